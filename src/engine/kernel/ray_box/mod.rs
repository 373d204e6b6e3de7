//! Rays against boxes along the axes, by several methods side by side; pictures are made with [`Slabs`].
//!
//! The law of a hierarchy is that it loses no hit. Two things together keep it:
//!
//! - A box is padded for the ray, by more than rounding can move a hit out of it ([`Slabs::new`]).
//! - A triangle is hit only where the ray also passes the triangle's own box, by the same formula, and its t is moved into the box's
//!   interval ([`own_box`]): on slivers the computed t may lie far off. The formula is monotone in the planes, so boxes that contain
//!   each other have intervals that contain each other exactly, and a hit in a box is in every box around it.
//!
//! Source: the slab test of Kay, Kajiya, 1986, as one FMA a plane; padding instead of Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.

mod forms;
mod slabs;

pub use forms::{BySign, BySignWidened, Contracted, IeeeMinMax, X86MinMax};
pub use slabs::{Padded, Slabs};

use crate::lane::Lane;
use crate::math::{Ray, Vec3};

/// A way to intersect rays with a box.
///
/// Shapes: `WIDTH` rays against `WIDTH` boxes, lane by lane.
/// Units: t in multiples of the direction's length.
/// Domain: any direction; the method says what becomes of those along an axis. Boxes whose lower corner is not above the upper one.
/// The box is passed if the ray enters it not after it leaves it, and does not leave it before its own origin.
pub trait BoxMethod: Send + Sync + 'static {
    /// What is computed once per ray.
    type Prepared<L: Lane>: Copy;

    /// `reach` is of use to methods that pad.
    fn prepare<L: Lane>(ray: &Ray<L>, padding: Padding) -> Self::Prepared<L>;

    /// Where each ray enters and leaves its box, given by its lower and upper corner.
    fn pass<L: Lane>(ray: &Self::Prepared<L>, lo: Vec3<L>, hi: Vec3<L>) -> (L, L);
}

/// What a scene adds to the padding of its boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Padding {
    /// The largest absolute coordinate of any box.
    extent: f32,
    /// [`OF_ORIGIN`] where there are spheres, else 0.
    spheres: f32,
    /// How much of all that a ray's boxes are padded by: [`PADDING`], or nothing.
    padding: f32,
}

/// Eight roundings: 2⁻²¹.
const PADDING: f32 = 1.0 / 2_097_152.0;

/// Spheres may seem to be hit up to r 2⁻¹⁶ + D 2⁻¹⁹ outside, D the distance of ray origin and centre: 32 ε D, and something for directions
/// that are not of unit length. With D ≤ |o| + |c| the parts of r and c widen the sphere's own box ([`room_of_sphere`]), |o| all boxes.
///
/// What must be shown: where the robust test finds a hit, the line passes a sphere of that larger radius R, and the hit is not before the
/// line enters it, or the origin is in it. (Behind it the hit may be: boxes are left out by where rays enter them.) f = o − c as rounded;
/// the line passes the centre at the distance H, B ahead of the origin; b = B + β, |β| ≤ 3 ε D; h² is the discriminant, Q = b + h.
///
/// - The perpendicular is off by ε D + ε r across the ray, and along it by some α, which makes it longer: H² + h² ≤ r² − α² + η and
///   r² − H² ≤ h² + α² + η, η = 2 ε r D + 6 ε r². So H < R.
/// - From inside, c ≤ 0: then D < R.
/// - From outside t = c / Q, where c = B² + H² − r² is off by δ = 3 ε D² + ε r², and t by 4 ε t. The hit is before the line's nearest
///   point by B − t ≤ h + ρ, ρ = 7 ε D + (α² + η + δ) / Q. Its distance x from the centre has
///   x² ≤ H² + (h + ρ)² ≤ r² + η + 14 ε r D + min(1, 2 r / D) (η + δ) + ρ²: as h ≤ Q / 2, α² is made up for by the α² above.
/// - Where t = Q, because c / Q is beyond it, B − t = −β − h, less than that.
/// - Where Q² ≥ 24 ε D² that is (r + 20 ε D)² at most; elsewhere D² = H² + B² is. The rounding of f moves all of it by ε D: 21 in all.
/// - A direction of length 1 + e multiplies b and t: what is left is e h (B − h) / (B + h) < e r, and |e| ≤ 10⁻⁵ < 2⁻¹⁶.
///
/// Measured: 5.2 ε D at most, with FMA and without (`tests/kernel_sphere_box.rs`, which fails if this were eight times less).
const OF_ORIGIN: f32 = 4.0;

/// How much larger the box of a sphere is made on every side, so that what seems to be hit of the sphere lies in it: see `OF_ORIGIN`.
pub fn room_of_sphere(center: glam::Vec3, radius: f32) -> f32 {
    radius * f32::powi(0.5, 16) + center.length() * f32::powi(0.5, 19)
}

impl Padding {
    /// Of a scene whose boxes have no coordinate beyond this.
    pub const fn new(extent: f32) -> Self {
        Self { extent, spheres: 0.0, padding: PADDING }
    }
    /// Makes room for the hits of spheres.
    pub const fn with_spheres(self) -> Self {
        Self { spheres: OF_ORIGIN, ..self }
    }
    /// Loses hits: to see what padding is for.
    pub const fn without_padding(self) -> Self {
        Self { padding: 0.0, ..self }
    }
    /// All that padding is measured against for a ray from here, without |o| itself: in units of 2²¹.
    #[inline(always)]
    pub fn room<L: Lane>(&self, origin: Vec3<L>) -> L {
        let far = origin.x.abs() + origin.y.abs() + origin.z.abs();
        L::splat(self.spheres).mul_add(far, L::splat(self.extent))
    }
}

/// The planes of a box in the order in which a ray meets them, by the sign of what it divides by.
#[inline(always)]
fn in_order<L: Lane>(inverse: Vec3<L>, lo: Vec3<L>, hi: Vec3<L>) -> (Vec3<L>, Vec3<L>) {
    let backwards = |inverse: L| inverse.lt(L::zero());
    let [x, y, z] = [inverse.x, inverse.y, inverse.z].map(backwards);
    let pick = |a: Vec3<L>, b: Vec3<L>| {
        Vec3::new(L::select(x, b.x, a.x), L::select(y, b.y, a.y), L::select(z, b.z, a.z))
    };
    (pick(lo, hi), pick(hi, lo))
}

/// The rule of the own box: of lanes that hit a triangle at `t`, those that pass its box in front of `limit`, and t moved into it.
#[inline(always)]
pub fn own_box<L: Lane>(
    slabs: &Slabs<L>,
    (lo, hi): (Vec3<L>, Vec3<L>),
    hit: L::Mask,
    t: L,
    limit: L,
) -> (L::Mask, L) {
    let (near, far) = slabs.pass(lo, hi);
    let t = t.min(far).max(near);
    (hit & near.le(far) & L::zero().lt(t) & t.lt(limit), t)
}
