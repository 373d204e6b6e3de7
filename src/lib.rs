//! octray: a data-oriented path tracer for CPUs. Packets of eight rays over structure-of-arrays buffers, tile by tile, beside a scalar
//! path that gives the same bits.
//!
//! Three sentences of its owner rule every choice: *both speed and accuracy count: chart one against the other; test stability where
//! methods fail; model no more than a scene needs.*
//!
//! # One way through the house
//! A scene file becomes a picture by passing through six forms. Each is built from the last; none reaches back.
//!
//! | form | what it is | room |
//! |---|---|---|
//! | scene file | what the user wrote | [`scene`] |
//! | [`scene::Scene`] | what we accept; its existence is the proof of validity | [`scene`] |
//! | [`buffers::Buffers`], [`buffers::Features`] | flattened into aligned structure-of-arrays buffers, and the features the scene uses | [`buffers`] |
//! | packets and queues | eight rays and a mask; a tile's paths in structure-of-arrays form | [`math`], [`integrate`] |
//! | [`film::Film`] | sums of linear radiance, in a fixed order | [`film`], [`render`] |
//! | picture file | what people see | [`output`] |
//!
//! Between packets and film stand the [`kernel`]s: equations that know lanes and nothing else.
//!
//! ```
//! use octray::render::{Renderer, Settings};
//!
//! let scene = octray::scene::load("builtin:three")?;
//! let renderer = Renderer::new(&scene, Settings { resolution: [24, 16], ..Settings::of(&scene) });
//! let mut film = renderer.film();
//! renderer.add_samples(&mut film, 4);
//! assert_eq!(film.picture().pixels.len(), 24 * 16);
//! # Ok::<(), octray::scene::SceneError>(())
//! ```
//!
//! # The rooms, each importing only from above
//! | module | idea |
//! |---|---|
//! | [`lane`] | width as a type: `f32` and `F32x8` behind one trait; the elementary functions, once |
//! | [`math`] | vectors, rays and hits of lanes; rounding error as code |
//! | [`wording`] | numbers and nouns as people read them |
//! | [`sampling`] | random numbers that are a function of (seed, pixel, sample, dimension), independent or well spread; warps |
//! | [`kernel`] | intersection, scattering, texture lookup: several methods side by side |
//! | [`scene`] | files, validation, what a scene is |
//! | [`buffers`] | the scene flattened; what it needs |
//! | [`bvh`] | the hierarchy of boxes over the scene, built and checked |
//! | [`camera`] | pixels to primary rays |
//! | [`traverse`] | which primitive a ray meets first |
//! | [`integrate`] | the path estimator, as stages over queues |
//! | [`mod@reference`] | the independent judge: f64, one ray, one object at a time; it imports only `scene` and the integer hash |
//! | [`threads`] | worker threads, each with working memory of its own |
//! | [`film`], [`adaptive`] | sums; when a block of pixels has had samples enough |
//! | [`render`], [`output`] | tiles and threads; tone mapping and encoders |
//! | [`display`] | from film to window while the camera moves: smoothing edges, removing noise, keeping what was seen before |
//! | [`measure`] | figures: speed, parity, where methods fail, the machine they come from |
//! | [`report`] | figures as people read them: drawn, tabled, on a page |
//! | `viewer` | a window, or a terminal, to walk through a scene in (feature `viewer`) |
//! | [`cli`] | raw arguments, validated options, commands |
//!
//! `tests/architecture.rs` recovers this order from the source and fails when an arrow turns.
//!
//! # The laws
//! - **One picture.** A pixel is a function of (scene, settings, pixel, sample): the same bits for scalar and SIMD, any threads, any tile
//!   size, whole or in parts. Ties in t go to the lower primitive; sums have a fixed order; nothing is approximate on one width only.
//! - **Width is a type.** An equation is written once over [`lane::Lane`] and run at width 1 and 8.
//! - **The judge is independent.** It shares no equation with what it judges.
//! - **Features.** The shading stages are compiled for sets of features; a scene gets the smallest set that holds its own.
//! - **Conservative culling.** Whatever skips a test gives the same hit as testing everything.
//! - **Safe.** No `unsafe` at all: `wide` and `bytemuck` have it where it belongs.

#![forbid(unsafe_code)]

pub use octray_engine::{
    adaptive, buffers, bvh, camera, choice, display, film, integrate, kernel, lane, math, render, sampling, threads,
    tone, traverse,
};
pub use octray_formats::{output, scene, wording};
pub use octray_laboratory::{measure, reference};

pub mod cli;
pub mod machine;
pub mod report;
#[cfg(feature = "viewer")]
pub mod viewer;
