//! Every ray against every primitive: the fastest way through small scenes, and what every other traversal must equal.

use crate::buffers::Spheres;
use crate::kernel::ray_sphere::SphereMethod;
use crate::kernel::ray_triangle::TriangleMethod;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray};

/// The nearest hit of each ray. Later primitives win only when they are truly nearer, so ties go to the lower index.
///
/// Shapes: a packet of `WIDTH` rays; one primitive at a time is splatted over the lanes.
#[inline(always)]
pub fn closest<L: Lane, S: SphereMethod, T: TriangleMethod>(
    spheres: &Spheres,
    triangles: &[T::Stored],
    ray: &Ray<L>,
) -> Hit<L> {
    let mut hit = Hit::miss();
    if !spheres.is_empty() {
        let prepared = S::prepare(ray);
        spheres.for_each(|index, center, radius2| {
            let (mask, t) = S::test(&prepared, center, radius2, hit.t);
            hit.t = L::select(mask, t, hit.t);
            hit.primitive = L::Bits::select(mask, L::Bits::splat(index as u32), hit.primitive);
        });
    }
    if !triangles.is_empty() {
        let prepared = T::prepare(ray);
        for (index, triangle) in (spheres.len() as u32..).zip(triangles) {
            let found = T::test(&prepared, triangle, hit.t);
            if found.mask.any() {
                hit.t = L::select(found.mask, found.t, hit.t);
                hit.primitive = L::Bits::select(found.mask, L::Bits::splat(index), hit.primitive);
                hit.u = L::select(found.mask, found.u, hit.u);
                hit.v = L::select(found.mask, found.v, hit.v);
            }
        }
    }
    hit
}
