//! What a window shows while the camera moves: frames of one sample, by themselves and with what earlier ones saw.
//!
//! For: [`measure`]. May import: `display`, `truth`, `errors`. Must never know: how it is drawn.
//!
//! The camera goes sideways and forwards at walking speed, and turns, at 60 frames a second: [`FRAMES`] of them with a seed each. Four frames
//! of the second half are held against truths of their own.

use super::pictures::Spread;
use super::truth::{Making, Truth};
use crate::display::{Denoiser, History, Samples, walking_speed};
use crate::film::Picture;
use crate::integrate::aovs::Aovs;
use crate::measure::errors::Errors;
use crate::render::{Renderer, Settings};
use crate::scene::{Camera, Scene};
use glam::Quat;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Frames of a path; fewer where they would take more than their share of the time, but not fewer than [`LEAST_FRAMES`].
pub const FRAMES: u32 = 48;
pub const LEAST_FRAMES: u32 = 16;
const A_SECOND: f32 = 60.0;
/// Radians a second.
const TURN: f32 = std::f32::consts::FRAC_PI_6;
/// The ways to show a frame, the first as it is.
pub const WAYS: [&str; 3] = ["as it is", "reprojected", "reprojected, denoised"];
/// How many frames of a path are judged.
const JUDGED: u32 = 4;
/// The share of the time in which frames are made; truths have the rest.
const FRAMES_SHARE: f64 = 0.6;
/// Enough for a truth.
const MOST_TRUTH_SAMPLES: u32 = 1_024;

/// How the camera moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Path {
    Sideways,
    Forwards,
    Turning,
}

impl Path {
    pub const ALL: [Self; 3] = [Self::Sideways, Self::Forwards, Self::Turning];

    pub fn name(self) -> &'static str {
        match self {
            Self::Sideways => "sideways",
            Self::Forwards => "forwards",
            Self::Turning => "turning",
        }
    }

    /// The camera in the frame of this number; `speed` in scene units a second.
    fn camera(self, from: &Camera, frame: u32, speed: f32) -> Camera {
        let seconds = frame as f32 / A_SECOND;
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

/// One path, shown in one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moving {
    pub path: Path,
    pub way: &'static str,
    pub threads: usize,
    pub frames: u32,
    /// Scene units a second.
    pub speed: f32,
    /// Root mean square over the judged frames, the truths' own error taken out; null where what is left is not more than chance makes: two
    /// standard errors of the mean square over the frames.
    pub rmse: Option<f64>,
    /// How many times as large that of the frames as they are is; null where one of the two is not known.
    pub times_lower: Option<f64>,
    /// To take the frame's sample, and then to show it, guides included.
    pub frame_ms: Spread,
    pub filter_ms: Spread,
}

/// A path while it is walked: times by frame, and the judged pictures by way, with their cameras.
struct Walk {
    frame_ms: Vec<f64>,
    filter_ms: [Vec<f64>; 3],
    judged: Vec<(Camera, [Picture; 3])>,
}

/// Walks all paths, and then judges them in the time that is left. `settings` are those of frames.
pub fn measure(scene: &Scene, settings: Settings, threads: usize, end: Instant) -> Vec<Moving> {
    measure_to(scene, settings, threads, end, MOST_TRUTH_SAMPLES)
}

/// As [`measure`], with so many samples of a truth at most.
fn measure_to(
    scene: &Scene,
    settings: Settings,
    threads: usize,
    end: Instant,
    most_truth_samples: u32,
) -> Vec<Moving> {
    let start = Instant::now();
    let settings = Settings { threads, ..settings };
    let mut renderer = Renderer::new(scene, settings);
    let mut guides = Aovs::default();
    renderer.aovs_into(&mut guides);
    let speed = walking_speed(&guides);
    let frames = {
        renderer.add_samples(&mut renderer.film(), 1);
        let start_of_frame = Instant::now();
        renderer.add_samples(&mut renderer.film(), 1);
        renderer.aovs_into(&mut guides);
        let share = end.saturating_duration_since(start).as_secs_f64() * FRAMES_SHARE;
        let frame = 1.5 * start_of_frame.elapsed().as_secs_f64();
        ((share / (Path::ALL.len() as f64 * frame)) as u32).clamp(LEAST_FRAMES, FRAMES)
    };
    let walks = Path::ALL.map(|path| walk(&mut renderer, scene, path, frames, speed));
    drop(renderer);

    let mut making = Making::new(scene, settings, threads);
    let mut left = (Path::ALL.len() as u32) * JUDGED;
    let mut judge = |walk: &Walk| {
        let mut squares = [const { Vec::new() }; 3];
        for (camera, pictures) in &walk.judged {
            making.look(scene, camera, &settings);
            let now = Instant::now();
            let share = end.saturating_duration_since(now) / left;
            left -= 1;
            let truth: Truth = making.until(now + share, most_truth_samples, Duration::ZERO);
            for (squares, picture) in squares.iter_mut().zip(pictures) {
                // Without a bias, however rough the truth: its halves are independent, and this is the mean of (x − a)(x − b).
                squares
                    .push(Errors::of(picture, &truth.frame).rmse.powi(2) - truth.quality.frame_rmse.powi(2));
            }
        }
        squares.map(|squares| root_if_known(&squares))
    };
    let moving = |(path, walk): (Path, &Walk)| {
        let errors = judge(walk);
        let of_way = |number: usize| Moving {
            path,
            way: WAYS[number],
            threads,
            frames,
            speed,
            rmse: errors[number],
            times_lower: errors[0].zip(errors[number]).map(|(plain, error)| plain / error),
            frame_ms: Spread::of(&walk.frame_ms),
            filter_ms: Spread::of(&walk.filter_ms[number]),
        };
        [0, 1, 2].map(of_way)
    };
    Path::ALL.into_iter().zip(&walks).flat_map(moving).collect()
}

/// The root of a mean, if the mean is more than two of its standard errors.
fn root_if_known(squares: &[f64]) -> Option<f64> {
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let variance = squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean > 2.0 * (variance / count).sqrt()).then(|| mean.sqrt())
}

fn walk(renderer: &mut Renderer, scene: &Scene, path: Path, frames: u32, speed: f32) -> Walk {
    let Settings { resolution, max_bounces, .. } = *renderer.settings();
    let (mut film, mut fresh, mut guides) = (renderer.film(), Picture::default(), Aovs::default());
    let (mut history, mut denoiser) = (History::new(), Denoiser::new());
    let mut walk = Walk { frame_ms: Vec::new(), filter_ms: [const { Vec::new() }; 3], judged: Vec::new() };
    let judged: Vec<u32> = (0..JUDGED).map(|i| frames / 2 + (2 * i + 1) * frames / (4 * JUDGED)).collect();
    for frame in 0..frames {
        let camera = path.camera(&scene.camera, frame, speed);
        renderer.set_view(scene, &camera, resolution, max_bounces);
        renderer.set_seed(frame + 1);
        film.clear();
        let ms = |start: Instant| 1e3 * start.elapsed().as_secs_f64();
        let start = Instant::now();
        renderer.add_samples(&mut film, 1);
        walk.frame_ms.push(ms(start));
        film.picture_into(&mut fresh);
        let start = Instant::now();
        renderer.on_threads(|| {
            renderer.aovs_into(&mut guides);
            history.reproject(&fresh, 1, &guides, renderer.camera());
        });
        let reprojected = ms(start);
        let start = Instant::now();
        let (kept, counts) = (history.shown(), Samples::Each(history.counts()));
        let clean = renderer.on_threads(|| denoiser.filter(kept, counts, &guides));
        for (taken, ms) in walk.filter_ms.iter_mut().zip([0.0, reprojected, reprojected + ms(start)]) {
            taken.push(ms);
        }
        if judged.contains(&frame) {
            walk.judged.push((camera, [&fresh, kept, clean].map(Picture::clone)));
        }
    }
    walk
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_go_where_their_names_say() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let from = scene.camera;
        let of = |path: Path| path.camera(&from, 60, 2.0);
        let forward = (from.look_at - from.position).normalize();
        let [sideways, forwards, turning] = Path::ALL.map(of);
        let step = sideways.position - from.position;
        assert!((step.length() - 2.0).abs() < 1e-4 && step.dot(forward).abs() < 1e-4);
        assert!((forwards.position - from.position - 2.0 * forward).length() < 1e-4);
        assert_eq!(turning.position, from.position);
        let looks = (turning.look_at - turning.position).normalize();
        let right = forward.cross(from.up).normalize();
        assert!(looks.dot(right) > 0.4, "30° to the right");
        assert_eq!(Path::Turning.camera(&from, 0, 2.0).position, from.position);
    }

    #[test]
    fn errors_are_known_where_frames_agree() {
        assert_eq!(root_if_known(&[4.0, 4.0, 4.0, 4.0]), Some(2.0));
        assert_eq!(root_if_known(&[1.0, 5.0, 4.0, 6.0]), Some(2.0));
        assert_eq!(root_if_known(&[0.0, 16.0, 0.0, 0.0]), None);
        // A mean of 4, whose standard error is 2.7.
        assert_eq!(root_if_known(&[0.0, 12.0, 2.0, 2.0]), None);
        assert_eq!(root_if_known(&[-1.0, -1.0, -1.0, -1.0]), None);
    }

    /// Errors are measured without a bias however rough the truths are: 48 samples, whose error is a seventh of a frame's, tell 2 from 1.5.
    #[test]
    fn reprojection_halves_the_error_in_motion_at_least() {
        check_halving([48, 27], 48);
    }

    #[test]
    #[ignore = "minutes: run by .ci/run"]
    fn reprojection_halves_the_error_in_motion_at_least_by_good_truths() {
        check_halving([96, 54], 256);
    }

    /// Given more time than it needs, it makes all frames and takes all samples of the truths: no clock has a say in the result.
    fn check_halving(resolution: [u32; 2], truth_samples: u32) {
        for name in ["three", "cornell"] {
            let scene = octray_formats::scene::load(&format!("builtin:{name}")).unwrap();
            let settings = Settings { resolution, ..Settings::of(&scene) };
            let end = Instant::now() + Duration::from_secs(3600);
            let all = measure_to(&scene, settings, 1, end, truth_samples);
            assert_eq!(all.len(), Path::ALL.len() * WAYS.len());
            for moving in &all {
                let least = if moving.way == "as it is" { 1.0 } else { 2.0 };
                assert!(moving.times_lower.is_some_and(|times| times >= least), "{name}: {moving:?}");
                assert!(moving.frame_ms.median > 0.0 && moving.speed > 0.0);
                assert_eq!(moving.frames, FRAMES);
            }
        }
    }
}
