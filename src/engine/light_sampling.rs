//! Light sampling over lanes: chooses a light by the alias table of [`Lights`], or by the irradiance of each
//! at a point ([`Lights::compare`] for few, [`Lights::resample`] for many), and samples directions of an
//! [`EnvironmentLight`] by inverting its CDFs. Points on spheres, triangles and parallelograms are sampled by
//! [`crate::kernel::light`].

use crate::buffers::{EnvironmentLight, Lights};
use crate::kernel::light::{FlatLight, LightSample};
use crate::lane::{Bits, Lane, functions};
use crate::math::{BELOW_ONE, Vec3};

/// A light for each lane.
pub struct ChosenLight<L: Lane> {
    /// Its index.
    pub index: L::Bits,
    /// Centre of a sphere, first vertex of a triangle.
    pub at: Vec3<L>,
    /// 0 for triangles, negative for the environment light.
    pub radius: L,
    /// Radiance of the light.
    pub emission: Vec3<L>,
    /// The edge to the second vertex.
    pub ab: Vec3<L>,
    /// The edge to the third vertex.
    pub ac: Vec3<L>,
    /// The lanes whose light is the parallelogram that continues the triangle `at`, `ab`, `ac`.
    pub is_quad: L::Mask,
    /// The light's error bound: shadow rays end at this distance from its surface.
    pub offset: L,
    /// The probability of choosing it by power.
    pub probability: L,
    /// Its contribution counts so many times: 1 if it was chosen by power, else the probability by power over
    /// that by irradiance.
    pub weight: L,
}

impl<L: Lane> ChosenLight<L> {
    /// The light as seen from `origin`, if it is a triangle or a parallelogram.
    #[inline(always)]
    pub fn flat(&self, origin: Vec3<L>) -> FlatLight<L> {
        FlatLight { a: self.at - origin, ab: self.ab, ac: self.ac, is_quad: self.is_quad }
    }
}

/// How many lights [`Lights::resample`] compares.
const CANDIDATES: usize = 8;

impl Lights {
    /// Chooses a light by `u`. Returns the rest of `u` too: a number in [0, 1), as well distributed over the
    /// chosen light as `u` is over all of them. Among more than 64 lights `number` and `second_number`
    /// choose, and `u` is returned whole. `fits_registers` promises at most [`Lights::FEW`] lights.
    ///
    /// Domain: there are lights.
    #[inline(always)]
    pub fn choose<L: Lane>(
        &self,
        u: L,
        number: impl Fn() -> L,
        second_number: impl Fn() -> L,
        fits_registers: bool,
    ) -> (ChosenLight<L>, L) {
        let (light, rest) = match self.len() {
            1 => (L::Bits::splat(0), u),
            count if fits_registers || count <= Self::MAX_SHARED => {
                let (slot, fraction) = self.slot(u);
                let threshold = L::from_bits(L::gather_bits(&self.alias_table.threshold, slot));
                let own = fraction.lt(threshold);
                let above = (fraction - threshold) / (L::one() - threshold);
                let rest = L::select(own, fraction / threshold, above).min(L::splat(BELOW_ONE));
                (L::Bits::select(own, slot, L::gather_bits(&self.alias_table.alias, slot)), rest)
            }
            _ => (self.light_of(number(), second_number()), u),
        };
        (self.fetch(light, L::one(), fits_registers), rest)
    }

    /// Chooses one of few lights in proportion to its irradiance at `point` with the normal `n`, were nothing
    /// between them, by `u`. Returns the rest of `u` too, as [`Lights::choose`] does.
    ///
    /// Domain: there are importance rows, at most [`Lights::MAX_COMPARED`].
    #[inline(always)]
    pub fn compare<L: Lane>(
        &self,
        (point, n): (Vec3<L>, Vec3<L>),
        u: L,
        fits_registers: bool,
    ) -> (ChosenLight<L>, L) {
        let mut ends = [L::zero(); Self::MAX_COMPARED];
        let mut sum = L::zero();
        for (light, end) in ends.iter_mut().enumerate().take(self.len()) {
            sum = sum + self.irradiance(L::Bits::splat(light as u32), point, n, true);
            *end = sum;
        }
        let at = u * sum;
        let (mut light, mut start, mut end) = (L::Bits::splat(0), L::zero(), ends[0]);
        for (index, ends) in ends.windows(2).enumerate().take(self.len() - 1) {
            let is_beyond = ends[0].le(at);
            light = L::Bits::select(is_beyond, L::Bits::splat(index as u32 + 1), light);
            start = L::select(is_beyond, ends[0], start);
            end = L::select(is_beyond, ends[1], end);
        }
        let share = end - start;
        let possible = L::zero().lt(share);
        let per_share = L::one() / L::select(possible, share, L::one());
        let rest = ((at - start) * per_share).max(L::zero()).min(L::splat(BELOW_ONE));
        let mut chosen = self.fetch(light, L::one(), fits_registers);
        // 0 where no light is above the horizon.
        chosen.weight = (chosen.probability * (sum * per_share)).only(possible);
        (chosen, rest)
    }

    /// Chooses among many lights by what each would bring to `point` with the normal `n`, were nothing
    /// between them: takes `CANDIDATES` lights by power, and one of those in proportion to its irradiance
    /// over its probability. Three numbers in [0, 1).
    ///
    /// The light's contribution over its probability counts as many times as the mean of those quotients
    /// exceeds its own: an estimate without bias, because each light that can bring something may be chosen.
    ///
    /// Domain: there are importance rows. Source: J. Talbot, D. Cline, P. Egbert, "Importance Resampling for
    /// Global Illumination", EGSR 2005; the bounds of cosines after A. Conty Estevez, C. Kulla, "Importance
    /// Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, §4.
    #[inline(always)]
    pub fn resample<L: Lane>(
        &self,
        (point, n): (Vec3<L>, Vec3<L>),
        [number, second_number, mut choice]: [L; 3],
    ) -> ChosenLight<L> {
        let mut chosen = L::Bits::splat(0);
        let (mut sum, mut quotient) = (L::zero(), L::zero());
        let below_one = L::splat(BELOW_ONE);
        for candidate in 0..CANDIDATES {
            // Evenly spread over the table.
            let at = (number + L::splat(candidate as f32)) * L::splat(1.0 / CANDIDATES as f32);
            let light = self.light_of(at.min(below_one), second_number);
            let probability = self.rows.fetch::<L>(light.shl(1), false)[7];
            let own = self.irradiance(light, point, n, false) / probability;
            sum = sum + own;
            // Weighted reservoir sampling; the rest of the number is used again.
            let share = L::select(L::zero().lt(own), own / sum, L::zero());
            let taken = choice.lt(share);
            let left = L::select(taken, choice / share, (choice - share) / (L::one() - share));
            choice = left.max(L::zero()).min(below_one);
            chosen = L::Bits::select(taken, light, chosen);
            quotient = L::select(taken, own, quotient);
        }
        let mean = sum * L::splat(1.0 / CANDIDATES as f32);
        // 0 where no candidate is above the horizon.
        let weight = L::select(L::zero().lt(quotient), mean / quotient, L::zero());
        self.fetch(chosen, weight, false)
    }

    /// The lights that are the pieces of triangles at barycentrics, in the lanes of `mask`; `chance` is
    /// the probability of the light.
    #[inline(always)]
    pub fn piece_at<L: Lane>(&self, chance: L, (u, v): (L, L), mask: L::Mask) -> ChosenLight<L> {
        let side = L::splat(self.pieces_side as f32);
        let last = side - L::one();
        let row = (v * side).floor().max(L::zero()).min(last);
        let column = (u * side).floor().max(L::zero()).min(last - row);
        // Row r begins after r rows that are one shorter each.
        let before = row * L::splat(-0.5).mul_add(row - L::one(), side);
        let light = (before + column - L::one() - chance).truncate_to_int();
        self.fetch(L::Bits::select(mask, light, L::Bits::splat(0)), L::one(), false)
    }

    /// An estimate of the irradiance of a light at `point` on a surface with the normal `n`, nothing between
    /// them; above 0 where some of it is above the horizon.
    #[inline(always)]
    fn irradiance<L: Lane>(&self, light: L::Bits, point: Vec3<L>, n: Vec3<L>, fits_registers: bool) -> L {
        let [x, y, z, radius, nx, ny, nz, power] = self.importance_rows.fetch::<L>(light, fits_registers);
        let (to, normal) = (Vec3::new(x, y, z) - point, Vec3::new(nx, ny, nz));
        let distance2 = to.dot(to).max(radius * radius).max(L::splat(f32::MIN_POSITIVE));
        let per_distance = functions::approximate_rsqrt(distance2);
        // The cosine of an angle that is smaller by that of the bounding sphere is at most greater by its
        // sine.
        let sine = radius * per_distance;
        let cosine = to.dot(n).mul_add(per_distance, sine).max(L::zero()).min(L::one());
        let facing = (to.dot(normal).abs()).mul_add(per_distance, sine).min(L::one());
        let is_flat = L::zero().lt(normal.dot(normal));
        let bound = power * cosine * L::select(is_flat, facing, L::one()) * (per_distance * per_distance);
        L::select(radius.lt(L::zero()), power, bound)
    }

    /// The slot of the alias table that a number in [0, 1) falls into, and where in the slot.
    #[inline(always)]
    fn slot<L: Lane>(&self, number: L) -> (L::Bits, L) {
        let scaled = number * L::splat(self.len() as f32);
        // The product may round up to the number of lights.
        let last = L::Bits::splat(self.len() as u32 - 1);
        let slot = scaled.truncate_to_int();
        let slot = L::Bits::select(last.less(slot), last, slot);
        (slot, scaled - L::from_int(slot))
    }

    /// The light that `number` and, within its slot, `fraction` choose.
    #[inline(always)]
    fn light_of<L: Lane>(&self, number: L, fraction: L) -> L::Bits {
        let (slot, _) = self.slot(number);
        let threshold = L::from_bits(L::gather_bits(&self.alias_table.threshold, slot));
        L::Bits::select(fraction.lt(threshold), slot, L::gather_bits(&self.alias_table.alias, slot))
    }

    #[inline(always)]
    fn fetch<L: Lane>(&self, light: L::Bits, weight: L, fits_registers: bool) -> ChosenLight<L> {
        let first = light.shl(1);
        let [x, y, z, radius, r, g, b, probability] = self.rows.fetch::<L>(first, fits_registers);
        let [abx, aby, abz, acx, acy, acz, quad, offset] =
            self.rows.fetch::<L>(first | L::Bits::splat(1), fits_registers);
        ChosenLight {
            index: light,
            at: Vec3::new(x, y, z),
            radius,
            emission: Vec3::new(r, g, b),
            ab: Vec3::new(abx, aby, abz),
            ac: Vec3::new(acx, acy, acz),
            is_quad: L::zero().lt(quad),
            offset,
            probability,
            weight,
        }
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
        let turns =
            (L::from_int(column) + across) * L::splat(1.0 / self.columns as f32) - L::splat(self.turn);
        let (sin_around, cos_around) = functions::sin_cos_turns(turns);
        let direction = Vec3::new(sin * cos_around, y, sin * sin_around).normalize();
        let pdf = read(&self.pdfs, first.wrapping_add(column));
        LightSample { wi: direction, t: L::splat(f32::INFINITY), n: Vec3::zero(), pdf }
    }

    /// The pdf of [`Self::sample`], in 1/sr, at the direction with these
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
