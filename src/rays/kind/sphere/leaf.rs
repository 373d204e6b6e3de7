//! Intersects rays with the spheres of a leaf.

use super::Sphere;
use crate::kernel::ray_sphere;
use crate::kind::{LEAF, Leaf, inclusive, keep_if_nearer};
use crate::lane::{Lane, Mask, Native};
use crate::math::{Hit, Ray, Vec3};

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

    /// Calls `visit` with each hit of a ray.
    pub fn visit(&self, ray: &Ray<f32>, visit: &mut impl FnMut(Hit<f32>)) {
        for (lane, &primitive) in self.primitives.primitives().iter().enumerate() {
            super::visit(ray, primitive, self.sphere(lane), visit);
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
