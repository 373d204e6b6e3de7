//! One ray against the eight boxes of a wide node at once.
//!
//! For rays that have no company: each step tests eight boxes, keeps those the ray passes on a stack by one compressed store, and goes
//! on with the nearest.

use super::hierarchy::{Hierarchy, SingleRay};
use super::tally::Tally;
use crate::bvh::{Child, MAX_STACK, WIDE, WideNode};
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8, U32x8};
use crate::math::{Hit, MISS};

/// Room for the stack: a power of two, so that a mask keeps every index inside, with a packet to spare.
const STACK: usize = 512;
const _: () = assert!(MAX_STACK + WIDE <= STACK);

/// Working memory of a thread.
pub struct Stack {
    child: [u32; STACK],
    near: [f32; STACK],
}

impl Stack {
    pub fn new() -> Self {
        Self { child: [0; STACK], near: [0.0; STACK] }
    }

    /// Puts those of eight children on the stack, from place `at` on, that `passes` names; the nearest on top. Returns how many.
    #[inline(always)]
    pub fn put(&mut self, at: usize, children: &[Child; WIDE], near: F32x8, passes: Mask8) -> usize {
        let indices = F32x8::compress_indices(passes);
        let children = U32x8::load(bytemuck::cast_slice(children));
        F32x8::compress_bits(children, indices).store(&mut self.child[at & (STACK - 1)..]);
        near.compress(indices).store(&mut self.near[at & (STACK - 1)..]);
        let count = passes.count();
        if count > 1 {
            let last = at + count - 1;
            let mut nearest = last;
            for i in at..last {
                if self.near[i & (STACK - 1)] < self.near[nearest & (STACK - 1)] {
                    nearest = i;
                }
            }
            self.child.swap(nearest & (STACK - 1), last & (STACK - 1));
            self.near.swap(nearest & (STACK - 1), last & (STACK - 1));
        }
        count
    }

    /// What stands at a place, and how near it is.
    #[inline(always)]
    pub fn get(&self, at: usize) -> (Child, f32) {
        (Child(self.child[at & (STACK - 1)]), self.near[at & (STACK - 1)])
    }
}

impl Default for Stack {
    fn default() -> Self {
        Self::new()
    }
}

/// Three numbers of a ray in every lane.
type Splats = [F32x8; 3];

/// A ray in every lane, as the boxes want it.
#[derive(Clone, Copy)]
pub struct SplatSlabs {
    inverse: Splats,
    near: Splats,
    far: Splats,
    /// Which planes the ray meets first and second.
    first: [usize; 3],
    second: [usize; 3],
}

impl SplatSlabs {
    #[inline(always)]
    pub fn new(ray: &SingleRay) -> Self {
        let slabs = &ray.slabs;
        let inverse = [slabs.inverse.x, slabs.inverse.y, slabs.inverse.z];
        let backwards = inverse.map(|inverse| usize::from(inverse < 0.0));
        Self {
            inverse: inverse.map(F32x8::splat),
            near: [slabs.near.x, slabs.near.y, slabs.near.z].map(F32x8::splat),
            far: [slabs.far.x, slabs.far.y, slabs.far.z].map(F32x8::splat),
            first: std::array::from_fn(|axis| axis + 3 * backwards[axis]),
            second: std::array::from_fn(|axis| axis + 3 * (1 - backwards[axis])),
        }
    }

    /// Where the ray enters the node's boxes, and which of them it passes within its reach.
    #[inline(always)]
    fn pass(&self, node: &WideNode, padding: f32) -> (F32x8, Mask8) {
        let planes = node.planes();
        let plane = |plane: usize, axis: usize, rest: &Splats| {
            F32x8::load(&planes[plane]).mul_add(self.inverse[axis], rest[axis])
        };
        let near = |axis: usize| plane(self.first[axis], axis, &self.near);
        let far = |axis: usize| plane(self.second[axis], axis, &self.far);
        // In this order a NaN, which min and max take from their second operand, is kept and passes no box, not even an empty one.
        let entry = F32x8::zero().max(near(0).max(near(1)).max(near(2)));
        let exit = F32x8::splat(padding).min(far(0).min(far(1)).min(far(2)));
        (entry, entry.le(exit))
    }
}

/// Improves `hit`, which comes in with the ray's reach; with `ANY`, ends at the first hit found.
pub fn trace<const ANY: bool>(
    hierarchy: &Hierarchy,
    ray: &SingleRay,
    stack: &mut Stack,
    hit: &mut Hit<f32>,
    tally: impl Tally,
) {
    trace_from::<ANY>(hierarchy, Child(0), ray, stack, hit, tally);
}

/// The same below one node or leaf.
#[inline(always)]
pub fn trace_from<const ANY: bool>(
    hierarchy: &Hierarchy,
    from: Child,
    ray: &SingleRay,
    stack: &mut Stack,
    hit: &mut Hit<f32>,
    tally: impl Tally,
) {
    let slabs = SplatSlabs::new(ray);
    let mut waiting = 0;
    let mut next = from;
    loop {
        if next.is_leaf() {
            tally.leaf(hierarchy, next, 1);
            hierarchy.meet_leaf(next, ray, hit);
            if ANY && hit.primitive != MISS {
                return;
            }
        } else {
            let node = &hierarchy.bvh.wide[next.index()];
            tally.node(node, 1);
            let (entry, passes) = slabs.pass(node, hit.t);
            let passed = passes.count();
            if passed == 1 {
                let lane = (passes.bitmask().trailing_zeros() & 7) as usize;
                next = node.children()[lane];
                continue;
            }
            if passed > 0 {
                waiting += stack.put(waiting, node.children(), entry, passes) - 1;
                (next, _) = stack.get(waiting);
                continue;
            }
        }
        loop {
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            let (child, near) = stack.get(waiting);
            if near <= hit.t {
                next = child;
                break;
            }
        }
    }
}
