//! The law of the hierarchy: every primitive in exactly one leaf, every box exactly around what is below it,
//! no deeper than promised, and the same bits for any number of threads; on random scenes, on real meshes,
//! and where builders fail.

use crate::common::*;
use octray::kernel::ray_box::sphere_bounds;
use octray::kernel::surface::triangle_bounds;
use octray::rays::KindCounts;
use octray::rays::bvh::check::{Statistics, check, check_geometry};
use octray::rays::bvh::{Bounds, Bvh, Child, LEAF, MAX_DEPTH, MAX_STACK, WIDE, WideNode};

/// Builds over boxes, of which the first `spheres` count as spheres, and checks.
fn valid(spheres: usize, boxes: &[Bounds]) -> Statistics {
    let counts = KindCounts([spheres, boxes.len() - spheres]);
    let bvh = Bvh::of_boxes(counts, Trees::WideAndBinary, |number| boxes[number]);
    let statistics = check(&bvh, counts, |number| boxes[number]).unwrap();
    assert!(statistics.wide_depth <= MAX_DEPTH as usize && statistics.binary_depth <= MAX_DEPTH as usize);
    assert!(statistics.stack <= MAX_STACK);
    statistics
}

fn valid_scene(scene: &Scene) -> Statistics {
    check_geometry(&Bvh::new(&scene.geometry(), Trees::WideAndBinary), &scene.geometry()).unwrap()
}

fn at(point: DVec3, size: f64) -> Bounds {
    let half = DVec3::splat(size / 2.0);
    Bounds { lo: (point - half).as_vec3(), hi: (point + half).as_vec3() }
}

/// Triangles and spheres of sizes spread over a decade.
fn crowd(rng: &mut Rng, spheres: usize, triangles: usize) -> Scene {
    let mut scene = empty();
    for _ in 0..spheres {
        let (center, radius) = (rng.in_cube().as_vec3(), rng.scale(0.005, 0.05) as f32);
        scene.spheres.push(sphere(center, radius, 0));
    }
    for _ in 0..triangles {
        let (middle, size) = (rng.in_cube(), rng.scale(0.01, 0.1));
        let vertices = [0; 3].map(|_| (middle + size * rng.in_cube()).as_vec3());
        scene.triangles.push(triangle(vertices, 0));
    }
    scene
}

fn mesh(name: &str) -> Option<Scene> {
    skipped::mesh(name).map(|path| load(path.to_str().unwrap()).unwrap())
}

#[test]
fn sphere_box_holds_the_sphere() {
    let mut rng = Rng(11);
    for _ in 0..100_000 {
        let (center, radius) = (rng.in_cube() * rng.scale(1e-6, 1e6), rng.scale(1e-6, 1e6));
        let (center, radius) = (center.as_vec3(), radius as f32);
        let bounds = Bounds::new(sphere_bounds(center, radius));
        let (low, high) = (center.as_dvec3() - f64::from(radius), center.as_dvec3() + f64::from(radius));
        // Sums of two f32 may need more than f64's bits; what is lost is far below half a unit of f32.
        assert!(bounds.lo.as_dvec3().cmple(low).all() && bounds.hi.as_dvec3().cmpge(high).all());
    }
}

#[test]
fn wide_node_is_whole_cache_lines_and_an_empty_one_hits_nothing() {
    assert_eq!((size_of::<WideNode>(), align_of::<WideNode>()), (32 * WIDE, 64));
    for slot in 0..WIDE {
        assert_eq!(WideNode::EMPTY.bounds(slot), Bounds::EMPTY);
        assert!(WideNode::EMPTY.children()[slot] == Child::NONE && Child::NONE.is_leaf());
    }
}

#[test]
fn few_primitives_make_a_valid_tree() {
    let mut rng = Rng(1);
    for count in 0..=40 {
        for spheres in [0, count / 3, count] {
            let boxes: Vec<_> = (0..count).map(|_| at(rng.in_cube(), 0.1)).collect();
            let statistics = valid(spheres, &boxes);
            assert!(count > LEAF || statistics.wide_nodes == 1, "{count} fit one node");
        }
    }
    let none = Bvh::of_boxes(KindCounts::default(), Trees::WideAndBinary, |_| unreachable!());
    assert_eq!((none.wide.len(), none.wide[0].children()[0]), (1, Child::NONE));
    assert!(none.bounds.is_empty());
}

#[test]
fn random_scenes_of_both_kinds_make_valid_trees() {
    let mut rng = Rng(2);
    for (spheres, triangles) in [(1, 1), (5, 0), (0, 5), (100, 100), (3, 5000), (5000, 3), (20_000, 20_000)] {
        valid_scene(&crowd(&mut rng, spheres, triangles));
    }
}

#[test]
fn equal_boxes_fill_leaves() {
    let one = at(dvec3(1.0, 2.0, 3.0), 0.5);
    let statistics = valid(0, &vec![one; 1_000_000]);
    assert!(statistics.leaf_fill > 7.9, "{statistics:?}");
    // Equal centres, different sizes.
    let mut rng = Rng(3);
    let nested: Vec<_> = (0..10_000).map(|_| at(DVec3::ZERO, rng.scale(1e-6, 1e6))).collect();
    assert!(valid(5_000, &nested).binary_depth <= 14);
    // Points, all the same and all different.
    valid(0, &vec![at(DVec3::ONE, 0.0); 1000]);
    let points: Vec<_> = (0..10_000).map(|_| at(rng.in_cube(), 0.0)).collect();
    valid(0, &points);
    // In a line and in a plane.
    valid(0, &points.iter().map(|one| at(one.lo.as_dvec3() * DVec3::X, 0.0)).collect::<Vec<_>>());
    valid(0, &points.iter().map(|one| at(one.lo.as_dvec3() * dvec3(1.0, 0.0, 1.0), 0.0)).collect::<Vec<_>>());
}

#[test]
fn depth_bombs_stay_shallow() {
    // Each box is a fixed share of the next one: a cut by cost splits off one at a time.
    for ratio in [1.01_f64, 1.1, 1.5, 2.0, 4.0, 10.0, 1000.0] {
        let scales = || (0..100_000).map(|i| ratio.powi(i)).take_while(|&scale| scale < 1e36);
        let boxes: Vec<_> = scales().map(|scale| at(DVec3::splat(scale * 1e-18), scale * 1e-18)).collect();
        valid(0, &boxes);
        let along: Vec<_> = scales().map(|scale| at(DVec3::X * scale * 1e-18, 0.0)).collect();
        valid(0, &along);
        // Many copies of each.
        let many: Vec<_> = (0..100).flat_map(|_| boxes.iter().copied()).collect();
        valid(many.len() / 2, &many);
    }
}

#[test]
fn mixed_scales_and_slivers_make_valid_trees() {
    let mut rng = Rng(4);
    let mut random = |count: usize, of: fn(&mut Rng) -> Bounds| -> Vec<Bounds> {
        (0..count).map(|_| of(&mut rng)).collect()
    };
    for boxes in [
        random(20_000, |rng| at(rng.in_cube() * rng.scale(1e-18, 1e18), rng.scale(1e-18, 1e18))),
        random(20_000, |rng| at(rng.in_cube() * rng.scale(1e-45, 1e-30), rng.scale(1e-45, 1e-30))),
        random(20_000, |rng| at(rng.in_cube() * 2e18, 0.0)),
        random(20_000, |rng| {
            let (point, way) = (rng.in_cube(), rng.direction() * rng.scale(1e-3, 1.0));
            Bounds::new(triangle_bounds([point, point + way, point + way * 0.5].map(|v| v.as_vec3())))
        }),
        // Longer than the distance between them, along one axis.
        random(20_000, |rng| {
            let x = rng.signed() as f32;
            Bounds { lo: vec3(x, -1.0, -1.0), hi: vec3(x, 1.0, 1.0) }
        }),
        // Far from the origin, where centres are few steps of f32 apart.
        random(20_000, |rng| at(DVec3::splat(1e6) + rng.in_cube(), 0.1)),
    ] {
        valid(7_000, &boxes);
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let mut rng = Rng(5);
    let mut scenes = vec![crowd(&mut rng, 30_000, 70_000)];
    scenes.extend(mesh("dragon-48k.obj"));
    for scene in &scenes {
        let mut first: Option<Vec<Vec<u32>>> = None;
        for threads in [1, 2, 3, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let bvh = pool.install(|| Bvh::new(&scene.geometry(), Trees::WideAndBinary));
            let leaves =
                |leaves: &[octray::rays::bvh::Leaf]| leaves.iter().flat_map(|leaf| leaf.primitives).collect();
            let bits = vec![
                bytemuck::cast_slice(&bvh.wide).to_vec(),
                bytemuck::cast_slice(&bvh.binary).to_vec(),
                leaves(&bvh.leaves[1]),
                leaves(&bvh.leaves[0]),
            ];
            assert!(first.get_or_insert_with(|| bits.clone()) == &bits, "{threads} threads");
        }
    }
}

/// All but the scalar baseline read the wide tree alone: leaving the binary tree out changes nothing of it.
#[test]
fn the_wide_tree_is_the_same_without_the_binary_one() {
    let scene = crowd(&mut Rng(7), 300, 700);
    let [both, wide] = [Trees::WideAndBinary, Trees::Wide].map(|trees| Bvh::new(&scene.geometry(), trees));
    assert!(!both.binary.is_empty() && wide.binary.is_empty());
    let bits = |bvh: &Bvh| bytemuck::cast_slice::<_, u32>(&bvh.wide).to_vec();
    assert!(bits(&both) == bits(&wide) && both.bounds == wide.bounds);
    assert!(both.leaves == wide.leaves);
    assert!(both.bytes() > wide.bytes());
    let statistics = check_geometry(&wide, &scene.geometry()).unwrap();
    assert_eq!((statistics.binary_nodes, statistics.binary_depth), (0, 0));
}

#[test]
fn meshes_fill_nodes_and_leaves() {
    for name in ["bunny.obj", "dragon-48k.obj"] {
        let Some(scene) = mesh(name) else { continue };
        let statistics = valid_scene(&scene);
        assert!(statistics.leaf_fill > 5.0 && statistics.node_fill > 6.0, "{name}: {statistics:?}");
    }
}

#[test]
fn check_finds_what_is_wrong() {
    let mut rng = Rng(6);
    let boxes: Vec<_> = (0..1000).map(|_| at(rng.in_cube(), 0.1)).collect();
    let good = Bvh::of_boxes(KindCounts([0, 1000]), Trees::WideAndBinary, |number| boxes[number]);
    let wrong = |change: &dyn Fn(&mut Bvh)| {
        let mut bvh = good.clone();
        change(&mut bvh);
        check(&bvh, KindCounts([0, 1000]), |number| boxes[number]).unwrap_err()
    };
    assert!(wrong(&|bvh| bvh.leaves[1][3].primitives[0] += 1).contains("box"));
    assert!(wrong(&|bvh| bvh.wide.truncate(5)).contains("out of range"));
    assert!(wrong(&|bvh| bvh.wide[2] = WideNode::EMPTY).contains("0 children"));
    assert!(wrong(&|bvh| bvh.binary[7] = bvh.binary[8]).contains("binary node"));
    assert!(wrong(&|bvh| bvh.bounds.hi.x += 1.0).contains("bounds"));
    assert!(wrong(&|bvh| bvh.leaves[1].push(bvh.leaves[1][0])).contains("lost leaves"));
}
