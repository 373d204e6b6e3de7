//! Triangle meshes and spheres, given in double or single precision, and queries about rays and points.
//!
//! [`Surfaces`] collects meshes and spheres, and [`Surfaces::build`] makes an [`Intersector`] of them, which
//! answers queries about many [`Rays`] at once, on all threads of rayon's pool:
//!
//! | query | answer for each ray or point |
//! |---|---|
//! | [`Intersector::closest`] | the first hit: t, surface, primitive, barycentric weights |
//! | [`Intersector::closest_to`] | the same, written into columns of the caller: all, or some of them |
//! | [`Intersector::occluded`] | whether there is a hit |
//! | [`Intersector::all_hits`] | every hit, in order |
//! | [`Intersector::count`] | how many surfaces the ray crosses |
//! | [`Intersector::contains`] | whether closed surfaces enclose the point |
//!
//! ```
//! use octray_rays::query::{MISS, Precision, Rays, Surfaces};
//!
//! # fn main() -> Result<(), octray_rays::query::Error> {
//! let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let mut surfaces = Surfaces::new();
//! surfaces.add_mesh(&corners, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
//! let tetrahedron = surfaces.build(Precision::Exact)?;
//!
//! // Down onto a face, and past it. Directions have any length, which is the unit of t.
//! let (origins, directions) = ([[0.25, 0.25, 2.0], [2.0, 2.0, 2.0]], [[0.0, 0.0, -0.5]; 2]);
//! let hits = tetrahedron.closest(&Rays::new(&origins, &directions))?;
//! assert_eq!((hits.t[0], hits.primitive[0], hits.primitive[1]), (3.0, 3, MISS));
//! assert_eq!(tetrahedron.contains(&[[0.1, 0.1, 0.1], [0.5, 0.5, 0.5]])?, [true, false]);
//! # Ok(())
//! # }
//! ```
//!
//! # Rules
//! - **Hits** have t_min < t < t_max, by default between 0 and ∞. Both sides of a triangle are hit. Hits are
//!   ordered by t, and at the same t by number: spheres before triangles, then in the order of adding.
//! - **Edges and vertices** belong to each of their triangles, so [`Intersector::all_hits`] reports a hit for
//!   each. [`Intersector::count`] and [`Intersector::contains`] cross them once in [`Precision::Exact`].
//! - **Rays that hit nothing**: with NaN or an infinite number in origin or direction, with a direction of 0,
//!   with a t range that is empty or has a NaN. A negative t_min is 0, and in [`Precision::Exact`] a hit at
//!   t = 0 counts too.
//! - **Triangles that nothing hits**: those with a repeated vertex. Other triangles without an area have no
//!   hits in [`Precision::Exact`], and may have some in [`Precision::Single`]. Rays within the plane of a
//!   triangle miss it. A triangle that is there twice is hit twice.
//! - **Errors** ([`Error`]): vertices that are not finite, and all numbers except 0 whose absolute value is
//!   not between 2⁻¹²⁰ and 2¹²⁰ (8·10⁻³⁷ to 10³⁶); for rays only in [`Precision::Exact`], where components
//!   of directions may be as small as 2⁻¹⁶² (2·10⁻⁴⁹).
//! - Answers do not depend on the number of threads, nor on the rays beside.
//! - **Order** matters for speed only: the rays of an image are fastest row by row, other rays where
//!   neighbours begin and run alike.

mod answer;
mod exact;
mod input;
mod intersector;
mod order;
mod scene_rays;
mod single;
mod surfaces;

pub use crate::math::MISS;
pub use answer::{AllHits, HitColumns, HitsMut};
pub use input::{Numbers, Points, Rays};
pub use intersector::{Intersector, Threads};
pub use surfaces::Surfaces;

use std::fmt;

/// How hits are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// In f32, as [`crate::Tracer`] does: the fastest. Vertices and rays are rounded to f32 relative to the
    /// middle of the surfaces, or to 0 where that is as good. Rays through edges of a mesh do not leak, but
    /// hits near edges may be on the neighbour, and t is off by some 10⁻⁶.
    Single,
    /// Which triangles are hit, and in what order, is that of real arithmetic on the given doubles; t is
    /// within two units in the last place, and the barycentric weights are within 2⁻⁵². Only for triangles.
    Exact,
}

/// An error in surfaces or rays.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A vertex or a centre is not finite, or outside the range of numbers.
    Point {
        /// The surface.
        surface: usize,
        /// The vertex or the sphere.
        index: usize,
        /// The number.
        number: f64,
    },
    /// A radius is not above 0, or outside the range of numbers.
    Radius {
        /// The surface.
        surface: usize,
        /// The sphere.
        index: usize,
        /// The radius.
        number: f64,
    },
    /// A face refers to a vertex that its mesh does not have.
    Face {
        /// The surface.
        surface: usize,
        /// The face.
        index: usize,
        /// The vertex.
        vertex: u32,
    },
    /// Columns or lists that belong together have different lengths.
    Length {
        /// The name of the columns or lists.
        of: &'static str,
        /// The length.
        found: usize,
        /// The length that it must have.
        expected: usize,
    },
    /// There are more vertices, triangles or spheres than numbers for them.
    TooMany,
    /// There is no such surface, or it is of another kind.
    Surface(usize),
    /// [`Precision::Exact`] has no spheres.
    ExactSpheres,
    /// A ray or a point is outside the range of numbers of [`Precision::Exact`].
    Ray {
        /// The ray or the point.
        index: usize,
        /// The number.
        number: f64,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        const RANGE: &str = "use 0, or an absolute value between 8e-37 and 1e36";
        match self {
            Self::Point { surface, index, number } => {
                write!(
                    to,
                    "surface {surface}, vertex or sphere {index}: {number:e} is no coordinate: {RANGE}"
                )
            }
            Self::Radius { surface, index, number } => {
                write!(
                    to,
                    "surface {surface}, sphere {index}: {number:e} is no radius: use one from 8e-37 to 1e36"
                )
            }
            Self::Face { surface, index, vertex } => {
                write!(to, "surface {surface}, face {index}: the mesh has no vertex {vertex}; the first is 0")
            }
            Self::Length { of, found, expected } => write!(to, "{of}: {found} instead of {expected}"),
            Self::TooMany => {
                write!(to, "too many vertices, triangles or spheres: build several intersectors")
            }
            Self::Surface(surface) => write!(to, "surface {surface} does not exist, or has no such parts"),
            Self::ExactSpheres => write!(to, "exact answers are for triangles only: use single precision"),
            Self::Ray { index, number } => {
                write!(
                    to,
                    "ray or point {index}: {number:e} is out of range: {RANGE} (directions: from 2e-49)"
                )
            }
        }
    }
}

impl std::error::Error for Error {}

/// Returns the first number, except 0, whose absolute value is outside a range.
fn outside(numbers: impl IntoIterator<Item = f64>, [least, most]: [f64; 2]) -> Option<f64> {
    numbers.into_iter().find(|number| *number != 0.0 && !(least..=most).contains(&number.abs()))
}
