//! From scene files to a valid [`Scene`].
//!
//! For: [`load`] and [`load_with_view`], which read every format; [`View`], which is also written;
//! [`native_from_obj`], which converts a model. The scene model itself is the engine's, re-exported here. May
//! import: the engine's scene model, the files that hold pictures. Must not know: buffers, lanes, pipelines,
//! windows.
//!
//! | file | what it does |
//! |---|---|
//! | `load` | from a name on the command line to a [`Scene`]; detects the format |
//! | `native` | the native JSON as the user wrote it: keys and their JSON types |
//! | `validate`, `material` | from that to a [`Scene`], or an error that says where and how to mend it |
//! | `thesis` | the thesis's own JSON |
//! | `obj`, `mtl`, `statements` | Wavefront OBJ and MTL, and the lines that both are made of |
//! | `placement` | scale, rotation and translation of a mesh |
//! | `procedural` | generated meshes of any size |
//! | `view` | a view file: another scene, a camera, render options; read and written |
//! | `camera_path` | cameras between the keyframes of a view |
//! | `convert` | from a model to a native scene file |
//! | `write` | numbers, vectors, cameras and paths as the native formats write them |
//! | `builder` | collects materials, textures and primitives; fills in defaults |
//! | `texture` | image files decoded to texels |
//! | `files` | reads a scene's other files and records which were requested |
//! | `builtin`, `embedded` | the built-in scenes by name; their files inside the program |
//! | `check`, `spelling` | bounds of numbers; suggestions for misspelt names |
//! | `json` | reading JSON; the line and column of a JSON path |
//! | [`error`] | why a scene was refused |

mod builder;
mod builtin;
mod camera_path;
mod check;
mod convert;
mod embedded;
pub mod error;
mod files;
mod json;
mod load;
mod material;
mod mtl;
mod native;
mod obj;
mod placement;
mod procedural;
mod spelling;
mod statements;
mod texture;
mod thesis;
mod validate;
mod view;
mod write;

pub use builtin::names as builtin_names;
pub use camera_path::{CameraPath, Keyframe};
pub use convert::{native_from_obj, native_from_obj_in};
pub use error::SceneError;
pub use load::{load, load_with_view};
pub use view::{Loaded, Rendering, View, view_fault};

pub use octray_engine::scene::*;
