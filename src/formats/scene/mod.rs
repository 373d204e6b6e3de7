//! What a scene is: the accepted form of what the user wrote.
//!
//! For: [`Scene`], whose existence is the proof of validity, and the ways to get one ([`load`]). May import: `math`.
//! Must never know: buffers, lanes, pipelines, pixels.
//!
//! | file | what it does |
//! |---|---|
//! | `load` | from a name on the command line to a [`Scene`] |
//! | `file` | the native JSON as the user wrote it |
//! | `validate`, `material` | from that to a [`Scene`], or an error that says where and how to mend it |
//! | `thesis` | the thesis's own JSON |
//! | `obj`, `mtl` | Wavefront OBJ and MTL |
//! | `convert` | from a model to a native scene file |
//! | `view` | another scene, and how it is looked at: read and written |
//! | `writing` | what writers of the native formats share |
//! | `draft` | what all formats share: a scene in the making |
//! | `check` | numbers as a scene may hold them |
//! | `image` | texture files |
//! | `builtin`, `files` | the scenes inside the program; files there and on disk |
//! | `procedural` | meshes of any size, made by rule |
//! | `place` | where in a JSON text something stands |
//! | [`error`] | what can be wrong |

mod builtin;
mod check;
mod convert;
mod draft;
pub mod error;
mod file;
mod files;
mod image;
mod load;
mod material;
mod mtl;
mod obj;
mod place;
mod procedural;
mod thesis;
mod validate;
mod view;
mod writing;

pub use builtin::names as builtin_names;
pub use convert::{native_from_obj, native_from_obj_in};
pub use error::SceneError;
pub use load::{Loaded, load, load_with_view};
pub use view::{Rendering, View, view_fault};

pub use octray_engine::scene::*;
