//! The two clocks of one thread, and which of them decides.

use crate::measure::cores::{Reliability, on_own_cores};
use crate::measure::quantiles::{Quantiles, Spread};
use serde::Serialize;

/// A clock by which work on one thread is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// All that passes.
    Wall,
    /// The thread's own processor time: that of other programs does not count.
    Processor,
}

/// Above this ratio of their 90 % and 10 % quantiles, times are not relied on.
const SCATTERED: f64 = 1.5;

/// Seconds of equal work on the wall and of processor time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times(Vec<[f64; 2]>);

/// Times work on the calling thread, pinned to a core, by both clocks; the wall's alone where the system has
/// no other.
pub(crate) fn time(work: impl FnOnce()) -> [f64; 2] {
    let ((), wall, others) = on_own_cores(1, work);
    [wall, wall * (1.0 - others.taken.unwrap_or(0.0))]
}

impl Times {
    pub fn push(&mut self, times: [f64; 2]) {
        self.0.push(times);
    }
    pub fn by(&self, clock: Clock) -> Vec<f64> {
        self.0.iter().map(|times| times[clock as usize]).collect()
    }
    pub fn spread(&self, clock: Clock) -> Spread {
        Spread::of(self.by(clock))
    }
    /// Returns the share of the time that other programs took, in the median.
    pub fn taken(&self) -> f64 {
        Quantiles::of(self.0.iter().map(|[wall, processor]| 1.0 - processor / wall).collect()).median()
    }
    /// Returns how far these times by this clock can be relied on, given whether they are `enough`. A busy
    /// machine does not make the processor's times wrong.
    pub fn reliability(&self, clock: Clock, enough: bool) -> Reliability {
        let Spread { p10, p90, .. } = self.spread(clock);
        let reliable = enough && p90 <= SCATTERED * p10;
        Reliability { reliable, pinned: cfg!(target_os = "linux"), taken: Some(self.taken()) }
    }
}

impl Clock {
    /// Chooses the processor's clock where most of the times are those of a busy machine.
    pub(crate) fn of<'a>(times: impl Iterator<Item = &'a Times>) -> Self {
        let taken = Some(Quantiles::of(times.map(Times::taken).collect()).median());
        let busy = Reliability { reliable: true, pinned: true, taken }.is_busy();
        if busy { Self::Processor } else { Self::Wall }
    }
}
