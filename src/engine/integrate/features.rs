//! Tests of a pipeline's feature set.
//!
//! For: [`has`], [`is_general`], [`ends_missed`], [`reads_texels_first`] and [`abilities`], constants once a
//! pipeline is compiled; [`carries_cones`].

use crate::buffers::{Abilities, Features};

/// Does the feature set `N` hold this feature? Constant for the compiler.
#[inline(always)]
pub const fn has(n: u32, feature: Features) -> bool {
    Features(n).contains(feature)
}

/// Is this the pipeline with every feature? The longest functions of shading are called there, and inlined in
/// others: a quarter less of the engine to compile, and as fast. See `perf/README.md`.
#[inline(always)]
pub const fn is_general(n: u32) -> bool {
    n == Features::ALL.0
}

/// Do paths that miss end where they are intersected, so that shading has full packets? Only under a sky that
/// the feature set knows: in scenes without one, nearly every ray hits the sphere around them, and looking
/// for misses costs 3 %.
#[inline(always)]
pub const fn ends_missed(n: u32) -> bool {
    has(n, Features::SKY_GRADIENT) || has(n, Features::SKY_TEXTURE)
}

/// Are texels read before shading, in a loop of their own? Where each hit has at most one, a display value.
#[inline(always)]
pub const fn reads_texels_first(n: u32) -> bool {
    has(n, Features::TEXTURES) && !Features(n).meets(MANY_TEXELS)
}

/// Features with which a hit may have several texels, or one that is more than four bytes.
const MANY_TEXELS: Features = Features::BILINEAR
    .with(Features::LINEAR_TEXTURES)
    .with(Features::LEVELS_OF_DETAIL)
    .with(Features::ROUGHNESS_MAPS)
    .with(Features::NORMAL_MAPS)
    .with(Features::EMISSION_MAPS);

/// The texture lookups that the feature set `N` holds.
#[inline(always)]
pub const fn abilities(n: u32) -> Abilities {
    Abilities {
        bilinear: has(n, Features::BILINEAR),
        linear: has(n, Features::LINEAR_TEXTURES),
        levels: has(n, Features::LEVELS_OF_DETAIL),
    }
}

/// Do paths carry ray cones? In the general pipeline only those of scenes that need them.
#[inline(always)]
pub const fn carries_cones(n: u32, needs: Features) -> bool {
    has(n, Features::LEVELS_OF_DETAIL) && needs.contains(Features::LEVELS_OF_DETAIL)
}
