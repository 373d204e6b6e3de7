//! The means of blocks of a texture, which measure the light of textured emitters.

use super::mip_chain::halve;
use crate::scene::{Texture, Wrap};
use glam::{DVec2, DVec3};

/// The number of points along each side of a grid over a primitive at which its texture is read, and the
/// largest multiple of it along a side that has more texels.
pub(crate) const GRID: usize = 16;
const MOST_FINER: f64 = 16.0;

/// Iterates over the centres of the cells of a grid of columns and rows over the unit square.
fn grid([columns, rows]: [usize; 2]) -> impl Iterator<Item = DVec2> + Clone {
    let center = move |cell| DVec2::new((cell % columns) as f64 + 0.5, (cell / columns) as f64 + 0.5);
    (0..columns * rows).map(move |cell| center(cell) / DVec2::new(columns as f64, rows as f64))
}

/// A texture and the means of its blocks of 2, 4, 8 … texels a side: if the points that read it are farther
/// apart than texels, no bright texel is lost between them.
pub(crate) struct BlockMeans<'a> {
    pub texture: &'a Texture,
    levels: Vec<([u32; 2], Vec<[f32; 3]>)>,
}

impl<'a> BlockMeans<'a> {
    /// Computes the means.
    pub fn of(texture: &'a Texture) -> Self {
        let mut levels: Vec<([u32; 2], Vec<[f32; 3]>)> = Vec::new();
        for size in texture.halved_sizes() {
            let means = match levels.last() {
                None => halve([texture.width, texture.height], size, |at| texture.texels.linear(at)),
                Some((before, means)) => halve(*before, size, |at| means[at].map(f64::from)),
            };
            levels.push((size, means.into_iter().map(|mean| mean.map(|x| x as f32)).collect()));
        }
        Self { texture, levels }
    }

    /// Returns how to read a parallelogram of texture coordinates with these sides: the level whose blocks
    /// are as close as the points, and the points in the unit square, `count` along each side or more along
    /// the longer.
    pub fn points(
        &self,
        sides: [DVec2; 2],
        count: usize,
    ) -> (usize, impl Iterator<Item = DVec2> + Clone + use<>) {
        let size = DVec2::new(f64::from(self.texture.width), f64::from(self.texture.height));
        let texels = sides.map(|side| side.abs() * size / count as f64);
        let steps = texels.map(|texels| texels.max_element());
        let finer = steps[0].min(steps[1]).max(1.0);
        let more = steps.map(|step| (step / finer).ceil().clamp(1.0, MOST_FINER));
        let step = (texels[0] / more[0] + texels[1] / more[1]).max_element();
        let block = (step.ceil() as u32).clamp(1, 1 << 16).next_power_of_two();
        let level = (block.ilog2() as usize).min(self.levels.len());
        (level, grid(more.map(|more| count * more as usize)))
    }

    /// Returns the mean of the block around texture coordinates; on level 0 the texel.
    pub fn mean(&self, level: usize, uv: DVec2) -> DVec3 {
        let above = level.checked_sub(1).map(|above| &self.levels[above]);
        let [width, height] = above.map_or([self.texture.width, self.texture.height], |(size, _)| *size);
        let at = |x: f64, wrap: Wrap, count: u32| match wrap {
            Wrap::Repeat => (wrap.fold(x) * f64::from(count)) as usize % count as usize,
            Wrap::Clamp | Wrap::Mirror => {
                ((wrap.fold(x) * f64::from(count)) as usize).min(count as usize - 1)
            }
        };
        let [along_u, along_v] = self.texture.wrap;
        let index = at(1.0 - uv.y, along_v, height) * width as usize + at(uv.x, along_u, width);
        DVec3::from_array(match above {
            None => self.texture.texels.linear(index),
            Some((_, means)) => means[index].map(f64::from),
        })
    }

    /// Returns the mix of the four texels around texture coordinates.
    pub fn bilinear(&self, uv: DVec2) -> DVec3 {
        let size = DVec2::new(f64::from(self.texture.width), f64::from(self.texture.height));
        let (half, part) = (0.5 / size, (uv * size - 0.5).fract_gl());
        let at = |right: f64, up: f64| self.mean(0, uv + half * DVec2::new(right, up));
        let row = |up: f64| at(-1.0, up).lerp(at(1.0, up), part.x);
        row(-1.0).lerp(row(1.0), part.y)
    }
}
