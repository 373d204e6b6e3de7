//! The hierarchy of boxes over a scene's spheres and triangles: how it is built, and what traversals read.
//!
//! For: [`Bvh`], [`WideNode`], [`BinaryNode`], [`Leaf`]; [`Bounds`]; [`check`], which proves a hierarchy valid and measures it. May
//! import: `lane`, `scene`. Must never know: rays, equations of intersection, pixels.
//!
//! | file | what it does |
//! |---|---|
//! | `bounds` | boxes, and boxes packed so that a union is one instruction |
//! | `split` | where to cut a set of boxes in two |
//! | `cost` | what a hierarchy costs, and the cheapest way to collapse it |
//! | `draft` | the binary tree in the making |
//! | `node` | nodes and leaves as traversals read them |
//! | `collapse` | from the one to the other |
//! | [`check`] | validity and statistics |
//!
//! # What a traversal may rely on
//! - Every primitive is in exactly one leaf; a leaf holds 1 to [`LEAF`] primitives of one kind, numbered as hits are (spheres first, then
//!   triangles), ascending. Leaves stand in depth-first order.
//! - A child's box holds the boxes of all primitives below it exactly: planes are copied, never computed.
//! - The root is node 0, always there, of the wide tree and of the binary one. A wide node's filled slots come first; the others have an
//!   empty box (+∞, −∞), which no ray hits. A scene without primitives has an empty root.
//! - No leaf is deeper than [`MAX_DEPTH`] levels below the root. A traversal that pops one reference and pushes what it hits never holds
//!   more than [`MAX_STACK`] references in the wide tree and [`MAX_DEPTH`] + 1 in the binary tree.
//! - The same scene gives the same hierarchy in every bit, whatever the number of threads.

mod bounds;
pub mod check;
mod collapse;
mod cost;
mod draft;
mod node;
mod split;

pub use bounds::{Bounds, MAX_PRIMITIVES};
pub use node::{BinaryNode, Child, LEAF, Leaf, WIDE, WideNode};

use crate::scene::Scene;
use bounds::PackedBox;
use draft::Builder;
use rayon::prelude::*;

/// Most levels from the root to a leaf. Cuts by cost may be lopsided; where they would lead deeper, sets are cut in the middle, which
/// takes 27 levels for [`MAX_PRIMITIVES`].
pub const MAX_DEPTH: u32 = 48;
/// Most references that a traversal of the wide tree has to remember: each level leaves all but one child behind.
pub const MAX_STACK: usize = (WIDE - 1) * MAX_DEPTH as usize + 1;

/// How much time to spend for faster traversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quality {
    #[default]
    Medium,
}

/// A hierarchy over spheres and triangles.
#[derive(Clone, Debug)]
pub struct Bvh {
    pub wide: Vec<WideNode>,
    /// Over the same leaves.
    pub binary: Vec<BinaryNode>,
    pub triangle_leaves: Vec<Leaf>,
    pub sphere_leaves: Vec<Leaf>,
    /// Around everything.
    pub bounds: Bounds,
}

impl Bvh {
    pub fn new(scene: &Scene, quality: Quality) -> Self {
        let spheres = scene.spheres.len();
        let count = spheres + scene.triangles.len();
        Self::of_boxes(spheres, count, quality, |number| Bounds::of_primitive(scene, number))
    }

    /// A hierarchy over `count` primitives with boxes of their own; the first `spheres` of them are spheres.
    ///
    /// Domain: boxes are not empty, and neither coordinates nor extents leave ±1e19.
    ///
    /// # Panics
    /// With more than [`MAX_PRIMITIVES`].
    pub fn of_boxes(
        spheres: usize,
        count: usize,
        quality: Quality,
        bounds: impl Fn(usize) -> Bounds + Sync,
    ) -> Self {
        assert!(count <= MAX_PRIMITIVES, "{count} primitives; at most {MAX_PRIMITIVES} fit a hierarchy");
        let Quality::Medium = quality;
        let mut boxes: Vec<PackedBox> = (0..count)
            .into_par_iter()
            .with_min_len(4096)
            .map(|number| PackedBox::new(bounds(number), number as u32))
            .collect();
        let is_sphere = move |number: u32| (number as usize) < spheres;
        let drafts = Builder { is_sphere: &is_sphere, finest: 4 }.build(&mut boxes);
        let collapse::Collapse { wide, binary, triangle_leaves, sphere_leaves, .. } =
            collapse::Collapse::new(&drafts, &boxes, &is_sphere);
        let bounds = binary[0].bounds();
        Self { wide, binary, triangle_leaves, sphere_leaves, bounds }
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
