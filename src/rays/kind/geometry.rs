//! The primitives that rays can hit: spheres and triangles.
//!
//! Primitives are numbered spheres first, then triangles.

pub use super::sphere::Sphere;

use super::{Kind, KindCounts, triangle};
use crate::coordinates::Coordinates;
use crate::kernel::ray_box::Padding;
use crate::kernel::surface::{triangle_bounds, triangle_offset};
use crate::math::{Vec3, ViewFrustum};
use crate::numbering::Candidates;
use glam::DVec3;

/// The primitives of a scene.
///
/// Units: lengths in units of the [`Coordinates`]. Domain: radii above 0, triangles with an area, absolute
/// coordinates up to [`crate::coordinates::MAX_COORDINATE`].
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// The place of the primitives' coordinates in the world.
    pub coordinates: Coordinates,
    /// All spheres.
    pub spheres: Vec<Sphere>,
    /// The vertices of all triangles.
    pub triangles: Vec<[glam::Vec3; 3]>,
}

/// A primitive of a [`Geometry`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// The vertices of a triangle.
    Triangle([glam::Vec3; 3]),
}

impl Geometry {
    /// Returns the numbers of primitives by kind.
    pub fn counts(&self) -> KindCounts {
        KindCounts([self.spheres.len(), self.triangles.len()])
    }
    /// Returns the number of primitives.
    pub fn len(&self) -> usize {
        self.counts().total()
    }
    /// Tests whether there are no primitives.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns a primitive by its number.
    ///
    /// # Panics
    /// If `number` is not below [`Geometry::len`].
    pub fn shape(&self, number: usize) -> Shape {
        self.shape_at(self.counts().place(number))
    }
    fn shape_at(&self, (kind, index): (Kind, usize)) -> Shape {
        match kind {
            Kind::Sphere => Shape::Sphere(self.spheres[index]),
            Kind::Triangle => Shape::Triangle(self.triangles[index]),
        }
    }
    /// Iterates over all primitives in the order of their numbers.
    pub fn shapes(&self) -> impl Iterator<Item = Shape> {
        self.counts().places().map(|place| self.shape_at(place))
    }
    /// Returns the geometry of the primitives for which `keep(number, shape)` is true.
    pub fn only(&self, keep: impl Fn(usize, Shape) -> bool) -> Self {
        let mut kept = Self { coordinates: self.coordinates, ..Self::default() };
        for (_, shape) in self.shapes().enumerate().filter(|&(number, shape)| keep(number, shape)) {
            match shape {
                Shape::Sphere(sphere) => kept.spheres.push(sphere),
                Shape::Triangle(vertices) => kept.triangles.push(vertices),
            }
        }
        kept
    }
    /// Replaces candidates by the primitives for which `keep(number, shape)` is true.
    pub fn find_candidates(&self, candidates: &mut Candidates, keep: impl Fn(usize, Shape) -> bool) {
        candidates.clear();
        let kept = self.shapes().enumerate().filter(|&(number, shape)| keep(number, shape));
        kept.for_each(|(number, _)| candidates.push(self.counts(), number));
    }
    /// Replaces candidates by the primitives that are not outside of a frustum.
    pub fn find_in_frustum(&self, candidates: &mut Candidates, frustum: &ViewFrustum) {
        self.find_candidates(candidates, |_, shape| !frustum.excludes(shape.balls()));
    }
    /// Returns the [`Padding`] of boxes, from the extent of all primitives.
    pub fn padding(&self) -> Padding {
        let reach = |shape: Shape| {
            let [lo, hi] = shape.bounds();
            lo.abs().max(hi.abs()).max_element()
        };
        let padding = Padding::new(self.shapes().map(reach).fold(0.0, f32::max));
        // The error of a sphere's hits grows with the distance of the ray's origin.
        let grows = |(kind, count)| match kind {
            Kind::Sphere => count > 0,
            Kind::Triangle => false,
        };
        match Kind::ALL.into_iter().zip(self.counts().0).any(grows) {
            true => padding.with_spheres(),
            false => padding,
        }
    }
}

impl Shape {
    /// Returns the lower and upper corner of a box that holds the primitive and all computed hit points.
    pub fn bounds(self) -> [glam::Vec3; 2] {
        match self {
            Self::Sphere(sphere) => sphere.bounds(),
            Self::Triangle(vertices) => triangle_bounds(vertices),
        }
    }
    /// Returns the offset along the normal of rays that leave the surface.
    pub fn offset(self) -> f32 {
        match self {
            Self::Sphere(sphere) => sphere.offset(),
            Self::Triangle(vertices) => triangle_offset(vertices),
        }
    }
    /// Returns the point of the surface at a hit near `near` or, on a triangle, with the weights `u` and `v`;
    /// the geometric unit normal there, and the offset of rays that leave it.
    pub fn surface(self, near: Vec3<f32>, weights: [f32; 2]) -> (Vec3<f32>, Vec3<f32>, f32) {
        let (point, ng) = match self {
            Self::Sphere(sphere) => sphere.surface(near),
            Self::Triangle(vertices) => triangle::surface(vertices, weights),
        };
        (point, ng, self.offset())
    }
    /// Returns a point of a flat shape, and the unit normal of its plane.
    pub fn plane(self) -> Option<(DVec3, DVec3)> {
        match self {
            Self::Sphere(_) => None,
            Self::Triangle(vertices) => Some(triangle::plane(vertices)),
        }
    }
    /// Iterates over the centres and radii of balls whose convex hull contains the primitive.
    pub fn balls(self) -> impl Iterator<Item = (DVec3, f64)> + Clone {
        let (points, count, radius) = match self {
            Self::Sphere(Sphere { center, radius }) => ([center; 3], 1, radius),
            Self::Triangle(vertices) => (vertices, 3, 0.0),
        };
        points.into_iter().take(count).map(move |point| (point.as_dvec3(), f64::from(radius)))
    }
    /// Returns the lower and upper corner of the box around these balls.
    pub fn extent(self) -> [DVec3; 2] {
        let boxes = self.balls().map(|(center, radius)| [center - radius, center + radius]);
        boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default()
    }
    /// Returns the distance of a point from a sphere's surface or from a triangle's plane.
    pub fn distance(self, point: DVec3) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.distance(point),
            Self::Triangle(vertices) => triangle::distance(vertices, point),
        }
    }
}
