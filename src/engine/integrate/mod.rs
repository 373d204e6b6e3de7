//! The integrator: a wavefront path tracer.
//!
//! A tile's paths are in a queue in structure-of-arrays form ([`queue`]). Each stage runs over all of them
//! before the next one starts:
//!
//! ```text
//! generate → ( intersect → shade → shadow rays )* → intersect → shade last
//! ```
//!
//! - [`fn@generate`] creates primary rays and finds their hits. Those of a pinhole have one origin, which the
//!   queue does not hold; those of a lens and of an orthographic camera are traced like any other rays.
//! - `intersect` finds the hits of rays of later segments. Under a sky, paths that miss end here.
//! - If some surface is not opaque, rays that pass their hits go on to the next ones (`opacity`).
//! - Hits next to edges of triangles are corrected (`silhouettes`).
//! - `shade` adds emitted radiance, samples the BSDF, and compresses the paths that continue, so that packets
//!   stay full. If lights are sampled, it queues shadow rays. If each hit has at most one texel, all texels
//!   are read first.
//! - `shadow_rays` adds the radiance of the shadow rays that are not occluded.
//! - `shade_last` shades last segments: emitted radiance, no scattering.
//!
//! After two events a tile has few paths left: one or two packets, half empty. The paths of several tiles
//! therefore wait for each other in the queue at this point and continue together ([`fn@trace_tiles`]).
//!
//! # The estimator
//! Unidirectional path tracing: a path's radiance is the sum, over its segments, of the radiance emitted by
//! the environment or the surface at the segment's end, times the throughput so far. Directions are sampled
//! from each material's lobe; random numbers are [`crate::sampling::Sampler`]'s. A path has up to
//! `max_bounces` scattering events. Selected emitters are also sampled by next event estimation, combined by
//! multiple importance sampling.

pub mod aovs;
mod bsdf;
mod context;
pub mod cost;
pub mod edge_aovs;
mod emission;
mod evaluation;
mod generate;
mod glass;
mod intersect;
mod material;
pub mod meter;
mod opacity;
mod path;
mod pipeline;
pub mod queue;
mod radiance;
mod scratch;
mod shade;
mod shadow_rays;
mod silhouettes;
pub mod stats;
mod tile_pixels;

pub use context::TraceContext;
pub use generate::generate;
pub use path::trace_path;
pub use pipeline::{Pipeline, RENORMALIZATION_INTERVAL, pipeline_for, trace_tiles};
pub use radiance::MAX_TILES;
pub use scratch::Scratch;
