//! Splits textured triangles into pieces: if the texture is much brighter in places, each piece is a light.

use super::power::Emitted;
use crate::primitives::flat::{Flat, blend, inside, sides};
use crate::rays::Kind;
use crate::scene::Filter;
use glam::DVec2;

/// The largest number of pieces of all triangles together, and along an edge of one.
const MAX_PIECES: usize = 1 << 16;
const MAX_SIDE: usize = 16;
/// From this ratio of the brightest piece to the mean on, sampling a triangle in pieces pays. Choosing among
/// that many lights halves the speed of a small scene; at a ratio of 2 (a chessboard) the time to equal error
/// is the same, at 32 it is a thirteenth.
const MIN_CONTRAST: f64 = 4.0;
/// The least power of a piece, as a share of its triangle's mean: its points may have missed a bright texel.
const MIN_POWER: f64 = 1.0 / 16.0;
/// The number of points along each side of a piece at which its texture is read.
const GRID: usize = 4;

/// Returns the number of pieces along an edge if this number of triangles may be sampled in pieces; 1 if
/// there are too many.
pub(super) fn side(triangles: usize) -> usize {
    let mut side = MAX_SIDE;
    while triangles * side * side > MAX_PIECES {
        side /= 2;
    }
    side.max(1)
}

/// Iterates over columns and rows of a triangle's pieces: parallelograms, and at the end of each row a
/// triangle.
fn places(side: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..side).flat_map(move |row| (0..side - row).map(move |column| [column, row]))
}

impl Flat {
    /// Iterates over the pieces of a triangle.
    pub(super) fn pieces(self, side: usize) -> impl Iterator<Item = Self> {
        let part = 1.0 / side as f64;
        let Self { a, ab, ac, .. } = self;
        places(side).map(move |[column, row]| Self {
            a: a + (ab * column as f64 + ac * row as f64) * part,
            ab: ab * part,
            ac: ac * part,
            is_quad: column + row + 1 < side,
        })
    }
}

impl Emitted<'_> {
    /// Returns the shares of a textured triangle's power that its pieces emit. Returns `None` for other
    /// primitives, and for triangles that are about equally bright everywhere, or whose brightness depends on
    /// the level of detail.
    pub(super) fn piece_shares(&self, number: usize, side: usize) -> Option<Vec<f64>> {
        let uvs = self.scene.uvs.get(number.checked_sub(self.scene.counts().first(Kind::Triangle))?)?;
        let material = &self.scene.materials[self.scene.primitive(number).material() as usize];
        let (texture, emission) = (self.texture(material)?, material.emission.as_dvec3());
        let filter = texture.texture.filter;
        if filter == Filter::Trilinear {
            return None;
        }
        let (level, grid) = texture.points(sides(uvs).map(|whole| whole / side as f64), GRID);
        let lookup = |uv| match filter {
            Filter::Bilinear if level == 0 => texture.bilinear(uv),
            Filter::Nearest | Filter::Bilinear | Filter::Trilinear => texture.mean(level, uv),
        };
        let radiance = |[column, row]: [usize; 2]| {
            let corner = DVec2::new(column as f64, row as f64);
            let points = grid.clone().map(|at| if column + row + 1 == side { inside(at) } else { at });
            let texels = points.map(|at| lookup(blend(uvs, (corner + at) / side as f64)));
            texels.map(|texel| texel.dot(emission)).sum::<f64>()
        };
        let area = |[column, row]: [usize; 2]| if column + row + 1 == side { 0.5 } else { 1.0 };
        let powers: Vec<(f64, f64)> =
            places(side).map(|place| (area(place) * radiance(place), area(place))).collect();
        let mean = powers.iter().map(|(power, _)| power).sum::<f64>() / (0.5 * (side * side) as f64);
        let pays = powers.iter().any(|(power, area)| power / area > MIN_CONTRAST * mean);
        let floored = powers.iter().map(|(power, area)| power.max(MIN_POWER * area * mean));
        let total: f64 = floored.clone().sum();
        pays.then(|| floored.map(|power| power / total).collect())
    }
}
