//! Second stage: what every ray of the queue hits.

use super::World;
use super::queue::{Column, Integers, Queue, Vectors, Work};
use super::stats::RayKind;
use super::surface::has;
use crate::buffers::Features;
use crate::lane::{Bits, Lane};
use crate::math::{Hit, MISS, Ray};
use crate::traverse::batch::{Tracer, Traversal};
use crate::traverse::counter::Counter;
use crate::traverse::hierarchy::Hierarchy;
use crate::traverse::rays::{Hits, Rays};
use crate::traverse::{Batch, Visible};

/// Finds the nearest hit of the first `count` rays.
pub fn extend<L: Lane, const N: u32>(world: &World, work: &mut Work, count: usize) {
    if let Some((hierarchy, traversal)) = world.primitives.hierarchy() {
        work.trace(hierarchy, traversal, count, RayKind::Bounce);
    } else if world.primitives.uses_default_methods() {
        let stage = Stage::<N> { queue: &mut work.queue, count };
        world.primitives.for_default_batch::<L>(&world.buffers, None, stage);
    } else {
        meet::<L>(world, None, work.queue.segments(count));
    }
}

struct Stage<'a, const N: u32> {
    queue: &'a mut Queue,
    count: usize,
}

impl<L: Lane, const N: u32> Batch<L> for Stage<'_, N> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        for at in (0..self.count).step_by(L::WIDTH) {
            let hit = closest(&self.queue.ray(at));
            self.queue.store_hit(at, &hit, has(N, Features::TRIANGLES));
        }
    }
}

/// Rays, and where their hits go.
pub struct Segments<'a> {
    pub count: usize,
    pub origin: &'a Vectors,
    pub direction: &'a Vectors,
    /// From where on nothing counts as hit; without it everything does.
    pub t_max: Option<&'a Column>,
    pub t: &'a mut Column,
    pub primitive: &'a mut Integers,
    pub u: &'a mut Column,
    pub v: &'a mut Column,
}

impl Segments<'_> {
    /// Finds nearest hits in a hierarchy, or with `ANY` only whether there are some.
    #[inline(always)]
    pub fn trace<const ANY: bool>(
        self,
        tracer: &mut Tracer,
        hierarchy: &Hierarchy,
        traversal: Traversal,
        counter: Option<&Counter>,
    ) {
        let Segments { count, origin, direction, t_max, t, primitive, u, v } = self;
        let rays = Rays { origin: origin.first(count), direction: direction.first(count) };
        let [t, u, v] = [t, u, v].map(|column| &mut column[..count]);
        let primitive = &mut primitive[..count];
        match t_max {
            Some(t_max) => t.copy_from_slice(&t_max[..count]),
            None => t.fill(f32::INFINITY),
        }
        primitive.fill(MISS);
        if !ANY {
            // Spheres and misses have none.
            u.fill(0.0);
            v.fill(0.0);
        }
        let mut hits = Hits { t, primitive, u, v };
        match counter {
            None => tracer.trace::<ANY>(traversal, hierarchy, &rays, &mut hits),
            Some(counter) => tracer.count::<ANY>(traversal, hierarchy, &rays, &mut hits, counter),
        }
    }
}

/// Finds nearest hits by testing everything, or everything `visible`, with whichever equations were chosen.
///
/// One for all pipelines: six pairs of methods are much code.
#[inline(never)]
pub fn meet<L: Lane>(world: &World, visible: Option<&Visible>, segments: Segments) {
    world.primitives.for_batch::<L>(&world.buffers, visible, segments);
}

impl<L: Lane> Batch<L> for Segments<'_> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        for at in (0..self.count).step_by(L::WIDTH) {
            let mut hit = closest(&Ray { origin: self.origin.load(at), direction: self.direction.load(at) });
            if let Some(t_max) = self.t_max {
                let before = hit.t.lt(L::load(&t_max[at..]));
                hit.primitive = L::Bits::select(before, hit.primitive, L::Bits::splat(MISS));
            }
            hit.t.store(&mut self.t[at..]);
            hit.primitive.store(&mut self.primitive[at..]);
            hit.u.store(&mut self.u[at..]);
            hit.v.store(&mut self.v[at..]);
        }
    }
}
