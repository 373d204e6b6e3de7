//! The traversals that trace a set of rays, on one thread or many.

use super::ray_sets::{Answers, RaySet};
use crate::lane::NATIVE_WIDTH;
use crate::math::MISS;
use crate::rays::{Counts, Geometry, Hits, Rays, Structure, Tracer, Traversal};
use crate::render::TraversalChoice;
use crate::threads::Threads;
use rayon::prelude::*;

/// Most rays of a thread's unit of work: a whole batch of a stream.
const CHUNK: usize = Tracer::BATCH;
/// Units of work for each thread, so that all end at about the same time.
const UNITS: usize = 4;

/// Returns the traversals that can be measured, the baseline first and `linear` last.
pub fn traversals() -> impl Iterator<Item = TraversalChoice> {
    Traversal::ALL.into_iter().map(TraversalChoice::Through).chain([TraversalChoice::Linear])
}

/// Returns the number of SIMD lanes of a traversal.
pub fn lanes(traversal: TraversalChoice) -> usize {
    if let TraversalChoice::Through(traversal) = traversal { traversal.lanes() } else { NATIVE_WIDTH }
}

/// The acceleration structures of a scene that the traversals read.
pub struct Accelerators {
    /// Wide and binary trees: some traversals read the one, some the other.
    pub(crate) tree: Structure,
    list: Structure,
}

impl Accelerators {
    /// Builds a list of the primitives, beside their hierarchy ([`Structure::tree_for_all`]).
    pub fn new(geometry: &Geometry, tree: Structure) -> Self {
        Self { tree, list: Structure::list(geometry, NATIVE_WIDTH) }
    }

    /// Updates the hits of all rays: the closest hit, or any hit. Without a hierarchy, every primitive is
    /// tested. `inline(never)`: `perf/stat.sh` selects this function by name.
    #[inline(never)]
    fn trace_chunk(
        &self,
        method: TraversalChoice,
        tracer: &mut Tracer,
        rays: &Rays,
        hits: &mut Hits,
        any_hit: bool,
    ) {
        let structure = match method {
            TraversalChoice::Through(traversal) => &self.tree.with_traversal(traversal),
            TraversalChoice::Linear | TraversalChoice::Auto => &self.list,
        };
        match any_hit {
            true => tracer.improve::<true>(structure, rays, hits),
            false => tracer.improve::<false>(structure, rays, hits),
        }
    }

    /// Counts the tests of these rays, traced in chunks as on several threads.
    pub(crate) fn count(&self, method: TraversalChoice, set: &RaySet) -> Counts {
        let (mut tracer, mut answers) = (Tracer::new(), Answers::none(set));
        tracer.start_counting();
        let mut hits = answers.hits();
        for first in (0..set.len()).step_by(CHUNK) {
            let range = first..set.len().min(first + CHUNK);
            let (rays, hits) = (&set.rays().range(range.clone()), &mut hits.range(range));
            self.trace_chunk(method, &mut tracer, rays, hits, set.kind.any_hit());
        }
        tracer.take_counts()
    }
}

/// Worker threads, each with a tracer.
pub struct TracePool(Threads<Tracer>);

impl TracePool {
    /// # Panics
    /// If `threads` is 0, or the system refuses threads.
    pub fn new(threads: usize) -> Self {
        Self(Threads::new(threads, Tracer::new))
    }
    /// Returns the number of worker threads.
    pub fn threads(&self) -> usize {
        self.0.count()
    }
    /// Runs a closure on the pool's threads. Around [`TracePool::clear`] and [`TracePool::trace`], it keeps
    /// the threads awake between the two.
    pub(crate) fn run<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        self.0.run(run)
    }
    /// Resets the answers to misses.
    pub fn clear(&self, set: &RaySet, answers: &mut Answers) {
        self.each_chunk(set.len(), answers, |first, hits| {
            hits.t.copy_from_slice(&set.t_max[first..first + hits.t.len()]);
            hits.primitive.fill(MISS);
            hits.u.fill(0.0);
            hits.v.fill(0.0);
        });
    }
    /// Finds the closest hits, or any hits.
    pub fn trace(
        &self,
        method: TraversalChoice,
        structures: &Accelerators,
        set: &RaySet,
        answers: &mut Answers,
        any_hit: bool,
    ) {
        self.each_chunk(set.len(), answers, |first, hits| {
            let rays = set.rays().range(first..first + hits.t.len());
            structures.trace_chunk(method, &mut self.0.local(), &rays, hits, any_hit);
        });
    }

    /// Calls `work` with the number of the first ray and all answers, or on several threads chunks of them.
    fn each_chunk(&self, rays: usize, answers: &mut Answers, work: impl Fn(usize, &mut Hits) + Sync) {
        if self.0.is_single() {
            return work(0, &mut answers.hits());
        }
        debug_assert_eq!(rays, answers.t.len());
        // Whole tiles.
        let chunk =
            rays.div_ceil(UNITS * self.threads()).next_multiple_of(Tracer::TILE).clamp(Tracer::TILE, CHUNK);
        let Hits { t, primitive, u, v } = answers.hits();
        let [t, u, v] = [t, u, v].map(|column| column.par_chunks_mut(chunk));
        let columns = (t, primitive.par_chunks_mut(chunk), u, v);
        columns.into_par_iter().enumerate().for_each(|(unit, (t, primitive, u, v))| {
            work(unit * chunk, &mut Hits { t, primitive, u, v });
        });
    }
}
