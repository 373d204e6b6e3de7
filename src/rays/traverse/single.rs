//! Tests one ray against all boxes of a wide node at once.
//!
//! For incoherent rays: each step tests the boxes of a node, pushes those that the ray passes onto a stack by
//! one compressed store, and continues with the nearest.

use super::counter::CounterSink;
use super::hierarchy::Hierarchy;
use super::stack::{Stack, pop_within};
use crate::bvh::{Child, WIDE, WideNode};
use crate::kernel::ray_box::BoxRay;
use crate::lane::{Lane, Mask, Native, NativeMask};
use crate::math::{Hit, MISS, Vec3};
use crate::prepared::{SingleRay, splat_box_ray};

/// A ray in all lanes, and the rows of a node's planes in the order in which the ray meets them. The order is
/// chosen once per ray by the direction's signs; [`BoxRay::pass`] chooses it for each box.
#[derive(Clone, Copy)]
pub(super) struct NodeRay {
    box_ray: BoxRay<Native>,
    first: [usize; 3],
    second: [usize; 3],
}

impl NodeRay {
    #[inline(always)]
    pub fn new(box_ray: &BoxRay<f32>) -> Self {
        let Vec3 { x, y, z } = box_ray.inverse;
        let backwards = [x, y, z].map(|inverse| usize::from(inverse < 0.0));
        Self {
            box_ray: splat_box_ray(box_ray),
            first: std::array::from_fn(|axis| axis + 3 * backwards[axis]),
            second: std::array::from_fn(|axis| axis + 3 * (1 - backwards[axis])),
        }
    }

    /// Returns the entry distances into the node's boxes, and which of them the ray passes before `t_max`.
    #[inline(always)]
    pub fn pass(&self, node: &WideNode, t_max: f32) -> (Native, NativeMask) {
        let planes = node.planes();
        let rows = |[x, y, z]: [usize; 3]| {
            Vec3::new(Native::load(&planes[x]), Native::load(&planes[y]), Native::load(&planes[z]))
        };
        let (near, far) = self.box_ray.interval(rows(self.first), rows(self.second));
        // min and max return their second operand if one is NaN: in this order a NaN is kept and passes no
        // box, not even an empty one.
        let entry = Native::zero().max(near);
        let exit = Native::splat(t_max).min(far);
        (entry, entry.le(exit))
    }
}

/// Improves `hit`, whose `t` is at first the ray's t_max; with `ANY`, ends at the first hit found.
pub fn trace<const ANY: bool>(
    hierarchy: &Hierarchy,
    ray: &SingleRay,
    stack: &mut Stack,
    hit: &mut Hit<f32>,
    counter: impl CounterSink,
) {
    descend(hierarchy, ray, stack, hit, counter, |leaf, hit| {
        hierarchy.intersect_leaf(leaf, ray, hit);
        ANY && hit.primitive != MISS
    });
}

/// Visits the leaves whose boxes a ray passes before its hit, nearest first, until `visit` returns true.
#[inline(always)]
pub(super) fn descend(
    hierarchy: &Hierarchy,
    ray: &SingleRay,
    stack: &mut Stack,
    hit: &mut Hit<f32>,
    counter: impl CounterSink,
    mut visit: impl FnMut(Child, &mut Hit<f32>) -> bool,
) {
    let box_ray = NodeRay::new(&ray.box_ray);
    let mut len = 0;
    let mut next = Child(0);
    loop {
        if next.is_leaf() {
            counter.leaf(hierarchy, next, 1);
            if visit(next, hit) {
                return;
            }
        } else {
            let node = &hierarchy.bvh.wide[next.index()];
            counter.node(node, 1);
            let (entry, passes) = box_ray.pass(node, hit.t);
            let passed = passes.count();
            if passed == 1 {
                // The mask lets the compiler drop the bounds check.
                let lane = (passes.bitmask().trailing_zeros() & (WIDE as u32 - 1)) as usize;
                next = node.children()[lane];
                continue;
            }
            if passed > 0 {
                len += stack.push(len, node.children(), entry, passes) - 1;
                (next, _) = stack.get(len);
                continue;
            }
        }
        match pop_within(&mut len, hit.t, |at| stack.get(at)) {
            Some(child) => next = child,
            None => return,
        }
    }
}
