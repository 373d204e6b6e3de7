//! octray: a data-oriented path tracer for CPUs. It traces packets of 8 or 16 rays over structure-of-arrays
//! buffers, tile by tile, and has a scalar path that gives the same bits.
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
//! # Packages, and the data flow of a frame
//! This crate is the program; it re-exports the modules of the other packages. Each package imports only
//! those to its left.
//!
//! ```text
//!  octray-rays ────> octray-engine ──┬──> octray-formats ──┬──> octray-viewer ──┬──> octray
//!  lanes, kernels,   scene, buffers, │    scene files,     │    terminal and    │    commands,
//!  kinds, hierarchy, lights, film,   │    models, pictures │    window          │    reports
//!  traversal         render          └──> octray-display ──┴──> octray-laboratory
//!                                         denoiser,             f64 reference,
//!                                         reprojection          measurements
//!
//!  scene file ──> Scene                  formats: read and checked
//!  Scene ──> Buffers, Lights, Structure   engine, rays: flattened; a list or a hierarchy of the primitives
//!
//!  each sample of a tile:
//!    generate ──> intersect ──> shade ──> shadow rays ──> Film
//!                     ^           │
//!                     └─ bounce ──┘
//!
//!  Film ──> picture file                  tone, formats
//!       └─> screen                        display, viewer
//! ```
//!
//! | package | modules |
//! |---|---|
//! | [`octray-rays`](../octray_rays/index.html) | [`rays`]: the tracing core, closest hit and any hit of rays |
//! | [`octray-engine`](../octray_engine/index.html) | from a scene to a film: [`buffers`], [`integrate`], [`film`], [`render`] |
//! | [`octray-display`](../octray_display/index.html) | [`display`]: filters for the screen and the charts |
//! | [`octray-formats`](../octray_formats/index.html) | [`scene`] files, [`output`] files, [`mod@checkpoint`] files, [`wording`] |
//! | [`octray-viewer`](../octray_viewer/index.html) | `viewer` (feature `viewer`) |
//! | [`octray-laboratory`](../octray_laboratory/index.html) | [`mod@reference`], [`measure`], [`methods`] |
//! | `octray` | [`machine`], [`report`], [`cli`] |
//!
//! # Modules of this package
//! Each module imports only those above it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`machine`] | the machine and the build on which a figure was measured |
//! | [`report`] | figures as text, JSON, CSV, SVG and HTML |
//! | [`cli`] | commands, their options and help |
//!
//! # Laws
//! - **One picture.** A pixel is a function of (scene, settings, pixel, sample): the same bits for scalar and
//!   SIMD, for any number of threads, any tile size, whole or in parts; and from every build with fused
//!   multiply-add, and every build without ([`lane::FUSED`]). Ties in t go to the lower primitive index; sums
//!   have a fixed order; no width uses an approximation of its own.
//! - **Width is a type.** A kernel is written once over [`lane::Lane`] and runs at widths 1, 8 and 16.
//! - **The reference is independent.** It shares no code with the kernels that it checks.
//! - **Features.** The shading stages are compiled for sets of features; a scene gets the smallest set that
//!   contains its own.
//! - **Conservative culling.** A culled test never changes a hit.
//! - **Speed and accuracy.** A speed is reported together with its accuracy, and the default methods are
//!   robust.
//! - **Safe.** Vector code comes from the dependencies `wide` and `bytemuck`, except for a few instructions,
//!   whose `unsafe` blocks are in one module of [`lane`].

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub use octray_display as display;
pub use octray_engine::{
    adaptive, buffers, camera, choice, diagnosis, film, integrate, kernel, lane, lights, math, openings,
    path_vertex, primitives, rays, render, sampling, threads, tone,
};
pub use octray_formats::{checkpoint, output, scene, wording};
pub use octray_laboratory::{measure, methods, reference};
#[cfg(feature = "viewer")]
pub use octray_viewer as viewer;

pub mod cli;
pub mod machine;
pub mod report;
