//! Saves the sums of a film in a file, bit by bit, so that a rendering can resume. The shards of a picture
//! are files in this format, and [`merge`](mod@merge) joins them.
//!
//! # Format, version 3
//! All numbers are little-endian; a word has 32 bits.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | magic: `89 6f 63 74 72 61 79 0a` (`octray` between a byte that is not ASCII and a line feed) |
//! | 4 | version of the format: 3 |
//! | 4 | n, the length of the header: at most 2¹⁶ |
//! | n | the header ([`Header`]), JSON in UTF-8 |
//! | 4 | CRC-32 (ISO-HDLC, as in PNG) of everything before |
//! | 16 + 4 m each | the tiles, in ascending order of their numbers; the header has their number |
//! | 4 | CRC-32 of everything before |
//! | 8 + 4 m each | of a part of a picture to be denoised: the rows of the denoiser's AOVs |
//! | 4 | with such rows, CRC-32 of everything before |
//!
//! A tile begins with four words: its number, the samples that each of its pixels has, the samples that they
//! are to have at the end of the present round of adaptive sampling, and 1 if a column of discarded samples
//! follows, else 0. The m words of its pixels follow in the order of [`TileSums::words_into`]: compensated
//! sums with their rounding errors, and with a target error the sums that estimate the variance. They do not
//! depend on the width of the program's packets. A row begins with its number and m, and has m words.
//!
//! # Properties that must be the same to resume
//! [`Identity`] has the version of octray and its rounding (with fused multiply-add or without), the scene's
//! content, every setting that changes a bit of the film, and the shard. Threads, lanes, pipeline, traversal
//! and tone mapping may differ. A CRC-32 of each part of a scene finds changed scenes, but not forged ones.
//!
//! # Shards
//! Shard i of n has the tiles whose number leaves the remainder i − 1 when divided by n ([`Shard`]).
//! Neighbouring tiles are in different shards, so that all have about the same work. Shards divide the pixels
//! and not the samples: f32 addition is not associative, so the sums of two halves of a pixel's samples do
//! not add up to the bits of one sum, whereas a whole tile has the same bits in any film. Adaptive sampling
//! decides by the whole picture and so cannot be divided.
//!
//! [`TileSums::words_into`]: octray_engine::film::TileSums::words_into

mod error;
mod file;
mod fingerprint;
mod identity;
pub mod merge;
#[cfg(test)]
mod tests;

pub use error::CheckpointError;
pub use file::{Checkpoint, GuideRows, Header, is_checkpoint, save};
pub use fingerprint::Fingerprint;
pub use identity::{Identity, Program, Recorded, Shard};
