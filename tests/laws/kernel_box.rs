//! The law of ray and box: the computed interval holds the true one, whatever the directions and scales, so
//! no hit is lost; it is not much larger; boxes within each other have intervals within each other, exactly.
//! (Packets and single rays: `tests/laws/lane_parity.rs`.)
//!
//! Judged by the slabs in f64, where differences of f32 numbers of one size are exact.

use crate::common::*;
use octray::kernel::ray_box::{BoxRay, Padding, own_box};
use octray::measure::stability::boxes::{Cuboid, SCALES, aimed, meets, padding, passing, reference_interval};

fn corner<L: Lane>(v: Vec3) -> math::Vec3<L> {
    math::Vec3::splat(v)
}

fn computed(cuboid: Cuboid, extent: f32, ray: &Ray<f32>) -> (f32, f32) {
    BoxRay::new(ray, Padding::new(extent)).pass(corner(cuboid.lo), corner(cuboid.hi))
}

#[test]
fn the_interval_holds_the_true_one_at_all_scales() {
    let mut rng = Rng(71);
    let (mut hits, mut rays) = (0, 0);
    for scale in SCALES {
        for _ in 0..150_000 {
            let cuboid = Cuboid::random(&mut rng, scale);
            let ray = aimed(&mut rng, &cuboid, scale);
            let (enter, leave) = reference_interval(cuboid.grown(0.0), &ray);
            rays += 1;
            if enter <= leave && leave >= 0.0 {
                hits += 1;
                let (near, far) = computed(cuboid, cuboid.extent(), &ray);
                let holds = f64::from(near) <= enter.max(0.0) && leave <= f64::from(far);
                assert!(holds, "{cuboid:?}, {ray:?}: {near} to {far}, truly {enter} to {leave}");
            }
        }
    }
    // Aimed at the outermost, rounding lets half of them miss.
    assert!(hits * 3 > rays, "{hits} of {rays}");
}

/// What is further off than two paddings is missed: were the padding four times larger, a part of these rays
/// would pass.
#[test]
fn boxes_that_are_missed_by_two_paddings_are_missed() {
    let mut rng = Rng(72);
    let (mut misses, mut close) = (0, 0);
    for scale in SCALES {
        for _ in 0..100_000 {
            let cuboid = Cuboid::random(&mut rng, scale);
            if let Some(ray) = passing(&mut rng, &cuboid, scale, 2.0) {
                misses += 1;
                let padding = padding(&cuboid, ray.origin.get(0));
                close += usize::from(meets(cuboid.grown(3.0 * padding), &ray));
                let (near, far) = computed(cuboid, cuboid.extent(), &ray);
                assert!(near > far || far < 0.0, "{cuboid:?}, {ray:?}: {near} to {far}");
            }
        }
    }
    assert!(misses > 50_000 && close > 5_000, "{misses}, {close} of them close");
}

/// Planes between, or the same, or one number further in.
fn within(rng: &mut Rng, outer: Cuboid) -> Cuboid {
    let mut inner = outer;
    for axis in 0..3 {
        let (lo, hi) = (outer.lo[axis], outer.hi[axis]);
        let mut between = || (lo + (hi - lo) * rng.unit() as f32).clamp(lo, hi);
        let (a, b) = (between(), between());
        (inner.lo[axis], inner.hi[axis]) = match rng.index(4) {
            0 => (lo, hi),
            1 => (lo.next_up().min(hi), hi),
            2 => (lo, hi.next_down().max(lo)),
            _ => (a.min(b), a.max(b)),
        };
    }
    inner
}

#[test]
fn nested_boxes_have_nested_intervals_and_a_hit_in_one_is_in_all_around_it() {
    let mut rng = Rng(73);
    for scale in SCALES {
        for _ in 0..60_000 {
            let outer = Cuboid::random(&mut rng, scale);
            let inner = within(&mut rng, outer);
            let ray = aimed(&mut rng, &inner, scale);
            let slabs = BoxRay::new(&ray, Padding::new(outer.extent()));
            let of = |cuboid: Cuboid| slabs.pass(corner::<f32>(cuboid.lo), corner(cuboid.hi));
            let ((near, far), (near_inner, far_inner)) = (of(outer), of(inner));
            assert!(near <= near_inner && far_inner <= far, "{inner:?} in {outer:?}, {ray:?}");
            // However far off t is.
            let claimed = near_inner * (0.5 + rng.unit() as f32) + (rng.signed() * scale) as f32;
            let corners = (corner(inner.lo), corner(inner.hi));
            let (hit, t) = own_box(&slabs, corners, true, claimed, f32::INFINITY);
            assert!(!hit || (near <= t && t <= far && t > 0.0), "{claimed} became {t}");
            // A hit is lost only where the box is, or behind the origin.
            assert_eq!(hit, near_inner <= far_inner && t > 0.0);
            assert!(!own_box(&slabs, corners, false, claimed, f32::INFINITY).0);
            assert!(!own_box(&slabs, corners, true, claimed, t).0, "a hit at the limit is none");
        }
    }
}

/// Planes in the order in which the ray meets them give the same as the box itself.
#[test]
fn ordered_planes_have_the_interval_of_their_box() {
    let mut rng = Rng(74);
    for round in 0..50_000 {
        let scale = SCALES[round % SCALES.len()];
        let cuboid = Cuboid::random(&mut rng, scale);
        let slabs = BoxRay::new(&aimed(&mut rng, &cuboid, scale), Padding::new(cuboid.extent()));
        let inverse = slabs.inverse.get(0);
        let planes = |first: bool| {
            let Cuboid { lo, hi } = cuboid;
            let plane = |axis: usize| if (inverse[axis] < 0.0) == first { hi[axis] } else { lo[axis] };
            math::Vec3::new(plane(0), plane(1), plane(2))
        };
        let whole = slabs.pass(corner::<f32>(cuboid.lo), corner(cuboid.hi));
        assert_eq!(slabs.interval(planes(true), planes(false)), whole, "{cuboid:?}");
    }
}

#[test]
fn empty_boxes_are_never_passed_and_rays_of_nan_pass_no_box() {
    let mut rng = Rng(75);
    let empty = Cuboid { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };
    let passes = |slabs: &BoxRay<f32>, Cuboid { lo, hi }: Cuboid| {
        let (near, far) = slabs.pass(corner(lo), corner(hi));
        near <= far
    };
    for round in 0..50_000 {
        let scale = SCALES[round % SCALES.len()];
        let around = Cuboid { lo: Vec3::splat(-200.0 * scale as f32), hi: Vec3::splat(200.0 * scale as f32) };
        let sound = aimed(&mut rng, &around, scale);
        for padding in [Padding::new(scale as f32), Padding::new(scale as f32).with_spheres()] {
            let slabs = BoxRay::new(&sound, padding);
            assert!(passes(&slabs, around) && !passes(&slabs, empty), "{sound:?}");
            for number in 0..6 {
                let (mut origin, mut direction) = (sound.origin.get(0), sound.direction.get(0));
                let component = if number < 3 { &mut origin[number] } else { &mut direction[number - 3] };
                *component = f32::NAN;
                let slabs = BoxRay::new(&ray(origin, direction), padding);
                assert!(!passes(&slabs, around) && !passes(&slabs, empty), "{origin} along {direction}");
            }
            let nothing = BoxRay::new(&ray(Vec3::NAN, Vec3::NAN), padding);
            assert!(!passes(&nothing, around) && !passes(&nothing, empty));
        }
    }
}
