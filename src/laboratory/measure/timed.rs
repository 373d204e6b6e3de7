//! Renderers timed in alternating rounds, so that other load on the machine affects all of them alike.
//!
//! For: `TimedRenderer`, and the [`Ratio`] of two of them.
//!
//! A *round* gives every renderer one *turn*; a turn is some frames of one renderer.

use super::quantiles::Quantiles;
use crate::film::Film;
use crate::render::Renderer;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Frames before timing starts, or fewer if they take this time: caches and branch predictors fill, clocks
/// rise.
const WARM_UP: u32 = 5;
const WARM_UP_TIME: Duration = Duration::from_millis(200);

/// A renderer, its film and its frame times. A frame is one sample of every pixel.
pub(crate) struct TimedRenderer {
    pub renderer: Renderer,
    pub film: Film,
    /// Time of each frame.
    pub seconds: Vec<f64>,
    /// Median frame time of each turn, in seconds.
    turns: Vec<f64>,
}

impl TimedRenderer {
    /// Warms the renderer up; the film is empty afterwards.
    pub fn new(renderer: Renderer) -> Self {
        let mut timed = Self { film: renderer.film(), renderer, seconds: Vec::new(), turns: Vec::new() };
        timed.restart();
        timed
    }

    /// Warms the renderer up again; film and times are empty afterwards.
    pub fn restart(&mut self) {
        let start = Instant::now();
        self.film.clear();
        while self.film.samples() < WARM_UP && start.elapsed() < WARM_UP_TIME {
            self.renderer.add_samples(&mut self.film, 1);
        }
        self.film.clear();
        self.clear_times();
    }

    /// Times frames for `time`: at least one and at most `frames`, none for 0.
    pub fn turn(&mut self, frames: usize, time: Duration) {
        let Self { renderer, film, seconds, turns } = self;
        let before = seconds.len();
        renderer.on_threads(|| {
            let turn = Instant::now();
            for _ in 0..frames {
                let start = Instant::now();
                renderer.add_samples(film, 1);
                seconds.push(start.elapsed().as_secs_f64());
                if turn.elapsed() >= time {
                    break;
                }
            }
        });
        if seconds.len() > before {
            turns.push(Quantiles::of(seconds[before..].to_vec()).median());
        }
    }

    /// Drops the times and keeps the film.
    pub fn clear_times(&mut self) {
        self.seconds.clear();
        self.turns.clear();
    }
}

/// The ratio of two speeds: the median over the rounds of each round's own ratio. A slow spell of the machine
/// slows both turns of a round, and few rounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// Above 1 where the first is faster.
    pub median: f64,
    /// The 10th and the 90th percentile of the rounds.
    pub spread: [f64; 2],
    /// Rounds that both took part in.
    pub rounds: usize,
}

impl Ratio {
    /// The speed of `fast` over that of `slow`; `None` before their first common round.
    pub(crate) fn of(fast: &TimedRenderer, slow: &TimedRenderer) -> Option<Self> {
        Self::of_rounds(&fast.turns, &slow.turns)
    }

    /// The same of two lists of times, a time a round.
    pub(crate) fn of_rounds(fast: &[f64], slow: &[f64]) -> Option<Self> {
        let ratios: Vec<f64> = fast.iter().zip(slow).map(|(fast, slow)| slow / fast).collect();
        (!ratios.is_empty()).then(|| {
            let (rounds, ratios) = (ratios.len(), Quantiles::of(ratios));
            Self { median: ratios.median(), spread: ratios.spread(), rounds }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Settings;

    #[test]
    fn ratio_is_that_of_the_rounds_and_not_of_the_medians() {
        // From the third round on the machine is three times as slow. The last turn of `slow` has no
        // counterpart.
        let (fast, slow) = ([1.0, 1.0, 3.0, 3.0, 3.0], [4.0, 4.0, 12.0, 12.0, 24.0, 99.0]);
        let ratio = Ratio::of_rounds(&fast, &slow).unwrap();
        assert_eq!(ratio, Ratio { median: 4.0, spread: [4.0, 8.0], rounds: 5 });
        assert_eq!(Ratio::of_rounds(&[], &slow), None);
    }

    #[test]
    fn turn_times_at_least_one_frame_and_at_most_those_asked_for() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [8, 8], ..Settings::of(&scene) };
        let mut timed = TimedRenderer::new(Renderer::new(&scene, settings));
        assert_eq!(timed.film.samples(), 0);
        timed.turn(3, Duration::MAX);
        timed.turn(9, Duration::ZERO);
        timed.turn(0, Duration::MAX);
        assert_eq!((timed.film.samples(), timed.seconds.len(), timed.turns.len()), (4, 4, 2));
        timed.clear_times();
        assert_eq!((timed.film.samples(), timed.seconds.len(), timed.turns.len()), (4, 0, 0));
    }
}
