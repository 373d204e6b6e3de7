//! The law of ray and sphere: rays from inside and from the surface, tangents, limits, and directions that
//! are none. `tests/pictures/stability.rs` tests how often methods fail, from far away and elsewhere.

use crate::common::*;
use octray::measure::stability::spheres::{Ball, UNIT, aimed, intersect, off, passing, reference_t};
use octray::methods::{Naive, Robust, RobustAnyLength};

#[test]
fn any_length_is_scaled_exactly_by_powers_of_two() {
    // Nothing is rounded: t shrinks exactly as the direction grows.
    let mut rng = Rng(3);
    for _ in 0..10_000 {
        let unit = aimed(&mut rng, UNIT, 10.0, 1.0);
        for scale in [0.125, 4096.0] {
            let scaled = ray(unit.origin.get(0), unit.direction.get(0) * scale);
            let answers = [unit, scaled].map(|ray| intersect::<RobustAnyLength>(UNIT, &ray, f32::INFINITY));
            assert_eq!(answers[1].map(|t| t * scale), answers[0]);
        }
    }
}

/// The point at t lies on the sphere within the rounding of a good kernel.
fn lies_on(ball: Ball, ray: &Ray<f32>, t: f32) -> bool {
    let (off, allowed) = off(ball, ray, t);
    off <= allowed
}

fn from_inside_always_hits<S: SphereMethod>(radius: f32) {
    let mut rng = Rng(4);
    for _ in 0..50_000 {
        let ball = Ball { center: (rng.in_cube() * 3.0).as_vec3() * radius, radius };
        let inside = rng.direction() * (0.999 * rng.unit().cbrt() * f64::from(radius));
        let ray = ray((ball.center.as_dvec3() + inside).as_vec3(), rng.direction().as_vec3());
        let t = intersect::<S>(ball, &ray, f32::INFINITY);
        assert!(t.is_some_and(|t| lies_on(ball, &ray, t)), "{ball:?}, {ray:?}: {t:?}");
    }
}

#[test]
fn every_ray_from_inside_hits_the_far_side() {
    for radius in [1e-6, 1.0, 1e6] {
        from_inside_always_hits::<Robust>(radius);
        from_inside_always_hits::<RobustAnyLength>(radius);
    }
}

#[test]
fn rays_from_the_surface_inwards_hit_and_every_answer_lies_on_the_sphere() {
    fn check<S: SphereMethod>() {
        let mut rng = Rng(5);
        for _ in 0..50_000 {
            let ball = Ball { center: rng.in_cube().as_vec3(), radius: rng.scale(0.1, 10.0) as f32 };
            let normal = rng.direction();
            let origin = (ball.center.as_dvec3() + normal * f64::from(ball.radius)).as_vec3();
            let direction = rng.direction();
            let cos = direction.dot(normal);
            // Closer to the tangent, rounding decides which side of the surface the origin is on.
            if cos.abs() < 0.02 {
                continue;
            }
            let ray = ray(origin, direction.as_vec3());
            match intersect::<S>(ball, &ray, f32::INFINITY) {
                // The origin itself may be hit: it is rounded to one side of the surface or the other.
                Some(t) => assert!(lies_on(ball, &ray, t), "{ball:?}, {ray:?}: {t}"),
                None => assert!(cos > 0.0, "{ball:?}, {ray:?}"),
            }
        }
    }
    check::<Robust>();
    check::<RobustAnyLength>();
}

/// Both roots are next to zero there, and rounding alone decides whether there is a hit: but where there is
/// one, it is close by.
#[test]
fn rays_along_the_surface_hit_nothing_that_is_not_on_it() {
    fn check<S: SphereMethod>(length: f64) {
        let mut rng = Rng(9);
        let mut hits = 0;
        for i in 0..400_000 {
            let radius = [1.0, rng.scale(1e-6, 1e6) as f32][i % 2];
            let normal = if i % 5 == 0 { DVec3::AXES[rng.index(3)] } else { rng.direction() };
            let center = if i % 3 == 0 { DVec3::ZERO } else { rng.in_cube() * f64::from(radius) };
            let ball = Ball { center: center.as_vec3(), radius };
            // Exactly on the surface, or as near as rounding comes, or some steps of it off.
            let off = [0.0, rng.signed(), 8.0 * rng.signed()][rng.index(3)] / f64::from(1 << 24);
            let origin = ball.center.as_dvec3() + normal * (f64::from(radius) * (1.0 + off));
            let tangent = normal.cross(rng.direction()).normalize_or(normal.any_orthonormal_vector());
            let tilt = if i % 7 == 0 { 0.0 } else { rng.scale(1e-12, 1e-2) };
            let direction = (tangent + normal * (tilt * rng.signed().signum())).normalize() * length;
            let ray = ray(origin.as_vec3(), direction.as_vec3());
            if let Some(t) = intersect::<S>(ball, &ray, f32::INFINITY) {
                hits += 1;
                assert!(
                    lies_on(ball, &ray, t),
                    "{ball:?}, {ray:?}: {t}, in f64 {:?}",
                    reference_t(ball, &ray)
                );
            }
        }
        assert!(hits > 50_000, "{hits}");
    }
    check::<Robust>(1.0);
    check::<RobustAnyLength>(1.0);
    check::<RobustAnyLength>(1e-3);
}

#[test]
fn tangent_rays_are_undecided_only_within_the_rounding() {
    fn check<S: SphereMethod>() {
        let mut rng = Rng(6);
        for _ in 0..50_000 {
            let distance = rng.scale(1.5, 1e3);
            // The discriminant is r² − l², l the distance of line and centre: δl of a few ε · D decides
            // nothing below this.
            let margin = 20.0 / f64::from(1 << 24) * distance;
            for (from_center, hits) in [(1.0 - margin, true), (1.0 + margin, false)] {
                let ray = passing(&mut rng, from_center, distance);
                let t = intersect::<S>(UNIT, &ray, f32::INFINITY);
                assert_eq!(t.is_some(), hits, "l = {from_center}, D = {distance}");
                assert!(t.is_none_or(|t| lies_on(UNIT, &ray, t)), "{t:?}");
            }
        }
    }
    check::<Robust>();
    check::<RobustAnyLength>();
}

#[test]
fn zero_and_nan_directions_miss() {
    fn check<S: SphereMethod>(zero_from_inside: bool) {
        let outside = [Vec3::Z * 5.0, vec3(1.0, -2.0, 0.5)];
        let inside = [Vec3::ZERO, Vec3::X * 0.999, vec3(0.1, 0.2, 0.3)];
        let misses = |origin: Vec3, direction: Vec3| {
            for limit in [1.0, f32::INFINITY] {
                let t = intersect::<S>(UNIT, &ray(origin, direction), limit);
                assert_eq!(t, None, "{origin} along {direction}");
            }
        };
        for origin in outside.into_iter().chain(inside) {
            misses(origin, Vec3::NAN);
            misses(origin, vec3(f32::NAN, 0.0, -1.0));
        }
        for origin in outside.into_iter().chain(inside.into_iter().filter(|_| zero_from_inside)) {
            misses(origin, Vec3::ZERO);
            misses(origin, -Vec3::ZERO);
        }
    }
    // Robust takes unit length for granted: from inside, zero is outside its domain.
    check::<Robust>(false);
    check::<RobustAnyLength>(true);
    check::<Naive>(true);
}

#[test]
fn hits_lie_below_the_limit() {
    fn check<S: SphereMethod>() {
        let mut rng = Rng(7);
        for _ in 0..10_000 {
            let ray = aimed(&mut rng, UNIT, 4.0, 1.0);
            let Some(t) = intersect::<S>(UNIT, &ray, f32::INFINITY) else { continue };
            for (limit, hit) in [(0.0, None), (0.9 * t, None), (t, None), (t.next_up(), Some(t))] {
                assert_eq!(intersect::<S>(UNIT, &ray, limit), hit, "limit {limit}");
            }
        }
    }
    check::<Robust>();
    check::<RobustAnyLength>();
    check::<Naive>();
}
