//! The texels of all textures in two pools, display values and linear radiance, and their lookup over lanes.

use super::rows::Rows;
use crate::kernel::texture::{Grid, srgb_to_linear, unorm_to_unit};
use crate::lane::{Bits, Lane, Mask};
use crate::math::Vec3;
use crate::scene::{Filter, TexelKind, Texels, Texture};

/// All textures of a scene, and a table of the place of each in its pool.
pub struct Textures {
    /// Display values or data, red in the lowest byte. Never empty: inactive lanes read index 0.
    display: Vec<u32>,
    /// Linear radiance. Never empty.
    linear: Vec<[f32; 4]>,
    /// One row a texture: width, height, first texel (bits), bilinear (1 or 0), linear radiance (1 or 0).
    grids: Rows,
    /// At most [`Rows::FEW`] textures.
    few: bool,
}

/// The texture features that a pipeline has.
#[derive(Clone, Copy)]
pub struct Abilities {
    /// Some texture is filtered bilinearly.
    pub bilinear: bool,
    /// Some texture holds linear radiance.
    pub linear: bool,
}

impl Textures {
    pub(super) fn new(textures: &[Texture]) -> Self {
        let (mut display, mut linear, mut grids) = (vec![0], vec![[0.0; 4]], Vec::new());
        for texture in textures {
            let (first, is_linear) = match &texture.texels {
                Texels::Srgb8(texels) | Texels::Unorm8(texels) => {
                    let first = display.len();
                    display.extend(texels.iter().map(|&texel| u32::from_le_bytes(texel)));
                    (first, 0.0)
                }
                Texels::Float32(texels) => {
                    let first = linear.len();
                    linear.extend_from_slice(texels);
                    (first, 1.0)
                }
            };
            let first = u32::try_from(first).expect("scene validation bounds the number of texels");
            let bilinear = if texture.filter == Filter::Bilinear { 1.0 } else { 0.0 };
            let (width, height) = (texture.width as f32, texture.height as f32);
            grids.push([width, height, f32::from_bits(first), bilinear, is_linear, 0.0, 0.0, 0.0]);
        }
        Self { display, linear, grids: Rows::new(grids.into_iter()), few: textures.len() <= Rows::FEW }
    }
    /// Memory of the texels.
    pub fn bytes(&self) -> usize {
        size_of_val(self.display.as_slice()) + size_of_val(self.linear.as_slice()) + self.grids.bytes()
    }

    /// The colour, or the data, of texture `index` at (u, v), v from the top; u repeats, v repeats, or is
    /// clamped to the edge where `clamp_v`. Only lanes in `active` are looked up; the others are unspecified.
    #[inline(always)]
    pub fn sample<L: Lane>(
        &self,
        index: L::Bits,
        (u, v): (L, L),
        clamp_v: L::Mask,
        active: L::Mask,
        abilities: Abilities,
        texel_kind: TexelKind,
    ) -> Vec3<L> {
        let index = L::Bits::select(active, index, L::Bits::splat(0));
        let [width, height, first, is_bilinear, is_linear, ..] = self.grids.fetch::<L>(index, self.few);
        let grid = Grid { width, height, first: first.to_bits() };
        let linear = active & L::zero().lt(is_linear);
        let read = |texel: L::Bits| self.read::<L>(texel, active, linear, abilities, texel_kind);
        let smooth = active & L::zero().lt(is_bilinear);
        if abilities.bilinear && smooth.any() {
            let (texels, right, lower) = grid.bilinear(u, v, clamp_v);
            let [a, b, c, d] = texels.map(&read);
            let mix = |a: Vec3<L>, b: Vec3<L>, t: L| (b - a).mul_add(t, a);
            let blended = mix(mix(a, b, right), mix(c, d, right), lower);
            if (smooth ^ active).any() {
                Vec3::select(smooth, blended, read(grid.nearest(u, v, clamp_v)))
            } else {
                blended
            }
        } else {
            read(grid.nearest(u, v, clamp_v))
        }
    }

    /// Texels of the lanes in `active`; those in `linear` come from the pool of linear radiance.
    #[inline(always)]
    fn read<L: Lane>(
        &self,
        texel: L::Bits,
        active: L::Mask,
        linear: L::Mask,
        abilities: Abilities,
        texel_kind: TexelKind,
    ) -> Vec3<L> {
        let zero = L::Bits::splat(0);
        let display = active & !linear;
        let mut color = Vec3::zero();
        if !abilities.linear || display.any() {
            let texel = L::Bits::select(display, texel, zero);
            let texel = L::gather_bits(&self.display, texel);
            color = match texel_kind {
                TexelKind::Color => srgb_to_linear::<L>(texel),
                TexelKind::Data => unorm_to_unit::<L>(texel),
            };
        }
        if abilities.linear && linear.any() {
            let [r, g, b, _] = L::gather_rows::<4>(&self.linear, L::Bits::select(linear, texel, zero));
            color = Vec3::select(linear, Vec3::new(r, g, b), color);
        }
        color
    }
}
