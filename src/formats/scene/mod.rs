//! Loads scene files, models and views as a valid [`Scene`], and writes views and native files.
//!
//! `load` detects the format of a name on the command line. A native file is read in two steps: `native` has
//! its keys and JSON types, and `validate` converts them to a [`Scene`], or reports each fault with its place
//! and a remedy. Models (`obj`, `gltf`, `ply`) and the format of the thesis (`thesis`) take shorter ways. All
//! formats add their materials, textures and primitives to a `builder`.
//!
//! The scene model itself is the engine's, re-exported here.

mod alpha;
mod builder;
mod camera;
mod camera_path;
mod check;
mod colorimetry;
mod convert;
mod embedded;
pub mod error;
mod faults;
mod files;
mod glass;
mod gltf;
mod json;
mod light;
mod load;
mod material;
mod material_extras;
mod mesh;
mod model;
mod mtl;
mod mtl_map;
mod native;
mod notes;
mod obj;
mod placement;
mod ply;
mod portal;
mod procedural;
mod radiance;
mod relief;
mod scalar;
mod smooth;
mod spelling;
mod statements;
mod texture;
mod thesis;
mod validate;
mod vertex_colors;
mod view;
mod write;

pub use camera_path::{CameraPath, Keyframe};
pub use convert::{Converted, convert_model};
pub use embedded::{bench_names, names as builtin_names};
pub use error::SceneError;
pub use files::has_extension;
pub use load::{load, load_as, load_from, load_with_view, may_be_scene};
pub use model::is_model;
pub use view::{Loaded, Rendering, View, view_fault};
pub use write::point_in_file;

pub use octray_engine::scene::*;
