//! Self-intersection: rays spawned on a triangle and hit it again.
//!
//! Source: Wächter, Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch.
//! 6, 2019.

use super::methods::Method;
use super::rays::{ray, towards};
use super::rng::Rng;
use super::test_case::{Case, FailureCounts, TestCase, trials};
use super::triangles;
use crate::kernel::surface::{triangle_normal, triangle_offset};
use crate::math;
use crate::methods::Woop;
use crate::sampling::warp::sample_cosine_hemisphere;
use glam::Vec3;

pub(super) const WAECHTER: &str = "Wächter, Binder, Ray Tracing Gems ch. 6, 2019";

/// Returns what test cases of rays that leave a surface have in common.
pub(super) fn common(case: Case<SpawnMethod>) -> TestCase {
    TestCase {
        failure: "the ray hits the surface that it leaves",
        source: WAECHTER,
        methods: trials(case, &SPAWN_METHODS),
        ..TestCase::COMMON
    }
}

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![
        TestCase {
            name: "spawn-place",
            title: "Rays spawned on triangles with edges of 1",
            axis: "distance of the triangle from the origin",
            places: &[0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
            ..common(|rng, x, counts, method| leave_triangles(rng, counts, [1.0, x, 1.0], ARRIVING, method))
        },
        TestCase {
            name: "spawn-size",
            title: "Rays spawned on triangles at a distance of 1 from the origin",
            axis: "edge of the triangle",
            places: &[1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
            ..common(|rng, x, counts, method| leave_triangles(rng, counts, [x, 1.0, 1.0], ARRIVING, method))
        },
        TestCase {
            name: "spawn-travelled",
            title: "Rays spawned on triangles with edges of 1, at a distance of 1 from the origin, after a long ray",
            axis: "length of the arriving ray",
            places: &[0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
            ..common(|rng, x, counts, method| leave_triangles(rng, counts, [1.0; 3], [x; 2], method))
        },
        TestCase {
            name: "spawn-slivers",
            title: "Rays spawned on slivers with edges of 1",
            axis: "usual height / height",
            places: &[1.0, 10.0, 100.0, 1e3, 1e4],
            ..common(|rng, x, counts, method| leave_triangles(rng, counts, [1.0, 1.0, x], ARRIVING, method))
        },
    ]
}

/// How the origin of a ray that leaves a surface is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpawnMethod {
    /// Recompute the point from the exact surface, instead of o + t d.
    exact: bool,
    /// Offset along the normal: this share of the error bound of [`crate::kernel::surface`], and a constant
    /// in scene units.
    share: f32,
    constant: f32,
    /// Hits up to this t are ignored.
    pub(super) t_min: f32,
}

/// The renderer's own first.
const SPAWN_METHODS: [Method<SpawnMethod>; 6] = {
    let (bound, none) = (SpawnMethod::share(1.0), SpawnMethod::share(0.0));
    [
        Method::default("exact point, error bound", bound),
        Method::other("o + t d, error bound", SpawnMethod { exact: false, ..bound }),
        Method::other("exact point, 1e-4", SpawnMethod { constant: 1e-4, ..none }),
        Method::other("o + t d, t > 1e-4", SpawnMethod { exact: false, t_min: 1e-4, ..none }),
        Method::other("exact point, no offset", none),
        Method::other("o + t d, no offset", SpawnMethod { exact: false, ..none }),
    ]
};

impl SpawnMethod {
    /// Returns the renderer's, with this share of the offset.
    pub const fn share(share: f32) -> Self {
        Self { exact: true, share, constant: 0.0, t_min: 0.0 }
    }
    /// Returns the origin of the spawned ray, on the side of the unit vector `n`; `bound` is the surface's
    /// error bound.
    pub(super) fn start(self, exact: Vec3, along: Vec3, n: Vec3, bound: f32) -> Vec3 {
        let point = if self.exact { exact } else { along };
        let [n, point] = [n, point].map(math::Vec3::<f32>::splat);
        n.mul_add(bound * self.share + self.constant, point).get(0)
    }
}

/// Returns a unit direction on the side of the unit vector `n`: cosine-weighted, or with a cosine from 1 down
/// to 1e-6.
pub(crate) fn spawned(rng: &mut Rng, n: Vec3) -> Vec3 {
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

/// Length of arriving rays, in sizes, where it is not the axis of a test case.
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
    let (normal, bound) = (triangle_normal(vertices), triangle_offset(vertices));
    let [start, ab, ac] =
        [vertices[0], vertices[1] - vertices[0], vertices[2] - vertices[0]].map(math::Vec3::<f32>::splat);
    for _ in 0..8 {
        let target = triangles::mean(vertices.map(|v| v.as_dvec3()), rng.barycentrics());
        let distance = rng.scale(near, far);
        let arriving = towards((target + rng.direction() * distance).as_vec3(), target);
        let Some([t, u, v]) = triangles::intersect::<Woop>(vertices, &arriving, f32::INFINITY) else {
            continue;
        };
        let exact = ab.mul_add(u, ac.mul_add(v, start)).get(0);
        for n in [normal, -normal] {
            let origin = method.start(exact, arriving.at(t).get(0), n, bound);
            let next = ray(origin, spawned(rng, n));
            let again = triangles::intersect::<Woop>(vertices, &next, f32::INFINITY);
            counts.record(again.is_some_and(|[t, ..]| t > method.t_min));
        }
    }
}

/// Returns a triangle with edges of about `size`, at a distance of `place` from the origin, its height
/// divided by `flat`; `None` if it has hardly any area in single precision, as the loader rejects such
/// triangles.
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
    counts: &mut FailureCounts,
    [size, place, flat]: [f64; 3],
    travelled: [f64; 2],
    method: SpawnMethod,
) {
    if let Some(vertices) = triangle(rng, size, place, flat) {
        leave_triangle(counts, rng, vertices, travelled.map(|sizes| sizes * size), method);
    }
}
