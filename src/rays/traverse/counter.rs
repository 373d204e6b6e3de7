//! Counts of the boxes and primitives that rays are tested against.
//!
//! A *test* is one ray, or one frustum around many rays, against one box or one primitive; empty lanes do not
//! count. A *step* is one run through the equations: one test in the scalar traversal, up to one per lane in
//! the others. Tests measure how well the hierarchy culls, and steps what that costs; lanes times steps is
//! the number of tests that would fit.
//!
//! Traversals take a [`CounterSink`]. The no-op sink `()` leaves no code, as long as closures capture it by
//! value (`move`): a closure that borrows it makes the compiler emit 1 % more instructions.

use super::hierarchy::Hierarchy;
use crate::bvh::{Child, WideNode};
use crate::kind::{Kind, KindCounts};
use crate::lane::{Mask, NativeMask};
use serde::Serialize;
use std::cell::Cell;
use std::ops::AddAssign;

/// Receives the counts of a traversal.
pub trait CounterSink: Copy {
    /// Counts tests of boxes, and the steps that they take.
    #[inline(always)]
    fn boxes(self, _steps: usize, _tests: usize) {}
    /// Counts `rays` rays or frusta, each against the boxes of a node in one step.
    #[inline(always)]
    fn node(self, _node: &WideNode, _rays: usize) {}
    /// Counts `rays` rays, each against the primitives of a leaf in one step.
    #[inline(always)]
    fn leaf(self, _hierarchy: &Hierarchy, _leaf: Child, _rays: usize) {}
    /// Counts one ray against the primitives of a leaf, one after the other.
    #[inline(always)]
    fn leaf_one_by_one(self, _hierarchy: &Hierarchy, _leaf: Child) {}
    /// Counts a packet of `rays` rays against the primitives of a leaf, one after the other.
    #[inline(always)]
    fn packet(self, _hierarchy: &Hierarchy, _leaf: Child, _rays: usize) {}
    /// Counts a frustum against the boxes of a leaf's triangles, and its packet of `rays` rays against those
    /// that it meets, one after the other.
    #[inline(always)]
    fn packet_triangles(self, _hierarchy: &Hierarchy, _leaf: Child, _rays: usize, _met: NativeMask) {}
}

/// The no-op sink.
impl CounterSink for () {}

impl CounterSink for &Counter {
    fn boxes(self, steps: usize, tests: usize) {
        self.add(|counts| &mut counts.boxes, steps, tests);
    }
    fn node(self, node: &WideNode, rays: usize) {
        self.boxes(rays, rays * node.filled());
    }
    fn leaf(self, hierarchy: &Hierarchy, leaf: Child, rays: usize) {
        self.primitives(leaf, rays, rays * hierarchy.filled(leaf));
    }
    fn leaf_one_by_one(self, hierarchy: &Hierarchy, leaf: Child) {
        self.primitives(leaf, hierarchy.filled(leaf), hierarchy.filled(leaf));
    }
    fn packet(self, hierarchy: &Hierarchy, leaf: Child, rays: usize) {
        let filled = hierarchy.filled(leaf);
        self.primitives(leaf, filled, rays * filled);
    }
    fn packet_triangles(self, hierarchy: &Hierarchy, leaf: Child, rays: usize, met: NativeMask) {
        self.boxes(1, hierarchy.filled(leaf));
        self.primitives(leaf, met.count(), rays * met.count());
    }
}

/// The number of tests of one kind, and of the steps that they take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Tests {
    /// The number of pairs of a ray and a box or primitive.
    pub tests: u64,
    /// The number of runs: a packet against a primitive, or a ray against a node's boxes, counts once.
    pub steps: u64,
}

/// Tests by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Tests of boxes.
    pub boxes: Tests,
    /// Tests of primitives, by [`Kind`].
    pub primitives: [Tests; Kind::ALL.len()],
}

impl AddAssign for Tests {
    fn add_assign(&mut self, other: Self) {
        self.tests += other.tests;
        self.steps += other.steps;
    }
}

impl Counts {
    /// Returns the tests of primitives of all kinds.
    pub fn primitives(&self) -> u64 {
        self.primitives.iter().map(|kind| kind.tests).sum()
    }
    /// Returns the tests of primitives of this kind.
    pub fn of_kind(&self, kind: Kind) -> Tests {
        self.primitives[kind as usize]
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.boxes += other.boxes;
        self.primitives.iter_mut().zip(other.primitives).for_each(|(kind, other)| *kind += other);
    }
}

/// The counts of one thread.
#[derive(Debug, Default)]
pub struct Counter(Cell<Counts>);

impl Counter {
    /// Returns the counts so far, and restarts from 0.
    pub fn take(&self) -> Counts {
        self.0.take()
    }
    fn primitives(&self, leaf: Child, steps: usize, tests: usize) {
        self.add(|counts| &mut counts.primitives[leaf.kind() as usize], steps, tests);
    }
    /// Counts the tests of `rays` rays against the given primitives, in `packets` packets or one by one.
    pub fn list(&self, primitives: KindCounts, packets: usize, rays: usize) {
        for (kind, count) in Kind::ALL.into_iter().zip(primitives.0) {
            self.add(|counts| &mut counts.primitives[kind as usize], packets * count, rays * count);
        }
    }
    fn add(&self, kind: impl FnOnce(&mut Counts) -> &mut Tests, steps: usize, tests: usize) {
        let mut counts = self.0.get();
        *kind(&mut counts) += Tests { tests: tests as u64, steps: steps as u64 };
        self.0.set(counts);
    }
}
