//! The law of spheres in boxes: where the robust test finds a hit, the ray passes the sphere's box, and
//! enters it no later than it hits.
//!
//! Judged in f64. All regimes: from inside, on the surface, from near it and from 10⁸ radii away, through the
//! middle and along the silhouette, radii from 1e-18 to 1e6, directions of unit length and as far off it as
//! the domain allows.

use crate::common::*;
use octray::kernel::ray_box::{BoxRay, Padding, sphere_bounds, sphere_padding};
use octray::kernel::ray_sphere;
use octray::kernel::sphere_culling::{CulledSphere, SphereCulling};
use octray::math::EPSILON;
use octray::rays::bvh::Bounds;

const LENGTHS: [f64; 4] = [0.0, 1e-5, -1e-5, 1e-7];
/// Distances from the centre, in radii.
const DISTANCES: [(f64, f64); 7] =
    [(1e-6, 1.0), (1.0, 1.0), (1.0 + 1e-7, 1.001), (1.001, 2.0), (2.0, 100.0), (100.0, 1e5), (1e5, 1e8)];

/// A ray, a sphere, and the t that the test finds.
struct Found {
    center: Vec3,
    radius: f32,
    origin: Vec3,
    direction: Vec3,
    t: f32,
}

impl Found {
    /// How much larger the sphere would have to be for the hit to lie in it, or behind where the ray enters
    /// it; and the distance from origin to centre.
    fn excess(&self) -> (f64, f64) {
        let from_center = self.origin.as_dvec3() - self.center.as_dvec3();
        let (direction, length) = (self.direction.as_dvec3(), self.direction.as_dvec3().length());
        let unit = direction / length;
        let ahead = -from_center.dot(unit);
        let across = (from_center + unit * ahead).length();
        let distance = from_center.length();
        let behind_nearest = f64::from(self.t) * length - ahead;
        let mut needed = across;
        if behind_nearest < 0.0 {
            needed = needed.max(across.hypot(behind_nearest).min(distance));
        }
        if ahead < 0.0 {
            needed = needed.max(distance);
        }
        (needed - f64::from(self.radius), distance)
    }
}

/// Calls `check` with hits of spheres around the origin or elsewhere, by rays from `distances`, of which most
/// graze the sphere.
fn each_hit(seed: u64, rays: usize, distances: (f64, f64), length: f64, mut check: impl FnMut(&Found)) {
    let mut rng = Rng(seed);
    for i in 0..rays {
        let radius = rng.scale(1e-18, 1e6) as f32;
        let r = f64::from(radius);
        let (low, high) = distances;
        let ratio = if low > 1.0 { 1.0 + rng.scale(low - 1.0, high - 1.0) } else { rng.scale(low, high) };
        let place = if i % 2 == 0 { DVec3::ZERO } else { rng.in_cube() * (3.0 * r * ratio) };
        let center = place.as_vec3();
        let out = if i % 8 == 7 { DVec3::AXES[rng.index(3)] } else { rng.direction() };
        let origin = (center.as_dvec3() + out * (r * ratio)).as_vec3();
        let from_center = origin.as_dvec3() - center.as_dvec3();
        let distance = from_center.length();
        let across = from_center.cross(rng.direction()).normalize_or(out.any_orthonormal_vector());
        let near_silhouette = f64::from(EPSILON) * distance * rng.signed() * rng.scale(0.1, 30.0);
        let impact = if i % 4 == 0 { r * rng.unit().sqrt() } else { (r + near_silhouette).abs() };
        let sin = (impact / distance).min(1.0);
        let away = if ratio <= 1.0 && i % 3 == 0 { -1.0 } else { 1.0 };
        let towards = across * sin - from_center / distance * ((1.0 - sin * sin).sqrt() * away);
        let direction = (towards * (1.0 + length)).as_vec3();
        let ray = ray(origin, direction);
        let (hit, t) =
            ray_sphere::intersect::<f32>(&ray, math::Vec3::splat(center), radius * radius, f32::INFINITY);
        if hit {
            check(&Found { center, radius, origin, direction, t });
        }
    }
}

/// Room for r and |c| is in the sphere's box, for |o| in the ray's padding: both together as much as the
/// distance needs, and not eight times as much.
#[test]
fn hits_lie_within_the_room_made_for_them_and_need_more_than_an_eighth_of_it() {
    let room_of = |origin: Vec3| {
        let origin = math::Vec3::<f32>::splat(origin);
        let spheres = Padding::new(0.0).with_spheres().room(origin) - Padding::new(0.0).room(origin);
        f64::from(spheres) * 0.5f64.powi(21)
    };
    // What the two make of a unit of distance alone, if the centre is the origin of the scene.
    let per_distance = room_of(Vec3::X);
    assert_eq!(f64::from(sphere_padding(Vec3::X, 0.0)), per_distance, "|c| needs as much as |o|");
    let per_radius = f64::from(sphere_padding(Vec3::ZERO, 1.0));
    let (mut worst, mut worst_length) = (0.0f64, 0.0f64);
    for length in LENGTHS {
        for distances in DISTANCES {
            let mut hits = 0;
            each_hit(91, 150_000, distances, length, |found| {
                let (excess, distance) = found.excess();
                hits += 1;
                let radius = f64::from(found.radius);
                assert!(excess <= per_radius * radius + per_distance * distance, "{:?}", found.direction);
                if length == 0.0 {
                    worst = worst.max(excess / distance);
                } else {
                    // What rounding does not explain, which the unit directions came first to tell.
                    worst_length = worst_length.max((excess - worst * distance) / radius);
                }
            });
            // With directions of another length spheres are lost from further than r / 2e.
            assert!(hits > 50_000 || (length != 0.0 && distances.1 > 1e4), "{distances:?}: {hits}");
        }
    }
    println!("worst: {:.2} ε D; for the length {:.1e} r", worst / f64::from(EPSILON), worst_length);
    assert!(worst > per_distance / 8.0, "{worst:e}");
    assert!((per_radius / 8.0..per_radius).contains(&worst_length), "{worst_length:e}");
}

/// Culling keeps every sphere that is hit, and the ray passes its box, by the numbers that traversals use.
#[test]
fn spheres_that_are_hit_are_not_culled_and_their_boxes_are_entered_no_later() {
    let corner = |v: Vec3| math::Vec3::<f32>::splat(v);
    let mut hits = 0;
    for (length, distances) in LENGTHS.into_iter().flat_map(|length| DISTANCES.map(|near| (length, near))) {
        each_hit(92, 100_000, distances, length, |&Found { center, radius, origin, direction, t }| {
            hits += 1;
            let ray = ray(origin, direction);
            let what = || format!("{origin} {direction} {center} {radius:e}");
            let is_kept = SphereCulling::<f32>::new(&ray).may_hit(&CulledSphere::new(center, radius));
            assert!(is_kept, "culled: {}", what());
            let bounds = Bounds::new(sphere_bounds(center, radius));
            let extent = bounds.lo.abs().max(bounds.hi.abs()).max_element();
            let slabs = BoxRay::new(&ray, Padding::new(extent).with_spheres());
            let (near, far) = slabs.pass(corner(bounds.lo), corner(bounds.hi));
            assert!(near <= far && far >= 0.0 && near <= t, "{}: {near} to {far}, hit at {t}", what());
        });
    }
    assert!(hits > 1_500_000, "{hits}");
}

/// Of spheres that a ray misses by a tenth of the radius and more, hardly any is kept, unless they are so far
/// away or so small that their square is lost beside the distance's.
#[test]
fn spheres_that_are_missed_are_culled() {
    let (mut rng, mut missed, mut kept) = (Rng(93), 0, 0);
    for _ in 0..200_000 {
        let radius = rng.scale(0.1, 10.0);
        let (center, origin) = (rng.in_cube() * 30.0, rng.in_cube() * 30.0);
        let direction = rng.direction();
        let from_center = origin - center;
        let ahead = (-from_center.dot(direction)).max(0.0);
        if (from_center + direction * ahead).length() < 1.1 * radius {
            continue;
        }
        let culling = SphereCulling::<f32>::new(&ray(origin.as_vec3(), direction.as_vec3()));
        missed += 1;
        kept += usize::from(culling.may_hit(&CulledSphere::new(center.as_vec3(), radius as f32)));
    }
    assert!(missed > 100_000 && kept < missed / 1000, "{kept} of {missed}");
}

/// What overflows is not culled, even where a sum of products would be ∞ − ∞, and neither is what is not a
/// number.
#[test]
fn spheres_beyond_the_range_of_squares_are_not_culled() {
    let far = vec3(3e18, 0.0, 0.0);
    let backwards = ray(far, Vec3::X);
    for (ray, center) in [
        (backwards, Vec3::ZERO),
        (ray(Vec3::ZERO, -Vec3::X), far),
        (ray(Vec3::ZERO, Vec3::NAN), Vec3::ONE),
        (ray(Vec3::NAN, Vec3::X), Vec3::ONE),
        (ray(Vec3::splat(3e38), vec3(0.6, -0.8, 0.0)), vec3(-1e14, 1e14, 1e14)),
        (ray(vec3(2e14, -2e14, 3.0), vec3(0.6, 0.8, 0.0)), vec3(3e38, -3e38, 3e38)),
        (ray(Vec3::splat(3e38), Vec3::X), Vec3::splat(-3e38)),
    ] {
        assert!(SphereCulling::<f32>::new(&ray).may_hit(&CulledSphere::new(center, 1.0)), "{ray:?} {center}");
    }
}
