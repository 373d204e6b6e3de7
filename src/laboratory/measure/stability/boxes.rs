//! Boxes: corners, edges, planes of faces, far from the origin, all scales; false hits beside padded boxes.
//!
//! Source: Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.

use super::methods::all_methods;
use super::rays::{ray, to_f64, towards};
use super::rng::Rng;
use super::test_case::{Bound, Case, FAILED, FailureCounts, TestCase, trials};
use crate::kernel::ray_box::Padding;
use crate::math::{self, Ray};
use crate::methods::BoxMethod;
use glam::{DVec3, Vec3};

const IZE: &str = "Ize, Robust BVH Ray Traversal, JCGT 2(2), 2013";

pub(super) fn test_cases() -> Vec<TestCase> {
    let common = |case: Case<Entry>| TestCase {
        failure: "a ray that hits the box misses it",
        source: IZE,
        methods: trials(case, &all_methods!(box, entry)),
        ..TestCase::COMMON
    };
    vec![
        TestCase {
            name: "boxes-corners",
            title: "Rays aimed at corners of boxes, away from the origin of coordinates",
            axis: "distance of the box from the origin / its size",
            places: &[0.0, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6],
            error: Some("|Δt| of the entry point / t"),
            ..common(at_corners)
        },
        TestCase {
            name: "boxes-faces",
            title: "Rays that start in the plane of a face and run along it",
            axis: "component of the direction across the face",
            places: &[0.0, 1e-44, 1e-39, 1e-30, 1e-20, 1e-17, 1e-12, 1e-8, 1e-6, 1e-4],
            ..common(along_faces)
        },
        TestCase {
            name: "boxes-scale",
            title: "Boxes of all sizes, also flat ones, and directions close to an axis",
            axis: "size of the scene",
            places: &SCALES,
            ..common(at_scale)
        },
        TestCase {
            name: "boxes-beside",
            title: "The cost of padding: rays that miss a box by little",
            axis: "distance of ray and box / padding of the default method",
            places: &[0.01, 0.03, 0.1, 0.3, 1.0, 2.0, 10.0, 100.0],
            failure: "a ray that misses the box hits it",
            source: "this program",
            inputs: 50_000,
            bound: |off| if off < 2.0 { Bound::NONE } else { Bound::NO_FAILURE },
            ..common(beside)
        },
    ]
}

/// Scene sizes from tiny to huge.
pub const SCALES: [f64; 7] = [1e-15, 1e-6, 1e-2, 1.0, 1e3, 1e6, 1e15];

/// A box of single precision.
#[derive(Clone, Copy, Debug)]
pub struct Cuboid {
    /// Lower corner, in scene units.
    pub lo: Vec3,
    /// Upper corner; equal to `lo` in an axis where the box is flat.
    pub hi: Vec3,
}

impl Cuboid {
    /// Returns a box of random size and place within ±`scale`; some are flat.
    pub fn random(rng: &mut Rng, scale: f64) -> Self {
        let center = rng.in_cube() * scale;
        let half = DVec3::from_array([(); 3].map(|()| match rng.index(5) {
            0 => 0.0,
            _ => 0.5 * rng.scale(1e-6, 1.0) * scale,
        }));
        Self { lo: (center - half).as_vec3(), hi: (center + half).as_vec3() }
    }
    /// Returns the largest absolute coordinate.
    pub fn extent(&self) -> f32 {
        self.lo.abs().max(self.hi.abs()).max_element()
    }
    /// Returns a corner, or a point of an edge, a face or the inside: in each axis on the lower plane, on the
    /// upper one, or between.
    pub(crate) fn point(&self, rng: &mut Rng) -> DVec3 {
        let (lo, hi) = (self.lo.as_dvec3(), self.hi.as_dvec3());
        let share = DVec3::from_array([(); 3].map(|()| match rng.index(3) {
            0 => 0.0,
            1 => 1.0,
            _ => rng.unit(),
        }));
        lo + (hi - lo) * share
    }
    fn corner(&self, rng: &mut Rng) -> DVec3 {
        let share = DVec3::from_array([(); 3].map(|()| rng.index(2) as f64));
        self.lo.as_dvec3() + (self.hi.as_dvec3() - self.lo.as_dvec3()) * share
    }
    /// Returns the lower and the upper corner in f64, moved outwards by `by`.
    pub fn grown(&self, by: f64) -> (DVec3, DVec3) {
        (self.lo.as_dvec3() - by, self.hi.as_dvec3() + by)
    }
}

/// Returns the interval of t inside the box; the first is above the second for a miss. In f64, where
/// differences of f32 numbers of similar size are exact.
pub fn reference_interval((lo, hi): (DVec3, DVec3), ray: &Ray<f32>) -> (f64, f64) {
    let (origin, direction) = to_f64(ray);
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

/// Tests whether the ray hits the box between these corners, in front of its origin.
pub fn meets(corners: (DVec3, DVec3), ray: &Ray<f32>) -> bool {
    let (enter, leave) = reference_interval(corners, ray);
    enter <= leave && leave >= 0.0
}

/// Returns the padding that the default method gives a box, in scene units along each axis: see
/// [`crate::kernel::ray_box::BoxRay::new`].
pub fn padding(cuboid: &Cuboid, origin: Vec3) -> f64 {
    f64::from(origin.abs().max_element() + cuboid.extent()) * 0.5f64.powi(21)
}

/// Direction components whose reciprocals are infinite or very large.
const AWKWARD: [f32; 10] =
    [0.0, -0.0, 1e-17, -1e-17, 1e-18, -1e-19, 1e-40, -1e-40, f32::from_bits(1), -1e-30];

/// Returns a ray towards a point of the box, often a corner or a point of an edge; often with components near
/// zero, and then often in the plane of a face.
pub fn aimed(rng: &mut Rng, cuboid: &Cuboid, scale: f64) -> Ray<f32> {
    let target = cuboid.point(rng);
    let mut origin = match rng.index(4) {
        0 => cuboid.point(rng).as_vec3(),
        1 => (rng.in_cube() * (100.0 * scale)).as_vec3(),
        _ => (rng.in_cube() * (2.0 * scale)).as_vec3(),
    };
    let mut direction = (target - origin.as_dvec3()).normalize_or(rng.direction()).as_vec3();
    if rng.index(2) == 0 {
        let first = rng.index(3);
        for axis in [first, (first + 1) % 3].into_iter().take(1 + rng.index(2)) {
            direction[axis] = AWKWARD[rng.index(AWKWARD.len())];
            origin[axis] = target[axis] as f32;
        }
        direction = direction.as_dvec3().normalize_or(DVec3::X).as_vec3();
    }
    ray(origin, direction)
}

/// Returns a ray that misses the box by at least `by` paddings, and hardly by more than three times as many;
/// `None` if the random ray does not.
pub fn passing(rng: &mut Rng, cuboid: &Cuboid, scale: f64, by: f64) -> Option<Ray<f32>> {
    let origin = (rng.in_cube() * (4.0 * scale)).as_vec3();
    let padding = padding(cuboid, origin);
    let outwards = DVec3::from_array([(); 3].map(|()| rng.signed().signum()));
    let target = cuboid.point(rng) + outwards * (padding * by * (1.0 + 2.0 * rng.unit()));
    let direction = (target - origin.as_dvec3()).normalize_or(DVec3::X).as_vec3();
    let ray = ray(origin, direction);
    (!meets(cuboid.grown(by * padding), &ray)).then_some(ray)
}

/// The t at which a ray enters a box by one method; `None` for a miss.
type Entry = fn(&Cuboid, &Ray<f32>) -> Option<f32>;

/// Returns the t at which the ray enters the box by method `B`; `None` for a miss.
fn entry<B: BoxMethod>(cuboid: &Cuboid, ray: &Ray<f32>) -> Option<f32> {
    let precalculated = B::precalculate(ray, Padding::new(cuboid.extent()));
    let (near, far) = B::pass(&precalculated, math::Vec3::splat(cuboid.lo), math::Vec3::splat(cuboid.hi));
    (near <= far && far >= 0.0).then_some(near)
}

/// Records a ray that hits the box: a miss is a failure.
fn record_hit(counts: &mut FailureCounts, cuboid: &Cuboid, ray: &Ray<f32>, entry: Entry) {
    if meets(cuboid.grown(0.0), ray) {
        counts.record(entry(cuboid, ray).is_none());
    }
}

/// Returns a box around `center` with edges from 0.1 to 1, and the halves of its edges.
fn around(rng: &mut Rng, center: DVec3) -> (Cuboid, DVec3) {
    let half = DVec3::from_array([(); 3].map(|()| 0.05 + 0.45 * rng.unit()));
    (Cuboid { lo: (center - half).as_vec3(), hi: (center + half).as_vec3() }, half)
}

/// Origins up to four sizes away.
fn at_corners(rng: &mut Rng, offset: f64, counts: &mut FailureCounts, entry: Entry) {
    let center = rng.direction() * offset;
    let (cuboid, _) = around(rng, center);
    let origin = (center + rng.in_cube() * 4.0).as_vec3();
    let ray = towards(origin, cuboid.corner(rng));
    // Rounding of the direction moves about half of them outside.
    let (enter, leave) = reference_interval(cuboid.grown(0.0), &ray);
    if enter <= leave && enter > 0.0 {
        let error = |near| (f64::from(near) / enter - 1.0).abs();
        counts.record_error(entry(&cuboid, &ray).map_or(FAILED, error));
    }
}

/// Tries rays along lower and upper faces of all axes, with the component ±`across` across the face.
fn along_faces(rng: &mut Rng, across: f64, counts: &mut FailureCounts, entry: Entry) {
    let center = rng.in_cube();
    let (cuboid, half) = around(rng, center);
    let axis = rng.index(3);
    let mut origin = (rng.in_cube() * 4.0).as_vec3();
    origin[axis] = [cuboid.lo, cuboid.hi][rng.index(2)][axis];
    let mut target = center + half * rng.in_cube();
    target[axis] = f64::from(origin[axis]);
    let mut direction = (target - origin.as_dvec3()).normalize_or(DVec3::X).as_vec3();
    direction[axis] = across as f32 * [1.0, -1.0][rng.index(2)];
    record_hit(counts, &cuboid, &ray(origin, direction), entry);
}

fn at_scale(rng: &mut Rng, scale: f64, counts: &mut FailureCounts, entry: Entry) {
    let cuboid = Cuboid::random(rng, scale);
    let ray = aimed(rng, &cuboid, scale);
    record_hit(counts, &cuboid, &ray, entry);
}

fn beside(rng: &mut Rng, off: f64, counts: &mut FailureCounts, entry: Entry) {
    let cuboid = Cuboid::random(rng, 1.0);
    if let Some(ray) = passing(rng, &cuboid, 1.0, off) {
        counts.record(entry(&cuboid, &ray).is_some());
    }
}
