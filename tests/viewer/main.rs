//! The viewer: without a window, in a terminal, and in a window on a display of the test's own.
#![cfg(feature = "viewer")]

#[path = "../common/folder.rs"]
mod folder;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/seat.rs"]
mod seat;
#[path = "../common/skipped.rs"]
mod skipped;
#[path = "../common/waiting.rs"]
mod waiting;

mod events;
#[cfg_attr(not(unix), allow(dead_code))]
mod pictures;
#[cfg(unix)]
mod terminal;
#[cfg(all(unix, feature = "window"))]
mod window;
