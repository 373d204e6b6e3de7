//! Error against time: every configuration, from one sample a pixel on, with several seeds.
//!
//! For: [`measure`]. May import: `configurations`, `truth`, `errors`, `flip`, `front`. Must never know: how it is drawn.

use super::configurations::Configuration;
use super::front::Way;
use super::truth::Truth;
use crate::adaptive::Target;
use crate::film::Film;
use crate::measure::errors::Errors;
use crate::measure::flip::Flip;
use crate::measure::statistics::Quantiles;
use crate::render::{Renderer, Settings};
use crate::scene::Scene;
use serde::Serialize;
use std::hash::{DefaultHasher, Hasher};
use std::time::{Duration, Instant};

/// Fewest seeds behind a median.
pub const SEEDS: u32 = 8;
/// Most samples a pixel gets, and how many times as many the truth has at least.
pub const MOST_SAMPLES: u32 = 256;
pub const TRUTH_FACTOR: u32 = 100;
/// Target errors of the adaptive configuration: this, and halves of it. Each takes about four times the samples of the one before.
const FIRST_TARGET: f64 = 0.8;
/// Samples before it judges, as `render --target-error` takes them.
const LEAST: u32 = 16;

/// Middle and spread over the seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    pub median: f64,
    pub p10: f64,
    pub p90: f64,
}

impl Spread {
    pub fn of(values: &[f64]) -> Self {
        let values = Quantiles::of(values.to_vec());
        Self { median: values.median(), p10: values.at(0.1), p90: values.at(0.9) }
    }
}

/// So many samples of one configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Per pixel, the mean over picture and seeds.
    pub samples: f64,
    /// On one thread: tracing alone, no loading, building or encoding.
    pub seconds: Spread,
    pub rmse: Spread,
    pub relmse: Spread,
    pub relmse_trimmed: Spread,
    /// Mean FLIP of the displayed picture.
    pub flip: Spread,
    /// Does no other robust configuration have a smaller error in as much time, by the medians of `rmse`?
    pub on_front: bool,
}

/// A line of the chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    pub configuration: &'static str,
    pub points: Vec<Point>,
    /// Do its equations hold where others fail? One that does not is compared with all, and none is called worse than it.
    pub robust: bool,
    /// Pictures that differ from the default's with the same seed and samples, where they should not; `None` where they may.
    pub pictures_unlike_default: Option<usize>,
    /// How many times as long as the default it takes to the error (root mean square) of its own last point, by the medians over the seeds;
    /// see [`super::front`] for what is between points and beyond them.
    pub time_to_equal_error: f64,
    /// Which configuration is better in time and error at every point of this one, beyond the spread of the seeds. Where that takes several of
    /// them, the one that is so at the last point, and by most.
    pub dominated_by: Option<&'static str>,
}

impl Line {
    /// Does it show another picture than it promised?
    pub fn is_broken(&self) -> bool {
        self.pictures_unlike_default.is_some_and(|count| count > 0)
    }
}

/// Seconds and errors by seed, after one level.
#[derive(Clone, Default)]
struct Level {
    samples: f64,
    seconds: Vec<f64>,
    errors: Vec<Errors>,
    flip: Vec<f64>,
    /// Of each seed's picture.
    bits: Vec<u64>,
}

/// A configuration while it is measured.
struct Run<'a> {
    configuration: &'a Configuration,
    renderer: Renderer,
    /// One a seed, and the seconds that went into it.
    films: Vec<(Film, f64)>,
    levels: Vec<Level>,
    /// Target errors that it has met, if it is adaptive.
    targets: i32,
    /// All time that went into this configuration, errors included.
    spent: Duration,
    /// Of that, what rendering the level at hand has taken, and all that went into the one before.
    rendering: Duration,
    last: Duration,
    done: bool,
}

/// Measures all configurations until `end`; at least one level of each. `seeds` of them, numbered from 1.
pub fn measure(
    scene: &Scene,
    configurations: &[Configuration],
    truth: &Truth,
    seeds: u32,
    end: Instant,
) -> Vec<Line> {
    let flip = Flip::of(&truth.small);
    let most = MOST_SAMPLES.min(truth.small_samples() / TRUTH_FACTOR).max(1);
    let mut runs: Vec<Run> = configurations.iter().map(|one| Run::new(scene, one, truth, seeds)).collect();
    let slice = end.saturating_duration_since(Instant::now()) / runs.len() as u32;
    // Level by level, seed by seed, and each seed by turns: a machine that grows slow for a while does so for all configurations.
    while runs.iter().any(|run| !run.done) {
        let mut active: Vec<&mut Run> = runs.iter_mut().filter(|run| !run.done).collect();
        for seed in 0..seeds {
            active.iter_mut().for_each(|run| run.render(seed, most));
        }
        for run in active {
            run.end_level(truth, &flip, most);
            run.done |= run.spent + 2 * run.last > slice;
        }
    }
    lines(&runs)
}

impl<'a> Run<'a> {
    fn new(scene: &Scene, configuration: &'a Configuration, truth: &Truth, seeds: u32) -> Self {
        let start = Instant::now();
        let resolution = [truth.small.width, truth.small.height];
        let renderer = Renderer::new(scene, Settings { resolution, threads: 1, ..configuration.settings });
        // Caches fill, threads wake up.
        renderer.add_samples(&mut renderer.film(), 1);
        let films = (0..seeds).map(|_| (renderer.film(), 0.0)).collect();
        let none = Duration::ZERO;
        let (levels, spent) = (Vec::new(), start.elapsed());
        Self {
            configuration,
            renderer,
            films,
            levels,
            targets: 0,
            spent,
            rendering: none,
            last: none,
            done: false,
        }
    }

    /// Twice the samples for this seed, the first being 0; or half the target error, from the first sample on.
    fn render(&mut self, seed: u32, most: u32) {
        let (film, seconds) = &mut self.films[seed as usize];
        self.renderer.set_seed(seed + 1);
        let start = Instant::now();
        if self.configuration.adaptive {
            let error = FIRST_TARGET * 0.5f64.powi(self.targets);
            *film = to_target(&self.renderer, &Target { error, least: LEAST.min(most), most });
            *seconds = start.elapsed().as_secs_f64();
        } else {
            self.renderer.add_samples(film, film.samples().max(1));
            *seconds += start.elapsed().as_secs_f64();
        }
        self.rendering += start.elapsed();
    }

    /// After all seeds have had their turn: what there is to say of them, outside of what is timed.
    fn end_level(&mut self, truth: &Truth, flip: &Flip, most: u32) {
        let (start, mut level) = (Instant::now(), Level::default());
        for (film, seconds) in &self.films {
            let picture = film.picture();
            level.samples += film.mean_samples() / self.films.len() as f64;
            level.seconds.push(*seconds);
            level.errors.push(Errors::of(&picture, &truth.small));
            level.flip.push(flip.against(&picture));
            level.bits.push(fingerprint(&picture.pixels));
        }
        self.done = level.samples * 2.0 > f64::from(most);
        self.targets += 1;
        // Where the samples of the last target meet this one too, it is no other point.
        if self.levels.last().is_none_or(|last| level.samples > last.samples) {
            self.levels.push(level);
        }
        self.last = std::mem::take(&mut self.rendering) + start.elapsed();
        self.spent += self.last;
    }
}

/// Renders until the target is met.
fn to_target(renderer: &Renderer, target: &Target) -> Film {
    let mut film = renderer.film_with_noise();
    while let Some(round) = target.next(&film) {
        renderer.sample_tiles_to(&mut film, |tile, _| round.goals[tile], &());
    }
    film
}

/// Pictures of the same bits have the same one; others hardly ever.
fn fingerprint(pixels: &[[f32; 3]]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytemuck::cast_slice(pixels));
    hasher.finish()
}

/// What the runs say of themselves and of each other; the first is the default.
fn lines(runs: &[Run]) -> Vec<Line> {
    let ways: Vec<Way> = runs.iter().map(Run::way).collect();
    let default = &runs[0];
    let line = |(number, run): (usize, &Run)| {
        let others = ways.iter().enumerate();
        let others = others.filter(|(other, _)| *other != number && runs[*other].configuration.robust);
        let others: Vec<(&str, &Way)> = others.map(|(other, way)| (runs[other].name(), way)).collect();
        let way = &ways[number];
        let point = |(at, level): (usize, &Level)| {
            let spread =
                |of: fn(&Errors) -> f64| Spread::of(&level.errors.iter().map(of).collect::<Vec<_>>());
            Point {
                samples: level.samples,
                seconds: Spread::of(&level.seconds),
                rmse: spread(|errors| errors.rmse),
                relmse: spread(|errors| errors.relmse),
                relmse_trimmed: spread(|errors| errors.relmse_trimmed),
                flip: Spread::of(&level.flip),
                on_front: others.iter().all(|(_, other)| !other.passes_below(way, at)),
            }
        };
        let unlike = || {
            let levels = run.levels.iter().zip(&default.levels);
            levels.flat_map(|(a, b)| a.bits.iter().zip(&b.bits)).filter(|(a, b)| a != b).count()
        };
        Line {
            configuration: run.name(),
            robust: run.configuration.robust,
            points: run.levels.iter().enumerate().map(point).collect(),
            pictures_unlike_default: run.configuration.same_bits.then(unlike),
            time_to_equal_error: way.time_to_last_error_over(&ways[0]),
            dominated_by: way.dominated_by(&others),
        }
    };
    runs.iter().enumerate().map(line).collect()
}

impl Run<'_> {
    fn name(&self) -> &'static str {
        self.configuration.name
    }

    fn way(&self) -> Way {
        let rmse = |level: &Level| level.errors.iter().map(|errors| errors.rmse).collect();
        Way::new(self.levels.iter().map(|level| (level.seconds.clone(), rmse(level))))
    }
}

#[cfg(test)]
mod tests {
    use super::super::configurations::{DEFAULT, of_scene};
    use super::super::truth::Making;
    use super::*;

    #[test]
    fn lines_go_down_and_equal_ways_have_equal_bits() {
        let scene = octray_formats::scene::load("builtin:cornell").unwrap();
        let frame = Settings { resolution: [48, 27], ..Settings::of(&scene) };
        let later = |seconds| Instant::now() + Duration::from_secs(seconds);
        let truth = Making::new(&scene, frame, 1).until(later(60), 800, Duration::from_secs(60));
        let configurations = of_scene(&scene, Settings { resolution: [16, 9], ..frame });
        let lines = measure(&scene, &configurations, &truth, 3, later(3));
        assert_eq!(lines[0].configuration, DEFAULT);
        assert_eq!(lines[0].time_to_equal_error, 1.0);
        for line in &lines {
            assert!(line.pictures_unlike_default.is_none_or(|count| count == 0), "{line:?}");
            assert!(!line.points.is_empty(), "{line:?}");
        }
        let named = |name| lines.iter().find(|line| line.configuration == name).unwrap();
        assert!(named("scalar").pictures_unlike_default.is_some());
        let default = &lines[0].points;
        assert_eq!(default[0].samples, 1.0);
        for line in &lines {
            assert!(line.points.is_sorted_by(|a, b| a.samples < b.samples), "{line:?}");
        }
        assert!(default.len() > 3, "three seconds are many samples");
        for pair in default.windows(2) {
            assert!(
                pair[1].samples == 2.0 * pair[0].samples && pair[1].seconds.median > pair[0].seconds.median
            );
        }
        let (first, last) = (&default[0], &default[default.len() - 1]);
        assert!(last.rmse.median < 0.7 * first.rmse.median && last.flip.median < first.flip.median);
        let off = named("lights off");
        assert!(off.points[0].rmse.median > 1.5 * first.rmse.median, "lamps are hard to find by chance");
        assert!(off.points[3].rmse.median > 1.5 * default[3].rmse.median, "{off:?}");
        let scalar = named("scalar");
        // A first sample takes tens of microseconds, and other tests run beside it: what the clock says of early points is left to chance.
        assert!(
            scalar.time_to_equal_error > 1.0 && !scalar.points[scalar.points.len() - 1].on_front,
            "{scalar:?}"
        );
    }

    #[test]
    fn what_is_not_robust_makes_nothing_else_look_worse() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let frame = Settings { resolution: [48, 27], ..Settings::of(&scene) };
        let second = Duration::from_secs(1);
        let truth = Making::new(&scene, frame, 1).until(Instant::now() + second, 800, second);
        let of = |name, lanes, robust| Configuration {
            name,
            settings: Settings { resolution: [16, 9], lanes, ..frame },
            adaptive: false,
            same_bits: true,
            robust,
        };
        let lines = |robust| {
            let both = [of("slow", 1, true), of("fast", 8, robust)];
            measure(&scene, &both, &truth, 3, Instant::now() + second)
        };
        let ringed = |line: &Line| line.points.iter().filter(|point| point.on_front).count();
        let [slow, fast] = &lines(false)[..] else { panic!("two lines") };
        assert_eq!((slow.dominated_by, ringed(slow)), (None, slow.points.len()));
        assert!(ringed(fast) > 0 && !fast.robust);
        assert!(ringed(&lines(true)[0]) < slow.points.len(), "as it would be");
    }
}
