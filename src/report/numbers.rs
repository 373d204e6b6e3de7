//! Numbers as text, in one style for all reports.

use crate::measure::cores::Reliability;
use crate::measure::timed::Ratio;
use crate::wording::grouped;
use std::time::Duration;

/// Formats a number with `decimals` decimals, or with more where that leaves fewer than two significant
/// digits.
pub fn figure(x: f64, decimals: usize) -> String {
    // The cast saturates, and the clamp bounds the decimals of 0 and of numbers that are not finite.
    let needed = (1.0 - x.log10().floor()).clamp(0.0, 12.0) as usize;
    grouped(format!("{x:.0$}", decimals.max(if x > 0.0 { needed } else { 0 })))
}

/// Formats a share in per cent with two significant digits: 0, 0.0013 %, 4.5 %, 100 %.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 {
        return "0 %".into();
    }
    // Two digits would round 99.6 to 100.
    if percent > 99.0 && percent < 100.0 {
        return format!("{:.1} %", percent.min(99.9));
    }
    let decimals = (1.0 - percent.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{percent:.decimals$} %")
}

/// Returns the mark of a figure that is not reliable.
pub fn mark(figure: Reliability) -> &'static str {
    if figure.reliable { "" } else { "?" }
}

/// Formats a ratio, marked where it is not reliable, with its spread in brackets.
pub fn ratio(Ratio { median, spread: [low, high], reliability, .. }: Ratio) -> String {
    format!("{median:.2}×{} ({low:.2}–{high:.2})", mark(reliability))
}

/// Formats a ratio with two digits, or three just around 1; empty where it is not finite.
pub fn times(ratio: f64) -> String {
    match ratio {
        _ if !ratio.is_finite() => String::new(),
        _ if ratio < 1.995 => format!("{ratio:.2}×"),
        _ if ratio < 9.95 => format!("{ratio:.1}×"),
        _ => format!("{}×", figure(ratio, 0)),
    }
}

/// Returns millions of rays per second.
pub fn mrays_per_s(rays: u64, time: Duration) -> f64 {
    rays as f64 / time.as_secs_f64().max(1e-9) / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_never_shows_less_than_two_digits() {
        for (x, decimals, text) in [
            (123.46, 1, "123.5"),
            (1.25, 1, "1.2"),
            (0.96, 1, "0.96"),
            (0.0432, 1, "0.043"),
            (1.2e-7, 1, "0.00000012"),
            (0.0, 1, "0.0"),
            (1667.3, 0, "1,667"),
            (12_345.678, 1, "12,345.7"),
            (12.3, 0, "12"),
            (5.31, 0, "5.3"),
            (0.27, 0, "0.27"),
        ] {
            assert_eq!(figure(x, decimals), text);
        }
    }

    #[test]
    fn percent_has_two_digits_and_calls_only_nothing_0_and_all_100() {
        let shares = [0.0, 2.5e-6, 0.000_013, 0.045, 0.5, 0.996, 0.99999, 1.0];
        let texts = ["0 %", "0.00025 %", "0.0013 %", "4.5 %", "50 %", "99.6 %", "99.9 %", "100 %"];
        assert_eq!(shares.map(percent), texts);
    }
}
