//! The order in which rays are traced: rays of an image, which come row by row, are traced in small blocks of
//! pixels, because such rays visit the same nodes.

use super::input::Rays;
use glam::DVec3;
use std::ops::Range;

/// The number of neighbours in a row that are traced one after the other.
const GROUP: usize = 8;
/// The number of rows of a block of pixels.
const BLOCK_ROWS: usize = 8;
/// The least number of pixels in a row.
const LEAST_WIDTH: usize = 16;

/// The order in which the rays of a chunk are traced. A place is an index in this order. A ray may have
/// several places: its answers are the same.
pub(super) struct TraceOrder {
    range: Range<usize>,
    /// The first ray of each group of [`GROUP`] rays, relative to the range; empty for the given order.
    groups: Vec<u32>,
    /// The groups row by row within each row of blocks, so that writes are sequential.
    by_rows: Vec<u32>,
}

impl TraceOrder {
    /// Creates the order in which the rays are given.
    pub fn as_given(range: Range<usize>) -> Self {
        Self { range, groups: Vec::new(), by_rows: Vec::new() }
    }

    /// Creates an order in blocks of pixels for rays that seem to be rows of an image, and the given order
    /// for others.
    pub fn by_blocks(rays: &Rays, range: Range<usize>) -> Self {
        let Some((first, width)) = rows_of(rays, range.clone()) else { return Self::as_given(range) };
        let (rows, columns) = ((range.len() - first) / width, width.div_ceil(GROUP));
        let count = rows * columns + first.div_ceil(GROUP) + width.div_ceil(GROUP);
        let (mut groups, mut by_rows) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for top in (0..rows).step_by(BLOCK_ROWS) {
            let (height, before) = (BLOCK_ROWS.min(rows - top), groups.len());
            for column in 0..columns {
                // The last group of a row overlaps the one before it.
                let start = first + top * width + (column * GROUP).min(width - GROUP);
                groups.extend((0..height).map(|row| (start + row * width) as u32));
            }
            let of_row = |row: usize| (0..columns).map(move |column| (before + column * height + row) as u32);
            by_rows.extend((0..height).flat_map(of_row));
        }
        // The pieces of rows at both ends may overlap whole rows.
        let last = range.len() - GROUP;
        let pieces = (0..first).step_by(GROUP).chain((first + rows * width..range.len()).step_by(GROUP));
        groups.extend(pieces.map(|at| at.min(last) as u32));
        by_rows.extend(by_rows.len() as u32..groups.len() as u32);
        Self { range, groups, by_rows }
    }

    /// Tests whether the rays are traced in blocks of pixels.
    pub fn has_blocks(&self) -> bool {
        !self.groups.is_empty()
    }

    /// Returns the number of places.
    pub fn len(&self) -> usize {
        if self.has_blocks() { GROUP * self.groups.len() } else { self.range.len() }
    }

    /// Returns the index of the ray at a place.
    #[inline(always)]
    pub fn ray(&self, place: usize) -> usize {
        self.range.start + self.offset(place)
    }

    /// Splits places into runs of consecutive rays. The first place is that of a group's first ray.
    #[inline(always)]
    pub fn runs(&self, places: Range<usize>) -> impl Iterator<Item = Range<usize>> {
        // A step is never 0, not even where there are no places.
        let size = if self.has_blocks() { GROUP } else { places.len().max(1) };
        let end = places.end;
        places.step_by(size).map(move |place| place..end.min(place + size))
    }

    /// Calls `visit` with the places of consecutive rays, and the first of the rays relative to the chunk.
    #[inline(always)]
    pub fn for_runs(&self, mut visit: impl FnMut(Range<usize>, usize)) {
        if !self.has_blocks() {
            return visit(0..self.len(), 0);
        }
        for &group in &self.by_rows {
            // All ranges have the length [`GROUP`], for which the compiler makes loops of their own.
            let (group, first) = (group as usize, self.groups[group as usize] as usize);
            visit(GROUP * group..GROUP * group + GROUP, first);
        }
    }

    /// Returns the index of the ray at a place, relative to the chunk.
    #[inline(always)]
    fn offset(&self, place: usize) -> usize {
        if self.has_blocks() { self.groups[place / GROUP] as usize + place % GROUP } else { place }
    }
}

/// Returns the first ray of a row, relative to the range, and the number of rays in a row, if the rays seem
/// to be rows of an image: from one point, with directions that advance along each row.
fn rows_of(rays: &Rays, range: Range<usize>) -> Option<(usize, usize)> {
    let count = range.len();
    let origin = |at: usize| rays.origins.get(range.start + at);
    if count < 4 * LEAST_WIDTH || [1, count / 2, count - 1].into_iter().any(|at| origin(at) != origin(0)) {
        return None;
    }
    let direction = |at: usize| DVec3::from(rays.directions.get(range.start + at));
    let step = |at: usize| direction(at) - direction(at - 1);
    // A row ends where the step between directions turns by 90° or more.
    let next_row = |from: usize| {
        let forward = step(from + 1);
        (from + 2..(from + count / 4).min(count)).find(|&at| forward.dot(step(at)) <= 0.0)
    };
    let first = next_row(0)?;
    let width = next_row(first)? - first;
    let starts = (first..count - 1).step_by(width);
    let are_rows = starts.skip(1).all(|start| step(start).dot(step(start + 1)) < 0.0);
    (width >= LEAST_WIDTH && are_rows).then_some((first % width, width))
}
