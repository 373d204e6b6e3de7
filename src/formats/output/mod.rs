//! Pictures as people and programs see them: tone mapping, encoding, files that are whole or absent.
//!
//! For: [`save`] and [`save_unless`], which turn a [`Picture`] into a file, [`save_text`] and [`save_json`], and the parts they are made of. May import: `film`.
//! Must never know: scenes, rays, command lines, windows.
//!
//! | file | what it does |
//! |---|---|
//! | [`mod@encode`] | from a picture to PNG, JPEG, EXR or HDR |
//! | [`mod@file`] | writing that leaves a whole file or none |
//! | [`error`] | what can go wrong on the way |

pub mod encode;
pub mod error;
pub mod file;

pub use encode::{Format, encode};
pub use error::OutputError;
pub use file::{Existing, Unless, check, make_folder, save_json, save_text, write_atomically};

use crate::film::Picture;
use crate::tone::Tone;
use std::path::Path;

/// linear radiance. Afterwards the file is whole, or as it was before.
pub fn save(path: &Path, picture: &Picture, tone: &Tone) -> Result<(), OutputError> {
    save_unless(path, picture, tone, &|| false)
}

/// As [`save`]; fails, and leaves the place as it was before, once `given_up` says so.
pub fn save_unless(
    path: &Path,
    picture: &Picture,
    tone: &Tone,
    given_up: &dyn Fn() -> bool,
) -> Result<(), OutputError> {
    let format = Format::of(path)?;
    write_atomically(path, Existing::Replace, |inner| {
        encode(Unless { inner, given_up }, picture, format, tone)
    })
}
