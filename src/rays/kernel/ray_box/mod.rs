//! Rays against axis-aligned boxes.
//!
//! A hierarchy must lose no hit. Two rules together ensure it:
//!
//! - A box is padded for the ray, by more than rounding can move a hit out of it ([`BoxRay::new`],
//!   [`Padding`]).
//! - A triangle is hit only where the ray also passes the triangle's own box, by the same formula, and its t
//!   is clamped to the box's interval ([`own_box`]): on slivers the computed t may be far off. The formula is
//!   monotone in the planes, so nested boxes have exactly nested intervals, and a hit in a box is in every
//!   box around it.
//!
//! Source: the slab test of Kay, Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986, with one FMA per plane;
//! padding instead of the widened interval of Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.

mod box_ray;
mod padding;

pub use box_ray::{BoxRay, in_order, own_box};
pub use padding::{Padding, sphere_bounds, sphere_padding};
