//! The laboratory of octray: the f64 reference renderer, and the measurements of the engine's speed, accuracy
//! and numerical robustness.
//!
//! It may import the engine and the display filters. It must not know scene files, picture files, the command
//! line, windows or reports. The program and the tests call it. Every measurement returns plain values that
//! serialise to JSON.
//!
//! # Modules
//! A module imports only from modules above it in this table; no two files import each other.
//!
//! | module | what it holds |
//! |---|---|
//! | [`mod@methods`] | intersection methods that are charted beside the engine's own |
//! | [`mod@reference`] | path tracing in f64, one ray and one primitive at a time; shares no equation with the engine |
//! | [`mod@measure`] | the measurements: |
//! | [`measure::quantiles`] | medians, quantiles and spreads of a measurement's rounds |
//! | `measure::errors`, [`measure::flip`] | image metrics: RMSE, relative MSE, FLIP |
//! | [`measure::cores`] | pinned threads, and the share of their time that other programs took |
//! | [`measure::timed`] | renderers timed in alternating rounds, ratios of their speeds |
//! | [`measure::ray_sets`], [`measure::trace`] | prepared rays; the traversals that trace them, on one thread or many |
//! | [`measure::stats`] | time by stage, rays by kind, tests per ray |
//! | [`measure::bench`], [`measure::rays`], [`measure::compare`] | `octray bench`, `octray rays`, `octray compare` |
//! | [`measure::kernel_set`] | intersection kernels alone: fixed rays against fixed primitives |
//! | [`measure::stability`] | `octray stability`: inputs on which methods fail, and how often each fails |
//! | [`measure::chart`] | `octray chart`: error against time |
//!
//! # Rules
//! - The reference is independent: from the engine it imports only the scene's types, the sample values and
//!   the form of a path's vertices. The engine therefore cannot share its mistakes.
//! - Candidates compared by speed are timed in alternating rounds, so that a slow spell of the machine
//!   affects all alike.
//! - A speed is a median with a spread. A speed and its error come from the same run.
//! - Random inputs are a function of fixed seeds: a failure can be repeated.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

// The engine's modules and the display filters under the paths that they have in the program: `crate::film`,
// `crate::scene`.
use octray_display as display;
use octray_engine::{
    adaptive, buffers, camera, film, integrate, kernel, lane, lights, math, path_vertex, primitives, rays,
    render, sampling, scene, threads, tone,
};

pub mod measure;
pub mod methods;
pub mod reference;
