//! Tests of the program: its reports, its files, and what it refuses. It never panics and never leaves half a
//! file.

#[path = "../common/folder.rs"]
mod folder;
#[path = "../common/openexr.rs"]
mod openexr;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/skipped.rs"]
mod skipped;
#[path = "../common/waiting.rs"]
mod waiting;

mod chart;
#[cfg(unix)]
mod checkpoints;
mod convert;
mod denoise;
mod desk;
mod figures;
mod frames;
#[cfg(unix)]
mod interrupt;
mod limits;
mod one_path;
mod ratios;
mod rays;
mod render;
mod report_page;
mod scenes;
mod settings;
mod shards;
mod stability;
mod stats;
mod streams;
mod usage;
#[cfg(feature = "viewer")]
mod view;
mod views;
