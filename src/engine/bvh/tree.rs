//! The hierarchy in one call: boxes, build tree, collapse.

use super::bounds::{Bounds, MAX_PRIMITIVES, PackedBox};
use super::build::Builder;
use super::collapse::Collapse;
use super::node::{BinaryNode, Child, Leaf, WideNode};
use crate::scene::Scene;
use rayon::prelude::*;

/// Which trees to keep over the leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trees {
    /// The wide tree alone.
    Wide,
    /// The binary tree too: only the scalar baseline reads it (room `traverse`, file `scalar`).
    WideAndBinary,
}

/// A hierarchy over spheres and triangles.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The wide tree, the root first.
    pub wide: Vec<WideNode>,
    /// Over the same leaves; empty with [`Trees::Wide`].
    pub binary: Vec<BinaryNode>,
    /// Leaves of triangles.
    pub triangle_leaves: Vec<Leaf>,
    /// Leaves of spheres.
    pub sphere_leaves: Vec<Leaf>,
    /// Around everything.
    pub bounds: Bounds,
}

impl Bvh {
    /// Builds the hierarchy of a scene.
    pub fn new(scene: &Scene, trees: Trees) -> Self {
        let bounds = |number| Bounds::of_primitive(scene.primitive(number));
        Self::of_boxes(scene.spheres.len(), scene.primitives(), trees, bounds)
    }

    /// A hierarchy over `count` primitives with the given boxes; the first `spheres` of them are spheres.
    ///
    /// Domain: boxes are not empty, and neither coordinates nor extents leave ±1e19.
    ///
    /// # Panics
    /// With more than [`MAX_PRIMITIVES`].
    pub fn of_boxes(
        spheres: usize,
        count: usize,
        trees: Trees,
        bounds: impl Fn(usize) -> Bounds + Sync,
    ) -> Self {
        assert!(count <= MAX_PRIMITIVES, "{count} primitives; at most {MAX_PRIMITIVES} fit a hierarchy");
        let mut boxes: Vec<PackedBox> = (0..count)
            .into_par_iter()
            .with_min_len(4096)
            .map(|number| PackedBox::new(bounds(number), number as u32))
            .collect();
        let is_sphere = move |number: u32| (number as usize) < spheres;
        let (nodes, _) = Builder { is_sphere: &is_sphere }.build(&mut boxes);
        let Collapse { wide, binary, triangle_leaves, sphere_leaves, .. } =
            Collapse::new(&nodes, &boxes, &is_sphere, trees == Trees::WideAndBinary);
        let bounds = if boxes.is_empty() { Bounds::EMPTY } else { nodes[0].bounds };
        Self { wide, binary: binary.unwrap_or_default(), triangle_leaves, sphere_leaves, bounds }
    }

    /// The primitives of a leaf.
    #[inline(always)]
    pub fn leaf(&self, leaf: Child) -> &Leaf {
        if leaf.is_spheres() {
            &self.sphere_leaves[leaf.index()]
        } else {
            &self.triangle_leaves[leaf.index()]
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.wide.as_slice())
            + size_of_val(self.binary.as_slice())
            + size_of_val(self.triangle_leaves.as_slice())
            + size_of_val(self.sphere_leaves.as_slice())
    }
}
