//! What decides a picture besides its scene.

use super::Methods;
use crate::choice::choices;
use crate::lane::NATIVE_WIDTH;
use crate::scene::Scene;

choices! {
    /// Which of the pipelines in [`crate::integrate`] renders a scene. The general one measures and tests the
    /// gain of leaving features out.
    pub enum PipelineChoice {
        #[default]
        Auto = "auto", "The pipeline compiled for the smallest set of features that holds the scene's.";
        General = "general", "The pipeline with every feature.";
    }
}

choices! {
    /// Rays traced at a time.
    pub enum LaneChoice {
        #[default]
        Auto = "auto", "The width that measured fastest: 16 with AVX-512, else 8.";
        One = "1", "Scalar.";
        Eight = "8", "Packets of eight: one vector with AVX2.";
        Sixteen = "16", "Packets of sixteen: one vector with AVX-512, which the build must have.";
    }
}

impl LaneChoice {
    /// Rays of a packet.
    ///
    /// Measured with AVX-512: 16 lanes are 1.1 to 1.6 times as fast as 8 where every primitive is tested, and
    /// 1.03 to 1.06 times with a hierarchy, whose traversals have widths of their own.
    pub fn lanes(self) -> usize {
        match self {
            Self::One => 1,
            Self::Eight => 8,
            Self::Sixteen => 16,
            Self::Auto => NATIVE_WIDTH,
        }
    }
}

/// The settings of a picture. `lanes`, `threads`, `tile_size` and `pipeline` change how it is computed and no
/// bit of it (but tiles are the blocks of adaptive sampling, [`crate::adaptive`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels: width, height.
    pub resolution: [u32; 2],
    /// Scattering events allowed on a path.
    pub max_bounces: u32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Intersection, traversal, lights and sampler.
    pub methods: Methods,
    /// One of [`WIDTHS`](crate::lane::WIDTHS): see [`LaneChoice`].
    pub lanes: usize,
    /// Worker threads, at least 1.
    pub threads: usize,
    /// Pixels of a tile: width, height; their product is at most [`crate::camera::MAX_PIXELS`].
    pub tile_size: [u32; 2],
    /// What the pipeline is compiled for: the film is the same.
    pub pipeline: PipelineChoice,
    /// The most radiance of a sample in a channel; infinite, the default, is no limit. Clamping is biased:
    /// the picture is darker than ground truth by what it cuts off.
    pub clamp: f32,
}

impl Settings {
    /// The scene's own resolution and bounces, the default methods, the machine's widest packets, and one
    /// thread.
    pub fn of(scene: &Scene) -> Self {
        Self {
            resolution: scene.resolution,
            max_bounces: scene.max_bounces,
            seed: 0,
            methods: Methods::default(),
            lanes: LaneChoice::default().lanes(),
            threads: 1,
            tile_size: Self::TILE_SIZE,
            pipeline: PipelineChoice::default(),
            clamp: f32::INFINITY,
        }
    }
    /// Rows of whole packets, and a queue that stays in the first-level cache.
    pub const TILE_SIZE: [u32; 2] = [16, 16];
}
