//! Boxes at corners and edges, in the planes of faces, far from the origin, at all scales; and how much is let through beside them.
//!
//! Source: Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.

use super::aim::{exactly, ray, towards};
use super::methods::box_methods;
use super::{Bound, Dice, Recipe, Tally};
use crate::kernel::ray_box::{BoxMethod, Padding};
use crate::math::{self, Ray};
use glam::{DVec3, Vec3};

const IZE: &str = "Ize, Robust BVH Ray Traversal, JCGT 2(2), 2013";
const FALSE_MISS: &str = "a box that is hit is missed";

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "boxes-corners",
        title: "Rays aimed at corners of boxes, away from the origin of coordinates",
        axis: "distance of the box from the origin / its size",
        places: &[0.0, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6],
        failure: FALSE_MISS,
        error: Some("|Δt| of where the ray enters / t"),
        source: IZE,
        cases: 100_000,
        methods: &box_methods!(at_corners),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "boxes-faces",
        title: "Rays that start in the plane of a face and run along it",
        axis: "component of the direction across the face",
        places: &[0.0, 1e-44, 1e-39, 1e-30, 1e-20, 1e-17, 1e-12, 1e-8, 1e-6, 1e-4],
        failure: FALSE_MISS,
        error: None,
        source: IZE,
        cases: 100_000,
        methods: &box_methods!(along_faces),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "boxes-scale",
        title: "Boxes of all sizes, flat ones among them, and directions next to an axis",
        axis: "size of the scene",
        places: &SCALES,
        failure: FALSE_MISS,
        error: None,
        source: IZE,
        cases: 100_000,
        methods: &box_methods!(at_scale),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "boxes-beside",
        title: "The price: rays that miss a box by little",
        axis: "distance of ray and box / padding of the default method",
        places: &[0.01, 0.03, 0.1, 0.3, 1.0, 2.0, 10.0, 100.0],
        failure: "a box that is missed is passed",
        error: None,
        source: "this program",
        cases: 50_000,
        methods: &box_methods!(beside),
        bound: |off| if off < 2.0 { Bound::NONE } else { Bound::NO_FAILURE },
    },
];

/// Scene sizes from tiny to huge.
pub const SCALES: [f64; 7] = [1e-15, 1e-6, 1e-2, 1.0, 1e3, 1e6, 1e15];

/// A box of single precision.
#[derive(Clone, Copy, Debug)]
pub struct Cuboid {
    pub lo: Vec3,
    pub hi: Vec3,
}

impl Cuboid {
    /// Of any size and place within ±`scale`, flat ones among them.
    pub fn random(dice: &mut Dice, scale: f64) -> Self {
        let center = dice.in_cube() * scale;
        let half = DVec3::from_array([(); 3].map(|()| match dice.index(5) {
            0 => 0.0,
            _ => 0.5 * dice.scale(1e-6, 1.0) * scale,
        }));
        Self { lo: (center - half).as_vec3(), hi: (center + half).as_vec3() }
    }
    /// The largest absolute coordinate.
    pub fn extent(&self) -> f32 {
        self.lo.abs().max(self.hi.abs()).max_element()
    }
    /// A corner, or a point of an edge, a face or the inside: in every axis the lower plane, the upper one, or between.
    pub fn point(&self, dice: &mut Dice) -> DVec3 {
        let (lo, hi) = (self.lo.as_dvec3(), self.hi.as_dvec3());
        let share = DVec3::from_array([(); 3].map(|()| match dice.index(3) {
            0 => 0.0,
            1 => 1.0,
            _ => dice.unit(),
        }));
        lo + (hi - lo) * share
    }
    fn corner(&self, dice: &mut Dice) -> DVec3 {
        let share = DVec3::from_array([(); 3].map(|()| dice.index(2) as f64));
        self.lo.as_dvec3() + (self.hi.as_dvec3() - self.lo.as_dvec3()) * share
    }
    /// Grown by as much on every side, in f64.
    pub fn grown(&self, by: f64) -> (DVec3, DVec3) {
        (self.lo.as_dvec3() - by, self.hi.as_dvec3() + by)
    }
}

/// The judge: where the ray is in the box, by its t; the first is above the second where it misses. In f64, where differences of f32
/// numbers of one size are exact.
pub fn truth((lo, hi): (DVec3, DVec3), ray: &Ray<f32>) -> (f64, f64) {
    let (origin, direction) = exactly(ray);
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
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

/// Does the ray meet what lies between these corners, in front of its origin?
pub fn meets(corners: (DVec3, DVec3), ray: &Ray<f32>) -> bool {
    let (enter, leave) = truth(corners, ray);
    enter <= leave && leave >= 0.0
}

/// The padding that the default method gives a box, in scene units along each axis: see [`crate::kernel::ray_box::Slabs::new`].
pub fn padding(cuboid: &Cuboid, origin: Vec3) -> f64 {
    f64::from(origin.abs().max_element() + cuboid.extent()) * 0.5f64.powi(21)
}

/// Components that divide by zero, or nearly.
const AWKWARD: [f32; 10] =
    [0.0, -0.0, 1e-17, -1e-17, 1e-18, -1e-19, 1e-40, -1e-40, f32::from_bits(1), -1e-30];

/// A ray towards a point of the box, often a corner or a point of an edge; often with components next to zero, and then often in the plane
/// of a face.
pub fn aimed(dice: &mut Dice, cuboid: &Cuboid, scale: f64) -> Ray<f32> {
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

/// A ray that misses the box by `by` paddings at least, and by hardly more than twice as many; `None` if this throw went astray.
pub fn passing(dice: &mut Dice, cuboid: &Cuboid, scale: f64, by: f64) -> Option<Ray<f32>> {
    let origin = (dice.in_cube() * (4.0 * scale)).as_vec3();
    let padding = padding(cuboid, origin);
    let outwards = DVec3::from_array([(); 3].map(|()| dice.signed().signum()));
    let target = cuboid.point(dice) + outwards * (padding * by * (1.0 + 2.0 * dice.unit()));
    let direction = (target - origin.as_dvec3()).normalize_or(DVec3::X).as_vec3();
    let ray = ray(origin, direction);
    (!meets(cuboid.grown(by * padding), &ray)).then_some(ray)
}

/// Where the method says that the ray enters the box, if it passes it.
fn answer<B: BoxMethod>(cuboid: &Cuboid, ray: &Ray<f32>) -> Option<f32> {
    let prepared = B::prepare(ray, Padding::new(cuboid.extent()));
    let (near, far) = B::pass(&prepared, math::Vec3::splat(cuboid.lo), math::Vec3::splat(cuboid.hi));
    (near <= far && far >= 0.0).then_some(near)
}

/// Counts a ray, if it truly hits the box.
fn count<B: BoxMethod>(tally: &mut Tally, cuboid: &Cuboid, ray: &Ray<f32>) {
    if meets(cuboid.grown(0.0), ray) {
        tally.count(answer::<B>(cuboid, ray).is_none());
    }
}

/// From up to four sizes away.
fn at_corners<B: BoxMethod>(dice: &mut Dice, offset: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let center = dice.direction() * offset;
        let half = DVec3::from_array([(); 3].map(|()| 0.05 + 0.45 * dice.unit()));
        let cuboid = Cuboid { lo: (center - half).as_vec3(), hi: (center + half).as_vec3() };
        let origin = (center + dice.in_cube() * 4.0).as_vec3();
        let ray = towards(origin, cuboid.corner(dice));
        // Rounding of the direction takes about half of them outside.
        let (enter, leave) = truth(cuboid.grown(0.0), &ray);
        if enter <= leave && enter > 0.0 {
            match answer::<B>(&cuboid, &ray) {
                Some(near) => tally.off_by((f64::from(near) / enter - 1.0).abs()),
                None => tally.count(true),
            }
        }
    }
    tally
}

/// The component across the face is as it is said, of either sign; both faces of each axis by turns.
fn along_faces<B: BoxMethod>(dice: &mut Dice, across: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let center = dice.in_cube();
        let half = DVec3::from_array([(); 3].map(|()| 0.05 + 0.45 * dice.unit()));
        let cuboid = Cuboid { lo: (center - half).as_vec3(), hi: (center + half).as_vec3() };
        let axis = dice.index(3);
        let mut origin = (dice.in_cube() * 4.0).as_vec3();
        origin[axis] = [cuboid.lo, cuboid.hi][dice.index(2)][axis];
        let mut target = center + half * dice.in_cube();
        target[axis] = f64::from(origin[axis]);
        let mut direction = (target - origin.as_dvec3()).normalize_or(DVec3::X).as_vec3();
        direction[axis] = across as f32 * [1.0, -1.0][dice.index(2)];
        count::<B>(&mut tally, &cuboid, &ray(origin, direction));
    }
    tally
}

fn at_scale<B: BoxMethod>(dice: &mut Dice, scale: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let cuboid = Cuboid::random(dice, scale);
        let ray = aimed(dice, &cuboid, scale);
        count::<B>(&mut tally, &cuboid, &ray);
    }
    tally
}

fn beside<B: BoxMethod>(dice: &mut Dice, off: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let cuboid = Cuboid::random(dice, 1.0);
        if let Some(ray) = passing(dice, &cuboid, 1.0, off) {
            tally.count(answer::<B>(&cuboid, &ray).is_some());
        }
    }
    tally
}
