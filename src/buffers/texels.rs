//! Texels of all textures in one pool.

use super::rows::Rows;
use crate::kernel::texture::Grid;
use crate::lane::{Bits, Lane, Mask};
use crate::math::Vec3;
use crate::scene::{Filter, Texture};

/// All textures of a scene: linear RGB in rows of four floats, one pool, and a table of where each texture lies in it.
pub struct Textures {
    texels: Vec<[f32; 4]>,
    /// Width, height, first texel (bits), bilinear (1 or 0); one row a texture.
    grids: Rows,
    /// At most [`Rows::FEW`] textures.
    few: bool,
}

impl Textures {
    pub(super) fn new(textures: &[Texture]) -> Self {
        let mut texels = Vec::with_capacity(textures.iter().map(|texture| texture.texels.len()).sum());
        let mut grids = Vec::with_capacity(textures.len());
        for texture in textures {
            let first = u32::try_from(texels.len()).expect("scene validation bounds the number of texels");
            let bilinear = if texture.filter == Filter::Bilinear { 1.0 } else { 0.0 };
            let (width, height) = (texture.width as f32, texture.height as f32);
            grids.push([width, height, f32::from_bits(first), bilinear, 0.0, 0.0, 0.0, 0.0]);
            texels.extend_from_slice(&texture.texels);
        }
        Self { texels, grids: Rows::new(grids.into_iter()), few: textures.len() <= Rows::FEW }
    }
    pub fn bytes(&self) -> usize {
        size_of_val(self.texels.as_slice()) + self.grids.bytes()
    }

    /// The colour of texture `index` at (u, v), v from the top; u repeats, v repeats or stays at the edge where `clamp_v`. Only
    /// lanes of `wanted` are looked up; the others are unspecified. `bilinear`: some texture of the scene is.
    #[inline(always)]
    pub fn sample<L: Lane>(
        &self,
        index: L::Bits,
        (u, v): (L, L),
        clamp_v: L::Mask,
        wanted: L::Mask,
        bilinear: bool,
    ) -> Vec3<L> {
        let index = L::Bits::select(wanted, index, L::Bits::splat(0));
        let [width, height, first, is_bilinear, ..] = self.grids.fetch::<L>(index, self.few);
        let grid = Grid { width, height, first: first.to_bits() };
        let smooth = wanted & L::zero().lt(is_bilinear);
        if bilinear && smooth.any() {
            let (texels, right, lower) = grid.bilinear(u, v, clamp_v);
            let [a, b, c, d] = texels.map(|texel| self.read(texel));
            let mix = |a: Vec3<L>, b: Vec3<L>, t: L| (b - a).mul_add(t, a);
            let blended = mix(mix(a, b, right), mix(c, d, right), lower);
            if (smooth ^ wanted).any() {
                Vec3::select(smooth, blended, self.read(grid.nearest(u, v, clamp_v)))
            } else {
                blended
            }
        } else {
            self.read(grid.nearest(u, v, clamp_v))
        }
    }

    #[inline(always)]
    fn read<L: Lane>(&self, texel: L::Bits) -> Vec3<L> {
        let [r, g, b, _] = L::gather_rows::<4>(&self.texels, texel);
        Vec3::new(r, g, b)
    }
}
