//! Laws of whole films: the same bits from every width, thread and pipeline, the expected value of every estimator, the f64 reference,
//! what display does to pictures, and the recipes of `octray stability`.

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod determinism;
mod display;
mod expectation;
mod flip;
mod furnace;
mod history;
mod judged;
mod pipelines;
mod reference;
mod smooth;
mod stability;
mod stability_shading;
mod stats;
mod survey;
mod texture_orientation;
