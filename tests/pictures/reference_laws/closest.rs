//! The closest hit, against closed forms.

use super::scenes::{ball, empty, wall};
use crate::common::*;

#[test]
fn closest_gives_the_near_root_of_a_sphere_head_on() {
    let judge = Reference::new(&ball(Diffuse));
    let hit = judge.closest(DVec3::Z * 5.0, -DVec3::Z).unwrap();
    assert_eq!((hit.primitive, hit.t), (0, 4.0));
    let longer = judge.closest(DVec3::Z * 5.0, DVec3::Z * -8.0).unwrap();
    assert_eq!(longer.t, 0.5, "t counts in lengths of the direction");
    assert_eq!(judge.closest(DVec3::ZERO, DVec3::X).unwrap().t, 1.0, "from inside");
    assert!(judge.closest(DVec3::Z * 5.0, DVec3::Z).is_none(), "behind");
    assert!(judge.closest(dvec3(1.001, 0.0, 5.0), -DVec3::Z).is_none(), "beside");
    assert!(judge.closest(DVec3::Z * 5.0, DVec3::ZERO).is_none(), "a direction of length zero");
}

#[test]
fn closest_gives_t_and_weights_of_a_triangle() {
    let vertices = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 4.0];
    let judge = Reference::new(&Scene { triangles: vec![triangle(vertices, 0)], ..empty() });
    for side in [1.0, -1.0] {
        let hit = judge.closest(dvec3(0.5, 1.0, 3.0 * side), DVec3::Z * -side).unwrap();
        assert_eq!((hit.primitive, hit.t, hit.u, hit.v), (0, 3.0, 0.25, 0.25));
    }
    assert!(judge.closest(dvec3(-0.01, 1.0, 3.0), -DVec3::Z).is_none(), "beside");
    assert!(judge.closest(dvec3(0.5, 1.0, 3.0), DVec3::Z).is_none(), "behind");
    assert!(judge.closest(dvec3(0.5, 1.0, 0.0), DVec3::X).is_none(), "within its plane");
    assert!(judge.closest(dvec3(0.5, 1.0, 3.0), DVec3::ZERO).is_none(), "a direction of length zero");
}

#[test]
fn closest_prefers_the_nearer_then_the_lower_index() {
    let scene = wall(Diffuse);
    let far = scene.triangles[0].vertices.map(|vertex| vertex - Vec3::Z);
    let judge = Reference::new(&Scene {
        spheres: vec![
            sphere(Vec3::Z * -9.0, 1.0, 0),
            sphere(Vec3::Z * -1.0, 1.0, 0),
            sphere(Vec3::Z * -1.0, 1.0, 0),
        ],
        triangles: vec![triangle(far, 0), scene.triangles[0], scene.triangles[0]],
        ..empty()
    });
    assert_eq!(judge.closest(DVec3::Z * 5.0, -DVec3::Z).unwrap().primitive, 1, "sphere 1 touches triangle 4");
    assert_eq!(judge.closest(dvec3(3.0, 0.0, 5.0), -DVec3::Z).unwrap().primitive, 4);
}

/// An octahedron seen from inside, aimed at its edges: no ray may leave.
#[test]
fn closest_lets_nothing_pass_through_a_common_edge() {
    let mut triangles = Vec::new();
    for corner in 0..8 {
        let sign = |axis: u32| if corner >> axis & 1 == 0 { 1.0f32 } else { -1.0 };
        triangles.push(triangle([Vec3::X * sign(0), Vec3::Y * sign(1), Vec3::Z * sign(2)], 0));
    }
    let edges: Vec<_> =
        triangles.iter().flat_map(|t| (0..3).map(|i| (t.vertices[i], t.vertices[(i + 1) % 3]))).collect();
    let judge = Reference::new(&Scene { triangles, ..empty() });
    let mut rng = Rng(1);
    for i in 0..20_000 {
        let origin = rng.direction() * 0.5;
        let (from, to) = edges[i % edges.len()];
        let target = from.as_dvec3().lerp(to.as_dvec3(), rng.unit());
        assert!(judge.closest(origin, target - origin).is_some(), "from {origin} to {target}");
    }
}
