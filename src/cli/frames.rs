//! `--frames` and `--shard`: which frames, which part, and the names of their files.

use crate::checkpoint::Shard;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Largest number of a frame.
const MAX_FRAME: u32 = 9_999_999;
/// Most shards: more than there are machines, and fewer than tiles in most pictures.
const MAX_SHARDS: u32 = 65_536;

/// Reads the first and the last frame, `A..B`, or `A` for a single one.
pub fn frames(text: &str) -> Result<RangeInclusive<u32>, &'static str> {
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    match (first.parse(), last.parse()) {
        (Ok(first), Ok(last)) if first <= last && last <= MAX_FRAME => Ok(first..=last),
        (Ok(first), Ok(last)) if first > last => {
            Err("the first frame is after the last: give A..B, such as 1..48")
        }
        _ => Err("give the first and the last frame as A..B, such as 1..48"),
    }
}

/// Reads `I/N`.
pub fn shard(text: &str) -> Result<Shard, &'static str> {
    match text.split_once('/').map(|(number, of)| (number.parse(), of.parse())) {
        Some((Ok(number), Ok(of))) if (1..=of).contains(&number) && of <= MAX_SHARDS => {
            Ok(Shard { number, of })
        }
        _ => Err("give I/N, such as 3/8 for the third of eight parts; I is from 1 to N"),
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
        for (text, range) in [("1..48", 1..=48), ("0..0", 0..=0), ("7", 7..=7)] {
            assert_eq!(frames(text), Ok(range));
        }
        for text in ["", "..", "1..", "..2", "2..1", "1...2", "1-2", "-1..2", "1..10000000", "a..b"] {
            assert!(frames(text).unwrap_err().contains("1..48"), "{text}");
        }
    }

    #[test]
    fn shards_count_from_one() {
        assert_eq!(shard("3/8"), Ok(Shard { number: 3, of: 8 }));
        for text in ["", "/", "3", "0/8", "9/8", "3/0", "3/65537", "-1/8", "1/2/3", "1 / 2"] {
            assert!(shard(text).unwrap_err().contains("3/8"), "{text}");
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
