//! Multiple importance sampling.

/// A sampling density, which keeps what can and what cannot be hit by chance apart, so that MIS cannot mix them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Per unit solid angle, sr⁻¹.
    SolidAngle(f64),
    /// A direction that only this technique can produce.
    Delta,
}

/// How shadow rays are weighed against the walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heuristic {
    /// [`power_heuristic`], of lamps.
    Power,
    /// [`balance_heuristic`], of skies: their densities are made for it.
    Balance,
}

impl Heuristic {
    /// Of light from infinity or of a lamp.
    #[inline(always)]
    pub fn of(from_infinity: bool) -> Self {
        if from_infinity { Self::Balance } else { Self::Power }
    }

    /// The weight of the technique of density `own` against one of density `other`.
    #[inline(always)]
    pub fn weight(self, own: f64, other: f64) -> f64 {
        match self {
            Self::Power => power_heuristic(own, other),
            Self::Balance => balance_heuristic(own, other),
        }
    }
}

/// The balance heuristic (Veach 1997, §9.2.2) for the technique of density `own` against one of density `other`.
#[inline]
pub fn balance_heuristic(own: f64, other: f64) -> f64 {
    1.0 / (1.0 + other / own)
}

/// The power heuristic (Veach 1997, §9.2.4, β = 2) for the technique of density `own` against one of density `other`,
/// in the form 1/(1 + (other/own)²): it neither overflows nor becomes ∞/∞ where the squares would.
#[inline]
pub fn power_heuristic(own: f64, other: f64) -> f64 {
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn weights_survive_densities_whose_squares_overflow() {
        // Hard case 32.
        for scale in [1e20, 1e200] {
            assert!((power_heuristic(3.0 * scale, 2.0 * scale) - 9.0 / 13.0).abs() <= 4.0 * f64::EPSILON);
        }
        assert_eq!(power_heuristic(1.0, 0.0), 1.0);
        assert_eq!(power_heuristic(1e-200, 1e200), 0.0);
    }

    proptest! {
        #[test]
        fn weights_of_both_techniques_sum_to_one(a in -80.0..80.0_f64, b in -80.0..80.0_f64) {
            let (a, b) = (10f64.powf(a), 10f64.powf(b));
            for heuristic in [Heuristic::Power, Heuristic::Balance] {
                // Three roundings in each weight.
                let sum = heuristic.weight(a, b) + heuristic.weight(b, a);
                prop_assert!((sum - 1.0).abs() <= 6.0 * f64::EPSILON, "{heuristic:?}");
            }
        }
    }
}
