//! Writes picture files: tone mapping, encoding, and files that are complete or absent.

pub mod error;
pub mod file;
pub mod picture;

pub use error::OutputError;
pub(crate) use file::CancellableWriter;
pub use file::{Existing, check, make_folder, remove_leftovers, save_json, save_text, write_atomically};
pub use picture::{Format, encode, save, save_channels, save_shown, save_unless};
