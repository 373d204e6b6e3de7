//! Answers queries about rays and points, in chunks on several threads.

use super::answer::{AllHits, HitColumns, HitsMut};
use super::exact::{Exact, ExactBatch};
use super::input::{Points, Rays};
use super::surfaces::Surfaces;
use super::{Error, Precision, single};
use crate::traverse::every::Memory;
use crate::traverse::{Structure, Tracer, Traversal};
use glam::DVec3;
use rayon::prelude::*;
use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

/// The number of rays that a thread takes at a time.
const CHUNK: usize = Tracer::BATCH;

/// The direction of the rays that [`Intersector::contains`] counts along, if the first axis is that along
/// which the surfaces extend least: nearly along it, but no edge of a usual mesh is parallel.
const DIRECTION: [f64; 3] = [1.0, 0.113_721_695_4, 0.073_154_281_2];

/// The threads that answer queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Threads {
    /// The threads of the rayon pool in which a query is called.
    #[default]
    Pool,
    /// Only the thread that calls a query.
    Caller,
}

/// Meshes and spheres that are ready for queries. Clones share the memory.
#[derive(Clone)]
pub struct Intersector {
    surfaces: Arc<Surfaces>,
    structure: Structure,
    /// The lower and upper corner of the surfaces.
    bounds: [DVec3; 2],
    precision: Precision,
    threads: Threads,
}

/// The working memory of a thread.
#[derive(Default)]
struct Work {
    memory: Memory,
    single: single::Batch,
    exact: ExactBatch,
}

thread_local! {
    static WORK: RefCell<Work> = RefCell::default();
}

impl Intersector {
    pub(super) fn new(surfaces: Surfaces, precision: Precision) -> Self {
        let bounds = surfaces.bounds();
        let geometry = surfaces.geometry(bounds, precision);
        let structure = match precision {
            Precision::Single => Structure::new(&geometry),
            Precision::Exact => Structure::tree(&geometry, Traversal::Single),
        };
        Self { surfaces: Arc::new(surfaces), structure, bounds, precision, threads: Threads::default() }
    }

    /// Chooses the threads that answer queries.
    pub fn with_threads(self, threads: Threads) -> Self {
        Self { threads, ..self }
    }

    /// Returns the memory that surfaces and hierarchy take, in bytes.
    pub fn bytes(&self) -> usize {
        self.surfaces.bytes() + self.structure.bytes()
    }

    /// Returns the vertices of all meshes, one mesh after the other.
    pub fn vertices(&self) -> &[[f64; 3]] {
        self.surfaces.vertices()
    }

    /// Returns the faces of all meshes, as indices into [`Intersector::vertices`].
    pub fn faces(&self) -> &[[u32; 3]] {
        self.surfaces.faces()
    }

    /// Replaces the vertices of a mesh by as many others, and refits the hierarchy: faster than building, but
    /// queries become slower the further vertices move from their neighbours. Queries on earlier clones still
    /// see the earlier vertices.
    pub fn move_vertices<'a>(
        &mut self,
        surface: usize,
        vertices: impl Into<Points<'a>>,
    ) -> Result<(), Error> {
        Arc::make_mut(&mut self.surfaces).move_vertices(surface, vertices.into())?;
        self.bounds = self.surfaces.bounds();
        let geometry = self.surfaces.geometry(self.bounds, self.precision);
        self.structure = self.structure.refitted(&geometry);
        Ok(())
    }

    /// Returns the first hit of each ray, or a miss.
    pub fn closest(&self, rays: &Rays) -> Result<HitColumns, Error> {
        let mut hits = HitColumns::with_len(rays.len());
        self.closest_to(rays, hits.as_mut())?;
        Ok(hits)
    }

    /// Finds the first hit of each ray, or a miss, and writes them into columns. In [`Precision::Exact`] it
    /// is faster if only surfaces and primitives are wanted.
    pub fn closest_to(&self, rays: &Rays, hits: HitsMut) -> Result<(), Error> {
        rays.check()?;
        hits.check(rays.len())?;
        let parts = hits.parts(rays.len(), CHUNK);
        let answers = self.map_parts(rays.len(), parts, |range, hits, work| {
            let Work { memory, single, exact } = work;
            if self.precision == Precision::Single {
                single.closest((&self.surfaces, &self.structure), rays, range, hits);
                return Ok(());
            }
            self.exact(rays).closest(exact, range, memory, hits)
        });
        answers.into_iter().collect()
    }

    /// Tests which rays hit anything.
    pub fn occluded(&self, rays: &Rays) -> Result<Vec<bool>, Error> {
        rays.check()?;
        self.in_chunks(rays.len(), Vec::extend, |range, work| {
            let Work { memory, single, exact } = work;
            if self.precision == Precision::Single {
                return Ok(single.occluded(&self.structure, rays, range));
            }
            self.exact(rays).occluded(exact, range, memory)
        })
    }

    /// Returns every hit of each ray, in order. Edges and vertices belong to each of their triangles, in both
    /// precisions. In [`Precision::Single`] a sphere is hit where a ray enters it and where it leaves it.
    pub fn all_hits(&self, rays: &Rays) -> Result<AllHits, Error> {
        self.first_hits(rays, usize::MAX)
    }

    /// Returns the first hits of each ray, at most so many, in order.
    pub fn first_hits(&self, rays: &Rays, most: usize) -> Result<AllHits, Error> {
        rays.check()?;
        if most == 1 {
            return self.closest(rays).map(AllHits::of_closest);
        }
        self.in_chunks(rays.len(), AllHits::append, |range, work| {
            let Work { memory, single, exact } = work;
            match self.precision {
                Precision::Single => {
                    let of = (&*self.surfaces, &self.structure);
                    Ok(single.first_hits(of, rays, (range, most), memory))
                }
                Precision::Exact => self.exact(rays).first_hits(exact, (range, most), memory),
            }
        })
    }

    /// Returns how many surfaces each ray crosses.
    ///
    /// In [`Precision::Exact`] the ray crosses an edge or a vertex that triangles share once, or as often as
    /// it passes from one side of a closed surface to the other: as if it were moved by an infinitesimal
    /// step along x, a smaller one along y, and a still smaller one along z. Ends of rays on a surface are
    /// moved too, so that the parts of a cut ray cross as many as the whole. [`Precision::Single`] counts the
    /// hits of [`Intersector::all_hits`].
    pub fn count(&self, rays: &Rays) -> Result<Vec<u32>, Error> {
        rays.check()?;
        self.in_chunks(rays.len(), Vec::extend, |range, work| {
            let Work { memory, single, exact } = work;
            match self.precision {
                Precision::Single => Ok(single.count(&self.structure, rays, range, memory)),
                Precision::Exact => self.exact(rays).count(exact, range, memory),
            }
        })
    }

    /// Tests which points are inside: a ray from there crosses the surfaces an odd number of times. All
    /// surfaces together must be closed; where two of them overlap is outside. Points with NaN or infinite
    /// coordinates are outside.
    ///
    /// In [`Precision::Exact`] a point on a surface is inside if the point an infinitesimal step away along
    /// x is, then along y, then along z: of two solids that share a face, one contains its points. In
    /// [`Precision::Single`] points near surfaces, and few others, may be on the wrong side.
    pub fn contains<'a>(&self, points: impl Into<Points<'a>>) -> Result<Vec<bool>, Error> {
        let points = points.into();
        points.check("columns", points.len())?;
        // The shortest way out, as far as one axis tells.
        let [lo, hi] = self.bounds;
        let (middle, axis) = (lo * 0.5 + hi * 0.5, (hi - lo).min_position());
        let mut forward = DIRECTION;
        forward.rotate_right(axis);
        let backward = forward.map(|component| -component);
        let is_ahead = |at: usize| points.get(at)[axis] > middle[axis];
        let direction = |at: usize| if is_ahead(at) { forward } else { backward };
        let directions: Vec<[f64; 3]> = (0..points.len()).map(direction).collect();
        let counts = self.count(&Rays::new(points, &directions))?;
        Ok(counts.into_iter().map(|count| count % 2 == 1).collect())
    }

    fn exact<'a>(&'a self, rays: &'a Rays<'a>) -> Exact<'a> {
        Exact { surfaces: &self.surfaces, structure: &self.structure, rays }
    }

    /// Runs a query on chunks of `count` rays; returns the answers, appended in order, or the first error.
    fn in_chunks<R: Send + Default>(
        &self,
        count: usize,
        append: impl Fn(&mut R, R),
        query: impl Fn(Range<usize>, &mut Work) -> Result<R, Error> + Sync,
    ) -> Result<R, Error> {
        let answers =
            self.map_parts(count, vec![(); count.div_ceil(CHUNK)], |range, (), work| query(range, work));
        let joined = answers.into_iter().reduce(|all, chunk| {
            let mut all = all?;
            append(&mut all, chunk?);
            Ok(all)
        });
        joined.unwrap_or_else(|| Ok(R::default()))
    }

    /// Runs a query on chunks of `count` rays, each with a part of the output.
    fn map_parts<P: Send, R: Send>(
        &self,
        count: usize,
        parts: Vec<P>,
        query: impl Fn(Range<usize>, P, &mut Work) -> Result<R, Error> + Sync,
    ) -> Vec<Result<R, Error>> {
        let run = |(chunk, part): (usize, P)| {
            let range = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            WORK.with_borrow_mut(|work| query(range, part, work))
        };
        match self.threads {
            Threads::Pool => parts.into_par_iter().enumerate().map(run).collect(),
            Threads::Caller => parts.into_iter().enumerate().map(run).collect(),
        }
    }
}
