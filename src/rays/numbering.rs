//! The kinds of primitives, and how primitives are numbered: in the order of their kinds.

use crate::lane::Bits;

/// A kind of primitive. Primitives are numbered in the order of their kinds.
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
}

/// The numbers of primitives by kind.
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
    /// Returns the kind of a primitive, by its number.
    pub fn kind_of(self, number: usize) -> Kind {
        let is_before = |kind: &&Kind| number < self.first(**kind) + self.0[**kind as usize];
        *Kind::ALL.iter().find(is_before).unwrap_or(&Kind::Triangle)
    }
}

/// Where the numbers of each kind begin, for packets.
#[derive(Clone, Copy, Debug, Default)]
pub struct KindRanges {
    first_triangle: u32,
}

impl KindRanges {
    /// Returns the ranges of so many primitives.
    pub fn new(counts: KindCounts) -> Self {
        Self { first_triangle: counts.first(Kind::Triangle) as u32 }
    }
    /// Returns the lanes whose primitive is of this kind; unspecified in lanes without a hit.
    #[inline(always)]
    pub fn are_of_kind<B: Bits>(self, kind: Kind, primitive: B) -> B::Mask {
        let are_spheres = primitive.less(B::splat(self.first_triangle));
        match kind {
            Kind::Sphere => are_spheres,
            Kind::Triangle => !are_spheres,
        }
    }
    /// Returns the indices of primitives of a kind among those of the kind.
    #[inline(always)]
    pub fn index_in_kind<B: Bits>(self, kind: Kind, primitive: B) -> B {
        match kind {
            Kind::Sphere => primitive,
            Kind::Triangle => primitive.wrapping_add(B::splat(self.first_triangle.wrapping_neg())),
        }
    }
}
