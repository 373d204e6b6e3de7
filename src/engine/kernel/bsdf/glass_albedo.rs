//! Tabulates E, the share of light that rough glass keeps with single scattering, reflected and refracted:
//! the mean of G₂ / G₁ over sampled directions, of which those on the wrong side count 0.
//!
//! A table is of one index of refraction and one roughness. Its axes are the factor that a roughness map
//! gives the roughness, and t = (μ + μ / s) / 2 with μ = cos o and s of [`super::ggx`]: facets shadow each
//! other at angles where μ / s changes, and total reflection begins at one of μ.
//!
//! Error: 0.2 % of E on average, 0.5 % with a map; more in grazing light at roughness 1
//! (`tests/laws/lobes.rs`); in f64, over a lattice of the numbers of the sampling.

use super::{fresnel, ggx};
use crate::lane::Lane;
use crate::math::portable;
use std::sync::{Arc, Mutex, PoisonError};

/// The numbers of entries along t and the factor of the roughness.
const COSINES: usize = 64;
const FACTORS: usize = 16;
/// The number of rows of a table.
pub const ROWS: usize = (COSINES - 1) * (FACTORS - 1);
/// The points of quadrature, a lattice of two Fibonacci numbers: across the lobe, and along half a turn.
const POINTS: usize = 1597;
const STEP: usize = 987;

/// A table. Each row is a cell: E at two neighbouring t for one factor, then for the next, from outside; then
/// the same from inside.
pub type Table = Arc<[[f32; 8]]>;

/// The index of refraction and the roughness of a table, and whether a map multiplies the roughness.
type Key = (f32, f32, bool);

/// The last tables: one takes longer to compute than a small picture to render, and a scene may have many
/// renderers.
static LAST: Mutex<Vec<(Key, Table)>> = Mutex::new(Vec::new());
/// The number of tables that are kept, 30 kB each.
const KEPT: usize = 32;

/// Returns the table of an index of refraction and a roughness.
pub fn table(ior: f32, roughness: f32, is_mapped: bool) -> Table {
    let key = (ior, roughness, is_mapped);
    let lock = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, table)) = lock().iter().find(|(other, _)| *other == key) {
        return table.clone();
    }
    let table = compute(ior, roughness, is_mapped);
    let mut last = lock();
    if last.len() == KEPT {
        last.remove(0);
    }
    last.push((key, table.clone()));
    table
}

/// Computes a table. Unless `is_mapped`, only entries of the factor 1 are computed.
fn compute(ior: f32, roughness: f32, is_mapped: bool) -> Table {
    let ior = f64::from(ior);
    let turn = |point: usize| {
        let angle = std::f64::consts::PI * (point * STEP % POINTS) as f64 / POINTS as f64;
        portable::sin_cos(angle).1
    };
    let turns: Vec<f64> = (0..POINTS).map(turn).collect();
    let fraction = |index: usize, count: usize| index as f64 / (count - 1) as f64;
    let entry = |index: usize| {
        let factor = if is_mapped { fraction(index / COSINES, FACTORS) } else { 1.0 };
        let alpha = portable::powi(f64::from(roughness) * factor, 2);
        let mu = cosine(fraction(index % COSINES, COSINES), alpha);
        [1.0 / ior, ior].map(|eta| if alpha == 0.0 { 1.0 } else { albedo(mu, alpha, eta, &turns) as f32 })
    };
    let computed = if is_mapped { COSINES * FACTORS } else { COSINES };
    let entries: Vec<[f32; 2]> = (0..computed).map(entry).collect();
    let row = |cell: usize| {
        let first = cell / (COSINES - 1) * COSINES + cell % (COSINES - 1);
        let corners = [first, first + 1, first + COSINES, first + COSINES + 1];
        let corners = corners.map(|at| entries[at % computed]);
        std::array::from_fn(|column| corners[column % 4][column / 4])
    };
    (0..ROWS).map(row).collect()
}

/// Returns the μ of t, by bisection.
fn cosine(t: f64, alpha: f64) -> f64 {
    let of = |mu: f64| 0.5 * (mu + mu / (mu * mu + alpha * alpha * (1.0 - mu * mu)).sqrt().max(1e-300));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if of(middle) < t { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Integrates E over visible normals; `eta` is the index on the side of o over that on the other.
fn albedo(mu: f64, alpha: f64, eta: f64, turns: &[f64]) -> f64 {
    let sin = (1.0 - mu * mu).max(0.0).sqrt();
    let stretched = |cos: f64| (cos * cos + alpha * alpha * (1.0 - cos * cos).max(0.0)).sqrt();
    let length = stretched(mu);
    let (axis_x, axis_z) = (alpha * sin / length, mu / length);
    let kept = |cos: f64| match cos > 0.0 {
        true => cos * (mu + length) / (cos * length + mu * stretched(cos)),
        false => 0.0,
    };
    let mut sum = 0.0;
    for (point, &turn) in turns.iter().enumerate() {
        let u = (point as f64 + 0.5) / POINTS as f64;
        let z = (1.0 - u) * (1.0 + axis_z) - axis_z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let (x, y2) = (radius * turn + axis_x, radius * radius * (1.0 - turn * turn));
        let (x, y2, z) = (alpha * x, alpha * alpha * y2, z + axis_z);
        let inverse = 1.0 / (x * x + y2 + z * z).sqrt();
        let (x, z) = (x * inverse, z * inverse);
        let cos = (sin * x + mu * z).clamp(1e-9, 1.0);
        let cos2_t = 1.0 - eta * eta * (1.0 - cos * cos);
        let reflected = if cos2_t <= 0.0 { 1.0 } else { fresnel::reflectance_f64(eta, cos) };
        sum += reflected * kept(2.0 * cos * z - mu);
        if cos2_t > 0.0 {
            sum += (1.0 - reflected) * kept(eta * mu - z * (eta * cos - cos2_t.sqrt()));
        }
    }
    sum / POINTS as f64
}

/// The cell of a table that holds a direction of view, and the place in it.
#[derive(Clone, Copy, Debug)]
pub struct Cell<L: Lane> {
    /// The index of the row in its table.
    pub row: L::Bits,
    cosine: L,
    roughness: L,
}

impl<L: Lane> Cell<L> {
    /// Finds the cell of a direction by its cosine; α is `stated` without a map.
    #[inline(always)]
    pub fn of(cos: L, alpha: L, stated: L) -> Self {
        let along = |x: L, count: usize| {
            let x = (x * L::splat((count - 1) as f32)).max(L::zero());
            let first = x.floor().min(L::splat((count - 2) as f32));
            (first, (x - first).min(L::one()))
        };
        let mu = cos.min(L::one());
        let t = L::splat(0.5) * (mu + mu / ggx::stretched_cosine(alpha, mu));
        let (column, cosine) = along(t, COSINES);
        let factor = (alpha / stated.max(L::splat(f32::MIN_POSITIVE))).sqrt();
        let (line, roughness) = along(factor, FACTORS);
        let row = line.mul_add(L::splat((COSINES - 1) as f32), column).truncate_to_int();
        Self { row, cosine, roughness }
    }
    /// Interpolates E in the cell's row, from outside in the lanes of `outside`, else from inside.
    #[inline(always)]
    pub fn interpolate(&self, row: [L; 8], outside: L::Mask) -> L {
        let [a, b, c, d] = std::array::from_fn(|corner| L::select(outside, row[corner], row[corner + 4]));
        let lerp = |from: L, to: L, share: L| (to - from).mul_add(share, from);
        lerp(lerp(a, b, self.cosine), lerp(c, d, self.cosine), self.roughness)
    }
}
