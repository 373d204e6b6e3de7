//! Intersects rays with a list of spheres.

use super::Sphere;
use crate::columns::{Hits, Rays};
use crate::kernel::ray_sphere::QuadraticEquation;
use crate::kernel::sphere_culling::{CulledSphere, SphereCulling};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, MISS, Ray, Vec3};

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

    /// Calls `visit` with each hit of a ray.
    pub fn visit(&self, ray: &Ray<f32>, visit: &mut impl FnMut(Hit<f32>)) {
        for (number, &Row { center, radius2 }) in (0..).zip(&self.spheres) {
            super::visit(ray, number, (Vec3::splat(center), radius2), visit);
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
