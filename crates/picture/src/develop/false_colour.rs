//! Numbers as colours.

use super::exposure::percentile;
use super::palette::palette;

/// The colour of values that are not finite: a green that the palette does not have.
pub const NOT_FINITE: [u8; 3] = [0, 255, 0];

/// How values are spread over the palette.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// By their logarithms. Values of 0 and below have the lowest colour.
    #[default]
    Log,
    /// Evenly.
    Linear,
}

/// Which colour a value has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourScale {
    axis: Axis,
    range: [f64; 2],
}

impl ColourScale {
    /// A scale with these values at its two ends.
    ///
    /// # Errors
    /// A sentence, where the ends are not finite, not in this order, too near to each other or, with [`Axis::Log`], not above 0.
    pub fn new(axis: Axis, [low, high]: [f64; 2]) -> Result<Self, String> {
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Err("the low end of the range must be below the high end, and both finite".to_owned());
        }
        if axis == Axis::Log && low <= 0.0 {
            return Err("the range of a logarithmic scale must begin above 0".to_owned());
        }
        let scale = Self { axis, range: [low, high] };
        let length = scale.coordinate(high) - scale.coordinate(low);
        if length.is_finite() && length > 0.0 {
            Ok(scale)
        } else {
            Err("the range is too narrow or too wide".to_owned())
        }
    }

    /// A scale that suits these values: up to the value of rank ⌊0.995·(n − 1)⌋ among the n finite values, so that a few bright pixels
    /// do not decide. A logarithmic scale counts values above 0 only, begins at rank ⌊0.01·(n − 1)⌋ and spans at most a factor of 1000.
    /// A linear one begins at 0, or below at rank ⌊0.005·(n − 1)⌋ if that is negative. Where all values are equal it goes from half of them to
    /// twice, or from 0 to 1.
    ///
    /// `None` where no value counts.
    ///
    /// ```
    /// use etalon_picture::develop::{Axis, ColourScale};
    ///
    /// let scale = ColourScale::fitting(Axis::Linear, (0..=1000).map(f64::from)).unwrap();
    /// assert_eq!(scale.range(), [0.0, 995.0]);
    /// ```
    #[must_use]
    pub fn fitting(axis: Axis, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let counts = |v: &f64| v.is_finite() && (axis == Axis::Linear || *v > 0.0);
        let mut values: Vec<f64> = values.into_iter().filter(counts).collect();
        let high = percentile(&mut values, 0.995)?;
        let range = match axis {
            Axis::Log => [percentile(&mut values, 0.01)?.max(high / 1000.0), high],
            Axis::Linear => [percentile(&mut values, 0.005)?.min(0.0), high],
        };
        let equal = if high > 0.0 { [0.5 * high, 2.0 * high] } else { [high.min(0.0), high.min(0.0) + 1.0] };
        Self::new(axis, range).or_else(|_| Self::new(axis, equal)).ok()
    }

    /// The values at the two ends.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// Where a value lies: 0 at the low end, 1 at the high end, beyond them outside. NaN for NaN.
    ///
    /// ```
    /// use etalon_picture::develop::{Axis, ColourScale};
    ///
    /// let scale = ColourScale::new(Axis::Log, [0.01, 100.0])?;
    /// assert_eq!(scale.place(1.0), 0.5);
    /// assert_eq!(scale.place(0.0), f64::NEG_INFINITY);
    /// # Ok::<(), String>(())
    /// ```
    #[must_use]
    pub fn place(&self, value: f64) -> f64 {
        let [low, high] = self.range.map(|end| self.coordinate(end));
        (self.coordinate(value) - low) / (high - low)
    }

    /// The colour of a value, as sRGB levels: [`palette`] of its place; [`NOT_FINITE`] for NaN and infinities.
    #[must_use]
    pub fn colour(&self, value: f64) -> [u8; 3] {
        if value.is_finite() { palette(self.place(value)) } else { NOT_FINITE }
    }

    fn coordinate(&self, value: f64) -> f64 {
        match self.axis {
            Axis::Log if value.is_nan() => value,
            Axis::Log => value.max(0.0).log10(),
            Axis::Linear => value,
        }
    }

    /// Round values within the range, at most about eight: 1, 2 and 5 times powers of ten, or fewer.
    #[must_use]
    pub fn ticks(&self) -> Vec<f64> {
        let [low, high] = self.range;
        match self.axis {
            Axis::Log => log_ticks(low, high),
            Axis::Linear => linear_ticks(low, high),
        }
    }
}

fn log_ticks(low: f64, high: f64) -> Vec<f64> {
    let [first, last] = [low.log10().floor() as i32, high.log10().ceil() as i32];
    let within = |steps: &[i32], every: usize| -> Vec<f64> {
        let powers = (first..=last).step_by(every);
        // By the decimal text, whose value is the nearest to the power.
        let tick = |step: &i32, power: i32| -> f64 { format!("{step}e{power}").parse().expect("a number") };
        powers.flat_map(|p| steps.iter().map(move |s| tick(s, p))).filter(|t| (low..=high).contains(t)).collect()
    };
    let decades = last - first;
    if decades > 4 {
        let every = decades as usize / 8 + 1;
        return within(&[1], every);
    }
    let ticks = within(&[1, 2, 5], 1);
    if ticks.len() >= 2 { ticks } else { linear_ticks(low, high) }
}

fn linear_ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 8.0;
    let power = rough.log10().floor();
    let unit = 10.0_f64.powf(power);
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|s| s * unit >= rough).unwrap_or(10.0);
    // Whole numbers of steps, as decimal numbers.
    let (first, last) = ((low / (step * unit)).ceil(), (high / (step * unit)).floor());
    let count = (last - first).clamp(0.0, 20.0) as usize;
    let tick = |k: usize| format!("{}e{power}", (first + k as f64) * step).parse().expect("a number");
    (0..=count).map(tick).filter(|tick| (low..=high).contains(tick)).collect()
}

/// A number in few characters: `0.05`, `2000`, `2e5`.
///
/// ```
/// use etalon_picture::develop::short_number;
///
/// assert_eq!([0.05, 2000.0, 2e5, 1.25e-7].map(short_number), ["0.05", "2000", "2e5", "1.25e-7"]);
/// ```
#[must_use]
pub fn short_number(value: f64) -> String {
    let size = value.abs();
    let exponent = size != 0.0 && !(1e-3..1e5).contains(&size);
    // Four digits at most.
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if exponent { format!("{rounded:e}") } else { format!("{rounded}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ticks_are_round() {
        let of = |axis, range| {
            let ticks = ColourScale::new(axis, range).unwrap().ticks();
            ticks.into_iter().map(short_number).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(of(Axis::Log, [0.01, 10.0]), "0.01 0.02 0.05 0.1 0.2 0.5 1 2 5 10");
        assert_eq!(of(Axis::Log, [3.0, 4e4]), "10 100 1000 10000");
        assert_eq!(of(Axis::Log, [1e-6, 1e6]), "1e-6 1e-4 0.01 1 100 10000 1e6");
        assert_eq!(of(Axis::Log, [2.5, 3.1]), "2.5 2.6 2.7 2.8 2.9 3 3.1");
        assert_eq!(of(Axis::Linear, [0.0, 1.0]), "0 0.2 0.4 0.6 0.8 1");
        assert_eq!(of(Axis::Linear, [-3.0, 1e5]), "0 20000 40000 60000 80000 1e5");
    }

    #[test]
    fn ranges_that_are_none_are_refused() {
        let (nan, inf) = (f64::NAN, f64::INFINITY);
        for range in [[1.0, 1.0], [2.0, 1.0], [nan, 1.0], [0.0, inf], [-f64::MAX, f64::MAX]] {
            assert!(ColourScale::new(Axis::Linear, range).is_err(), "{range:?}");
        }
        assert!(ColourScale::new(Axis::Log, [0.0, 1.0]).unwrap_err().contains("above 0"));
    }

    #[test]
    fn equal_values_and_none_have_scales_or_not() {
        assert_eq!(ColourScale::fitting(Axis::Log, [3.0; 5]).unwrap().range(), [1.5, 6.0]);
        assert_eq!(ColourScale::fitting(Axis::Linear, [0.0; 5]).unwrap().range(), [0.0, 1.0]);
        assert_eq!(ColourScale::fitting(Axis::Log, [0.0, -1.0, f64::NAN, f64::INFINITY]), None);
        assert_eq!(ColourScale::fitting(Axis::Linear, []), None);
        // A firefly does not decide, and the dark is cut at a factor of 1000.
        let values = (1..=999).map(|i| f64::from(i) * 1e-3).chain([1e9]).chain([1e-12; 50]);
        let [low, high] = ColourScale::fitting(Axis::Log, values).unwrap().range();
        assert!(high < 1.0 && (low - high / 1000.0).abs() < 1e-15, "{low} {high}");
    }

    #[test]
    fn what_is_not_finite_has_a_colour_of_its_own() {
        let scale = ColourScale::new(Axis::Log, [1.0, 10.0]).unwrap();
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(scale.colour(value), NOT_FINITE);
        }
        assert_eq!(scale.colour(-3.0), palette(0.0));
        assert_eq!(scale.colour(1e9), palette(1.0));
        assert!((0..=255).all(|i| palette(f64::from(i) / 255.0) != NOT_FINITE));
    }

    proptest! {
        #[test]
        fn any_range_has_some_ticks_within_it(low in 1e-30..1e30_f64, factor in 1.001..1e20_f64) {
            for axis in [Axis::Log, Axis::Linear] {
                let scale = ColourScale::new(axis, [low, low * factor]).unwrap();
                let ticks = scale.ticks();
                prop_assert!((2..=16).contains(&ticks.len()), "{:?} {:?}", scale, ticks);
                prop_assert!(ticks.iter().all(|t| (0.0..=1.0).contains(&scale.place(*t))));
                prop_assert!(ticks.windows(2).all(|t| t[0] < t[1]));
            }
        }
    }
}
