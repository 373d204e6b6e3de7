//! Renderers timed in alternating rounds, so that other load on the machine affects all of them alike.
//!
//! A *round* gives every renderer one *turn*; a turn is some frames of one renderer.

use super::cores::{Reliability, on_own_cores};
use super::quantiles::Quantiles;
use crate::film::Film;
use crate::render::Renderer;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Frames before timing starts, or fewer in this time: caches and branch predictors fill, clocks rise.
const WARM_UP: u32 = 5;
const WARM_UP_TIME: Duration = Duration::from_millis(200);
/// Fewest rounds behind a ratio that is relied on.
const FEWEST_ROUNDS: usize = 3;

/// The times of work that is timed in turns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times {
    /// Time of each frame.
    pub seconds: Vec<f64>,
    /// Median frame time of each turn, in seconds.
    turns: Vec<f64>,
    /// Reliability of each turn.
    reliability: Vec<Reliability>,
}

impl Times {
    /// Adds a turn: its frames' times, unless there are none.
    pub fn push(&mut self, seconds: &[f64], reliability: Reliability) {
        if !seconds.is_empty() {
            self.seconds.extend(seconds);
            self.turns.push(Quantiles::of(seconds.to_vec()).median());
            self.reliability.push(reliability);
        }
    }
    /// Turns of one frame each, on an idle machine.
    #[cfg(test)]
    pub fn known(seconds: &[f64]) -> Self {
        let mut times = Self::default();
        let idle = Reliability { reliable: true, pinned: true, taken: Some(0.0) };
        seconds.iter().for_each(|&seconds| times.push(&[seconds], idle));
        times
    }
    /// Returns the reliability of figures that need this number of frames.
    pub fn reliability(&self, fewest: usize) -> Reliability {
        Reliability::of(&self.reliability, self.seconds.len() >= fewest)
    }
}

/// A renderer, its film and its frame times. A frame is one sample of every pixel.
pub(crate) struct TimedRenderer {
    pub renderer: Renderer,
    pub film: Film,
    pub times: Times,
}

impl TimedRenderer {
    /// Warms the renderer up; the film is empty afterwards.
    pub fn new(renderer: Renderer) -> Self {
        let mut timed = Self { film: renderer.film(), renderer, times: Times::default() };
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
        self.times = Times::default();
    }

    /// Times frames for `time`: at least one and at most `frames`, none for 0.
    pub fn turn(&mut self, frames: usize, time: Duration) {
        let Self { renderer, film, times } = self;
        let frame = |film: &mut Film| {
            let start = Instant::now();
            renderer.add_samples(film, 1);
            start.elapsed().as_secs_f64()
        };
        let run = || {
            let turn = Instant::now();
            let mut seconds = Vec::new();
            while seconds.len() < frames && (seconds.is_empty() || turn.elapsed() < time) {
                seconds.push(frame(film));
            }
            seconds
        };
        let (seconds, _, turn) = renderer.on_threads(|| on_own_cores(renderer.settings().threads, run));
        times.push(&seconds, turn);
    }
}

/// Runs work on the threads of a renderer, each on a core of its own. Returns its result, its milliseconds,
/// and their reliability.
pub(crate) fn time_on_cores<R: Send>(
    renderer: &Renderer,
    work: impl FnOnce() -> R + Send,
) -> (R, f64, Reliability) {
    let threads = renderer.settings().threads;
    let (result, seconds, reliability) = renderer.on_threads(|| on_own_cores(threads, work));
    (result, 1e3 * seconds, reliability)
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
    /// Reliability of both speeds.
    #[serde(flatten)]
    pub reliability: Reliability,
}

impl Ratio {
    /// Returns the speed of `fast` over that of `slow`; `None` before their first common round.
    pub(crate) fn of(fast: &Times, slow: &Times) -> Option<Self> {
        let worse = fast.reliability.iter().zip(&slow.reliability).map(|(fast, slow)| fast.worse(slow));
        Self::of_rounds(&fast.turns, &slow.turns, &worse.collect::<Vec<_>>())
    }

    /// Returns the ratio of two lists of times, a time a round, with the reliability of the rounds.
    pub fn of_rounds(fast: &[f64], slow: &[f64], rounds: &[Reliability]) -> Option<Self> {
        let ratios: Vec<f64> = fast.iter().zip(slow).map(|(fast, slow)| slow / fast).collect();
        (!ratios.is_empty()).then(|| {
            let (count, ratios) = (ratios.len(), Quantiles::of(ratios));
            let reliability = Reliability::of(rounds, count >= FEWEST_ROUNDS);
            Self { median: ratios.median(), spread: ratios.spread(), rounds: count, reliability }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratio_is_that_of_the_rounds_and_not_of_the_medians() {
        // From the third round on the machine is three times as slow. The last turn of `slow` has no
        // counterpart.
        let fast = Times::known(&[1.0, 1.0, 3.0, 3.0, 3.0]);
        let mut slow = Times::known(&[4.0, 4.0, 12.0, 12.0, 24.0, 99.0]);
        let reliability = Reliability { reliable: true, pinned: true, taken: Some(0.0) };
        let ratio = Ratio { median: 4.0, spread: [4.0, 8.0], rounds: 5, reliability };
        assert_eq!(Ratio::of(&fast, &slow), Some(ratio));
        assert_eq!(Ratio::of(&Times::default(), &slow), None);
        let is_reliable = |fast: &Times, slow: &Times| Ratio::of(fast, slow).unwrap().reliability.reliable;
        assert!(!is_reliable(&Times::known(&[1.0, 1.0]), &slow), "of two rounds");
        // Others took a tenth of the time in most turns of one of the two.
        slow.reliability[..4].iter_mut().for_each(|turn| turn.taken = Some(0.1));
        assert!(!is_reliable(&fast, &slow));
    }
}
