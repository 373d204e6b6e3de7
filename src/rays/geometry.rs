//! The primitives that rays can hit: spheres and triangles.
//!
//! Primitives are numbered spheres first, then triangles.

use crate::coordinates::Coordinates;
use crate::kernel::ray_box::{Padding, sphere_bounds};
use crate::kernel::surface::{
    sphere_offset, sphere_surface, triangle_bounds, triangle_normal, triangle_offset,
};
use crate::math::Vec3;
use glam::DVec3;

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: glam::Vec3,
    /// Above 0.
    pub radius: f32,
}

/// The primitives of a scene.
///
/// Units: lengths in units of the [`Coordinates`]. Domain: radii above 0, triangles with an area, absolute
/// coordinates up to [`crate::coordinates::MAX_COORDINATE`].
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Where the coordinates of the primitives are in the world.
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
    /// Returns the number of primitives.
    pub fn len(&self) -> usize {
        self.spheres.len() + self.triangles.len()
    }
    /// Returns whether there is no primitive.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Returns a primitive by its number.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn shape(&self, number: usize) -> Shape {
        match self.spheres.get(number) {
            Some(&sphere) => Shape::Sphere(sphere),
            None => Shape::Triangle(self.triangles[number - self.spheres.len()]),
        }
    }
    /// Iterates over all primitives in the order of their numbers.
    pub fn shapes(&self) -> impl Iterator<Item = Shape> {
        let spheres = self.spheres.iter().copied().map(Shape::Sphere);
        spheres.chain(self.triangles.iter().copied().map(Shape::Triangle))
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
    /// Returns the [`Padding`] of boxes, from the extent of all primitives.
    pub fn padding(&self) -> Padding {
        let reach = |shape: Shape| {
            let [lo, hi] = shape.bounds();
            lo.abs().max(hi.abs()).max_element()
        };
        let padding = Padding::new(self.shapes().map(reach).fold(0.0, f32::max));
        if self.spheres.is_empty() { padding } else { padding.with_spheres() }
    }
}

impl Shape {
    /// Returns the lower and upper corner of a box that holds the primitive and all computed hit points: see
    /// [`sphere_bounds`] and [`triangle_bounds`].
    pub fn bounds(self) -> [glam::Vec3; 2] {
        match self {
            Self::Sphere(Sphere { center, radius }) => sphere_bounds(center, radius),
            Self::Triangle(vertices) => triangle_bounds(vertices),
        }
    }
    /// Returns how far off the surface rays start that leave it: see [`sphere_offset`] and
    /// [`triangle_offset`].
    pub fn offset(self) -> f32 {
        match self {
            Self::Sphere(Sphere { center, radius }) => sphere_offset(center, radius),
            Self::Triangle(vertices) => triangle_offset(vertices),
        }
    }
    /// Returns the point of the surface at a hit near `near` or, on a triangle, with the weights `u` and `v`;
    /// the geometric unit normal there, and the offset of rays that leave it.
    pub fn surface(self, near: Vec3<f32>, [u, v]: [f32; 2]) -> (Vec3<f32>, Vec3<f32>, f32) {
        match self {
            Self::Sphere(Sphere { center, radius }) => {
                let (point, ng) = sphere_surface::<f32>(near, Vec3::splat(center), 1.0 / radius, true);
                (point, ng, self.offset())
            }
            Self::Triangle([a, b, c]) => {
                let [first, ab, ac] = [a, b - a, c - a].map(Vec3::splat);
                let ng = Vec3::splat(triangle_normal([a, b, c]));
                (ab.mul_add(u, ac.mul_add(v, first)), ng, self.offset())
            }
        }
    }
    /// Iterates over centre and radius of balls in whose convex hull the primitive lies.
    pub fn balls(self) -> impl Iterator<Item = (DVec3, f64)> + Clone {
        let (points, count, radius) = match self {
            Self::Sphere(Sphere { center, radius }) => ([center; 3], 1, radius),
            Self::Triangle(vertices) => (vertices, 3, 0.0),
        };
        points.into_iter().take(count).map(move |point| (point.as_dvec3(), f64::from(radius)))
    }
    /// Returns the lower and upper corner of the box around the balls.
    pub fn extent(self) -> [DVec3; 2] {
        let boxes = self.balls().map(|(center, radius)| [center - radius, center + radius]);
        boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default()
    }
    /// Returns the distance of a point from a sphere's surface or from a triangle's plane.
    pub fn distance(self, point: DVec3) -> f64 {
        match self {
            Self::Sphere(Sphere { center, radius }) => {
                (point.distance(center.into()) - f64::from(radius)).abs()
            }
            Self::Triangle(vertices) => {
                let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
                (point - a).dot((b - a).cross(c - a).normalize()).abs()
            }
        }
    }
}
