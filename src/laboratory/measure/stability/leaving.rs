//! Leaving triangles: rays that hit again what they leave.
//!
//! Source: Wächter, Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch. 6, 2019.

use super::aim::{ray, towards};
use super::{Bound, Dice, Recipe, Tally, triangles};
use crate::kernel::ray_triangle::Woop;
use crate::kernel::surface::{triangle_normal, triangle_offset};
use crate::math;
use crate::sampling::warp::sample_cosine_hemisphere;
use glam::Vec3;

pub(super) const WAECHTER: &str = "Wächter, Binder, Ray Tracing Gems ch. 6, 2019";
pub(super) const AGAIN: &str = "the surface that is left is hit again";

/// The ways of leaving, for a function that is generic over the number of one in [`Way::ALL`].
macro_rules! ways {
    ($run:ident) => {
        [
            $crate::measure::stability::Method::default("exact point, error bound", $run::<0>),
            $crate::measure::stability::Method::other("o + t d, error bound", $run::<1>),
            $crate::measure::stability::Method::other("exact point, 1e-4", $run::<2>),
            $crate::measure::stability::Method::other("o + t d, t > 1e-4", $run::<3>),
            $crate::measure::stability::Method::other("exact point, no offset", $run::<4>),
            $crate::measure::stability::Method::other("o + t d, no offset", $run::<5>),
        ]
    };
}
pub(super) use ways;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "leaving-place",
        title: "Leaving triangles with edges of 1",
        axis: "distance of the triangle from the origin",
        places: &[0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
        failure: AGAIN,
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &ways!(from_place),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "leaving-size",
        title: "Leaving triangles at a distance of 1 from the origin",
        axis: "edge of the triangle",
        places: &[1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
        failure: AGAIN,
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &ways!(of_size),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "leaving-travelled",
        title: "Leaving triangles with edges of 1, at a distance of 1 from the origin, after a long way",
        axis: "distance that the ray has travelled",
        places: &[0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
        failure: AGAIN,
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &ways!(after_way),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "leaving-slivers",
        title: "Leaving slivers with edges of 1",
        axis: "usual height / height",
        places: &[1.0, 10.0, 100.0, 1e3, 1e4],
        failure: AGAIN,
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &ways!(of_slivers),
        bound: |_| Bound::NO_FAILURE,
    },
];

/// Where a ray starts that leaves a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// The point is found again from what is exact about the surface, and not as o + t d.
    pub exact: bool,
    pub offset: Offset,
    /// Hits before this t do not count.
    pub least: f32,
}

/// How far along the normal a ray starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// This share of the error bound of [`crate::kernel::surface`].
    Bound(f32),
    /// Scene units.
    Constant(f32),
}

impl Way {
    /// In the order of `ways`: the pipeline's own first.
    pub const ALL: [Self; 6] = [
        Self::with(true, Offset::Bound(1.0), 0.0),
        Self::with(false, Offset::Bound(1.0), 0.0),
        Self::with(true, Offset::Constant(1e-4), 0.0),
        Self::with(false, Offset::Bound(0.0), 1e-4),
        Self::with(true, Offset::Bound(0.0), 0.0),
        Self::with(false, Offset::Bound(0.0), 0.0),
    ];

    const fn with(exact: bool, offset: Offset, least: f32) -> Self {
        Self { exact, offset, least }
    }
    /// The pipeline's, with this share of the offset.
    pub const fn share(share: f32) -> Self {
        Self::with(true, Offset::Bound(share), 0.0)
    }
    /// The point from where the ray leaves, on the side of the unit vector `n`; `bound` is the surface's error bound.
    pub fn start(self, exact: Vec3, along: Vec3, n: Vec3, bound: f32) -> Vec3 {
        let point = if self.exact { exact } else { along };
        let offset = match self.offset {
            Offset::Bound(share) => bound * share,
            Offset::Constant(offset) => offset,
        };
        let [n, point] = [n, point].map(math::Vec3::<f32>::splat);
        n.mul_add(offset, point).get(0)
    }
}

/// A unit direction on the side of `n`, a unit vector: drawn as diffuse surfaces draw, or with a cosine from 1 down to 1e-6.
pub fn leaving(dice: &mut Dice, n: Vec3) -> Vec3 {
    if dice.index(2) == 0 {
        let [u, v] = [(); 2].map(|()| (dice.unit() as f32).min(1.0_f32.next_down()));
        return sample_cosine_hemisphere::<f32>(math::Vec3::splat(n), u, v).get(0);
    }
    loop {
        let cos = dice.scale(1e-6, 1.0);
        let across = n.as_dvec3().cross(dice.direction()).normalize();
        let direction = (across * (1.0 - cos * cos).sqrt() + n.as_dvec3() * cos).as_vec3();
        // Rounding may have put it below.
        if direction.as_dvec3().dot(n.as_dvec3()) > 0.0 {
            return direction;
        }
    }
}

/// The distance that rays travel before they leave, in sizes, where it is not what a recipe is about.
pub(super) const TRAVELLED: [f64; 2] = [0.5, 5.0];

/// Counts rays that leave a triangle and hit it again: eight rays arrive at it, from so near to so far, and leave on both sides.
pub fn leave_triangle(
    tally: &mut Tally,
    dice: &mut Dice,
    vertices: [Vec3; 3],
    [near, far]: [f64; 2],
    way: Way,
) {
    let [a, b, c] = vertices.map(|v| v.as_dvec3());
    let (normal, bound) = (triangle_normal(vertices), triangle_offset(vertices));
    let [start, ab, ac] =
        [vertices[0], vertices[1] - vertices[0], vertices[2] - vertices[0]].map(math::Vec3::<f32>::splat);
    for _ in 0..8 {
        let weights = dice.barycentrics();
        let target = a * weights[0] + b * weights[1] + c * weights[2];
        let distance = dice.scale(near, far);
        let arriving = towards((target + dice.direction() * distance).as_vec3(), target);
        let Some([t, u, v]) = triangles::answer::<Woop>(vertices, &arriving, f32::INFINITY) else { continue };
        let exact = ab.mul_add(u, ac.mul_add(v, start)).get(0);
        for n in [normal, -normal] {
            let origin = way.start(exact, arriving.at(t).get(0), n, bound);
            let next = ray(origin, leaving(dice, n));
            let again = triangles::answer::<Woop>(vertices, &next, f32::INFINITY);
            tally.count(again.is_some_and(|[t, ..]| t > way.least));
        }
    }
}

/// A triangle with edges of about `size`, `place` from the origin, its height divided by `flat`; none if single precision leaves it
/// hardly an area, as such are refused at load.
pub fn triangle(dice: &mut Dice, size: f64, place: f64, flat: f64) -> Option<[Vec3; 3]> {
    let center = dice.direction() * place;
    let [a, b, c] = [(); 3].map(|()| center + dice.in_cube() * (0.6 * size));
    let foot = a.lerp(b, dice.unit());
    let vertices = [a, b, foot + (c - foot) / flat].map(|v| v.as_vec3());
    let [a, b, c] = vertices.map(|v| v.as_dvec3());
    ((b - a).cross(c - a).length() >= 1e-6 * size * size).then_some(vertices)
}

fn leave_triangles(dice: &mut Dice, [size, place, flat]: [f64; 3], cases: usize, way: Way) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        if let Some(vertices) = triangle(dice, size, place, flat) {
            leave_triangle(&mut tally, dice, vertices, TRAVELLED.map(|travelled| travelled * size), way);
        }
    }
    tally
}

fn from_place<const WAY: usize>(dice: &mut Dice, place: f64, cases: usize) -> Tally {
    leave_triangles(dice, [1.0, place, 1.0], cases, Way::ALL[WAY])
}

fn of_size<const WAY: usize>(dice: &mut Dice, size: f64, cases: usize) -> Tally {
    leave_triangles(dice, [size, 1.0, 1.0], cases, Way::ALL[WAY])
}

fn after_way<const WAY: usize>(dice: &mut Dice, travelled: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        if let Some(vertices) = triangle(dice, 1.0, 1.0, 1.0) {
            leave_triangle(&mut tally, dice, vertices, [travelled; 2], Way::ALL[WAY]);
        }
    }
    tally
}

fn of_slivers<const WAY: usize>(dice: &mut Dice, flat: f64, cases: usize) -> Tally {
    leave_triangles(dice, [1.0, 1.0, flat], cases, Way::ALL[WAY])
}
