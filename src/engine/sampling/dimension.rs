//! Numbers the sample dimensions of a path.
//!
//! Dimensions come in pairs, an even one and the next, which [`super::sobol`] stratifies together. [`PIXEL`]
//! (a pair) places the sample in its pixel, [`LENS`] (a pair) on the camera's lens. Scattering event b,
//! counted from 0, has the [`PER_BOUNCE`] dimensions from [`bounce`]`(b)` on.

/// The position in the pixel, a pair.
pub const PIXEL: u32 = 0;
/// The position on the camera's lens, a pair.
pub const LENS: u32 = 2;
/// The number of dimensions of one scattering event; even, so that pairs stay pairs.
pub const PER_BOUNCE: u32 = 8;
/// Within an event: the choice of the material's lobe, such as reflection or refraction.
pub const LOBE: u32 = 0;
/// Within an event: the choice of the light, if there are so many that [`LIGHT_POINT`] has too few digits for
/// light and point. It is a pair with [`LOBE`].
pub const LIGHT: u32 = 1;
/// Within an event, a pair: the scattered direction.
pub const DIRECTION: u32 = 2;
/// Within an event, a pair: the light, and the point on it.
pub const LIGHT_POINT: u32 = 4;
/// Within an event: which of the two lights of an alias table's entry, where [`LIGHT`] chose the entry.
pub const LIGHT_ALIAS: u32 = 6;
/// Within an event: one of the lights that were chosen by power. It is a pair with [`LIGHT_ALIAS`].
pub const LIGHT_RESAMPLED: u32 = 7;

/// Returns the first dimension of scattering event `bounce`, counted from 0.
#[inline(always)]
pub const fn bounce(bounce: u32) -> u32 {
    PER_BOUNCE * (bounce + 1)
}
