//! The tracing core of octray: finds which primitive a ray hits first, and whether it hits any.
//!
//! **[`query`] answers questions about meshes**: it takes vertices and faces in f32 or f64, and has exact
//! answers. The parts that follow are those that a renderer uses.
//!
//! A [`Structure`] is built once from a [`Geometry`] and shared by all threads. Each thread has a [`Tracer`],
//! which owns the working memory and runs two queries on columns of rays: [`Tracer::closest`] and
//! [`Tracer::occluded`]. [`Rays::until`] ends rays, and [`Rays::beyond`] begins them behind a hit. This
//! package knows only the geometry of primitives.
//!
//! ```
//! use octray_rays::{Geometry, Hits, MISS, Rays, Sphere, Structure, Tracer};
//!
//! let sphere = Sphere { center: glam::Vec3::new(0.0, 0.0, -5.0), radius: 1.0 };
//! let structure = Structure::new(&Geometry { spheres: vec![sphere], ..Geometry::default() });
//! // Two rays from the origin: one along −z and one along +y.
//! let (zero, direction) = ([0.0; 2], [[0.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]);
//! let rays = Rays::new([&zero; 3], direction.each_ref().map(|column| &column[..]));
//! let (mut t, mut primitive, mut u, mut v) = ([f32::INFINITY; 2], [MISS; 2], [0.0; 2], [0.0; 2]);
//! let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
//! Tracer::new().closest(&structure, &rays, &mut hits);
//! assert_eq!((t[0], primitive), (4.0, [0, MISS]));
//! ```
//!
//! # Compile for the processor
//! A package is compiled for its target's least processor, on x86-64 for SSE2, and this one then runs at half
//! the speed or less. Put `rustflags = ["-C", "target-cpu=native"]` under `[build]` into `.cargo/config.toml`
//! of your package; [`lane::INSTRUCTIONS`] names the vector instructions of a build.
//!
//! # Modules
//! Each module imports only from those above it. What is not linked is no part of the public interface.
//!
//! | module | what it holds |
//! |---|---|
//! | [`lane`] | width as a type: `f32`, `F32x8`, `F32x16` behind one trait; elementary functions |
//! | [`math`] | vectors, rays, hits and view frusta; bounds of rounding error |
//! | [`coordinates`] | the transform between world coordinates and those of a structure |
//! | [`kernel`] | intersection of rays with boxes, spheres and triangles; points on surfaces |
//! | `exact` | rays against triangles in doubles, decided as in real arithmetic |
//! | `prepared` | rays prepared for tests: the values computed once per ray or packet |
//! | `numbering` | the kinds of primitives, how primitives are numbered, and sets of them |
//! | `columns` | rays and hits as columns |
//! | `kind` | a module for each kind: geometry, tests in leaves and lists; all primitives of a scene |
//! | `bvh` | the bounding volume hierarchy: its builder and its check |
//! | `traverse` | closest hit and any hit, by a list or through the hierarchy |
//! | [`query`] | triangle meshes and spheres in doubles, and queries on all threads |
//!
//! # Laws
//! - **Every traversal gives the same hit**, bit for bit, as testing every primitive in the order of its
//!   [`Kind`]. The nearest t wins, and the lower index on a tie.
//! - **Width is a type.** An equation is written once over [`lane::Lane`] and runs at widths 1, 8 and 16.
//! - **Culling is conservative.** A test is skipped only where it would find no hit that counts.
//! - **Kernels are pure.** A kernel maps values to (mask, values): it allocates nothing and never panics.
//! - **Safe.** Only [`lane`] has `unsafe` blocks, for a few instructions.

#![deny(unsafe_code)]
#![warn(missing_docs)]

pub mod coordinates;
pub mod kernel;
pub mod lane;
pub mod math;
pub mod query;

// These modules are public only so that tests reach them.
#[doc(hidden)]
pub mod bvh;
#[doc(hidden)]
pub mod columns;
#[doc(hidden)]
pub mod exact;
#[doc(hidden)]
pub mod kind;
#[doc(hidden)]
pub mod numbering;
#[doc(hidden)]
pub mod prepared;
#[doc(hidden)]
pub mod traverse;

pub use bvh::check::Statistics;
pub use columns::{Hits, Rays};
pub use coordinates::Coordinates;
pub use kind::geometry::*;
pub use kind::keep_if_nearer;
pub use math::MISS;
pub use numbering::{Candidates, Kind, KindCounts, KindRanges};
pub use traverse::counter::{Counts, Tests};
pub use traverse::{MAX_LIST_COST, PrimitiveTests, Structure, Tracer, Traversal};
