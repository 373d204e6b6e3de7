//! What stands between a film and a window: edges smoothed, noise removed, what earlier frames saw kept while the camera moves.
//!
//! For: [`Blur`], [`Fxaa`] and [`Denoiser`], which turn a picture into another; [`History`], which blends frames from different places;
//! [`walking_speed`]. May import: `film`, `camera`, the guides of `integrate`, `output` (what a screen shows). Must never know: scenes,
//! renderers, windows.
//!
//! Everything here is for the eye alone: pictures in, pictures out, in linear radiance, and never back into a film. Each keeps its working
//! memory and takes none after the first picture of a size. Rows of pixels are worked on in parallel inside a pool of threads, as
//! [`crate::render::Renderer::on_threads`] gives, and one after the other outside of one; the bits are the same.

mod atrous;
mod blur;
mod fxaa;
mod history;
pub mod rows;

pub use atrous::{Denoiser, Samples};
pub use blur::Blur;
pub use fxaa::Fxaa;
pub use history::History;

use crate::integrate::aovs::{Aovs, Plane};

/// The share of the lower quartile of distances that is walked in a second.
const SHARE_A_SECOND: f32 = 0.25;
/// The speed where nothing is seen.
const SPEED_IN_THE_VOID: f32 = 1.0;

/// How fast to walk through what the camera sees, in scene units a second: a quarter of the lower quartile of the distances of the pixels
/// that see a surface, so that what is near passes by at the same pace in scenes of every size. One unit where no pixel sees any.
pub fn walking_speed(guides: &Aovs) -> f32 {
    let rows = (0..guides.resolution()[1]).flat_map(|y| guides.row(Plane::Distance, y));
    let mut distances: Vec<f32> = rows.copied().filter(|distance| distance.is_finite()).collect();
    if distances.is_empty() {
        return SPEED_IN_THE_VOID;
    }
    let quarter = (distances.len() - 1) / 4;
    let (_, quartile, _) = distances.select_nth_unstable_by(quarter, f32::total_cmp);
    SHARE_A_SECOND * *quartile
}
