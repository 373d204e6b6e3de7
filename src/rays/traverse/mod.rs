//! Finds the primitive that a ray hits first.
//!
//! | file | traversal |
//! |---|---|
//! | [`List`] | every primitive is tested, or the [`Candidates`](crate::Candidates) of the rays |
//! | [`scalar`] | one ray on the binary tree, one box and one primitive at a time: the baseline |
//! | [`single`] | one ray on the wide tree, against all boxes of a node or primitives of a leaf at once |
//! | [`tile`] | primary rays of a tile on the wide tree, each packet in a [`frustum`] |
//! | [`stream`] | ray streams on the wide tree: batches of rays in any order |
//! | `beyond` | one ray on the wide tree or list, for hits beyond a lower bound |
//! | `every` | one ray or a batch: every hit, and every triangle that rays in doubles may hit |
//! | `custom` | list or wide tree, with the caller's own tests of primitives |
//!
//! A [`Structure`] holds the list or the hierarchy, and a [`Tracer`] runs queries on it. Traversals share
//! [`hierarchy`] (nodes and leaves), [`stack`], and [`counter`], which counts the tests.
//!
//! Every traversal gives the same hit, bit for bit, as testing every primitive in order. The nearest t wins,
//! and the lower number on a tie.

mod beyond;
pub mod counter;
mod custom;
pub mod every;
pub mod frustum;
pub mod hierarchy;
mod occluders;
pub mod scalar;
pub mod single;
pub mod stack;
pub mod stream;
mod structure;
pub mod tile;
mod tracer;

pub use crate::kind::List;
pub use custom::PrimitiveTests;
pub use structure::{MAX_LIST_COST, Structure};
pub use tracer::{Tracer, Traversal};
