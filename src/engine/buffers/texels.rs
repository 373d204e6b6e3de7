//! Stores the texels of all textures, as display values or linear radiance, and looks them up over lanes.

use super::mip_chain::mip_chain;
use super::rows::Rows;
use crate::kernel::ray_cone::level_of_detail;
use crate::kernel::texture::{Grid, TexturePoint, WRAP_CODES, srgb_to_linear, unorm_to_unit};
use crate::lane::{Bits, Lane, Mask};
use crate::math::Vec3;
use crate::scene::{Filter, TexelKind, Texels, Texture, Wrap};

/// All textures of a scene, and a table with the position of each in its pool.
pub struct Textures {
    /// Display values or data, red in the lowest byte. Never empty, because inactive lanes read index 0.
    display: Vec<u32>,
    /// Linear radiance. Never empty.
    linear: Vec<[f32; 4]>,
    /// One row per texture: width, height, first texel (bits), bilinear (1 or 0), linear radiance (1 or 0),
    /// last level of detail, first row in `levels` (bits).
    grids: Rows,
    /// One row per level of detail, each texture's own texels first: width, height, first texel (bits), the
    /// [`WRAP_CODES`] along u and v. Empty
    /// if no texture has levels or a wrap other than repeating.
    levels: Rows,
    /// Whether some texture does not repeat.
    wraps: bool,
    /// Whether there are at most [`Rows::FEW`] textures.
    few: bool,
}

/// The texture features of a pipeline.
#[derive(Clone, Copy)]
pub struct Abilities {
    /// Whether some texture is filtered bilinearly.
    pub bilinear: bool,
    /// Whether some texture holds linear radiance.
    pub linear: bool,
    /// Whether some texture has [`super::Features::LONG_LOOKUPS`]. If none has, `levels` is empty.
    pub levels: bool,
}

/// The parameters of a lookup.
#[derive(Clone, Copy)]
struct Lookup<L: Lane> {
    /// The lanes that read.
    active: L::Mask,
    abilities: Abilities,
    texel_kind: TexelKind,
}

impl Textures {
    pub(super) fn new(textures: &[Texture]) -> Self {
        let (mut display, mut linear) = (vec![0], vec![[0.0; 4]]);
        let (mut grids, mut levels) = (Vec::new(), Vec::new());
        let wraps = textures.iter().any(|texture| texture.wrap != [Wrap::Repeat; 2]);
        let has_levels = wraps || textures.iter().any(|texture| texture.filter == Filter::Trilinear);
        let mut add = |[width, height]: [u32; 2], texels: &Texels| {
            let first = match texels {
                Texels::Srgb8(texels) | Texels::Unorm8(texels) => {
                    display.extend(texels.iter().map(|&texel| u32::from_le_bytes(texel)));
                    display.len() - texels.len()
                }
                Texels::Float32(texels) => {
                    linear.extend_from_slice(texels);
                    linear.len() - texels.len()
                }
            };
            let first = u32::try_from(first).expect("scene validation bounds the number of texels");
            [width as f32, height as f32, f32::from_bits(first)]
        };
        for texture in textures {
            let [width, height, first] = add([texture.width, texture.height], &texture.texels);
            let flag = |is: bool| f32::from(u8::from(is));
            let is_bilinear = flag(texture.filter != Filter::Nearest);
            let is_linear = flag(matches!(texture.texels, Texels::Float32(_)));
            let (row, mut last) = (f32::from_bits(levels.len() as u32), 0.0);
            if has_levels {
                let [along_u, along_v] = texture.wrap.map(|wrap| WRAP_CODES[wrap as usize]);
                levels.push([width, height, first, along_u, along_v, 0.0, 0.0, 0.0]);
                for (size, texels) in mip_chain(texture) {
                    let [width, height, first] = add(size, &texels);
                    levels.push([width, height, first, along_u, along_v, 0.0, 0.0, 0.0]);
                    last += 1.0;
                }
            }
            grids.push([width, height, first, is_bilinear, is_linear, last, row, 0.0]);
        }
        let (grids, levels) = (Rows::new(grids.into_iter()), Rows::new(levels.into_iter()));
        Self { display, linear, grids, levels, wraps, few: textures.len() <= Rows::FEW }
    }

    /// Returns the colour or data of texture `index` at a point. Only lanes in `active` are looked up; the
    /// others are unspecified.
    #[inline(always)]
    pub fn sample<L: Lane>(
        &self,
        index: L::Bits,
        at: TexturePoint<L>,
        active: L::Mask,
        abilities: Abilities,
        texel_kind: TexelKind,
    ) -> Vec3<L> {
        if abilities.levels {
            return self.sample_levels(index, at, active, texel_kind);
        }
        let index = L::Bits::select(active, index, L::Bits::splat(0));
        let [width, height, first, is_bilinear, is_linear, ..] = self.grids.fetch::<L>(index, self.few);
        let grid = Grid { width, height, first: first.to_bits() };
        self.filter(&grid, [is_bilinear, is_linear], at, Lookup { active, abilities, texel_kind })
    }

    /// Returns the indices of the texels of texture `index` nearest to a point, for
    /// [`Textures::read_texels`]; 0 in lanes that are not `active`.
    ///
    /// Domain: textures of display values.
    #[inline(always)]
    pub fn nearest_texels<L: Lane>(&self, index: L::Bits, at: TexturePoint<L>, active: L::Mask) -> L::Bits {
        let zero = L::Bits::splat(0);
        let index = L::Bits::select(active, index, zero);
        let [width, height, first, ..] = self.grids.fetch::<L>(index, self.few);
        let grid = Grid { width, height, first: first.to_bits() };
        L::Bits::select(active, grid.nearest(at.u, at.v, at.clamp_v), zero)
    }

    /// Replaces the indices of texels by the texels.
    ///
    /// # Panics
    /// If an index did not come from [`Textures::nearest_texels`].
    #[inline(never)]
    pub fn read_texels(&self, texels: &mut [u32]) {
        for texel in texels {
            *texel = self.display[*texel as usize];
        }
    }

    /// [`Textures::sample`] for textures with levels of detail, of which some may not repeat: the level that
    /// the footprint chooses, blended with the next one.
    ///
    /// Not inlined: it is rarely needed, and much code.
    #[inline(never)]
    fn sample_levels<L: Lane>(
        &self,
        index: L::Bits,
        at: TexturePoint<L>,
        active: L::Mask,
        texel_kind: TexelKind,
    ) -> Vec3<L> {
        let zero = L::Bits::splat(0);
        let index = L::Bits::select(active, index, zero);
        let [width, height, _, is_bilinear, is_linear, last, row, _] = self.grids.fetch::<L>(index, self.few);
        let abilities = Abilities { bilinear: true, linear: true, levels: true };
        let filter = |level: L, active: L::Mask| {
            let index = row.to_bits().wrapping_add(level.truncate_to_int());
            let [width, height, first, along_u, along_v, ..] =
                self.levels.fetch::<L>(L::Bits::select(active, index, zero), false);
            let grid = Grid { width, height, first: first.to_bits() };
            let smooth = L::zero().lt(is_bilinear);
            let at = if self.wraps { at.wrapped(&grid, [along_u, along_v], smooth) } else { at };
            self.filter(&grid, [is_bilinear, is_linear], at, Lookup { active, abilities, texel_kind })
        };
        let level = level_of_detail(at.footprint, width * height, last);
        let lower = level.floor();
        let color = filter(lower, active);
        let blend = level - lower;
        let between = active & L::zero().lt(blend);
        if !between.any() {
            return color;
        }
        let coarser = filter(lower + L::one(), between);
        Vec3::select(between, (coarser - color).mul_add(blend, color), color)
    }

    /// Returns the texture at a point of a level. `is_bilinear` and `is_linear` come from the table.
    #[inline(always)]
    fn filter<L: Lane>(
        &self,
        grid: &Grid<L>,
        [is_bilinear, is_linear]: [L; 2],
        TexturePoint { u, v, clamp_v, .. }: TexturePoint<L>,
        lookup: Lookup<L>,
    ) -> Vec3<L> {
        let Lookup { active, abilities, .. } = lookup;
        let linear = active & L::zero().lt(is_linear);
        let read = |texel: L::Bits| self.read::<L>(texel, linear, lookup);
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

    /// Returns texels; those of the lanes in `linear` come from the pool of linear radiance.
    #[inline(always)]
    fn read<L: Lane>(
        &self,
        texel: L::Bits,
        linear: L::Mask,
        Lookup { active, abilities, texel_kind }: Lookup<L>,
    ) -> Vec3<L> {
        let zero = L::Bits::splat(0);
        let display = active & !linear;
        let mut color = Vec3::zero();
        if !abilities.linear || display.any() {
            let texel = L::Bits::select(display, texel, zero);
            let texel = L::gather_bits(&self.display, texel);
            color = match texel_kind {
                TexelKind::Color => srgb_to_linear::<L>(texel),
                TexelKind::Data | TexelKind::Alpha | TexelKind::AlphaOrGrey => unorm_to_unit::<L>(texel),
            };
        }
        if abilities.linear && linear.any() {
            let [r, g, b, _] = L::gather_rows::<4>(&self.linear, L::Bits::select(linear, texel, zero));
            color = Vec3::select(linear, Vec3::new(r, g, b), color);
        }
        color
    }
}
