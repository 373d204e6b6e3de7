//! Intersection methods that are charted and tested beside the engine's own, and never render.

mod baldwin_weber;
mod boxes;
mod plucker;
mod variants;

pub use crate::kernel::ray_sphere::{Naive, Robust};
pub use crate::kernel::ray_triangle::{MollerTrumbore, Woop};
pub use baldwin_weber::{AffineMap, BaldwinWeber};
pub use boxes::{BoxMethod, BySign, BySignWidened, Contracted, IeeeMinMax, Padded, X86MinMax};
pub use plucker::Plucker;
pub use variants::{MollerTrumboreEpsilon, RobustAnyLength, WoopContracted};
