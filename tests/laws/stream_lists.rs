//! Lists of a stream's rays that fill what room there is: many rays, not whole packets of them, through boxes
//! that all of them pass.

use crate::common::rays::Set;
use crate::common::*;
use octray::rays::bvh::LEAF;

/// Thin triangles behind each other, each across all rays.
fn triangles() -> Scene {
    let mut scene = diffuse();
    for layer in 0..4500 {
        let z = layer as f32 * 2e-4;
        let corners = [vec3(-90.0, -90.0, z), vec3(90.0, -90.0, z), vec3(0.0, 90.0, z)];
        scene.triangles.push(triangle(corners, 0));
    }
    scene
}

/// Spheres behind each other, each across all rays.
fn spheres() -> Scene {
    let mut scene = diffuse();
    let layers = (0..700).map(|layer| sphere(Vec3::Z * (20.0 + layer as f32 * 2e-3), 20.0, 0));
    scene.spheres.extend(layers);
    scene
}

#[test]
fn lists_grow_when_every_ray_passes_every_box() {
    let mut rng = Rng(95);
    let counts = [8191, 8185];
    for (scene, count) in [triangles(), spheres()].iter().flat_map(|scene| counts.map(|count| (scene, count)))
    {
        let hierarchy = Hierarchy::new(&scene.geometry(), Trees::Wide);
        let mut set = Set::default();
        for _ in 0..count {
            let aim = vec3(rng.unit() as f32, rng.unit() as f32, 10.0);
            set.push(vec3(0.0, 0.0, -5.0), aim.normalize(), f32::INFINITY);
        }
        // Of the other traversals each ray goes by itself or with a packet.
        let expected = set.linear(scene);
        assert!(expected.iter().all(|answer| answer[1] != MISS));
        for traversal in [Traversal::Stream, Traversal::Hybrid] {
            let name = TraversalChoice::Through(traversal).name();
            assert!(set.through::<false>(&hierarchy, traversal) == expected, "{count} rays, {name}");
            let any = set.through::<true>(&hierarchy, traversal);
            assert!(any.iter().all(|answer| answer[1] != MISS), "{count} rays, any hit, {name}");
        }
    }
}

/// Two leaves that each ray reaches are tested in two loops, more pairs than a batch has rays.
#[test]
fn any_hit_rays_of_a_whole_batch_reach_two_leaves() {
    let mut scene = triangles();
    scene.triangles.truncate(LEAF + 1);
    // The last one is met by rays that miss the others.
    let z = scene.triangles.len() as f32 * 2e-4;
    let corners = [vec3(90.0, 90.0, z), vec3(-90.0, 90.0, z), vec3(90.0, -90.0, z)];
    scene.triangles.push(triangle(corners, 0));
    let hierarchy = Hierarchy::new(&scene.geometry(), Trees::WideAndBinary);
    assert_eq!(hierarchy.bvh.wide[0].filled(), 2);
    let mut rng = Rng(96);
    let mut set = Set::default();
    for _ in 0..8185 {
        // Inside of the boxes.
        let at = |unit: f64| 170.0 * unit as f32 - 85.0;
        let aim = vec3(at(rng.unit()), at(rng.unit()), 5.0);
        set.push(vec3(0.0, 0.0, -5.0), aim.normalize(), f32::INFINITY);
    }
    let misses = |answers: &[[u32; 4]]| answers.iter().map(|answer| answer[1] == MISS).collect::<Vec<_>>();
    let expected = misses(&set.linear(&scene));
    let missed = expected.iter().filter(|&&missed| missed).count();
    assert!((500..4000).contains(&missed), "{missed}");
    for traversal in [Traversal::Stream, Traversal::Hybrid] {
        assert_eq!(
            misses(&set.through::<true>(&hierarchy, traversal)),
            expected,
            "{}",
            TraversalChoice::Through(traversal).name()
        );
    }
}
