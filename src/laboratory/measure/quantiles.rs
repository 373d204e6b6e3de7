//! Quantiles of measurements, and how many rounds to measure.

use serde::Serialize;
use std::time::Instant;

/// Measurements, sorted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Quantiles {
    /// Ascending; at least one.
    sorted: Vec<f64>,
}

impl Quantiles {
    /// # Panics
    /// If there are no values.
    pub fn of(mut values: Vec<f64>) -> Self {
        assert!(!values.is_empty(), "no measurements");
        values.sort_by(f64::total_cmp);
        Self { sorted: values }
    }
    /// Returns the value below which a fraction of the measurements lies (nearest rank).
    pub fn at(&self, fraction: f64) -> f64 {
        let rank = (fraction * self.sorted.len() as f64).ceil() as usize;
        self.sorted[rank.clamp(1, self.sorted.len()) - 1]
    }
    /// Returns the middle value; the mean of the two middle values of an even count.
    pub fn median(&self) -> f64 {
        let middle = self.sorted.len() / 2;
        if self.sorted.len() % 2 == 1 {
            self.sorted[middle]
        } else {
            (self.sorted[middle - 1] + self.sorted[middle]) / 2.0
        }
    }
    /// Returns the 10th and the 90th percentile.
    pub fn spread(&self) -> [f64; 2] {
        [self.at(0.1), self.at(0.9)]
    }
    pub fn count(&self) -> usize {
        self.sorted.len()
    }
}

/// Median and spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// The middle value.
    pub median: f64,
    /// The 10th percentile.
    pub p10: f64,
    /// The 90th percentile.
    pub p90: f64,
}

impl Spread {
    /// # Panics
    /// If there are no values.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values = Quantiles::of(values.into_iter().collect());
        let [p10, p90] = values.spread();
        Self { median: values.median(), p10, p90 }
    }
}

/// The rounds of a measurement, numbered from 0: at least `fewest`, at most `most`, and between the two until
/// the time is over. All that is compared is measured once a round.
pub(crate) struct Rounds {
    fewest: usize,
    most: usize,
    end: Instant,
    /// Rounds that have begun.
    begun: usize,
    /// A round begins only if it ends in time, should it take as long as the last one.
    whole: bool,
    last_start: Instant,
}

impl Rounds {
    /// Builds rounds that begin before `end` and may end after it.
    pub fn until(end: Instant, fewest: usize, most: usize) -> Self {
        Self { fewest, most, end, begun: 0, whole: false, last_start: Instant::now() }
    }
    /// Builds rounds that begin only if they are expected to end before `end`.
    pub fn within(end: Instant, fewest: usize, most: usize) -> Self {
        Self { whole: true, ..Self::until(end, fewest, most) }
    }
}

impl Iterator for Rounds {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let now = Instant::now();
        let last = if self.whole { now - self.last_start } else { std::time::Duration::ZERO };
        if self.begun >= self.fewest && (self.begun >= self.most || now + last >= self.end) {
            return None;
        }
        self.last_start = now;
        self.begun += 1;
        Some(self.begun - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn rounds_are_the_fewest_without_time_and_the_most_with_time() {
        let (now, later) = (Instant::now(), Instant::now() + Duration::from_secs(3600));
        assert!(Rounds::until(now, 3, 8).eq(0..3) && Rounds::within(now, 3, 8).eq(0..3));
        assert!(Rounds::until(later, 3, 8).eq(0..8) && Rounds::within(later, 3, 8).eq(0..8));
        assert!(Rounds::until(later, 9, 8).eq(0..9), "the fewest come first");
    }
}
