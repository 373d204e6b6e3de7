//! The formats: from scene files to a [`scene::Scene`], and from a picture to picture files.

#![forbid(unsafe_code)]

use octray_engine::{film, tone};

pub mod openexr;
pub mod output;
pub mod scene;
pub mod wording;
