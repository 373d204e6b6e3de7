//! Chooses lights over lanes: by the irradiance that each brings to a point, or by power.

use super::Lights;
use crate::buffers::{Features, has};
use crate::lane::{Bits, Lane};
use crate::math::{BELOW_ONE, Vec3};
use crate::primitives::light::{ChosenLight, irradiance};
use crate::sampling::{PacketValues, dimension};

/// The number of lights that [`Lights::resample`] compares.
const CANDIDATES: usize = 8;

impl Lights {
    /// Chooses a light for each lane, for a `place`: a point and the normal there. It compares few lights,
    /// resamples very many, and chooses among others by power.
    ///
    /// Also returns the rest of `u`: a number in [0, 1), as well distributed over the chosen light as `u` is
    /// over all of them.
    ///
    /// Domain: there are lights.
    #[inline(always)]
    pub fn choose<L: Lane, const N: u64>(
        &self,
        place: (Vec3<L>, Vec3<L>),
        u: L,
        numbers: &PacketValues<L>,
    ) -> (ChosenLight<L>, L) {
        let fits_registers = !has(N, Features::MANY_LIGHTS);
        let by_irradiance = self.are_chosen_by_irradiance();
        if by_irradiance && (fits_registers || self.len() <= Self::MAX_COMPARED) {
            self.compare::<L, N>(place, u, fits_registers)
        } else if by_irradiance && has(N, Features::MANY_LIGHTS) {
            let numbers = [dimension::LIGHT, dimension::LIGHT_ALIAS, dimension::LIGHT_RESAMPLED]
                .map(|dimension| numbers.get_1d(dimension));
            (self.resample(place, numbers), u)
        } else {
            let number = || numbers.get_1d(dimension::LIGHT);
            self.choose_by_power(u, number, || numbers.get_1d(dimension::LIGHT_ALIAS), fits_registers)
        }
    }

    /// Chooses a light by `u`, and also returns the rest of `u`, as [`Lights::choose`] does. Among more than
    /// 64 lights `number` and `second_number` choose, and `u` is returned whole. `fits_registers` promises at
    /// most [`crate::primitives::LightTable::FEW`] lights.
    ///
    /// Domain: there are lights.
    #[inline(always)]
    pub fn choose_by_power<L: Lane>(
        &self,
        u: L,
        number: impl Fn() -> L,
        second_number: impl Fn() -> L,
        fits_registers: bool,
    ) -> (ChosenLight<L>, L) {
        let (light, rest) = match self.len() {
            1 => (L::Bits::splat(0), u),
            count if fits_registers || count <= Self::MAX_SHARED => self.alias_table.choose(u),
            _ => (self.alias_table.choose_by_two(number(), second_number()), u),
        };
        (self.table.fetch(light, L::one(), fits_registers), rest)
    }

    /// Chooses one of few lights by `u`, in proportion to its irradiance at `place`, ignoring occlusion. Also
    /// returns the rest of `u`, as [`Lights::choose`] does.
    ///
    /// Domain: there are importance rows, at most [`Lights::MAX_COMPARED`].
    #[inline(always)]
    pub fn compare<L: Lane, const N: u64>(
        &self,
        place: (Vec3<L>, Vec3<L>),
        u: L,
        fits_registers: bool,
    ) -> (ChosenLight<L>, L) {
        let mut ends = [L::zero(); Self::MAX_COMPARED];
        let mut sum = L::zero();
        for (light, end) in ends.iter_mut().enumerate().take(self.len()) {
            let mut own = irradiance(&self.importance_rows, L::Bits::splat(light as u32), place, true);
            if has(N, Features::PORTALS)
                && let Some(portal) = self.portals.of_light(light)
            {
                own = own.only(portal.is_lit_from(place.0));
            }
            sum = sum + own;
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
        let mut chosen = self.table.fetch(light, L::one(), fits_registers);
        // The weight is 0 if no light is above the horizon.
        chosen.weight = (chosen.probability * (sum * per_share)).only(possible);
        (chosen, rest)
    }

    /// Chooses among many lights by the irradiance that each would bring to `place`, ignoring occlusion:
    /// takes `CANDIDATES` lights by power, and one of those in proportion to its irradiance over its
    /// probability. The numbers are three in [0, 1).
    ///
    /// The light's contribution over its probability is multiplied by the mean of those quotients over its
    /// own: an estimate without bias, because each light that can bring something may be chosen.
    ///
    /// Domain: there are importance rows. Source: J. Talbot, D. Cline, P. Egbert, "Importance Resampling for
    /// Global Illumination", EGSR 2005.
    #[inline(always)]
    pub fn resample<L: Lane>(
        &self,
        place: (Vec3<L>, Vec3<L>),
        [number, second_number, mut choice]: [L; 3],
    ) -> ChosenLight<L> {
        let mut chosen = L::Bits::splat(0);
        let (mut sum, mut quotient) = (L::zero(), L::zero());
        let below_one = L::splat(BELOW_ONE);
        for candidate in 0..CANDIDATES {
            // The candidates are evenly spread over the table.
            let at = (number + L::splat(candidate as f32)) * L::splat(1.0 / CANDIDATES as f32);
            let light = self.alias_table.choose_by_two(at.min(below_one), second_number);
            let own = irradiance(&self.importance_rows, light, place, false) / self.table.probability(light);
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
        // The weight is 0 if no candidate is above the horizon.
        let weight = L::select(L::zero().lt(quotient), mean / quotient, L::zero());
        self.table.fetch(chosen, weight, false)
    }
}
