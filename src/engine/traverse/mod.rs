//! Which primitive a ray hits first.
//!
//! | file | traversal |
//! |---|---|
//! | `list` | every primitive is tested, of primary rays those that their tile can see, of shadow rays the [`Occluders`] |
//! | [`scalar`] | one ray on the binary tree, one box and one primitive at a time: the baseline |
//! | [`single`] | one ray on the wide tree, against all boxes of a node or primitives of a leaf at once |
//! | [`tile`] | primary rays of a tile on the wide tree, each packet in a [`frustum`] |
//! | [`stream`] | ray streams on the wide tree: batches of rays in any order |
//! | `tree` | the choice between those of the hierarchy |
//!
//! [`Primitives`] asks them. They share [`hierarchy`] (nodes and leaves),
//! `leaf` (how rays intersect triangles), `quadrics` (all else), `compact` (the leaves of large hierarchies),
//! `precalculated` (rays ready for boxes and triangles), [`rays`] (columns of rays and hits), [`stack`], and
//! [`counter`], which counts the tests.
//!
//! The law of every traversal: it gives the same hit, bit for bit, as testing every primitive in order,
//! quadrics first, then triangles, the nearest t winning and the lower index on a tie.

mod compact;
pub mod counter;
pub mod frustum;
pub mod hierarchy;
mod leaf;
mod list;
mod methods;
mod occluders;
mod precalculated;
mod primitive_list;
mod primitives;
mod quadrics;
pub mod rays;
pub mod scalar;
pub mod single;
pub mod stack;
pub mod stream;
pub mod tile;
mod tree;

pub use compact::Layout;
pub use list::List;
pub use methods::{MAX_LIST_COST, TRIANGLE_COST, features_of, list_cost};
pub use methods::{Methods, TraversalChoice, TriangleChoice};
pub use occluders::Occluders;
pub use precalculated::{Packet, SingleRay};
pub use primitive_list::PrimitiveList;
pub use primitives::Primitives;
pub use quadrics::SphereChoice;
pub use tree::{Tracer, Traversal};
