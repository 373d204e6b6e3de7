//! The kinds of primitives, and how primitives are numbered: in the order of their kinds.

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
