//! The interface of ray/box methods.

use super::padding::Padding;
use crate::lane::Lane;
use crate::math::{Ray, Vec3};

/// A method of intersecting rays with axis-aligned boxes. A ray passes a box if it enters it no later than it
/// leaves it, and does not leave it before its own origin.
///
/// Shapes: `WIDTH` rays against `WIDTH` boxes, lane by lane.
/// Units: t in multiples of the direction's length.
/// Domain: any direction; the method says what becomes of those along an axis. Boxes whose lower corner is
/// not above the upper one.
pub trait BoxMethod: Send + Sync + 'static {
    /// What is computed once per ray.
    type Prepared<L: Lane>: Copy;

    /// Methods without padding ignore `padding`.
    fn prepare<L: Lane>(ray: &Ray<L>, padding: Padding) -> Self::Prepared<L>;

    /// The t at which each ray enters and leaves its box, given by its lower and upper corner.
    fn pass<L: Lane>(ray: &Self::Prepared<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L);
}

/// The planes of a box in the order in which a ray meets them, by the sign of 1 / direction.
#[inline(always)]
pub(super) fn in_order<L: Lane>(inverse: Vec3<L>, lo: Vec3<L>, hi: Vec3<L>) -> (Vec3<L>, Vec3<L>) {
    let backwards = |inverse: L| inverse.lt(L::zero());
    let [x, y, z] = [inverse.x, inverse.y, inverse.z].map(backwards);
    let pick = |a: Vec3<L>, b: Vec3<L>| {
        Vec3::new(L::select(x, b.x, a.x), L::select(y, b.y, a.y), L::select(z, b.z, a.z))
    };
    (pick(lo, hi), pick(hi, lo))
}
