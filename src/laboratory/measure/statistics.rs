//! What many measurements say together.

/// Measurements, sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantiles {
    /// Ascending; at least one.
    sorted: Vec<f64>,
}

impl Quantiles {
    /// # Panics
    /// If there are none.
    pub fn of(mut values: Vec<f64>) -> Self {
        assert!(!values.is_empty(), "no measurements");
        values.sort_by(f64::total_cmp);
        Self { sorted: values }
    }
    /// The value below which a fraction of the measurements lies (nearest rank).
    pub fn at(&self, fraction: f64) -> f64 {
        let rank = (fraction * self.sorted.len() as f64).ceil() as usize;
        self.sorted[rank.clamp(1, self.sorted.len()) - 1]
    }
    /// The middle one; the mean of the two middle ones of an even number.
    pub fn median(&self) -> f64 {
        let middle = self.sorted.len() / 2;
        if self.sorted.len() % 2 == 1 {
            self.sorted[middle]
        } else {
            (self.sorted[middle - 1] + self.sorted[middle]) / 2.0
        }
    }
    pub fn count(&self) -> usize {
        self.sorted.len()
    }
}

#[cfg(test)]
mod tests {
    use super::Quantiles;

    #[test]
    fn median_is_the_middle_of_odd_and_the_mean_of_the_middles_of_even_counts() {
        assert_eq!(Quantiles::of(vec![3.0, 1.0, 2.0]).median(), 2.0);
        assert_eq!(Quantiles::of(vec![4.0, 1.0, 2.0, 3.0]).median(), 2.5);
    }

    #[test]
    fn quantile_is_the_nearest_rank() {
        let hundred = Quantiles::of((1..=100).map(f64::from).collect());
        assert_eq!(hundred.at(0.99), 99.0);
        assert_eq!(hundred.at(0.1), 10.0);
        assert_eq!(hundred.at(0.0), 1.0);
        assert_eq!(hundred.at(1.0), 100.0);
    }
}
