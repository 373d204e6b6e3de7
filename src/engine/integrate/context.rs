//! The data that every stage reads, and the tests of a pipeline's feature set.

use super::queue::{Path, PathQueue, QueueColumns};
use crate::buffers::{Abilities, Buffers, Features};
use crate::camera::PreparedCamera;
use crate::kernel::ray_cone::Cone;
use crate::lane::{Bits, Lane, lane_indices};
use crate::lights::Lights;
use crate::math::{Hit, Ray, Vec3};
use crate::primitives::{PrimitiveTables, Surface, SurfaceTables};
use crate::rays::{Candidates, Structure};
use crate::sampling::Sampler;

pub use crate::buffers::has;

/// Tests whether this is the pipeline with every feature. It calls the longest functions of shading, which
/// others inline: a quarter less of the engine to compile, and as fast. See `perf/README.md`.
#[inline(always)]
pub const fn is_general(n: u64) -> bool {
    n == Features::ALL.0
}

/// Tests whether paths that miss end where they are intersected, so that shading has full packets. They do so
/// only if the feature set has a sky: in scenes without one, nearly every ray hits the sphere around them,
/// and testing for misses costs 3 %.
#[inline(always)]
pub const fn ends_missed(n: u64) -> bool {
    has(n, Features::SKY_GRADIENT) || has(n, Features::SKY_TEXTURE)
}

/// Tests whether texels are read in a loop before shading: each hit has at most one, a display value.
#[inline(always)]
pub const fn reads_texels_first(n: u64) -> bool {
    has(n, Features::TEXTURES) && !Features(n).meets(MANY_TEXELS)
}

/// The features with which a hit may have several texels, or one of more than four bytes.
const MANY_TEXELS: Features = Features::BILINEAR
    .with(Features::LINEAR_TEXTURES)
    .with(Features::LONG_LOOKUPS)
    .with(Features::ROUGHNESS_MAPS)
    .with(Features::NORMAL_MAPS)
    .with(Features::EMISSION_MAPS);

/// Returns the texture lookups that the feature set `n` holds.
#[inline(always)]
pub const fn abilities(n: u64) -> Abilities {
    Abilities {
        bilinear: has(n, Features::BILINEAR),
        linear: has(n, Features::LINEAR_TEXTURES),
        levels: Features(n).meets(Features::LONG_LOOKUPS),
    }
}

/// The scene and settings of a picture, read-only while samples are taken.
pub struct TraceContext {
    /// Materials, textures and sky in flat form.
    pub buffers: Buffers,
    /// The primitives in flat form.
    pub primitives: PrimitiveTables,
    /// The lights that are sampled.
    pub lights: Lights,
    /// The scene in the form that intersection reads.
    pub structure: Structure,
    /// The camera.
    pub camera: PreparedCamera,
    /// The primitives that the primary rays of each tile can hit, by [`crate::camera::Tile::number`]; empty
    /// if culling does not pay.
    pub visible: Vec<Candidates>,
    /// The number of pixels in a row of the picture.
    pub width: u32,
    /// The number of scattering events allowed on a path.
    pub max_bounces: u32,
    /// The seed of the random numbers.
    pub seed: u32,
    /// The source of sample values.
    pub sampler: Sampler,
}

impl TraceContext {
    /// Tests whether paths carry ray cones: in the general pipeline, only in scenes that need them.
    #[inline(always)]
    pub fn carries_cones<const N: u64>(&self) -> bool {
        has(N, Features::LEVELS_OF_DETAIL) && self.buffers.needs.contains(Features::LEVELS_OF_DETAIL)
    }
    /// Tests whether rays may pass surfaces that they hit.
    #[inline(always)]
    pub fn has_opacity<const N: u64>(&self) -> bool {
        has(N, Features::OPACITY) && self.buffers.needs.contains(Features::OPACITY)
    }
    /// Looks up the surfaces of the lanes in `found`; the others are unspecified.
    #[inline(always)]
    pub fn surface<L: Lane, const N: u64>(&self, path: &Path<L>, hit: &Hit<L>, found: L::Mask) -> Surface<L> {
        Surface::of::<N>(&self.surfaces::<N>(), (&path.ray, &path.cone), hit, found)
    }
    /// Returns the tables of look-ups of surfaces.
    #[inline(always)]
    pub fn surfaces<const N: u64>(&self) -> SurfaceTables<'_> {
        let lights = &self.lights.table;
        SurfaceTables { primitives: &self.primitives, lights, cones: self.carries_cones::<N>() }
    }
    /// Returns the columns of the path queue that are stored.
    #[inline(always)]
    pub fn columns<const N: u64>(&self) -> QueueColumns {
        QueueColumns { lights: has(N, Features::LIGHTS), cones: self.carries_cones::<N>() }
    }
    /// Returns the cones of primary rays.
    #[inline(always)]
    pub fn primary_cone<L: Lane, const N: u64>(&self) -> Cone<L> {
        if self.carries_cones::<N>() { self.camera.cone() } else { Cone::none() }
    }

    /// Returns the camera rays of the packet at `at`. The queue holds their origins unless they have one.
    #[inline(always)]
    pub fn primary_ray<L: Lane, const N: u64>(&self, queue: &PathQueue, at: usize) -> Ray<L> {
        if has(N, Features::RAY_ORIGINS) && self.camera.common_origin().is_none() {
            return queue.ray(at);
        }
        Ray { origin: Vec3::splat(self.camera.position()), direction: queue.primary(at).0 }
    }
    /// Returns the paths of the packet at `at`. With `FIRST` they are at their first segment, of which the
    /// queue holds only the ray and the key.
    #[inline(always)]
    pub fn path<L: Lane, const N: u64, const FIRST: bool>(&self, queue: &PathQueue, at: usize) -> Path<L> {
        if !FIRST {
            return queue.path(at, self.columns::<N>());
        }
        let (ray, (_, key)) = (self.primary_ray::<L, N>(queue, at), queue.primary::<L>(at));
        let slot = lane_indices::<L>().wrapping_add(L::Bits::splat(queue.primary_slot(at)));
        Path::primary(ray, key, slot, self.primary_cone::<L, N>())
    }
}
