//! Maps numbers to positions along an axis, and chooses its ticks.

/// A logarithmic scale spans at least so many decades.
const LEAST_DECADES: f64 = 0.5;

/// The scale of an axis. Its coordinate is the number, or its logarithm to base 10.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    log: bool,
    /// The coordinates of the axis's ends.
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    /// The coordinate of numbers that have no logarithm.
    zero: f64,
    /// The positions of `low` and `high`, in units of the drawing.
    ends: [i32; 2],
}

impl Scale {
    /// Builds a logarithmic scale around these numbers. Numbers that are 0 or less are at the lower end, at a
    /// tick "0".
    pub fn log(numbers: &[f64], most_ticks: usize, ends: [i32; 2]) -> Self {
        let logs = || numbers.iter().filter(|x| x.is_finite() && **x > 0.0).map(|x| x.log10());
        let least = logs().reduce(f64::min).unwrap_or(0.0);
        let most = logs().reduce(f64::max).unwrap_or(1.0);
        let wide = most - least;
        let margin = (0.04 * wide).max((LEAST_DECADES - wide) / 2.0) + 0.02;
        let (mut low, high) = (least - margin, most + margin);
        let mut ticks = decades(low, high, most_ticks);
        let zero = low - 0.12 * (high - low) - 0.1;
        if numbers.iter().any(|x| *x <= 0.0) {
            ticks.push(0.0);
            low = zero - 0.02 * (high - low);
        }
        Self { log: true, low, high, ticks, zero, ends }
    }

    /// Builds a linear scale from 0 to the largest of these numbers.
    pub fn from_zero(numbers: &[f64], most_ticks: usize, ends: [i32; 2]) -> Self {
        let most = numbers.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
        let high = if most > 0.0 { most } else { 1.0 };
        let first = high.log10().floor() as i32 - 1;
        let mut steps = (first..).flat_map(|power| [1, 2, 5].map(|digit| decimal(digit, power)));
        let step = steps.find(|step| high / step < most_ticks as f64).unwrap_or(high);
        let ticks = (0..most_ticks).map(|number| number as f64 * step).filter(|tick| *tick <= high).collect();
        Self { log: false, low: 0.0, high, ticks, zero: 0.0, ends }
    }

    /// Returns the position of a number.
    pub fn at(&self, number: f64) -> i32 {
        let coordinate = match self.log {
            true if number <= 0.0 => self.zero,
            true => number.log10(),
            false => number,
        };
        let [low, high] = self.ends.map(f64::from);
        (low + (high - low) * (coordinate - self.low) / (self.high - self.low)).round() as i32
    }

    /// Positions and labels.
    pub fn ticks(&self) -> impl Iterator<Item = (i32, String)> {
        self.ticks.iter().map(|&tick| {
            let short = tick == 0.0 || !self.log || (1e-3..1e4).contains(&tick);
            let rounded = (tick * 1e6).round() / 1e6;
            (self.at(tick), if short { format!("{rounded}") } else { format!("{tick:e}") })
        })
    }
}

/// Returns a digit times a power of ten.
fn decimal(digit: u8, power: i32) -> f64 {
    format!("{digit}e{power}").parse().expect("a number")
}

/// Returns at most `most` ticks between two logarithms, at the densest of these digits times powers of ten.
fn decades(low: f64, high: f64, most: usize) -> Vec<f64> {
    const DIGITS: [&[u8]; 4] = [&[1, 2, 3, 5], &[1, 2, 5], &[1, 3], &[1]];
    let rules = DIGITS.map(|digits| (digits, 1)).into_iter().chain((2..).map(|every| (&[1][..], every)));
    let ticks = |(digits, every): (&[u8], i32)| -> Vec<f64> {
        let powers = (low.floor() as i32..=high.ceil() as i32).filter(|power| power.rem_euclid(every) == 0);
        let all = powers.flat_map(|power| digits.iter().map(move |&digit| decimal(digit, power)));
        all.filter(|tick| (low..=high).contains(&tick.log10())).collect()
    };
    rules.map(ticks).find(|ticks| ticks.len() <= most).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> Vec<String> {
        scale.ticks().map(|(_, label)| label).collect()
    }

    #[test]
    fn numbers_without_a_logarithm_stand_below_all_others_at_a_tick_of_their_own() {
        let scale = Scale::log(&[0.0, 1e-6, 1.0], 5, [0, 1_000]);
        assert!(0 < scale.at(0.0) && scale.at(0.0) < scale.at(1e-6) && scale.at(1.0) < 1_000);
        assert_eq!(labels(&scale), ["1e-6", "1e-4", "0.01", "1", "0"]);
    }

    #[test]
    fn ticks_are_round_inside_and_not_too_many() {
        let log = |least, most, count| labels(&Scale::log(&[least, most], count, [0, 100]));
        assert_eq!(log(1.0, 10.0, 4), ["1", "2", "5", "10"]);
        assert_eq!(log(0.3, 0.4, 7), ["0.2", "0.3", "0.5"]);
        assert_eq!(log(1e-12, 1e4, 6), ["1e-12", "1e-9", "1e-6", "0.001", "1", "1000"]);
        let linear = |most| labels(&Scale::from_zero(&[most], 4, [0, 100]));
        assert_eq!(linear(1.14), ["0", "0.5", "1"]);
        assert_eq!(linear(13.0), ["0", "5", "10"]);
        assert_eq!(linear(0.35), ["0", "0.1", "0.2", "0.3"]);
        assert_eq!(linear(0.0), ["0", "0.5", "1"]);
    }
}
