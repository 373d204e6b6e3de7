//! Checks the validity of a hierarchy and collects statistics, for tests and reports; speed does not matter.

use super::bounds::Bounds;
use super::cost::LEAF_COST;
use super::node::{Child, MAX_DEPTH, WIDE};
use super::tree::Bvh;
use crate::kind::Geometry;
use crate::kind::{Kind, KindCounts, LEAF, Leaf};
use serde::Serialize;

/// The statistics of a hierarchy. Expected numbers are those of a random line that meets the root's box: sums
/// of surface areas, divided by the root's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    /// The number of nodes of the wide tree.
    pub wide_nodes: usize,
    /// The number of nodes of the binary tree; 0 if none is kept.
    pub binary_nodes: usize,
    /// The number of leaves of both kinds.
    pub leaves: usize,
    /// The average number of filled slots in a wide node, of [`WIDE`].
    pub node_fill: f64,
    /// The average number of primitives in a leaf, of [`LEAF`].
    pub leaf_fill: f64,
    /// The number of levels of nodes above the deepest leaf.
    pub wide_depth: usize,
    /// The depth of the binary tree; 0 if none is kept.
    pub binary_depth: usize,
    /// The expected number of wide nodes that a random line tests.
    pub node_visits: f64,
    /// The expected number of leaves that a random line tests.
    pub leaf_visits: f64,
    /// The expected number of primitives that a random line tests.
    pub primitive_tests: f64,
    /// The expected cost of a random line, in tests of a node of [`WIDE`] children; the builder minimises it.
    pub cost: f64,
    /// The largest number of references on the stack of a traversal of the wide tree.
    pub stack: usize,
}

/// Validates both trees, depth first, and sums up the statistics.
struct Validator<'a, F> {
    bvh: &'a Bvh,
    bounds: F,
    counts: KindCounts,
    seen: Vec<u32>,
    /// The leaves of each kind that were reached.
    leaves: [usize; Kind::ALL.len()],
    statistics: Statistics,
    area: f64,
}

type Checked<T> = Result<T, String>;

/// Runs [`check`] on the hierarchy over all primitives of a geometry.
pub fn check_geometry(bvh: &Bvh, geometry: &Geometry) -> Checked<Statistics> {
    let bounds = |number| Bounds::new(geometry.shape(number).bounds());
    check(bvh, geometry.counts(), bounds)
}

/// Checks the hierarchy over primitives with the given boxes. Returns its statistics, or the first fault.
pub fn check(bvh: &Bvh, counts: KindCounts, bounds: impl Fn(usize) -> Bounds) -> Checked<Statistics> {
    let (count, of_kinds) = (counts.total(), bvh.leaves.each_ref().map(Vec::len));
    let leaves = of_kinds.iter().sum::<usize>();
    let statistics = Statistics {
        wide_nodes: bvh.wide.len(),
        binary_nodes: bvh.binary.len(),
        leaves,
        ..Statistics::default()
    };
    let area = bvh.bounds.half_area().max(f64::MIN_POSITIVE);
    let mut validator =
        Validator { bvh, bounds, counts, seen: vec![0; count], leaves: [0; _], statistics, area };

    let mut next_node = 1;
    let (root, stack) = validator.node(0, 1, bvh.bounds, &mut next_node)?;
    expect(root == bvh.bounds, || format!("bounds {:?} are not those of the root, {root:?}", bvh.bounds))?;
    expect(next_node == bvh.wide.len(), || format!("{} wide nodes, {next_node} reached", bvh.wide.len()))?;
    expect(validator.leaves == of_kinds, || "lost leaves".into())?;
    if let Some(lost) = validator.seen.iter().position(|&times| times != 1) {
        return Err(format!("primitive {lost} is in {} leaves", validator.seen[lost]));
    }

    let (mut next, mut deepest) = (0, 0);
    if !bvh.binary.is_empty() {
        validator.leaves = [0; _];
        validator.binary(&mut next, 0, &mut deepest)?;
        expect(next == bvh.binary.len(), || format!("{} binary nodes, {next} reached", bvh.binary.len()))?;
        expect(validator.leaves == of_kinds, || "the binary tree has other leaves".into())?;
    }

    let mut statistics = validator.statistics;
    statistics.node_fill = (bvh.wide.len() - 1 + leaves) as f64 / bvh.wide.len() as f64;
    statistics.leaf_fill = count as f64 / leaves.max(1) as f64;
    statistics.binary_depth = deepest as usize;
    statistics.stack = stack.max(1);
    Ok(statistics)
}

fn expect(holds: bool, otherwise: impl FnOnce() -> String) -> Checked<()> {
    if holds { Ok(()) } else { Err(otherwise()) }
}

impl<F: Fn(usize) -> Bounds> Validator<'_, F> {
    /// Returns the union of the boxes below a wide node, and the references that it may put on a stack.
    fn node(
        &mut self,
        node: usize,
        level: usize,
        around: Bounds,
        next_node: &mut usize,
    ) -> Checked<(Bounds, usize)> {
        let wide = *self.bvh.wide.get(node).ok_or_else(|| format!("wide node {node} is out of range"))?;
        expect(level <= MAX_DEPTH as usize, || format!("wide node {node} is {level} levels deep"))?;
        self.statistics.wide_depth = self.statistics.wide_depth.max(level);
        let filled = wide.children().iter().take_while(|&&child| child != Child::NONE).count();
        let share = around.half_area() / self.area;
        self.statistics.node_visits += share;
        self.statistics.cost += share;
        let (mut union, mut deepest) = (Bounds::EMPTY, 0);
        for slot in 0..WIDE {
            let (child, bounds) = (wide.children()[slot], wide.bounds(slot));
            let place = || format!("slot {slot} of wide node {node}");
            if slot >= filled {
                expect(child == Child::NONE && bounds == Bounds::EMPTY, || {
                    format!("{} is not empty", place())
                })?;
                continue;
            }
            let below = if child.is_leaf() {
                self.leaf(child, bounds)?
            } else {
                expect(child.index() == *next_node, || {
                    format!("{} refers to {}, out of order", place(), child.index())
                })?;
                *next_node += 1;
                let (below, stack) = self.node(child.index(), level + 1, bounds, next_node)?;
                deepest = deepest.max(stack);
                below
            };
            expect(below == bounds, || format!("{} has box {bounds:?} around {below:?}", place()))?;
            union = union.union(bounds);
        }
        expect(filled > 1 || self.bvh.wide.len() == 1, || format!("wide node {node} has {filled} children"))?;
        Ok((union, (filled + deepest.saturating_sub(1)).max(filled)))
    }

    fn leaf(&mut self, child: Child, bounds: Bounds) -> Checked<Bounds> {
        let kind = child.kind();
        let (leaves, next) = (&self.bvh.leaves[kind as usize], &mut self.leaves[kind as usize]);
        let leaf =
            leaves.get(child.index()).ok_or_else(|| format!("leaf {} is out of range", child.index()))?;
        expect(child.index() == *next, || format!("leaf {} is in place {next}", child.index()))?;
        *next += 1;
        let primitives = leaf.primitives();
        expect(!primitives.is_empty(), || format!("leaf {} is empty", child.index()))?;
        expect(leaf.primitives[primitives.len()..].iter().all(|&one| one == Leaf::NONE), || {
            format!("leaf {} has a gap", child.index())
        })?;
        expect(primitives.is_sorted(), || format!("leaf {} is out of order", child.index()))?;
        let mut union = Bounds::EMPTY;
        for &primitive in primitives {
            let number = primitive as usize;
            expect(number < self.seen.len(), || format!("primitive {number} is out of range"))?;
            expect(self.counts.kind_of(number) == kind, || {
                format!("primitive {number} is of the wrong kind")
            })?;
            self.seen[number] += 1;
            union = union.union((self.bounds)(number));
        }
        let share = bounds.half_area() / self.area;
        self.statistics.leaf_visits += share;
        self.statistics.cost += share * LEAF_COST;
        self.statistics.primitive_tests += share * primitives.len() as f64;
        debug_assert!(primitives.len() <= LEAF);
        Ok(union)
    }

    /// Returns the union of the boxes below the next binary node.
    fn binary(&mut self, next: &mut usize, depth: u32, deepest: &mut u32) -> Checked<Bounds> {
        let index = *next;
        let node =
            *self.bvh.binary.get(index).ok_or_else(|| format!("binary node {index} is out of range"))?;
        *next += 1;
        expect(depth <= MAX_DEPTH, || format!("binary node {index} is at depth {depth}"))?;
        *deepest = depth.max(*deepest);
        let child = node.child();
        let union = if child == Child::NONE {
            Bounds::EMPTY
        } else if child.is_leaf() {
            let place = &mut self.leaves[child.kind() as usize];
            expect(child.index() == *place, || {
                format!("binary node {index} refers to leaf {}", child.index())
            })?;
            *place += 1;
            let primitives = self.bvh.leaf(child).primitives();
            primitives.iter().fold(Bounds::EMPTY, |union, &one| union.union((self.bounds)(one as usize)))
        } else {
            let left = self.binary(next, depth + 1, deepest)?;
            expect(child.index() == *next, || format!("binary node {index} refers to {}", child.index()))?;
            left.union(self.binary(next, depth + 1, deepest)?)
        };
        expect(union == node.bounds(), || format!("binary node {index} has a box of its own"))?;
        Ok(union)
    }
}

#[cfg(test)]
mod tests {
    use super::check;
    use crate::bvh::bounds::{Bounds, PackedBox};
    use crate::bvh::build::Builder;
    use crate::bvh::tree::{Bvh, Trees};
    use crate::kind::KindCounts;
    use glam::Vec3;

    #[test]
    fn cost_is_what_the_builder_minimises() {
        for of_kinds in [[0, 40], [0, 300], [300, 1000], [0, 1001], [400, 2000], [3000, 0]] {
            let mut counts = KindCounts::default();
            counts.0.iter_mut().zip(of_kinds).for_each(|(count, of_kind)| *count = of_kind);
            // Points of a Kronecker sequence, with boxes of three sizes.
            let bounds = |number: usize| {
                let point = (Vec3::new(0.819_17, 0.671_04, 0.549_7) * number as f32).fract();
                let half = Vec3::splat([0.005, 0.02, 0.08][number % 3]);
                Bounds { lo: point - half, hi: point + half }
            };
            let mut boxes: Vec<_> =
                (0..counts.total()).map(|number| PackedBox::new(bounds(number), number as u32)).collect();
            let (_, costs) = Builder { counts }.build(&mut boxes);
            let bvh = Bvh::of_boxes(counts, Trees::Wide, bounds);
            let planned = costs.of_tree() / bvh.bounds.half_area();
            let cost = check(&bvh, counts, bounds).unwrap().cost;
            // The builder rounds extents to f32.
            assert!((cost / planned - 1.0).abs() < 1e-6, "{counts:?}: {cost}, planned {planned}");
        }
    }
}
