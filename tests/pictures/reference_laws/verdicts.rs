//! The judge lets rounding pass and lets nothing else pass: single-precision kernels, good, naive and
//! sabotaged.

use super::scenes::empty;
use crate::common::rays::{Set, list_of};
use crate::common::*;
use octray::reference::Verdict;

fn direction(rng: &mut Rng) -> Vec3 {
    rng.direction().as_vec3()
}

fn scale(rng: &mut Rng, low: f64, high: f64) -> f32 {
    rng.scale(low, high) as f32
}

/// What the engine's equations find nearest, in a direction of unit length.
fn nearest(scene: &Scene, sphere: SphereChoice, origin: Vec3, d: Vec3) -> [u32; 4] {
    let list = list_of(scene, Methods { sphere, ..Methods::default() }, 1);
    Set::of(&[ray(origin, d)]).nearest_in(&list)[0]
}

/// The nearest hit of everything: what a kernel under test answers.
fn answer(scene: &Scene, sphere: SphereChoice, origin: Vec3, d: Vec3) -> (f32, u32) {
    // A power of two, which rounds nothing.
    let length = d.length().log2().round().exp2();
    let [t, primitive, ..] = nearest(scene, sphere, origin, d / length);
    (f32::from_bits(t) / length, primitive)
}

fn judge(scene: &Scene, origin: Vec3, d: Vec3, (t, primitive): (f32, u32)) -> Verdict {
    Reference::new(scene).check_primary(origin.to_array(), d.to_array(), t, primitive)
}

/// A direction from `origin` towards `target`, of some power of two as its length.
fn aim(rng: &mut Rng, origin: Vec3, target: Vec3) -> Vec3 {
    (target - origin).normalize() * [0.125, 0.5, 1.0, 8.0][rng.index(4)]
}

/// One sphere, a ray aimed within 1.2 radii of its centre: every distance and size, eyes inside, outside and
/// lifted off the surface; and a ray in three straight at the outline.
fn sphere_inputs(rng: &mut Rng) -> (Scene, Vec3, Vec3) {
    let radius = scale(rng, 1e-6, 1e6);
    let center = direction(rng) * scale(rng, 1e-3, 1e3);
    let normal = direction(rng);
    let height = match (rng.unit() * 4.0) as u32 {
        0 => 1.0 + scale(rng, 1e-5, 1e5),
        1 => rng.unit() as f32,
        2 => 1.0 + 2e-6,
        _ => 1.0 - 2e-6,
    };
    let origin = center + normal * radius * height;
    let aside = direction(rng).cross(normal).normalize();
    let offset = if rng.unit() < 0.33 { scale(rng, 0.9999, 1.0001) } else { 1.2 * rng.unit().sqrt() as f32 };
    let target =
        if height > 1.0001 { center + aside * radius * offset } else { origin + direction(rng) * radius };
    let d = aim(rng, origin, target);
    (Scene { spheres: vec![sphere(center, radius, 0)], ..empty() }, origin, d)
}

/// One triangle, from round to sliver, at every size and distance; a ray in three at an edge, one in three
/// edge-on.
fn triangle_inputs(rng: &mut Rng) -> (Scene, Vec3, Vec3) {
    let (size, distance) = (scale(rng, 1e-3, 1e3), scale(rng, 1e-2, 1e4));
    let corner = direction(rng) * scale(rng, 1e-2, 1e2);
    let edge = direction(rng) * size;
    let height = direction(rng).cross(edge).normalize() * size * scale(rng, 1e-4, 1.0);
    let vertices = [corner, corner + edge, corner + edge * rng.unit() as f32 + height];
    let (kind, u, v) = (rng.unit(), rng.unit() as f32, rng.unit() as f32);
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let v = if kind < 0.33 { scale(rng, 1e-9, 1e-5) } else { v };
    let target = vertices[0] + (vertices[1] - vertices[0]) * u + (vertices[2] - vertices[0]) * v;
    let away = if kind > 0.67 {
        (edge.normalize() * rng.signed() as f32 + height.normalize() * rng.signed() as f32).normalize()
            + direction(rng) * scale(rng, 1e-8, 1e-2)
    } else {
        direction(rng)
    };
    let origin = target + away.normalize() * size * distance;
    let d = aim(rng, origin, target);
    (Scene { triangles: vec![triangle(vertices, 0)], ..empty() }, origin, d)
}

#[test]
fn rounding_of_a_good_kernel_is_right() {
    let mut rng = Rng(3);
    for inputs in [sphere_inputs, triangle_inputs] {
        let mut hits = 0;
        for ray in 0..100_000 {
            let (scene, origin, d) = inputs(&mut rng);
            let found = answer(&scene, SphereChoice::Robust, origin, d);
            hits += u32::from(found.1 != MISS);
            let verdict = judge(&scene, origin, d, found);
            let things = (&scene.spheres, &scene.triangles);
            assert_eq!(verdict, Verdict::Right, "ray {ray}: {origin:?} {d:?} {found:?} {things:?}");
        }
        assert!((40_000..95_000).contains(&hits), "{hits} hits: both answers are put to the test");
    }
}

/// The weights of a good kernel pass on every shape of triangle; wrong ones are flagged wherever single
/// precision can tell.
#[test]
fn weights_of_a_good_kernel_are_right_and_wrong_ones_are_flagged() {
    let mut rng = Rng(13);
    let (mut judged, mut flagged) = (0, [0; 4]);
    for ray in 0..100_000 {
        let (scene, origin, d) = triangle_inputs(&mut rng);
        let d = d.normalize();
        let [_, primitive, u, v] = nearest(&scene, SphereChoice::Robust, origin, d);
        if primitive == MISS {
            continue;
        }
        let [u, v] = [u, v].map(f32::from_bits);
        let reference = Reference::new(&scene);
        let verdict = |weights| reference.check_weights(origin.to_array(), d.to_array(), 0, weights);
        let told = format!("ray {ray}: {origin:?} {d:?} {u} {v} {:?}", scene.triangles);
        assert_eq!(verdict([u, v]), Verdict::Right, "{told}");
        judged += 1;
        for weights in [[f32::NAN, v], [u, f32::NAN], [-1e-3, v], [u, 1.001 - u]] {
            assert_eq!(verdict(weights), Verdict::Invalid);
        }
        // Swapped, of the wrong vertices, and off by a hundredth and a thousandth: less than single precision
        // knows of slivers.
        let wrong = [[v, u], [1.0 - u - v, u], [0.99 * u, v], [u, 0.999 * v]];
        for (count, weights) in flagged.iter_mut().zip(wrong) {
            *count += u32::from(verdict(weights) != Verdict::Right);
        }
    }
    assert!(judged > 40_000, "{judged}");
    let least = [0.8, 0.8, 0.6, 0.2];
    for (count, least) in flagged.into_iter().zip(least) {
        assert!(f64::from(count) > least * f64::from(judged), "{flagged:?} of {judged}");
    }
}

/// At distance 4096 a third of the naive kernel's answers are wrong, at 100 one in a thousand
/// and many t.
#[test]
fn rounding_of_a_naive_kernel_is_flagged() {
    let scene = Scene { spheres: vec![sphere(Vec3::ZERO, 1.0, 0)], ..empty() };
    let mut rng = Rng(5);
    for (distance, least) in [(100.0, 0.5), (4096.0, 0.9)] {
        let (mut flagged_naive, mut flagged_robust) = (0, 0);
        for _ in 0..20_000 {
            let eye = direction(&mut rng) * distance;
            let target = direction(&mut rng).cross(eye).normalize() * 1.2 * rng.unit().sqrt() as f32;
            let d = (target - eye).normalize();
            let wrong = |roots| judge(&scene, eye, d, answer(&scene, roots, eye, d)) != Verdict::Right;
            flagged_naive += u32::from(wrong(SphereChoice::Naive));
            flagged_robust += u32::from(wrong(SphereChoice::Robust));
        }
        // A third of the rays miss by far, which nobody gets wrong at 100.
        let share = f64::from(flagged_naive) / 20_000.0;
        assert!(share > least * 0.3, "distance {distance}: {share}");
        assert_eq!(flagged_robust, 0);
    }
}

/// A heap of spheres and triangles, and every way to be wrong about it.
#[test]
fn every_sabotage_is_flagged() {
    let mut rng = Rng(9);
    let mut scene = empty();
    for _ in 0..30 {
        scene.spheres.push(sphere(
            direction(&mut rng) * scale(&mut rng, 0.5, 4.0),
            scale(&mut rng, 0.1, 0.5),
            0,
        ));
        let center = direction(&mut rng) * scale(&mut rng, 0.5, 4.0);
        scene.triangles.push(triangle([0, 1, 2].map(|_| center + direction(&mut rng) * 0.5), 0));
    }
    let reference = Reference::new(&scene);
    let (mut judged, mut shifted, mut behind) = (0, [0; 2], 0);
    for _ in 0..20_000 {
        let (origin, target) = (direction(&mut rng) * 6.0, direction(&mut rng) * 3.0 * rng.unit() as f32);
        let d = aim(&mut rng, origin, target);
        let (t, primitive) = answer(&scene, SphereChoice::Robust, origin, d);
        let verdict = |t, primitive| reference.check_primary(origin.to_array(), d.to_array(), t, primitive);
        assert_eq!(verdict(t, primitive), Verdict::Right);
        // That a miss is right says that the judge sees nothing either.
        if primitive == MISS {
            continue;
        }
        // Beyond doubt: the primitive alone is not within 1e-3 of its outline, says the judge of misses.
        let alone = match primitive as usize {
            sphere @ 0..30 => Scene { spheres: vec![scene.spheres[sphere]], ..empty() },
            triangle => Scene { triangles: vec![scene.triangles[triangle - 30]], ..empty() },
        };
        let missed = judge(&alone, origin, d, (f32::INFINITY, MISS));
        if !matches!(missed, Verdict::Overlooked { slack, .. } if slack < 1e-3) {
            continue;
        }
        judged += 1;
        // Tangents apart, a shift along the ray leaves the surface.
        for (count, factor) in shifted.iter_mut().zip([0.999f32, 1.001]) {
            *count += u32::from(verdict(t * factor, primitive) != Verdict::Right);
        }
        for wrong in [f32::NAN, -t, 0.0, f32::INFINITY] {
            assert_eq!(verdict(wrong, primitive), Verdict::Invalid);
        }
        assert_eq!(verdict(t, 60), Verdict::Invalid);
        // Where two primitives cross, both may be right.
        let near = (0..60).filter(|&p| verdict(t, p) == Verdict::Right).count() > 1;
        for other in (0..60).filter(|&other| other != primitive) {
            let off = matches!(verdict(t, other), Verdict::OffSurface { .. });
            assert!(off || near, "primitive {other} at t of {primitive}");
        }
        // The next thing behind, as if the first one had been lost.
        let mut without = scene.clone();
        match primitive as usize {
            lost @ 0..30 => without.spheres[lost].center = Vec3::X * 1e4,
            lost => without.triangles[lost - 30].vertices = Vec3::AXES.map(|v| v + Vec3::X * 1e4),
        }
        let (next, hidden) = answer(&without, SphereChoice::Robust, origin, d);
        if next > t * 1.01 {
            behind += 1;
            let overlooked = verdict(next, hidden);
            let is_first = matches!(overlooked, Verdict::Overlooked { primitive: p, .. } if p == primitive);
            assert!(is_first, "{overlooked:?}");
        }
    }
    assert!(judged > 5_000 && behind > 5_000, "{judged} rays judged, {behind} with the first hit lost");
    let all = shifted.iter().all(|&flagged| f64::from(flagged) > 0.99 * f64::from(judged));
    assert!(all, "{shifted:?} of {judged}");
}

#[test]
fn far_root_of_a_sphere_seen_from_outside_is_flagged() {
    let scene = Scene { spheres: vec![sphere(Vec3::ZERO, 1.0, 0)], ..empty() };
    let overlooked = judge(&scene, Vec3::Z * 5.0, -Vec3::Z, (6.0, 0));
    assert!(matches!(overlooked, Verdict::Overlooked { primitive: 0, distance: 4.0, .. }), "{overlooked:?}");
    assert_eq!(judge(&scene, Vec3::Z * 5.0, -Vec3::Z, (4.0, 0)), Verdict::Right);
    assert_eq!(judge(&scene, Vec3::Z * 0.5, -Vec3::Z, (1.5, 0)), Verdict::Right, "from inside the only one");
}

/// Of two surfaces one rounding apart either may be named; of two a hundred apart only the nearer.
#[test]
fn nearly_equal_distances_may_be_swapped_and_others_not() {
    let at = |z: f32| triangle([vec3(-1.0, -1.0, z), vec3(1.0, -1.0, z), vec3(0.0, 2.0, z)], 0);
    let gap = |gap: f32| Scene { triangles: vec![at(0.0), at(-gap)], ..empty() };
    assert_eq!(judge(&gap(5e-7), Vec3::Z * 5.0, -Vec3::Z, (5.0, 1)), Verdict::Right);
    let swapped = judge(&gap(1e-4), Vec3::Z * 5.0, -Vec3::Z, (5.0001, 1));
    assert!(matches!(swapped, Verdict::Overlooked { primitive: 0, .. }), "{swapped:?}");
}

/// A direction that is no direction hits nothing.
#[test]
fn only_a_miss_is_right_along_no_direction() {
    let scene = Scene { spheres: vec![sphere(Vec3::ZERO, 1.0, 0)], ..empty() };
    for d in [Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)] {
        assert_eq!(judge(&scene, Vec3::Z * 5.0, d, (f32::INFINITY, MISS)), Verdict::Right);
        assert_eq!(judge(&scene, Vec3::Z * 5.0, d, (4.0, 0)), Verdict::Invalid);
    }
}

/// What the judge takes for the truth agrees with its own closest hit.
#[test]
fn closest_is_right_by_its_own_verdict() {
    let mut rng = Rng(11);
    for inputs in [sphere_inputs, triangle_inputs] {
        for _ in 0..20_000 {
            let (scene, origin, d) = inputs(&mut rng);
            let hit = Reference::new(&scene).closest(origin.as_dvec3(), d.as_dvec3());
            let (t, primitive) = hit.map_or((f32::INFINITY, MISS), |hit| (hit.t as f32, hit.primitive));
            let verdict = judge(&scene, origin, d, (t, primitive));
            assert_eq!(verdict, Verdict::Right, "{origin:?} {d:?} {hit:?} {:?}", scene.triangles);
        }
    }
}
