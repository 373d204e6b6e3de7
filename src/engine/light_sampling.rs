//! Light sampling over lanes: chooses a light by the alias table of [`Lights`], and samples directions of an
//! [`EnvironmentLight`] by inverting its CDFs. Points on spheres and triangles are sampled by
//! [`crate::kernel::light`].
//!
//! May import: `lane`, `math`, `kernel`, `buffers`. Must never know: paths, queues, pixels.

use crate::buffers::{EnvironmentLight, Lights};
use crate::kernel::light::LightSample;
use crate::lane::{Bits, Lane, functions};
use crate::math::Vec3;

/// A light for each lane.
pub struct ChosenLight<L: Lane> {
    /// Centre of a sphere, first vertex of a triangle.
    pub at: Vec3<L>,
    /// 0 for triangles, negative for the environment light.
    pub radius: L,
    pub emission: Vec3<L>,
    pub ab: Vec3<L>,
    pub ac: Vec3<L>,
    pub offset: L,
    /// The probability of choosing it.
    pub probability: L,
}

impl Lights {
    /// Chooses a light by `u`. Returns the rest of `u` too: a number in [0, 1), as well distributed over the
    /// chosen light as `u` is over all of them. Among more than 64 lights `number` and `second_number`
    /// choose, and `u` is returned whole. `few` promises at most [`Lights::FEW`] lights.
    ///
    /// Domain: there are lights.
    #[inline(always)]
    pub fn choose<L: Lane>(
        &self,
        u: L,
        number: impl Fn() -> L,
        second_number: impl Fn() -> L,
        few: bool,
    ) -> (ChosenLight<L>, L) {
        let mut rest = u;
        let light = match self.len() {
            1 => L::Bits::splat(0),
            count => {
                let shared = few || count <= Self::MAX_SHARED;
                let scaled = if shared { u } else { number() } * L::splat(count as f32);
                // The product may round up to the number of lights.
                let last = L::Bits::splat(count as u32 - 1);
                let slot = scaled.truncate_to_int();
                let slot = L::Bits::select(last.less(slot), last, slot);
                let fraction = if shared { scaled - L::from_int(slot) } else { second_number() };
                let threshold = L::from_bits(L::gather_bits(&self.alias_table.threshold, slot));
                let own = fraction.lt(threshold);
                if shared {
                    let above = (fraction - threshold) / (L::one() - threshold);
                    rest =
                        L::select(own, fraction / threshold, above).min(L::splat(1.0 - f32::EPSILON / 2.0));
                }
                L::Bits::select(own, slot, L::gather_bits(&self.alias_table.alias, slot))
            }
        };
        let first = light.shl(1);
        let [x, y, z, radius, r, g, b, probability] = self.rows.fetch::<L>(first, few);
        let [abx, aby, abz, acx, acy, acz, _, offset] = self.rows.fetch::<L>(first | L::Bits::splat(1), few);
        let chosen = ChosenLight {
            at: Vec3::new(x, y, z),
            radius,
            emission: Vec3::new(r, g, b),
            ab: Vec3::new(abx, aby, abz),
            ac: Vec3::new(acx, acy, acz),
            offset,
            probability,
        };
        (chosen, rest)
    }
}

impl EnvironmentLight {
    /// Samples a direction; its `t` is infinite.
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
        let turns = (L::from_int(column) + across) * L::splat(1.0 / self.columns as f32);
        let (sin_around, cos_around) = functions::sin_cos_turns(turns);
        let direction = Vec3::new(sin * cos_around, y, sin * sin_around).normalize();
        let pdf = read(&self.pdfs, first.wrapping_add(column));
        LightSample { wi: direction, t: L::splat(f32::INFINITY), n: Vec3::zero(), pdf }
    }

    /// The pdf of [`Self::sample`], in 1/sr, at the direction with these texture coordinates, u unwrapped and
    /// v from the top.
    #[inline(always)]
    pub fn pdf<L: Lane>(&self, (u, v): (L, L)) -> L {
        let cell_along = |x: L, count: u32| {
            let at = (x * L::splat(count as f32)).max(L::zero()).truncate_to_int();
            let last = L::Bits::splat(count - 1);
            L::Bits::select(last.less(at), last, at)
        };
        let (column, row) = (cell_along(u - u.floor(), self.columns), cell_along(v, self.rows));
        let cell = row.wrapping_mul(L::Bits::splat(self.columns)).wrapping_add(column);
        L::from_bits(L::gather_bits(&self.pdfs, cell))
    }
}

/// Inverts the CDF in the `count` entries of `cdf` from `first` on, at a number of [0, 1): the index of the
/// interval, counted from `first`, and the position within it, in [0, 1].
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
