//! The queues of paths and of shadow rays, in structure-of-arrays form.

use crate::camera::MAX_PIXELS;
use crate::kernel::ray_cone::Cone;
use crate::lane::{Bits, F32x16, Lane};
use crate::math::{Hit, Ray, Vec3};
use crate::rays::{Hits, Rays};
use bytemuck::Zeroable;
use std::ops::Range;

/// The largest number of paths of earlier tiles that wait when a tile begins.
pub(super) const MAX_EARLIER: usize = 2 * MAX_PIXELS;
/// The length of a column: the waiting paths, a tile's, and the widest packet more, so that the last packet
/// may be stored whole. Columns are three quarters of a page and a cache line apart, so that the same part of
/// all columns is spread evenly over the sets of the cache.
const LENGTH: usize = MAX_EARLIER + MAX_PIXELS + F32x16::WIDTH;

pub(super) type Column = [f32; LENGTH];
pub(super) type IntColumn = [u32; LENGTH];

/// Three columns: a vector or a colour per path.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Vec3Columns {
    pub(super) x: Column,
    pub(super) y: Column,
    pub(super) z: Column,
}

impl Vec3Columns {
    #[inline(always)]
    pub(super) fn load<L: Lane>(&self, at: usize) -> Vec3<L> {
        Vec3::new(L::load(&self.x[at..]), L::load(&self.y[at..]), L::load(&self.z[at..]))
    }
    pub(super) fn from(&self, first: usize) -> [&[f32]; 3] {
        [&self.x, &self.y, &self.z].map(|column| &column[first..])
    }
    #[inline(always)]
    pub(super) fn store<L: Lane>(&mut self, at: usize, v: Vec3<L>) {
        v.x.store(&mut self.x[at..]);
        v.y.store(&mut self.y[at..]);
        v.z.store(&mut self.z[at..]);
    }
}

/// Moves the lanes of `mask` to the front.
#[inline(always)]
pub(super) fn compress<L: Lane>(v: Vec3<L>, mask: L::Mask) -> Vec3<L> {
    Vec3::new(v.x.compress(mask), v.y.compress(mask), v.z.compress(mask))
}

/// The paths of a tile behind the waiting ones of earlier tiles, and the hits of their last segments.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
pub struct PathQueue {
    origin: Vec3Columns,
    direction: Vec3Columns,
    /// The factor by which radiance found from here on counts in the pixel.
    throughput: Vec3Columns,
    /// One over the pdf of the path's direction, in sr; 0 after a delta lobe, which light sampling cannot
    /// sample. Stored only if lights are sampled.
    inv_pdf: Column,
    /// The key of the path's random numbers.
    key: IntColumn,
    /// The number of the path's pixel among those of all tiles that are traced together: its number in its
    /// tile ([`crate::camera::Tile::places`]), and [`MAX_PIXELS`] for each tile before it.
    slot: IntColumn,
    t: Column,
    primitive: IntColumn,
    u: Column,
    v: Column,
    /// The [`Cone`]s, stored only if textures have levels of detail.
    cone_width: Column,
    cone_angle: Column,
    /// The number that is added to the index of a primary ray for its slot, modulo 2³².
    to_slot: u32,
}

/// The columns that are not stored in every scene.
#[derive(Clone, Copy)]
pub struct QueueColumns {
    /// Whether lights are sampled: `inv_pdf`.
    pub lights: bool,
    /// Whether textures have levels of detail: ray cones.
    pub cones: bool,
}

/// A packet of paths as they leave a surface or the camera.
#[derive(Clone, Copy)]
pub struct Path<L: Lane> {
    /// The next segment.
    pub ray: Ray<L>,
    /// The product of weights so far.
    pub throughput: Vec3<L>,
    /// One over the pdf of the ray's direction, in sr; 0 after a delta lobe, which light sampling cannot
    /// sample.
    pub inv_pdf: L,
    /// The key of the random numbers.
    pub key: L::Bits,
    /// The number of the pixel, as in the queue.
    pub slot: L::Bits,
    /// The ray cone; without width if textures have no levels of detail.
    pub cone: Cone<L>,
}

impl PathQueue {
    /// Begins the tile of this number among those that are traced together: its primary rays start at
    /// `first`.
    pub fn begin_tile(&mut self, number: usize, first: usize) {
        self.to_slot = ((number * MAX_PIXELS) as u32).wrapping_sub(first as u32);
    }
    /// Returns a range of the rays, all from `origin` if that is given, and the columns of their hits.
    #[inline(always)]
    pub fn queries(&mut self, range: Range<usize>, origin: Option<glam::Vec3>) -> (Rays<'_>, Hits<'_>) {
        let first = range.start;
        let direction = self.direction.from(first);
        let rays = match origin {
            Some(origin) => Rays::from_one(origin, direction),
            None => Rays::new(self.origin.from(first), direction),
        };
        let hits = Hits {
            t: &mut self.t[first..],
            primitive: &mut self.primitive[first..],
            u: &mut self.u[first..],
            v: &mut self.v[first..],
        };
        (rays.first(range.len()), hits)
    }
    /// Returns the columns for the hits of another queue's rays, which overwrite the paths' own.
    #[inline(always)]
    pub fn other_hits(&mut self) -> Hits<'_> {
        let Self { t, primitive, u, v, .. } = self;
        Hits { t, primitive, u, v }
    }
    /// Returns the slots of all paths.
    pub fn slots(&self) -> &IntColumn {
        &self.slot
    }
    /// Returns the rays of `WIDTH` paths.
    #[inline(always)]
    pub fn ray<L: Lane>(&self, at: usize) -> Ray<L> {
        Ray { origin: self.origin.load(at), direction: self.direction.load(at) }
    }
    /// Returns the paths of a packet; zeros for columns that are not stored.
    #[inline(always)]
    pub fn path<L: Lane>(&self, at: usize, QueueColumns { lights, cones }: QueueColumns) -> Path<L> {
        let cone = match cones {
            true => Cone { width: L::load(&self.cone_width[at..]), angle: L::load(&self.cone_angle[at..]) },
            false => Cone::none(),
        };
        Path {
            cone,
            ray: self.ray(at),
            throughput: self.throughput.load(at),
            inv_pdf: if lights { L::load(&self.inv_pdf[at..]) } else { L::zero() },
            key: L::Bits::load(&self.key[at..]),
            slot: L::Bits::load(&self.slot[at..]),
        }
    }
    /// Returns the slot of the primary ray at `at`.
    #[inline(always)]
    pub fn primary_slot(&self, at: usize) -> u32 {
        self.to_slot.wrapping_add(at as u32)
    }
    /// Returns direction and key of paths at their first segment; origin and throughput are the same for all,
    /// and slots follow from the index in the queue.
    #[inline(always)]
    pub fn primary<L: Lane>(&self, at: usize) -> (Vec3<L>, L::Bits) {
        (self.direction.load(at), L::Bits::load(&self.key[at..]))
    }
    /// Stores camera rays at full throughput, which all have one origin unless
    /// [`PathQueue::store_origins`] stores theirs.
    #[inline(always)]
    pub fn store_primary<L: Lane>(&mut self, at: usize, direction: Vec3<L>, key: L::Bits) {
        self.direction.store(at, direction);
        key.store(&mut self.key[at..]);
    }
    /// Stores the origins of camera rays.
    #[inline(always)]
    pub fn store_origins<L: Lane>(&mut self, at: usize, origin: Vec3<L>) {
        self.origin.store(at, origin);
    }
    /// Stores paths.
    #[inline(always)]
    pub fn store_path<L: Lane>(
        &mut self,
        at: usize,
        path: &Path<L>,
        QueueColumns { lights, cones }: QueueColumns,
    ) {
        self.origin.store(at, path.ray.origin);
        self.direction.store(at, path.ray.direction);
        self.throughput.store(at, path.throughput);
        if lights {
            path.inv_pdf.store(&mut self.inv_pdf[at..]);
        }
        if cones {
            path.cone.width.store(&mut self.cone_width[at..]);
            path.cone.angle.store(&mut self.cone_angle[at..]);
        }
        path.key.store(&mut self.key[at..]);
        path.slot.store(&mut self.slot[at..]);
    }
    /// Sets bits of a path's key.
    pub fn mark_key(&mut self, at: usize, bits: u32) {
        self.key[at] |= bits;
    }
    /// Renormalises the directions of a range of paths.
    pub fn normalize_directions<L: Lane>(&mut self, paths: Range<usize>) {
        for at in paths.step_by(L::WIDTH) {
            let direction: Vec3<L> = self.direction.load(at);
            self.direction.store(at, direction.normalize());
        }
    }
    /// Returns the hits of `WIDTH` paths.
    #[inline(always)]
    pub fn hit<L: Lane>(&self, at: usize) -> Hit<L> {
        Hit {
            t: L::load(&self.t[at..]),
            primitive: L::Bits::load(&self.primitive[at..]),
            u: L::load(&self.u[at..]),
            v: L::load(&self.v[at..]),
        }
    }
    /// Stores hits; u and v only if there are `triangles`.
    #[inline(always)]
    pub fn store_hit<L: Lane>(&mut self, at: usize, hit: &Hit<L>, triangles: bool) {
        hit.t.store(&mut self.t[at..]);
        hit.primitive.store(&mut self.primitive[at..]);
        if triangles {
            hit.u.store(&mut self.u[at..]);
            hit.v.store(&mut self.v[at..]);
        }
    }
}

impl<L: Lane> Path<L> {
    /// Returns paths as they leave the camera.
    #[inline(always)]
    pub fn primary(ray: Ray<L>, key: L::Bits, slot: L::Bits, cone: Cone<L>) -> Self {
        Path { ray, throughput: Vec3::repeat(L::one()), inv_pdf: L::zero(), key, slot, cone }
    }
    /// Moves the lanes of `mask` to the front.
    #[inline(always)]
    pub fn compress(&self, mask: L::Mask, QueueColumns { cones, .. }: QueueColumns) -> Self {
        let cone = match cones {
            true => Cone { width: self.cone.width.compress(mask), angle: self.cone.angle.compress(mask) },
            false => Cone::none(),
        };
        Path {
            cone,
            ray: Ray {
                origin: compress(self.ray.origin, mask),
                direction: compress(self.ray.direction, mask),
            },
            throughput: compress(self.throughput, mask),
            inv_pdf: self.inv_pdf.compress(mask),
            key: self.key.compress(mask),
            slot: self.slot.compress(mask),
        }
    }
}

/// Shadow rays, and the radiance that each unoccluded one adds to its pixel.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
pub struct ShadowQueue {
    origin: Vec3Columns,
    direction: Vec3Columns,
    /// Only hits before it occlude.
    t_max: Column,
    radiance: Vec3Columns,
    slot: IntColumn,
    /// The indices of lights, and [`Cone`]s; stored only if [`crate::lights::Lights::needs_hits`]
    /// or rays may pass surfaces.
    light: IntColumn,
    cone_width: Column,
    cone_angle: Column,
}

/// A packet of shadow rays.
pub struct ShadowRay<L: Lane> {
    /// Origin and direction.
    pub ray: Ray<L>,
    /// Only hits before it occlude.
    pub t_max: L,
    /// The radiance that the ray carries.
    pub radiance: Vec3<L>,
    /// The pixel's number, as in the path queue.
    pub slot: L::Bits,
}

impl ShadowQueue {
    /// Returns the first `count` rays and the columns of their hits: those of the path queue, which shading
    /// has read, or which waiting paths do not have yet.
    #[inline(always)]
    pub fn queries<'a>(&'a self, queue: &'a mut PathQueue, count: usize) -> (Rays<'a>, Hits<'a>) {
        let rays = Rays::new(self.origin.from(0), self.direction.from(0)).first(count);
        (rays.until(&self.t_max), queue.other_hits())
    }
    /// Returns the t_max of a ray.
    pub fn t_max(&self, at: usize) -> f32 {
        self.t_max[at]
    }
    /// Returns the pixels of the packet at `at`, and the radiance that its rays carry.
    #[inline(always)]
    pub fn contribution<L: Lane>(&self, at: usize) -> (L::Bits, Vec3<L>) {
        (L::Bits::load(&self.slot[at..]), self.radiance.load(at))
    }
    /// Returns the lights at which the rays of the packet at `at` are aimed, and the rays as paths.
    pub fn to_light<L: Lane>(&self, at: usize) -> (L::Bits, Path<L>) {
        let ray = Ray { origin: self.origin.load(at), direction: self.direction.load(at) };
        let cone = Cone { width: L::load(&self.cone_width[at..]), angle: L::load(&self.cone_angle[at..]) };
        let (slot, throughput) = self.contribution(at);
        let path = Path { ray, throughput, inv_pdf: L::zero(), key: L::Bits::splat(0), slot, cone };
        (L::Bits::load(&self.light[at..]), path)
    }
    /// Stores the columns beside the rays that [`Self::to_light`] reads.
    pub fn store_light<L: Lane>(&mut self, at: usize, mask: L::Mask, light: L::Bits, cone: Cone<L>) {
        light.compress(mask).store(&mut self.light[at..]);
        cone.width.compress(mask).store(&mut self.cone_width[at..]);
        cone.angle.compress(mask).store(&mut self.cone_angle[at..]);
    }
    /// Stores the lanes of `mask` from `at` on.
    #[inline(always)]
    pub fn store<L: Lane>(&mut self, at: usize, mask: L::Mask, ray: &ShadowRay<L>) {
        self.origin.store(at, compress(ray.ray.origin, mask));
        self.direction.store(at, compress(ray.ray.direction, mask));
        ray.t_max.compress(mask).store(&mut self.t_max[at..]);
        self.radiance.store(at, compress(ray.radiance, mask));
        ray.slot.compress(mask).store(&mut self.slot[at..]);
    }
}
