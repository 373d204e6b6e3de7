//! Tests of a pipeline's feature set.
//!
//! For: [`has`] and [`abilities`], constants once a pipeline is compiled. May import: `buffers`. Must never
//! know: stages.

use crate::buffers::{Abilities, Features};

/// Does the feature set `N` hold this feature? Constant for the compiler.
#[inline(always)]
pub const fn has(n: u32, feature: Features) -> bool {
    Features(n).contains(feature)
}

/// The texture lookups that the feature set `N` holds.
#[inline(always)]
pub const fn abilities(n: u32) -> Abilities {
    Abilities { bilinear: has(n, Features::BILINEAR), linear: has(n, Features::LINEAR_TEXTURES) }
}
