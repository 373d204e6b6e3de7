//! Meshes, and queries about rays and points.

use crate::pool::{in_parts, pool};
use bytemuck::allocation::cast_vec;
use bytemuck::{cast_slice, cast_slice_mut};
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use octray_rays::Tracer;
use octray_rays::lane::prefetch;
use octray_rays::query::{
    AllHits, Error, HitsMut, Intersector, Numbers, Points, Precision, Rays, Surfaces, Threads,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::mem::take;
use std::ops::Range;

/// A C-contiguous array of n points or vectors, or one for all.
#[derive(FromPyObject)]
pub enum Triples<'py> {
    F32(PyReadonlyArray2<'py, f32>),
    F64(PyReadonlyArray2<'py, f64>),
    Same([f64; 3]),
}

impl Triples<'_> {
    fn points(&self) -> PyResult<Points<'_>> {
        Ok(match self {
            Self::Same(point) => Points::same(*point),
            Self::F32(array) => Points::F32(cast_slice(array.as_slice()?)),
            Self::F64(array) => Points::F64(cast_slice(array.as_slice()?)),
        })
    }
}

/// The ends of rays: one for all, or an array.
#[derive(FromPyObject)]
pub enum Ends<'py> {
    Same(f64),
    Each(PyReadonlyArray1<'py, f64>),
}

impl Ends<'_> {
    fn numbers(&self) -> PyResult<Numbers<'_>> {
        Ok(match self {
            Self::Same(number) => Numbers::Same(*number),
            Self::Each(array) => Numbers::F64(array.as_slice()?),
        })
    }
}

/// Origins, directions, t_min and t_max.
type RayArrays<'py> = (Triples<'py>, Triples<'py>, Ends<'py>, Ends<'py>);
/// t, primitive, u and v.
type HitArrays<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

fn rays<'a>((origins, directions, t_min, t_max): &'a RayArrays) -> PyResult<Rays<'a>> {
    let rays = Rays::new(origins.points()?, directions.points()?);
    Ok(rays.after(t_min.numbers()?).until(t_max.numbers()?))
}

/// Returns the error of a part of the rays as that of all; `index_of` gives the index of a ray among all.
fn among_all(error: Error, index_of: impl Fn(usize) -> usize) -> Error {
    match error {
        Error::Ray { index, number } => Error::Ray { index: index_of(index), number },
        other => other,
    }
}

/// Converts the error of a part of the rays, whose first is ray `first` of all.
fn error(error: Error, first: usize) -> PyErr {
    PyValueError::new_err(among_all(error, |index| index + first).to_string())
}

/// A mesh that is ready for queries.
#[pyclass(frozen)]
pub struct Mesh {
    intersector: Intersector,
    precision: Precision,
    threads: usize,
}

impl Mesh {
    /// Calls `run` for parts of the rays, on all threads if there are enough of them.
    fn for_parts(
        &self,
        py: Python,
        count: usize,
        mut run: impl FnMut(&Intersector, Range<usize>) -> Result<(), Error> + Send,
    ) -> PyResult<()> {
        let caller = self.intersector.clone().with_threads(Threads::Caller);
        let pool = (self.threads > 1 && count > Tracer::BATCH).then(|| pool(py, self.threads));
        in_parts(py, (count, self.threads), |range| {
            let answer = match pool {
                Some(pool) => pool.install(|| run(&self.intersector, range.clone())),
                None => run(&caller, range.clone()),
            };
            answer.map_err(|fault| error(fault, range.start))
        })
    }

    /// Returns one value for each of `count` rays.
    fn map<'py, T: numpy::Element + Send + Copy>(
        &self,
        py: Python<'py>,
        count: usize,
        query: impl Fn(&Intersector, Range<usize>) -> Result<Vec<T>, Error> + Sync,
    ) -> PyResult<Bound<'py, PyArray1<T>>> {
        let array = PyArray1::zeros(py, count, false);
        let mut writable = array.readwrite();
        let out = writable.as_slice_mut()?;
        self.for_parts(py, count, |of, range| {
            out[range.clone()].copy_from_slice(&query(of, range)?);
            Ok(())
        })?;
        drop(writable);
        Ok(array)
    }

    /// Finds the first hits of rays, and writes them into columns.
    fn closest_to(&self, py: Python, rays: &Rays, hits: HitsMut) -> PyResult<()> {
        let mut rest = hits;
        self.for_parts(py, rays.len(), |of, range| {
            let part;
            (part, rest) = take(&mut rest).split(range.len());
            of.closest_to(&rays.range(range), part)
        })
    }

    fn all(&self, py: Python, rays: &Rays, max_hits: usize) -> PyResult<AllHits> {
        let mut all = AllHits::default();
        self.for_parts(py, rays.len(), |of, range| {
            all.append(of.first_hits(&rays.range(range), max_hits)?);
            Ok(())
        })?;
        Ok(all)
    }

    /// Returns where a ray meets a face, with t computed from the face's plane in double precision.
    fn location(&self, [origin, direction]: [DVec3; 2], (t, face): (f64, u32)) -> [f64; 3] {
        let mut t = t;
        if self.precision == Precision::Single {
            let [a, b, c] = self.intersector.faces()[face as usize];
            // Not array::map, which may be a call.
            let vertex = |vertex: u32| DVec3::from(self.intersector.vertices()[vertex as usize]);
            let (a, b, c) = (vertex(a), vertex(b), vertex(c));
            let normal = (b - a).cross(c - a);
            let of_plane = normal.dot(a - origin) / normal.dot(direction);
            // Where the ray is nearly in the plane, the rounded t is better.
            t = if (of_plane - t).abs() < 1e-3 * t { of_plane } else { t };
        }
        (origin + t * direction).to_array()
    }
}

#[pymethods]
impl Mesh {
    #[new]
    fn new(
        py: Python,
        vertices: Triples,
        faces: PyReadonlyArray2<u32>,
        exact: bool,
        threads: usize,
    ) -> PyResult<Self> {
        let (vertices, faces) = (vertices.points()?, cast_slice::<u32, [u32; 3]>(faces.as_slice()?));
        let precision = if exact { Precision::Exact } else { Precision::Single };
        let pool = pool(py, threads);
        let build = || {
            let mut surfaces = Surfaces::new();
            surfaces.add_mesh(vertices, faces)?;
            surfaces.build(precision)
        };
        let intersector = py.detach(|| pool.install(build)).map_err(|fault| error(fault, 0))?;
        Ok(Self { intersector, precision, threads })
    }

    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.intersector.vertices())
    }

    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        array(py, self.intersector.faces())
    }

    fn bytes(&self) -> usize {
        self.intersector.bytes()
    }

    fn closest<'py>(&self, py: Python<'py>, rays: RayArrays) -> PyResult<HitArrays<'py>> {
        let rays = self::rays(&rays)?;
        let [t, u, v] = std::array::from_fn(|_| PyArray1::<f64>::zeros(py, rays.len(), false));
        let primitive = PyArray1::<i32>::zeros(py, rays.len(), false);
        {
            let (mut t, mut u, mut v) = (t.readwrite(), u.readwrite(), v.readwrite());
            let mut primitive = primitive.readwrite();
            let hits = HitsMut {
                t: t.as_slice_mut()?,
                surface: &mut [],
                // The number of a miss becomes −1.
                primitive: cast_slice_mut(primitive.as_slice_mut()?),
                u: u.as_slice_mut()?,
                v: v.as_slice_mut()?,
            };
            self.closest_to(py, &rays, hits)?;
        }
        Ok((t, primitive, u, v))
    }

    /// Returns the first face of each ray, or −1.
    fn first<'py>(&self, py: Python<'py>, rays: RayArrays) -> PyResult<Bound<'py, PyArray1<i32>>> {
        let rays = self::rays(&rays)?;
        let faces = PyArray1::<i32>::zeros(py, rays.len(), false);
        {
            let mut faces = faces.readwrite();
            let primitive = cast_slice_mut(faces.as_slice_mut()?);
            self.closest_to(py, &rays, HitsMut { primitive, ..HitsMut::default() })?;
        }
        Ok(faces)
    }

    fn occluded<'py>(&self, py: Python<'py>, rays: RayArrays) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let rays = self::rays(&rays)?;
        self.map(py, rays.len(), |of, range| of.occluded(&rays.range(range)))
    }

    fn count<'py>(&self, py: Python<'py>, rays: RayArrays) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let rays = self::rays(&rays)?;
        self.map(py, rays.len(), |of, range| of.count(&rays.range(range)))
    }

    fn contains<'py>(&self, py: Python<'py>, points: Triples) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let points = points.points()?;
        self.map(py, points.len(), |of, range| of.contains(points.range(range)))
    }

    /// Returns a verdict for each point, by rays along a direction and back: 1, inside, if both cross an odd
    /// number of faces; 2, undecided, if one does, and both hit; 0, outside, otherwise, and beyond `corners`.
    fn sides<'py>(
        &self,
        py: Python<'py>,
        points: Triples,
        direction: [f64; 3],
        corners: [[f64; 3]; 2],
    ) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let points = points.points()?;
        let directions = [direction, direction.map(|component| -component)].map(Points::same);
        let is_between = |point: [f64; 3]| {
            (0..3).all(|axis| corners[0][axis] < point[axis] && point[axis] < corners[1][axis])
        };
        self.map(py, points.len(), |of, range| {
            let mut sides = vec![0; range.len()];
            let (places, between): (Vec<usize>, Vec<[f64; 3]>) =
                range.map(|at| points.get(at)).enumerate().filter(|(_, point)| is_between(*point)).unzip();
            let count = |direction| {
                let counts = of.count(&Rays::new(&between, direction));
                counts.map_err(|error| among_all(error, |index| places[index]))
            };
            let [there, back] = directions.map(count);
            for (&place, (there, back)) in places.iter().zip(there?.into_iter().zip(back?)) {
                sides[place] = match (there % 2, back % 2) {
                    (1, 1) => 1,
                    (0, 0) => 0,
                    _ => 2 * u8::from(there > 0 && back > 0),
                };
            }
            Ok(sides)
        })
    }

    /// Returns the offsets, and t, primitive, u and v of all hits.
    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: RayArrays,
        max_hits: usize,
    ) -> PyResult<(Bound<'py, PyArray1<i64>>, HitArrays<'py>)> {
        let AllHits { offsets, hits } = self.all(py, &self::rays(&rays)?, max_hits)?;
        let primitive = hits.primitive.into_iter().map(|number| number as i32);
        let offsets = PyArray1::from_iter(py, offsets.into_iter().map(|offset| offset as i64));
        let [t, u, v] = [hits.t, hits.u, hits.v].map(|column| PyArray1::from_vec(py, column));
        Ok((offsets, (t, PyArray1::from_iter(py, primitive), u, v)))
    }

    /// Returns face, ray and location of all hits: the first hits of all rays, then the second ones, and so
    /// on. Hits of a ray whose t differs less than by the factor `apart` are one.
    #[allow(clippy::type_complexity)]
    fn hits_by_depth<'py>(
        &self,
        py: Python<'py>,
        rays: RayArrays,
        max_hits: usize,
        apart: f64,
    ) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f64>>)> {
        let (origins, directions) = (rays.0.points()?, rays.1.points()?);
        let hits = self.kept(py, &self::rays(&rays)?, max_hits, apart)?;
        let columns = py.detach(|| {
            let mut next = vec![0; hits.iter().map(|hit| hit.depth as usize + 1).max().unwrap_or(0)];
            hits.iter().for_each(|hit| next[hit.depth as usize] += 1);
            let mut first = 0;
            next.iter_mut().for_each(|next| (*next, first) = (first, first + *next));
            let (mut faces, mut of_rays) = (vec![0; hits.len()], vec![0; hits.len()]);
            let mut locations = vec![[0.0; 3]; hits.len()];
            for (at, &Kept { depth, ray, t, face }) in hits.iter().enumerate() {
                self.prefetch(&hits[at..]);
                let next = &mut next[depth as usize];
                let to = *next;
                *next += 1;
                (faces[to], of_rays[to]) = (i64::from(face), i64::from(ray));
                let ray = ray as usize;
                let of_ray = [origins.get(ray).into(), directions.get(ray).into()];
                locations[to] = self.location(of_ray, (t, face));
            }
            (faces, of_rays, locations)
        });
        let (faces, of_rays, locations) = columns;
        let locations =
            PyArray1::from_vec(py, cast_vec::<[f64; 3], f64>(locations)).reshape([hits.len(), 3])?;
        Ok((PyArray1::from_vec(py, faces), PyArray1::from_vec(py, of_rays), locations))
    }
}

/// A hit among the hits of its ray.
struct Kept {
    depth: u32,
    ray: u32,
    face: u32,
    t: f64,
}

impl Mesh {
    /// Returns the hits of [`Mesh::hits_by_depth`], ray by ray.
    fn kept(&self, py: Python, rays: &Rays, max_hits: usize, apart: f64) -> PyResult<Vec<Kept>> {
        // Merging may drop later hits, never the first.
        let most = if max_hits == 1 { 1 } else { usize::MAX };
        let max_hits = u32::try_from(max_hits).unwrap_or(u32::MAX);
        let mut kept = Vec::new();
        self.for_parts(py, rays.len(), |of, range| {
            let AllHits { offsets, hits } = of.first_hits(&rays.range(range.clone()), most)?;
            for (ray, ends) in (range.start as u32..).zip(offsets.windows(2)) {
                let (mut last, mut depth) = (f64::NEG_INFINITY, 0);
                for (&t, &face) in hits.t[ends[0]..ends[1]].iter().zip(&hits.primitive[ends[0]..ends[1]]) {
                    if depth < max_hits && t - last > apart * t {
                        kept.push(Kept { depth, ray, face, t });
                        (last, depth) = (t, depth + 1);
                    }
                }
            }
            Ok(())
        })?;
        Ok(kept)
    }

    /// Fetches what [`Mesh::location`] will read for later hits.
    #[inline(always)]
    fn prefetch(&self, next: &[Kept]) {
        if self.precision == Precision::Single {
            let faces = self.intersector.faces();
            if let Some(hit) = next.get(16) {
                prefetch(&faces[hit.face as usize]);
            }
            if let Some(hit) = next.get(8) {
                faces[hit.face as usize]
                    .iter()
                    .for_each(|&vertex| prefetch(&self.intersector.vertices()[vertex as usize]));
            }
        }
    }
}

/// Returns rows of three numbers as an array.
fn array<'py, T: numpy::Element + bytemuck::Pod>(
    py: Python<'py>,
    rows: &[[T; 3]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_slice(py, cast_slice::<[T; 3], T>(rows)).reshape([rows.len(), 3])
}
