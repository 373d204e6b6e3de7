//! Quadrics, which are all primitives but triangles, as rays intersect them: in a list, and in the leaves of
//! a hierarchy.

use super::leaf::{inclusive, keep_if_nearer};
use super::rays::{Hits, Rays};
use crate::bvh::{LEAF, Leaf};
use crate::geometry::{self, Geometry};
use crate::kernel::ray_sphere::{Naive, Robust, SphereMethod};
use crate::kernel::sphere_culling::{CulledSphere, SphereCulling};
use crate::lane::{Bits, Lane, Mask, Native};
use crate::math::{Hit, MISS, Ray, Vec3};

/// A ray–sphere intersection method of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SphereTest {
    /// [`Robust`]: the default.
    #[default]
    Robust,
    /// [`Naive`]: the textbook's, for contrast.
    Naive,
}

/// From this many spheres on, those that no ray of a packet may hit are culled first. Culling costs about
/// half a test. Packets always compute the root, so culling pays sooner than for single rays, which skip it
/// where they miss.
const fn min_culled_spheres(width: usize) -> usize {
    if width == 1 { 16 } else { 8 }
}

/// How many spheres are culled at a time.
const CHUNK: usize = 64;

/// All quadrics, in the order of their numbers.
pub(super) struct Quadrics {
    sphere: SphereTest,
    spheres: Vec<Sphere>,
    culled_spheres: Vec<CulledSphere>,
}

/// A sphere as tests read it.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Sphere {
    center: glam::Vec3,
    radius2: f32,
}

impl Quadrics {
    /// Stores all quadrics for an intersection method.
    pub fn new(geometry: &Geometry, sphere: SphereTest) -> Self {
        let spheres = geometry.spheres.iter().map(|sphere| (sphere.center, sphere.radius));
        let stored = spheres.clone().map(|(center, radius)| Sphere { center, radius2: radius * radius });
        Self {
            sphere,
            spheres: stored.collect(),
            culled_spheres: spheres.map(|(center, radius)| CulledSphere::new(center, radius)).collect(),
        }
    }

    pub fn len(&self) -> usize {
        self.spheres.len()
    }

    /// Finds the nearest hit of each ray among all quadrics or those `listed`; overwrites the hits.
    pub fn trace<L: Lane>(&self, rays: &Rays, hits: &mut Hits, listed: Option<&[u32]>) {
        match self.sphere {
            SphereTest::Robust => self.trace_listed::<L, Robust>(rays, hits, listed),
            SphereTest::Naive => self.trace_listed::<L, Naive>(rays, hits, listed),
        }
    }

    fn trace_listed<L: Lane, S: SphereMethod>(&self, rays: &Rays, hits: &mut Hits, listed: Option<&[u32]>) {
        match listed {
            None => self.trace_spheres::<L, S>(self.len(), |at| at, rays, hits),
            Some(listed) => self.trace_spheres::<L, S>(listed.len(), |at| listed[at] as usize, rays, hits),
        }
    }

    /// Finds the nearest of `count` spheres that each ray hits; `number` gives their numbers, ascending. A
    /// later sphere replaces a hit only if it is strictly nearer, so the lower number wins ties.
    ///
    /// Shapes: packets of `WIDTH` rays; one sphere at a time is broadcast to all lanes.
    #[inline(never)]
    fn trace_spheres<L: Lane, S: SphereMethod>(
        &self,
        count: usize,
        number: impl Fn(usize) -> usize,
        rays: &Rays,
        hits: &mut Hits,
    ) {
        let are_culled = S::MAY_CULL && count >= min_culled_spheres(L::WIDTH);
        for at in (0..rays.len()).step_by(L::WIDTH) {
            let ray = rays.packet::<L>(at);
            let (t, primitive) = (rays.t_max(at), L::Bits::splat(MISS));
            let mut tests = SphereTests::<L, S> { ray: S::precalculate(&ray), t, primitive };
            if are_culled {
                let culling = SphereCulling::new(&ray);
                for first in (0..count).step_by(CHUNK) {
                    let (mut near, mut found) = ([0; CHUNK], 0);
                    for number in (first..count.min(first + CHUNK)).map(&number) {
                        // Always written, and counted only if it is near: no branch.
                        near[found % CHUNK] = number;
                        found += usize::from(culling.may_hit(&self.culled_spheres[number]).any());
                    }
                    for &number in &near[..found.min(CHUNK)] {
                        tests.test(number as u32, &self.spheres[number]);
                    }
                }
            } else {
                for number in (0..count).map(&number) {
                    tests.test(number as u32, &self.spheres[number]);
                }
            }
            hits.store_nearest(at, tests.t, tests.primitive);
        }
    }
}

/// The tests of a packet against spheres in turn.
struct SphereTests<L: Lane, S: SphereMethod> {
    ray: S::Precalculated<L>,
    /// The nearest hits so far: t, and the index of the primitive.
    t: L,
    primitive: L::Bits,
}

impl<L: Lane, S: SphereMethod> SphereTests<L, S> {
    #[inline(always)]
    fn test(&mut self, number: u32, sphere: &Sphere) {
        let (meets, equation) = S::equation(&self.ray, Vec3::splat(sphere.center), L::splat(sphere.radius2));
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

/// Up to [`LEAF`] quadrics as a structure of arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct QuadricLeaf {
    center: [[f32; LEAF]; 3],
    /// Squared; negative where there is no sphere, so that no ray hits it.
    radius2: [f32; LEAF],
    primitives: Leaf,
}

impl QuadricLeaf {
    pub fn new(geometry: &Geometry, leaf: &Leaf) -> Self {
        let mut stored = Self { center: [[0.0; LEAF]; 3], radius2: [-1.0; LEAF], primitives: *leaf };
        for (lane, &primitive) in leaf.primitives().iter().enumerate() {
            let geometry::Sphere { center, radius } = geometry.spheres[primitive as usize];
            (0..3).for_each(|axis| stored.center[axis][lane] = center[axis]);
            stored.radius2[lane] = radius * radius;
        }
        stored
    }

    /// Centre and squared radius of one sphere in all lanes.
    #[inline(always)]
    fn sphere<L: Lane>(&self, lane: usize) -> (Vec3<L>, L) {
        let [x, y, z] = &self.center;
        (Vec3::new(L::splat(x[lane]), L::splat(y[lane]), L::splat(z[lane])), L::splat(self.radius2[lane]))
    }

    /// One ray against the quadrics, one a lane.
    #[inline(never)]
    pub fn intersect(&self, ray: &Ray<f32>, hit: &mut Hit<f32>) {
        let ray = Ray {
            origin: ray.origin.each_ref().broadcast(),
            direction: ray.direction.each_ref().broadcast(),
        };
        let [x, y, z] = &self.center;
        let center = Vec3::new(Native::load(x), Native::load(y), Native::load(z));
        let radius2 = Native::load(&self.radius2);
        let limit = Native::splat(inclusive(hit.t));
        let (mask, t) = Robust::test(&Robust::precalculate(&ray), center, radius2, limit);
        for lane in mask.lanes() {
            keep_if_nearer(true, self.primitives.primitives[lane], [t.get(lane), 0.0, 0.0], hit);
        }
    }

    /// A packet against the quadrics, one after the other; whether any hit was nearer.
    #[inline(always)]
    pub fn intersect_packet<L: Lane>(&self, ray: &Ray<L>, hit: &mut Hit<L>) -> bool {
        let mut closer = false;
        let precalculated = Robust::precalculate(ray);
        for (lane, &primitive) in self.primitives.primitives().iter().enumerate() {
            let (center, radius2) = self.sphere::<L>(lane);
            let infinite = L::splat(f32::INFINITY);
            let (mask, t) = Robust::test::<L>(&precalculated, center, radius2, infinite);
            closer |= keep_if_nearer(mask, primitive, [t, L::zero(), L::zero()], hit);
        }
        closer
    }
}
