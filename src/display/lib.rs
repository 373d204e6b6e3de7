//! octray's display filters, from a film's picture to the picture that is shown: denoising, anti-aliasing,
//! and temporal reprojection while the camera moves. The viewer and the charts use them.
//!
//! A filter turns a picture into a picture, in linear radiance, and never changes a film. Each filter keeps
//! its working memory and allocates nothing after the first picture of a size. Rows are filtered in parallel
//! inside a pool of threads, such as [`octray_engine::render::Renderer::on_threads`] provides, and one after
//! the other outside of one; the bits are the same.
//!
//! The package imports the engine: its film, its AOVs and its lanes. The engine does not know this package.
//!
//! | module | what it does |
//! |---|---|
//! | [`rows`] | loops over rows of pixels, in parallel inside a pool of threads |
//! | `blur` | [`Blur`]: the 3×3 blur of the thesis |
//! | `fxaa` | [`Fxaa`]: anti-aliasing of converged pictures |
//! | `atrous` | [`Denoiser`]: the edge-avoiding à-trous filter |
//! | `history` | [`History`]: reprojects and accumulates the frames of a moving camera |

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod atrous;
mod blur;
mod fxaa;
mod history;
pub mod rows;

pub use atrous::{Denoiser, Samples};
pub use blur::Blur;
pub use fxaa::Fxaa;
pub use history::History;

use octray_engine::integrate::aovs::{Aovs, Plane};

/// The share of the lower quartile of depths that the camera covers in a second.
const SHARE_A_SECOND: f32 = 0.25;
/// The speed if no pixel sees a surface, in scene units per second.
const DEFAULT_SPEED: f32 = 1.0;

/// Returns the speed of a walking camera, in scene units per second: a quarter of the lower quartile of the
/// depths of the pixels that see a surface, so that near surfaces pass by at the same pace in scenes of every
/// size. It is one unit if no pixel sees a surface.
pub fn walking_speed(aovs: &Aovs) -> f32 {
    let rows = (0..aovs.resolution()[1]).flat_map(|y| aovs.row(Plane::Distance, y));
    let mut distances: Vec<f32> = rows.copied().filter(|distance| distance.is_finite()).collect();
    if distances.is_empty() {
        return DEFAULT_SPEED;
    }
    let quarter = (distances.len() - 1) / 4;
    let (_, quartile, _) = distances.select_nth_unstable_by(quarter, f32::total_cmp);
    SHARE_A_SECOND * *quartile
}
