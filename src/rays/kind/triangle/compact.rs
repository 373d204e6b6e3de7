//! The leaves of triangles, and their compact layout in large hierarchies.
//!
//! If a hierarchy does not fit the caches, rays wait for its cache lines. The triangles of a leaf share
//! vertices: with each vertex stored once, a leaf takes three lines instead of five. A leaf is expanded when
//! it is visited, in streams once for all rays of a node. The vertices keep their bits.

use super::leaf::TriangleLeaf;
use crate::kind::{LEAF, Leaf};
use crate::lane::{Bits, Lane, Mask, Native, NativeBits, U32x16, prefetch};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

/// The layout of the leaves of triangles. Rays find the same hits in both layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// The vertices of every triangle, with nothing to expand.
    Full,
    /// Shared vertices stored once, in fewer cache lines.
    Compact,
}

/// If nodes and leaves take more bytes than this, the layout is compact: from some 130,000 triangles on in
/// leaves of 8, from 260,000 in leaves of 16, which take longer to expand.
const MAX_FULL: usize = if LEAF == 8 { 8 << 20 } else { 16 << 20 };
/// The distance between the leaves that are sampled to choose the layout. At least three quarters of them
/// must fit a compact leaf.
const SAMPLED: usize = 64;
/// The smallest number of leaves that justifies another thread.
pub(crate) const MIN_LEAVES_PER_THREAD: usize = 256;

/// The columns of vertices in a compact leaf; the last one is NaN, for the corners of absent triangles.
/// Nearly all leaves of scanned and of procedural meshes have no more vertices.
const COLUMNS: usize = if LEAF == 8 { 11 } else { 22 };

/// Up to [`LEAF`] triangles with fewer than [`COLUMNS`] different vertices: three or six cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
struct CompactLeaf {
    /// The x, y and z of the vertices.
    vertices: [[f32; COLUMNS]; 3],
    /// The columns of the triangles' vertices: one row for the first corners, one for the second, one for the
    /// third.
    corners: [[u8; LEAF]; 3],
    primitives: Leaf,
    /// The index of the full leaf that replaces this one, or [`CompactLeaf::IS_COMPACT`].
    full: u32,
    /// Padding, so that every leaf starts a cache line.
    unused: [u32; LEAF / 8 - 1],
}
const _: () = assert!(size_of::<CompactLeaf>() == 3 * 64 * LEAF / 8);

impl CompactLeaf {
    const IS_COMPACT: u32 = u32::MAX;

    /// Stores the triangles of a leaf; returns `None` if there are too many vertices.
    fn new(leaf: &Leaf, corners_of: impl Fn(u32) -> [[f32; 3]; 3]) -> Option<Self> {
        let mut rows = [[f32::NAN.to_bits(); 32]; 3];
        let mut corners = [[COLUMNS as u8 - 1; LEAF]; 3];
        let mut filled = 0;
        for (lane, &primitive) in leaf.primitives().iter().enumerate() {
            for (corners, vertex) in corners.iter_mut().zip(corners_of(primitive)) {
                // The bits are compared, so that −0 and 0 stay distinct.
                let vertex = vertex.map(f32::to_bits);
                let same = |first: usize| {
                    let [x, y, z] = [0, 1, 2]
                        .map(|axis| U32x16::load(&rows[axis][first..]).equals(U32x16::splat(vertex[axis])));
                    (x & y & z).bitmask()
                };
                let same = if COLUMNS > 16 { same(0) | same(16) << 16 } else { same(0) };
                let column = if same != 0 { same.trailing_zeros() as usize } else { filled };
                if column == filled {
                    if filled == COLUMNS - 1 {
                        return None;
                    }
                    rows.iter_mut().zip(vertex).for_each(|(row, component)| row[column] = component);
                    filled += 1;
                }
                corners[lane] = column as u8;
            }
        }
        let vertices = rows.map(|row| std::array::from_fn(|column| f32::from_bits(row[column])));
        Some(Self {
            vertices,
            corners,
            primitives: *leaf,
            full: Self::IS_COMPACT,
            unused: Zeroable::zeroed(),
        })
    }

    /// Returns an entry that refers to a full leaf.
    fn full(index: usize) -> Self {
        Self { full: index as u32, ..Self::zeroed() }
    }

    #[inline(always)]
    fn expand(&self, to: &mut TriangleLeaf) {
        let words: &[f32; 48 * LEAF / 8] = bytemuck::cast_ref(self);
        for (rows, corners) in to.vertices.iter_mut().zip(&self.corners) {
            let columns = NativeBits::from_fn(|lane| u32::from(corners[lane]));
            for (axis, row) in rows.iter_mut().enumerate() {
                // Reads sixteen words from an offset in the row; the words behind its columns are not picked.
                let words = &words[axis * COLUMNS..];
                let low = Native::pick_of_16(words.first_chunk().expect("a row"), columns);
                let picked = if COLUMNS <= 16 {
                    low
                } else {
                    let before = COLUMNS as u32 - 16;
                    let behind = columns.wrapping_add(NativeBits::splat(before.wrapping_neg()));
                    let words = words[before as usize..].first_chunk().expect("a row");
                    let high = Native::pick_of_16(words, behind);
                    Native::select(columns.less(NativeBits::splat(16)), low, high)
                };
                picked.store(row);
            }
        }
        to.primitives = self.primitives;
    }

    /// Returns the corners of one triangle.
    #[inline(always)]
    fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.corners.map(|corners| {
            let column = usize::from(corners[lane & (LEAF - 1)]) % COLUMNS;
            [0, 1, 2].map(|axis| self.vertices[axis][column])
        })
    }
}

/// All leaves of triangles in a hierarchy, by their index.
pub struct TriangleLeaves {
    /// All leaves, or those that have too many vertices.
    full: Vec<TriangleLeaf>,
    /// All leaves, or none.
    compact: Vec<CompactLeaf>,
}

/// A leaf in the form in which it is stored.
enum Stored<'a> {
    Full(&'a TriangleLeaf),
    Compact(&'a CompactLeaf),
}

impl TriangleLeaves {
    /// Stores the triangles of all leaves. The first triangle has the number `first`, and the hierarchy's
    /// nodes take `node_bytes`; if `layout` is `None`, the sizes and the sampled leaves decide.
    pub fn new(
        (first, triangles): (usize, &[[glam::Vec3; 3]]),
        leaves: &[Leaf],
        node_bytes: usize,
        layout: Option<Layout>,
    ) -> Self {
        let corners_of =
            |primitive: u32| triangles[primitive as usize - first].map(|vertex| vertex.to_array());
        let full = |leaf: &Leaf| {
            let mut full = TriangleLeaf { primitives: *leaf, ..TriangleLeaf::EMPTY };
            for (lane, &primitive) in leaf.primitives().iter().enumerate() {
                for (rows, corner) in full.vertices.iter_mut().zip(corners_of(primitive)) {
                    rows.iter_mut().zip(corner).for_each(|(row, component)| row[lane] = component);
                }
            }
            full
        };
        let compact = |leaf: &Leaf| CompactLeaf::new(leaf, corners_of);
        let suits = || {
            let bytes = node_bytes + leaves.len() * size_of::<TriangleLeaf>();
            let sampled = leaves.iter().step_by(SAMPLED);
            let fit = sampled.clone().filter(|leaf| compact(leaf).is_some()).count();
            bytes > MAX_FULL && 4 * fit >= 3 * sampled.len()
        };
        let layout = layout.unwrap_or_else(|| if suits() { Layout::Compact } else { Layout::Full });
        let each = leaves.par_iter().with_min_len(MIN_LEAVES_PER_THREAD);
        if layout == Layout::Full {
            return Self { full: each.map(full).collect(), compact: Vec::new() };
        }
        // Leaves that do not fit get their index in the next step.
        let mut compact: Vec<_> =
            each.map(|leaf| compact(leaf).unwrap_or_else(|| CompactLeaf::full(0))).collect();
        let mut others = Vec::new();
        for (compact, leaf) in compact.iter_mut().zip(leaves) {
            if compact.full != CompactLeaf::IS_COMPACT {
                *compact = CompactLeaf::full(others.len());
                others.push(full(leaf));
            }
        }
        Self { full: others, compact }
    }

    /// Calls `visit` with a leaf.
    #[inline(always)]
    pub fn with<R>(&self, leaf: usize, visit: impl FnOnce(&TriangleLeaf) -> R) -> R {
        let mut room;
        visit(match self.stored(leaf) {
            Stored::Full(leaf) => leaf,
            Stored::Compact(leaf) => {
                room = TriangleLeaf::EMPTY;
                leaf.expand(&mut room);
                &room
            }
        })
    }

    /// Returns a leaf, expanded into `room` if it is compact.
    #[inline(always)]
    pub fn expanded<'a>(&'a self, leaf: usize, room: &'a mut TriangleLeaf) -> &'a TriangleLeaf {
        match self.stored(leaf) {
            Stored::Full(leaf) => leaf,
            Stored::Compact(leaf) => {
                leaf.expand(room);
                room
            }
        }
    }

    /// Returns the corners of one triangle of a leaf.
    #[inline(always)]
    pub fn corners(&self, leaf: usize, lane: usize) -> [[f32; 3]; 3] {
        match self.stored(leaf) {
            Stored::Full(leaf) => leaf.corners(lane),
            Stored::Compact(leaf) => leaf.corners(lane),
        }
    }

    #[inline(always)]
    fn stored(&self, leaf: usize) -> Stored<'_> {
        match self.compact.get(leaf) {
            Some(compact) if compact.full == CompactLeaf::IS_COMPACT => Stored::Compact(compact),
            Some(compact) => Stored::Full(&self.full[compact.full as usize]),
            None => Stored::Full(&self.full[leaf]),
        }
    }

    /// Fetches the vertices of a full leaf, or a whole compact leaf: whether it refers to a full leaf is not
    /// known before it is read.
    #[inline(always)]
    pub fn prefetch(&self, leaf: usize) {
        match self.compact.get(leaf) {
            Some(compact) => prefetch(compact),
            None => prefetch(&self.full[leaf].vertices),
        }
    }

    /// Returns the size of all leaves in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.full.as_slice()) + size_of_val(self.compact.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles form a strip, the last one absent, with zeros of both signs.
    #[test]
    fn compact_leaves_keep_the_bits_of_their_vertices() {
        let vertex =
            |i: usize| [i as f32 * 0.1, if i.is_multiple_of(2) { 0.0 } else { -0.0 }, 1.0 / (i as f32 + 1.0)];
        let strip = |primitive: u32| [0, 1, 2].map(|corner| vertex(primitive as usize + corner));
        let mut leaf = Leaf { primitives: [Leaf::NONE; LEAF] };
        leaf.primitives[..LEAF - 1].copy_from_slice(&std::array::from_fn::<_, { LEAF - 1 }, _>(|i| i as u32));
        leaf.primitives[LEAF - 2] += 1;
        let compact = CompactLeaf::new(&leaf, strip).expect("two vertices more than triangles, and one");
        let mut expanded = TriangleLeaf::EMPTY;
        compact.expand(&mut expanded);
        assert_eq!(expanded.primitives, leaf);
        for (lane, &primitive) in leaf.primitives().iter().enumerate() {
            let bits = |corners: [[f32; 3]; 3]| corners.map(|corner| corner.map(f32::to_bits));
            assert_eq!(bits(expanded.corners(lane)), bits(strip(primitive)));
            assert_eq!(bits(compact.corners(lane)), bits(strip(primitive)));
        }
        assert!(expanded.corners(LEAF - 1).as_flattened().iter().all(|component| component.is_nan()));
        leaf.primitives[LEAF - 2..].copy_from_slice(&[100, 200]);
        assert!(CompactLeaf::new(&leaf, strip).is_none(), "six vertices more than triangles");
    }
}
