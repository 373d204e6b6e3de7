//! octray's file formats: scene files in, picture files out.
//!
//! ```text
//! .json (native, thesis, view), .obj + .mtl, builtin:NAME  ->  scene::load  ->  Scene (engine)
//! film::Picture (engine)  ->  output::save  ->  .png .jpg .exr .hdr
//! film::Film (engine)  <->  checkpoint::save, checkpoint::Checkpoint
//! ```
//!
//! Each module imports only those above it.
//!
//! | module | what it does |
//! |---|---|
//! | [`wording`] | numbers and nouns as text |
//! | [`openexr`] | OpenEXR, read (textures) and written (pictures) |
//! | [`scene`] | scene files, models and views into a valid [`scene::Scene`]; views and native files out |
//! | [`output`] | a picture as PNG, JPEG, EXR or HDR; files that are complete or absent |
//! | [`checkpoint`] | the sums of a film, whole or a shard of it, written and read bit by bit |
//!
//! The package imports the engine's scene model ([`octray_engine::scene`]), its
//! [`film`](octray_engine::film), its [`tone`](octray_engine::tone) mapping, and the choices that a view's
//! render options name. It renders nothing, and it must not know the command line, the viewer or the
//! laboratory.
//!
//! Every error says what is wrong, where (file, JSON path, line and column) and how to mend it:
//! [`scene::SceneError`], [`output::OutputError`]. A scene that loads is valid: no later stage checks it
//! again.
//!
//! ```
//! use octray_formats::scene::load;
//!
//! let scene = load("builtin:three")?;
//! assert!(!scene.spheres.is_empty());
//!
//! let error = load("builtin:thre").unwrap_err().to_string();
//! assert!(error.contains("did you mean `builtin:three`?"));
//! # Ok::<(), octray_formats::scene::SceneError>(())
//! ```

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod checkpoint;
pub mod openexr;
pub mod output;
pub mod scene;
pub mod wording;
