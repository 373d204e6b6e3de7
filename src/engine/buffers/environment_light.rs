//! The sky's picture as a light: directions drawn as its brightness says.

use crate::kernel::light::LightSample;
use crate::lane::{Bits, Lane, functions};
use crate::math::Vec3;
use crate::scene::{Filter, Scene, Sky, Texture};
use std::f64::consts::{PI, TAU};

/// A latitude/longitude grid of cells; within a cell all directions are equally likely.
///
/// ScatteredPath by inverting the distributions of rows and of columns in a row, which keeps well spread points well spread: Pharr et al., PBR 4ed
/// §A.4.7 and §12.5.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    rows: u32,
    columns: u32,
    /// For each row, the share of it and of all above it; then one more row's worth of nothing. Bits.
    row_sums: Vec<u32>,
    /// For each cell, the share of it and of those left of it within its row. Bits.
    cell_sums: Vec<u32>,
    /// Of each cell, in 1/sr. Bits.
    densities: Vec<u32>,
    /// Cosines from the pole of the rows' upper edges, and of the last one's lower edge. Bits.
    edges: Vec<u32>,
    /// The radiance's mean over all directions.
    pub mean: f64,
    /// The mean of its square over the square of its mean: 1 for an even sky.
    pub contrast: f64,
}

/// Most cells: finer pictures are drawn by the mean of the texels in a cell.
const MOST: [u32; 2] = [512, 256];

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u32> {
    numbers.into_iter().map(|number| (number as f32).to_bits()).collect()
}

/// The share of each and of those before it in the whole; evenly spread where there is nothing.
fn cdf(parts: &[f64]) -> Vec<f64> {
    let total: f64 = parts.iter().sum();
    let even = 1.0 / parts.len() as f64;
    let shares = parts.iter().map(|&part| if total > 0.0 { part / total } else { even });
    let mut sums: Vec<f64> = shares
        .scan(0.0, |sum, share| {
            *sum += share;
            Some(*sum)
        })
        .collect();
    // Exactly all, in single precision too.
    *sums.last_mut().expect("there is a cell") = 1.0;
    sums
}

impl EnvironmentLight {
    /// Of a scene whose sky is a picture that is not black.
    pub fn of(scene: &Scene) -> Option<Self> {
        let Sky::Texture { texture, color } = scene.sky else { return None };
        let color = f64::from(color.element_sum()) / 3.0;
        let sky = Self::new(&scene.textures[texture as usize], color);
        (sky.mean > 0.0 && sky.mean.is_finite()).then_some(sky)
    }

    fn new(picture: &Texture, color: f64) -> Self {
        let (width, height) = (picture.width as usize, picture.height as usize);
        let (columns, rows) = (picture.width.min(MOST[0]) as usize, picture.height.min(MOST[1]) as usize);
        // What of a texel's light falls on its neighbours before and after, and on itself: between texels' centres the picture is blended.
        let spread: &[(usize, f64)] = match picture.filter {
            Filter::Nearest => &[(1, 1.0)],
            Filter::Bilinear => &[(0, 0.125), (1, 0.75), (2, 0.125)],
        };
        let mut sums = vec![0.0; rows * columns];
        let mut taken = vec![0.0; rows * columns];
        for y in 0..height {
            for x in 0..width {
                let radiance = color * picture.texels.linear(y * width + x).iter().sum::<f64>() / 3.0;
                for (&(right, across), &(below, down)) in
                    spread.iter().flat_map(|x| spread.iter().map(move |y| (x, y)))
                {
                    let column = (x + width + right - 1) % width * columns / width;
                    let row = (y + below).saturating_sub(1).min(height - 1) * rows / height;
                    sums[row * columns + column] += across * down * radiance;
                    taken[row * columns + column] += across * down;
                }
            }
        }
        let radiances: Vec<f64> = sums.iter().zip(&taken).map(|(sum, taken)| sum / taken).collect();
        let edge = |row: usize| (PI * row as f64 / rows as f64).cos();
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
            row_sums: bits(cdf(&row_powers)),
            cell_sums: bits((0..rows).flat_map(|row| cdf(&radiances[row * columns..][..columns]))),
            densities: bits(radiances.iter().map(|radiance| radiance / power)),
            edges: bits((0..=rows).map(edge)),
            mean,
            contrast: squares / (2.0 * TAU) / (mean * mean),
        }
    }
    pub fn bytes(&self) -> usize {
        let tables = [&self.row_sums, &self.cell_sums, &self.densities, &self.edges];
        tables.iter().map(|table| size_of_val(table.as_slice())).sum()
    }

    /// A direction; the sky is as far as can be.
    #[inline(always)]
    pub fn aim<L: Lane>(&self, u: L, v: L) -> LightSample<L> {
        let read = |table: &[u32], at: L::Bits| L::from_bits(L::gather_bits(table, at));
        let (row, down) = find::<L>(&self.row_sums, L::Bits::splat(0), self.rows, v);
        let first = row.wrapping_mul(L::Bits::splat(self.columns));
        let (column, across) = find::<L>(&self.cell_sums, first, self.columns, u);
        let (upper, lower) = (read(&self.edges, row), read(&self.edges, row.wrapping_add(L::Bits::splat(1))));
        let y = (lower - upper).mul_add(down, upper);
        let sin = y.neg_mul_add(y, L::one()).max(L::zero()).sqrt();
        let turn = (L::from_int(column) + across) * L::splat(1.0 / self.columns as f32);
        let (sin_around, cos_around) = functions::sin_cos_turns(turn);
        let direction = Vec3::new(sin * cos_around, y, sin * sin_around).normalize();
        let density = read(&self.densities, first.wrapping_add(column));
        LightSample { wi: direction, t: L::splat(f32::INFINITY), n: Vec3::zero(), pdf: density }
    }

    /// The density of the direction with these coordinates, u unwrapped and v from the top, as [`Self::aim`] draws.
    #[inline(always)]
    pub fn density<L: Lane>(&self, (u, v): (L, L)) -> L {
        let place = |x: L, count: u32| {
            let at = (x * L::splat(count as f32)).max(L::zero()).truncate_to_int();
            let last = L::Bits::splat(count - 1);
            L::Bits::select(last.less(at), last, at)
        };
        let (column, row) = (place(u - u.floor(), self.columns), place(v, self.rows));
        let cell = row.wrapping_mul(L::Bits::splat(self.columns)).wrapping_add(column);
        L::from_bits(L::gather_bits(&self.densities, cell))
    }
}

/// In which of the `count` running shares from `first` on a number of [0, 1) falls, counted from there, and where within it, in [0, 1].
#[inline(always)]
fn find<L: Lane>(sums: &[u32], first: L::Bits, count: u32, number: L) -> (L::Bits, L) {
    let read = |at: L::Bits| L::from_bits(L::gather_bits(sums, first.wrapping_add(at)));
    let before = |at: L::Bits| read(at.wrapping_add(L::Bits::splat(u32::MAX)));
    // The last share that starts at the number or below it, by halving.
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
