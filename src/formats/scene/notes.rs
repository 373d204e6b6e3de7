//! Collects notes about the parts of a file that are left out: one for each kind, with its first place and
//! the number of places.

use super::error::{MAX_FAULTS, SceneError};
use std::fmt::Display;
use std::path::Path;

/// Most kinds of notes, so that a search of all of them stays fast.
const MOST: usize = 100;

/// Notes about the parts of a file that are left out.
#[derive(Default)]
pub struct Notes {
    /// The key of each kind, its text, the first place and the number of places.
    kinds: Vec<(String, String, String, usize)>,
    /// Number of notes of further kinds.
    others: usize,
    faults: Vec<SceneError>,
}

impl Notes {
    /// Adds a note about a place.
    pub fn add(&mut self, place: &impl Display, what: impl Into<String>) {
        let what = what.into();
        self.add_kind(&what, place, || what.clone());
    }
    fn add_kind(&mut self, key: &str, place: &impl Display, what: impl FnOnce() -> String) {
        match self.kinds.iter().position(|(known, ..)| known == key) {
            Some(known) => self.kinds[known].3 += 1,
            None if self.kinds.len() < MOST => {
                self.kinds.push((key.to_string(), what(), place.to_string(), 1));
            }
            None => self.others += 1,
        }
    }
    /// Notes that a part of the file, such as a statement, is left out because of a fault.
    pub fn add_fault(&mut self, left_out: &str, fault: SceneError) {
        let at = fault.at.as_deref().unwrap_or_default();
        let place = at.strip_prefix("line ").map_or_else(|| format!(" {at}"), str::to_string);
        self.add_kind(left_out, &place, || format!("{left_out} is left out: {}", fault.what));
        if self.faults.len() < MAX_FAULTS {
            self.faults.push(fault);
        }
    }
    /// Returns the faults as one error, for a file of which nothing is left; `otherwise` without faults.
    pub fn refusal(self, otherwise: SceneError) -> SceneError {
        SceneError::join(self.faults).unwrap_or(otherwise)
    }
    /// Returns the notes as warnings, with `separator` between the file's name and the place.
    pub fn warnings(&self, path: &Path, separator: &str) -> impl Iterator<Item = String> {
        let path = path.display();
        let others =
            (self.others > 0).then(|| format!("{path}: {} more of other kinds are left out.", self.others));
        let kinds = self.kinds.iter().map(move |(_, what, place, count)| {
            let more = if *count > 1 { format!(" ({} more like it)", count - 1) } else { String::new() };
            format!("{path}{separator}{place}: {what}{more}.")
        });
        kinds.chain(others)
    }
}
