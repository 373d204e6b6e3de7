//! Collects meshes and spheres, and gives their primitives numbers.

use super::input::{Numbers, Points};
use super::{Error, Intersector, Precision, outside};
use crate::coordinates::Coordinates;
use crate::exact::DOMAIN;
use crate::kind::geometry::{Geometry, Sphere};
use crate::lane::prefetch;
use crate::numbering::Kind;
use glam::DVec3;
use rayon::prelude::*;

/// The largest number of primitives of a hierarchy.
const MAX_PRIMITIVES: usize = crate::bvh::MAX_PRIMITIVES;
/// The smallest number of triangles that justifies another thread.
const PER_THREAD: usize = 4096;

/// Triangle meshes and groups of spheres: each is a surface, numbered from 0 in the order of adding, and its
/// faces or spheres have numbers of their own from 0.
#[derive(Clone, Debug, Default)]
pub struct Surfaces {
    vertices: Vec<[f64; 3]>,
    /// The faces of all meshes, as indices into `vertices`.
    faces: Vec<[u32; 3]>,
    spheres: Vec<([f64; 3], f64)>,
    parts: Vec<Part>,
    /// For each kind, the first primitive of its surfaces and their numbers.
    starts: [Vec<(usize, u32)>; Kind::ALL.len()],
}

/// A surface.
#[derive(Clone, Copy, Debug)]
struct Part {
    kind: Kind,
    /// The indices of a mesh's vertices.
    vertices: [usize; 2],
}

impl Surfaces {
    /// Creates an empty collection.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a mesh; returns its number. Faces are indices into its vertices. Vertices that are no corner are
    /// ignored, but must be finite too.
    pub fn add_mesh<'a>(
        &mut self,
        vertices: impl Into<Points<'a>>,
        faces: &[[u32; 3]],
    ) -> Result<usize, Error> {
        let (vertices, surface, first) = (vertices.into(), self.parts.len(), self.vertices.len());
        let points = checked(vertices, surface)?;
        let is_beyond = |vertex: &u32| *vertex as usize >= points.len();
        let outside = |face: &[u32; 3]| face.iter().copied().find(is_beyond);
        if let Some((index, vertex)) =
            (0..).zip(faces).find_map(|(index, face)| Some((index, outside(face)?)))
        {
            return Err(Error::Face { surface, index, vertex });
        }
        let count = self.faces.len() + self.spheres.len() + faces.len();
        if count > MAX_PRIMITIVES || u32::try_from(first + points.len()).is_err() {
            return Err(Error::TooMany);
        }
        let range = [first, first + points.len()];
        self.starts[Kind::Triangle as usize].push((self.faces.len(), surface as u32));
        self.parts.push(Part { kind: Kind::Triangle, vertices: range });
        self.vertices.extend(points);
        self.faces.extend(faces.iter().map(|face| face.map(|vertex| vertex + first as u32)));
        Ok(surface)
    }

    /// Adds spheres; returns the number of the group.
    pub fn add_spheres<'a>(
        &mut self,
        centers: impl Into<Points<'a>>,
        radii: impl Into<Numbers<'a>>,
    ) -> Result<usize, Error> {
        let (radii, surface) = (radii.into(), self.parts.len());
        let centers = checked(centers.into(), surface)?;
        radii.check("radii", centers.len())?;
        let radii: Vec<f64> = (0..centers.len()).map(|at| radii.get(at)).collect();
        let is_wrong = |radius: &f64| *radius <= 0.0 || outside([*radius], DOMAIN).is_some();
        if let Some(index) = radii.iter().position(is_wrong) {
            return Err(Error::Radius { surface, index, number: radii[index] });
        }
        if self.faces.len() + self.spheres.len() + radii.len() > MAX_PRIMITIVES {
            return Err(Error::TooMany);
        }
        self.starts[Kind::Sphere as usize].push((self.spheres.len(), surface as u32));
        self.parts.push(Part { kind: Kind::Sphere, vertices: [0; 2] });
        self.spheres.extend(centers.into_iter().zip(radii));
        Ok(surface)
    }

    /// Builds the structure that answers queries.
    pub fn build(self, precision: Precision) -> Result<Intersector, Error> {
        if precision == Precision::Exact && !self.spheres.is_empty() {
            return Err(Error::ExactSpheres);
        }
        Ok(Intersector::new(self, precision))
    }

    pub(super) fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }
    pub(super) fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Replaces the vertices of a mesh by as many others.
    pub(super) fn move_vertices(&mut self, surface: usize, vertices: Points) -> Result<(), Error> {
        let part = self.parts.get(surface).filter(|part| part.kind == Kind::Triangle);
        let [first, end] = part.ok_or(Error::Surface(surface))?.vertices;
        vertices.check("vertices", end - first)?;
        self.vertices[first..end].copy_from_slice(&checked(vertices, surface)?);
        Ok(())
    }

    /// Returns the size of vertices, faces and spheres in bytes.
    pub(super) fn bytes(&self) -> usize {
        let Self { vertices, faces, spheres, parts: _, starts: _ } = self;
        size_of_val(&vertices[..]) + size_of_val(&faces[..]) + size_of_val(&spheres[..])
    }

    /// Returns the corners of a triangle, by its index among all triangles.
    #[inline(always)]
    pub(super) fn corners(&self, index: usize) -> [DVec3; 3] {
        // Not array::map, which may be a call.
        let ([a, b, c], corner) = (self.faces[index], |vertex: u32| self.vertices[vertex as usize].into());
        [corner(a), corner(b), corner(c)]
    }

    /// Fetches the indices of a triangle's vertices into the cache.
    #[inline(always)]
    pub(super) fn prefetch_face(&self, index: u32) {
        prefetch(&self.faces[index as usize]);
    }

    /// Fetches the vertices of a triangle into the cache.
    #[inline(always)]
    pub(super) fn prefetch_vertices(&self, index: u32) {
        self.faces[index as usize].iter().for_each(|&vertex| prefetch(&self.vertices[vertex as usize]));
    }

    /// Tests whether all primitives are triangles of the first surface.
    pub(super) fn is_one_mesh(&self) -> bool {
        matches!(self.parts[..], [Part { kind: Kind::Triangle, .. }])
    }

    /// Returns the surface of a primitive, and its number there, by its number among all.
    #[inline]
    pub(super) fn place(&self, number: u32) -> (u32, u32) {
        let (kind, index) = match (number as usize).checked_sub(self.spheres.len()) {
            Some(index) => (Kind::Triangle, index),
            None => (Kind::Sphere, number as usize),
        };
        let starts = &self.starts[kind as usize];
        if let [(_, surface)] = starts[..] {
            return (surface, index as u32);
        }
        // An empty surface starts where the next one does.
        let (first, surface) = starts[starts.partition_point(|(first, _)| *first <= index) - 1];
        (surface, (index - first) as u32)
    }

    /// Tests whether a primitive, by its number among all, is a sphere.
    pub(super) fn is_sphere(&self, number: u32) -> bool {
        (number as usize) < self.spheres.len()
    }

    /// Returns the lower and upper corner of all surfaces.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let of_face = |face: usize| {
            let [a, b, c] = self.corners(face);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let of_sphere = |&(center, radius): &([f64; 3], f64)| {
            [DVec3::from(center) - radius, DVec3::from(center) + radius]
        };
        let nothing = || [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let union = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2]| [a.min(c), b.max(d)];
        let faces = (0..self.faces.len()).into_par_iter().with_min_len(PER_THREAD);
        self.spheres.iter().map(of_sphere).fold(faces.map(of_face).reduce(nothing, union), union)
    }

    /// Returns the primitives in f32, relative to the middle of their [`Surfaces::bounds`]; in
    /// [`Precision::Single`] relative to 0 if the middle is no further than they are large.
    pub(super) fn geometry(&self, [lo, hi]: [DVec3; 2], precision: Precision) -> Geometry {
        let (middle, size) = (lo * 0.5 + hi * 0.5, (hi - lo).max_element());
        let stays = precision == Precision::Single && middle.abs().max_element() <= size;
        let origin = if stays || !middle.is_finite() { DVec3::ZERO } else { middle };
        let coordinates = Coordinates::around(origin, size);
        let to_scene = |point: DVec3| coordinates.to_scene(point).as_vec3();
        let sphere = |&(center, radius): &([f64; 3], f64)| Sphere {
            center: to_scene(center.into()),
            radius: (radius / coordinates.unit) as f32,
        };
        let faces = (0..self.faces.len()).into_par_iter();
        Geometry {
            coordinates,
            spheres: self.spheres.iter().map(sphere).collect(),
            triangles: faces.map(|face| self.corners(face).map(to_scene)).collect(),
        }
    }
}

/// Returns points as triples of doubles, all in the range of numbers.
fn checked(points: Points, surface: usize) -> Result<Vec<[f64; 3]>, Error> {
    points.check("columns", points.len())?;
    let points: Vec<_> = (0..points.len()).map(|at| points.get(at)).collect();
    match (0..).zip(&points).find_map(|(index, point)| Some((index, outside(*point, DOMAIN)?))) {
        Some((index, number)) => Err(Error::Point { surface, index, number }),
        None => Ok(points),
    }
}
