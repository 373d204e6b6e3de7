//! The law of ray and box: the computed interval holds the true one, whatever the directions and scales, so no hit is lost; it is not much
//! larger; boxes within each other have intervals within each other, exactly; and packets agree with single rays in every bit.
//!
//! Judged by the slabs in f64, where differences of f32 numbers of one size are exact.

mod common;

use common::{Dice, packet, ray};
use glam::{DVec3, Vec3};
use octray::kernel::ray_box::{Reach, Slabs, own_box};
use octray::lane::{F32x8, Lane, Mask};
use octray::math::{self, Ray};

#[derive(Clone, Copy, Debug)]
struct Cuboid {
    lo: Vec3,
    hi: Vec3,
}

impl Cuboid {
    fn extent(&self) -> f32 {
        self.lo.abs().max(self.hi.abs()).max_element()
    }
    /// The box as one point sees it: in every axis the lower plane, the upper one, or between.
    fn point(&self, dice: &mut Dice) -> DVec3 {
        let (lo, hi) = (self.lo.as_dvec3(), self.hi.as_dvec3());
        let share = DVec3::from_array([(); 3].map(|()| match dice.index(3) {
            0 => 0.0,
            1 => 1.0,
            _ => dice.unit(),
        }));
        lo + (hi - lo) * share
    }
    /// Grown by as much on every side, in f64.
    fn grown(&self, by: f64) -> (DVec3, DVec3) {
        (self.lo.as_dvec3() - by, self.hi.as_dvec3() + by)
    }
}

/// Where the ray is in the box, by its t; the first is above the second where it misses.
fn truth((lo, hi): (DVec3, DVec3), origin: Vec3, direction: Vec3) -> (f64, f64) {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (f64::from(origin[axis]), f64::from(direction[axis]));
        if d == 0.0 {
            if o < lo[axis] || o > hi[axis] {
                return (f64::INFINITY, f64::NEG_INFINITY);
            }
        } else {
            let (a, b) = ((lo[axis] - o) / d, (hi[axis] - o) / d);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
    }
    (near, far)
}

fn corner<L: Lane>(v: Vec3) -> math::Vec3<L> {
    math::Vec3::splat(v)
}

fn computed(cuboid: Cuboid, extent: f32, ray: &Ray<f32>) -> (f32, f32) {
    Slabs::new(ray, Reach::new(extent)).pass(corner(cuboid.lo), corner(cuboid.hi))
}

/// A box of any size and place within ±`scale`, flat ones among them.
fn cuboid(dice: &mut Dice, scale: f64) -> Cuboid {
    let center = dice.in_cube() * scale;
    let half = DVec3::from_array([(); 3].map(|()| match dice.index(5) {
        0 => 0.0,
        _ => 0.5 * dice.scale(1e-6, 1.0) * scale,
    }));
    Cuboid { lo: (center - half).as_vec3(), hi: (center + half).as_vec3() }
}

/// Components that divide by zero, or nearly.
const AWKWARD: [f32; 10] =
    [0.0, -0.0, 1e-17, -1e-17, 1e-18, -1e-19, 1e-40, -1e-40, f32::from_bits(1), -1e-30];

/// A ray towards a point of the box, often a corner or a point of an edge; often with components next to zero, and then often in the plane
/// of a face.
fn aimed(dice: &mut Dice, cuboid: &Cuboid, scale: f64) -> Ray<f32> {
    let target = cuboid.point(dice);
    let mut origin = match dice.index(4) {
        0 => cuboid.point(dice).as_vec3(),
        1 => (dice.in_cube() * (100.0 * scale)).as_vec3(),
        _ => (dice.in_cube() * (2.0 * scale)).as_vec3(),
    };
    let mut direction = (target - origin.as_dvec3()).normalize_or(dice.direction()).as_vec3();
    if dice.index(2) == 0 {
        let first = dice.index(3);
        for axis in [first, (first + 1) % 3].into_iter().take(1 + dice.index(2)) {
            direction[axis] = AWKWARD[dice.index(AWKWARD.len())];
            origin[axis] = target[axis] as f32;
        }
        direction = direction.as_dvec3().normalize_or(DVec3::X).as_vec3();
    }
    ray(origin, direction)
}

const SCALES: [f64; 7] = [1e-15, 1e-6, 1e-2, 1.0, 1e3, 1e6, 1e15];

#[test]
fn the_interval_holds_the_true_one_at_all_scales() {
    let mut dice = Dice(71);
    let (mut hits, mut rays) = (0, 0);
    for scale in SCALES {
        for _ in 0..150_000 {
            let cuboid = cuboid(&mut dice, scale);
            let ray = aimed(&mut dice, &cuboid, scale);
            let (origin, direction) = (ray.origin.get(0), ray.direction.get(0));
            let (enter, leave) = truth(cuboid.grown(0.0), origin, direction);
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

/// What is further off than two paddings is missed: were the padding four times larger, a part of these rays would pass.
#[test]
fn boxes_that_are_missed_by_two_paddings_are_missed() {
    let mut dice = Dice(72);
    let (mut misses, mut close) = (0, 0);
    for scale in SCALES {
        for _ in 0..100_000 {
            let cuboid = cuboid(&mut dice, scale);
            let origin = (dice.in_cube() * (4.0 * scale)).as_vec3();
            let padding = f64::from(origin.abs().max_element() + cuboid.extent()) * 0.5f64.powi(21);
            let outwards = DVec3::from_array([(); 3].map(|()| dice.signed().signum()));
            let target = cuboid.point(&mut dice) + outwards * (padding * 6.0 * dice.unit());
            let direction = (target - origin.as_dvec3()).normalize_or(DVec3::X).as_vec3();
            let meets = |by: f64| {
                let (enter, leave) = truth(cuboid.grown(by * padding), origin, direction);
                enter <= leave && leave >= 0.0
            };
            if !meets(2.0) {
                misses += 1;
                close += usize::from(meets(3.0));
                let ray = ray(origin, direction);
                let (near, far) = computed(cuboid, cuboid.extent(), &ray);
                assert!(near > far || far < 0.0, "{cuboid:?}, {ray:?}: {near} to {far}");
            }
        }
    }
    assert!(misses > 50_000 && close > 5_000, "{misses}, {close} of them close");
}

/// Planes between, or the same, or one number further in.
fn within(dice: &mut Dice, outer: Cuboid) -> Cuboid {
    let mut inner = outer;
    for axis in 0..3 {
        let (lo, hi) = (outer.lo[axis], outer.hi[axis]);
        let mut between = || (lo + (hi - lo) * dice.unit() as f32).clamp(lo, hi);
        let (a, b) = (between(), between());
        (inner.lo[axis], inner.hi[axis]) = match dice.index(4) {
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
    let mut dice = Dice(73);
    for scale in SCALES {
        for _ in 0..60_000 {
            let outer = cuboid(&mut dice, scale);
            let inner = within(&mut dice, outer);
            let ray = aimed(&mut dice, &inner, scale);
            let slabs = Slabs::new(&ray, Reach::new(outer.extent()));
            let of = |cuboid: Cuboid| slabs.pass(corner::<f32>(cuboid.lo), corner(cuboid.hi));
            let ((near, far), (near_inner, far_inner)) = (of(outer), of(inner));
            assert!(near <= near_inner && far_inner <= far, "{inner:?} in {outer:?}, {ray:?}");
            // However far off t is.
            let claimed = near_inner * (0.5 + dice.unit() as f32) + (dice.signed() * scale) as f32;
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
    let mut dice = Dice(74);
    let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    for round in 0..20_000 {
        let scale = SCALES[round % SCALES.len()];
        let cuboids: [Cuboid; 8] = std::array::from_fn(|_| cuboid(&mut dice, scale));
        let mut rays: [Ray<f32>; 8] = std::array::from_fn(|lane| aimed(&mut dice, &cuboids[lane], scale));
        if round % 10 == 0 {
            rays[dice.index(8)].direction.y = f32::NAN;
            rays[dice.index(8)].origin.z = f32::INFINITY;
        }
        let mut reach = Reach::new(cuboids[0].extent());
        if round % 2 == 0 {
            reach = reach.with_spheres();
        }
        let column = |of: fn(&Cuboid) -> Vec3| {
            let axis = |axis: usize| F32x8::from_fn(|lane| of(&cuboids[lane])[axis]);
            math::Vec3::new(axis(0), axis(1), axis(2))
        };
        let corners = (column(|cuboid| cuboid.lo), column(|cuboid| cuboid.hi));
        let slabs = Slabs::new(&packet::<F32x8>(&rays), reach);
        let (near, far) = slabs.pass(corners.0, corners.1);
        let (claimed, limit) = (scale as f32, 2.0 * scale as f32);
        let mask = <F32x8 as Lane>::Mask::splat(true);
        let (hit, t) = own_box(&slabs, corners, mask, F32x8::splat(claimed), F32x8::splat(limit));
        for lane in 0..8 {
            let single = Slabs::new(&rays[lane], reach);
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

#[test]
fn empty_boxes_are_never_passed_and_rays_of_nan_pass_no_box() {
    let mut dice = Dice(75);
    let empty = Cuboid { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };
    let passes = |slabs: &Slabs<f32>, Cuboid { lo, hi }: Cuboid| {
        let (near, far) = slabs.pass(corner(lo), corner(hi));
        near <= far
    };
    for round in 0..50_000 {
        let scale = SCALES[round % SCALES.len()];
        let around = Cuboid { lo: Vec3::splat(-200.0 * scale as f32), hi: Vec3::splat(200.0 * scale as f32) };
        let sound = aimed(&mut dice, &around, scale);
        for reach in [Reach::new(scale as f32), Reach::new(scale as f32).with_spheres()] {
            let slabs = Slabs::new(&sound, reach);
            assert!(passes(&slabs, around) && !passes(&slabs, empty), "{sound:?}");
            for number in 0..6 {
                let (mut origin, mut direction) = (sound.origin.get(0), sound.direction.get(0));
                let component = if number < 3 { &mut origin[number] } else { &mut direction[number - 3] };
                *component = f32::NAN;
                let slabs = Slabs::new(&ray(origin, direction), reach);
                assert!(!passes(&slabs, around) && !passes(&slabs, empty), "{origin} along {direction}");
            }
            let nothing = Slabs::new(&ray(Vec3::NAN, Vec3::NAN), reach);
            assert!(!passes(&nothing, around) && !passes(&nothing, empty));
        }
    }
}
