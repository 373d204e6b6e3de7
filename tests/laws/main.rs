//! Laws of bits and of parts: lanes, kernels, sampling, hierarchies, traversals, lights, lobes; films that
//! are the same from every width, thread, tile and pipeline; and the order of the sources.
//!
//! One module for each law. All run at every width they speak of; seeds are fixed. `.ci/run` also runs them
//! without AVX2 and FMA.

// The packages under one name, as the program's library shows them; the program itself is not needed.
extern crate self as octray;
pub use octray_engine::*;
pub use octray_formats::scene;
pub use octray_laboratory::{measure, methods, reference};

#[path = "../common/mod.rs"]
mod common;

mod architecture;
mod beyond;
mod bvh_laws;
mod cameras;
mod choosing;
mod determinism;
mod frustum_edges;
mod frustum_laws;
mod hierarchy_laws;
mod kernel_box;
mod kernel_ray_cone;
mod kernel_sphere;
mod kernel_sphere_box;
mod kernel_texture;
mod kernel_triangle;
mod lane_functions;
mod lane_parity;
mod light_laws;
mod lobes;
mod long_paths;
mod occluders;
mod one_path;
mod pipelines;
mod portals;
mod random_scenes;
mod rough_glass;
mod sampling_laws;
mod sobol;
mod spawn;
mod stream_lists;
mod traversal_laws;
mod visible;
mod watertight;
