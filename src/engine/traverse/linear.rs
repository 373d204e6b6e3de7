//! Every ray against every primitive: fastest for small scenes, and the result that every other traversal
//! must equal.

use super::primitive_list::PrimitiveList;
use crate::buffers::{Features, Spheres};
use crate::kernel::ray_box::{Padding, Slabs, own_box};
use crate::kernel::ray_sphere::{QuadraticEquation, SphereMethod};
use crate::kernel::ray_triangle::{PairHit, TriangleHit, TriangleMethod};
use crate::kernel::sphere_culling::{CulledSphere, SphereCulling};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::scene::Scene;

/// The cost of testing a triangle, in tests of a sphere.
pub const TRIANGLE_COST: usize = 6;
/// Up to this [`cost`] primitives are tested one by one, above it through a hierarchy: about where that
/// becomes faster. Measured in frames, both take equally long for terrains of about 45 triangles with 16
/// lanes and 32 with 8, knots of 120 and 90, 270 to 390 spheres and 200 to 290.
pub const MAX_COST: usize = 240;

/// The cost of testing every primitive for a ray, in tests of a sphere.
pub fn cost(scene: &Scene) -> usize {
    scene.spheres.len() + TRIANGLE_COST * scene.triangles.len()
}

/// The features that traversal adds to those of [`Features::of`]: [`Features::HIERARCHY`] above [`MAX_COST`].
pub fn features_of(scene: &Scene) -> Features {
    if cost(scene) > MAX_COST { Features::HIERARCHY } else { Features::NONE }
}

/// From this many spheres on, those that no ray of a packet may hit are culled first. Where all are tested,
/// the branch that skips the rest of a test is often predicted wrong; culling has no branch.
const CULLED_SPHERES: usize = 16;
/// Most rays of a packet whose equations wait for others: see [`SphereTests`].
const MAX_WAITING: usize = 8;
/// How many spheres are culled at a time.
const CHUNK: usize = 64;

/// Calls `f` with those of up to [`CHUNK`] spheres that some ray may hit: number, centre, squared radius.
#[inline(always)]
fn for_each_near<'a, L: Lane>(
    rays: &SphereCulling<L>,
    chunk: impl Iterator<Item = (u32, &'a CulledSphere)>,
    spheres: &Spheres,
    f: &mut impl FnMut(u32, Vec3<L>, L),
) {
    let (mut near, mut count) = ([0; CHUNK], 0);
    for (number, sphere) in chunk {
        // Always written, and counted only if it is near: no branch.
        near[count % CHUNK] = number;
        count += usize::from(rays.may_hit(sphere).any());
    }
    for &number in &near[..count.min(CHUNK)] {
        let (center, radius2) = spheres.splat(number as usize);
        f(number, center, radius2);
    }
}

/// The primitives to test a ray against, by ascending number: spheres first, then triangles as the method
/// stores them.
pub trait Candidates<Stored> {
    /// How many spheres there are.
    fn sphere_count(&self) -> usize;
    /// Calls `f` with each sphere's number, centre and squared radius.
    fn for_each_sphere<L: Lane>(&self, f: impl FnMut(u32, Vec3<L>, L));
    /// [`Candidates::for_each_sphere`] of those that any of the rays may hit.
    fn for_each_sphere_near<L: Lane>(&self, rays: &SphereCulling<L>, f: impl FnMut(u32, Vec3<L>, L));
    /// Whether there is any triangle.
    fn has_triangles(&self) -> bool;
    /// Each triangle and its number. An iterator and no closure: a test is so much code that a closure with
    /// it would not be inlined into the loop (4 % more instructions in boxes).
    fn triangles<'a>(&'a self) -> impl Iterator<Item = (u32, &'a Stored)>
    where
        Stored: 'a;
}

/// Every primitive of a scene.
#[derive(Clone, Copy)]
pub struct All<'a, Stored> {
    /// All spheres.
    pub spheres: &'a Spheres,
    /// The same, for culling.
    pub culled_spheres: &'a [CulledSphere],
    /// All triangles.
    pub triangles: &'a [Stored],
}

/// Those primitives that are listed.
#[derive(Clone, Copy)]
pub struct Listed<'a, Stored> {
    /// Every primitive.
    pub all: All<'a, Stored>,
    /// The indices of those that can be hit.
    pub listed: &'a PrimitiveList,
}

impl<Stored> Candidates<Stored> for All<'_, Stored> {
    #[inline(always)]
    fn sphere_count(&self) -> usize {
        self.spheres.len()
    }
    #[inline(always)]
    fn for_each_sphere<L: Lane>(&self, mut f: impl FnMut(u32, Vec3<L>, L)) {
        self.spheres.for_each(|index, center, radius2| f(index as u32, center, radius2));
    }
    #[inline(always)]
    fn for_each_sphere_near<L: Lane>(&self, rays: &SphereCulling<L>, mut f: impl FnMut(u32, Vec3<L>, L)) {
        for (chunk, spheres) in self.culled_spheres.chunks(CHUNK).enumerate() {
            let numbers = (chunk * CHUNK) as u32..;
            for_each_near(rays, numbers.zip(spheres), self.spheres, &mut f);
        }
    }
    #[inline(always)]
    fn has_triangles(&self) -> bool {
        !self.triangles.is_empty()
    }
    #[inline(always)]
    fn triangles<'a>(&'a self) -> impl Iterator<Item = (u32, &'a Stored)>
    where
        Stored: 'a,
    {
        (self.spheres.len() as u32..).zip(self.triangles)
    }
}

impl<Stored> Candidates<Stored> for Listed<'_, Stored> {
    #[inline(always)]
    fn sphere_count(&self) -> usize {
        self.listed.spheres.len()
    }
    #[inline(always)]
    fn for_each_sphere<L: Lane>(&self, mut f: impl FnMut(u32, Vec3<L>, L)) {
        for &index in &self.listed.spheres {
            let (center, radius2) = self.all.spheres.splat(index as usize);
            f(index, center, radius2);
        }
    }
    #[inline(always)]
    fn for_each_sphere_near<L: Lane>(&self, rays: &SphereCulling<L>, mut f: impl FnMut(u32, Vec3<L>, L)) {
        for listed in self.listed.spheres.chunks(CHUNK) {
            let culled = |&number: &u32| (number, &self.all.culled_spheres[number as usize]);
            for_each_near(rays, listed.iter().map(culled), self.all.spheres, &mut f);
        }
    }
    #[inline(always)]
    fn has_triangles(&self) -> bool {
        !self.listed.triangles.is_empty()
    }
    #[inline(always)]
    fn triangles<'a>(&'a self) -> impl Iterator<Item = (u32, &'a Stored)>
    where
        Stored: 'a,
    {
        let (first, triangles) = (self.all.spheres.len() as u32, self.all.triangles);
        self.listed.triangles.iter().map(move |&index| (first + index, &triangles[index as usize]))
    }
}

/// The nearest hit of each ray. A later primitive replaces a hit only if it is strictly nearer, so the lower
/// index wins ties.
///
/// Shapes: a packet of `WIDTH` rays; one primitive at a time is broadcast to all lanes.
#[inline(always)]
pub fn closest<L: Lane, S: SphereMethod, T: TriangleMethod>(
    candidates: &impl Candidates<T::Stored>,
    padding: Padding,
    ray: &Ray<L>,
) -> Hit<L> {
    let mut hit = Hit::miss();
    let spheres = candidates.sphere_count();
    if spheres > 0 {
        let mut tests = SphereTests::<L, S>::new(ray);
        let test = |number, center, radius2| tests.test(number, center, radius2);
        if S::MAY_CULL && spheres >= CULLED_SPHERES {
            candidates.for_each_sphere_near(&SphereCulling::new(ray), test);
        } else {
            candidates.for_each_sphere(test);
        }
        hit = tests.nearest();
    }
    if candidates.has_triangles() {
        let prepared = T::prepare(ray);
        let mut triangles = candidates.triangles().peekable();
        while let Some((number, triangle)) = triangles.next() {
            if T::is_linked(triangle)
                && let Some(&(next, second)) = triangles.peek()
                && next == number + 1
                && let Some(found) = T::test_pair(&prepared, [triangle, second])
            {
                triangles.next();
                keep_pair_if_nearer::<L, T>(&mut hit, ray, padding, number, [triangle, second], found);
            } else {
                test_triangle::<L, T>(&mut hit, ray, &prepared, padding, number, triangle);
            }
        }
    }
    hit
}

/// The tests of a packet against spheres in turn. A ray meets few of them, so square root and division wait,
/// lane by lane, until some ray meets a second sphere: one pair of them serves several spheres. Not so in
/// packets of more than [`MAX_WAITING`] rays, some of which nearly always meet a second one.
struct SphereTests<L: Lane, S: SphereMethod> {
    ray: S::Prepared<L>,
    /// The nearest hits of the equations that are solved.
    hit: Hit<L>,
    /// The lanes that hold an equation to solve.
    waiting: L::Mask,
    equation: QuadraticEquation<L>,
    /// The spheres of the equations.
    number: L::Bits,
}

impl<L: Lane, S: SphereMethod> SphereTests<L, S> {
    #[inline(always)]
    fn new(ray: &Ray<L>) -> Self {
        Self {
            ray: S::prepare(ray),
            hit: Hit::miss(),
            waiting: L::Mask::splat(false),
            equation: QuadraticEquation::none(),
            number: L::Bits::splat(0),
        }
    }
    #[inline(always)]
    fn test(&mut self, number: u32, center: Vec3<L>, radius2: L) {
        let (meets, equation) = S::equation(&self.ray, center, radius2);
        let number = L::Bits::splat(number);
        if L::WIDTH > MAX_WAITING {
            if meets.any() {
                self.keep_if_nearer(meets, &equation, number);
            }
            return;
        }
        // Where all wait, as in a sphere around the scene, the next one that any ray meets is a second one.
        if (meets & self.waiting).any() || self.waiting.all() {
            self.solve();
        }
        self.equation = QuadraticEquation::select(meets, &equation, &self.equation);
        self.number = L::Bits::select(meets, number, self.number);
        self.waiting = self.waiting | meets;
    }
    #[inline(always)]
    fn keep_if_nearer(&mut self, meets: L::Mask, equation: &QuadraticEquation<L>, number: L::Bits) {
        let t = S::root(&self.ray, equation);
        let nearer = meets & L::zero().lt(t) & t.lt(self.hit.t);
        self.hit.t = L::select(nearer, t, self.hit.t);
        self.hit.primitive = L::Bits::select(nearer, number, self.hit.primitive);
    }
    #[inline(always)]
    fn solve(&mut self) {
        let (equation, number) = (self.equation, self.number);
        self.keep_if_nearer(self.waiting, &equation, number);
        self.waiting = L::Mask::splat(false);
    }
    #[inline(always)]
    fn nearest(mut self) -> Hit<L> {
        if L::WIDTH <= MAX_WAITING && self.waiting.any() {
            self.solve();
        }
        self.hit
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
