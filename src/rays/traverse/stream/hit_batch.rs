//! Collects pairs of a ray and a triangle ahead of it, and accepts as many at a time as a vector has lanes.

use super::listed::{BATCH, axes_of, rays_of, update_hit};
use super::stream_ray::StreamRay;
use crate::bvh::LEAF;
use crate::columns::Hits;
use crate::kernel::ray_box::own_box;
use crate::kind::keep_if_nearer;
use crate::kind::triangle::{TriangleLeaf, box_of};
use crate::lane::{Bits, Lane, Mask, NATIVE_WIDTH, Native, NativeBits, NativeMask};
use crate::math::{Hit, Vec3};

/// A column with a number for each lane.
type Column<T> = [T; NATIVE_WIDTH];

/// Up to [`NATIVE_WIDTH`] listed rays, each with a triangle that its line passes.
#[repr(align(64))]
pub struct HitBatch {
    /// The components of the triangles' corners.
    corners: [[Column<f32>; 3]; 3],
    /// The rays' entries in lists.
    entries: Column<u32>,
    primitives: Column<u32>,
    /// The number of lanes in use.
    filled: usize,
}

impl HitBatch {
    /// A batch without entries.
    pub const EMPTY: Self = Self {
        corners: [[[0.0; NATIVE_WIDTH]; 3]; 3],
        entries: [0; NATIVE_WIDTH],
        primitives: [0; NATIVE_WIDTH],
        filled: 0,
    };

    /// Tests whether there is nothing to accept.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.filled == 0
    }

    /// Adds a ray and a triangle of a leaf. Returns whether all lanes are filled: the hits must then be
    /// accepted before the next entry is added.
    #[inline(always)]
    pub fn push(&mut self, entry: u16, leaf: &TriangleLeaf, triangle: usize) -> bool {
        // The masks drop the bounds checks.
        let (lane, triangle) = (self.filled & (NATIVE_WIDTH - 1), triangle & (LEAF - 1));
        for (to, from) in self.corners.as_flattened_mut().iter_mut().zip(leaf.vertices.as_flattened()) {
            to[lane] = from[triangle];
        }
        self.entries[lane] = u32::from(entry);
        self.primitives[lane] = leaf.primitives.primitives[triangle];
        self.filled = lane + 1;
        self.filled == NATIVE_WIDTH
    }

    /// Stores the hits that are nearer than those so far, and empties the batch.
    #[inline(never)]
    pub fn accept<const ANY: bool>(&mut self, stream_rays: &mut [StreamRay; BATCH], hits: &mut Hits) {
        let Some(Tested { mask, t, limit, u, v }) = self.test(stream_rays) else { return };
        let (ts, us, vs) = (column(t), column(u), column(v));
        // A hit at the limit itself may have a lower number. A ray may be in several lanes, each of which
        // compares anew.
        for lane in (mask & t.le(limit)).lanes() {
            let lane = lane & (NATIVE_WIDTH - 1);
            update_hit::<ANY>(self.entries[lane] as u16, stream_rays, hits, |listed, hits| {
                let mut hit = listed.hit(hits);
                keep_if_nearer(true, self.primitives[lane], [ts[lane], us[lane], vs[lane]], &mut hit);
                Some(hit)
            });
        }
    }

    /// Calls `visit` with rays, by their index in the batch, and hits before their ends; empties the batch.
    #[inline(never)]
    pub fn visit(&mut self, stream_rays: &[StreamRay; BATCH], visit: &mut impl FnMut(usize, Hit<f32>)) {
        let Some(Tested { mask, t, limit, u, v }) = self.test(stream_rays) else { return };
        let (ts, us, vs) = (column(t), column(u), column(v));
        for lane in (mask & t.lt(limit)).lanes() {
            let lane = lane & (NATIVE_WIDTH - 1);
            let hit = Hit { t: ts[lane], primitive: self.primitives[lane], u: us[lane], v: vs[lane] };
            visit(self.entries[lane] as usize & (BATCH - 1), hit);
        }
    }

    /// Tests all rays against their triangles, and empties the batch.
    #[inline(always)]
    fn test(&mut self, stream_rays: &[StreamRay; BATCH]) -> Option<Tested> {
        let filled = NativeMask::first(std::mem::take(&mut self.filled));
        let entries = NativeBits::load(&self.entries);
        let (box_ray, woop, limit) = StreamRay::columns(stream_rays, rays_of(entries), axes_of(entries));
        let corner =
            |[x, y, z]: &[Column<f32>; 3]| Vec3::new(Native::load(x), Native::load(y), Native::load(z));
        let [a, b, c] = &self.corners;
        let corners = [corner(a), corner(b), corner(c)];
        let found = woop.test_each(corners)?;
        let infinite = Native::splat(f32::INFINITY);
        let (mask, t) = own_box(&box_ray, box_of(corners), found.mask & filled, found.t, infinite);
        Some(Tested { mask, t, limit, u: found.u, v: found.v })
    }
}

/// The tests of a batch.
struct Tested {
    /// The rays that hit their triangles, at any distance.
    mask: NativeMask,
    t: Native,
    u: Native,
    v: Native,
    /// The ends of the rays.
    limit: Native,
}

#[inline(always)]
fn column(x: Native) -> Column<f32> {
    let mut column = [0.0; NATIVE_WIDTH];
    x.store(&mut column);
    column
}
