//! The leaves of triangles, and their compact layout in large hierarchies.
//!
//! Where a hierarchy does not fit the caches, rays wait for its cache lines. The triangles of a leaf share
//! vertices: stored once, eight triangles take three lines instead of five. A leaf is expanded where it is
//! visited, in streams once for all rays of a list. The vertices keep their bits.

use super::leaf::TriangleLeaf;
use crate::bvh::{Bvh, LEAF, Leaf};
use crate::lane::{Bits, F32x8, Lane, Mask, U32x8, U32x16};
use crate::scene::Scene;
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

/// How the leaves of triangles are stored. Rays find the same hits in both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// The vertices of every triangle: nothing to expand.
    Full,
    /// Shared vertices once: fewer cache lines.
    Compact,
}

/// Nodes and leaves of more bytes than this are compact: from some 130,000 triangles on.
const MAX_FULL: usize = 8 << 20;
/// Leaves looked at for the choice of the layout: each that many-th. At least three quarters of them must
/// fit.
const SAMPLED: usize = 64;
/// Fewest leaves for another thread to fill.
const MIN_LEAVES_PER_THREAD: usize = 256;

/// Columns of vertices in a compact leaf: eleven vertices, and NaN for the corners of absent triangles. Of
/// the leaves of scanned and of procedural meshes, 99 % have no more.
const COLUMNS: usize = 12;

/// Up to eight triangles with up to eleven different vertices: three cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
struct CompactLeaf {
    /// The x, y and z of the vertices.
    vertices: [[f32; COLUMNS]; 3],
    /// For the first corners of the eight triangles, their second and their third ones: the columns of their
    /// vertices, four bits each.
    corners: [u32; 3],
    primitives: Leaf,
    /// The index among the full leaves of one with more vertices, or [`CompactLeaf::IS_COMPACT`].
    full: u32,
}
const _: () = assert!(size_of::<CompactLeaf>() == 3 * 64);

impl CompactLeaf {
    const IS_COMPACT: u32 = u32::MAX;

    /// `None` if there are too many vertices.
    fn new(leaf: &Leaf, corners_of: impl Fn(u32) -> [[f32; 3]; 3]) -> Option<Self> {
        let mut rows = [[f32::NAN.to_bits(); 16]; 3];
        let mut corners = [0x1111_1111 * (COLUMNS as u32 - 1); 3];
        let mut filled = 0;
        for (lane, &primitive) in leaf.primitives().iter().enumerate() {
            for (corners, vertex) in corners.iter_mut().zip(corners_of(primitive)) {
                // Bits, so that −0 and 0 stay what they are.
                let vertex = vertex.map(f32::to_bits);
                let [x, y, z] =
                    [0, 1, 2].map(|axis| U32x16::load(&rows[axis]).equals(U32x16::splat(vertex[axis])));
                let same = (x & y & z).bitmask();
                let column = if same != 0 { same.trailing_zeros() as usize } else { filled };
                if column == filled {
                    if filled == COLUMNS - 1 {
                        return None;
                    }
                    rows.iter_mut().zip(vertex).for_each(|(row, component)| row[column] = component);
                    filled += 1;
                }
                let shift = 4 * lane;
                *corners = *corners & !(15 << shift) | (column as u32) << shift;
            }
        }
        let vertices = rows.map(|row| std::array::from_fn(|column| f32::from_bits(row[column])));
        Some(Self { vertices, corners, primitives: *leaf, full: Self::IS_COMPACT })
    }

    /// Stands for a full leaf.
    fn full(index: usize) -> Self {
        Self { full: index as u32, ..Self::zeroed() }
    }

    #[inline(always)]
    fn expanded(&self) -> TriangleLeaf {
        let words: &[f32; 48] = bytemuck::cast_ref(self);
        // Four bits of each lane's own, moved to the top: a product with a power of two is a shift.
        let to_top = U32x8::from_fn(|lane| 1 << (28 - 4 * lane));
        let columns = self.corners.map(|corners| U32x8::splat(corners).wrapping_mul(to_top).shr(28));
        let vertices = columns.map(|columns| {
            [0, 1, 2].map(|axis| {
                // Sixteen words from the row's first on; those behind its columns are not picked.
                let row = words[axis * COLUMNS..].first_chunk().expect("a row and the words behind it");
                bytemuck::cast(F32x8::pick_of_16(row, columns))
            })
        });
        TriangleLeaf { vertices, primitives: self.primitives }
    }

    /// One triangle alone.
    #[inline(always)]
    fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.corners.map(|corners| {
            let column = (corners >> (4 * (lane & 7)) & 15) as usize % COLUMNS;
            [0, 1, 2].map(|axis| self.vertices[axis][column])
        })
    }
}

/// All leaves of triangles of a hierarchy, by their index.
pub(super) struct TriangleLeaves {
    /// All of them, or those that have too many vertices.
    full: Vec<TriangleLeaf>,
    /// All of them, or empty.
    compact: Vec<CompactLeaf>,
}

impl TriangleLeaves {
    /// `None` takes the layout that suits the hierarchy.
    pub fn new(scene: &Scene, bvh: &Bvh, layout: Option<Layout>) -> Self {
        let leaves = bvh.triangle_leaves.as_slice();
        let corners_of = |primitive: u32| {
            scene.triangles[primitive as usize - scene.spheres.len()].vertices.map(|vertex| vertex.to_array())
        };
        let full = |leaf: &Leaf| {
            let mut vertices = [[[f32::NAN; LEAF]; 3]; 3];
            for (lane, &primitive) in leaf.primitives().iter().enumerate() {
                for (rows, corner) in vertices.iter_mut().zip(corners_of(primitive)) {
                    rows.iter_mut().zip(corner).for_each(|(row, component)| row[lane] = component);
                }
            }
            TriangleLeaf { vertices, primitives: *leaf }
        };
        let compact = |leaf: &Leaf| CompactLeaf::new(leaf, corners_of);
        let suits = || {
            let bytes = size_of_val(bvh.wide.as_slice()) + leaves.len() * size_of::<TriangleLeaf>();
            let sampled = leaves.iter().step_by(SAMPLED);
            let fit = sampled.clone().filter(|leaf| compact(leaf).is_some()).count();
            bytes > MAX_FULL && 4 * fit >= 3 * sampled.len()
        };
        let layout = layout.unwrap_or_else(|| if suits() { Layout::Compact } else { Layout::Full });
        let each = leaves.par_iter().with_min_len(MIN_LEAVES_PER_THREAD);
        if layout == Layout::Full {
            return Self { full: each.map(full).collect(), compact: Vec::new() };
        }
        // Those that do not fit, first with no index.
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

    #[inline(always)]
    pub fn is_compact(&self) -> bool {
        !self.compact.is_empty()
    }

    /// Visits a leaf.
    #[inline(always)]
    pub fn with<R>(&self, leaf: usize, visit: impl FnOnce(&TriangleLeaf) -> R) -> R {
        let expanded;
        let leaf = match self.compact.get(leaf) {
            Some(compact) if compact.full == CompactLeaf::IS_COMPACT => {
                expanded = compact.expanded();
                &expanded
            }
            Some(compact) => &self.full[compact.full as usize],
            None => &self.full[leaf],
        };
        visit(leaf)
    }

    /// The corners of one triangle of a leaf.
    #[inline(always)]
    pub fn corners(&self, leaf: usize, lane: usize) -> [[f32; 3]; 3] {
        match self.compact.get(leaf) {
            Some(compact) if compact.full == CompactLeaf::IS_COMPACT => compact.corners(lane),
            Some(compact) => self.full[compact.full as usize].corners(lane),
            None => self.full[leaf].corners(lane),
        }
    }

    /// Reads a word of each cache line of a compact leaf; returns the words combined.
    #[inline(always)]
    pub fn touch(&self, leaf: usize) -> u32 {
        let Some(leaf) = self.compact.get(leaf) else { return 0 };
        let words: &[u32; 48] = bytemuck::cast_ref(leaf);
        words[0] ^ words[16] ^ words[32]
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.full.as_slice()) + size_of_val(self.compact.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight triangles of a strip, the last one absent, with zeros of both signs.
    #[test]
    fn compact_leaves_keep_the_bits_of_their_vertices() {
        let vertex =
            |i: usize| [i as f32 * 0.1, if i.is_multiple_of(2) { 0.0 } else { -0.0 }, 1.0 / (i as f32 + 1.0)];
        let strip = |primitive: u32| [0, 1, 2].map(|corner| vertex(primitive as usize + corner));
        let mut leaf = Leaf { primitives: [Leaf::NONE; LEAF] };
        leaf.primitives[..7].copy_from_slice(&[0, 1, 2, 3, 4, 5, 8]);
        let compact = CompactLeaf::new(&leaf, strip).expect("eleven vertices");
        let expanded = compact.expanded();
        assert_eq!(expanded.primitives, leaf);
        for (lane, &primitive) in leaf.primitives().iter().enumerate() {
            let bits = |corners: [[f32; 3]; 3]| corners.map(|corner| corner.map(f32::to_bits));
            assert_eq!(bits(expanded.corners(lane)), bits(strip(primitive)));
            assert_eq!(bits(compact.corners(lane)), bits(strip(primitive)));
        }
        assert!(expanded.corners(7).as_flattened().iter().all(|component| component.is_nan()));
        leaf.primitives[7] = 20;
        assert!(CompactLeaf::new(&leaf, strip).is_none(), "fourteen vertices");
    }
}
