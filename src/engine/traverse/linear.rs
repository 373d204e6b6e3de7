//! Every ray against every primitive: fastest for small scenes, and the result that every other traversal
//! must equal.
//!
//! Spheres and triangles have a loop over the rays each. In short loops the processor works on several
//! packets at a time, and what a ray needs stays in registers: with 16 lanes 1.03 to 1.1 times as fast as one
//! loop in scenes that have both; with 8 there is no difference.

use super::candidates::{SphereCandidates, TriangleCandidates};
use crate::buffers::Features;
use crate::kernel::ray_box::{Padding, Slabs, own_box};
use crate::kernel::ray_sphere::SphereMethod;
use crate::kernel::ray_triangle::{PairHit, TriangleHit, TriangleMethod};
use crate::kernel::sphere_culling::SphereCulling;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::scene::Scene;
use std::ops::Range;

/// The cost of testing a triangle, in tests of a sphere.
pub const TRIANGLE_COST: usize = 6;
/// Up to this [`cost`] primitives are tested one by one, above it through a hierarchy: about where that
/// becomes faster. Measured in frames, both take equally long for terrains of about 45 triangles with 16
/// lanes (AMD Zen 4) and 32 with 8, knots of 55 and 90, 285 spheres and 200 to 290.
pub const MAX_COST: usize = 240;

/// The cost of testing every primitive for a ray, in tests of a sphere.
pub fn cost(scene: &Scene) -> usize {
    scene.spheres.len() + TRIANGLE_COST * scene.triangles.len()
}

/// The features that traversal adds to those of [`Features::of`]: [`Features::HIERARCHY`] above [`MAX_COST`].
pub fn features_of(scene: &Scene) -> Features {
    if cost(scene) > MAX_COST { Features::HIERARCHY } else { Features::NONE }
}

/// From this many spheres on, those that no ray of a packet may hit are culled first. Culling costs about
/// half a test. Packets always compute the root, so culling pays sooner than for single rays, which skip it
/// where they miss.
const fn min_culled_spheres(width: usize) -> usize {
    if width == 1 { 16 } else { 8 }
}

/// Rays and their hits, a packet of `WIDTH` at a time.
pub trait Batch<L: Lane> {
    /// The indices of the rays. The last packet may have fewer than `WIDTH`; what its other lanes hold is
    /// unspecified.
    fn range(&self) -> Range<usize>;
    /// The packet of rays from `at` on.
    fn ray(&self, at: usize) -> Ray<L>;
    /// Their t_max: hits from here on do not count.
    fn t_max(&self, at: usize) -> L;
    /// The hits that [`Batch::store_nearest`] stored.
    fn nearest(&self, at: usize) -> (L, L::Bits);
    /// Stores t and the primitive's number of each hit; t_max and [`MISS`] where nothing is hit.
    fn store_nearest(&mut self, at: usize, t: L, primitive: L::Bits);
    /// Stores barycentric weights of hits; zeros but on triangles.
    fn store_barycentrics(&mut self, at: usize, u: L, v: L);
}

/// Finds the nearest of the spheres that each ray hits. A later sphere replaces a hit only if it is strictly
/// nearer, so the lower number wins ties.
///
/// Shapes: packets of `WIDTH` rays; one sphere at a time is broadcast to all lanes.
#[inline(never)]
pub(super) fn trace_spheres<L: Lane, S: SphereMethod>(
    spheres: &impl SphereCandidates,
    batch: &mut impl Batch<L>,
) {
    let are_culled = S::MAY_CULL && spheres.count() >= min_culled_spheres(L::WIDTH);
    for at in batch.range().step_by(L::WIDTH) {
        let ray = batch.ray(at);
        let mut tests = SphereTests::<L, S>::new(&ray, batch.t_max(at));
        let test = |number, center, radius2| tests.test(number, center, radius2);
        if are_culled {
            spheres.for_each_near(&SphereCulling::new(&ray), test);
        } else {
            spheres.for_each(test);
        }
        batch.store_nearest(at, tests.t, tests.primitive);
    }
}

/// Finds the nearest of the triangles that each ray hits, or keeps what [`trace_spheres`] found before, if
/// `after_spheres`, where no triangle is strictly nearer.
///
/// Shapes: packets of `WIDTH` rays; one triangle, or two that share an edge, at a time is broadcast to all
/// lanes.
#[inline(never)]
pub(super) fn trace_triangles<L: Lane, T: TriangleMethod>(
    triangles: &impl TriangleCandidates<T::Stored>,
    padding: Padding,
    after_spheres: bool,
    batch: &mut impl Batch<L>,
) {
    for at in batch.range().step_by(L::WIDTH) {
        let (t, primitive) = match after_spheres {
            true => batch.nearest(at),
            false => (batch.t_max(at), L::Bits::splat(MISS)),
        };
        let (ray, mut hit) = (batch.ray(at), Hit { t, primitive, u: L::zero(), v: L::zero() });
        let prepared = T::prepare(&ray);
        let mut triangles = triangles.iter().peekable();
        while let Some((number, triangle)) = triangles.next() {
            if T::is_linked(triangle)
                && let Some(&(next, second)) = triangles.peek()
                && next == number + 1
                && let Some(found) = T::test_pair(&prepared, [triangle, second])
            {
                triangles.next();
                keep_pair_if_nearer::<L, T>(&mut hit, &ray, padding, number, [triangle, second], found);
            } else {
                test_triangle::<L, T>(&mut hit, &ray, &prepared, padding, number, triangle);
            }
        }
        batch.store_nearest(at, hit.t, hit.primitive);
        batch.store_barycentrics(at, hit.u, hit.v);
    }
}

/// The tests of a packet against spheres in turn.
struct SphereTests<L: Lane, S: SphereMethod> {
    ray: S::Prepared<L>,
    /// The nearest hits so far: t, and the index of the primitive.
    t: L,
    primitive: L::Bits,
}

impl<L: Lane, S: SphereMethod> SphereTests<L, S> {
    #[inline(always)]
    fn new(ray: &Ray<L>, t: L) -> Self {
        Self { ray: S::prepare(ray), t, primitive: L::Bits::splat(MISS) }
    }
    #[inline(always)]
    fn test(&mut self, number: u32, center: Vec3<L>, radius2: L) {
        let (meets, equation) = S::equation(&self.ray, center, radius2);
        // Only of a single ray the rest of the test is skipped. Whether any ray of a packet meets a sphere is
        // often predicted wrong, which costs more than a square root and a division.
        if L::WIDTH == 1 && !meets.any() {
            return;
        }
        let (nearer, t) = S::solve(&self.ray, (meets, equation), self.t);
        self.t = L::select(nearer, t, self.t);
        self.primitive = L::Bits::select(nearer, L::Bits::splat(number), self.primitive);
    }
}

/// Keeps the hits of one triangle that are nearer than those found before.
#[inline(always)]
fn test_triangle<L: Lane, T: TriangleMethod>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    prepared: &T::Prepared<L>,
    padding: Padding,
    number: u32,
    triangle: &T::Stored,
) {
    let corners = T::own_box(triangle);
    let limit = if corners.is_some() { L::splat(f32::INFINITY) } else { hit.t };
    let found = T::test(prepared, triangle, limit);
    if found.mask.any() {
        let corners = corners.map(|[lo, hi]| [Vec3::splat(lo), Vec3::splat(hi)]);
        keep_if_nearer(hit, ray, padding, L::Bits::splat(number), corners, found);
    }
}

/// [`test_triangle`] of a pair that was tested.
#[inline(always)]
fn keep_pair_if_nearer<L: Lane, T: TriangleMethod>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    padding: Padding,
    number: u32,
    [first, second]: [&T::Stored; 2],
    PairHit { hit: found, is_second }: PairHit<L>,
) {
    if !found.mask.any() {
        return;
    }
    let of = |first: f32, second: f32| L::select(is_second, L::splat(second), L::splat(first));
    let corner = |first: glam::Vec3, second: glam::Vec3| {
        Vec3::new(of(first.x, second.x), of(first.y, second.y), of(first.z, second.z))
    };
    let corners = match (T::own_box(first), T::own_box(second)) {
        (Some(first), Some(second)) => Some([corner(first[0], second[0]), corner(first[1], second[1])]),
        _ => None,
    };
    let number = L::Bits::select(is_second, L::Bits::splat(number + 1), L::Bits::splat(number));
    keep_if_nearer(hit, ray, padding, number, corners, found);
}

/// Keeps what was found where it is nearer than what was found before, within the triangles' own boxes.
#[inline(always)]
fn keep_if_nearer<L: Lane>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    padding: Padding,
    number: L::Bits,
    corners: Option<[Vec3<L>; 2]>,
    found: TriangleHit<L>,
) {
    let (mask, t) = match corners {
        // Slabs are computed here and not once a packet: few packets hit a triangle's plane inside its edges.
        Some([lo, hi]) => own_box(&Slabs::new(ray, padding), (lo, hi), found.mask, found.t, hit.t),
        None => (found.mask & found.t.lt(hit.t), found.t),
    };
    hit.t = L::select(mask, t, hit.t);
    hit.primitive = L::Bits::select(mask, number, hit.primitive);
    hit.u = L::select(mask, found.u, hit.u);
    hit.v = L::select(mask, found.v, hit.v);
}
