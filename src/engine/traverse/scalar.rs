//! One ray on the binary tree, one box and one primitive at a time: the honest baseline.

use super::hierarchy::{Hierarchy, SingleRay};
use super::tally::Tally;
use crate::bvh::{Child, MAX_DEPTH};
use crate::kernel::ray_box::Slabs;
use crate::math::{Hit, MISS, Vec3};

/// Improves `hit`, which comes in with the ray's reach; with `ANY`, ends at the first hit found.
pub fn trace<const ANY: bool>(hierarchy: &Hierarchy, ray: &SingleRay, hit: &mut Hit<f32>, tally: impl Tally) {
    let nodes = &hierarchy.bvh.binary;
    let mut stack = [(0u32, 0f32); MAX_DEPTH as usize + 2];
    let mut waiting = 0;
    let upwards = u32::from(ray.ray.direction.x > 0.0)
        | u32::from(ray.ray.direction.y > 0.0) << 1
        | u32::from(ray.ray.direction.z > 0.0) << 2;
    let enter = |node: usize, padding: f32| -> f32 {
        let bounds = nodes[node].bounds();
        let corner = |v: glam::Vec3| Vec3::new(v.x, v.y, v.z);
        entry(&ray.slabs, corner(bounds.lo), corner(bounds.hi), padding)
    };
    tally.boxes(1, 1);
    if enter(0, hit.t).is_nan() {
        return;
    }
    let mut node = 0;
    loop {
        let child = nodes[node].child();
        if child.is_leaf() {
            if child != Child::NONE {
                tally.leaf_one_by_one(hierarchy, child);
                hierarchy.meet_leaf_one_by_one(child, ray, hit);
                if ANY && hit.primitive != MISS {
                    return;
                }
            }
        } else {
            let (left, right) = (node + 1, child.index());
            let (first, second) = if nodes[node].left_first(upwards) { (left, right) } else { (right, left) };
            tally.boxes(2, 2);
            let (near, far) = (enter(first, hit.t), enter(second, hit.t));
            if near <= hit.t {
                if far <= hit.t {
                    stack[waiting] = (second as u32, far);
                    waiting += 1;
                }
                node = first;
                continue;
            }
            if far <= hit.t {
                node = second;
                continue;
            }
        }
        loop {
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            let (next, near) = stack[waiting];
            if near <= hit.t {
                node = next as usize;
                break;
            }
        }
    }
}

/// Where the ray enters a box within its reach; NaN or beyond the reach where it does not.
#[inline(always)]
fn entry(slabs: &Slabs<f32>, lo: Vec3<f32>, hi: Vec3<f32>, padding: f32) -> f32 {
    let (near, far) = slabs.pass(lo, hi);
    let near = near.max(0.0);
    if near <= far && near <= padding { near } else { f32::NAN }
}
