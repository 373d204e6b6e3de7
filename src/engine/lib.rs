//! octray's engine: a wavefront path tracer for CPUs. It turns a [`scene::Scene`] into a [`film::Film`].
//!
//! Packets of 8 or 16 rays run over structure-of-arrays buffers, tile by tile. A scalar path beside it gives
//! the same bits.
//!
//! # From scene to film
//! A scene passes through these forms.
//!
//! | form | what it is | modules |
//! |---|---|---|
//! | [`scene::Scene`] | a valid scene: its existence is the proof of validity | [`scene`] |
//! | [`buffers::Buffers`], [`rays::Structure`] | structure-of-arrays buffers; a list or a hierarchy | [`buffers`], [`rays`] |
//! | [`buffers::Features`] | the features that the scene uses | [`buffers`] |
//! | packets and queues | 8 or 16 rays and a mask; the paths of one or several tiles, as columns | [`math`], [`integrate`] |
//! | [`film::Film`] | sums of linear radiance, in a fixed order | [`film`], [`render`] |
//!
//! The integrator runs in stages over the paths of a tile: generate camera rays → intersect → shade → trace
//! shadow rays, once per scattering event. Each stage processes all paths before the next begins, and
//! compresses them to those that are alive. After two events the paths of several tiles continue together.
//! The stages compute with [`kernel`]s: equations over lanes.
//!
//! Builds should target their processor: see the front page of [`rays`].
//!
//! # Modules
//! Each module imports only from those above it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`rays`] | the package `octray-rays`: closest hit and any hit of rays, over lanes; its modules [`lane`] and [`math`] have short paths here |
//! | [`mod@choice`] | named alternatives, shared by the command line, view files and reports |
//! | [`sampling`] | sample values as functions of (seed, pixel, sample, dimension); warps |
//! | [`kernel`] | BSDFs, texture lookups |
//! | [`scene`] | the scene model: camera, materials, textures, primitives |
//! | [`path_vertex`] | the vertices of one path as data |
//! | [`buffers`] | materials, textures and sky in flat buffers, and the features that a scene uses |
//! | [`primitives`] | the kinds of primitives in shading, one file each: tables, surfaces, light |
//! | [`lights`] | the lights that are sampled, and the choice among them |
//! | [`camera`] | the map from raster space to primary rays |
//! | [`integrate`] | the path estimator, as stages over queues |
//! | [`threads`] | worker threads, each with its own working memory |
//! | [`film`], [`adaptive`] | sums of samples; the criterion by which a block of pixels has enough of them |
//! | [`render`] | the renderer: samples a scene into a film, by tiles and threads |
//! | [`tone`] | tone mapping |
//! | [`openings`] | openings of rooms, for portals |
//! | [`diagnosis`] | reasons why a picture is black or lacks light |
//!
//! # Laws
//! - **One image.** A pixel is a function of (scene, settings, pixel, sample): the same bits for scalar and
//!   SIMD, for any number of threads, any tile size, whole or in shards. Ties in t go to the lower primitive
//!   index; sums have a fixed order; no operation is approximate at one width only.
//! - **Width is a type.** An equation is written once over [`lane::Lane`] and runs at widths 1, 8 and 16.
//!   Algorithms that differ by width (traversal of one ray, of a packet) are written twice, side by side.
//! - **Features.** Shading stages are compiled for sets of features; a scene runs the smallest set that holds
//!   its own. The general pipeline gives the same bits.
//! - **Conservative culling.** Code that skips tests gives the same hits as testing every primitive.
//! - **Kernels are pure.** A kernel maps values to (mask, values): it allocates nothing, looks nothing up and
//!   never panics.
//! - **Safe.** Only `lane` of [`rays`] has `unsafe` blocks, for a few instructions.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod adaptive;
pub mod buffers;
pub mod camera;
pub mod choice;
pub mod diagnosis;
pub mod film;
pub mod integrate;
pub mod kernel;
pub mod lights;
pub mod openings;
pub mod path_vertex;
pub mod primitives;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod threads;
pub mod tone;

pub use octray_rays::{self as rays, lane, math};
