//! Accumulates the samples of the present pose in a film until a frame is due.

use super::dynamic_resolution::DynamicResolution;
use super::frame::Exchange;
use super::timing::{RateMeter, Summary};
use octray_engine::film::Film;
use octray_engine::render::{RenderObserver, Renderer, Settings};
use octray_formats::scene::{Camera, Scene};
use std::sync::atomic::Ordering::Acquire;
use std::thread;
use std::time::{Duration, Instant};

/// Samples per pixel after which accumulation stops and the machine idles.
const MAX_SAMPLES: u32 = 65_536;
/// A picture that has accumulated for this long keeps its resolution once the target is met, because a change
/// would discard its samples.
const SETTLE_TIME: Duration = Duration::from_secs(1);

/// The settings, apart from scene, seed and methods, that determine a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub camera: Camera,
    pub resolution: [u32; 2],
    pub bounces: u32,
}

/// The film of the present pose, and the timing of frames.
pub struct Accumulation {
    pub film: Film,
    pub pose: Pose,
    /// Whether a frame of this pose has been shown.
    pub pose_shown: bool,
    pub resolution: DynamicResolution,
    pub rates: RateMeter,
    pub summary: Summary,
    /// Whether the film holds the requested seed's samples from the first one on: a still in progress.
    pub progressive: bool,
    /// The requested seed.
    seed: u32,
    /// When the last frame was published, and when the next one is due.
    last_shown: Instant,
    due: Instant,
    /// Duration of the last complete pass.
    pass_time: Duration,
    painting_time: Duration,
    pose_since: Instant,
}

/// An observer that cancels a pass that no frame needs.
struct PassWatch<'a> {
    exchange: &'a Exchange,
    /// Whether the film already has a complete pass. Then this one is cancelled once an event is pending
    /// and a frame is due.
    optional: bool,
    due: Instant,
}

impl RenderObserver for PassWatch<'_> {
    fn is_cancelled(&self) -> bool {
        let Exchange { closed, notified, .. } = self.exchange;
        closed.load(Acquire) || (self.optional && notified.load(Acquire) && Instant::now() >= self.due)
    }
    fn sample_done(&self, _pixels: usize, _rays: u64) {}
}

impl Accumulation {
    /// Starts with an empty film for a new renderer.
    pub fn new(renderer: &Renderer, scene: &Scene) -> Self {
        let now = Instant::now();
        let &Settings { resolution, max_bounces: bounces, seed, .. } = renderer.settings();
        Self {
            film: renderer.film(),
            pose: Pose { camera: scene.camera, resolution, bounces },
            pose_shown: false,
            resolution: DynamicResolution::default(),
            rates: RateMeter::default(),
            summary: Summary::default(),
            progressive: true,
            seed,
            last_shown: now,
            due: now,
            pass_time: Duration::ZERO,
            painting_time: Duration::ZERO,
            pose_since: now,
        }
    }

    /// Starts over with another renderer; keeps the resolution scale and the timing of frames.
    pub fn reset(&mut self, renderer: &Renderer, scene: &Scene) {
        let Self { film, pose, pose_since, .. } = Self::new(renderer, scene);
        (self.film, self.pose, self.pose_since) = (film, pose, pose_since);
        (self.pose_shown, self.progressive) = (false, true);
        self.resolution.restart();
    }

    /// Sets the renderer's camera, resolution and bounces, and clears the film if they changed. A resting
    /// camera has the requested seed; a moving one has a different seed in every frame, derived from the
    /// frame's number. Returns whether resolution or bounces changed, which makes history invalid.
    pub fn set_pose(&mut self, renderer: &mut Renderer, pose: Pose) -> bool {
        let before = std::mem::replace(&mut self.pose, pose);
        if pose == before {
            if !self.progressive {
                self.progressive = true;
                self.film.clear();
                renderer.set_seed(self.seed);
            }
            return false;
        }
        renderer.set_view(&pose.camera, pose.resolution, pose.bounces);
        let other = pose.bounces != before.bounces || pose.resolution != before.resolution;
        (self.pose_shown, self.progressive) = (false, other);
        self.pose_since = Instant::now();
        if pose.resolution == before.resolution {
            self.film.clear();
        } else {
            self.film = renderer.film();
            self.resolution.restart();
        }
        if other {
            self.rates.reset();
            renderer.set_seed(self.seed);
        } else {
            renderer.set_seed(self.seed.wrapping_add(1).wrapping_add(self.summary.frames as u32));
        }
        other
    }

    /// Adds samples, at least one, until a frame is due at `rate` frames per second or the front end has
    /// closed.
    pub fn accumulate(&mut self, renderer: &Renderer, rate: f64, exchange: &Exchange) {
        // Counted from the previous due time, so that a late frame does not shorten the next one's share.
        // Lost frames are not made up for.
        let interval = Duration::from_secs_f64(1.0 / rate);
        self.due = (self.due + interval).max(self.last_shown + interval / 2);
        let due = self.due - self.painting_time.min(interval / 2);
        loop {
            if self.film.samples() >= MAX_SAMPLES {
                return thread::sleep(due.saturating_duration_since(Instant::now()));
            }
            // A resting camera already has a picture to show; a moving one needs this sample.
            let optional = self.progressive && self.film.samples() > 0;
            let watch = PassWatch { exchange, optional, due };
            let (start, before) = (Instant::now(), (self.film.pixel_samples(), self.film.rays()));
            renderer.add_samples_observed(&mut self.film, 1, &watch);
            let time = start.elapsed();
            let pixels = f64::from(self.pose.resolution[0]) * f64::from(self.pose.resolution[1]);
            let passes = (self.film.pixel_samples() - before.0) as f64 / pixels;
            self.summary.passes += passes;
            self.summary.tracing += time;
            // A cancelled pass is not measured.
            if passes == 1.0 {
                self.rates.pass(renderer.settings().lanes, self.film.rays() - before.1, time);
                self.pass_time = time;
            }
            if exchange.closed.load(Acquire) || Instant::now() + self.pass_time / 2 >= due {
                return;
            }
        }
    }

    /// Records a published frame: when its painting started, and the time of the oldest event that it shows.
    pub fn frame_shown(&mut self, start: Instant, event: Option<Instant>) {
        let now = Instant::now();
        let since = now - self.last_shown;
        (self.last_shown, self.painting_time, self.pose_shown) = (now, now - start, true);
        self.rates.frame(since);
        self.summary.painting += self.painting_time;
        self.summary.frame(since, event.map(|at| now - at));
    }

    /// Lowers the resolution when frames take longer than the target allows, raises it when there is time.
    pub fn adapt_resolution(&mut self, target: Option<u32>) {
        // The wait for the display does not count: no resolution shortens it.
        let needed = self.pass_time + self.painting_time;
        let settled = self.progressive && self.pose_since.elapsed() >= SETTLE_TIME;
        self.resolution.adapt(target, needed, settled);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_formats::scene::load;

    struct Test {
        renderer: Renderer,
        accumulation: Accumulation,
    }

    impl Test {
        fn new(resolution: [u32; 2]) -> Self {
            let scene = load("builtin:three").unwrap();
            let renderer = Renderer::new(&scene, Settings { resolution, seed: 5, ..Settings::of(&scene) });
            let accumulation = Accumulation::new(&renderer, &scene);
            Self { renderer, accumulation }
        }
        /// Sets a pose in a frame of this number and adds two samples. Returns whether history is invalid,
        /// the seed, and the number of samples.
        fn go(&mut self, pose: Pose, frame: u64) -> (bool, u32, u32) {
            self.accumulation.summary.frames = frame;
            let other = self.accumulation.set_pose(&mut self.renderer, pose);
            self.renderer.add_samples(&mut self.accumulation.film, 2);
            (other, self.renderer.settings().seed, self.accumulation.film.samples())
        }
    }

    /// The picture of a resting camera has the bits of a still and does not depend on earlier frames.
    #[test]
    fn a_camera_that_comes_to_rest_accumulates_the_samples_of_a_still() {
        let mut test = Test::new([24, 16]);
        let home = test.accumulation.pose;
        let away = Pose { camera: Camera { vertical_fov: 30.0, ..home.camera }, ..home };
        assert_eq!(test.go(home, 0), (false, 5, 2));
        assert_eq!(test.go(away, 1), (false, 7, 2));
        assert_eq!(test.go(home, 2), (false, 8, 2));
        assert_eq!(test.go(home, 3), (false, 5, 2), "at rest: from the first sample on");
        assert_eq!(test.go(home, 4), (false, 5, 4));
        let still = Test::new([24, 16]).renderer;
        let mut film = still.film();
        still.add_samples(&mut film, 4);
        assert_eq!(test.accumulation.film.picture(), film.picture());
        let deep = Pose { bounces: home.bounces + 1, ..home };
        assert_eq!(test.go(deep, 5), (true, 5, 2), "another picture begins at once");
        assert_eq!(test.go(Pose { resolution: [12, 8], ..deep }, 6), (true, 5, 2));
        assert_eq!(test.accumulation.film.resolution(), [12, 8]);
    }

    #[test]
    fn neither_a_delayed_frame_nor_a_settled_picture_changes_the_resolution() {
        let mut accumulation = Test::new([24, 16]).accumulation;
        let hold = |accumulation: &mut Accumulation, ms, times| {
            accumulation.pass_time = Duration::from_millis(ms);
            (0..times).for_each(|_| accumulation.adapt_resolution(Some(30)));
            accumulation.resolution.scale
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
    fn accumulation_stops_at_the_maximum_of_samples() {
        // One pixel, so that it has all of its samples soon.
        let Test { renderer, mut accumulation } = Test::new([1, 1]);
        renderer.add_samples(&mut accumulation.film, MAX_SAMPLES - 1);
        for _ in 0..2 {
            accumulation.accumulate(&renderer, 1e9, &Exchange::default());
            assert_eq!(accumulation.film.most_samples(), MAX_SAMPLES);
        }
    }
}
