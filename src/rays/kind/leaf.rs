//! The primitives of a leaf of the hierarchy.

use crate::lane::NATIVE_WIDTH;
use bytemuck::{Pod, Zeroable};

/// The largest number of primitives in a leaf: as many as one vector tests at once.
pub const LEAF: usize = NATIVE_WIDTH;

/// Up to [`LEAF`] primitives of one kind, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Leaf {
    /// The numbers, ascending; [`Leaf::NONE`] fills the unused entries at the end.
    pub primitives: [u32; LEAF],
}

impl Leaf {
    /// Marks an unused entry.
    pub const NONE: u32 = u32::MAX;
    /// Returns the numbers of the primitives.
    pub fn primitives(&self) -> &[u32] {
        let len = self.primitives.iter().position(|&one| one == Self::NONE).unwrap_or(LEAF);
        &self.primitives[..len]
    }
}
