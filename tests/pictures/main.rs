//! Laws of pictures: the expected value of every estimator, the f64 reference, what display does to pictures,
//! and the test cases of `octray stability`.

// The packages under one name, as the program's library shows them; the program itself is not needed.
extern crate self as octray;
pub use octray_display as display;
pub use octray_engine::*;
pub use octray_formats::scene;
pub use octray_laboratory::{measure, methods, reference};

#[path = "../common/mod.rs"]
mod common;

mod adaptive_laws;
mod copies;
mod display_laws;
mod expectation;
mod extras;
mod flip;
mod furnace;
mod history;
mod judged;
mod lamps;
mod levels_of_detail;
mod opacity;
mod peers;
mod punctual;
mod reference_laws;
mod smooth;
mod stability;
mod stats;
mod survey;
mod texture_orientation;
