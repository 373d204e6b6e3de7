//! What many measurements say together.

/// Frame times of one engine, sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Times {
    /// Seconds, ascending; at least one.
    sorted: Vec<f64>,
}

impl Times {
    /// # Panics
    /// If there are none.
    pub fn new(mut seconds: Vec<f64>) -> Self {
        assert!(!seconds.is_empty(), "no measurements");
        seconds.sort_by(f64::total_cmp);
        Self { sorted: seconds }
    }
    /// The time below which a fraction of the measurements lies (nearest rank).
    pub fn quantile(&self, fraction: f64) -> f64 {
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
    use super::Times;

    #[test]
    fn median_is_the_middle_of_odd_and_the_mean_of_the_middles_of_even_counts() {
        assert_eq!(Times::new(vec![3.0, 1.0, 2.0]).median(), 2.0);
        assert_eq!(Times::new(vec![4.0, 1.0, 2.0, 3.0]).median(), 2.5);
    }

    #[test]
    fn quantile_is_the_nearest_rank() {
        let hundred = Times::new((1..=100).map(f64::from).collect());
        assert_eq!(hundred.quantile(0.99), 99.0);
        assert_eq!(hundred.quantile(0.1), 10.0);
        assert_eq!(hundred.quantile(0.0), 1.0);
        assert_eq!(hundred.quantile(1.0), 100.0);
    }
}
