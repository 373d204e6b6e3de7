//! Every way through the hierarchy finds what testing every primitive finds, bit for bit.

use crate::common::rays::{Set, mixture};
use crate::common::*;
use octray::measure::ray_sets::{Answers, RaySet};
use octray::measure::trace::{Accelerators, TracePool, traversals};

/// Directions that divide by zero, or nearly.
fn awkward(rng: &mut Rng) -> Vec3 {
    let tiny = [0.0, -0.0, 1e-17, -1e-17, 1e-40, -1e-40, 1.0, -1.0, 0.3];
    let mut pick = || tiny[(rng.unit() * tiny.len() as f64) as usize];
    loop {
        let d = vec3(pick(), pick(), pick());
        if d.length() > 0.1 {
            return d.normalize();
        }
    }
}

#[test]
fn every_traversal_equals_testing_every_primitive() {
    let mut rng = Rng(11);
    let mut hits = 0;
    for (triangles, spheres, scales, offset) in [
        (1, 0, 0.0, 0.0),
        (0, 1, 0.0, 0.0),
        (5, 3, 0.0, 0.0),
        (300, 0, 1.0, 0.0),
        (0, 300, 2.0, 0.0),
        (400, 200, 3.0, 0.0),
        (300, 100, 1.0, 1000.0),
        (2000, 0, 2.0, 0.0),
    ] {
        let scene = mixture(&mut rng, triangles, spheres, scales, offset);
        let mut set = Set::default();
        let corners: Vec<Vec3> = scene.triangles.iter().flat_map(|triangle| triangle.vertices).collect();
        for i in 0..6000 {
            let mut origin = rng.in_cube().as_vec3() * 6.0 + offset;
            // At a corner, towards a corner, in the plane of a box's face.
            let corner = corners.get((rng.unit() * corners.len() as f64) as usize).copied();
            match (i % 8, corner) {
                (0, Some(corner)) => origin = corner,
                (1, Some(corner)) => origin.x = corner.x,
                _ => {}
            }
            let direction = match (i % 3, corner) {
                (0, _) => awkward(&mut rng),
                (1, Some(corner)) => (corner - origin).normalize_or(Vec3::X),
                _ => rng.direction().as_vec3(),
            };
            let t_max = if i % 5 == 0 { (4.0 * rng.unit()) as f32 } else { f32::INFINITY };
            set.push(origin, direction, t_max);
        }
        let what = format!("{triangles} triangles, {spheres} spheres, {scales} decades at {offset}");
        hits += set.check(&scene, &what);
    }
    assert!(hits > 3_000, "only {hits} rays hit anything");
}

/// Streams take batches whose rays run into one octant another way than those of more.
#[test]
fn batches_of_one_octant_and_of_several_find_the_same() {
    let mut rng = Rng(18);
    let scene = mixture(&mut rng, 600, 60, 1.0, 0.0);
    let mut hits = 0;
    // Each octant in turn; all together; backwards along zeros, or next to them; one whose last packet is not
    // whole and leaves the octant.
    for batch in 0..11 {
        let mut set = Set::default();
        for i in 0..if batch == 10 { 131 } else { 256 } {
            let leaves = batch == 10 && i >= 128;
            let direction = match batch {
                8 => rng.direction().as_vec3(),
                9 => -awkward(&mut rng).abs(),
                10 if leaves => -rng.direction().as_vec3().abs(),
                10 => rng.direction().as_vec3().abs(),
                octant => {
                    let sign = |axis: usize| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 };
                    rng.direction().as_vec3().abs() * vec3(sign(0), sign(1), sign(2))
                }
            };
            // From outside and from among them; what leaves its octant, at something.
            let through = match leaves {
                true => scene.spheres[i % scene.spheres.len()].center,
                false => rng.in_cube().as_vec3() * 3.0,
            };
            set.push(through - direction * if i % 2 == 0 { 9.0 } else { 0.5 }, direction, f32::INFINITY);
        }
        if batch == 0 {
            // One that does not run along an axis backwards but has a sign there.
            (set.origin[0][77], set.direction[0][77]) = (set.origin[0][77].abs().min(2.0), -0.0);
        }
        hits += set.check(&scene, &format!("batch {batch}"));
    }
    assert!(hits > 300);
}

#[test]
fn rays_that_are_none_miss_and_a_hit_at_the_reach_is_none() {
    let mut scene = mixture(&mut Rng(14), 40, 1, 0.0, 0.0);
    scene.spheres.push(sphere(vec3(10.0, 0.0, 0.0), 1e-18, 0));
    let mut set = Set::default();
    let (nan, infinity) = (f32::NAN, f32::INFINITY);
    for direction in [Vec3::NAN, Vec3::ZERO, vec3(0.0, 0.0, nan), vec3(nan, 1.0, 0.0)] {
        set.push(Vec3::ONE, direction, infinity);
    }
    for origin in [Vec3::NAN, Vec3::INFINITY, vec3(-20.0, 0.0, 0.0), vec3(0.0, -20.0, 0.0)] {
        set.push(origin, Vec3::X, infinity);
        set.push(origin, Vec3::Y, infinity);
        set.push(origin, Vec3::Z, infinity);
    }
    let mut rng = Rng(15);
    let first = set.t_max.len();
    for _ in 0..500 {
        set.push(rng.direction().as_vec3() * 8.0, rng.direction().as_vec3(), infinity);
    }
    set.check(&scene, "no rays at all");
    let answers = set.linear(&scene);
    for (t_max, answer) in set.t_max[first..].iter_mut().zip(&answers[first..]) {
        *t_max = f32::from_bits(answer[0]);
    }
    set.check(&scene, "reaches that end at the hit");
}

/// Measuring knows one way more: it tests everything with packets.
#[test]
fn ways_that_are_measured_agree_and_a_hit_at_the_reach_is_none() {
    let scene = mixture(&mut Rng(16), 40, 20, 0.0, 0.0);
    let structures =
        Accelerators::new(&scene.geometry(), octray::rays::Structure::tree_for_all(&scene.geometry()));
    let mut rng = Rng(17);
    let pixels: Vec<[u32; 2]> = (0..48 * 32).map(|i| [i % 48, i / 48]).collect();
    let camera = octray::camera::PreparedCamera::new(&scene.camera, [48, 32]);
    let mut set = RaySet::primary(&camera, &pixels);
    let pool = TracePool::new(1);
    let traced = |set: &RaySet, way: TraversalChoice| {
        let mut answers = Answers::none(set);
        pool.trace(way, &structures, set, &mut answers, false);
        answers
    };
    let nearest = traced(&set, TraversalChoice::Linear);
    assert!(nearest.count() > 200, "{}", nearest.count());
    // The hit itself, the number behind it, somewhere, and NaN, which spoils no other ray of a packet.
    let mut end = |(i, &t): (usize, &f32)| [t, t.next_up(), 8.0 * rng.unit() as f32, f32::NAN][i % 4];
    set.t_max = nearest.t.iter().enumerate().map(&mut end).collect();
    let expected = traced(&set, TraversalChoice::Linear);
    for (at, (&t_max, &t)) in set.t_max.iter().zip(&nearest.t).enumerate() {
        assert_eq!(expected.primitive[at] != MISS, t < t_max, "ray {at}: {t} within {t_max}");
    }
    // As bits: NaN equals itself, and the zeros differ.
    let bits = |Answers { t, primitive, u, v }: Answers| {
        (primitive, [t, u, v].map(|column| column.into_iter().map(f32::to_bits).collect::<Vec<_>>()))
    };
    let expected = bits(expected);
    for way in traversals() {
        assert!(bits(traced(&set, way)) == expected, "{}", way.name());
    }
}

/// What padding is for, seen through the whole of a hierarchy.
#[test]
fn without_padding_hits_are_lost_at_corners() {
    let mut rng = Rng(17);
    let scene = mixture(&mut rng, 300, 0, 1.0, 1000.0);
    let mut set = Set::default();
    let corners: Vec<Vec3> = scene.triangles.iter().flat_map(|triangle| triangle.vertices).collect();
    for _ in 0..20_000 {
        let target = corners[rng.index(corners.len())];
        let origin = target + rng.in_cube().as_vec3() * 8.0;
        set.push(origin, (target - origin).normalize_or(Vec3::X), f32::INFINITY);
    }
    let mut hierarchy = Hierarchy::new(&scene.geometry(), Trees::WideAndBinary);
    let found = |hierarchy: &Hierarchy| {
        let answers = set.through::<false>(hierarchy, Traversal::Hybrid);
        answers.iter().filter(|answer| answer[1] != MISS).count()
    };
    let padded = found(&hierarchy);
    hierarchy.padding = hierarchy.padding.without_padding();
    let unpadded = found(&hierarchy);
    assert!(padded > 5_000 && unpadded < padded - padded / 50, "{unpadded} of {padded}");
}
