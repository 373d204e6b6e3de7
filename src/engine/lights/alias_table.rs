//! The alias table: chooses a light by its probability in constant time.
//!
//! Source: Walker, "An Efficient Method for Generating Discrete Random Variables with General Distributions",
//! ACM TOMS 3(3), 1977; the table by Vose, IEEE TSE 17(9), 1991.

use crate::lane::{Bits, Lane};
use crate::math::BELOW_ONE;

/// A slot of equal width for each light: a number within the slot's width chooses the slot's own light below
/// `threshold`, its alias from there on.
#[derive(Clone, Debug, Default)]
pub(super) struct AliasTable {
    /// The thresholds: fractions of the slot's width, as bits.
    threshold: Vec<u32>,
    alias: Vec<u32>,
}

impl AliasTable {
    /// Builds the table of lights with these probabilities.
    pub fn new(shares: &[f64]) -> Self {
        let count = shares.len();
        let mut rest: Vec<f64> = shares.iter().map(|share| share * count as f64).collect();
        let mut threshold = vec![1f32.to_bits(); count];
        let mut alias: Vec<u32> = (0..count as u32).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..count).partition(|&slot| rest[slot] < 1.0);
        while let (Some(&short), Some(&long)) = (small.last(), large.last()) {
            small.pop();
            threshold[short] = (rest[short] as f32).to_bits();
            alias[short] = long as u32;
            rest[long] -= 1.0 - rest[short];
            if rest[long] < 1.0 {
                large.pop();
                small.push(long);
            }
        }
        // The remaining slots are full except for rounding.
        Self { threshold, alias }
    }

    /// Returns the number of lights.
    pub fn len(&self) -> usize {
        self.alias.len()
    }

    /// Returns the slot that a number in [0, 1) falls into, and the position within the slot.
    #[inline(always)]
    fn slot<L: Lane>(&self, number: L) -> (L::Bits, L) {
        let scaled = number * L::splat(self.len() as f32);
        // The product may round up to the number of lights.
        let last = L::Bits::splat(self.len() as u32 - 1);
        let slot = scaled.truncate_to_int();
        let slot = L::Bits::select(last.less(slot), last, slot);
        (slot, scaled - L::from_int(slot))
    }

    /// Returns the threshold of a slot.
    #[inline(always)]
    fn threshold<L: Lane>(&self, slot: L::Bits) -> L {
        L::from_bits(L::gather_bits(&self.threshold, slot))
    }

    /// Returns the light that `number` chooses, and the rest of `number`: a number in [0, 1).
    #[inline(always)]
    pub fn choose<L: Lane>(&self, number: L) -> (L::Bits, L) {
        let (slot, fraction) = self.slot(number);
        let threshold = self.threshold::<L>(slot);
        let own = fraction.lt(threshold);
        let above = (fraction - threshold) / (L::one() - threshold);
        let rest = L::select(own, fraction / threshold, above).min(L::splat(BELOW_ONE));
        (L::Bits::select(own, slot, L::gather_bits(&self.alias, slot)), rest)
    }

    /// Returns the light that `number` and, within its slot, `fraction` choose.
    #[inline(always)]
    pub fn choose_by_two<L: Lane>(&self, number: L, fraction: L) -> L::Bits {
        let (slot, _) = self.slot(number);
        L::Bits::select(fraction.lt(self.threshold(slot)), slot, L::gather_bits(&self.alias, slot))
    }
}
