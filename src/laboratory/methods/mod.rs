//! Intersection methods: the engine's own, and others, which are charted and tested beside them. Some of the
//! others render ([`renderer`]).

mod baldwin_weber;
mod boxes;
mod moller_trumbore;
mod plucker;
mod primitive_tests;
mod sphere;
mod triangle;

pub use baldwin_weber::{AffineMap, BaldwinWeber};
pub use boxes::{BoxMethod, BySign, BySignWidened, Contracted, IeeeMinMax, Padded, X86MinMax};
pub use moller_trumbore::{Edges, MollerTrumbore, MollerTrumboreEpsilon};
pub use plucker::Plucker;
pub use primitive_tests::{MethodTests, renderer, tests};
pub use sphere::{Naive, Robust, RobustAnyLength, Scaled, SphereMethod};
pub use triangle::{TriangleMethod, Woop, WoopContracted};
