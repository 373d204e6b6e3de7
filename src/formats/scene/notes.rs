//! What is left out of a file: each kind once, with its first place and the number of places.
//!
//! For: [`Notes`].

use std::fmt::Display;
use std::path::Path;

/// Most kinds that are told apart: a search of all of them stays fast, and nobody reads more.
const MOST: usize = 100;

/// What is left out of a file.
#[derive(Default)]
pub struct Notes {
    /// What it is, the first place and the number of places.
    kinds: Vec<(String, String, usize)>,
    others: usize,
}

impl Notes {
    pub fn add(&mut self, place: &impl Display, what: impl Into<String>) {
        let what = what.into();
        match self.kinds.iter().position(|(known, ..)| *known == what) {
            Some(known) => self.kinds[known].2 += 1,
            None if self.kinds.len() < MOST => self.kinds.push((what, place.to_string(), 1)),
            None => self.others += 1,
        }
    }
    /// `separator` stands between the file's name and the place.
    pub fn into_warnings(self, path: &Path, separator: &str) -> impl Iterator<Item = String> {
        let path = path.display();
        let others =
            (self.others > 0).then(|| format!("{path}: {} more of other kinds are left out.", self.others));
        let kinds = self.kinds.into_iter().map(move |(what, place, count)| {
            let more = if count > 1 { format!(" ({} more like it)", count - 1) } else { String::new() };
            format!("{path}{separator}{place}: {what}{more}.")
        });
        kinds.chain(others)
    }
}
