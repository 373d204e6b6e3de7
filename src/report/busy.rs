//! The warning that other programs took the processor while something was timed.
//!
//! For: [`warning`].

/// Names the result whose `share`, the speed of its slow parts over that of the median, is the least, where
/// that is below `bound`. `evidence` says so of a result, with the share in percent.
pub fn warning<'a, R: 'a>(
    results: impl Iterator<Item = &'a R>,
    share: impl Fn(&R) -> f64,
    bound: f64,
    evidence: impl Fn(&R, &str) -> String,
) -> Option<String> {
    let worst = results.min_by(|a, b| share(a).total_cmp(&share(b))).filter(|worst| share(worst) < bound)?;
    let evidence = evidence(worst, &format!("{:.0} %", 100.0 * share(worst)));
    Some(format!(
        "the machine is busy: {evidence}; end other programs and measure again: ratios are wrong, too."
    ))
}
