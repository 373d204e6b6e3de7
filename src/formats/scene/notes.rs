//! What is left out of a file: each kind once, with its first place and the number of places.
//!
//! For: [`Notes`].

use super::builder::SceneBuilder;
use std::fmt::Display;
use std::path::Path;

/// Most kinds that are told apart: a search of all of them stays fast, and nobody reads more.
const MOST: usize = 100;

/// What is left out of a file.
pub struct Notes {
    /// Between the file's name and the place.
    separator: &'static str,
    /// What it is, the first place and the number of places.
    kinds: Vec<(String, String, usize)>,
    others: usize,
}

impl Notes {
    pub fn new(separator: &'static str) -> Self {
        Self { separator, kinds: Vec::new(), others: 0 }
    }
    pub fn add(&mut self, place: &impl Display, what: impl Into<String>) {
        let what = what.into();
        match self.kinds.iter().position(|(known, ..)| *known == what) {
            Some(known) => self.kinds[known].2 += 1,
            None if self.kinds.len() < MOST => self.kinds.push((what, place.to_string(), 1)),
            None => self.others += 1,
        }
    }
    pub fn warn(self, path: &Path, builder: &mut SceneBuilder) {
        let (path, separator) = (path.display(), self.separator);
        for (what, place, count) in self.kinds {
            let more = if count > 1 { format!(" ({} more like it)", count - 1) } else { String::new() };
            builder.warn(format!("{path}{separator}{place}: {what}{more}."));
        }
        if self.others > 0 {
            builder.warn(format!("{path}: {} more of other kinds are left out.", self.others));
        }
    }
}
