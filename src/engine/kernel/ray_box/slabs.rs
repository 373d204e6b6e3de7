//! The default: one FMA a plane, and padding that makes up for it.

use super::{BoxMethod, Padding, in_order};
use crate::lane::Lane;
use crate::math::{Ray, Vec3};

/// A ray made ready for boxes: the intervals of t within pairs of planes are `plane · inverse + near` to `plane · inverse + far`.
#[derive(Clone, Copy, Debug)]
pub struct Slabs<L> {
    /// 1 / direction; directions along an axis are turned off it by 2⁻⁶⁰ of their length.
    pub inverse: Vec3<L>,
    /// −origin / direction, less the padding.
    pub near: Vec3<L>,
    /// −origin / direction, and the padding.
    pub far: Vec3<L>,
}

impl<L: Lane> Slabs<L> {
    /// Padding, in units of t: (|o| + room) 2⁻²¹ |1/d| along each axis, |o| along that axis and room of [`Padding::room`]: eight roundings
    /// of everything that the FMA adds up. No hit is lost: `tests/hierarchy_laws.rs`, at corners, in the planes of faces, in awkward directions.
    #[inline(always)]
    pub fn new(ray: &Ray<L>, padding: Padding) -> Self {
        let d = ray.direction;
        // A sum and not the largest, so that a NaN in one component is in all planes: such a ray passes no box.
        let least = (d.x.abs() + d.y.abs() + d.z.abs()) * L::splat(f32::powi(0.5, 60));
        let (room, share) = (padding.room(ray.origin), L::splat(padding.padding));
        let axis = |origin: L, direction: L| {
            let inverse = L::one() / direction.abs().max(least).copysign(direction);
            let middle = -(origin * inverse);
            let padding = (origin.abs() + room) * inverse.abs() * share;
            (inverse, middle - padding, middle + padding)
        };
        let (x, y, z) = (axis(ray.origin.x, d.x), axis(ray.origin.y, d.y), axis(ray.origin.z, d.z));
        Self {
            inverse: Vec3::new(x.0, y.0, z.0),
            near: Vec3::new(x.1, y.1, z.1),
            far: Vec3::new(x.2, y.2, z.2),
        }
    }

    /// Where each ray enters and leaves its box, from its planes in the order in which the ray meets them. It passes the box if the
    /// first is not above the second; the first may be negative.
    #[inline(always)]
    pub fn interval(&self, first: Vec3<L>, second: Vec3<L>) -> (L, L) {
        let plane = |plane: L, inverse: L, rest: L| plane.mul_add(inverse, rest);
        let near = plane(first.x, self.inverse.x, self.near.x)
            .max(plane(first.y, self.inverse.y, self.near.y))
            .max(plane(first.z, self.inverse.z, self.near.z));
        let far = plane(second.x, self.inverse.x, self.far.x)
            .min(plane(second.y, self.inverse.y, self.far.y))
            .min(plane(second.z, self.inverse.z, self.far.z));
        (near, far)
    }

    /// The same for boxes given by their lower and upper corners.
    #[inline(always)]
    pub fn pass(&self, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        let (first, second) = in_order(self.inverse, lo, hi);
        self.interval(first, second)
    }
}

/// [`Slabs`] as one method among others.
///
/// Error: no false miss; boxes that are missed by less than two paddings may be passed (`tests/kernel_box.rs`).
/// Source: see [`super`].
pub struct Padded;

impl BoxMethod for Padded {
    type Prepared<L: Lane> = Slabs<L>;

    #[inline(always)]
    fn prepare<L: Lane>(ray: &Ray<L>, padding: Padding) -> Slabs<L> {
        Slabs::new(ray, padding)
    }
    #[inline(always)]
    fn pass<L: Lane>(slabs: &Slabs<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        slabs.pass(lo, hi)
    }
}
