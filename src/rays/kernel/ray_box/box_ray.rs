//! The slab test: one FMA per plane, and padding that covers its rounding.

use super::padding::Padding;
use crate::lane::Lane;
use crate::math::{Ray, Vec3};

/// A ray prepared for box tests: between a pair of planes t runs from `plane · inverse + near` to `plane ·
/// inverse + far`.
#[derive(Clone, Copy, Debug)]
pub struct BoxRay<L> {
    /// 1 / direction, finite: each component of the direction is made at least 2⁻⁶⁰ of its length.
    pub inverse: Vec3<L>,
    /// −origin / direction − padding.
    pub near: Vec3<L>,
    /// −origin / direction + padding.
    pub far: Vec3<L>,
}

impl<L: Lane> BoxRay<L> {
    /// Prepares a ray. The padding is (|o| + room) 2⁻²¹ |1/d| along each axis, with |o| along that axis and
    /// the room from [`Padding::room`]: eight roundings of the sum in the FMA.
    ///
    /// Units: the padding is in units of t.
    /// Error: no hit is lost, at corners, in the planes of faces and in nearly axis-parallel directions
    /// (`tests/laws/hierarchy_laws.rs`).
    #[inline(always)]
    pub fn new(ray: &Ray<L>, padding: Padding) -> Self {
        let d = ray.direction;
        // The sum of the components and not the largest: a NaN in one component then reaches all planes, and
        // the ray misses every box.
        let least = (d.x.abs() + d.y.abs() + d.z.abs()) * L::splat(f32::powi(0.5, 60));
        let (room, relative) = (padding.room(ray.origin), padding.relative::<L>());
        let axis = |origin: L, direction: L| {
            let inverse = L::one() / direction.abs().max(least).copysign(direction);
            let middle = -(origin * inverse);
            let padding = (origin.abs() + room) * inverse.abs() * relative;
            (inverse, middle - padding, middle + padding)
        };
        let (x, y, z) = (axis(ray.origin.x, d.x), axis(ray.origin.y, d.y), axis(ray.origin.z, d.z));
        Self {
            inverse: Vec3::new(x.0, y.0, z.0),
            near: Vec3::new(x.1, y.1, z.1),
            far: Vec3::new(x.2, y.2, z.2),
        }
    }

    /// Returns the t at which each ray enters and leaves its box, whose planes are given in the order in
    /// which the ray meets them (the slab test). The ray passes the box if the first t is not above the
    /// second; the first may be negative.
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

    /// Applies [`BoxRay::interval`] to boxes given by their lower and upper corners.
    #[inline(always)]
    pub fn pass(&self, lo: Vec3<L>, hi: Vec3<L>) -> (L, L) {
        let (first, second) = in_order(self.inverse, lo, hi);
        self.interval(first, second)
    }
}

/// Returns the planes of a box in the order in which a ray meets them, by the sign of 1 / direction.
#[inline(always)]
pub fn in_order<L: Lane>(inverse: Vec3<L>, lo: Vec3<L>, hi: Vec3<L>) -> (Vec3<L>, Vec3<L>) {
    let backwards = |inverse: L| inverse.lt(L::zero());
    let [x, y, z] = [inverse.x, inverse.y, inverse.z].map(backwards);
    let pick = |a: Vec3<L>, b: Vec3<L>| {
        Vec3::new(L::select(x, b.x, a.x), L::select(y, b.y, a.y), L::select(z, b.z, a.z))
    };
    (pick(lo, hi), pick(hi, lo))
}

/// Restricts triangle hits at `t` to the triangle's own box. Returns the lanes of `hit` that pass the box
/// before `limit`, and t clamped to the box's interval.
#[inline(always)]
pub fn own_box<L: Lane>(
    box_ray: &BoxRay<L>,
    (lo, hi): (Vec3<L>, Vec3<L>),
    hit: L::Mask,
    t: L,
    limit: L,
) -> (L::Mask, L) {
    let (near, far) = box_ray.pass(lo, hi);
    let t = t.min(far).max(near);
    (hit & near.le(far) & L::zero().lt(t) & t.lt(limit), t)
}
