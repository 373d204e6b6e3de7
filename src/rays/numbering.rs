//! The kinds of primitives, and how primitives are numbered: in the order of their kinds.

use crate::lane::{Bits, Mask};

/// A kind of primitive. Primitives are numbered in the order of their kinds.
///
/// Code that differs by kind is a `match` in this file, in [`crate::kind`] or in [`crate::Shape`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A sphere.
    Sphere,
    /// A triangle.
    Triangle,
}

impl Kind {
    /// All kinds in their order.
    pub const ALL: [Self; 2] = [Self::Sphere, Self::Triangle];

    /// Returns the cost of testing a primitive of this kind in a list, in tests of a sphere.
    pub const fn test_cost(self) -> usize {
        match self {
            Self::Sphere => 1,
            Self::Triangle => 6,
        }
    }
}

// `ALL` has every kind, and the last one at its end.
const _: () = match Kind::ALL[Kind::ALL.len() - 1] {
    Kind::Sphere => panic!("`Kind::ALL` lacks a kind"),
    Kind::Triangle => assert!(Kind::Triangle as usize + 1 == Kind::ALL.len()),
};

/// The number of primitives of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KindCounts(pub [usize; Kind::ALL.len()]);

impl KindCounts {
    /// Returns the number of all primitives.
    pub fn total(self) -> usize {
        self.0.into_iter().sum()
    }
    /// Returns the number of the first primitive of a kind.
    pub fn first(self, kind: Kind) -> usize {
        self.0[..kind as usize].iter().sum()
    }
    /// Returns the kind of a primitive, and its index among those of its kind.
    ///
    /// # Panics
    /// If `number` is not below [`KindCounts::total`].
    pub fn place(self, number: usize) -> (Kind, usize) {
        let mut index = number;
        for (kind, count) in Kind::ALL.into_iter().zip(self.0) {
            if index < count {
                return (kind, index);
            }
            index -= count;
        }
        panic!("primitive {number} of {self:?}");
    }
    /// Returns the kind of a primitive, by its number.
    pub fn kind_of(self, number: usize) -> Kind {
        self.place(number).0
    }
    /// Iterates over the places of all primitives in the order of their numbers.
    pub fn places(self) -> impl Iterator<Item = (Kind, usize)> {
        let of_kind = |(kind, count)| (0..count).map(move |index| (kind, index));
        Kind::ALL.into_iter().zip(self.0).flat_map(of_kind)
    }
    /// Returns the cost of testing all primitives for a ray, in tests of a sphere.
    pub fn list_cost(self) -> usize {
        Kind::ALL.into_iter().zip(self.0).map(|(kind, count)| kind.test_cost() * count).sum()
    }
}

/// The first number of each kind, for packets.
#[derive(Clone, Copy, Debug, Default)]
pub struct KindRanges {
    /// The first number of each kind.
    first: [u32; Kind::ALL.len()],
}

impl KindRanges {
    /// Returns the ranges for these counts.
    pub fn new(counts: KindCounts) -> Self {
        Self { first: Kind::ALL.map(|kind| counts.first(kind) as u32) }
    }
    /// Returns the lanes whose primitive is of this kind; lanes without a hit are unspecified.
    #[inline(always)]
    pub fn are_of_kind<B: Bits>(self, kind: Kind, primitive: B) -> B::Mask {
        let are_below = |end: u32| primitive.less(B::splat(end));
        let (first, next) = (self.first[kind as usize], self.first.get(kind as usize + 1));
        match (kind as usize, next) {
            (0, None) => B::Mask::splat(true),
            (0, Some(&next)) => are_below(next),
            (_, None) => !are_below(first),
            (_, Some(&next)) => !are_below(first) & are_below(next),
        }
    }
    /// Returns the primitives' indices among those of their kind.
    #[inline(always)]
    pub fn index_in_kind<B: Bits>(self, kind: Kind, primitive: B) -> B {
        match kind as usize {
            0 => primitive,
            kind => primitive.wrapping_add(B::splat(self.first[kind].wrapping_neg())),
        }
    }
}

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
