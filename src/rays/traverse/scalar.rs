//! Traces one ray through the binary tree, one box and one primitive at a time, without SIMD: the baseline of
//! every reported speed-up.

use super::counter::CounterSink;
use super::hierarchy::Hierarchy;
use super::stack::pop_within;
use crate::bvh::{Child, MAX_DEPTH};
use crate::kernel::ray_box::BoxRay;
use crate::math::{Hit, MISS, Vec3};
use crate::prepared::SingleRay;

/// Improves `hit`, whose `t` is at first the ray's t_max; with `ANY`, ends at the first hit found.
///
/// # Panics
/// If the hierarchy has no binary tree ([`crate::bvh::Trees::Wide`]).
pub fn trace<const ANY: bool>(
    hierarchy: &Hierarchy,
    ray: &SingleRay,
    hit: &mut Hit<f32>,
    counter: impl CounterSink,
) {
    let nodes = &hierarchy.bvh.binary;
    let mut stack = [(0u32, 0f32); MAX_DEPTH as usize + 2];
    let mut len = 0;
    let upwards = u32::from(ray.ray.direction.x > 0.0)
        | u32::from(ray.ray.direction.y > 0.0) << 1
        | u32::from(ray.ray.direction.z > 0.0) << 2;
    let enter = |node: usize, t_max: f32| -> f32 {
        let bounds = nodes[node].bounds();
        let corner = |v: glam::Vec3| Vec3::new(v.x, v.y, v.z);
        entry(&ray.box_ray, corner(bounds.lo), corner(bounds.hi), t_max)
    };
    counter.boxes(1, 1);
    if enter(0, hit.t).is_nan() {
        return;
    }
    let mut node = 0;
    loop {
        let child = nodes[node].child();
        if child.is_leaf() {
            if child != Child::NONE {
                counter.leaf_one_by_one(hierarchy, child);
                hierarchy.intersect_leaf_one_by_one(child, ray, hit);
                if ANY && hit.primitive != MISS {
                    return;
                }
            }
        } else {
            let (left, right) = (node + 1, child.index());
            let (first, second) = if nodes[node].left_first(upwards) { (left, right) } else { (right, left) };
            counter.boxes(2, 2);
            let (near, far) = (enter(first, hit.t), enter(second, hit.t));
            if near <= hit.t {
                if far <= hit.t {
                    stack[len] = (second as u32, far);
                    len += 1;
                }
                node = first;
                continue;
            }
            if far <= hit.t {
                node = second;
                continue;
            }
        }
        match pop_within(&mut len, hit.t, |at| stack[at]) {
            Some(next) => node = next as usize,
            None => return,
        }
    }
}

/// Returns the distance at which the ray enters a box; NaN if it does not pass the box before `t_max`.
#[inline(always)]
fn entry(box_ray: &BoxRay<f32>, lo: Vec3<f32>, hi: Vec3<f32>, t_max: f32) -> f32 {
    let (near, far) = box_ray.pass(lo, hi);
    let near = near.max(0.0);
    if near <= far && near <= t_max { near } else { f32::NAN }
}
