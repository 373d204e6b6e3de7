//! From scene files to a valid [`Scene`].
//!
//! The scene model itself is the engine's, re-exported here.
//!
//! | file | what it does |
//! |---|---|
//! | `load` | from a name on the command line to a [`Scene`]; detects the format |
//! | `native` | the native JSON as the user wrote it: keys and their JSON types |
//! | `validate`, `material` | from that to a [`Scene`], or an error that says where and how to mend it |
//! | `thesis` | the thesis's own JSON |
//! | `model` | models of any format: reading them, and a scene of one |
//! | `obj`, `mtl`, `statements` | Wavefront OBJ and MTL, and the lines that both are made of |
//! | `gltf` | glTF 2.0, as text (.gltf) and binary (.glb) |
//! | `ply` | PLY, as text and in both binary orders |
//! | `scalar` | numbers in binary files |
//! | `notes` | what is left out of a file, each kind once |
//! | `mesh` | a mesh of polygons; why a model cannot be used |
//! | `placement` | a model's scale, rotation and translation |
//! | `procedural` | generated meshes of any size |
//! | `view` | a view file: another scene, a camera, render options; read and written |
//! | `camera_path` | cameras between the keyframes of a view |
//! | `convert` | from a model to a native scene file |
//! | `write` | numbers, vectors, cameras and paths as the native formats write them |
//! | `vertex_colors` | colours of vertices as a texture |
//! | `builder` | collects materials, textures and primitives; fills in defaults |
//! | `texture`, `radiance`, `colorimetry` | image files decoded to texels; headers of .hdr files; Rec. 709 |
//! | `files` | reads a scene's other files and records which were requested |
//! | `embedded` | the built-in scenes by name; their files inside the program |
//! | `check`, `spelling` | bounds of numbers; suggestions for misspelt names |
//! | `json` | reading JSON; the line and column of a JSON path |
//! | `faults` | all faults of a native text at once |
//! | [`error`] | why a scene was refused |

mod builder;
mod camera_path;
mod check;
mod colorimetry;
mod convert;
mod embedded;
pub mod error;
mod faults;
mod files;
mod gltf;
mod json;
mod load;
mod material;
mod mesh;
mod model;
mod mtl;
mod native;
mod notes;
mod obj;
mod placement;
mod ply;
mod procedural;
mod radiance;
mod scalar;
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
pub use model::{EXTENSIONS as MODEL_EXTENSIONS, is_model};
pub use view::{Loaded, Rendering, View, view_fault};
pub use write::point_in_file;

pub use octray_engine::scene::*;
