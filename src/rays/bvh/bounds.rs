//! Axis-aligned boxes: as lower and upper corner, and packed into one register for the builder.

use super::node::Child;
use crate::lane::{F32x8, Lane, Mask8};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The points between `lo` and `hi`, faces included. Units: scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lower corner.
    pub lo: Vec3,
    /// The upper corner.
    pub hi: Vec3,
}

impl Bounds {
    /// The empty box: the identity of `union`; no ray hits it.
    pub const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    /// Creates a box from its lower and upper corner.
    pub const fn new([lo, hi]: [Vec3; 2]) -> Self {
        Self { lo, hi }
    }
    /// Returns the smallest box that holds both.
    pub fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }
    /// Tests whether this box holds all points of the other one.
    pub fn contains(self, other: Self) -> bool {
        self.lo.cmple(other.lo).all() && self.hi.cmpge(other.hi).all()
    }
    /// Tests whether the box holds no point.
    pub fn is_empty(self) -> bool {
        !self.lo.cmple(self.hi).all()
    }
    /// Returns half the surface area in f64, which holds the square of every f32; 0 for the empty box.
    pub fn half_area(self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let e = self.hi.as_dvec3() - self.lo.as_dvec3();
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}

/// A box as one packet: `lo` in lanes 0 to 2, `−hi` in lanes 4 to 6, so that a union is one `min`.
///
/// Lane 3 holds the primitive's number in boxes of primitives; lanes 3 and 7 are undefined in unions.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct PackedBox(F32x8);

/// Numbers are stored as the bits of floats from 2⁻¹⁰³ upwards. Arithmetic runs over them as over the other
/// lanes, and some processors are a hundred times slower with denormal operands or results. Two of these
/// floats differ by at least 2⁻¹²⁶, the smallest normal float.
const NUMBER_BASE: u32 = 0x0C00_0000;
/// The largest number of primitives in a hierarchy: their numbers stay finite floats, and every leaf has a
/// reference.
pub const MAX_PRIMITIVES: usize = Child::INDEX as usize + 1;
const _: () = assert!(f32::from_bits(NUMBER_BASE + MAX_PRIMITIVES as u32 - 1).is_finite());

impl PackedBox {
    pub fn new(bounds: Bounds, number: u32) -> Self {
        let ([a, b, c], [x, y, z]) = (bounds.lo.to_array(), (-bounds.hi).to_array());
        Self(bytemuck::cast([a, b, c, f32::from_bits(number + NUMBER_BASE), x, y, z, 0.0]))
    }
    #[inline(always)]
    pub fn empty() -> Self {
        Self(F32x8::splat(f32::INFINITY))
    }
    /// Returns the number of the primitive; undefined for unions.
    #[inline(always)]
    pub fn number(self) -> u32 {
        bytemuck::cast::<_, [u32; 8]>(self.0)[3] - NUMBER_BASE
    }
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    pub fn bounds(self) -> Bounds {
        let [a, b, c, _, x, y, z, _]: [f32; 8] = bytemuck::cast(self.0);
        Bounds { lo: Vec3::new(a, b, c), hi: -Vec3::new(x, y, z) }
    }
    #[inline(always)]
    pub fn lanes(self) -> F32x8 {
        self.0
    }
    /// Returns the box if `mask` is true, else the empty box. Domain: `mask` is the same in all lanes.
    #[inline(always)]
    pub fn only(self, mask: Mask8) -> Self {
        Self(F32x8::select(mask, self.0, F32x8::splat(f32::INFINITY)))
    }
    /// Exchanges the lower and the upper half: `−hi`, `lo`.
    #[inline(always)]
    fn swapped(self) -> F32x8 {
        F32x8::pick(bytemuck::cast_ref(&self.0), bytemuck::cast([4, 5, 6, 7, 0, 1, 2, 3]))
    }
    /// Returns twice the centre as a box of one point: lo + hi, −(lo + hi).
    #[inline(always)]
    pub fn center(self) -> Self {
        Self(self.0 - self.swapped())
    }
    /// Returns hi − lo in lanes 0 to 2, never negative.
    #[inline(always)]
    pub fn extent(self) -> [f32; 3] {
        let [x, y, z, ..]: [f32; 8] = bytemuck::cast((-(self.0 + self.swapped())).max(F32x8::zero()));
        [x, y, z]
    }
    pub fn half_area(self) -> f64 {
        let [x, y, z] = self.extent();
        let (x, y, z) = (f64::from(x), f64::from(y), f64::from(z));
        x * y + y * z + z * x
    }
    /// Returns half the surface areas of eight boxes, times `scale`²; 0 for empty ones.
    #[inline(always)]
    pub fn half_areas(boxes: &[Self; 8], scale: F32x8) -> F32x8 {
        let rows: &[[f32; 8]] = bytemuck::cast_slice(boxes);
        let [a, b, c, _, x, y, z, _] = F32x8::gather_rows(rows, bytemuck::cast([0, 1, 2, 3, 4, 5, 6, 7]));
        let extent = |lo: F32x8, minus_hi: F32x8| (-(lo + minus_hi) * scale).max(F32x8::zero());
        let (x, y, z) = (extent(a, x), extent(b, y), extent(c, z));
        x.mul_add(y + z, y * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_primitives_bring_no_denormals_into_arithmetic() {
        let bounds = Bounds { lo: Vec3::ZERO, hi: Vec3::ONE };
        let last = MAX_PRIMITIVES as u32 - 1;
        for (a, b) in [(0, 1), (7, 3), (0x7f_ffff, 0x80_0000), (last - 1, last), (0, last)] {
            let (a, b) = (PackedBox::new(bounds, a), PackedBox::new(bounds, b));
            let centers = a.center().union(b.center());
            let differences = [b.lanes() - a.lanes(), a.center().lanes() - centers.lanes()];
            for lanes in [a.lanes(), centers.lanes(), centers.lanes() + centers.swapped()]
                .into_iter()
                .chain(differences)
            {
                assert!(
                    (0..8).all(|lane| lanes.get(lane).is_finite() && !lanes.get(lane).is_subnormal()),
                    "{lanes:?}"
                );
            }
        }
        assert_eq!(PackedBox::new(bounds, last).number(), last);
    }
}
