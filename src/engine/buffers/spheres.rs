//! Spheres in blocks, for intersection.

use crate::lane::Lane;
use crate::math::Vec3;
use crate::scene;

/// Spheres in a block of [`Spheres`].
const BLOCK: usize = 8;

/// `N` spheres as a structure of arrays: each component fills a packet.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct SphereBlock<const N: usize> {
    x: [f32; N],
    y: [f32; N],
    z: [f32; N],
    /// Squared radius; negative in padding, so that no ray hits it.
    radius2: [f32; N],
}

impl<const N: usize> SphereBlock<N> {
    const PADDING: Self = Self { x: [0.0; N], y: [0.0; N], z: [0.0; N], radius2: [-1.0; N] };

    /// Up to `N` spheres, the rest padding.
    pub fn new<'a>(spheres: impl IntoIterator<Item = &'a scene::Sphere>) -> Self {
        let mut block = Self::PADDING;
        for (lane, sphere) in spheres.into_iter().enumerate() {
            (block.x[lane], block.y[lane], block.z[lane]) = sphere.center.into();
            block.radius2[lane] = sphere.radius * sphere.radius;
        }
        block
    }

    /// One sphere broadcast to all lanes: centre and squared radius.
    #[inline(always)]
    pub fn splat<L: Lane>(&self, index: usize) -> (Vec3<L>, L) {
        let center = Vec3::new(L::splat(self.x[index]), L::splat(self.y[index]), L::splat(self.z[index]));
        (center, L::splat(self.radius2[index]))
    }

    /// The spheres, one a lane: centres and squared radii.
    #[inline(always)]
    pub fn all<L: Lane>(&self) -> (Vec3<L>, L) {
        (Vec3::new(L::load(&self.x), L::load(&self.y), L::load(&self.z)), L::load(&self.radius2))
    }
}

/// All spheres, in blocks; the last one is padded.
#[derive(Clone, Debug)]
pub struct Spheres {
    blocks: Vec<SphereBlock<BLOCK>>,
    len: usize,
}

impl Spheres {
    pub(super) fn new(spheres: &[scene::Sphere]) -> Self {
        let blocks = spheres.chunks(BLOCK).map(SphereBlock::new).collect();
        Self { blocks, len: spheres.len() }
    }
    /// The number of spheres.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }
    /// Whether there is no sphere.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
    /// The spheres in blocks.
    #[inline(always)]
    pub fn blocks(&self) -> &[SphereBlock<BLOCK>] {
        &self.blocks
    }
    /// One sphere broadcast to all lanes: centre and squared radius.
    #[inline(always)]
    pub fn splat<L: Lane>(&self, index: usize) -> (Vec3<L>, L) {
        self.blocks[index / BLOCK].splat(index % BLOCK)
    }
    /// Calls `f` with the index of each sphere, its centre and its squared radius, broadcast to all lanes, in
    /// order.
    #[inline(always)]
    pub fn for_each<L: Lane>(&self, mut f: impl FnMut(usize, Vec3<L>, L)) {
        for (number, block) in self.blocks.iter().enumerate() {
            let first = number * BLOCK;
            for lane in 0..(self.len - first).min(BLOCK) {
                let (center, radius2) = block.splat(lane);
                f(first + lane, center, radius2);
            }
        }
    }
    /// Memory of the blocks.
    pub fn bytes(&self) -> usize {
        size_of_val(self.blocks.as_slice())
    }
}
