//! Error against time: every configuration from one sample per pixel on, with several seeds.

use super::clock::{self, Clock, Times};
use super::configurations::{Configuration, Group};
use super::ground_truth::GroundTruth;
use super::pareto::ErrorCurve;
use crate::adaptive::Target;
use crate::film::Film;
use crate::measure::cores::Reliability;
use crate::measure::errors::Errors;
use crate::measure::flip::Flip;
use crate::measure::quantiles::{Quantiles, Spread};
use crate::render::Renderer;
use crate::scene::Scene;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Fewest seeds behind a median.
pub const SEEDS: u32 = 8;
/// Most samples of a pixel, and least ratio of the ground truth's samples to a picture's.
pub(crate) const MOST_SAMPLES: u32 = 256;
pub(crate) const GROUND_TRUTH_FACTOR: u32 = 100;
/// First target error of the adaptive configuration. Each further one is half the last and takes about four
/// times the samples.
const FIRST_TARGET: f64 = 0.8;
/// Samples before the first noise estimate, as in `render --target-error`.
const LEAST: u32 = 16;
/// Untimed rendering right before a timed part: other configurations ran since, so the caches and the branch
/// predictor are theirs, and the worker sleeps. Where a pass takes longer than `LONG`, in seconds, that no
/// longer matters.
const WARM_UP: Duration = Duration::from_millis(1);
const LONG: f64 = 0.02;
/// A part shorter than this is timed again, up to so many times, for the median: an interrupt takes as long.
const SHORT: Duration = Duration::from_millis(1);
const MOST_REPEATS: usize = 9;
/// A configuration is compared from so many points on.
const FEWEST_POINTS: usize = 3;

/// One number of samples of one configuration.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Point {
    /// Samples per pixel: mean over picture and seeds.
    pub samples: f64,
    /// Seconds on one thread, by the clock that decides: rendering alone, without loading, building or
    /// encoding.
    pub seconds: Spread,
    /// Wall time.
    pub wall_s: Spread,
    /// Processor time of the thread.
    pub processor_s: Spread,
    /// Root mean square error, in radiance.
    pub rmse: Spread,
    /// Relative mean square error, without unit: `measure::errors` defines the three.
    pub relmse: Spread,
    /// `relmse` without the worst 0.1 % of pixels.
    pub relmse_trimmed: Spread,
    /// Mean FLIP of the displayed picture.
    pub flip: Spread,
    /// Whether no other robust configuration has a smaller `rmse` in the same time, for nine of ten seeds.
    pub on_front: bool,
}

/// A line of the chart.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Line {
    /// Its name.
    pub configuration: &'static str,
    /// `None` for the default.
    pub group: Option<Group>,
    /// Points by rising samples; adaptive configurations by falling target error.
    pub points: Vec<Point>,
    /// Whether its methods are the robust ones. One that is not robust dominates no other.
    pub robust: bool,
    /// Pictures that differ from the default's with the same seed and samples; `None` where they may differ.
    pub pictures_unlike_default: Option<usize>,
    /// Time to the error (root mean square) of its own last point, or of the default's where that is larger,
    /// over the default's time to the same error; see [`super::pareto`] for interpolation and extrapolation.
    pub time_to_equal_error: Spread,
    /// The configuration that is better in time and error at every point of this one, beyond the spread of
    /// the seeds. If only several together are, the best of them at the last point.
    pub dominated_by: Option<&'static str>,
    /// Reliability of the comparison with the others. With [`Clock::Processor`], a busy machine does not make
    /// it wrong.
    #[serde(flatten)]
    pub reliability: Reliability,
}

impl Line {
    /// Tests whether pictures differ that must not.
    pub fn is_broken(&self) -> bool {
        self.pictures_unlike_default.is_some_and(|count| count > 0)
    }
}

/// Seconds and errors by seed, of one level.
#[derive(Clone, Default)]
struct Level {
    samples: f64,
    times: Times,
    errors: Vec<Errors>,
    flip: Vec<f64>,
    /// Hash of each seed's picture.
    hashes: Vec<u64>,
}

/// A configuration while it is measured.
pub(super) struct Run<'a> {
    configuration: &'a Configuration,
    renderer: Renderer,
    /// One per seed, with its seconds on the wall and of processor time.
    films: Vec<(Film, [f64; 2])>,
    levels: Vec<Level>,
    /// Number of target errors reached, if adaptive.
    targets: i32,
    /// Time of this level, and of all levels, including that of computing errors.
    level_time: Duration,
    spent: Duration,
    done: bool,
}

/// Measures all configurations until `end`; at least one level of each. `seeds` of them, numbered from 1.
pub(super) fn runs<'a>(
    scene: &Scene,
    configurations: &'a [Configuration],
    ground_truth: &GroundTruth,
    seeds: u32,
    end: Instant,
) -> Vec<Run<'a>> {
    let flip = Flip::of(&ground_truth.small);
    let most = MOST_SAMPLES.min(ground_truth.small_samples() / GROUND_TRUTH_FACTOR).max(1);
    let mut runs: Vec<Run> =
        configurations.iter().map(|one| Run::new(scene, one, ground_truth, seeds)).collect();
    let slice = end.saturating_duration_since(Instant::now()) / runs.len() as u32;
    // Level by level and seed by seed, alternating between configurations: a slow spell of the machine
    // affects all alike.
    while runs.iter().any(|run| !run.done) {
        let mut active: Vec<&mut Run> = runs.iter_mut().filter(|run| !run.done).collect();
        for seed in 0..seeds {
            active.iter_mut().for_each(|run| run.render(seed, most));
        }
        for run in active {
            run.end_level(ground_truth, &flip, most);
            let last = std::mem::take(&mut run.level_time);
            run.spent += last;
            run.done |= run.spent + 2 * last > slice;
        }
    }
    runs
}

impl<'a> Run<'a> {
    fn new(scene: &Scene, configuration: &'a Configuration, ground_truth: &GroundTruth, seeds: u32) -> Self {
        let resolution = [ground_truth.small.width, ground_truth.small.height];
        let renderer = configuration.renderer(scene, resolution, 1);
        let films = (0..seeds).map(|_| (renderer.film(), [0.0; 2])).collect();
        Self {
            configuration,
            renderer,
            films,
            levels: Vec::new(),
            targets: 0,
            level_time: Duration::ZERO,
            spent: Duration::ZERO,
            done: false,
        }
    }

    /// Doubles the samples of this seed, the first being 0; or halves the target error and starts again.
    fn render(&mut self, seed: u32, most: u32) {
        let Self { configuration, renderer, films, targets, .. } = self;
        let (film, seconds) = &mut films[seed as usize];
        let target = Target { error: FIRST_TARGET * 0.5f64.powi(*targets), least: LEAST.min(most), most };
        let start = Instant::now();
        renderer.set_seed(seed + 1);
        // On the worker from the warm-up on, so that no time is that of waking it.
        renderer.on_threads(|| {
            let mut untimed = renderer.film();
            while seconds[0] <= film.mean_samples() * LONG && start.elapsed() < WARM_UP {
                renderer.add_samples(&mut untimed, 1);
            }
            if configuration.adaptive {
                *seconds = clock::time(|| *film = to_target(renderer, &target));
            } else {
                let more = film.samples().max(1);
                let taken = median_time(film, |film| clock::time(|| renderer.add_samples(film, more)));
                *seconds = [0, 1].map(|clock| seconds[clock] + taken[clock]);
            }
        });
        self.level_time += start.elapsed();
    }

    /// Computes the errors of all seeds' pictures, outside the timed part.
    fn end_level(&mut self, ground_truth: &GroundTruth, flip: &Flip, most: u32) {
        let (start, mut level) = (Instant::now(), Level::default());
        for (film, seconds) in &self.films {
            let picture = film.picture();
            level.samples += film.mean_samples() / self.films.len() as f64;
            level.times.push(*seconds);
            level.errors.push(Errors::of(&picture, &ground_truth.small));
            level.flip.push(flip.against(&picture));
            level.hashes.push(picture.hash());
        }
        self.done = level.samples * 2.0 > f64::from(most);
        self.targets += 1;
        // If the samples of the last target also meet this one, there is no new point.
        if self.levels.last().is_none_or(|last| level.samples > last.samples) {
            self.levels.push(level);
        }
        self.level_time += start.elapsed();
    }
}

/// Applies a change, which returns its seconds by both clocks, to the film once; returns the median times of
/// several changes of equal films where one is [`SHORT`].
fn median_time(film: &mut Film, mut change: impl FnMut(&mut Film) -> [f64; 2]) -> [f64; 2] {
    let before = film.clone();
    let mut times = vec![change(film)];
    let by = |times: &[[f64; 2]], clock: usize| times.iter().map(|time| time[clock]).collect::<Vec<_>>();
    while times.len() < MOST_REPEATS && by(&times, 0).iter().sum::<f64>() < SHORT.as_secs_f64() {
        times.push(change(&mut before.clone()));
    }
    [0, 1].map(|clock| Quantiles::of(by(&times, clock)).median())
}

/// Returns the seconds of one pass: those of the last point, over its samples.
pub fn pass_time(line: &Line) -> f64 {
    line.points.last().map_or(f64::NAN, |point| point.seconds.median / point.samples)
}

/// Renders until the target error is met.
fn to_target(renderer: &Renderer, target: &Target) -> Film {
    let mut film = renderer.film_with_noise();
    while let Some(round) = target.next(&film) {
        renderer.sample_tiles_to(&mut film, |tile, _| round.goals[tile], &());
    }
    film
}

/// Returns the clock that decides, and the lines of all runs; the first run is the default.
pub(super) fn lines(runs: &[Run]) -> (Clock, Vec<Line>) {
    let clock = Clock::of(runs.iter().flat_map(|run| run.levels.iter().map(|level| &level.times)));
    let curves: Vec<ErrorCurve> = runs.iter().map(|run| run.curve(clock)).collect();
    let default = &runs[0];
    let of_default = default.reliability(clock);
    let reliability: Vec<_> = runs.iter().map(|run| run.reliability(clock).worse(&of_default)).collect();
    let line = |(number, run): (usize, &Run)| {
        let counts = |other: usize| {
            other != number && runs[other].configuration.is_robust() && reliability[other].reliable
        };
        let others = (0..runs.len()).filter(|&other| counts(other));
        let others: Vec<_> = others.map(|other| (runs[other].configuration.name, &curves[other])).collect();
        let curve = &curves[number];
        let point = |(at, level): (usize, &Level)| {
            let spread = |of: fn(&Errors) -> f64| Spread::of(level.errors.iter().map(of));
            Point {
                samples: level.samples,
                seconds: level.times.spread(clock),
                wall_s: level.times.spread(Clock::Wall),
                processor_s: level.times.spread(Clock::Processor),
                rmse: spread(|errors| errors.rmse),
                relmse: spread(|errors| errors.relmse),
                relmse_trimmed: spread(|errors| errors.relmse_trimmed),
                flip: Spread::of(level.flip.iter().copied()),
                on_front: others.iter().all(|(_, other)| !other.beats(curve, at)),
            }
        };
        let unlike = || {
            let levels = run.levels.iter().zip(&default.levels);
            levels.flat_map(|(a, b)| a.hashes.iter().zip(&b.hashes)).filter(|(a, b)| a != b).count()
        };
        Line {
            configuration: run.configuration.name,
            group: Group::of(run.configuration.name),
            robust: run.configuration.is_robust(),
            points: run.levels.iter().enumerate().map(point).collect(),
            pictures_unlike_default: run.configuration.has_same_bits().then(unlike),
            time_to_equal_error: curve.time_to_last_error_over(&curves[0]),
            dominated_by: curve.dominated_by(&others).filter(|_| reliability[number].reliable),
            reliability: reliability[number],
        }
    };
    (clock, runs.iter().enumerate().map(line).collect())
}

impl Run<'_> {
    fn curve(&self, clock: Clock) -> ErrorCurve {
        let rmse = |level: &Level| level.errors.iter().map(|errors| errors.rmse).collect();
        ErrorCurve::new(self.levels.iter().map(|level| (level.times.by(clock), rmse(level))))
    }

    /// Returns the reliability of the last point, if enough points precede it.
    fn reliability(&self, clock: Clock) -> Reliability {
        self.levels[self.levels.len() - 1].times.reliability(clock, self.levels.len() >= FEWEST_POINTS)
    }
}

#[cfg(test)]
mod tests {
    use super::super::ground_truth::GroundTruthRenderer;
    use super::*;
    use crate::render::{Settings, SphereChoice};

    /// Returns the lines of a slow and of a fast configuration that give one picture, with doctored times:
    /// `times(seconds)` are those of the three seeds. The fast one is robust or not.
    fn doctored(robust: bool, times: impl Fn(f64) -> [[f64; 2]; 3]) -> (Clock, Vec<Line>) {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let frame = Settings { resolution: [48, 27], ..Settings::of(&scene) };
        let ground_truth = GroundTruthRenderer::new(&scene, frame, 1).render(800);
        let of = |name, robust| {
            let mut settings = Settings { resolution: [16, 9], ..frame };
            settings.methods.sphere = if robust { SphereChoice::Robust } else { SphereChoice::Naive };
            Configuration { name, settings, levels_of_detail: false, adaptive: false }
        };
        let both = [of("slow", true), of("fast", robust)];
        let hour = Instant::now() + Duration::from_secs(3_600);
        let mut runs = runs(&scene, &both, &ground_truth, 3, hour);
        for (run, second) in runs.iter_mut().zip([2.0, 1.0]) {
            for level in &mut run.levels {
                level.times = Times::default();
                times(second * level.samples).into_iter().for_each(|times| level.times.push(times));
            }
        }
        lines(&runs)
    }

    #[test]
    fn processor_time_decides_on_a_busy_machine_and_scattered_times_decide_nothing() {
        // Others took from nothing to nine tenths of the wall time.
        let busy = |seconds: f64| [1.0, 4.0, 10.0].map(|times| [times * seconds, seconds]);
        let (clock, lines) = doctored(true, busy);
        let fast = &lines[1];
        assert!(
            clock == Clock::Processor && (fast.time_to_equal_error.median - 0.5).abs() < 1e-9,
            "{fast:?}"
        );
        assert_eq!((fast.reliability.reliable, fast.reliability.taken), (true, Some(0.75)));
        assert_eq!(lines[0].dominated_by, Some("fast"));
        let point = &fast.points[0];
        assert_eq!([point.seconds.median, point.wall_s.median, point.processor_s.median], [1.0, 4.0, 1.0]);

        let idle = |seconds: f64| [[seconds; 2]; 3];
        let (clock, lines) = doctored(true, idle);
        assert_eq!((clock, lines[1].reliability.taken), (Clock::Wall, Some(0.0)));
        let scattered = |seconds: f64| [1.0, 2.0, 8.0].map(|times| [times * seconds; 2]);
        let (_, lines) = doctored(true, scattered);
        assert!(lines.iter().all(|line| !line.reliability.reliable && line.dominated_by.is_none()));
    }

    #[test]
    fn configuration_that_is_not_robust_dominates_no_other() {
        let lines = |robust| doctored(robust, |seconds| [[seconds; 2]; 3]).1;
        let on_front = |line: &Line| line.points.iter().filter(|point| point.on_front).count();
        let [slow, fast] = &lines(false)[..] else { panic!("two lines") };
        assert_eq!((slow.dominated_by, on_front(slow)), (None, slow.points.len()));
        assert!(on_front(fast) > 0 && !fast.robust);
        assert!(on_front(&lines(true)[0]) < slow.points.len(), "a robust one would dominate");
    }
}
