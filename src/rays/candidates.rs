//! //! Lists of the primitives that a set of rays can hit.

use crate::numbering::{Kind, KindCounts};

/// The primitives of each kind in ascending order; each entry is an index among the primitives of that kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Candidates([Vec<u32>; Kind::ALL.len()]);

impl Candidates {
    /// Returns the candidates of one kind.
    pub fn of_kind(&self, kind: Kind) -> &[u32] {
        &self.0[kind as usize]
    }
    /// Returns the numbers of candidates by kind.
    pub fn counts(&self) -> KindCounts {
        KindCounts(self.0.each_ref().map(Vec::len))
    }
    /// Returns the number of candidates.
    pub fn len(&self) -> usize {
        self.counts().total()
    }
    /// Tests whether there are no candidates.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Removes all candidates.
    pub fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }
    /// Adds a primitive, given by its number in a geometry with these counts.
    pub fn push(&mut self, counts: KindCounts, number: usize) {
        let (kind, index) = counts.place(number);
        self.0[kind as usize].push(index as u32);
    }
}
