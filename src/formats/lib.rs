//! Reads scene files and writes picture files.
//!
//! ```text
//! .json (native, thesis, view), .obj + .mtl, .gltf, .glb, .ply, builtin:NAME  ->  scene::load  ->  Scene
//! film::Picture  ->  output::save  ->  .png .jpg .exr .hdr
//! film::Film  <->  checkpoint::save, checkpoint::Checkpoint
//! ```
//!
//! `Scene` and `film` are the engine's. Each module imports only those above it.
//!
//! | module | what it does |
//! |---|---|
//! | [`wording`] | numbers and nouns as text |
//! | [`openexr`] | OpenEXR, read (textures) and written (pictures) |
//! | [`scene`] | scene files, models and views, read as a valid [`scene::Scene`]; views and native files, written |
//! | [`output`] | pictures as PNG, JPEG, EXR or HDR; files that are complete or absent |
//! | [`checkpoint`] | the sums of a film or of a shard of it, written and read bit by bit |
//!
//! The package imports the engine's scene model ([`octray_engine::scene`]), its
//! [`film`](octray_engine::film), its [`tone`](octray_engine::tone) mapping, and the choices that a view's
//! render options name. It renders nothing, and it must not know the command line, the viewer or the
//! laboratory.
//!
//! Every error ([`scene::SceneError`], [`output::OutputError`]) names the fault, its place (file, JSON path,
//! line and column) and a remedy. A scene that loads is valid, and no later stage checks it again.
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
