//! Renderers timed by turns, so that what else the machine does falls on all of them.
//!
//! For: [`Timed`], and [`Ratio`] of two of them. May import: `render`, `statistics`. Must never know: what the times are for.

use super::statistics::Quantiles;
use crate::film::Film;
use crate::render::Renderer;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Frames before timing starts, or as many as this time holds: caches and branch predictors fill, clocks rise.
const WARM_UP: u32 = 5;
const WARM_UP_TIME: Duration = Duration::from_millis(200);

/// A renderer, the frames it has made, and how long they took. A frame is one sample of every pixel.
pub struct Timed {
    pub renderer: Renderer,
    pub film: Film,
    /// Of every frame.
    pub seconds: Vec<f64>,
    /// Of the middle frame of every turn.
    turns: Vec<f64>,
}

impl Timed {
    /// Warms the renderer up; the film is empty afterwards.
    pub fn new(renderer: Renderer) -> Self {
        let (mut film, start) = (renderer.film(), Instant::now());
        while film.samples() < WARM_UP && start.elapsed() < WARM_UP_TIME {
            renderer.add_samples(&mut film, 1);
        }
        Self { film: renderer.film(), renderer, seconds: Vec::new(), turns: Vec::new() }
    }

    /// Times frames until `time` is over: at least one and at most `frames`, none for 0.
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

    /// Forgets the times and keeps the film.
    pub fn forget_times(&mut self) {
        self.seconds.clear();
        self.turns.clear();
    }
}

/// How many times as fast one is as the other: the middle of what each round of turns says by itself, because a machine that is slowed down
/// for a while slows down both turns of a round, and few rounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    pub median: f64,
    /// 10 % of the rounds say less than the first, and 10 % more than the second.
    pub spread: [f64; 2],
    pub rounds: usize,
}

impl Ratio {
    /// How many times as fast `fast` is as `slow`; `None` before they have had a round together.
    pub fn of(fast: &Timed, slow: &Timed) -> Option<Self> {
        Self::of_rounds(&fast.turns, &slow.turns)
    }

    fn of_rounds(fast: &[f64], slow: &[f64]) -> Option<Self> {
        let ratios: Vec<f64> = fast.iter().zip(slow).map(|(fast, slow)| slow / fast).collect();
        (!ratios.is_empty()).then(|| {
            let (rounds, ratios) = (ratios.len(), Quantiles::of(ratios));
            Self { median: ratios.median(), spread: [ratios.at(0.1), ratios.at(0.9)], rounds }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Settings;

    #[test]
    fn ratio_is_that_of_the_rounds_and_not_of_the_medians() {
        // From the third round on the machine is three times as slow; the last turn of the second engine falls out of its round.
        let (fast, slow) = ([1.0, 1.0, 3.0, 3.0, 3.0], [4.0, 4.0, 12.0, 12.0, 24.0, 99.0]);
        let ratio = Ratio::of_rounds(&fast, &slow).unwrap();
        assert_eq!(ratio, Ratio { median: 4.0, spread: [4.0, 8.0], rounds: 5 });
        assert_eq!(Ratio::of_rounds(&[], &slow), None);
    }

    #[test]
    fn turn_times_at_least_one_frame_and_at_most_those_asked_for() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [8, 8], ..Settings::of(&scene) };
        let mut timed = Timed::new(Renderer::new(&scene, settings));
        assert_eq!(timed.film.samples(), 0);
        timed.turn(3, Duration::MAX);
        timed.turn(9, Duration::ZERO);
        timed.turn(0, Duration::MAX);
        assert_eq!((timed.film.samples(), timed.seconds.len(), timed.turns.len()), (4, 4, 2));
        timed.forget_times();
        assert_eq!((timed.film.samples(), timed.seconds.len(), timed.turns.len()), (4, 0, 0));
    }
}
