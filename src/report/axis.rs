//! Maps numbers to positions along an axis, and chooses its ticks.
//!
//! For: [`Axis`], and `Range`.

/// A coordinate. The axis covers the range of the data.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    pub label: String,
    /// Logarithmic, to base 10. Numbers that are not above 0 are drawn at the lower edge, at a tick labelled
    /// "0".
    pub log: bool,
}

impl Axis {
    /// The label beside the axis.
    pub(super) fn name(&self) -> String {
        if self.log { format!("{} (log scale)", self.label) } else { self.label.clone() }
    }
}

/// A logarithmic axis spans at least so many decades, and has at least so many ticks where possible.
const LEAST_DECADES: f64 = 0.5;
const FEWEST_TICKS: usize = 3;

/// The range of an axis, in its own coordinate: the number, or its logarithm to base 10.
pub(super) struct Range {
    log: bool,
    pub low: f64,
    pub high: f64,
    pub ticks: Vec<f64>,
    /// The coordinate of numbers that have no logarithm.
    zero: Option<f64>,
    /// The positions of `low` and `high`, in units of the drawing.
    units: [i32; 2],
}

impl Range {
    pub fn of(axis: &Axis, numbers: &[f64], units: [i32; 2]) -> Self {
        let shown = |number: &f64| number.is_finite() && (!axis.log || *number > 0.0);
        let coordinates = numbers.iter().copied().filter(shown);
        let coordinates: Vec<f64> =
            coordinates.map(|number| if axis.log { number.log10() } else { number }).collect();
        let least = coordinates.iter().copied().reduce(f64::min).unwrap_or(0.0);
        let most = coordinates.iter().copied().reduce(f64::max).unwrap_or(1.0);
        let has_zero = axis.log && numbers.iter().any(|&number| number <= 0.0);
        let (mut low, high, mut ticks) = if axis.log { decades(least, most) } else { steps(least, most) };
        let zero = has_zero.then(|| {
            low -= 0.06 * (high - low) + 0.2;
            low + 0.03 * (high - low)
        });
        ticks.extend(zero);
        Self { log: axis.log, low, high, ticks, zero, units }
    }

    pub fn place(&self, number: f64) -> f64 {
        match self.zero {
            Some(zero) if number <= 0.0 => zero,
            _ if self.log => number.log10(),
            _ => number,
        }
    }

    /// The position of a number in the drawing.
    pub fn at(&self, number: f64) -> i32 {
        self.unit(self.place(number))
    }

    /// The position of a coordinate in the drawing.
    pub fn unit(&self, at: f64) -> i32 {
        let [low, high] = self.units.map(f64::from);
        (low + (high - low) * (at - self.low) / (self.high - self.low)).round() as i32
    }

    pub fn label(&self, at: f64) -> String {
        match self.zero {
            Some(zero) if at == zero => "0".into(),
            _ if self.log => power(at),
            _ => format!("{}", (at * 1e9).round() / 1e9),
        }
    }
}

/// The range around these logarithms, and ticks: powers of ten; where these are few, also 2 and 5 times
/// these, or all digits.
fn decades(least: f64, most: f64) -> (f64, f64, Vec<f64>) {
    let margin = (0.04 * (most - least)).max(LEAST_DECADES / 2.0 - (most - least) / 2.0) + 0.02;
    let (low, high) = (least - margin, most + margin);
    let every = ((high - low) / 8.0).ceil().max(1.0) as i32;
    let ticks = |factors: &[u8]| {
        let powers = (low.floor() as i32..=high.ceil() as i32).filter(|power| power.rem_euclid(every) == 0);
        let all = powers.flat_map(|power| {
            factors.iter().map(move |&factor| f64::from(power) + f64::from(factor).log10())
        });
        all.filter(|&tick| tick >= low && tick <= high).collect::<Vec<f64>>()
    };
    let sets: [&[u8]; 3] = [&[1], &[1, 2, 5], &[1, 2, 3, 4, 5, 6, 8]];
    let enough = sets.into_iter().map(ticks).find(|ticks| ticks.len() >= FEWEST_TICKS);
    (low, high, enough.unwrap_or_else(|| ticks(sets[2])))
}

/// The range around these numbers, and ticks at 1, 2 or 5 times a power of ten.
fn steps(least: f64, most: f64) -> (f64, f64, Vec<f64>) {
    let wide = if most > least { most - least } else { least.abs().max(1.0) };
    let (low, high) = (least - 0.04 * wide, most + 0.04 * wide);
    let power = 10f64.powf((wide / 6.0).log10().floor());
    let step =
        power * [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power * 8.0 >= wide).unwrap_or(10.0);
    let ticks = (0..20).map(|number| (low / step).ceil() * step + f64::from(number) * step);
    (low, high, ticks.take_while(|&tick| tick <= high).collect())
}

/// A number given by its logarithm: as a decimal where that is short, otherwise as a power of ten.
fn power(logarithm: f64) -> String {
    let exponent = logarithm.floor() as i32;
    let factor = 10f64.powf(logarithm - f64::from(exponent)).round() as i32;
    if (-3..4).contains(&exponent) {
        let number = f64::from(factor) * 10f64.powi(exponent);
        return format!("{}", (number * 1e6).round() / 1e6);
    }
    let raised: String = exponent
        .to_string()
        .chars()
        .map(|digit| match digit {
            '-' => '⁻',
            digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize - '0' as usize],
        })
        .collect();
    if factor == 1 { format!("10{raised}") } else { format!("{factor}·10{raised}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_without_a_logarithm_lie_below_all_others_at_a_tick_of_their_own() {
        let range = Range::of(&Axis { log: true, ..Axis::default() }, &[0.0, 1e-6, 1.0], [0, 100]);
        assert!(range.low < range.place(0.0) && range.place(0.0) < range.place(1e-6));
        assert_eq!(range.label(range.place(0.0)), "0");
        assert_eq!(range.label(-6.0), "10⁻⁶");
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let (low, high, ticks) = steps(0.0, 13.0);
        assert_eq!(ticks, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0]);
        assert!(low < 0.0 && high > 13.0);
        let (_, _, ticks) = decades(0.0, 1.0);
        let texts: Vec<_> = ticks.into_iter().map(power).collect();
        assert_eq!(texts, ["1", "2", "5", "10"]);
        assert_eq!(decades(-12.0, 4.0).2.len(), 6, "every third");
        assert_eq!(power(5f64.log10() - 9.0), "5·10⁻⁹");
    }
}
