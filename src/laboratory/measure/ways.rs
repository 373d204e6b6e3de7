//! The ways to trace a set of rays, on one thread or many.
//!
//! For: [`Way`], [`Ground`] (a scene made ready for all of them) and [`Team`]. May import: `ray_sets` and all rooms above. Must never
//! know: clocks.

use super::ray_sets::{Answers, RaySet};
use crate::buffers::{Buffers, store_triangles};
use crate::kernel::ray_sphere::Robust;
use crate::kernel::ray_triangle::{TriangleMethod, Woop};
use crate::lane::{Bits, F32x8, Lane};
use crate::math::MISS;
use crate::scene::Scene;
use crate::threads::Threads;
use crate::traverse::TraversalChoice;
use crate::traverse::batch::{Tracer, Traversal};
use crate::traverse::counter::{Counter, Counts};
use crate::traverse::hierarchy::Hierarchy;
use crate::traverse::linear;
use crate::traverse::rays::{Hits, Rays};
use rayon::prelude::*;

/// Rays that a thread takes at a time: whole tiles, and a whole batch of a stream.
const CHUNK: usize = crate::traverse::stream::BATCH;

/// How to find what rays hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Testing every primitive, eight rays at a time.
    Linear,
    /// Through the hierarchy.
    Tree(Traversal),
}

impl Way {
    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Tree(traversal) => traversal.name(),
        }
    }
    /// Lanes it works with.
    pub fn lanes(self) -> usize {
        match self {
            Self::Linear => F32x8::WIDTH,
            Self::Tree(traversal) => traversal.lanes(),
        }
    }
    /// The one that was asked for; `None` where that is left to what suits.
    pub fn of(choice: TraversalChoice) -> Option<Self> {
        match choice {
            TraversalChoice::Needed => None,
            TraversalChoice::Linear => Some(Self::Linear),
            TraversalChoice::Through(traversal) => Some(Self::Tree(traversal)),
        }
    }
    /// All of them, the baseline first.
    pub fn all() -> impl Iterator<Item = Self> {
        Traversal::ALL.into_iter().map(Self::Tree).chain([Self::Linear])
    }
}

/// A scene made ready for every way.
pub struct Ground {
    pub hierarchy: Hierarchy,
    buffers: Buffers,
    triangles: Vec<<Woop as TriangleMethod>::Stored>,
}

impl Ground {
    pub fn new(scene: &Scene, hierarchy: Hierarchy) -> Self {
        Self { hierarchy, buffers: Buffers::new(scene), triangles: store_triangles::<Woop>(scene) }
    }

    /// Improves the hits of all rays; with `ANY`, each ray is content with any hit.
    fn trace<const ANY: bool>(&self, way: Way, tracer: &mut Tracer, rays: &Rays, hits: &mut Hits) {
        match way {
            Way::Tree(traversal) => tracer.trace::<ANY>(traversal, &self.hierarchy, rays, hits),
            Way::Linear => {
                let packets = rays.len() - rays.len() % F32x8::WIDTH;
                self.test_all::<F32x8>(&rays.range(0..packets), &mut hits.range(0..packets));
                let rest = packets..rays.len();
                self.test_all::<f32>(&rays.range(rest.clone()), &mut hits.range(rest));
            }
        }
    }

    /// What is tested for these rays, chunk by chunk as more than one thread would trace them.
    pub fn count(&self, way: Way, set: &RaySet) -> Counts {
        let (mut tracer, mut answers, counter) = (Tracer::new(), Answers::none(set), Counter::default());
        let mut hits = answers.hits();
        for first in (0..set.len()).step_by(CHUNK) {
            let range = first..set.len().min(first + CHUNK);
            let (rays, hits) = (&set.rays().range(range.clone()), &mut hits.range(range));
            match (way, set.kind.any_hit()) {
                (Way::Linear, _) => {
                    let each = [self.buffers.spheres.len(), self.triangles.len()];
                    // As it traces: whole packets, and the rest one by one.
                    let packets = rays.len() / F32x8::WIDTH + rays.len() % F32x8::WIDTH;
                    counter.linear(each, packets, rays.len());
                }
                (Way::Tree(traversal), true) => {
                    tracer.count::<true>(traversal, &self.hierarchy, rays, hits, &counter);
                }
                (Way::Tree(traversal), false) => {
                    tracer.count::<false>(traversal, &self.hierarchy, rays, hits, &counter);
                }
            }
        }
        counter.get()
    }

    /// Domain: whole packets.
    fn test_all<L: Lane>(&self, rays: &Rays, hits: &mut Hits) {
        let all = linear::All { spheres: &self.buffers.spheres, triangles: &self.triangles };
        let padding = self.hierarchy.padding;
        for at in (0..rays.len()).step_by(L::WIDTH) {
            let hit = linear::closest::<L, Robust, Woop>(&all, padding, &rays.packet(at));
            let limit = L::load(&hits.t[at..]);
            let within = hit.found() & hit.t.lt(limit);
            let zero = L::zero();
            L::select(within, hit.t, limit).store(&mut hits.t[at..]);
            L::Bits::select(within, hit.primitive, L::Bits::splat(MISS)).store(&mut hits.primitive[at..]);
            L::select(within, hit.u, zero).store(&mut hits.u[at..]);
            L::select(within, hit.v, zero).store(&mut hits.v[at..]);
        }
    }
}

/// Threads that trace.
pub struct Team(Threads<Tracer>);

impl Team {
    /// # Panics
    /// If there are to be no threads, or the system refuses them.
    pub fn new(threads: usize) -> Self {
        Self(Threads::new(threads, Tracer::new))
    }
    pub fn threads(&self) -> usize {
        self.0.count()
    }
    /// Runs something on the team's threads. Called around [`Team::forget`] and [`Team::trace`], it finds them awake.
    pub fn run<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        self.0.run(run)
    }
    /// Nothing found yet, again.
    pub fn forget(&self, set: &RaySet, answers: &mut Answers) {
        self.each_chunk(set.len(), answers, |first, hits| {
            hits.t.copy_from_slice(&set.t_max[first..first + hits.t.len()]);
            hits.primitive.fill(MISS);
            hits.u.fill(0.0);
            hits.v.fill(0.0);
        });
    }
    /// Finds what the rays hit; with `ANY`, whether they hit something.
    pub fn trace<const ANY: bool>(&self, way: Way, ground: &Ground, set: &RaySet, answers: &mut Answers) {
        self.each_chunk(set.len(), answers, |first, hits| {
            self.trace_chunk::<ANY>(way, ground, set, first, hits);
        });
    }

    /// Never in line: `perf/stat.sh` knows it by name.
    #[inline(never)]
    fn trace_chunk<const ANY: bool>(
        &self,
        way: Way,
        ground: &Ground,
        set: &RaySet,
        first: usize,
        hits: &mut Hits,
    ) {
        let range = first..first + hits.t.len();
        ground.trace::<ANY>(way, &mut self.0.local(), &set.rays().range(range), hits);
    }

    /// All answers at once on one thread, and in chunks on more; `work` is told the number of its first ray.
    fn each_chunk(&self, rays: usize, answers: &mut Answers, work: impl Fn(usize, &mut Hits) + Sync) {
        if self.0.is_single() {
            return work(0, &mut answers.hits());
        }
        debug_assert_eq!(rays, answers.t.len());
        let Answers { t, primitive, u, v } = answers;
        let columns = (
            t.par_chunks_mut(CHUNK),
            primitive.par_chunks_mut(CHUNK),
            u.par_chunks_mut(CHUNK),
            v.par_chunks_mut(CHUNK),
        );
        columns.into_par_iter().enumerate().for_each(|(chunk, (t, primitive, u, v))| {
            work(chunk * CHUNK, &mut Hits { t, primitive, u, v });
        });
    }
}
