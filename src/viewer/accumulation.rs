//! Accumulates samples: the film of the present pose, samples until a frame is due, dynamic resolution.
//!
//! For: [`Accumulation`]. May import: `render`, `film`, `timing`, `frame` (for cancellation). Must not know:
//! events, windows, how the film is displayed.

use super::frame::Exchange;
use super::timing::{RateMeter, Summary};
use crate::film::Film;
use crate::render::{RenderObserver, Renderer};
use crate::scene::{Camera, Scene};
use std::thread;
use std::time::{Duration, Instant};

/// Samples per pixel after which accumulation stops and the machine idles.
const MAX_SAMPLES: u32 = 65_536;
/// Shares of the target frame time: what a new resolution aims at, and below what a higher resolution is
/// chosen.
const TARGET_SHARE: f64 = 0.95;
const MIN_SHARE: f64 = 0.6;
/// Lowest resolution scale.
const MIN_RESOLUTION_SCALE: f64 = 0.05;
/// Number of frames whose fastest decides: one frame alone may have been delayed by something else.
const DECIDING_FRAMES: u32 = 2;
/// Count and fastest time of no frames.
const NO_FRAMES: (u32, Duration) = (0, Duration::MAX);
/// A picture that has accumulated for this long keeps its resolution once the target is met: a change would
/// discard its samples.
const SETTLE_TIME: Duration = Duration::from_secs(1);

/// What determines a picture apart from scene, seed and methods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub camera: Camera,
    pub resolution: [u32; 2],
    pub bounces: u32,
}

/// How a pose differs from the previous one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseChange {
    /// Same camera, resolution and bounces.
    Same,
    /// Another camera: history can be reprojected.
    Moved,
    /// Another resolution or number of bounces: history is invalid.
    Other,
}

/// The film of the present pose, and the timing of frames.
pub struct Accumulation {
    pub film: Film,
    pub pose: Pose,
    /// Whether a frame of this pose has been shown.
    pub pose_shown: bool,
    /// Scale of the resolution's sides that holds the target frame rate; at most 1.
    pub resolution_scale: f64,
    /// Whether the film holds the requested seed's samples from the first one on: a still in progress.
    pub progressive: bool,
    /// When the last frame was published, and when the next one is due.
    last_shown: Instant,
    due: Instant,
    /// Duration of the last sample of the whole picture, and of painting the last frame.
    sample_time: Duration,
    painting_time: Duration,
    /// Count and fastest time of the frames since the last decision about the resolution.
    fastest: (u32, Duration),
    /// Whether the frame time was within the target's bounds at the last decision.
    target_met: bool,
    /// When the pose last changed.
    pose_since: Instant,
}

/// Cancels a sample that is not needed for a frame.
struct SampleWatch<'a> {
    exchange: &'a Exchange,
    /// Whether the film already has a complete sample. Then this one is cancelled once an event is pending
    /// and a frame is due.
    optional: bool,
    due: Instant,
}

impl RenderObserver for SampleWatch<'_> {
    fn is_cancelled(&self) -> bool {
        self.exchange.is_closed()
            || (self.optional && self.exchange.is_notified() && Instant::now() >= self.due)
    }
    fn sample_done(&self, _pixels: usize, _rays: u64) {}
}

impl Accumulation {
    /// For a new renderer, with an empty film.
    pub fn new(renderer: &Renderer, scene: &Scene) -> Self {
        let settings = renderer.settings();
        let pose =
            Pose { camera: scene.camera, resolution: settings.resolution, bounces: settings.max_bounces };
        let now = Instant::now();
        Self {
            film: renderer.film(),
            pose,
            pose_shown: false,
            resolution_scale: 1.0,
            progressive: true,
            last_shown: now,
            due: now,
            sample_time: Duration::ZERO,
            painting_time: Duration::ZERO,
            fastest: NO_FRAMES,
            target_met: false,
            pose_since: now,
        }
    }

    /// Starts over with another renderer; keeps the resolution scale and the frame timing.
    pub fn reset(&mut self, renderer: &Renderer, scene: &Scene) {
        let Self { resolution_scale, last_shown, due, sample_time, painting_time, .. } = *self;
        *self = Self {
            resolution_scale,
            last_shown,
            due,
            sample_time,
            painting_time,
            ..Self::new(renderer, scene)
        };
    }

    /// Sets the renderer's camera, resolution and bounces, and clears the film if they changed. A resting
    /// camera has the requested seed; a moving one has a different seed in every frame, derived from the
    /// frame's number.
    pub fn set_pose(
        &mut self,
        renderer: &mut Renderer,
        scene: &Scene,
        pose: Pose,
        seed: u32,
        frame: u64,
    ) -> PoseChange {
        let before = std::mem::replace(&mut self.pose, pose);
        if pose == before {
            if !self.progressive {
                self.progressive = true;
                self.film.clear();
                renderer.set_seed(seed);
            }
            return PoseChange::Same;
        }
        renderer.set_view(scene, &pose.camera, pose.resolution, pose.bounces);
        let other = pose.bounces != before.bounces || pose.resolution != before.resolution;
        (self.pose_shown, self.progressive) = (false, other);
        self.pose_since = Instant::now();
        if pose.resolution == before.resolution {
            self.film.clear();
        } else {
            self.film = renderer.film();
            (self.fastest, self.target_met) = (NO_FRAMES, false);
        }
        renderer.set_seed(if other { seed } else { seed.wrapping_add(1).wrapping_add(frame as u32) });
        if other { PoseChange::Other } else { PoseChange::Moved }
    }

    /// Adds samples, at least one, until a frame is due at `rate` frames per second or the front end has
    /// closed.
    pub fn accumulate(
        &mut self,
        renderer: &Renderer,
        rate: f64,
        exchange: &Exchange,
        (rates, summary): (&mut RateMeter, &mut Summary),
    ) {
        // Counted from the previous due time: a late frame does not shorten the next one's share, and lost
        // frames are not made up for.
        let interval = Duration::from_secs_f64(1.0 / rate);
        self.due = (self.due + interval).max(self.last_shown + interval / 2);
        let due = self.due - self.painting_time.min(interval / 2);
        loop {
            if self.film.samples() >= MAX_SAMPLES {
                return thread::sleep(due.saturating_duration_since(Instant::now()));
            }
            // A resting camera already has a picture to show; a moving one needs this sample.
            let optional = self.progressive && self.film.samples() > 0;
            let watch = SampleWatch { exchange, optional, due };
            let (start, before) = (Instant::now(), (self.film.pixel_samples(), self.film.rays()));
            renderer.add_samples_observed(&mut self.film, 1, &watch);
            let time = start.elapsed();
            let pixels = f64::from(self.pose.resolution[0]) * f64::from(self.pose.resolution[1]);
            let samples = (self.film.pixel_samples() - before.0) as f64 / pixels;
            rates.samples(renderer.settings().lanes, samples, self.film.rays() - before.1, time);
            summary.samples += samples;
            summary.tracing += time;
            if samples == 1.0 {
                self.sample_time = time;
            }
            if exchange.is_closed() || Instant::now() + self.sample_time / 2 >= due {
                return;
            }
        }
    }

    /// Records that a frame was published and how long it took to paint; returns the time since the previous
    /// frame.
    pub fn frame_shown(&mut self, now: Instant, painting: Duration) -> Duration {
        let since = now - self.last_shown;
        (self.last_shown, self.painting_time, self.pose_shown) = (now, painting, true);
        since
    }

    /// Lowers the resolution when frames take longer than the target allows, raises it when there is time.
    pub fn adapt_resolution(&mut self, target: Option<u32>) {
        let Some(target) = target else {
            self.resolution_scale = 1.0;
            return;
        };
        // Without the wait for the display, which no resolution shortens.
        let needed = self.sample_time + self.painting_time;
        self.fastest = (self.fastest.0 + 1, self.fastest.1.min(needed));
        if self.fastest.0 < DECIDING_FRAMES
            || (self.target_met && self.progressive && self.pose_since.elapsed() >= SETTLE_TIME)
        {
            return;
        }
        let (needed, wanted) = (self.fastest.1.as_secs_f64(), 1.0 / f64::from(target));
        self.fastest = NO_FRAMES;
        self.target_met = (wanted * MIN_SHARE..wanted * 1.05).contains(&needed);
        if !self.target_met {
            // Frame time is proportional to the number of pixels, the square of the scale.
            let step = (TARGET_SHARE * wanted / needed.max(1e-9)).sqrt();
            self.resolution_scale = (self.resolution_scale * step).clamp(MIN_RESOLUTION_SCALE, 1.0);
        }
    }

    /// Completes a partial sample, so that all pixels have the same number of samples, at least one.
    pub fn equalize_samples(&mut self, renderer: &Renderer) {
        let uneven = self.film.most_samples().max(1) - self.film.samples();
        renderer.add_samples(&mut self.film, uneven);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Settings;
    use crate::scene::load;

    fn start() -> (Renderer, Scene, Accumulation) {
        let scene = load("builtin:three").unwrap();
        let settings = Settings { resolution: [24, 16], seed: 5, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let accumulation = Accumulation::new(&renderer, &scene);
        (renderer, scene, accumulation)
    }

    /// A resting camera's picture has the bits of a still, whatever was rendered before it.
    #[test]
    fn a_camera_that_comes_to_rest_accumulates_the_samples_of_a_still() {
        let (mut renderer, scene, mut accumulation) = start();
        let home = accumulation.pose;
        let away = Pose { camera: Camera { vertical_fov: 30.0, ..home.camera }, ..home };
        let mut go = |accumulation: &mut Accumulation, pose, frame| {
            let change = accumulation.set_pose(&mut renderer, &scene, pose, 5, frame);
            renderer.add_samples(&mut accumulation.film, 2);
            (change, renderer.settings().seed, accumulation.film.samples())
        };
        assert_eq!(go(&mut accumulation, home, 0), (PoseChange::Same, 5, 2));
        assert_eq!(go(&mut accumulation, away, 1), (PoseChange::Moved, 7, 2));
        assert_eq!(go(&mut accumulation, home, 2), (PoseChange::Moved, 8, 2));
        assert_eq!(
            go(&mut accumulation, home, 3),
            (PoseChange::Same, 5, 2),
            "at rest: from the first sample on"
        );
        assert_eq!(go(&mut accumulation, home, 4), (PoseChange::Same, 5, 4));
        let (still, ..) = start();
        let mut film = still.film();
        still.add_samples(&mut film, 4);
        assert_eq!(accumulation.film.picture(), film.picture());
        let deep = Pose { bounces: home.bounces + 1, ..home };
        assert_eq!(
            go(&mut accumulation, deep, 5),
            (PoseChange::Other, 5, 2),
            "another picture begins at once"
        );
        let small = Pose { resolution: [12, 8], ..deep };
        assert_eq!(go(&mut accumulation, small, 6), (PoseChange::Other, 5, 2));
        assert_eq!(accumulation.film.resolution(), [12, 8]);
    }

    #[test]
    fn resolution_drops_as_far_as_the_frame_rate_needs_and_no_further() {
        let (.., mut accumulation) = start();
        // A machine that takes 100 ms for all pixels.
        let mut settle = |target| {
            for _ in 0..300 {
                accumulation.sample_time =
                    Duration::from_secs_f64(0.1 * accumulation.resolution_scale.powi(2));
                accumulation.adapt_resolution(target);
            }
            (accumulation.resolution_scale, 0.1 * accumulation.resolution_scale.powi(2))
        };
        let (coarse, takes) = settle(Some(30));
        assert!(coarse < 1.0 && (0.5 / 30.0..1.05 / 30.0).contains(&takes), "{takes} s");
        assert_eq!(settle(Some(30)).0, coarse, "at rest");
        assert!(settle(Some(60)).0 < coarse);
        assert_eq!(settle(Some(5)).0, 1.0);
        assert!(settle(Some(1_000)).0 < coarse);
        assert_eq!(settle(None).0, 1.0);
    }

    #[test]
    fn a_frame_rate_is_held_after_a_few_frames() {
        let (.., mut accumulation) = start();
        let mut after = |frames, target| {
            for _ in 0..frames {
                accumulation.sample_time =
                    Duration::from_secs_f64(0.4 * accumulation.resolution_scale.powi(2));
                accumulation.adapt_resolution(Some(target));
            }
            accumulation.sample_time.as_secs_f64() * f64::from(target)
        };
        let takes = [after(3, 30), after(3, 60), after(3, 20)];
        assert!(takes.iter().all(|share| (0.6..1.05).contains(share)), "shares of the time: {takes:?}");
    }

    #[test]
    fn neither_a_delayed_frame_nor_a_settled_picture_changes_the_resolution() {
        let (.., mut accumulation) = start();
        let hold = |accumulation: &mut Accumulation, ms, times| {
            accumulation.sample_time = Duration::from_millis(ms);
            (0..times).for_each(|_| accumulation.adapt_resolution(Some(30)));
            accumulation.resolution_scale
        };
        for _ in 0..10 {
            assert_eq!(hold(&mut accumulation, 20, 2), 1.0);
            assert_eq!(hold(&mut accumulation, 500, 1), 1.0, "delayed");
        }
        assert_eq!(hold(&mut accumulation, 20, 2), 1.0);
        accumulation.pose_since = Instant::now().checked_sub(SETTLE_TIME).unwrap();
        assert_eq!(hold(&mut accumulation, 500, 10), 1.0, "the camera rests");
        accumulation.progressive = false;
        assert!(hold(&mut accumulation, 500, 3) < 1.0, "the camera moves");
    }

    #[test]
    fn resolution_of_a_slow_picture_drops_at_a_resting_camera_too() {
        let (.., mut accumulation) = start();
        accumulation.pose_since = Instant::now().checked_sub(SETTLE_TIME).unwrap();
        accumulation.sample_time = Duration::from_secs(2);
        (0..DECIDING_FRAMES).for_each(|_| accumulation.adapt_resolution(Some(30)));
        assert!(accumulation.resolution_scale < 0.2, "{}", accumulation.resolution_scale);
        accumulation.sample_time = Duration::from_secs(200);
        (0..DECIDING_FRAMES).for_each(|_| accumulation.adapt_resolution(Some(30)));
        assert_eq!(accumulation.resolution_scale, MIN_RESOLUTION_SCALE, "no coarser, however slow");
    }

    #[test]
    fn frame_times_that_vary_a_little_keep_the_resolution() {
        let (.., mut accumulation) = start();
        let mut hold = |ms, times| {
            for _ in 0..times {
                accumulation.sample_time =
                    Duration::from_secs_f64(ms * 1e-3 * accumulation.resolution_scale.powi(2));
                accumulation.adapt_resolution(Some(30));
            }
            accumulation.resolution_scale
        };
        let coarse = hold(100.0, 10);
        for ms in [90.0, 105.0, 80.0, 100.0, 70.0] {
            assert_eq!(hold(ms, 4), coarse, "{ms} ms for all pixels, where 100 were");
        }
        assert!(hold(50.0, 4) > coarse && hold(150.0, 4) < coarse);
    }

    #[test]
    fn a_closed_window_cancels_the_sample() {
        let (renderer, _, mut accumulation) = start();
        let (exchange, mut rates, mut summary) =
            (Exchange::default(), RateMeter::default(), Summary::default());
        exchange.notify();
        accumulation.accumulate(&renderer, 1e9, &exchange, (&mut rates, &mut summary));
        assert_eq!(
            accumulation.film.samples(),
            1,
            "the first sample of a picture is never cancelled by an event"
        );
        accumulation.film.clear();
        exchange.close();
        accumulation.accumulate(&renderer, 1.0, &exchange, (&mut rates, &mut summary));
        assert_eq!(accumulation.film.most_samples(), 0);
        accumulation.equalize_samples(&renderer);
        assert_eq!(accumulation.film.samples(), 1, "a screenshot completes it");
    }

    #[test]
    fn accumulation_stops_for_events_and_at_the_maximum_of_samples() {
        let (renderer, _, mut accumulation) = start();
        let (exchange, mut rates, mut summary) =
            (Exchange::default(), RateMeter::default(), Summary::default());
        let mut accumulate = |accumulation: &mut Accumulation, renderer: &Renderer, exchange: &Exchange| {
            accumulation.accumulate(renderer, 1e9, exchange, (&mut rates, &mut summary));
            accumulation.film.most_samples()
        };
        assert_eq!(accumulate(&mut accumulation, &renderer, &exchange), 1);
        assert_eq!(accumulate(&mut accumulation, &renderer, &exchange), 2);
        exchange.notify();
        assert_eq!(
            accumulate(&mut accumulation, &renderer, &exchange),
            2,
            "an event cancels the next sample"
        );
        exchange.clear_notification();
        // One pixel, so that it has all of its samples soon.
        let scene = load("builtin:three").unwrap();
        let renderer = Renderer::new(&scene, Settings { resolution: [1, 1], ..Settings::of(&scene) });
        accumulation.reset(&renderer, &scene);
        renderer.add_samples(&mut accumulation.film, MAX_SAMPLES - 1);
        assert_eq!(accumulate(&mut accumulation, &renderer, &exchange), MAX_SAMPLES);
        assert_eq!(accumulate(&mut accumulation, &renderer, &exchange), MAX_SAMPLES);
    }
}
