//! What is left out of a model: each kind once, with its first place and the number of places.
//!
//! For: [`Notes`]. May import: `builder`, `json`. Must not know: glTF.

use super::super::builder::SceneBuilder;
use super::super::json::JsonPath;
use std::path::Path;

#[derive(Default)]
pub struct Notes(Vec<(String, String, usize)>);

impl Notes {
    pub fn add(&mut self, place: &JsonPath, what: String) {
        match self.0.iter_mut().find(|(known, ..)| *known == what) {
            Some((.., count)) => *count += 1,
            None => self.0.push((what, place.to_string(), 1)),
        }
    }
    pub fn warn(self, path: &Path, builder: &mut SceneBuilder) {
        for (what, place, count) in self.0 {
            let more = if count > 1 { format!(" ({} more like it)", count - 1) } else { String::new() };
            builder.warn(format!("{}: {place}: {what}{more}.", path.display()));
        }
    }
}
