//! Running moments and estimates.

/// Mean and variance of a stream in one pass (Welford 1962), mergeable (Chan, Golub & LeVeque 1979).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Welford {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Welford {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { count: 0, mean: 0.0, squares: 0.0 }
    }

    /// Takes in one value. A NaN stays visible: it makes mean and variance NaN.
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
    }

    /// Both streams together.
    #[must_use]
    pub fn merged(self, other: Self) -> Self {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { other } else { self };
        }
        let count = self.count + other.count;
        let share = other.count as f64 / count as f64;
        let apart = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + apart * share,
            squares: self.squares + other.squares + apart * apart * self.count as f64 * share,
        }
    }

    /// How many values were taken in.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; 0 of none.
    #[must_use]
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// Their unbiased sample variance; NaN of fewer than two.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }

    /// Standard error of the mean; NaN of fewer than two values.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }

    /// The mean as an estimate that knows its degrees of freedom.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        let freedom = (self.count.max(1) - 1) as f64;
        Estimate { mean: self.mean, standard_error: self.standard_error(), degrees_of_freedom: Some(freedom) }
    }
}

impl Extend<f64> for Welford {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, values: I) {
        for value in values {
            self.push(value);
        }
    }
}

impl FromIterator<f64> for Welford {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::new();
        moments.extend(values);
        moments
    }
}

/// A measured mean with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The mean, in the units of what was measured.
    pub mean: f64,
    /// Standard error of the mean, in the same units; 0 for a noise-free measurement.
    pub standard_error: f64,
    /// Degrees of freedom of the standard error; `None` when there are so many that it counts as known.
    pub degrees_of_freedom: Option<f64>,
}

impl Estimate {
    /// An estimate whose standard error comes from so many samples that it counts as known.
    #[must_use]
    pub const fn new(mean: f64, standard_error: f64) -> Self {
        Self { mean, standard_error, degrees_of_freedom: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_survive_a_large_offset_where_sums_of_squares_would_not() {
        let moments: Welford = [4.0, 7.0, 13.0, 16.0].iter().map(|x| x + 1e9).collect();
        assert_eq!(moments.mean(), 1e9 + 10.0);
        assert_eq!(moments.variance(), 30.0);
    }

    #[test]
    fn merging_equals_one_pass() {
        let values: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.7).sin()).collect();
        let whole: Welford = values.iter().copied().collect();
        for cut in [0, 1, 17, 999, 1000] {
            let left: Welford = values[..cut].iter().copied().collect();
            let right: Welford = values[cut..].iter().copied().collect();
            let merged = left.merged(right);
            assert_eq!(merged.count(), whole.count());
            assert!((merged.mean() - whole.mean()).abs() < 1e-15);
            assert!((merged.variance() - whole.variance()).abs() < 1e-14);
        }
    }

    #[test]
    fn too_few_values_have_no_spread_and_nan_is_kept() {
        let one: Welford = [1.0].into_iter().collect();
        assert!(one.variance().is_nan());
        let poisoned: Welford = [1.0, f64::NAN, 2.0].into_iter().collect();
        assert!(poisoned.mean().is_nan());
    }
}
