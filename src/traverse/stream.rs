//! Many rays down the tree together: each node is read once for all rays that reach it, and its planes stay in registers.
//!
//! A batch of rays is sorted by octant, so that all of them meet the planes of a box in the same order. At a node each ray of its list is
//! tested against eight boxes; the masks are compressed into a list of rays for each child. Children follow in the order of their mean entry
//! distance. Lists too short to pay go on as single rays.
//!
//! Source: Tsakok, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG 2009.

use super::hierarchy::{Hierarchy, SingleRay};
use super::rays::{Hits, Rays};
use super::single::{self, Stack};
use crate::bvh::{Child, WIDE};
use crate::kernel::ray_box::Slabs;
use crate::kernel::ray_triangle::WoopRay;
use crate::lane::{Bits, F32x8, Lane, Mask, U32x8};
use crate::math::{Hit, MISS};

/// Rays of a batch: their records fill half of a second-level cache.
pub const BATCH: usize = 4096;
/// Lists of at most so many rays go on one by one.
const FEW: usize = 3;

/// What a ray keeps through its batch: two cache lines, of which boxes need the first.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Record {
    slabs: Slabs<f32>,
    /// Found so far; how far the ray reaches, and −∞ where it wants nothing more.
    t: f32,
    primitive: u32,
    u: f32,
    v: f32,
    /// Which of the rays it is.
    source: u32,
    woop: WoopRay<f32>,
}

/// Working memory of a thread: about 0.6 MiB.
pub struct Stream {
    records: Vec<Record>,
    /// Lists of rays, one after the other, like a stack.
    lists: Vec<u32>,
    /// The boxes that each ray of a list passes, one bit a box.
    masks: Vec<u32>,
    stack: Stack,
}

impl Default for Stream {
    fn default() -> Self {
        Self::new()
    }
}

impl Stream {
    pub fn new() -> Self {
        Self {
            records: Vec::with_capacity(BATCH),
            lists: Vec::new(),
            masks: vec![0; BATCH + WIDE],
            stack: Stack::new(),
        }
    }

    /// Improves the hits of all rays; with `ANY`, each ends at the first hit found.
    pub fn trace<const ANY: bool>(&mut self, hierarchy: &Hierarchy, rays: &Rays, hits: &mut Hits) {
        for first in (0..rays.len()).step_by(BATCH) {
            let count = BATCH.min(rays.len() - first);
            self.batch::<ANY>(
                hierarchy,
                &rays.range(first..first + count),
                &mut hits.range(first..first + count),
            );
        }
    }

    fn batch<const ANY: bool>(&mut self, hierarchy: &Hierarchy, rays: &Rays, hits: &mut Hits) {
        self.records.clear();
        let mut octants = [0usize; 9];
        let octant = |at: usize| {
            let sign = |column: &[f32]| usize::from(column[at].is_sign_negative());
            let [x, y, z] = &rays.direction;
            sign(x) | sign(y) << 1 | sign(z) << 2
        };
        for at in 0..rays.len() {
            let ray = rays.single(at, hierarchy.reach);
            let Hit { t, primitive, u, v } = hits.get(at);
            let SingleRay { slabs, woop, .. } = ray;
            self.records.push(Record { slabs, t, primitive, u, v, source: at as u32, woop });
            octants[octant(at) + 1] += 1;
        }
        for octant in 0..8 {
            octants[octant + 1] += octants[octant];
        }
        let starts = octants;
        self.lists.clear();
        self.lists.resize(rays.len() + WIDE, 0);
        for at in 0..rays.len() {
            let place = &mut octants[octant(at)];
            self.lists[*place] = at as u32;
            *place += 1;
        }
        for octant in 0..8 {
            let (start, end) = (starts[octant], starts[octant + 1]);
            if start < end {
                let mut walk = Walk { stream: self, hierarchy, rays, octant };
                walk.node::<ANY>(0, start, end - start, rays.len() + WIDE);
            }
        }
        for record in &self.records {
            let &Record { t, primitive, u, v, source, .. } = record;
            hits.set(source as usize, &Hit { t, primitive, u, v });
        }
    }
}

/// One octant of a batch on its way down.
struct Walk<'a> {
    stream: &'a mut Stream,
    hierarchy: &'a Hierarchy,
    rays: &'a Rays<'a>,
    octant: usize,
}

impl Walk<'_> {
    /// The `count` rays listed from `start` on, through a node; `free` is where new lists may start.
    fn node<const ANY: bool>(&mut self, node: usize, start: usize, count: usize, free: usize) {
        let node = &self.hierarchy.bvh.wide[node];
        let Stream { records, lists, masks, .. } = &mut *self.stream;
        let planes = node.planes();
        let first = |axis: usize| F32x8::load(&planes[axis + 3 * (self.octant >> axis & 1)]);
        let second = |axis: usize| F32x8::load(&planes[axis + 3 * (1 - (self.octant >> axis & 1))]);
        let (first, second) = ([first(0), first(1), first(2)], [second(0), second(1), second(2)]);
        let mut distances = F32x8::zero();
        let mut all = 0;
        for (mask, &ray) in masks.iter_mut().zip(&lists[start..start + count]) {
            let Record { slabs, t, .. } = &records[ray as usize];
            let [x, y, z] = [slabs.inverse.x, slabs.inverse.y, slabs.inverse.z].map(F32x8::splat);
            let splat = F32x8::splat;
            let near = first[0]
                .mul_add(x, splat(slabs.near.x))
                .max(first[1].mul_add(y, splat(slabs.near.y)))
                .max(first[2].mul_add(z, splat(slabs.near.z)))
                .max(F32x8::zero());
            let far = second[0]
                .mul_add(x, splat(slabs.far.x))
                .min(second[1].mul_add(y, splat(slabs.far.y)))
                .min(second[2].mul_add(z, splat(slabs.far.z)))
                .min(splat(*t));
            let passes = near.le(far);
            distances = distances + F32x8::select(passes, near, F32x8::zero());
            *mask = passes.bitmask();
            all |= *mask;
        }
        if all == 0 {
            return;
        }
        // One list for each child that some ray reaches.
        let most = (all.count_ones() as usize) * (count + WIDE);
        if lists.len() < free + most {
            lists.resize(free + most, 0);
        }
        let mut children = [(0.0, Child::NONE, 0usize, 0usize); WIDE];
        let mut reached = 0;
        let mut top = free;
        let mut left = all;
        while left != 0 {
            let slot = (left.trailing_zeros() & 7) as usize;
            left &= left - 1;
            let bit = U32x8::splat(1 << slot);
            let begin = top;
            for at in (0..count).step_by(8) {
                // The last packet may hold rays of no list: their masks are not of this node.
                let valid = <F32x8 as Lane>::Mask::first(count - at);
                let passes = !(U32x8::load(&masks[at..]) & bit).equals(U32x8::splat(0)) & valid;
                let packing = F32x8::packing(passes);
                let rays = U32x8::load(&lists[start + at..]);
                F32x8::pack_bits(rays, packing).store(&mut lists[top..]);
                top += passes.count();
            }
            let listed = top - begin;
            let mean = distances.get(slot) / listed as f32;
            children[reached] = (mean, node.children()[slot], begin, listed);
            reached += 1;
        }
        let children = &mut children[..reached];
        if !ANY {
            children.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        }
        for &(_, child, begin, listed) in children.iter() {
            if child.is_leaf() {
                self.leaf::<ANY>(child, begin, listed);
            } else if listed <= FEW {
                self.one_by_one::<ANY>(child, begin, listed);
            } else {
                self.node::<ANY>(child.index(), begin, listed, top + WIDE);
            }
        }
    }

    #[inline(always)]
    fn meet<const ANY: bool>(&mut self, ray: usize, meet: impl FnOnce(&mut Stream, &Record, &mut Hit<f32>)) {
        let record = self.stream.records[ray];
        let mut hit = Hit { t: record.t, primitive: record.primitive, u: record.u, v: record.v };
        meet(self.stream, &record, &mut hit);
        let record = &mut self.stream.records[ray];
        (record.t, record.primitive, record.u, record.v) = (hit.t, hit.primitive, hit.u, hit.v);
        if ANY && hit.primitive != MISS {
            record.t = f32::NEG_INFINITY;
        }
    }

    fn leaf<const ANY: bool>(&mut self, leaf: Child, start: usize, count: usize) {
        let (hierarchy, rays) = (self.hierarchy, self.rays);
        for at in start..start + count {
            let ray = self.stream.lists[at] as usize;
            if ANY && self.stream.records[ray].t < 0.0 {
                continue;
            }
            if leaf.is_spheres() {
                let single = rays.packet::<f32>(self.stream.records[ray].source as usize);
                self.meet::<ANY>(ray, |_, _, hit| hierarchy.meet_spheres(leaf.index(), &single, hit));
            } else {
                self.meet::<ANY>(ray, |_, record, hit| {
                    hierarchy.meet_triangles(leaf.index(), &record.woop, &record.slabs, hit);
                });
            }
        }
    }

    fn one_by_one<const ANY: bool>(&mut self, child: Child, start: usize, count: usize) {
        let (hierarchy, rays) = (self.hierarchy, self.rays);
        for at in start..start + count {
            let ray = self.stream.lists[at] as usize;
            if ANY && self.stream.records[ray].t < 0.0 {
                continue;
            }
            self.meet::<ANY>(ray, |stream, record, hit| {
                let ray = rays.packet::<f32>(record.source as usize);
                let single = SingleRay { ray, slabs: record.slabs, woop: record.woop };
                single::trace_from::<ANY>(hierarchy, child, &single, &mut stream.stack, hit);
            });
        }
    }
}
