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
//! # Packages
//! This crate is the program; it re-exports the modules of five packages. Each package imports only those
//! above it.
//!
//! | package | modules |
//! |---|---|
//! | [`rays`] (`octray-rays`) | the tracing core: closest hit and any hit of rays |
//! | [`octray_engine`] | from a scene to a film: see its front page for the architecture |
//! | [`octray_formats`] | [`scene`] files, [`output`] files, [`mod@checkpoint`] files, [`wording`] |
//! | `octray_viewer` | `viewer` (feature `viewer`) |
//! | [`octray_laboratory`] | [`mod@reference`], [`measure`], [`methods`] |
//! | `octray` | [`machine`], [`report`], [`cli`] |
//!
//! # From a scene file to a picture file
//! Each form is built from the one above it.
//!
//! | form | what it is | module |
//! |---|---|---|
//! | scene file | what the user wrote | [`scene`] |
//! | [`scene::Scene`] | the validated scene | [`scene`] |
//! | [`buffers::Buffers`] and its features | structure-of-arrays buffers, and what the scene uses | [`buffers`] |
//! | packets and queues | 8 or 16 rays and a mask; the paths of a tile in structure-of-arrays form | [`math`], [`integrate`] |
//! | [`film::Film`] | sums of linear radiance, in a fixed order | [`film`], [`render`] |
//! | picture file | the displayed or linear picture | [`output`] |
//!
//! # Modules, each importing only those above it
//! | module | what it holds |
//! |---|---|
//! | [`lane`] | width as a type: `f32`, `F32x8` and `F32x16` behind one trait, with the elementary functions |
//! | [`math`] | vectors, rays and hits of lanes; rounding error bounds |
//! | [`mod@choice`] | named alternatives that the command line, view files and reports share |
//! | [`wording`] | numbers and nouns in text |
//! | [`sampling`] | random numbers and Sobol points as functions of (seed, pixel, sample, dimension); warps |
//! | [`kernel`] | intersection, scattering, texture lookup: several methods side by side |
//! | [`scene`] | scene, view, model and texture files; the validated scene |
//! | [`path_vertex`] | the vertices of one path as data |
//! | [`buffers`] | the scene as flat buffers, and its features |
//! | [`bvh`] | the bounding volume hierarchy: build and check |
//! | [`camera`] | from pixels to primary rays |
//! | [`traverse`] | closest-hit and any-hit queries |
//! | [`integrate`] | the wavefront path integrator: stages over queues |
//! | [`mod@reference`] | the reference: f64, one ray and one object at a time, without kernels |
//! | [`threads`] | worker threads with working memory of their own |
//! | [`film`], [`adaptive`] | sums of samples; adaptive sampling by blocks |
//! | [`render`], [`tone`], [`output`] | tiles on threads; tone mapping; picture files |
//! | [`mod@checkpoint`] | the sums of a film as a file: to resume, and to join shards |
//! | [`display`] | filters between film and window: antialiasing, denoising, temporal reprojection |
//! | [`methods`] | intersection methods that are charted and never render |
//! | [`measure`] | measurements: speed, SIMD against scalar, accuracy, stability |
//! | [`machine`] | the machine and build of a figure |
//! | [`report`] | figures as text, JSON, CSV, SVG and HTML |
//! | `viewer` | the front ends: terminal (feature `viewer`), window (feature `window`) |
//! | [`cli`] | commands, their options and help |
//!
//! `tests/laws/architecture/mod.rs` checks this order.
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
//! - **Safe.** The dependencies `wide` and `bytemuck` contain what is needed, but for a few instructions:
//!   their `unsafe` blocks are a module of their own.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub use octray_engine::{
    adaptive, buffers, bvh, camera, choice, diagnosis, display, film, integrate, kernel, lane, math,
    path_vertex, rays, render, sampling, threads, tone, traverse,
};
pub use octray_formats::{checkpoint, output, scene, wording};
pub use octray_laboratory::{measure, methods, reference};
#[cfg(feature = "viewer")]
pub use octray_viewer as viewer;

pub mod cli;
pub mod machine;
pub mod report;
