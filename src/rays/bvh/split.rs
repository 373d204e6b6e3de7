//! Splits a set of boxes in two: by the surface area heuristic over bins, or at the median where that fails.
//!
//! Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007. The result does not
//! depend on the number of threads: bins are integer sums and minima, which are the same in any order, and
//! long slices are halved at places that depend only on their lengths.

use super::bounds::PackedBox;
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8, U32x8};
use rayon::join;

/// The number of bins along each axis: two packets of costs.
const BINS: usize = 16;
/// The longest slice that one thread bins or partitions; longer ones are halved over two threads.
const MAX_SEQUENTIAL: usize = 8192;

/// The bounds of a set of boxes, and the bounds of their (doubled) centres.
#[derive(Clone, Copy)]
pub(super) struct Set {
    pub bounds: PackedBox,
    pub centers: PackedBox,
}

impl Set {
    fn empty() -> Self {
        Self { bounds: PackedBox::empty(), centers: PackedBox::empty() }
    }
    fn union(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), centers: self.centers.union(other.centers) }
    }
    pub fn of(boxes: &[PackedBox]) -> Self {
        if boxes.len() > MAX_SEQUENTIAL {
            let (low, high) = boxes.split_at(boxes.len() / 2);
            let (low, high) = join(|| Self::of(low), || Self::of(high));
            return low.union(high);
        }
        boxes.iter().fold(Self::empty(), |set, one| Self {
            bounds: set.bounds.union(*one),
            centers: set.centers.union(one.center()),
        })
    }
}

/// A split: the axis, and the first bin on the right.
#[derive(Clone, Copy)]
pub(super) struct Split {
    axis: usize,
    bin: usize,
    /// Half surface area times blocks, summed over both sides, in the units of [`PackedBox::half_area`].
    pub cost: f64,
}

/// Maps a box to its bins along the three axes.
struct Grid {
    origin: F32x8,
    scale: F32x8,
}

impl Grid {
    fn new(centers: PackedBox) -> Self {
        // Below BINS, so that the last centre falls into the last bin. Centres share one bin if they differ
        // by less than f32 can divide by.
        const NEARLY_ALL: f32 = BINS as f32 * 0.999_99;
        let [x, y, z] = centers.extent().map(|e| if e > 1e-34 { NEARLY_ALL / e } else { 0.0 });
        Self { origin: centers.lanes(), scale: bytemuck::cast([x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0]) }
    }
    /// Returns the bin of a box along each axis, always below [`BINS`].
    #[inline(always)]
    fn bins(&self, of: PackedBox) -> [usize; 3] {
        let at = (of.center().lanes() - self.origin) * self.scale;
        let [x, y, z, ..]: [u32; 8] = bytemuck::cast(at.truncate_to_int());
        [x as usize % BINS, y as usize % BINS, z as usize % BINS]
    }
}

/// The union and the number of the boxes in each bin of each axis.
#[derive(Clone)]
struct Bins {
    boxes: [[PackedBox; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    fn fill(boxes: &[PackedBox], grid: &Grid) -> Self {
        if boxes.len() > MAX_SEQUENTIAL {
            let (low, high) = boxes.split_at(boxes.len() / 2);
            let (mut low, high) = join(|| Self::fill(low, grid), || Self::fill(high, grid));
            for axis in 0..3 {
                for bin in 0..BINS {
                    low.boxes[axis][bin] = low.boxes[axis][bin].union(high.boxes[axis][bin]);
                    low.counts[axis][bin] += high.counts[axis][bin];
                }
            }
            return low;
        }
        let mut filled = Self { boxes: [[PackedBox::empty(); BINS]; 3], counts: [[0; BINS]; 3] };
        for one in boxes {
            for (axis, bin) in grid.bins(*one).into_iter().enumerate() {
                filled.boxes[axis][bin] = filled.boxes[axis][bin].union(*one);
                filled.counts[axis][bin] += 1;
            }
        }
        filled
    }

    /// Returns the cheapest split, with the lowest axis and bin among equals; `None` if all centres share a
    /// bin on every axis.
    ///
    /// `block` primitives are tested together, so the cost of a side is its surface area times the number of
    /// blocks that it fills.
    fn cheapest(&self, scale: f32, block: u32) -> Option<(usize, usize, f32)> {
        let scale = F32x8::splat(scale);
        let (mut best, mut place) = (F32x8::splat(f32::INFINITY), U32x8::splat(0));
        for axis in 0..3 {
            let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
            // The sides of the split before bin i + 1, for i from 0; the last has an empty right side and is
            // no split.
            let mut left = [PackedBox::empty(); BINS];
            let mut right = [PackedBox::empty(); BINS];
            let mut weights = [[0.0; BINS]; 2];
            let (mut union, mut count) = (PackedBox::empty(), 0);
            let total: u32 = counts.iter().sum();
            for i in 0..BINS {
                union = union.union(boxes[i]);
                count += counts[i];
                left[i] = union;
                weights[0][i] = count.div_ceil(block) as f32;
                weights[1][i] = (total - count).div_ceil(block) as f32;
            }
            let mut union = PackedBox::empty();
            for i in (0..BINS - 1).rev() {
                union = union.union(boxes[i + 1]);
                right[i] = union;
            }
            for first in (0..BINS).step_by(8) {
                let eight = |boxes: &[PackedBox; BINS]| {
                    PackedBox::half_areas(boxes[first..].first_chunk().expect("bins in eights"), scale)
                };
                let [low, high] = weights.each_ref().map(|weights| F32x8::load(&weights[first..]));
                let cost = eight(&left) * low + eight(&right) * high;
                let splits = F32x8::zero().lt(low) & F32x8::zero().lt(high);
                let better = splits & cost.lt(best);
                best = F32x8::select(better, cost, best);
                let here = U32x8::from_fn(|lane| (axis * BINS + first + lane) as u32);
                place = U32x8::select(better, here, place);
            }
        }
        let mut found = (f32::INFINITY, usize::MAX);
        for lane in 0..8 {
            let candidate = (best.get(lane), place.get(lane) as usize);
            if candidate.0 < found.0 || (candidate.0 == found.0 && candidate.1 < found.1) {
                found = candidate;
            }
        }
        (found.0 < f32::INFINITY).then(|| (found.1 / BINS, found.1 % BINS + 1, found.0))
    }
}

/// Returns the cheapest split of `boxes`, whose bounds are `set`, by the surface area heuristic; `None` if
/// all share their bins.
pub(super) fn cheapest_split(boxes: &[PackedBox], set: &Set, block: u32) -> Option<Split> {
    let longest = set.bounds.extent().into_iter().fold(0.0, f32::max);
    // Surface areas in units of the longest edge, so that no square overflows; boxes without extent cost 0.
    let scale = if longest > 1e-34 { 1.0 / longest } else { 0.0 };
    let bins = Bins::fill(boxes, &Grid::new(set.centers));
    let (axis, bin, cost) = bins.cheapest(scale, block)?;
    Some(Split { axis, bin, cost: f64::from(cost) * f64::from(longest).powi(2) })
}

/// Reorders the boxes so that those before the split come first. Returns the number on the left, and the
/// bounds of both sides.
pub(super) fn partition(boxes: &mut [PackedBox], set: &Set, split: &Split) -> (usize, Set, Set) {
    let grid = Grid::new(set.centers);
    let axis = U32x8::splat(split.axis as u32);
    let of_axis = |lanes: F32x8| F32x8::pick(bytemuck::cast_ref(&lanes), axis);
    let (origin, scale, bin) = (of_axis(grid.origin), of_axis(grid.scale), F32x8::splat(split.bin as f32));
    // The same arithmetic as `Grid::bins`, one axis in all lanes.
    let before = |one: PackedBox| ((of_axis(one.center().lanes()) - origin) * scale).lt(bin);
    partition_by(boxes, &before)
}

/// Reorders the boxes so that those for which `left` is true come first. Domain: `left` is the same in all
/// lanes.
pub(super) fn partition_by(
    boxes: &mut [PackedBox],
    left: &(impl Fn(PackedBox) -> Mask8 + Sync),
) -> (usize, Set, Set) {
    if boxes.len() > MAX_SEQUENTIAL {
        let half = boxes.len() / 2;
        let (low, high) = boxes.split_at_mut(half);
        let (low, high) = join(|| partition_by(low, left), || partition_by(high, left));
        // The order is now left, right, left, right: swap the shorter middle run with the end of the other.
        let moved = (half - low.0).min(high.0);
        let (front, back) = boxes.split_at_mut(half);
        front[low.0..low.0 + moved].swap_with_slice(&mut back[high.0 - moved..high.0]);
        return (low.0 + high.0, low.1.union(high.1), low.2.union(high.2));
    }
    // Branch-free, because half of the branches would be mispredicted: every box is swapped with the first
    // one on the right.
    let mut count = 0;
    let (mut low, mut high) = (Set::empty(), Set::empty());
    for i in 0..boxes.len() {
        let one = boxes[i];
        let is_left = left(one);
        let center = one.center();
        low = low.union(Set { bounds: one.only(is_left), centers: center.only(is_left) });
        high = high.union(Set { bounds: one.only(!is_left), centers: center.only(!is_left) });
        boxes[i] = boxes[count];
        boxes[count] = one;
        count += (is_left.bitmask() & 1) as usize;
    }
    (count, low, high)
}

/// Splits at the median, rounded up to whole blocks, along the axis on which the centres are furthest apart;
/// equal centres keep their order. Any boxes are halved.
pub(super) fn halve(boxes: &mut [PackedBox], set: &Set, block: usize) -> (usize, Set, Set) {
    let middle = boxes.len().div_ceil(block).div_ceil(2) * block;
    let extent = set.centers.extent();
    let axis = (0..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    if extent[axis] > 0.0 {
        let key = |one: &PackedBox| one.center().lanes().get(axis);
        boxes.select_nth_unstable_by(middle, |a, b| {
            key(a).total_cmp(&key(b)).then_with(|| a.number().cmp(&b.number()))
        });
    }
    let (low, high) = boxes.split_at(middle);
    (middle, Set::of(low), Set::of(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::bounds::Bounds;
    use glam::Vec3;

    #[test]
    fn boxes_fall_into_the_bins_of_their_centres() {
        let one =
            |x: f32, number| PackedBox::new(Bounds { lo: Vec3::splat(x), hi: Vec3::splat(x + 1.0) }, number);
        let boxes = [one(0.0, 7), one(5.0, 3), one(9.0, 4)];
        let grid = Grid::new(Set::of(&boxes).centers);
        assert_eq!(boxes.map(|one| grid.bins(one)), [[0; 3], [8; 3], [15; 3]]);
    }
}
