//! Self-intersection: rays that leave a triangle and hit it again.
//!
//! Source: Wächter, Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch.
//! 6, 2019.

use super::rays::{ray, towards};
use super::recipe::{Bound, FailureCounts, Recipe};
use super::rng::Rng;
use super::triangles;
use crate::kernel::ray_triangle::Woop;
use crate::kernel::surface::{triangle_normal, triangle_offset};
use crate::math;
use crate::sampling::warp::sample_cosine_hemisphere;
use glam::Vec3;

pub(super) const WAECHTER: &str = "Wächter, Binder, Ray Tracing Gems ch. 6, 2019";
pub(super) const AGAIN: &str = "the ray hits the surface that it leaves";

/// The spawn methods, for a function that takes one of [`SpawnMethod::ALL`] as its last argument.
macro_rules! spawn_methods {
    ($run:ident) => {
        $crate::measure::stability::leaving::spawn_methods!($run;
            default "exact point, error bound" 0, other "o + t d, error bound" 1, other "exact point, 1e-4" 2,
            other "o + t d, t > 1e-4" 3, other "exact point, no offset" 4, other "o + t d, no offset" 5)
    };
    ($run:ident; $($role:ident $name:literal $number:literal),+) => {
        [$($crate::measure::stability::methods::Method::$role($name, |rng, x, cases| {
            $run(rng, x, cases, $crate::measure::stability::leaving::SpawnMethod::ALL[$number])
        })),+]
    };
}
pub(super) use spawn_methods;

pub(super) const RECIPES: &[Recipe] = &[
    Recipe {
        name: "leaving-place",
        title: "Leaving triangles with edges of 1",
        axis: "distance of the triangle from the origin",
        places: &[0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
        failure: AGAIN,
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &spawn_methods!(from_place),
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
        methods: &spawn_methods!(of_size),
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "leaving-travelled",
        title: "Leaving triangles with edges of 1, at a distance of 1 from the origin, after a long ray",
        axis: "length of the arriving ray",
        places: &[0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
        failure: AGAIN,
        error: None,
        source: WAECHTER,
        cases: 100_000,
        methods: &spawn_methods!(after_distance),
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
        methods: &spawn_methods!(of_slivers),
        bound: |_| Bound::NO_FAILURE,
    },
];

/// The origin of a ray that leaves a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpawnMethod {
    /// Recompute the point from the exact surface, instead of o + t d.
    pub(crate) exact: bool,
    pub(crate) offset: Offset,
    /// Hits up to this t are ignored.
    pub(crate) t_min: f32,
}

/// Offset of the origin along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Offset {
    /// This share of the error bound of [`crate::kernel::surface`].
    Bound(f32),
    /// Scene units.
    Constant(f32),
}

impl SpawnMethod {
    /// In the order of `spawn_methods`: the renderer's own first.
    pub(crate) const ALL: [Self; 6] = [
        Self::with(true, Offset::Bound(1.0), 0.0),
        Self::with(false, Offset::Bound(1.0), 0.0),
        Self::with(true, Offset::Constant(1e-4), 0.0),
        Self::with(false, Offset::Bound(0.0), 1e-4),
        Self::with(true, Offset::Bound(0.0), 0.0),
        Self::with(false, Offset::Bound(0.0), 0.0),
    ];

    const fn with(exact: bool, offset: Offset, t_min: f32) -> Self {
        Self { exact, offset, t_min }
    }
    /// The renderer's, with this share of the offset.
    pub const fn share(share: f32) -> Self {
        Self::with(true, Offset::Bound(share), 0.0)
    }
    /// The origin of the leaving ray, on the side of the unit vector `n`; `bound` is the surface's error
    /// bound.
    pub(crate) fn start(self, exact: Vec3, along: Vec3, n: Vec3, bound: f32) -> Vec3 {
        let point = if self.exact { exact } else { along };
        let offset = match self.offset {
            Offset::Bound(share) => bound * share,
            Offset::Constant(offset) => offset,
        };
        let [n, point] = [n, point].map(math::Vec3::<f32>::splat);
        n.mul_add(offset, point).get(0)
    }
}

/// A unit direction on the side of the unit vector `n`: cosine-weighted, or with a cosine from 1 down to
/// 1e-6.
pub(crate) fn leaving(rng: &mut Rng, n: Vec3) -> Vec3 {
    if rng.index(2) == 0 {
        let [u, v] = [(); 2].map(|()| (rng.unit() as f32).min(1.0_f32.next_down()));
        return sample_cosine_hemisphere::<f32>(math::Vec3::splat(n), u, v).get(0);
    }
    loop {
        let cos = rng.scale(1e-6, 1.0);
        let across = n.as_dvec3().cross(rng.direction()).normalize();
        let direction = (across * (1.0 - cos * cos).sqrt() + n.as_dvec3() * cos).as_vec3();
        // Rounding may move it below.
        if direction.as_dvec3().dot(n.as_dvec3()) > 0.0 {
            return direction;
        }
    }
}

/// Length of arriving rays, in sizes, where it is not the axis of a recipe.
pub(super) const ARRIVING: [f64; 2] = [0.5, 5.0];

/// Counts rays that leave a triangle and hit it again: eight rays of lengths `near` to `far` arrive, and
/// leave on both sides.
pub fn leave_triangle(
    counts: &mut FailureCounts,
    rng: &mut Rng,
    vertices: [Vec3; 3],
    [near, far]: [f64; 2],
    method: SpawnMethod,
) {
    let [a, b, c] = vertices.map(|v| v.as_dvec3());
    let (normal, bound) = (triangle_normal(vertices), triangle_offset(vertices));
    let [start, ab, ac] =
        [vertices[0], vertices[1] - vertices[0], vertices[2] - vertices[0]].map(math::Vec3::<f32>::splat);
    for _ in 0..8 {
        let weights = rng.barycentrics();
        let target = a * weights[0] + b * weights[1] + c * weights[2];
        let distance = rng.scale(near, far);
        let arriving = towards((target + rng.direction() * distance).as_vec3(), target);
        let Some([t, u, v]) = triangles::intersect::<Woop>(vertices, &arriving, f32::INFINITY) else {
            continue;
        };
        let exact = ab.mul_add(u, ac.mul_add(v, start)).get(0);
        for n in [normal, -normal] {
            let origin = method.start(exact, arriving.at(t).get(0), n, bound);
            let next = ray(origin, leaving(rng, n));
            let again = triangles::intersect::<Woop>(vertices, &next, f32::INFINITY);
            counts.record(again.is_some_and(|[t, ..]| t > method.t_min));
        }
    }
}

/// A triangle with edges of about `size`, at a distance of `place` from the origin, its height divided by
/// `flat`; `None` if it has hardly any area in single precision, as the loader rejects such triangles.
pub fn triangle(rng: &mut Rng, size: f64, place: f64, flat: f64) -> Option<[Vec3; 3]> {
    let center = rng.direction() * place;
    let [a, b, c] = [(); 3].map(|()| center + rng.in_cube() * (0.6 * size));
    let foot = a.lerp(b, rng.unit());
    let vertices = [a, b, foot + (c - foot) / flat].map(|v| v.as_vec3());
    let [a, b, c] = vertices.map(|v| v.as_dvec3());
    ((b - a).cross(c - a).length() >= 1e-6 * size * size).then_some(vertices)
}

fn leave_triangles(
    rng: &mut Rng,
    [size, place, flat]: [f64; 3],
    cases: usize,
    method: SpawnMethod,
) -> FailureCounts {
    let mut counts = FailureCounts::default();
    while counts.tested < cases {
        if let Some(vertices) = triangle(rng, size, place, flat) {
            leave_triangle(&mut counts, rng, vertices, ARRIVING.map(|travelled| travelled * size), method);
        }
    }
    counts
}

fn from_place(rng: &mut Rng, place: f64, cases: usize, method: SpawnMethod) -> FailureCounts {
    leave_triangles(rng, [1.0, place, 1.0], cases, method)
}

fn of_size(rng: &mut Rng, size: f64, cases: usize, method: SpawnMethod) -> FailureCounts {
    leave_triangles(rng, [size, 1.0, 1.0], cases, method)
}

fn after_distance(rng: &mut Rng, travelled: f64, cases: usize, method: SpawnMethod) -> FailureCounts {
    let mut counts = FailureCounts::default();
    while counts.tested < cases {
        if let Some(vertices) = triangle(rng, 1.0, 1.0, 1.0) {
            leave_triangle(&mut counts, rng, vertices, [travelled; 2], method);
        }
    }
    counts
}

fn of_slivers(rng: &mut Rng, flat: f64, cases: usize, method: SpawnMethod) -> FailureCounts {
    leave_triangles(rng, [1.0, 1.0, flat], cases, method)
}
