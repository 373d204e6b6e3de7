//! The environment light: the sky's texture as a piecewise constant distribution over directions. The tables
//! are built here and sampled in [`crate::light_sampling`].

use crate::math::portable;
use crate::scene::{Filter, Scene, Sky, Texture};
use std::f64::consts::{PI, TAU};

/// A latitude/longitude grid of cells; the pdf is constant within a cell.
///
/// Sampled by inverting the marginal CDF of rows and the conditional CDF of columns in a row, which keeps
/// low-discrepancy points well spread: Pharr et al., PBR 4ed §A.4.7 and §12.5.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    pub(crate) rows: u32,
    pub(crate) columns: u32,
    /// The marginal CDF of rows, from the top. Bits.
    pub(crate) row_cdf: Vec<u32>,
    /// For each row, the conditional CDF of its columns, from the left. Bits.
    pub(crate) column_cdfs: Vec<u32>,
    /// The pdf of each cell, in 1/sr. Bits.
    pub(crate) pdfs: Vec<u32>,
    /// Cosines of the polar angle at the rows' upper edges, and at the last one's lower edge. Bits.
    pub(crate) edge_cosines: Vec<u32>,
    /// Turns of the texture: see [`Sky::Texture`].
    pub(crate) turn: f32,
    /// The mean radiance over all directions.
    pub mean: f64,
    /// The mean of the squared radiance over the square of the mean: 1 for a uniform sky.
    pub contrast: f64,
}

/// Most columns and rows: in finer textures a cell has the mean of its texels.
const MAX_CELLS: [u32; 2] = [512, 256];

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u32> {
    numbers.into_iter().map(|number| (number as f32).to_bits()).collect()
}

/// The CDF of a piecewise constant function; uniform where the function is 0.
fn cdf(parts: &[f64]) -> Vec<f64> {
    let total: f64 = parts.iter().sum();
    let uniform = 1.0 / parts.len() as f64;
    let shares = parts.iter().map(|&part| if total > 0.0 { part / total } else { uniform });
    let mut sums: Vec<f64> = shares
        .scan(0.0, |sum, share| {
            *sum += share;
            Some(*sum)
        })
        .collect();
    // Exactly 1, in single precision too.
    *sums.last_mut().expect("there is a cell") = 1.0;
    sums
}

impl EnvironmentLight {
    /// The light of a scene whose sky is a texture; `None` where it is black.
    pub fn of(scene: &Scene) -> Option<Self> {
        let Sky::Texture { texture, color, turn } = scene.sky else { return None };
        let color = f64::from(color.element_sum()) / 3.0;
        let sky = Self { turn, ..Self::new(&scene.textures[texture as usize], color) };
        (sky.mean > 0.0 && sky.mean.is_finite()).then_some(sky)
    }

    fn new(texture: &Texture, color: f64) -> Self {
        let (width, height) = (texture.width as usize, texture.height as usize);
        let (columns, rows) =
            (texture.width.min(MAX_CELLS[0]) as usize, texture.height.min(MAX_CELLS[1]) as usize);
        // The shares of a texel's light in the cells of the texel before, its own and the one after: bilinear
        // lookups blend between texel centres.
        let taps: &[(usize, f64)] = match texture.filter {
            Filter::Nearest => &[(1, 1.0)],
            Filter::Bilinear | Filter::Trilinear => &[(0, 0.125), (1, 0.75), (2, 0.125)],
        };
        let mut sums = vec![0.0; rows * columns];
        let mut weights = vec![0.0; rows * columns];
        for y in 0..height {
            for x in 0..width {
                let radiance = color * texture.texels.linear(y * width + x).iter().sum::<f64>() / 3.0;
                for (&(right, across), &(below, down)) in
                    taps.iter().flat_map(|x| taps.iter().map(move |y| (x, y)))
                {
                    let column = (x + width + right - 1) % width * columns / width;
                    let row = (y + below).saturating_sub(1).min(height - 1) * rows / height;
                    sums[row * columns + column] += across * down * radiance;
                    weights[row * columns + column] += across * down;
                }
            }
        }
        let radiances: Vec<f64> = sums.iter().zip(&weights).map(|(sum, weight)| sum / weight).collect();
        let edge = |row: usize| portable::cos(PI * row as f64 / rows as f64);
        let solid_angle = |row: usize| (edge(row) - edge(row + 1)) * TAU / columns as f64;
        let row_powers: Vec<f64> = (0..rows)
            .map(|row| radiances[row * columns..][..columns].iter().sum::<f64>() * solid_angle(row))
            .collect();
        let power: f64 = row_powers.iter().sum();
        let mean = power / (2.0 * TAU);
        let squares: f64 =
            (0..rows * columns).map(|cell| radiances[cell].powi(2) * solid_angle(cell / columns)).sum();
        Self {
            rows: rows as u32,
            columns: columns as u32,
            row_cdf: bits(cdf(&row_powers)),
            column_cdfs: bits((0..rows).flat_map(|row| cdf(&radiances[row * columns..][..columns]))),
            pdfs: bits(radiances.iter().map(|radiance| radiance / power)),
            edge_cosines: bits((0..=rows).map(edge)),
            turn: 0.0,
            mean,
            contrast: squares / (2.0 * TAU) / (mean * mean),
        }
    }
    /// Memory of the tables.
    pub fn bytes(&self) -> usize {
        let tables = [&self.row_cdf, &self.column_cdfs, &self.pdfs, &self.edge_cosines];
        tables.iter().map(|table| size_of_val(table.as_slice())).sum()
    }
}
