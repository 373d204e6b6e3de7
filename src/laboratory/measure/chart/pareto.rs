//! Dominance and the Pareto front of error against time.
//!
//! A configuration is measured at a few points and interpolated between them by straight lines in logarithms.
//! After its last point its error is extrapolated with the root of time, as that of independent samples;
//! before its first point it has no error.

use crate::measure::quantiles::{Quantiles, Spread};

/// Error against time of one configuration.
pub struct ErrorCurve {
    /// Logarithms of (seconds, error), by seed, then by level.
    seeds: Vec<Vec<[f64; 2]>>,
    /// Their medians, by level.
    medians: Vec<[f64; 2]>,
}

impl ErrorCurve {
    /// Builds a curve from seconds and errors by level, each by seed; both above 0.
    pub fn new(levels: impl Iterator<Item = (Vec<f64>, Vec<f64>)>) -> Self {
        let mut curve = Self { seeds: Vec::new(), medians: Vec::new() };
        for (seconds, errors) in levels {
            curve.seeds.resize(seconds.len(), Vec::new());
            for (seed, (time, error)) in curve.seeds.iter_mut().zip(seconds.iter().zip(&errors)) {
                seed.push([time.ln(), error.ln()]);
            }
            curve.medians.push([seconds, errors].map(|values| Quantiles::of(values).median().ln()));
        }
        curve
    }

    /// Tests whether this curve has a smaller error in the time of a level of the other for at least nine of
    /// ten seeds.
    pub fn beats(&self, other: &ErrorCurve, level: usize) -> bool {
        let better = |(ours, theirs): (&Vec<[f64; 2]>, &Vec<[f64; 2]>)| {
            let [time, error] = theirs[level];
            error_at(ours, time).is_some_and(|ours| ours < error)
        };
        let seeds = self.seeds.iter().zip(&other.seeds);
        10 * seeds.filter(|pair| better(*pair)).count() >= 9 * self.seeds.len()
    }

    /// Returns the curve that dominates this one: if some other curve beats this one at every level, the
    /// first that does so at all levels, or else the one with the smallest error at the last level.
    pub(crate) fn dominated_by<'a>(&self, others: &[(&'a str, &ErrorCurve)]) -> Option<&'a str> {
        let levels = 0..self.medians.len();
        let everywhere =
            |(_, other): &&(&str, &ErrorCurve)| levels.clone().all(|level| other.beats(self, level));
        if let Some((name, _)) = others.iter().find(everywhere) {
            return Some(name);
        }
        let somewhere = |level| others.iter().any(|(_, other)| other.beats(self, level));
        if !levels.clone().all(somewhere) {
            return None;
        }
        let last = self.medians.len() - 1;
        let error =
            |other: &ErrorCurve| error_at(&other.medians, self.medians[last][0]).unwrap_or(f64::INFINITY);
        let at_last = others.iter().filter(|(_, other)| other.beats(self, last));
        at_last.min_by(|a, b| error(a.1).total_cmp(&error(b.1))).map(|(name, _)| *name)
    }

    /// Returns the time to the error of this curve's last point, or of the default's where that is larger,
    /// over the time of `default` to the same error: by the medians, and from 10 to 90 % of the seeds.
    /// Neither is extrapolated to errors that it did not reach.
    pub(crate) fn time_to_last_error_over(&self, default: &ErrorCurve) -> Spread {
        let ratio = |(ours, theirs): (&Vec<[f64; 2]>, &Vec<[f64; 2]>)| {
            let error = ours[ours.len() - 1][1].max(theirs[theirs.len() - 1][1]);
            (time_at(ours, error) - time_at(theirs, error)).exp()
        };
        let median = ratio((&self.medians, &default.medians));
        let Spread { p10, p90, .. } = Spread::of(self.seeds.iter().zip(&default.seeds).map(ratio));
        Spread { median, p10: p10.min(median), p90: p90.max(median) }
    }
}

/// Slope of the extrapolation: Δ ln error / Δ ln time.
const SLOPE: f64 = -0.5;

/// Returns the error of a curve at a time, in logarithms; `None` before its first point.
fn error_at(curve: &[[f64; 2]], time: f64) -> Option<f64> {
    let (first, last) = (curve.first()?, curve.last()?);
    if time < first[0] {
        return None;
    }
    let after = curve.partition_point(|point| point[0] <= time);
    if after == curve.len() {
        return Some(last[1] + SLOPE * (time - last[0]));
    }
    let ([t0, e0], [t1, e1]) = (curve[after - 1], curve[after]);
    Some(e0 + (e1 - e0) * (time - t0) / (t1 - t0))
}

/// Returns the time at which a curve first has this error, in logarithms.
fn time_at(curve: &[[f64; 2]], error: f64) -> f64 {
    let reached = curve.iter().position(|point| point[1] <= error);
    match reached {
        // Before the first point: extrapolated with the same slope.
        Some(0) => curve[0][0] + (error - curve[0][1]) / SLOPE,
        Some(at) => {
            let ([t0, e0], [t1, e1]) = (curve[at - 1], curve[at]);
            t0 + (t1 - t0) * (error - e0) / (e1 - e0)
        }
        None => {
            let [time, last] = curve[curve.len() - 1];
            time + (error - last) / SLOPE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a curve `speed` times as fast as one second a pass with an error of `noise`; seeds differ by a
    /// few per cent.
    fn curve(speed: f64, noise: f64, levels: u32) -> ErrorCurve {
        ErrorCurve::new((0..levels).map(|level| {
            let samples = f64::from(1 << level);
            let seeds = [0.97, 1.0, 1.02];
            let seconds = seeds.map(|seed| samples / speed * seed);
            let errors = seeds.map(|seed| noise / samples.sqrt() / seed);
            (seconds.to_vec(), errors.to_vec())
        }))
    }

    /// Returns a curve of one level, from seconds and errors by seed.
    fn point(seconds: &[f64], errors: &[f64]) -> ErrorCurve {
        ErrorCurve::new([(seconds.to_vec(), errors.to_vec())].into_iter())
    }

    #[test]
    fn time_to_equal_error_is_extrapolated_with_the_root_of_time() {
        let steep = [(1.0, 1.0), (2.0, 0.5f64.sqrt()), (4.0, 0.1)].map(|(t, e)| (vec![t / 2.0], vec![e]));
        for (ours, default, expected) in [
            (curve(1.0, 1.0, 5), curve(2.0, 1.0, 5), 2.0),
            (curve(2.0, 1.0, 5), curve(1.0, 1.0, 5), 0.5),
            // The error counts squared.
            (curve(1.0, 2.0, 5), curve(1.0, 1.0, 5), 4.0),
            // Sixteen times the samples of the last point, and a sixteenth of those of the first.
            (curve(1.0, 1.0, 6), curve(1.0, 1.0, 2), 1.0),
            (curve(1.0, 4.0, 1), curve(1.0, 1.0, 6), 16.0),
            // Twice as fast, with errors that fall faster than the root of time after the other's last point.
            (ErrorCurve::new(steep.into_iter()), curve(1.0, 1.0, 2), 0.5),
        ] {
            let found = ours.time_to_last_error_over(&default).median;
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} instead of {expected}");
        }
        let stays_below = |speed| curve(1.0, 1.0, 6).beats(&curve(speed, 1.0, 12), 11);
        assert!(stays_below(0.99) && !stays_below(1.01));
    }

    #[test]
    fn curve_is_a_line_of_logarithms_between_points() {
        let between = point(&[2.9; 3], &[3.0f64.sqrt().recip(); 3]);
        assert!(!curve(1.0, 1.0, 6).beats(&between, 0) && curve(1.1, 1.0, 6).beats(&between, 0));
    }

    #[test]
    fn dominated_is_what_another_beats_at_every_level_for_nine_of_ten_seeds() {
        let other =
            |worse: usize| point(&[1.0; 10], &[&vec![2.0; worse][..], &vec![0.5; 10 - worse]].concat());
        let early = point(&[0.1; 3], &[0.5; 3]);
        // A quick start with much noise, and a slow start with little.
        let (quick, good) = (curve(8.0, 4.0, 6), curve(1.0, 1.0, 6));
        let (slow, fast) = (curve(1.0, 1.0, 8), curve(3.0, 1.0, 3));
        let ten = point(&[1.0; 10], &[1.0; 10]);
        let one_of_three = point(&[0.995, 0.99, 1.0], &[1.0; 3]);
        for (ours, others, expected) in [
            (&ten, &[("nine", &other(1))][..], Some("nine")),
            (&ten, &[("eight", &other(2))], None),
            // Measured longer, and slower at the same error.
            (&slow, &[("fast", &fast)], Some("fast")),
            (&fast, &[("slow", &slow)], None),
            (&quick, &[("good", &good)], None),
            (&good, &[("quick", &quick)], None),
            (&point(&[1.0, 1.02, 0.99], &[1.0; 3]), &[("other", &one_of_three)], None),
            (&good, &[("early", &early)], Some("early")),
        ] {
            assert_eq!(ours.dominated_by(others), expected, "{:?}", others[0].0);
        }
        assert!(fast.beats(&slow, 7) && !slow.beats(&fast, 2));
    }
}
