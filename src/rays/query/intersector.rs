//! Answers queries about rays and points, in chunks on several threads.

use super::answer::{AllHits, HitColumns};
use super::exact::{Exact, ExactBatch};
use super::input::{OneRay, Points, Rays};
use super::single::{self, Batch};
use super::surfaces::Surfaces;
use super::{Error, Precision};
use crate::traverse::stack::Stack;
use crate::traverse::{Structure, Tracer, Traversal};
use rayon::prelude::*;
use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

/// The number of rays that a thread takes at a time.
const CHUNK: usize = Tracer::BATCH;

/// The direction of the rays that [`Intersector::contains`] counts along: no edge of a usual mesh is parallel
/// to it.
const DIRECTION: [f64; 3] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2, 0.324_717_957_244_746_1];

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
    precision: Precision,
    threads: Threads,
}

/// The working memory of a thread.
#[derive(Default)]
struct Memory {
    tracer: Tracer,
    stack: Stack,
    batch: Batch,
    exact: ExactBatch,
}

thread_local! {
    static MEMORY: RefCell<Memory> = RefCell::default();
}

impl Intersector {
    pub(super) fn new(surfaces: Surfaces, precision: Precision) -> Self {
        let geometry = surfaces.geometry();
        let structure = match precision {
            Precision::Single => Structure::new(&geometry),
            Precision::Exact => Structure::tree(&geometry, Traversal::Single),
        };
        Self { surfaces: Arc::new(surfaces), structure, precision, threads: Threads::default() }
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
        self.structure = self.structure.refitted(&self.surfaces.geometry());
        Ok(())
    }

    /// Returns the first hit of each ray, or a miss.
    pub fn closest(&self, rays: &Rays) -> Result<HitColumns, Error> {
        rays.check()?;
        self.in_chunks(rays.len(), HitColumns::append, |range, memory| {
            let mut hits = HitColumns::with_capacity(range.len());
            let mut push = |hit: Option<([f64; 3], u32)>| match hit {
                Some((hit, number)) => self.push(&mut hits, hit, number),
                None => hits.push_miss(),
            };
            let count = range.len();
            if self.precision == Precision::Exact {
                self.trace_exact::<false>(rays, range, memory)?;
                for at in 0..count {
                    memory.exact.prefetch(at + 16, &self.surfaces, false);
                    memory.exact.prefetch(at + 8, &self.surfaces, true);
                    push(memory.exact.hit(at, &self.surfaces));
                }
            } else {
                memory.trace::<false>(self, range.map(|at| rays.get(at)));
                (0..count).for_each(|at| push(memory.batch.hit(at)));
            }
            Ok(hits)
        })
    }

    /// Tests which rays hit anything.
    pub fn occluded(&self, rays: &Rays) -> Result<Vec<bool>, Error> {
        rays.check()?;
        self.in_chunks(rays.len(), Vec::extend, |range, memory| {
            let count = range.len();
            if self.precision == Precision::Exact {
                self.trace_exact::<true>(rays, range, memory)?;
                return Ok((0..count).map(|at| memory.exact.is_hit(at)).collect());
            }
            memory.trace::<true>(self, range.map(|at| rays.get(at)));
            Ok((0..count).map(|at| memory.batch.hit(at).is_some()).collect())
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
        self.in_chunks(rays.len(), AllHits::append, |range, memory| {
            let mut all = AllHits::default();
            for at in range {
                if let Some(ray) = self.ray(rays, at)? {
                    let mut left = most;
                    self.every_hit(&ray, memory, |hit, number| {
                        if left > 0 {
                            left -= 1;
                            self.push(&mut all.hits, hit, number);
                        }
                    });
                }
                all.end_ray();
            }
            Ok(all)
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
        self.one_by_one(rays.len(), |at, memory| {
            let ray = self.ray(rays, at)?;
            Ok(ray.map_or(0, |ray| self.crossings(&ray, memory)))
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
        self.one_by_one(points.len(), |at, memory| {
            let (origin, [t_min, t_max]) = (points.get(at), [0.0, f64::INFINITY]);
            let ray = OneRay { origin, direction: DIRECTION, t_min, t_max };
            if origin.iter().any(|component| !component.is_finite()) {
                return Ok(false);
            }
            self.check(&ray, at)?;
            Ok(self.crossings(&ray, memory) % 2 == 1)
        })
    }

    fn exact(&self) -> Exact<'_> {
        Exact { surfaces: &self.surfaces, structure: &self.structure }
    }

    /// Returns a ray, if it can hit something and can be answered.
    fn ray(&self, rays: &Rays, at: usize) -> Result<Option<OneRay>, Error> {
        let ray = rays.get(at);
        ray.map_or(Ok(()), |ray| self.check(&ray, at)).map(|()| ray)
    }

    fn check(&self, ray: &OneRay, at: usize) -> Result<(), Error> {
        if self.precision == Precision::Exact { ray.check(at) } else { Ok(()) }
    }

    fn trace_exact<const ANY: bool>(
        &self,
        rays: &Rays,
        range: Range<usize>,
        memory: &mut Memory,
    ) -> Result<(), Error> {
        let (Memory { exact, stack, .. }, mut fault) = (memory, Ok(()));
        let rays = range.map_while(|at| self.ray(rays, at).map_err(|error| fault = Err(error)).ok());
        self.exact().trace::<ANY>(exact, stack, rays);
        fault
    }

    fn every_hit(&self, ray: &OneRay, memory: &mut Memory, push: impl FnMut([f64; 3], u32)) {
        match self.precision {
            Precision::Single => single::every_hit(&self.structure, ray, &mut memory.stack, push),
            Precision::Exact => self.exact().every_hit(ray, &mut memory.stack, push),
        }
    }

    fn crossings(&self, ray: &OneRay, memory: &mut Memory) -> u32 {
        match self.precision {
            Precision::Single => {
                let mut count = 0;
                self.every_hit(ray, memory, |_, _| count += 1);
                count
            }
            Precision::Exact => self.exact().count(ray, &mut memory.stack),
        }
    }

    fn push(&self, hits: &mut HitColumns, [t, u, v]: [f64; 3], number: u32) {
        let [u, v] = if self.surfaces.is_sphere(number) { [0.0; 2] } else { [u, v] };
        hits.push([t, u, v], self.surfaces.place(number));
    }

    /// Runs a query on each of `count` rays; returns the answers in order, or the first error.
    fn one_by_one<R: Send>(
        &self,
        count: usize,
        query: impl Fn(usize, &mut Memory) -> Result<R, Error> + Sync,
    ) -> Result<Vec<R>, Error> {
        self.in_chunks(count, Vec::extend, |range, memory| range.map(|at| query(at, memory)).collect())
    }

    /// Runs a query on chunks of `count` rays; returns the answers, appended in order, or the first error.
    fn in_chunks<R: Send + Default>(
        &self,
        count: usize,
        append: impl Fn(&mut R, R),
        query: impl Fn(Range<usize>, &mut Memory) -> Result<R, Error> + Sync,
    ) -> Result<R, Error> {
        let run = |chunk: usize| {
            let range = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            MEMORY.with_borrow_mut(|memory| query(range, memory))
        };
        let chunks = 0..count.div_ceil(CHUNK);
        let answers: Vec<_> = match self.threads {
            Threads::Pool => chunks.into_par_iter().map(run).collect(),
            Threads::Caller => chunks.map(run).collect(),
        };
        let joined = answers.into_iter().reduce(|all, chunk| {
            let mut all = all?;
            append(&mut all, chunk?);
            Ok(all)
        });
        joined.unwrap_or_else(|| Ok(R::default()))
    }
}

impl Memory {
    fn trace<const ANY: bool>(
        &mut self,
        of: &Intersector,
        rays: impl ExactSizeIterator<Item = Option<OneRay>>,
    ) {
        self.batch.trace::<ANY>((&of.structure, &mut self.tracer), rays);
    }
}
