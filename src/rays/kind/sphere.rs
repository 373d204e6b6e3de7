//! Spheres: their geometry, and the intersection of rays with a leaf of a hierarchy and with a list.

use super::{LEAF, Leaf, inclusive, keep_if_nearer};
use crate::columns::{Hits, Rays};
use crate::kernel::ray_box::sphere_bounds;
use crate::kernel::ray_sphere::{self, QuadraticEquation};
use crate::kernel::sphere_culling::{CulledSphere, SphereCulling};
use crate::kernel::surface::{sphere_offset, sphere_surface};
use crate::lane::{Bits, Lane, Mask, Native};
use crate::math::{Hit, MISS, Ray, Vec3};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: glam::Vec3,
    /// The radius, above 0.
    pub radius: f32,
}

/// Calls `visit` with each hit of a ray with a sphere: none, one or two.
fn visit(ray: &Ray<f32>, number: u32, (center, radius2): (Vec3<f32>, f32), visit: &mut impl FnMut(Hit<f32>)) {
    let (may_hit, equation) = QuadraticEquation::new(ray, center, radius2);
    let roots = equation.roots().into_iter().filter(|&t| may_hit && t > 0.0);
    roots.for_each(|t| visit(Hit { t, primitive: number, u: 0.0, v: 0.0 }));
}

impl Sphere {
    /// Returns the lower and upper corner of the sphere's box.
    pub fn bounds(self) -> [glam::Vec3; 2] {
        sphere_bounds(self.center, self.radius)
    }
    /// Returns the offset along the normal of rays that leave the sphere.
    pub fn offset(self) -> f32 {
        sphere_offset(self.center, self.radius)
    }
    /// Returns the point of the surface next to `near`, and the unit normal there.
    pub fn surface(self, near: Vec3<f32>) -> (Vec3<f32>, Vec3<f32>) {
        sphere_surface::<f32>(near, Vec3::splat(self.center), 1.0 / self.radius, true)
    }
    /// Returns the distance of a point from the surface.
    pub fn distance(self, point: glam::DVec3) -> f64 {
        (point.distance(self.center.into()) - f64::from(self.radius)).abs()
    }
}

/// Up to [`LEAF`] spheres as a structure of arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct SphereLeaf {
    center: [[f32; LEAF]; 3],
    /// The squared radii; a negative entry means that there is no sphere, and no ray hits it.
    radius2: [f32; LEAF],
    primitives: Leaf,
}

impl SphereLeaf {
    /// Stores the spheres of a leaf.
    pub fn new(spheres: &[Sphere], leaf: &Leaf) -> Self {
        let mut stored = Self { center: [[0.0; LEAF]; 3], radius2: [-1.0; LEAF], primitives: *leaf };
        for (lane, &primitive) in leaf.primitives().iter().enumerate() {
            let Sphere { center, radius } = spheres[primitive as usize];
            (0..3).for_each(|axis| stored.center[axis][lane] = center[axis]);
            stored.radius2[lane] = radius * radius;
        }
        stored
    }

    /// Returns the centre and the squared radius of one sphere in all lanes.
    #[inline(always)]
    fn sphere<L: Lane>(&self, lane: usize) -> (Vec3<L>, L) {
        let [x, y, z] = &self.center;
        (Vec3::new(L::splat(x[lane]), L::splat(y[lane]), L::splat(z[lane])), L::splat(self.radius2[lane]))
    }

    /// Improves the hit of one ray with the spheres, one sphere per lane.
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
        let (mask, t) = ray_sphere::intersect(&ray, center, radius2, limit);
        for lane in mask.lanes() {
            keep_if_nearer(true, self.primitives.primitives[lane], [t.get(lane), 0.0, 0.0], hit);
        }
    }

    /// Calls `found` with each hit of a ray.
    pub fn visit(&self, ray: &Ray<f32>, found: &mut impl FnMut(Hit<f32>)) {
        for (lane, &primitive) in self.primitives.primitives().iter().enumerate() {
            visit(ray, primitive, self.sphere(lane), found);
        }
    }

    /// Improves the hits of a packet with the spheres, one after the other. Returns whether any hit was
    /// nearer.
    #[inline(always)]
    pub fn intersect_packet<L: Lane>(&self, ray: &Ray<L>, hit: &mut Hit<L>) -> bool {
        let mut closer = false;
        for (lane, &primitive) in self.primitives.primitives().iter().enumerate() {
            let (center, radius2) = self.sphere::<L>(lane);
            let infinite = L::splat(f32::INFINITY);
            let (mask, t) = ray_sphere::intersect(ray, center, radius2, infinite);
            closer |= keep_if_nearer(mask, primitive, [t, L::zero(), L::zero()], hit);
        }
        closer
    }
}

/// Returns the number of spheres from which on a packet first culls those that none of its rays may hit.
/// Culling costs about half a test. Packets always compute the root, so culling pays sooner for them than for
/// single rays, which skip it on a miss.
const fn min_culled_spheres(width: usize) -> usize {
    if width == 1 { 16 } else { 8 }
}

/// The number of spheres that are culled at a time.
const CHUNK: usize = 64;

/// All spheres, in the order of their numbers.
pub struct List {
    spheres: Vec<Row>,
    culled_spheres: Vec<CulledSphere>,
}

/// A sphere in the form that tests read.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Row {
    center: glam::Vec3,
    radius2: f32,
}

impl List {
    /// Stores all spheres.
    pub fn new(spheres: &[Sphere]) -> Self {
        let row = |&Sphere { center, radius }: &Sphere| Row { center, radius2: radius * radius };
        let culled = |&Sphere { center, radius }: &Sphere| CulledSphere::new(center, radius);
        Self {
            spheres: spheres.iter().map(row).collect(),
            culled_spheres: spheres.iter().map(culled).collect(),
        }
    }

    /// Returns the number of spheres.
    pub(crate) fn len(&self) -> usize {
        self.spheres.len()
    }

    /// Calls `found` with each hit of a ray.
    pub fn visit(&self, ray: &Ray<f32>, found: &mut impl FnMut(Hit<f32>)) {
        for (number, &Row { center, radius2 }) in (0..).zip(&self.spheres) {
            visit(ray, number, (Vec3::splat(center), radius2), found);
        }
    }

    /// Finds the nearest hit of each ray among all spheres or the `listed` ones; overwrites the hits.
    pub fn trace<L: Lane>(&self, rays: &Rays, hits: &mut Hits, listed: Option<&[u32]>) {
        match listed {
            None => self.trace_spheres::<L>(self.len(), |at| at, rays, hits),
            Some(listed) => self.trace_spheres::<L>(listed.len(), |at| listed[at] as usize, rays, hits),
        }
    }

    /// Finds the nearest of `count` spheres that each ray hits; `number` maps indices to ascending numbers. A
    /// later sphere replaces a hit only if it is strictly nearer, so the lower number wins ties.
    ///
    /// Shapes: packets of `WIDTH` rays; one sphere at a time is broadcast to all lanes.
    #[inline(never)]
    fn trace_spheres<L: Lane>(
        &self,
        count: usize,
        number: impl Fn(usize) -> usize,
        rays: &Rays,
        hits: &mut Hits,
    ) {
        let are_culled = count >= min_culled_spheres(L::WIDTH);
        for at in (0..rays.len()).step_by(L::WIDTH) {
            let ray = rays.packet::<L>(at);
            let (t, primitive) = (rays.t_max(at), L::Bits::splat(MISS));
            let mut tests = SphereTests { ray, t, primitive };
            if are_culled {
                let culling = SphereCulling::new(&ray);
                for first in (0..count).step_by(CHUNK) {
                    let (mut near, mut found) = ([0; CHUNK], 0);
                    for number in (first..count.min(first + CHUNK)).map(&number) {
                        // The entry is always written, and counted only if the sphere may be hit: no branch.
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

/// A packet and its nearest hits, tested against spheres in turn.
struct SphereTests<L: Lane> {
    ray: Ray<L>,
    /// The nearest hits so far: t, and the index of the primitive.
    t: L,
    primitive: L::Bits,
}

impl<L: Lane> SphereTests<L> {
    #[inline(always)]
    fn test(&mut self, number: u32, sphere: &Row) {
        let (center, radius2) = (Vec3::splat(sphere.center), L::splat(sphere.radius2));
        let (may_hit, equation) = QuadraticEquation::new(&self.ray, center, radius2);
        // Only single rays skip the rest of the test. For packets the branch is often mispredicted, which
        // costs more than a square root and a division.
        if L::WIDTH == 1 && !may_hit.any() {
            return;
        }
        let (nearer, t) = equation.solve(may_hit, self.t);
        self.t = L::select(nearer, t, self.t);
        self.primitive = L::Bits::select(nearer, L::Bits::splat(number), self.primitive);
    }
}
