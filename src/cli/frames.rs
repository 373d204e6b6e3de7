//! `--frames` and `--shard`: which frames, which part, and the names of their files.
//!
//! For: [`Frames`], [`shard`], [`numbered`].

use super::error::CliError;
use super::numbers::{read_whole, refuse};
use crate::checkpoint::Shard;
use std::path::{Path, PathBuf};

/// Largest number of a frame.
pub const MAX_FRAME: u32 = 9_999_999;
/// Most shards: more than there are machines, and fewer than tiles in most pictures.
pub const MAX_SHARDS: u32 = 65_536;

/// Frames from `first` to `last`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    pub first: u32,
    pub last: u32,
}

impl Frames {
    /// Reads `A..B`, or `A` for a single one.
    pub fn read(text: &str) -> Result<Self, CliError> {
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        match (read_whole(first), read_whole(last)) {
            (Some(first), Some(last)) if first <= last && last <= MAX_FRAME => Ok(Self { first, last }),
            (Some(first), Some(last)) if first > last => {
                Err(refuse("--frames", text, "the first frame is after the last: give A..B, such as 1..48"))
            }
            _ => Err(refuse("--frames", text, "give the first and the last frame as A..B, such as 1..48")),
        }
    }
    pub fn numbers(self) -> impl Iterator<Item = u32> {
        self.first..=self.last
    }
    pub fn count(self) -> u32 {
        self.last - self.first + 1
    }
}

/// Reads `I/N`.
pub fn shard(text: &str) -> Result<Shard, CliError> {
    let numbers = text.split_once('/').map(|(number, of)| (read_whole(number), read_whole(of)));
    match numbers {
        Some((Some(number), Some(of))) if (1..=of).contains(&number) && of <= MAX_SHARDS => {
            Ok(Shard { number, of })
        }
        _ => Err(refuse(
            "--shard",
            text,
            "give I/N, such as 3/8 for the third of eight parts; I is from 1 to N",
        )),
    }
}

/// The file of a frame: the last `#`, or row of them, of the file's name becomes the frame's number, with
/// zeros to as many digits as there are `#`. `None` without a `#`.
pub fn numbered(path: &Path, frame: u32) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let end = name.rfind('#')? + 1;
    let start = name[..end].trim_end_matches('#').len();
    let digits = end - start;
    Some(path.with_file_name(format!("{}{frame:0digits$}{}", &name[..start], &name[end..])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_a_range_or_one() {
        let range = |first, last| Frames { first, last };
        for (text, frames) in [("1..48", range(1, 48)), ("0..0", range(0, 0)), ("7", range(7, 7))] {
            assert_eq!(Frames::read(text).unwrap(), frames);
        }
        for text in ["", "..", "1..", "..2", "2..1", "1...2", "1-2", "-1..2", "1..10000000", "a..b"] {
            let message = Frames::read(text).unwrap_err().to_string();
            assert!(message.contains("--frames") && message.contains("1..48"), "{text}: {message}");
        }
    }

    #[test]
    fn shards_count_from_one() {
        assert_eq!(shard("3/8").unwrap(), Shard { number: 3, of: 8 });
        for text in ["", "/", "3", "0/8", "9/8", "3/0", "3/65537", "-1/8", "1/2/3", "1 / 2"] {
            let message = shard(text).unwrap_err().to_string();
            assert!(message.contains("--shard") && message.contains("3/8"), "{text}: {message}");
        }
    }

    #[test]
    fn numbered_fills_the_last_row_of_signs() {
        let name = |path: &str| numbered(path.as_ref(), 42).map(|path| path.to_str().unwrap().to_owned());
        assert_eq!(name("a/shot-####.png").as_deref(), Some("a/shot-0042.png"));
        assert_eq!(name("#.png").as_deref(), Some("42.png"));
        assert_eq!(name("take#2-###.exr").as_deref(), Some("take#2-042.exr"));
        assert_eq!(name("a#/shot.png"), None);
        assert_eq!(name("shot.png"), None);
    }
}
