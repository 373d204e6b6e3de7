//! What the film sees, and for how long: where the camera stands, whether it moves, and when a frame is due.
//!
//! For: [`Exposure`]. May import: `render`, `rates`. Must never know: events, windows, what becomes of the film.

use super::frame::Exchange;
use super::rates::Rates;
use super::summary::Summary;
use crate::film::Film;
use crate::render::{RenderObserver, Renderer};
use crate::scene::{Camera, Scene};
use std::thread;
use std::time::{Duration, Instant};

/// Samples after which a standing picture is left as it is, and the machine alone.
const MOST_SAMPLES: u32 = 65_536;
/// Shares of the time that a frame may take: what pixels that hold a frame rate are chosen for, and with less than what finer ones are chosen.
const AIM: f64 = 0.95;
const SPARE: f64 = 0.6;
/// How coarse they become at most.
const COARSEST: f64 = 0.05;
/// Frames that this is decided by, their fastest: one that something else held up says nothing. And the fastest of none.
const TRIED: u32 = 2;
const NONE: (u32, Duration) = (0, Duration::MAX);
/// A picture that has stood for so long keeps its pixels, once they are as coarse as they should be: others would begin it anew.
const SETTLED: Duration = Duration::from_secs(1);

/// What a picture is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub camera: Camera,
    pub resolution: [u32; 2],
    pub bounces: u32,
}

/// What a pose is to the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The same.
    None,
    /// The same things from elsewhere.
    Moved,
    /// Another picture.
    Other,
}

/// The film of the frame under way, and its times.
pub struct Exposure {
    pub film: Film,
    pub pose: Pose,
    /// Was a frame of this pose shown?
    pub known: bool,
    /// Of the pixels that hold a frame rate: 1 for none coarser than they were.
    pub coarseness: f64,
    /// Does the film hold samples of the seed that was asked for, from the first one on?
    pub still: bool,
    /// When the last frame was handed over, and when the next one is due.
    shown: Instant,
    due: Instant,
    /// How long the last sample took, and painting the last frame.
    sample: Duration,
    painting: Duration,
    /// What frames of this resolution took at least, since one was chosen: so many, the fastest.
    fastest: (u32, Duration),
    /// Do frames of this resolution take as long as the target allows, as far as was seen?
    fits: bool,
    /// When the picture became what it is.
    since: Instant,
}

/// Stops samples that nobody waits for.
struct Impatience<'a> {
    exchange: &'a Exchange,
    /// Is there a picture without this sample? Then it is stopped as soon as something happens and a frame is due.
    spare: bool,
    due: Instant,
}

impl RenderObserver for Impatience<'_> {
    fn is_cancelled(&self) -> bool {
        self.exchange.is_left() || (self.spare && self.exchange.has_news() && Instant::now() >= self.due)
    }
    fn sample_done(&self, _pixels: usize, _rays: u64) {}
}

impl Exposure {
    /// For a renderer that is new: nothing is known of its pictures.
    pub fn new(renderer: &Renderer, scene: &Scene) -> Self {
        let settings = renderer.settings();
        let pose =
            Pose { camera: scene.camera, resolution: settings.resolution, bounces: settings.max_bounces };
        let now = Instant::now();
        Self {
            film: renderer.film(),
            pose,
            known: false,
            coarseness: 1.0,
            still: true,
            shown: now,
            due: now,
            sample: Duration::ZERO,
            painting: Duration::ZERO,
            fastest: NONE,
            fits: false,
            since: now,
        }
    }

    /// The same for another renderer in the place of the one before.
    pub fn renew(&mut self, renderer: &Renderer, scene: &Scene) {
        let Self { coarseness, shown, due, sample, painting, .. } = *self;
        *self = Self { coarseness, shown, due, sample, painting, ..Self::new(renderer, scene) };
    }

    /// Points the renderer where the camera is, and gives what it sees a film of its own. A standing picture has the seed that was asked
    /// for, a moving one another in every frame, `frame` being its number.
    pub fn point(
        &mut self,
        renderer: &mut Renderer,
        scene: &Scene,
        pose: Pose,
        seed: u32,
        frame: u64,
    ) -> Change {
        let before = std::mem::replace(&mut self.pose, pose);
        if pose == before {
            if !self.still {
                self.still = true;
                self.film.clear();
                renderer.set_seed(seed);
            }
            return Change::None;
        }
        renderer.set_view(scene, &pose.camera, pose.resolution, pose.bounces);
        let other = pose.bounces != before.bounces || pose.resolution != before.resolution;
        (self.known, self.still) = (false, other);
        self.since = Instant::now();
        if pose.resolution == before.resolution {
            self.film.clear();
        } else {
            self.film = renderer.film();
            (self.fastest, self.fits) = (NONE, false);
        }
        renderer.set_seed(if other { seed } else { seed.wrapping_add(1).wrapping_add(frame as u32) });
        if other { Change::Other } else { Change::Moved }
    }

    /// Takes samples, at least one, until a frame is due at a rate of so many a second, or nobody waits for it.
    pub fn expose(
        &mut self,
        renderer: &Renderer,
        rate: f64,
        exchange: &Exchange,
        (rates, summary): (&mut Rates, &mut Summary),
    ) {
        // From when the last one was due: a frame that came late takes nothing from those behind it, but there is no catching up.
        let interval = Duration::from_secs_f64(1.0 / rate);
        self.due = (self.due + interval).max(self.shown + interval / 2);
        let due = self.due - self.painting.min(interval / 2);
        loop {
            if self.film.samples() >= MOST_SAMPLES {
                return thread::sleep(due.saturating_duration_since(Instant::now()));
            }
            // Whoever looks at a standing picture has one already; whoever moves needs this one.
            let spare = self.still && self.film.samples() > 0;
            let watch = Impatience { exchange, spare, due };
            let (start, before) = (Instant::now(), (self.film.pixel_samples(), self.film.rays()));
            renderer.add_samples_observed(&mut self.film, 1, &watch);
            let time = start.elapsed();
            let pixels = f64::from(self.pose.resolution[0]) * f64::from(self.pose.resolution[1]);
            let samples = (self.film.pixel_samples() - before.0) as f64 / pixels;
            rates.samples(renderer.settings().lanes, samples, self.film.rays() - before.1, time);
            summary.samples += samples;
            summary.tracing += time;
            if samples == 1.0 {
                self.sample = time;
            }
            if exchange.is_left() || Instant::now() + self.sample / 2 >= due {
                return;
            }
        }
    }

    /// A frame is handed over, painting which took so long; returns the time since the one before.
    pub fn shown(&mut self, now: Instant, painting: Duration) -> Duration {
        let since = now - self.shown;
        (self.shown, self.painting, self.known) = (now, painting, true);
        since
    }

    /// Makes pixels coarser where frames take longer than the target allows, finer where there is time.
    pub fn hold(&mut self, target: Option<u32>) {
        let Some(target) = target else {
            self.coarseness = 1.0;
            return;
        };
        // What a frame takes at least; waiting for the display is no reason for coarser pixels.
        let needed = self.sample + self.painting;
        self.fastest = (self.fastest.0 + 1, self.fastest.1.min(needed));
        if self.fastest.0 < TRIED || (self.fits && self.still && self.since.elapsed() >= SETTLED) {
            return;
        }
        let (needed, wanted) = (self.fastest.1.as_secs_f64(), 1.0 / f64::from(target));
        self.fastest = NONE;
        self.fits = (wanted * SPARE..wanted * 1.05).contains(&needed);
        if !self.fits {
            // What a frame takes grows with its pixels, the square of what a side has of them.
            let step = (AIM * wanted / needed.max(1e-9)).sqrt();
            self.coarseness = (self.coarseness * step).clamp(COARSEST, 1.0);
        }
    }

    /// Brings all pixels to the same number of samples, at least one.
    pub fn even_out(&mut self, renderer: &Renderer) {
        let uneven = self.film.most_samples().max(1) - self.film.samples();
        renderer.add_samples(&mut self.film, uneven);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Settings;
    use crate::scene::load;

    fn start() -> (Renderer, Scene, Exposure) {
        let scene = load("builtin:three").unwrap();
        let settings = Settings { resolution: [24, 16], seed: 5, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let exposure = Exposure::new(&renderer, &scene);
        (renderer, scene, exposure)
    }

    /// The bits of a standing picture are those of a still, whatever was seen before it.
    #[test]
    fn a_camera_that_comes_to_rest_gathers_the_samples_of_a_still() {
        let (mut renderer, scene, mut exposure) = start();
        let home = exposure.pose;
        let away = Pose { camera: Camera { vertical_fov: 30.0, ..home.camera }, ..home };
        let mut go = |exposure: &mut Exposure, pose, frame| {
            let change = exposure.point(&mut renderer, &scene, pose, 5, frame);
            renderer.add_samples(&mut exposure.film, 2);
            (change, renderer.settings().seed, exposure.film.samples())
        };
        assert_eq!(go(&mut exposure, home, 0), (Change::None, 5, 2));
        assert_eq!(go(&mut exposure, away, 1), (Change::Moved, 7, 2));
        assert_eq!(go(&mut exposure, home, 2), (Change::Moved, 8, 2));
        assert_eq!(go(&mut exposure, home, 3), (Change::None, 5, 2), "at rest: from the first sample on");
        assert_eq!(go(&mut exposure, home, 4), (Change::None, 5, 4));
        let (still, ..) = start();
        let mut film = still.film();
        still.add_samples(&mut film, 4);
        assert_eq!(exposure.film.picture(), film.picture());
        let deep = Pose { bounces: home.bounces + 1, ..home };
        assert_eq!(go(&mut exposure, deep, 5), (Change::Other, 5, 2), "another picture begins at once");
        let small = Pose { resolution: [12, 8], ..deep };
        assert_eq!(go(&mut exposure, small, 6), (Change::Other, 5, 2));
        assert_eq!(exposure.film.resolution(), [12, 8]);
    }

    #[test]
    fn pixels_become_as_coarse_as_a_frame_rate_needs_and_no_coarser() {
        let (.., mut exposure) = start();
        // A machine that takes 100 ms for all pixels.
        let mut settle = |target| {
            for _ in 0..300 {
                exposure.sample = Duration::from_secs_f64(0.1 * exposure.coarseness.powi(2));
                exposure.hold(target);
            }
            (exposure.coarseness, 0.1 * exposure.coarseness.powi(2))
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
        let (.., mut exposure) = start();
        let mut after = |frames, target| {
            for _ in 0..frames {
                exposure.sample = Duration::from_secs_f64(0.4 * exposure.coarseness.powi(2));
                exposure.hold(Some(target));
            }
            exposure.sample.as_secs_f64() * f64::from(target)
        };
        let takes = [after(3, 30), after(3, 60), after(3, 20)];
        assert!(takes.iter().all(|share| (0.6..1.05).contains(share)), "shares of the time: {takes:?}");
    }

    #[test]
    fn neither_a_frame_held_up_nor_a_picture_that_has_stood_changes_its_pixels() {
        let (.., mut exposure) = start();
        let hold = |exposure: &mut Exposure, ms, times| {
            exposure.sample = Duration::from_millis(ms);
            (0..times).for_each(|_| exposure.hold(Some(30)));
            exposure.coarseness
        };
        for _ in 0..10 {
            assert_eq!(hold(&mut exposure, 20, 2), 1.0);
            assert_eq!(hold(&mut exposure, 500, 1), 1.0, "held up");
        }
        assert_eq!(hold(&mut exposure, 20, 2), 1.0);
        exposure.since = Instant::now().checked_sub(SETTLED).unwrap();
        assert_eq!(hold(&mut exposure, 500, 10), 1.0, "it stands");
        exposure.still = false;
        assert!(hold(&mut exposure, 500, 3) < 1.0, "it moves");
    }

    #[test]
    fn pixels_of_a_slow_picture_that_never_moved_become_coarser_too() {
        let (.., mut exposure) = start();
        exposure.since = Instant::now().checked_sub(SETTLED).unwrap();
        exposure.sample = Duration::from_secs(2);
        (0..TRIED).for_each(|_| exposure.hold(Some(30)));
        assert!(exposure.coarseness < 0.2, "{}", exposure.coarseness);
        exposure.sample = Duration::from_secs(200);
        (0..TRIED).for_each(|_| exposure.hold(Some(30)));
        assert_eq!(exposure.coarseness, COARSEST, "no coarser, however slow");
    }

    #[test]
    fn frames_that_vary_a_little_change_no_pixels() {
        let (.., mut exposure) = start();
        let mut hold = |ms, times| {
            for _ in 0..times {
                exposure.sample = Duration::from_secs_f64(ms * 1e-3 * exposure.coarseness.powi(2));
                exposure.hold(Some(30));
            }
            exposure.coarseness
        };
        let coarse = hold(100.0, 10);
        for ms in [90.0, 105.0, 80.0, 100.0, 70.0] {
            assert_eq!(hold(ms, 4), coarse, "{ms} ms for all pixels, where 100 were");
        }
        assert!(hold(50.0, 4) > coarse && hold(150.0, 4) < coarse);
    }

    #[test]
    fn nobody_waits_for_a_sample_of_a_window_that_is_closed() {
        let (renderer, _, mut exposure) = start();
        let (exchange, mut rates, mut summary) = (Exchange::default(), Rates::default(), Summary::default());
        exchange.tell();
        exposure.expose(&renderer, 1e9, &exchange, (&mut rates, &mut summary));
        assert_eq!(exposure.film.samples(), 1, "the first sample of a picture is waited for");
        exposure.film.clear();
        exchange.leave();
        exposure.expose(&renderer, 1.0, &exchange, (&mut rates, &mut summary));
        assert_eq!(exposure.film.most_samples(), 0);
        exposure.even_out(&renderer);
        assert_eq!(exposure.film.samples(), 1, "but by who takes a picture of it");
    }

    #[test]
    fn a_picture_that_stands_is_left_for_news_and_when_it_has_its_samples() {
        let (renderer, _, mut exposure) = start();
        let (exchange, mut rates, mut summary) = (Exchange::default(), Rates::default(), Summary::default());
        let mut expose = |exposure: &mut Exposure, renderer: &Renderer, exchange: &Exchange| {
            exposure.expose(renderer, 1e9, exchange, (&mut rates, &mut summary));
            exposure.film.most_samples()
        };
        assert_eq!(expose(&mut exposure, &renderer, &exchange), 1);
        assert_eq!(expose(&mut exposure, &renderer, &exchange), 2);
        exchange.tell();
        assert_eq!(expose(&mut exposure, &renderer, &exchange), 2, "nobody waits for a sample more");
        exchange.hear();
        // One pixel, so that it has all of its samples soon.
        let scene = load("builtin:three").unwrap();
        let renderer = Renderer::new(&scene, Settings { resolution: [1, 1], ..Settings::of(&scene) });
        exposure.renew(&renderer, &scene);
        renderer.add_samples(&mut exposure.film, MOST_SAMPLES - 1);
        assert_eq!(expose(&mut exposure, &renderer, &exchange), MOST_SAMPLES);
        assert_eq!(expose(&mut exposure, &renderer, &exchange), MOST_SAMPLES);
    }
}
