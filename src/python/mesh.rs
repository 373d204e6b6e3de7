//! Meshes, and queries about rays and points.

use crate::pool::{in_parts, pool};
use bytemuck::cast_slice;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use octray_rays::Tracer;
use octray_rays::query::{AllHits, Error, Intersector, Points, Precision, Rays, Surfaces, Threads};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::ops::Range;

/// A C-contiguous array of n points or vectors.
#[derive(FromPyObject)]
pub enum Triples<'py> {
    F32(PyReadonlyArray2<'py, f32>),
    F64(PyReadonlyArray2<'py, f64>),
}

impl Triples<'_> {
    fn points(&self) -> PyResult<Points<'_>> {
        Ok(match self {
            Self::F32(array) => Points::F32(cast_slice(array.as_slice()?)),
            Self::F64(array) => Points::F64(cast_slice(array.as_slice()?)),
        })
    }
}

/// The ends of rays, as an array or none.
type Ends<'py> = Option<PyReadonlyArray1<'py, f64>>;
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
    let mut rays = Rays::new(origins.points()?, directions.points()?);
    if let Some(t_min) = t_min {
        rays = rays.after(t_min.as_slice()?);
    }
    if let Some(t_max) = t_max {
        rays = rays.until(t_max.as_slice()?);
    }
    Ok(rays)
}

/// Returns an error of a part that begins with a ray as that of the whole.
fn error(error: Error, first: usize) -> PyErr {
    let error = match error {
        Error::Ray { index, number } => Error::Ray { index: index + first, number },
        other => other,
    };
    PyValueError::new_err(error.to_string())
}

/// A mesh that is ready for queries.
#[pyclass(frozen)]
pub struct Mesh {
    intersector: Intersector,
    precision: Precision,
    threads: usize,
}

impl Mesh {
    /// Calls `query` for parts of the rays, on all threads if there are enough of them.
    fn for_parts<T: Send>(
        &self,
        py: Python,
        count: usize,
        query: impl Fn(&Intersector, Range<usize>) -> Result<T, Error> + Sync,
        mut keep: impl FnMut(Range<usize>, T) + Send,
    ) -> PyResult<()> {
        let caller = self.intersector.clone().with_threads(Threads::Caller);
        let pool = (self.threads > 1 && count > Tracer::BATCH).then(|| pool(py, self.threads));
        in_parts(py, (count, self.threads), |range| {
            let answer = match pool {
                Some(pool) => pool.install(|| query(&self.intersector, range.clone())),
                None => query(&caller, range.clone()),
            };
            keep(range.clone(), answer.map_err(|fault| error(fault, range.start))?);
            Ok(())
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
        self.for_parts(py, count, query, |range, values| out[range].copy_from_slice(&values))?;
        drop(writable);
        Ok(array)
    }

    fn all(&self, py: Python, rays: Rays, max_hits: usize) -> PyResult<AllHits> {
        let mut all = AllHits::default();
        let query = |of: &Intersector, range| of.first_hits(&rays.range(range), max_hits);
        self.for_parts(py, rays.len(), query, |_, part| all.append(part))?;
        Ok(all)
    }

    /// Returns where a ray meets a face, with t computed from the face's plane in double precision.
    fn location(&self, origin: [f64; 3], direction: [f64; 3], (t, face): (f64, u32)) -> [f64; 3] {
        let mut t = t;
        if self.precision == Precision::Single {
            let corners = self.intersector.faces()[face as usize];
            let [a, b, c] = corners.map(|vertex| self.intersector.vertices()[vertex as usize]);
            let sub = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
            let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
            let (p, q) = (sub(b, a), sub(c, a));
            let n = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
            let of_plane = dot(n, sub(a, origin)) / dot(n, direction);
            // Where the ray is nearly in the plane, the rounded t is better.
            t = if (of_plane - t).abs() < 1e-3 * t { of_plane } else { t };
        }
        std::array::from_fn(|axis| origin[axis] + t * direction[axis])
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
        let count = rays.len();
        let [t, u, v] = std::array::from_fn(|_| PyArray1::<f64>::zeros(py, count, false));
        let primitive = PyArray1::<i32>::zeros(py, count, false);
        {
            let mut of = [&t, &u, &v].map(|array| array.readwrite());
            let mut of_primitive = primitive.readwrite();
            let numbers = of_primitive.as_slice_mut()?;
            let [t, u, v] = &mut of;
            let (t, u, v) = (t.as_slice_mut()?, u.as_slice_mut()?, v.as_slice_mut()?);
            self.for_parts(
                py,
                count,
                |of, range| of.closest(&rays.range(range)),
                |range, hits| {
                    t[range.clone()].copy_from_slice(&hits.t);
                    u[range.clone()].copy_from_slice(&hits.u);
                    v[range.clone()].copy_from_slice(&hits.v);
                    // The number of a miss becomes −1.
                    numbers[range].iter_mut().zip(&hits.primitive).for_each(|(to, from)| *to = *from as i32);
                },
            )?;
        }
        Ok((t, primitive, u, v))
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

    /// Returns the offsets, and t, primitive, u and v of all hits.
    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: RayArrays,
        max_hits: usize,
    ) -> PyResult<(Bound<'py, PyArray1<i64>>, HitArrays<'py>)> {
        let AllHits { offsets, hits } = self.all(py, self::rays(&rays)?, max_hits)?;
        let primitive = hits.primitive.into_iter().map(|number| number as i32);
        let offsets = PyArray1::from_iter(py, offsets.into_iter().map(|offset| offset as i64));
        let [t, u, v] = [hits.t, hits.u, hits.v].map(|column| PyArray1::from_vec(py, column));
        Ok((offsets, (t, PyArray1::from_iter(py, primitive), u, v)))
    }

    /// Returns face, ray and location of all hits: the first hits of all rays, then the second ones, and so
    /// on. Hits of a ray that are no further than `apart` from each other, which is a factor of t and a
    /// length, are one.
    #[allow(clippy::type_complexity)]
    fn hits_by_depth<'py>(
        &self,
        py: Python<'py>,
        rays: RayArrays,
        max_hits: usize,
        apart: [f64; 2],
    ) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f64>>)> {
        let (origins, directions) = (rays.0.points()?, rays.1.points()?);
        // Duplicates do not count, so more hits than `max_hits` may be needed.
        let AllHits { offsets, hits } = self.all(py, self::rays(&rays)?, max_hits.saturating_mul(8))?;
        let mut by_depth: Vec<[Vec<i64>; 2]> = Vec::new();
        let mut locations: Vec<Vec<[f64; 3]>> = Vec::new();
        py.detach(|| {
            for (ray, range) in offsets.windows(2).enumerate() {
                let (mut last, mut depth) = (f64::NEG_INFINITY, 0);
                for at in range[0]..range[1] {
                    let t = hits.t[at];
                    if depth == max_hits || t - last <= apart[0] * t + apart[1] {
                        continue;
                    }
                    if depth == by_depth.len() {
                        by_depth.push(Default::default());
                        locations.push(Vec::new());
                    }
                    let face = hits.primitive[at];
                    by_depth[depth][0].push(face.into());
                    by_depth[depth][1].push(ray as i64);
                    let (origin, direction) = (origins.get(ray), directions.get(ray));
                    locations[depth].push(self.location(origin, direction, (t, face)));
                    (last, depth) = (t, depth + 1);
                }
            }
        });
        let [faces, of_rays] = [0, 1].map(|column| {
            let all: Vec<i64> = by_depth.iter().flat_map(|depth| &depth[column]).copied().collect();
            PyArray1::from_vec(py, all)
        });
        Ok((faces, of_rays, array(py, &locations.concat())?))
    }
}

/// Returns rows of three numbers as an array.
fn array<'py, T: numpy::Element + bytemuck::Pod>(
    py: Python<'py>,
    rows: &[[T; 3]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_slice(py, cast_slice::<[T; 3], T>(rows)).reshape([rows.len(), 3])
}
