//! Every ray against every primitive: the fastest way through small scenes, and what every other traversal must equal.

use super::Visible;
use crate::buffers::Spheres;
use crate::kernel::ray_box::{Padding, Slabs, own_box};
use crate::kernel::ray_sphere::SphereMethod;
use crate::kernel::ray_triangle::TriangleMethod;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};

/// The nearest hit of each ray. Later primitives win only when they are truly nearer, so ties go to the lower index.
///
/// Shapes: a packet of `WIDTH` rays; one primitive at a time is splatted over the lanes.
#[inline(always)]
pub fn closest<L: Lane, S: SphereMethod, T: TriangleMethod>(
    spheres: &Spheres,
    triangles: &[T::Stored],
    padding: Padding,
    ray: &Ray<L>,
) -> Hit<L> {
    let mut hit = Hit::miss();
    if !spheres.is_empty() {
        let prepared = S::prepare(ray);
        spheres.for_each(|index, center, radius2| {
            meet_sphere::<L, S>(&mut hit, &prepared, index as u32, center, radius2);
        });
    }
    if !triangles.is_empty() {
        let prepared = T::prepare(ray);
        for (index, triangle) in (spheres.len() as u32..).zip(triangles) {
            meet_triangle::<L, T>(&mut hit, ray, padding, &prepared, index, triangle);
        }
    }
    hit
}

/// The nearest hit of rays that can meet only the primitives in `visible`.
#[inline(always)]
pub fn closest_visible<L: Lane, S: SphereMethod, T: TriangleMethod>(
    spheres: &Spheres,
    triangles: &[T::Stored],
    padding: Padding,
    visible: &Visible,
    ray: &Ray<L>,
) -> Hit<L> {
    let mut hit = Hit::miss();
    if !visible.spheres.is_empty() {
        let prepared = S::prepare(ray);
        for &index in &visible.spheres {
            let (center, radius2) = spheres.splat(index as usize);
            meet_sphere::<L, S>(&mut hit, &prepared, index, center, radius2);
        }
    }
    if !visible.triangles.is_empty() {
        let prepared = T::prepare(ray);
        for &index in &visible.triangles {
            let triangle = &triangles[index as usize];
            let number = spheres.len() as u32 + index;
            meet_triangle::<L, T>(&mut hit, ray, padding, &prepared, number, triangle);
        }
    }
    hit
}

#[inline(always)]
fn meet_sphere<L: Lane, S: SphereMethod>(
    hit: &mut Hit<L>,
    ray: &S::Prepared<L>,
    index: u32,
    center: Vec3<L>,
    radius2: L,
) {
    let (mask, t) = S::test(ray, center, radius2, hit.t);
    hit.t = L::select(mask, t, hit.t);
    hit.primitive = L::Bits::select(mask, L::Bits::splat(index), hit.primitive);
}

#[inline(always)]
fn meet_triangle<L: Lane, T: TriangleMethod>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    padding: Padding,
    prepared: &T::Prepared<L>,
    index: u32,
    triangle: &T::Stored,
) {
    let corners = T::own_box(triangle);
    let limit = if corners.is_some() { L::splat(f32::INFINITY) } else { hit.t };
    let found = T::test(prepared, triangle, limit);
    if !found.mask.any() {
        return;
    }
    let (mask, t) = match corners {
        // Made ready for boxes here and not before: few packets come so far.
        Some(corners) => {
            let [lo, hi] = corners.map(Vec3::splat);
            own_box(&Slabs::new(ray, padding), (lo, hi), found.mask, found.t, hit.t)
        }
        None => (found.mask, found.t),
    };
    hit.t = L::select(mask, t, hit.t);
    hit.primitive = L::Bits::select(mask, L::Bits::splat(index), hit.primitive);
    hit.u = L::select(mask, found.u, hit.u);
    hit.v = L::select(mask, found.v, hit.v);
}
