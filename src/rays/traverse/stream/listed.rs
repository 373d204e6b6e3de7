//! The entries of a stream's lists: rays of a batch, and access to their hits.

use super::stream_ray::StreamRay;
use crate::columns::Hits;
use crate::kernel::ray_triangle::{StoredWoopRay, WoopRay};
use crate::kind::triangle::TriangleLeaf;
use crate::lane::{Bits, NativeBits};
use crate::math::Hit;

/// The number of rays of a batch: the most that a list entry can address. Large batches share the reads of a
/// large tree; the stream rays, 64 bytes each, may exceed the second-level cache, as lists are read in order.
/// Half as many are 3 % faster on 4,000 triangles, 2 to 10 % slower on 100,000 and more.
pub const BATCH: usize = 16_384;

/// The first bit of the triangle tests' axis in an entry of a list: two bits above the ray's index in its
/// batch.
const AXIS_SHIFT: u32 = BATCH.trailing_zeros();
const _: () = assert!(AXIS_SHIFT + 2 <= u16::BITS);

/// Returns the entry of a ray with this index and axis.
#[inline(always)]
pub fn entry_of(ray: u16, axis: u8) -> u16 {
    ray | u16::from(axis) << AXIS_SHIFT
}

/// Returns the indices of the rays of entries.
#[inline(always)]
pub fn rays_of(entries: NativeBits) -> NativeBits {
    entries & NativeBits::splat(BATCH as u32 - 1)
}

/// Returns the axes of the triangle tests of entries.
#[inline(always)]
pub fn axes_of(entries: NativeBits) -> NativeBits {
    entries.shr(AXIS_SHIFT)
}

/// A ray of a list.
pub struct ListedRay<'a> {
    entry: u16,
    /// The ray in the stream's form.
    pub stream_ray: &'a StreamRay,
}

impl<'a> ListedRay<'a> {
    #[inline(always)]
    pub fn new(entry: u16, stream_rays: &'a [StreamRay; BATCH]) -> Self {
        Self { entry, stream_ray: &stream_rays[entry as usize & (BATCH - 1)] }
    }
    /// Returns the ray's index in the batch.
    #[inline(always)]
    pub fn ray(&self) -> usize {
        self.entry as usize & (BATCH - 1)
    }
    #[inline(always)]
    fn axis(&self) -> u32 {
        u32::from(self.entry >> AXIS_SHIFT & 3)
    }
    /// Returns the ray in the form of triangle tests.
    #[inline(always)]
    pub fn woop(&self) -> WoopRay<f32> {
        self.stream_ray.woop(self.axis())
    }
    /// Returns a reference to the ray in the form of triangle tests.
    #[inline(always)]
    pub fn stored_woop(&self) -> StoredWoopRay<'_> {
        self.stream_ray.stored_woop(self.axis())
    }
    /// Returns the ray's nearest hit so far.
    #[inline(always)]
    pub fn hit(&self, hits: &Hits) -> Hit<f32> {
        Hit { t: self.stream_ray.t, ..hits.get(self.ray()) }
    }
    /// Returns the ray's nearest hit after tests of those triangles of a leaf whose bits are set.
    #[inline(always)]
    pub fn accept(&self, leaf: &TriangleLeaf, candidates: u32, hits: &Hits) -> Hit<f32> {
        let mut hit = self.hit(hits);
        leaf.accept(candidates, &self.woop(), &self.stream_ray.box_ray(), &mut hit);
        hit
    }
}

/// Stores the hit that `find` returns for a listed ray that is not done: the hit so far or a nearer one.
/// `None` changes nothing.
#[inline(always)]
pub fn update_hit<const ANY: bool>(
    entry: u16,
    stream_rays: &mut [StreamRay; BATCH],
    hits: &mut Hits,
    find: impl FnOnce(&ListedRay, &Hits) -> Option<Hit<f32>>,
) {
    let listed = ListedRay::new(entry, stream_rays);
    if ANY && listed.stream_ray.t < 0.0 {
        return;
    }
    if let Some(hit) = find(&listed, hits) {
        let ray = listed.ray();
        stream_rays[ray].store_hit::<ANY>(ray, &hit, hits);
    }
}
