//! Picture files: tone mapping, encoding, and files that are complete or absent.
//!
//! For: [`save`] and [`save_unless`], which write a [`Picture`](octray_engine::film::Picture); [`save_text`]
//! and [`save_json`]; and the parts they are made of.
//!
//! | file | what it does |
//! |---|---|
//! | [`picture`] | PNG, JPEG, EXR and HDR |
//! | [`mod@file`] | atomic writes |
//! | [`error`] | why a file was not written |

pub mod error;
pub mod file;
pub mod picture;

pub use error::OutputError;
pub use file::{
    CancellableWriter, Existing, check, make_folder, remove_leftovers, save_json, save_text, write_atomically,
};
pub use picture::{Format, encode, save, save_unless};
