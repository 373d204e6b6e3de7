//! The law of ray and box: the computed interval holds the true one, whatever the directions and scales, so
//! no hit is lost; it is not much larger; boxes within each other have intervals within each other, exactly;
//! and packets agree with single rays in every bit.
//!
//! Judged by the slabs in f64, where differences of f32 numbers of one size are exact.

use crate::common::*;
use octray::kernel::ray_box::{BoxRay, Padding, own_box};
use octray::measure::stability::boxes::{Cuboid, SCALES, aimed, meets, padding, passing, reference_interval};
use octray::methods::{BoxMethod, BySign, BySignWidened, Contracted, IeeeMinMax, Padded, X86MinMax};

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

#[test]
fn packets_agree_with_single_rays_in_every_bit() {
    fn check<L: Lane>() {
        let mut rng = Rng(74);
        let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        for round in 0..10_000 {
            let scale = SCALES[round % SCALES.len()];
            let cuboids: [Cuboid; 16] = std::array::from_fn(|_| Cuboid::random(&mut rng, scale));
            let mut rays: [Ray<f32>; 16] = std::array::from_fn(|lane| aimed(&mut rng, &cuboids[lane], scale));
            if round % 10 == 0 {
                rays[rng.index(L::WIDTH)].direction.y = f32::NAN;
                rays[rng.index(L::WIDTH)].origin.z = f32::INFINITY;
            }
            let mut padding = Padding::new(cuboids[0].extent());
            if round % 2 == 0 {
                padding = padding.with_spheres();
            }
            let column = |of: fn(&Cuboid) -> Vec3| {
                let axis = |axis: usize| L::from_fn(|lane| of(&cuboids[lane])[axis]);
                math::Vec3::new(axis(0), axis(1), axis(2))
            };
            let corners = (column(|cuboid| cuboid.lo), column(|cuboid| cuboid.hi));
            let slabs = BoxRay::new(&Ray::<L>::from_lanes(&rays), padding);
            let (near, far) = slabs.pass(corners.0, corners.1);
            let (claimed, limit) = (scale as f32, 2.0 * scale as f32);
            let mask = L::Mask::splat(true);
            let (hit, t) = own_box(&slabs, corners, mask, L::splat(claimed), L::splat(limit));
            for lane in 0..L::WIDTH {
                let single = BoxRay::new(&rays[lane], padding);
                let Cuboid { lo, hi } = cuboids[lane];
                let (near_one, far_one) = single.pass(corner(lo), corner(hi));
                assert!(same(near.get(lane), near_one) && same(far.get(lane), far_one), "{:?}", rays[lane]);
                let (hit_one, t_one) = own_box(&single, (corner(lo), corner(hi)), true, claimed, limit);
                assert_eq!(hit.bitmask() >> lane & 1 == 1, hit_one);
                assert!(same(t.get(lane), t_one));
                // Planes in the order in which the ray meets them give the same as the box itself.
                let ordered = |first: bool| {
                    let pick = |axis: usize, inverse: f32| {
                        if (inverse < 0.0) == first { hi[axis] } else { lo[axis] }
                    };
                    let inverse = single.inverse;
                    math::Vec3::new(pick(0, inverse.x), pick(1, inverse.y), pick(2, inverse.z))
                };
                let (near_ordered, far_ordered) = single.interval(ordered(true), ordered(false));
                assert!(same(near_ordered, near_one) && same(far_ordered, far_one));
            }
        }
    }
    check::<F32x8>();
    check::<F32x16>();
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

/// The other forms too, NaN and infinities included.
#[test]
fn every_method_gives_packets_the_bits_of_single_rays() {
    fn check<B: BoxMethod>() {
        at_width::<B, F32x8>();
        at_width::<B, F32x16>();
    }
    fn at_width<B: BoxMethod, L: Lane>() {
        let mut rng = Rng(76);
        let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        for round in 0..2_000 {
            let scale = SCALES[round % SCALES.len()];
            let cuboid = Cuboid::random(&mut rng, scale);
            let rays: [Ray<f32>; 16] = std::array::from_fn(|_| aimed(&mut rng, &cuboid, scale));
            let padding = Padding::new(cuboid.extent());
            let packet = B::precalculate(&Ray::<L>::from_lanes(&rays), padding);
            let (near, far) = B::pass(&packet, corner(cuboid.lo), corner(cuboid.hi));
            for (lane, ray) in rays.iter().enumerate().take(L::WIDTH) {
                let single = B::pass(&B::precalculate(ray, padding), corner(cuboid.lo), corner(cuboid.hi));
                assert!(same(near.get(lane), single.0) && same(far.get(lane), single.1), "{ray:?}");
            }
        }
    }
    check::<Padded>();
    check::<BySign>();
    check::<BySignWidened>();
    check::<Contracted>();
    check::<X86MinMax>();
    check::<IeeeMinMax>();
}
