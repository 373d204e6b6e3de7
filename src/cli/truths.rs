//! Truths that were rendered before: a picture takes long to become true, and stays so.
//!
//! For: [`load`], [`save`]. May import: `output`, `measure::chart`. Must never know: how a truth is made.
//!
//! A truth is kept as an .exr of the frame and a .json of its quality beside it, under a name that holds a fingerprint of all that decides
//! it: the scene with all its pictures, size, bounces, and the commit of the program.

use super::error::CliError;
use crate::film::Picture;
use crate::measure::Machine;
use crate::measure::chart::truth::{Quality, Truth};
use crate::output::{self, Tone};
use crate::report::chart::file_name;
use crate::scene::Scene;
use std::fmt::Write;
use std::fs;
use std::hash::{DefaultHasher, Hasher};
use std::path::{Path, PathBuf};

/// Where the truth of this scene is kept, without an extension.
pub fn place(folder: &Path, scene: &Scene, size: [u32; 2], max_bounces: u32) -> PathBuf {
    struct Hashed(DefaultHasher);
    impl Write for Hashed {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            self.0.write(text.as_bytes());
            Ok(())
        }
    }
    let mut hashed = Hashed(DefaultHasher::new());
    // A scene's debugging text holds all that it is, and every f32 in as many digits as tell it from all others.
    let _ = write!(hashed, "{scene:?} {size:?} {max_bounces} {}", Machine::current().commit);
    folder.join("truth").join(format!("{}-{:016x}", file_name(&scene.name), hashed.0.finish()))
}

/// The truth that is kept there; `None` where there is none that can be read, or its size is another.
pub fn load(place: &Path, size: [u32; 2]) -> Option<Truth> {
    let quality: Quality = serde_json::from_slice(&fs::read(place.with_extension("json")).ok()?).ok()?;
    let picture = image::open(place.with_extension("exr")).ok()?.into_rgb32f();
    let [width, height] = size;
    if picture.dimensions() != (width, height) {
        return None;
    }
    let pixels = picture.pixels().map(|pixel| pixel.0).collect();
    Some(Truth::kept(Picture { width, height, pixels }, quality))
}

/// Keeps a truth: the picture first, so that there is no quality without one.
pub fn save(place: &Path, truth: &Truth) -> Result<(), CliError> {
    let quality = place.with_extension("json");
    output::make_folder(place.parent().unwrap_or(Path::new(".")))?;
    output::save(&place.with_extension("exr"), &truth.frame, &Tone::default())?;
    Ok(output::save_json(&quality, &truth.quality)?)
}
