//! Error of the interactive view in motion: frames of one sample, alone and with temporal reprojection of
//! earlier frames.
//!
//! The camera moves sideways and forwards at walking speed, and turns, at 60 frames per second: `FRAMES`
//! frames with a seed each. Four frames of the second half are compared with their own ground truths.

use super::ground_truth::GroundTruthRenderer;
use crate::display::{Denoiser, History, Samples, walking_speed};
use crate::film::Picture;
use crate::integrate::aovs::Aovs;
use crate::integrate::edge_aovs::DenoiserAovs;
use crate::measure::cores::Reliability;
use crate::measure::errors::Errors;
use crate::measure::quantiles::Spread;
use crate::measure::timed::time_on_cores;
use crate::render::{Renderer, Settings};
use crate::scene::{Camera, Scene};
use glam::Quat;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Frames of a camera path; fewer where they take more than their share of the time, but at least
/// [`LEAST_FRAMES`].
pub(crate) const FRAMES: u32 = 48;
pub(crate) const LEAST_FRAMES: u32 = 16;
const FRAMES_PER_SECOND: f32 = 60.0;
/// Radians per second.
const TURN: f32 = std::f32::consts::FRAC_PI_6;
/// The display filters; the first is none.
pub const FILTERS: [&str; 3] = ["as it is", "reprojected", "reprojected, denoised"];
/// Frames of a camera path that are compared with a ground truth.
const COMPARED: u32 = 4;
/// The share of the time for frames; ground truths have the rest.
const FRAMES_SHARE: f64 = 0.6;
/// Most samples of a ground truth.
pub(crate) const MOST_GROUND_TRUTH_SAMPLES: u32 = 1_024;

/// How the camera moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CameraPath {
    /// Moves to the right at walking speed, looking ahead.
    Sideways,
    /// Moves along the view at walking speed.
    Forwards,
    /// Turns in place, around the up vector, by 30° a second.
    Turning,
}

impl CameraPath {
    /// All paths in the order of reports.
    pub const ALL: [Self; 3] = [Self::Sideways, Self::Forwards, Self::Turning];

    /// Returns the name in reports, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sideways => "sideways",
            Self::Forwards => "forwards",
            Self::Turning => "turning",
        }
    }

    /// Returns the camera in the frame of this number; `speed` in scene units per second.
    fn camera(self, from: &Camera, frame: u32, speed: f32) -> Camera {
        let seconds = frame as f32 / FRAMES_PER_SECOND;
        let forward = (from.look_at - from.position).normalize();
        let step = match self {
            Self::Sideways => forward.cross(from.up).normalize() * speed * seconds,
            Self::Forwards => forward * speed * seconds,
            Self::Turning => {
                let turn = Quat::from_axis_angle(from.up.normalize(), -TURN * seconds);
                return Camera { look_at: from.position + turn * (from.look_at - from.position), ..*from };
            }
        };
        Camera { position: from.position + step, look_at: from.look_at + step, ..*from }
    }
}

/// One camera path with one filter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionResult {
    /// How the camera moves.
    pub path: CameraPath,
    /// One of [`FILTERS`].
    pub filter: &'static str,
    /// Worker threads.
    pub threads: usize,
    /// Frames of the path, of which four are compared.
    pub frames: u32,
    /// Scene units per second.
    pub speed: f32,
    /// Root mean square over the compared frames, without the part of the ground truths' own error; null
    /// where the mean square is at most two of its standard errors over the frames, and so could be chance.
    pub rmse: Option<f64>,
    /// The unfiltered frames' `rmse` over this one; null where one of the two is null.
    pub times_lower: Option<f64>,
    /// Time to render a frame's sample, in milliseconds.
    pub frame_ms: Spread,
    /// Time to filter it, AOVs included, in milliseconds.
    pub filter_ms: Spread,
    /// Reliability of the times.
    #[serde(flatten)]
    pub reliability: Reliability,
}

/// The frames of a camera path: times by frame, and the compared pictures by filter, with their cameras.
#[derive(Default)]
struct PathFrames {
    frame_ms: Vec<f64>,
    filter_ms: [Vec<f64>; 3],
    turns: Vec<Reliability>,
    compared: Vec<(Camera, [Picture; 3])>,
}

/// Renders all camera paths, and then ground truths in the remaining time. `settings` are those of frames.
pub(crate) fn measure(
    scene: &Scene,
    settings: Settings,
    threads: usize,
    end: Instant,
    most_ground_truth_samples: u32,
) -> Vec<MotionResult> {
    let start = Instant::now();
    let settings = Settings { threads, ..settings };
    let mut renderer = Renderer::new(scene, settings);
    let mut aovs = Aovs::default();
    renderer.aovs_into(&mut aovs);
    let speed = walking_speed(&aovs);
    let frames = {
        renderer.add_samples(&mut renderer.film(), 1);
        let start_of_frame = Instant::now();
        renderer.add_samples(&mut renderer.film(), 1);
        renderer.aovs_into(&mut aovs);
        let share = end.saturating_duration_since(start).as_secs_f64() * FRAMES_SHARE;
        let frame = 1.5 * start_of_frame.elapsed().as_secs_f64();
        ((share / (CameraPath::ALL.len() as f64 * frame)) as u32).clamp(LEAST_FRAMES, FRAMES)
    };
    let paths = CameraPath::ALL.map(|path| render_path(&mut renderer, scene, path, frames, speed));
    drop(renderer);

    let mut truth_renderer = GroundTruthRenderer::new(scene, settings, threads);
    let mut left = (CameraPath::ALL.len() as u32) * COMPARED;
    let mut errors_of = |path_frames: &PathFrames| {
        let mut squares = [const { Vec::new() }; 3];
        for (camera, pictures) in &path_frames.compared {
            truth_renderer.set_camera(camera, &settings);
            let now = Instant::now();
            let share = end.saturating_duration_since(now) / left;
            left -= 1;
            let ground_truth =
                truth_renderer.render_until(now + share, most_ground_truth_samples, Duration::ZERO);
            for (squares, picture) in squares.iter_mut().zip(pictures) {
                // Unbiased at any noise of the ground truth: with its independent halves a and b, this is the
                // mean of (x − a)(x − b).
                let rmse = Errors::of(picture, &ground_truth.frame).rmse;
                squares.push(rmse.powi(2) - ground_truth.info.frame_rmse.powi(2));
            }
        }
        squares.map(|squares| root_if_known(&squares))
    };
    let results = |(path, path_frames): (CameraPath, &PathFrames)| {
        let errors = errors_of(path_frames);
        let of_filter = |number: usize| MotionResult {
            path,
            filter: FILTERS[number],
            threads,
            frames,
            speed,
            rmse: errors[number],
            times_lower: errors[0].zip(errors[number]).map(|(unfiltered, error)| unfiltered / error),
            frame_ms: Spread::of(path_frames.frame_ms.iter().copied()),
            filter_ms: Spread::of(path_frames.filter_ms[number].iter().copied()),
            reliability: Reliability::of(&path_frames.turns, true),
        };
        [0, 1, 2].map(of_filter)
    };
    CameraPath::ALL.into_iter().zip(&paths).flat_map(results).collect()
}

/// Returns the root of a mean, if the mean is more than two of its standard errors.
fn root_if_known(squares: &[f64]) -> Option<f64> {
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let variance = squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean > 2.0 * (variance / count).sqrt()).then(|| mean.sqrt())
}

fn render_path(
    renderer: &mut Renderer,
    scene: &Scene,
    path: CameraPath,
    frames: u32,
    speed: f32,
) -> PathFrames {
    let Settings { resolution, max_bounces, .. } = *renderer.settings();
    let (mut film, mut fresh, mut aovs) = (renderer.film(), Picture::default(), Aovs::default());
    let (mut history, mut denoiser) = (History::default(), Denoiser::default());
    let mut denoiser_aovs = DenoiserAovs::default();
    let mut taken = PathFrames::default();
    let compared: Vec<u32> =
        (0..COMPARED).map(|i| frames / 2 + (2 * i + 1) * frames / (4 * COMPARED)).collect();
    for frame in 0..frames {
        let camera = path.camera(&scene.camera, frame, speed);
        renderer.set_view(&camera, resolution, max_bounces);
        renderer.set_seed(frame + 1);
        film.clear();
        let ((), frame_ms, load) = time_on_cores(renderer, || renderer.add_samples(&mut film, 1));
        taken.frame_ms.push(frame_ms);
        taken.turns.push(load);
        film.picture_into(&mut fresh);
        let ((), reprojection_ms, _) = time_on_cores(renderer, || {
            renderer.aovs_into(&mut aovs);
            history.reproject(&fresh, 1, &aovs, renderer.camera());
        });
        let (kept, counts) = (history.shown(), Samples::Each(history.counts()));
        let (clean, denoising_ms, _) = time_on_cores(renderer, || {
            renderer.denoiser_aovs_into(&aovs, &mut denoiser_aovs);
            denoiser.filter(kept, counts, &denoiser_aovs)
        });
        let filter_ms = [0.0, reprojection_ms, reprojection_ms + denoising_ms];
        taken.filter_ms.iter_mut().zip(filter_ms).for_each(|(taken, ms)| taken.push(ms));
        if compared.contains(&frame) {
            taken.compared.push((camera, [&fresh, kept, clean].map(Picture::clone)));
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_known_where_frames_agree() {
        assert_eq!(root_if_known(&[4.0, 4.0, 4.0, 4.0]), Some(2.0));
        assert_eq!(root_if_known(&[1.0, 5.0, 4.0, 6.0]), Some(2.0));
        assert_eq!(root_if_known(&[0.0, 16.0, 0.0, 0.0]), None);
        // A mean of 4, whose standard error is 2.7.
        assert_eq!(root_if_known(&[0.0, 12.0, 2.0, 2.0]), None);
        assert_eq!(root_if_known(&[-1.0, -1.0, -1.0, -1.0]), None);
    }

    /// Measures with more than enough time for all frames and all samples of the ground truths, so that no
    /// clock affects the result.
    fn reprojection_halves_the_error(scenes: &[&str], resolution: [u32; 2], most_ground_truth_samples: u32) {
        for name in scenes {
            let scene = octray_formats::scene::load(&format!("builtin:{name}")).unwrap();
            let settings = Settings { resolution, ..Settings::of(&scene) };
            let end = Instant::now() + Duration::from_secs(3600);
            let all = measure(&scene, settings, 1, end, most_ground_truth_samples);
            assert_eq!(all.len(), CameraPath::ALL.len() * FILTERS.len());
            for result in &all {
                let least = if result.filter == FILTERS[0] { 1.0 } else { 2.0 };
                assert!(result.times_lower.is_some_and(|times| times >= least), "{name}: {result:?}");
                assert!(result.frame_ms.median > 0.0 && result.speed > 0.0);
                assert_eq!(result.frames, FRAMES);
            }
        }
    }

    /// Tests one scene, with a quarter of the pixels and a quarter of the ground truth's samples, against the
    /// large version's bound of 2. The ratios here are 3.4 to 4.8. Cornell needs the large version: here its
    /// ground truth is too noisy for the errors of filtered frames to be known.
    #[test]
    fn reprojection_halves_the_error_in_motion_at_least() {
        reprojection_halves_the_error(&["three"], [48, 27], 128);
    }

    #[test]
    #[ignore = "minutes: run by .ci/run"]
    fn reprojection_halves_the_error_in_motion_at_least_on_large_frames() {
        reprojection_halves_the_error(&["cornell"], [96, 54], MOST_GROUND_TRUTH_SAMPLES / 2);
    }
}
