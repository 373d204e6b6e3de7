//! The bounding volume hierarchy over the boxes of primitives: its builder, and the nodes that traversals
//! read.
//!
//! | file | what it does |
//! |---|---|
//! | `bounds` | axis-aligned boxes, and boxes packed so that a union is one instruction |
//! | `node` | nodes and leaves as traversals read them, and the limits that traversals rely on |
//! | `split` | splits a set of boxes in two: surface area heuristic over bins, median |
//! | `cost` | computes the cost of a hierarchy and the cheapest way to collapse it |
//! | `build` | builds the binary tree |
//! | `collapse` | turns it into wide nodes, leaves, and a binary tree over the same leaves |
//! | `tree` | runs all of these in one call: [`Bvh`] |
//! | `refit` | moves the boxes to primitives that have moved |
//! | [`check`] | checks validity and collects statistics |
//!
//! # What a traversal may rely on
//! - Every primitive is in exactly one leaf; a leaf holds 1 to [`LEAF`] primitives of one kind, ascending.
//!   Leaves are in depth-first order.
//! - A child's box holds the boxes of all primitives below it exactly: planes are copied, never computed.
//! - The root is node 0; it always exists, in the wide tree and in the binary one. A wide node's filled slots
//!   come first; the others have an empty box (+∞, −∞), which no ray hits. A scene without primitives has an
//!   empty root.
//! - No leaf is deeper than [`MAX_DEPTH`] levels below the root. A traversal that pops one reference and
//!   pushes what it hits never holds more than [`MAX_STACK`] references in the wide tree and [`MAX_DEPTH`] +
//!   1 in the binary tree.
//! - The same scene gives the same hierarchy in every bit, for any number of threads.

mod bounds;
mod build;
pub mod check;
mod collapse;
mod cost;
mod node;
mod refit;
mod split;
mod tree;

pub use crate::kind::{LEAF, Leaf};
pub use bounds::{Bounds, MAX_PRIMITIVES};
pub use node::{BinaryNode, Child, MAX_DEPTH, MAX_STACK, WIDE, WideNode, slots};
pub use tree::{Bvh, Trees};
