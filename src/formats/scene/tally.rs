//! Counts a model's triangles as they enter the builder.
//!
//! For: [`Tally`], [`Misplaced`].

use super::builder::SceneBuilder;
use glam::DVec3;
use std::path::Path;

/// Why a model cannot be used with its placement.
#[derive(Debug)]
pub enum Misplaced {
    /// This point lies beyond the bounds of a scene.
    TooFar(DVec3),
    /// No triangle has an area in single precision.
    NoArea,
}

/// The number of triangles with and without area.
#[derive(Default)]
pub struct Tally {
    with_area: usize,
    without_area: usize,
}

impl Tally {
    pub fn count(&mut self, has_area: bool) {
        match has_area {
            true => self.with_area += 1,
            false => self.without_area += 1,
        }
    }
    /// Warns of triangles without area; `Some` if there are no others.
    pub fn finish(self, path: &Path, builder: &mut SceneBuilder) -> Option<Misplaced> {
        let Self { with_area, without_area } = self;
        if with_area == 0 {
            return Some(Misplaced::NoArea);
        }
        if without_area > 0 {
            let (noun, verb) = if without_area == 1 { ("triangle", "was") } else { ("triangles", "were") };
            builder.warn(format!("{}: {without_area} {noun} of zero area {verb} left out.", path.display()));
        }
        None
    }
}
