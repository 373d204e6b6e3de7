//! The viewer: explores a path-traced scene in a terminal or, with the feature `window`, in a window.
//!
//! A front end sends [`state::Event`]s and shows [`frame::Frame`]s. The render loop and the loader run in
//! threads of their own. Events reach the render loop through a message queue; frames reach the front end
//! through `frame::Exchange`, which swaps buffers.
//!
//! A file imports only those above it.
//!
//! | file | what it does |
//! |---|---|
//! | [`frame`], `timing` | frames handed from the render loop to a front end; frame rates, latencies |
//! | [`playlist`], `options` | the scenes to switch between; the options that the viewer starts with |
//! | `camera_controller` | the camera as keys and mouse move it |
//! | `display_mode`, `controls` | false-colour images instead of the picture; the settings that keys change |
//! | [`keys`] | the action of each key; the help |
//! | [`state`] | turns events into changes of camera, controls and playlist |
//! | `dynamic_resolution`, `accumulation` | the resolution that holds a frame rate; the film of the present pose, samples per frame |
//! | `file_watcher`, `loader` | changes of scene files; the thread that loads scenes |
//! | `minimap`, `painter` | the scene from above; the pixels of a frame: reprojection, filters, tone mapping |
//! | `screenshot` | saves the film, and a view file that renders it again |
//! | `overlay` | the text over the picture |
//! | `render_loop` | the thread that renders frames |
//! | `session` | starts the render loop for a front end |
//! | `canvas`, `window_text`, `cell_buffer` | draw a frame at another size; with its text as pixels; as character cells |
//! | `terminal`, `window` | the front ends |

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod accumulation;
mod camera_controller;
mod canvas;
mod cell_buffer;
mod controls;
mod display_mode;
mod dynamic_resolution;
mod file_watcher;
pub mod frame;
pub mod keys;
mod loader;
mod minimap;
mod options;
mod overlay;
mod painter;
pub mod playlist;
mod render_loop;
mod screenshot;
mod session;
pub mod state;
mod terminal;
mod timing;
#[cfg(feature = "window")]
mod window;
#[cfg(feature = "window")]
mod window_text;

pub use options::{BYTES_PER_PIXEL, Options, Wake};
pub use session::Viewer;
pub use terminal::terminal;
pub use timing::Summary;
#[cfg(feature = "window")]
pub use window::{WindowError, window};
