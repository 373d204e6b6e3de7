//! Runs the caller's own tests of primitives, on every primitive or on those that a hierarchy leaves.
//!
//! Rays of one octant descend the wide tree together. A ray visits the children that it enters in an order
//! that only its octant decides, and skips those behind its nearest hit. Its hit therefore does not depend on
//! the rays beside it, even if tests find hits outside the boxes of their primitives; such hits may differ
//! from those that testing every primitive gives.

use super::counter::{Counter, CounterSink};
use super::single::NodeRay;
use crate::bvh::{Bvh, Child, Trees, WIDE, WideNode, slots};
use crate::columns::{Hits, Rays};
use crate::coordinates::Coordinates;
use crate::kernel::ray_box::{BoxRay, Padding};
use crate::kind::Geometry;
use crate::kind::KindCounts;
use crate::lane::{Lane, Mask, Native};
use crate::math::{MISS, Ray, Vec3};
use std::sync::Arc;

/// Tests of rays against the primitives of a geometry.
pub trait PrimitiveTests: Send + Sync {
    /// Improves the hits of rays with these primitives, which are given by number, in ascending order. The
    /// nearer t wins, and the lower number on a tie: see [`crate::kind::keep_if_nearer`].
    ///
    /// Rays arrive in whole packets of `lanes`: 1, 8 or 16. The hit of a ray must depend neither on the rays
    /// beside it nor on `lanes`.
    fn improve(&self, rays: &Rays, hits: &mut Hits, primitives: &[u32], lanes: usize);
}

/// The primitives of a geometry, tested by the caller's tests.
pub(super) struct Custom {
    tests: Arc<dyn PrimitiveTests>,
    counts: KindCounts,
    /// The place of the primitives' coordinates in the world.
    pub coordinates: Coordinates,
    /// The numbers of all primitives; empty if there is a hierarchy.
    all: Vec<u32>,
    /// The hierarchy, and the padding of its boxes.
    tree: Option<(Bvh, Padding)>,
}

impl Custom {
    pub fn list(geometry: &Geometry, tests: Arc<dyn PrimitiveTests>) -> Self {
        let (counts, coordinates) = (geometry.counts(), geometry.coordinates);
        Self { tests, counts, coordinates, all: (0..counts.total() as u32).collect(), tree: None }
    }

    pub fn tree(geometry: &Geometry, tests: Arc<dyn PrimitiveTests>) -> Self {
        let tree = (Bvh::new(geometry, Trees::Wide), geometry.padding());
        Self { all: Vec::new(), tree: Some(tree), ..Self::list(geometry, tests) }
    }

    pub fn bvh(&self) -> Option<&Bvh> {
        self.tree.as_ref().map(|(bvh, _)| bvh)
    }

    /// Improves the hits of rays in packets of `lanes`. With `any`, each ray ends at its first hit.
    pub fn trace(&self, any: bool, lanes: usize, rays: &Rays, hits: &mut Hits, counter: Option<&Counter>) {
        let Some((bvh, padding)) = &self.tree else {
            for (range, lanes) in rays.in_packets(lanes) {
                if let Some(counter) = counter {
                    counter.list(self.counts, range.len() / lanes, range.len());
                }
                self.tests.improve(&rays.range(range.clone()), &mut hits.range(range), &self.all, lanes);
            }
            return;
        };
        let mut descent = Descent {
            any,
            lanes,
            bvh,
            tests: &*self.tests,
            counter,
            rays,
            hits,
            box_rays: (0..rays.len()).map(|ray| BoxRay::new(&rays.packet(ray), *padding)).collect(),
            list: Vec::new(),
            columns: [const { Vec::new() }; 9],
            primitive: Vec::new(),
        };
        for octant in 0..8 {
            let rays = descent.box_rays.iter().enumerate();
            let list = rays.filter(|(_, ray)| octant_of(ray) == octant).map(|(ray, _)| (ray, 0));
            descent.list = list.collect();
            descent.node(&bvh.wide[0], octant, 0);
        }
    }
}

/// Returns one bit for each axis along which a ray runs backwards.
fn octant_of(box_ray: &BoxRay<f32>) -> usize {
    let Vec3 { x, y, z } = box_ray.inverse;
    [x, y, z].iter().rfold(0, |bits, &inverse| bits << 1 | usize::from(inverse < 0.0))
}

/// Returns how far ahead the first corner of each box of a node is, along the diagonal of an octant.
fn distances(node: &WideNode, octant: usize) -> [f32; WIDE] {
    let along = |axis: usize| {
        let is_backwards = octant >> axis & 1;
        let sign = if is_backwards == 1 { -1.0 } else { 1.0 };
        Native::load(&node.planes()[axis + 3 * is_backwards]) * Native::splat(sign)
    };
    let mut distances = [0.0; WIDE];
    (along(0) + along(1) + along(2)).store(&mut distances);
    distances
}

/// The descent of rays through a hierarchy.
struct Descent<'a, 'b> {
    any: bool,
    lanes: usize,
    bvh: &'a Bvh,
    tests: &'a dyn PrimitiveTests,
    counter: Option<&'a Counter>,
    rays: &'a Rays<'a>,
    hits: &'a mut Hits<'b>,
    box_rays: Vec<BoxRay<f32>>,
    /// A stack of lists, one for each node on the path to the present one. An entry is a ray and one bit for
    /// each box of the node that it passes.
    list: Vec<(usize, u32)>,
    /// Packets of listed rays and their hits: the columns are origin, direction, t, u, v.
    columns: [Vec<f32>; 9],
    primitive: Vec<u32>,
}

impl Descent<'_, '_> {
    /// Traces the list that starts at `first` through a node.
    fn node(&mut self, node: &WideNode, octant: usize, first: usize) {
        let end = self.list.len();
        if let Some(counter) = self.counter {
            counter.node(node, end - first);
        }
        let mut passed = 0;
        for (ray, boxes) in &mut self.list[first..] {
            *boxes = NodeRay::new(&self.box_rays[*ray]).pass(node, self.hits.t[*ray]).1.bitmask();
            passed |= *boxes;
        }
        let distances = distances(node, octant);
        let mut order: Vec<usize> = slots(passed).collect();
        order.sort_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        for slot in order {
            for at in first..end {
                let (ray, boxes) = self.list[at];
                let is_done = self.any && self.hits.primitive[ray] != MISS;
                if boxes >> slot & 1 == 1 && !is_done {
                    self.list.push((ray, 0));
                }
            }
            match node.children()[slot] {
                leaf if leaf.is_leaf() => self.leaf(leaf, end),
                child => self.node(&self.bvh.wide[child.index()], octant, end),
            }
            self.list.truncate(end);
        }
    }

    /// Tests the list that starts at `first` against the primitives of a leaf, in whole packets.
    fn leaf(&mut self, leaf: Child, first: usize) {
        let (listed, primitives) = (&self.list[first..], self.bvh.leaf(leaf).primitives());
        let whole = listed.len().next_multiple_of(self.lanes);
        let (columns, primitive) = (&mut self.columns, &mut self.primitive);
        columns.iter_mut().for_each(Vec::clear);
        primitive.clear();
        for &(ray, _) in listed {
            let (Ray { origin: o, direction: d }, hit) = (self.rays.packet::<f32>(ray), self.hits.get(ray));
            let numbers = [o.x, o.y, o.z, d.x, d.y, d.z, hit.t, hit.u, hit.v];
            columns.iter_mut().zip(numbers).for_each(|(column, number)| column.push(number));
            primitive.push(hit.primitive);
        }
        // Rays that end at 0 hit nothing.
        columns.iter_mut().for_each(|column| column.resize(whole, 0.0));
        primitive.resize(whole, MISS);
        let [x, y, z, dx, dy, dz, t, u, v] = columns;
        let mut hits = Hits { t, primitive, u, v };
        self.tests.improve(&Rays::new([x, y, z], [dx, dy, dz]), &mut hits, primitives, self.lanes);
        for (at, &(ray, _)) in listed.iter().enumerate() {
            self.hits.set(ray, &hits.get(at));
        }
        if let Some(counter) = self.counter {
            let mut tested = KindCounts::default();
            tested.0[leaf.kind() as usize] = primitives.len();
            counter.list(tested, whole / self.lanes, listed.len());
        }
    }
}
