//! Builds a hierarchy in one call: boxes, build tree, collapse.

use super::bounds::{Bounds, MAX_PRIMITIVES, PackedBox};
use super::build::Builder;
use super::collapse::Collapse;
use super::node::{BinaryNode, Child, WideNode};
use crate::kind::Geometry;
use crate::kind::{Kind, KindCounts, Leaf};
use rayon::prelude::*;

/// The trees to keep over the leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trees {
    /// Only the wide tree.
    Wide,
    /// The binary tree too, which only the scalar baseline reads (file `traverse/scalar`).
    WideAndBinary,
}

/// A hierarchy over primitives.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The wide tree, the root first.
    pub wide: Vec<WideNode>,
    /// The binary tree over the same leaves; empty with [`Trees::Wide`].
    pub binary: Vec<BinaryNode>,
    /// The leaves of each kind.
    pub leaves: [Vec<Leaf>; Kind::ALL.len()],
    /// The box around everything.
    pub bounds: Bounds,
}

impl Bvh {
    /// Builds the hierarchy over all primitives.
    pub fn new(geometry: &Geometry, trees: Trees) -> Self {
        let bounds = |number| Bounds::new(geometry.shape(number).bounds());
        Self::of_boxes(geometry.counts(), trees, bounds)
    }

    /// Builds the hierarchy over primitives with the given boxes.
    ///
    /// Domain: boxes are not empty, and neither coordinates nor extents leave ±1e19.
    ///
    /// # Panics
    /// If there are more than [`MAX_PRIMITIVES`].
    pub fn of_boxes(counts: KindCounts, trees: Trees, bounds: impl Fn(usize) -> Bounds + Sync) -> Self {
        let count = counts.total();
        assert!(count <= MAX_PRIMITIVES, "{count} primitives; at most {MAX_PRIMITIVES} fit a hierarchy");
        let mut boxes: Vec<PackedBox> = (0..count)
            .into_par_iter()
            .with_min_len(4096)
            .map(|number| PackedBox::new(bounds(number), number as u32))
            .collect();
        let (nodes, _) = Builder { counts }.build(&mut boxes);
        let Collapse { wide, binary, leaves, .. } =
            Collapse::new(&nodes, &boxes, counts, trees == Trees::WideAndBinary);
        let bounds = if boxes.is_empty() { Bounds::EMPTY } else { nodes[0].bounds };
        Self { wide, binary: binary.unwrap_or_default(), leaves, bounds }
    }

    /// Returns the primitives of a leaf.
    #[inline(always)]
    pub fn leaf(&self, leaf: Child) -> &Leaf {
        &self.leaves[leaf.kind() as usize][leaf.index()]
    }

    /// Returns the size in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.wide.as_slice())
            + size_of_val(self.binary.as_slice())
            + self.leaves.iter().map(|leaves| size_of_val(leaves.as_slice())).sum::<usize>()
    }
}
