//! Converts texture coordinates to texel indices and filter weights, and decodes texels. The caller reads the
//! texels.
//!
//! Shapes: one lookup per lane; each lane may have a texture of its own.

use crate::lane::functions::polynomial;
use crate::lane::{Bits, Lane};
use crate::math::{BELOW_ONE, Vec3};

/// The points at which textures are read.
#[derive(Clone, Copy, Debug)]
pub struct TexturePoint<L: Lane> {
    /// The texture coordinate to the right; it repeats.
    pub u: L,
    /// The texture coordinate from the top.
    pub v: L,
    /// The lanes in which v is clamped to the edge instead of repeated: those on spheres and the sky.
    pub clamp_v: L::Mask,
    /// The visible area, as in [`super::ray_cone::footprint`]; 0 unless paths carry ray cones.
    pub footprint: L,
}

impl<L: Lane> TexturePoint<L> {
    /// Returns the points at which a texture that repeats shows what a clamped or mirrored one shows at
    /// these, between texel centres in the lanes of `smooth`. `wrap` has one of [`WRAP_CODES`] for u and v
    /// each. Lanes of `clamp_v` keep their point, because u and v go once around a sphere.
    ///
    /// Mirrored texels at an edge are their own neighbours, as clamped ones are: no lookup blends across an
    /// edge. Points stay away from it by half a texel and by more than what rounding could undo.
    ///
    /// Error: less than size · 2⁻²¹ texels.
    #[inline(always)]
    pub fn wrapped(self, grid: &Grid<L>, wrap: [L; 2], smooth: L::Mask) -> Self {
        let (half, one, two) = (L::splat(0.5), L::one(), L::splat(2.0));
        let fold = |x: L, wrap: L, size: L| {
            let period = x - two * (x * half).floor();
            let mirrored = period.min(two - period);
            let inset = (half / size).only(smooth) * L::splat(1.0 + INSET);
            let clamped = L::select(one.lt(wrap), mirrored, x);
            let clamped = clamped.max(inset).min((one - inset) * L::splat(1.0 - INSET));
            L::select(self.clamp_v | wrap.le(L::zero()), x, clamped)
        };
        Self { u: fold(self.u, wrap[0], grid.width), v: fold(self.v, wrap[1], grid.height), ..self }
    }
}

/// Four roundings of single precision.
const INSET: f32 = 4.0 / 16_777_216.0;

/// The codes of textures that repeat, are clamped, and are mirrored.
pub const WRAP_CODES: [f32; 3] = [0.0, 1.0, 2.0];

/// The size and position of each lane's texture among the texels.
#[derive(Clone, Copy, Debug)]
pub struct Grid<L: Lane> {
    /// The number of texels in a row, as floats ≤ 2¹⁴.
    pub width: L,
    /// The number of rows of texels, as floats ≤ 2¹⁴.
    pub height: L,
    /// The index of the first texel.
    pub first: L::Bits,
}

/// Returns x − ⌊x⌋, below 1 even if rounding would give 1 (tiny negative x).
#[inline(always)]
fn fraction<L: Lane>(x: L) -> L {
    (x - x.floor()).min(L::splat(BELOW_ONE))
}

impl<L: Lane> Grid<L> {
    #[inline(always)]
    fn index(&self, column: L, row: L) -> L::Bits {
        let row_start = row.truncate_to_int().wrapping_mul(self.width.truncate_to_int());
        self.first.wrapping_add(row_start).wrapping_add(column.truncate_to_int())
    }

    /// Returns the index of the texel that contains (u, v), v from the top. u repeats; v repeats, or is
    /// clamped to the edge in lanes of `clamp_v`.
    ///
    /// Domain: |u|, |v| < 2²³; indices of any other value, NaN too, stay inside the texture.
    #[inline(always)]
    pub fn nearest(&self, u: L, v: L, clamp_v: L::Mask) -> L::Bits {
        let v = L::select(clamp_v, v, fraction(v));
        self.index(
            self.clamped(fraction(u) * self.width, self.width),
            self.clamped(v * self.height, self.height),
        )
    }

    /// Returns the indices of the four texels around (u, v) in the order ↖ ↗ ↙ ↘, and the weights of the
    /// right column and of the lower row.
    ///
    /// Domain: that of [`Grid::nearest`].
    #[inline(always)]
    pub fn bilinear(&self, u: L, v: L, clamp_v: L::Mask) -> ([L::Bits; 4], L, L) {
        let half = L::splat(0.5);
        let x = fraction(u) * self.width - half;
        let y = L::select(clamp_v, v, fraction(v)) * self.height - half;
        let (left, top) = (x.floor(), y.floor());
        let (right, bottom) = (left + L::one(), top + L::one());
        let wrap = |i: L, size: L| {
            let i = L::select(i.lt(L::zero()), i + size, i);
            L::select(size.le(i), i - size, i)
        };
        let columns = [left, right].map(|i| self.clamped(wrap(i, self.width), self.width));
        let rows =
            [top, bottom].map(|i| self.clamped(L::select(clamp_v, i, wrap(i, self.height)), self.height));
        let texels = [
            self.index(columns[0], rows[0]),
            self.index(columns[1], rows[0]),
            self.index(columns[0], rows[1]),
            self.index(columns[1], rows[1]),
        ];
        (texels, x - left, y - top)
    }

    /// Clamps to [0, size − 1]; NaN to 0.
    #[inline(always)]
    fn clamped(&self, i: L, size: L) -> L {
        i.max(L::zero()).min(size - L::one())
    }
}

/// Decodes an 8-bit unorm texel, red in the lowest byte: bytes over 255.
#[inline(always)]
pub fn unorm_to_unit<L: Lane>(texel: L::Bits) -> Vec3<L> {
    let unit = |byte: L::Bits| L::from_int(byte & L::Bits::splat(0xff)) * L::splat(1.0 / 255.0);
    Vec3::new(unit(texel), unit(texel.shr(8)), unit(texel.shr(16)))
}

/// Decodes an 8-bit sRGB texel, red in the lowest byte, to linear light. It is a polynomial because a table
/// would be read 24 times per packet.
///
/// Error: relative ≤ 1.3e-5, measured over all 256 values, `tests/laws/kernel_texture.rs`.
/// Source: IEC 61966-2-1; coefficients by Lawson's algorithm, minimax in relative error over 11 to 255.
#[inline(always)]
pub fn srgb_to_linear<L: Lane>(texel: L::Bits) -> Vec3<L> {
    // Takes the byte itself, not its 255th part. Even and odd powers are summed apart: shorter chains.
    const EVEN: [f32; 5] = [-1.101_632_4e-20, -5.465_427e-15, -2.713_833_6e-10, 7.317_687e-6, 8.412_828e-4];
    const ODD: [f32; 4] = [1.185_722_9e-17, 1.455_644_4e-12, 5.631_158e-8, 1.407_861_9e-4];
    let linear = |byte: L::Bits| {
        let byte = L::from_int(byte & L::Bits::splat(0xff));
        let squared = byte * byte;
        let curve = polynomial(squared, ODD).mul_add(byte, polynomial(squared, EVEN));
        L::select(byte.le(L::splat(10.0)), byte * L::splat(1.0 / (255.0 * 12.92)), curve)
    };
    Vec3::new(linear(texel), linear(texel.shr(8)), linear(texel.shr(16)))
}
