//! How far numbers are from what chance would make them, in standard errors.

/// Standard errors that the largest of `family` normal deviates exceeds with probability 1e-4: from the
/// tail's bound e^(−z²/2).
pub fn allowed(family: usize) -> f64 {
    (2.0 * (2e4 * family as f64).ln()).sqrt()
}

/// Asserts that of a family of deviations, each with what it is of, none is more than chance allows.
pub fn assert_all_within(deviations: Vec<(f64, String)>) {
    let family = deviations.len();
    for (deviation, what) in deviations {
        assert!(deviation.abs() < allowed(family), "{what}: {deviation:.1} standard errors");
    }
}

/// The mean of some numbers, and its standard error.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

/// χ² in standard errors from its expectation, by Wilson and Hilferty's cube root, which is normal to within
/// some percent.
pub fn chi_squared_deviation(counts: &[usize], expected: f64) -> f64 {
    let chi2: f64 = counts.iter().map(|&count| (count as f64 - expected).powi(2) / expected).sum();
    deviation_of(chi2, (counts.len() - 1) as f64)
}

/// The same of χ² itself with so many degrees of freedom.
pub fn deviation_of(chi2: f64, freedom: f64) -> f64 {
    let variance = 2.0 / (9.0 * freedom);
    ((chi2 / freedom).cbrt() - (1.0 - variance)) / variance.sqrt()
}

/// The correlation of pairs of uniform numbers, in standard errors.
pub fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (x, y) in pairs {
        sum += (x - 0.5) * (y - 0.5);
        count += 1.0;
    }
    // Of independent numbers, each product has the variance 1/144.
    sum / (count / 144.0_f64).sqrt()
}

/// Joint uniformity of pairs on an 8 × 8 grid, in standard errors: sees dependence that correlation does not.
pub fn joint(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut counts = [0; 64];
    let mut count = 0.0;
    for (x, y) in pairs {
        counts[(x * 8.0) as usize * 8 + (y * 8.0) as usize] += 1;
        count += 1.0;
    }
    chi_squared_deviation(&counts, count / 64.0)
}
