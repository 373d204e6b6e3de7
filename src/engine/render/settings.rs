//! The settings that define a picture besides its scene.

use super::Methods;
use crate::choice::choices;
use crate::lane::NATIVE_WIDTH;
use crate::scene::Scene;

choices! {
    /// The pipeline in [`crate::integrate`] that renders a scene. The general one serves to measure and test
    /// the gain of leaving features out.
    pub enum PipelineChoice {
        #[default]
        Auto = "auto", "The pipeline compiled for the smallest set of features that holds the scene's.";
        General = "general", "The pipeline with every feature.";
    }
}

choices! {
    /// The number of rays traced at a time.
    pub enum LaneChoice {
        #[default]
        Auto = "auto", "The width that measured fastest: 16 with AVX-512, else 8.";
        One = "1", "Scalar.";
        Eight = "8", "Packets of eight: one vector with AVX2.";
        Sixteen = "16", "Packets of sixteen: one vector with AVX-512, which the build must have.";
    }
}

impl LaneChoice {
    /// Returns the number of rays of a packet.
    ///
    /// Measured with AVX-512: 16 lanes are 1.1 to 1.6 times as fast as 8 if every primitive is tested, and
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

/// The settings of a picture. `lanes`, `threads`, `tile_size` and `pipeline` change its computation and no
/// bit of it (except that tiles are the blocks of adaptive sampling, [`crate::adaptive`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The width and height in pixels.
    pub resolution: [u32; 2],
    /// The number of scattering events allowed on a path.
    pub max_bounces: u32,
    /// The seed of the random numbers.
    pub seed: u32,
    /// The methods of intersection, traversal and sampling.
    pub methods: Methods,
    /// The number of lanes, one of [`WIDTHS`](crate::lane::WIDTHS): see [`LaneChoice`].
    pub lanes: usize,
    /// The number of worker threads, at least 1.
    pub threads: usize,
    /// The width and height of a tile in pixels; at most [`crate::camera::MAX_PIXELS`] pixels in all.
    pub tile_size: [u32; 2],
    /// The choice of the pipeline: the film is the same.
    pub pipeline: PipelineChoice,
    /// The largest radiance of a sample in a channel; infinite, the default, means no limit. Clamping is
    /// biased: the picture is darker than ground truth by the radiance that is cut off.
    pub clamp: f32,
}

impl Settings {
    /// Returns the scene's own resolution and bounces, the default methods, the machine's widest packets, and
    /// one thread.
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
    /// The default size: rows of whole packets, and a queue that stays in the first-level cache.
    pub const TILE_SIZE: [u32; 2] = [16, 16];
}
