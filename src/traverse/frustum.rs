//! Camera rays by the tile: a frustum around many rays is tested once where each ray would be.
//!
//! A tile's frustum descends first, always opening the largest box, until eight entries are left that together hold all that the tile can see:
//! its cut. No entry, and the tile is empty. Each packet then starts at the cut with a frustum of its own and goes down nearest first;
//! boxes are held against the frustum alone. In a leaf the triangles outside the frustum are left out, and the packet meets the rest
//! one by one.
//!
//! Conservative: a ray that passes a padded box ([`crate::kernel::ray_box::Slabs`]) meets it within (|o| + E) 2⁻²⁰; the frustum leaves twice that.
//!
//! Source: Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005.

use super::hierarchy::{Hierarchy, Packet};
use super::rays::{Hits, Rays};
use super::single::Stack;
use crate::bvh::{Child, WIDE, WideNode};
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8, U32x8};
use crate::math::{Hit, Ray, Vec3};

/// Rays of a tile.
pub const TILE: usize = 256;

/// Around rays with one origin: between two slopes along each of two axes, per step along the third.
#[derive(Clone, Copy)]
struct Frustum {
    /// The axis along which all rays run, then the other two.
    axes: [usize; 3],
    /// The rays run downwards along the first axis.
    backwards: bool,
    origin: [f32; 3],
    /// How much further boxes reach on every side.
    padding: f32,
    /// Least and largest slope along the other two axes.
    slopes: [[f32; 2]; 2],
}

fn axis_of<L: Copy>(v: Vec3<L>, axis: usize) -> L {
    [v.x, v.y, v.z][axis]
}

fn lowest(x: F32x8) -> f32 {
    let lanes: [f32; 8] = bytemuck::cast(x);
    let pairs = [0, 1, 2, 3].map(|i| if lanes[i] < lanes[i + 4] { lanes[i] } else { lanes[i + 4] });
    let low = if pairs[0] < pairs[2] { pairs[0] } else { pairs[2] };
    let high = if pairs[1] < pairs[3] { pairs[1] } else { pairs[3] };
    if low < high { low } else { high }
}

impl Frustum {
    /// The frustum's axes for rays like this one, without slopes yet.
    fn along(direction: Vec3<f32>, origin: Vec3<f32>, hierarchy: &Hierarchy) -> Self {
        let d = [direction.x, direction.y, direction.z];
        let size = d.map(f32::abs);
        let main = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else if size[1] >= size[2] {
            1
        } else {
            2
        };
        let axes = [main, (main + 1) % 3, (main + 2) % 3];
        let far = origin.x.abs().max(origin.y.abs()).max(origin.z.abs());
        let padding = (hierarchy.reach.room(origin) + far) * f32::powi(0.5, 19);
        let origin = [origin.x, origin.y, origin.z];
        Self { axes, backwards: d[main] < 0.0, origin, padding, slopes: [[0.0; 2]; 2] }
    }

    /// The slopes of a packet's rays; `None` where one does not run along the frustum's axis.
    #[inline(always)]
    fn slopes(&self, ray: &Ray<F32x8>) -> Option<[F32x8; 2]> {
        let main = axis_of(ray.direction, self.axes[0]);
        let main = if self.backwards { -main } else { main };
        let same_origin = (0..3).fold(Mask8::splat(true), |same, axis| {
            same & axis_of(ray.origin, axis).eq(F32x8::splat(self.origin[axis]))
        });
        // A slope of more than 2²⁰ has no use for a frustum.
        let others =
            axis_of(ray.direction, self.axes[1]).abs().max(axis_of(ray.direction, self.axes[2]).abs());
        let runs = (others * F32x8::splat(f32::powi(0.5, 20))).lt(main);
        if !(same_origin & runs).all() {
            return None;
        }
        let inverse = F32x8::one() / main;
        Some([1, 2].map(|i| axis_of(ray.direction, self.axes[i]) * inverse))
    }

    /// Between these slopes, and a little more for the rounding of slopes and products: 8 ε of the larger one.
    #[inline(always)]
    fn between(self, low: [F32x8; 2], high: [F32x8; 2]) -> Self {
        let slopes = [0, 1].map(|i| {
            let (low, high) = (lowest(low[i]), -lowest(-high[i]));
            let more = low.abs().max(high.abs()) * f32::powi(0.5, 21);
            [low - more, high + more]
        });
        Self { slopes, ..self }
    }

    /// How far along its axis the frustum meets each of eight boxes, given by their lower and upper planes along an axis, and which
    /// of them it meets before `limit`.
    #[inline(always)]
    fn pass(&self, planes: impl Fn(usize) -> (F32x8, F32x8), limit: f32) -> (F32x8, Mask8) {
        let splat = F32x8::splat;
        let [main, ..] = self.axes;
        let (lo, hi) = planes(main);
        let (inner, outer) =
            (splat(self.origin[main] + self.padding), splat(self.origin[main] - self.padding));
        let (near, far) = if self.backwards { (outer - hi, inner - lo) } else { (lo - inner, hi - outer) };
        let near = near.max(F32x8::zero());
        let mut meets = near.le(far.min(splat(limit)));
        for i in 0..2 {
            let axis = self.axes[i + 1];
            let (lo, hi) = planes(axis);
            let (lo, hi) =
                (lo - splat(self.origin[axis] + self.padding), hi - splat(self.origin[axis] - self.padding));
            let [low, high] = self.slopes[i].map(splat);
            meets = meets & (low * near).min(low * far).le(hi) & lo.le((high * near).max(high * far));
        }
        (near, meets)
    }

    /// [`Frustum::pass`] of a node's boxes.
    #[inline(always)]
    fn pass_node(&self, planes: &[[f32; WIDE]; 6], limit: f32) -> (F32x8, Mask8) {
        self.pass(|axis| (F32x8::load(&planes[axis]), F32x8::load(&planes[axis + 3])), limit)
    }
}

/// Up to eight entries that together hold all that a tile can see.
struct Cut {
    planes: [[f32; WIDE]; 6],
    children: [Child; WIDE],
    filled: usize,
}

impl Cut {
    /// The entries below the root, or nothing where the frustum meets nothing.
    fn of(hierarchy: &Hierarchy, frustum: &Frustum) -> Option<Self> {
        let mut cut = Self { planes: *WideNode::EMPTY.planes(), children: [Child::NONE; WIDE], filled: 0 };
        let mut open = Some(Child(0));
        while let Some(node) = open {
            let node = &hierarchy.bvh.wide[node.index()];
            let (_, meets) = frustum.pass_node(node.planes(), f32::INFINITY);
            let mut lanes = meets.bitmask();
            while lanes != 0 {
                let lane = (lanes.trailing_zeros() & 7) as usize;
                lanes &= lanes - 1;
                cut.put(cut.filled, node.planes().map(|plane| plane[lane]), node.children()[lane]);
                cut.filled += 1;
            }
            open = cut.take_largest(hierarchy, frustum);
        }
        (cut.filled > 0).then_some(cut)
    }

    fn put(&mut self, slot: usize, planes: [f32; 6], child: Child) {
        self.planes.iter_mut().zip(planes).for_each(|(plane, value)| plane[slot] = value);
        self.children[slot] = child;
    }

    /// Takes out the node with the largest box whose children find room.
    fn take_largest(&mut self, hierarchy: &Hierarchy, frustum: &Frustum) -> Option<Child> {
        let [a, b, c, x, y, z] = self.planes;
        let area = |i: usize| {
            let (x, y, z) = (x[i] - a[i], y[i] - b[i], z[i] - c[i]);
            x * y + y * z + z * x
        };
        let nodes = (0..self.filled).filter(|&i| !self.children[i].is_leaf());
        let largest = nodes.max_by(|&i, &j| area(i).total_cmp(&area(j)))?;
        let child = self.children[largest];
        let (_, meets) = frustum.pass_node(hierarchy.bvh.wide[child.index()].planes(), f32::INFINITY);
        if self.filled - 1 + meets.count() > WIDE {
            return None;
        }
        let last = self.filled - 1;
        self.put(largest, self.planes.map(|plane| plane[last]), self.children[last]);
        self.put(last, WideNode::EMPTY.planes().map(|plane| plane[0]), Child::NONE);
        self.filled = last;
        Some(child)
    }
}

/// A packet on its way down.
struct Walk<'a> {
    hierarchy: &'a Hierarchy,
    frustum: Frustum,
    packet: Packet,
    hit: Hit<F32x8>,
    /// How far along the frustum's axis there may be nearer hits.
    limit: f32,
}

impl Walk<'_> {
    /// Visits what waits on the stack, and what is below it.
    fn run(&mut self, stack: &mut Stack, mut waiting: usize) {
        while waiting > 0 {
            waiting -= 1;
            let (child, near) = stack.get(waiting);
            if near > self.limit {
                continue;
            }
            if child.is_leaf() {
                self.leaf(child);
            } else {
                let node = &self.hierarchy.bvh.wide[child.index()];
                let (near, meets) = self.frustum.pass_node(node.planes(), self.limit);
                waiting += stack.put(waiting, node.children(), near, meets);
            }
        }
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Child) {
        if leaf.is_spheres() {
            self.hierarchy.packet_meets_spheres(leaf.index(), &self.packet.ray, &mut self.hit);
            self.shorten();
            return;
        }
        let leaf = self.hierarchy.triangle_leaf(leaf.index());
        let (_, meets) = self.frustum.pass(|axis| leaf.planes(axis), self.limit);
        let mut lanes = meets.bitmask();
        let mut closer = false;
        while lanes != 0 {
            let lane = (lanes.trailing_zeros() & 7) as usize;
            lanes &= lanes - 1;
            closer |= leaf.packet_meets(lane, &self.packet, &mut self.hit);
        }
        if closer {
            self.shorten();
        }
    }

    /// Measures again how far the packet's rays reach along the axis: their furthest hit, and a little more for rounding.
    #[inline(never)]
    fn shorten(&mut self) {
        let along = axis_of(self.packet.ray.direction, self.frustum.axes[0]).abs();
        self.limit = -lowest(-(self.hit.t * along)) * (1.0 + 4.0 * f32::EPSILON);
    }
}

/// Improves the hits of up to [`TILE`] camera rays, which come in with the rays' reach; says no and does nothing if they do not
/// run together from one origin.
pub fn trace_tile(hierarchy: &Hierarchy, rays: &Rays, hits: &mut Hits, stack: &mut Stack) -> bool {
    let count = rays.len();
    if !count.is_multiple_of(8) || !(8..=TILE).contains(&count) {
        return false;
    }
    let first = rays.packet::<f32>(0);
    let axes = Frustum::along(first.direction, first.origin, hierarchy);
    let mut slopes = [[F32x8::zero(); 2]; TILE / 8];
    let (mut low, mut high) = ([F32x8::splat(f32::INFINITY); 2], [F32x8::splat(f32::NEG_INFINITY); 2]);
    for (packet, slopes) in slopes[..count / 8].iter_mut().enumerate() {
        let ray = rays.packet::<F32x8>(packet * 8);
        let Some(of_packet) = axes.slopes(&ray) else { return false };
        *slopes = of_packet;
        for i in 0..2 {
            (low[i], high[i]) = (low[i].min(of_packet[i]), high[i].max(of_packet[i]));
        }
    }
    let tile = axes.between(low, high);
    let Some(cut) = Cut::of(hierarchy, &tile) else { return true };
    for (packet, &slopes) in slopes[..count / 8].iter().enumerate() {
        let at = packet * 8;
        let ray = rays.packet::<F32x8>(at);
        let hit = Hit {
            t: F32x8::load(&hits.t[at..]),
            primitive: U32x8::load(&hits.primitive[at..]),
            u: F32x8::load(&hits.u[at..]),
            v: F32x8::load(&hits.v[at..]),
        };
        let frustum = axes.between(slopes, slopes);
        let (near, meets) = frustum.pass_node(&cut.planes, f32::INFINITY);
        if !meets.any() {
            continue;
        }
        let waiting = stack.put(0, &cut.children, near, meets);
        let packet = Packet::new(ray, hierarchy.reach);
        let mut walk = Walk { hierarchy, frustum, packet, hit, limit: f32::INFINITY };
        walk.run(stack, waiting);
        walk.hit.t.store(&mut hits.t[at..]);
        walk.hit.primitive.store(&mut hits.primitive[at..]);
        walk.hit.u.store(&mut hits.u[at..]);
        walk.hit.v.store(&mut hits.v[at..]);
    }
    true
}
