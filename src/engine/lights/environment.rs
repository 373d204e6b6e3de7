//! The environment as a light: the sky's texture as a piecewise constant distribution over directions.

use crate::lane::{Bits, Lane, functions};
use crate::math::{Vec3, portable};
use crate::primitives::light::{LightKind, LightRow, LightSample, importance_everywhere};
use crate::scene::{Filter, Scene, Sky, Texture};
use std::f32::consts::PI as PI_F32;
use std::f64::consts::{PI, TAU};

/// A latitude/longitude grid of cells; the pdf is constant within a cell.
///
/// It is sampled by inverting the marginal CDF of rows and the conditional CDF of columns in a row, which
/// keeps low-discrepancy points well spread: Pharr et al., PBR 4ed §A.4.7 and §12.5.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    rows: u32,
    columns: u32,
    /// The marginal CDF of rows, from the top, as bits.
    row_cdf: Vec<u32>,
    /// For each row, the conditional CDF of its columns, from the left, as bits.
    column_cdfs: Vec<u32>,
    /// The pdf of each cell, in 1/sr, as bits.
    pdfs: Vec<u32>,
    /// The cosines of the polar angle at the rows' upper edges and at the last row's lower edge, as bits.
    edge_cosines: Vec<u32>,
    /// The rotation of the texture in turns: see [`Sky::Texture`].
    turn: f32,
    /// The mean radiance over all directions.
    pub mean: f64,
    /// The mean of the squared radiance over the square of the mean: 1 for a uniform sky.
    pub contrast: f64,
}

/// The largest number of columns and rows: in finer textures a cell has the mean of its texels.
const MAX_CELLS: [u32; 2] = [512, 256];

/// The share of its irradiance by which the sky is weighed beside portals. Larger shares pay where the sun
/// shines in, which portals find only by chance; smaller ones everywhere else in a room.
const SHARE_BESIDE_PORTALS: f64 = 1.0 / 16.0;

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u32> {
    numbers.into_iter().map(|number| (number as f32).to_bits()).collect()
}

/// Returns the CDF of a piecewise constant function; uniform if the function is 0.
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
    // The sum is exactly 1, in single precision too.
    *sums.last_mut().expect("there is a cell") = 1.0;
    sums
}

impl EnvironmentLight {
    /// Returns the light of a scene whose sky is a texture; `None` if the texture is black.
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
        // The shares of a texel's light in the previous texel's cell, its own and the next one: bilinear
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

    /// Returns the power that arrives from the sky at a sphere around the scene.
    pub(super) fn power(&self, scene: &Scene) -> f64 {
        let (lower, upper) = scene.bounds();
        let radius = (upper - lower).length() / 2.0;
        4.0 * f64::from(PI_F32) * f64::from(PI_F32) * radius * radius * self.mean
    }

    /// Returns the rows of the light, beside `portals` or without any. In rooms with portals, the sky as a
    /// whole is mostly occluded; outside, no other light is the sky.
    pub(super) fn light(&self, portals: bool) -> (LightRow, [f32; 8]) {
        let row = LightRow { kind: LightKind::Environment, ..LightRow::default() };
        let share = if portals { SHARE_BESIDE_PORTALS } else { 1.0 };
        (row, importance_everywhere(share * f64::from(PI_F32) * self.mean))
    }

    /// Samples a direction. Its `t` is infinite.
    #[inline(always)]
    pub fn sample<L: Lane>(&self, u: L, v: L) -> LightSample<L> {
        let read = |table: &[u32], at: L::Bits| L::from_bits(L::gather_bits(table, at));
        let (row, down) = invert_cdf::<L>(&self.row_cdf, L::Bits::splat(0), self.rows, v);
        let first = row.wrapping_mul(L::Bits::splat(self.columns));
        let (column, across) = invert_cdf::<L>(&self.column_cdfs, first, self.columns, u);
        let upper = read(&self.edge_cosines, row);
        let lower = read(&self.edge_cosines, row.wrapping_add(L::Bits::splat(1)));
        let y = (lower - upper).mul_add(down, upper);
        let sin = y.neg_mul_add(y, L::one()).max(L::zero()).sqrt();
        let turns =
            (L::from_int(column) + across) * L::splat(1.0 / self.columns as f32) - L::splat(self.turn);
        let (sin_around, cos_around) = functions::sin_cos_turns(turns);
        let direction = Vec3::new(sin * cos_around, y, sin * sin_around).normalize();
        let pdf = read(&self.pdfs, first.wrapping_add(column));
        LightSample { wi: direction, t: L::splat(f32::INFINITY), n: Vec3::zero(), pdf }
    }

    /// Returns the pdf of [`Self::sample`], in 1/sr, at the direction with these
    /// [`crate::kernel::surface::latitude_longitude`] coordinates, u unwrapped and v from the top.
    #[inline(always)]
    pub fn pdf<L: Lane>(&self, (u, v): (L, L)) -> L {
        let cell_along = |x: L, count: u32| {
            let at = (x * L::splat(count as f32)).max(L::zero()).truncate_to_int();
            let last = L::Bits::splat(count - 1);
            L::Bits::select(last.less(at), last, at)
        };
        let u = u + L::splat(self.turn);
        let (column, row) = (cell_along(u - u.floor(), self.columns), cell_along(v, self.rows));
        let cell = row.wrapping_mul(L::Bits::splat(self.columns)).wrapping_add(column);
        L::from_bits(L::gather_bits(&self.pdfs, cell))
    }
}

/// Inverts the CDF in the `count` entries of `cdf` from `first` on, at a number of [0, 1). Returns the index
/// of the interval, counted from `first`, and the position within it, in [0, 1].
#[inline(always)]
fn invert_cdf<L: Lane>(cdf: &[u32], first: L::Bits, count: u32, number: L) -> (L::Bits, L) {
    let read = |at: L::Bits| L::from_bits(L::gather_bits(cdf, first.wrapping_add(at)));
    let before = |at: L::Bits| read(at.wrapping_add(L::Bits::splat(u32::MAX)));
    // Binary search for the last interval that starts at the number or below it.
    let last = L::Bits::splat(count - 1);
    let (mut found, mut step) = (L::Bits::splat(0), count.next_power_of_two() / 2);
    while step > 0 {
        let next = found.wrapping_add(L::Bits::splat(step));
        let fits = !last.less(next);
        let starts_below = before(L::Bits::select(fits, next, last)).le(number);
        found = L::Bits::select(fits & starts_below, next, found);
        step /= 2;
    }
    let is_first = found.equals(L::Bits::splat(0));
    let start = L::select(is_first, L::zero(), before(L::Bits::select(is_first, L::Bits::splat(1), found)));
    let width = read(found) - start;
    let within = (number - start) / L::select(L::zero().lt(width), width, L::one());
    (found, within.max(L::zero()).min(L::one()))
}
