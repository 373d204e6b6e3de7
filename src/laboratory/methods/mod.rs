//! Intersection methods: the engine's own, and others, which are charted and tested beside them. Some of the
//! others render ([`renderer`]).

mod boxes;
mod primitive_tests;
mod sphere;
mod triangle;

pub use boxes::{BoxMethod, BySign, BySignWidened, Contracted, IeeeMinMax, Padded, X86MinMax};
pub use primitive_tests::{MethodTests, renderer, tests};
pub use sphere::{Naive, Robust, RobustAnyLength, Scaled, SphereMethod};
pub use triangle::{AffineMap, BaldwinWeber, Edges, MollerTrumbore, MollerTrumboreEpsilon, Plucker};
pub use triangle::{TriangleMethod, Woop, WoopContracted};
