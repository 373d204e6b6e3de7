//! The padding of boxes for a ray, so that rounding loses no hit.

use crate::lane::Lane;
use crate::math::Vec3;

/// The scene's part of the padding. [`Padding::room`] adds the ray's part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Padding {
    /// The largest absolute coordinate of any box.
    extent: f32,
    /// `OF_ORIGIN` if the scene has spheres, else 0.
    spheres: f32,
    /// The padding relative to [`Padding::room`]: `EIGHT_ROUNDINGS`, or 0 without padding.
    relative: f32,
}

/// Eight roundings as a relative error: 2⁻²¹.
const EIGHT_ROUNDINGS: f32 = 1.0 / 2_097_152.0;

/// The weight of |o| in the padding if the scene has spheres.
///
/// The computed hit of a sphere may lie up to r 2⁻¹⁶ + D 2⁻¹⁹ outside it, where D is the distance from the
/// ray's origin to the centre: 32 ε D, and a margin for directions not of unit length. Since D ≤ |o| + |c|,
/// the terms in r and c pad the sphere's own box ([`sphere_padding`]), and the term in |o| pads all boxes.
///
/// Claim: if the robust test finds a hit, the line passes a sphere of that larger radius R, and the hit is
/// not before the line enters it, or the origin is in it. (The hit may lie behind it: boxes are culled by
/// where rays enter them.) Let f = o − c as rounded; the line passes the centre at the distance H, B ahead of
/// the origin; b = B + β, |β| ≤ 3 ε D; h² is the discriminant, Q = b + h.
///
/// - The perpendicular is off by ε D + ε r across the ray, and along it by some α, which makes it longer:
///   H² + h² ≤ r² − α² + η and r² − H² ≤ h² + α² + η, η = 2 ε r D + 6 ε r². So H < R.
/// - From inside, c ≤ 0: then D < R.
/// - From outside t = c / Q, where c = B² + H² − r² is off by δ = 3 ε D² + ε r², and t by 4 ε t. The hit is
///   before the line's nearest point by B − t ≤ h + ρ, ρ = 7 ε D + (α² + η + δ) / Q. Its distance x from the
///   centre has x² ≤ H² + (h + ρ)² ≤ r² + η + 14 ε r D + min(1, 2 r / D) (η + δ) + ρ²: as h ≤ Q / 2, the α²
///   above cancels this α².
/// - Where t = Q, because c / Q is larger, B − t = −β − h, less than that.
/// - Where Q² ≥ 24 ε D² that is (r + 20 ε D)² at most; elsewhere D² = H² + B² is. The rounding of f moves all
///   of it by ε D: 21 in all.
/// - A direction of length 1 + e multiplies b and t: what remains is e h (B − h) / (B + h) < e r, and |e| ≤
///   10⁻⁵ < 2⁻¹⁶.
///
/// Measured: 5.2 ε D at most, with FMA and without (`tests/laws/kernel_sphere_box.rs`, which fails if this
/// were eight times less).
const OF_ORIGIN: f32 = 4.0;

/// Returns the padding of a sphere's box on every side, so that computed hits lie in it: see `OF_ORIGIN`.
///
/// Units: scene units.
pub fn sphere_padding(center: glam::Vec3, radius: f32) -> f32 {
    radius * f32::powi(0.5, 16) + center.length() * f32::powi(0.5, 19)
}

/// Returns the lower and upper corner of a box that holds a sphere and all computed hit points, except for
/// the part of their error that grows with the distance of the ray's origin ([`Padding`] covers that).
/// Rounding moves centre ± radius by at most half a unit in the last place, so one unit outwards is enough.
/// Domain: |centre| + radius well below f32's largest number, which scene validation ensures.
pub fn sphere_bounds(center: glam::Vec3, radius: f32) -> [glam::Vec3; 2] {
    let outwards = |x: glam::Vec3, to: fn(f32) -> f32| glam::Vec3::new(to(x.x), to(x.y), to(x.z));
    let half = radius + sphere_padding(center, radius);
    [outwards(center - half, f32::next_down), outwards(center + half, f32::next_up)]
}

impl Padding {
    /// Returns the padding for a scene whose boxes have no coordinate beyond `extent`.
    pub const fn new(extent: f32) -> Self {
        Self { extent, spheres: 0.0, relative: EIGHT_ROUNDINGS }
    }
    /// Adds room for the hits of spheres: see `OF_ORIGIN`.
    pub const fn with_spheres(self) -> Self {
        Self { spheres: OF_ORIGIN, ..self }
    }
    /// Removes the padding, which loses hits: for tests and charts.
    pub const fn without_padding(self) -> Self {
        Self { relative: 0.0, ..self }
    }
    /// Returns the largest absolute coordinate of any box.
    pub const fn extent(&self) -> f32 {
        self.extent
    }
    /// Returns the padding's base for a ray from `origin`, without the |o| along each axis, in scene units.
    #[inline(always)]
    pub fn room<L: Lane>(&self, origin: Vec3<L>) -> L {
        let far = origin.x.abs() + origin.y.abs() + origin.z.abs();
        L::splat(self.spheres).mul_add(far, L::splat(self.extent))
    }
    /// Returns the padding relative to |o| + [`Padding::room`].
    #[inline(always)]
    pub(super) fn relative<L: Lane>(&self) -> L {
        L::splat(self.relative)
    }
}
