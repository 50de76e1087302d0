//! Light that a surface takes in at one wavelength and gives back at another.
//!
//! The **reradiation** Φ(λᵢ, λₒ), nm⁻¹, is the power that leaves at λₒ, for each nanometre there, of one unit of power that came in at λᵢ
//! (Donaldson 1954, *Spectrophotometry of fluorescent pigments*). What stays at its wavelength is no part of it: that is a reflectance.

use crate::error::{OpticsError, increasing, non_negative};
use crate::spectrum::{Spectrum, simpson};
use crate::table::{lerp, locate};

/// What fluoresces at a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Fluorescence {
    /// Dyes, each of which emits the same spectrum however it was excited.
    Fluorophores(Vec<Fluorophore>),
    /// A measured reradiation.
    Matrix(ReradiationMatrix),
}

/// A dye: Φ(λᵢ, λₒ) = Q a(λᵢ) λᵢ e(λₒ) / ∫ e λ dλ.
///
/// It absorbs the share a(λᵢ) of the light, and Q photons leave for each that it absorbs. A photon's energy goes as 1/λ. So e(λₒ) λₒ / ∫ e λ dλ
/// is the density of photons over wavelengths, and each has λᵢ/λₒ of the energy of the photon that it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Fluorophore {
    absorption: Spectrum,
    emission: Spectrum,
    quantum_yield: f64,
    /// The wavelengths between which it emits, nm.
    extent_nm: [f64; 2],
    /// Q / ∫ e λ dλ.
    scale: f64,
}

/// Φ at wavelengths of excitation and emission, bilinear between them and zero outside.
#[derive(Clone, Debug, PartialEq)]
pub struct ReradiationMatrix {
    excitation_nm: Vec<f64>,
    emission_nm: Vec<f64>,
    /// nm⁻¹; of each excitation, one after the other, at all wavelengths of emission.
    per_nm: Vec<f64>,
}

impl Fluorophore {
    /// `absorption` is a share in [0, 1]. `emission` is relative power for each nanometre: only its shape counts, over its own wavelengths if
    /// it is a table that is zero outside, else over `range_nm`. `quantum_yield` is in [0, 1].
    ///
    /// Fails if the emission is zero, or the quantum yield is no share.
    pub fn new(
        absorption: Spectrum,
        emission: Spectrum,
        quantum_yield: f64,
        range_nm: [f64; 2],
    ) -> Result<Self, OpticsError> {
        let what = "a quantum yield";
        if non_negative(what, quantum_yield)? > 1.0 {
            return Err(OpticsError::AboveOne { what, value: quantum_yield });
        }
        let extent_nm = emission.support_nm().unwrap_or(range_nm);
        let photons: f64 = simpson(emission.borders_nm(extent_nm))
            .into_iter()
            .map(|(nm, weight)| weight * emission.eval(nm) * nm)
            .sum();
        if photons <= 0.0 {
            return Err(OpticsError::NotPositive { what: "the emission of a fluorophore", value: photons });
        }
        Ok(Self { absorption, emission, quantum_yield, extent_nm, scale: quantum_yield / photons })
    }

    /// The share of light that it absorbs.
    pub fn absorption(&self) -> &Spectrum {
        &self.absorption
    }

    /// What it emits, in any unit.
    pub fn emission(&self) -> &Spectrum {
        &self.emission
    }

    /// Photons that leave for each that is absorbed.
    pub fn quantum_yield(&self) -> f64 {
        self.quantum_yield
    }

    /// What absorption · λᵢ · emission is multiplied by to give Φ.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// ∫ e dλ over the part of a range in which it emits.
    fn emitted(&self, [first, last]: [f64; 2]) -> f64 {
        let [from, to] = self.extent_nm;
        let range_nm = [first.max(from), last.min(to)];
        if range_nm[0] >= range_nm[1] {
            return 0.0;
        }
        let nodes = simpson(self.emission.borders_nm(range_nm));
        nodes.into_iter().map(|(nm, weight)| weight * self.emission.eval(nm)).sum()
    }
}

impl ReradiationMatrix {
    /// At least two wavelengths of excitation and of emission, nm, increasing, and for each of the former a row of Φ, nm⁻¹, finite and not
    /// negative, at all of the latter.
    ///
    /// Fails if anything of that does not hold.
    pub fn new(excitation_nm: Vec<f64>, emission_nm: Vec<f64>, rows: &[Vec<f64>]) -> Result<Self, OpticsError> {
        const WHAT: &str = "a reradiation matrix";
        increasing(WHAT, &excitation_nm, &[rows.len()])?;
        for row in rows {
            increasing(WHAT, &emission_nm, &[row.len()])?;
            for &value in row {
                non_negative("a value of a reradiation matrix", value)?;
            }
        }
        Ok(Self { excitation_nm, emission_nm, per_nm: rows.concat() })
    }

    /// The wavelengths of excitation, nm.
    pub fn excitation_nm(&self) -> &[f64] {
        &self.excitation_nm
    }

    /// ∫ Φ dλₒ over a range, for each wavelength of excitation.
    fn returned(&self, [first, last]: [f64; 2]) -> Vec<f64> {
        let emission_nm = &self.emission_nm;
        let range_nm = [first.max(emission_nm[0]), last.min(emission_nm[emission_nm.len() - 1])];
        if range_nm[0] >= range_nm[1] {
            return vec![0.0; self.excitation_nm.len()];
        }
        let within = emission_nm.iter().copied().filter(|nm| (range_nm[0]..=range_nm[1]).contains(nm));
        let nodes = simpson(range_nm.into_iter().chain(within));
        let row = |nm: &f64| nodes.iter().map(|(emission, weight)| weight * self.eval(*nm, *emission)).sum();
        self.excitation_nm.iter().map(row).collect()
    }

    /// Φ, nm⁻¹.
    #[inline]
    pub fn eval(&self, excitation_nm: f64, emission_nm: f64) -> f64 {
        let (Some((i, s)), Some((j, t))) =
            (locate(&self.excitation_nm, excitation_nm), locate(&self.emission_nm, emission_nm))
        else {
            return 0.0;
        };
        let columns = self.emission_nm.len();
        let row = |i: usize| lerp(self.per_nm[i * columns + j], self.per_nm[i * columns + j + 1], t);
        lerp(row(i), row(i + 1), s)
    }
}

impl Fluorescence {
    /// Φ(λᵢ, λₒ), nm⁻¹.
    pub fn eval(&self, excitation_nm: f64, emission_nm: f64) -> f64 {
        match self {
            Self::Matrix(matrix) => matrix.eval(excitation_nm, emission_nm),
            Self::Fluorophores(all) => {
                let of = |dye: &Fluorophore| {
                    dye.scale * dye.absorption.eval(excitation_nm) * excitation_nm * dye.emission.eval(emission_nm)
                };
                all.iter().map(of).sum()
            }
        }
    }

    /// The share of power that comes back, ∫ Φ dλₒ over a range, of light of each of these wavelengths, nm.
    pub fn returned(&self, excitations_nm: &[f64], range_nm: [f64; 2]) -> Vec<f64> {
        let mut returned = vec![0.0; excitations_nm.len()];
        match self {
            Self::Matrix(matrix) => {
                let of_rows = matrix.returned(range_nm);
                for (sum, nm) in returned.iter_mut().zip(excitations_nm) {
                    if let Some((row, t)) = locate(&matrix.excitation_nm, *nm) {
                        *sum = lerp(of_rows[row], of_rows[row + 1], t);
                    }
                }
            }
            Self::Fluorophores(all) => {
                for dye in all {
                    let emitted = dye.scale * dye.emitted(range_nm);
                    for (sum, nm) in returned.iter_mut().zip(excitations_nm) {
                        *sum += emitted * dye.absorption.eval(*nm) * nm;
                    }
                }
            }
        }
        returned
    }

    /// The wavelengths within a range at which what comes back may have a kink or a jump as a function of the excitation, nm.
    pub fn kinks_nm(&self, range_nm: [f64; 2]) -> Vec<f64> {
        match self {
            Self::Matrix(matrix) => {
                let within = |nm: &f64| (range_nm[0]..=range_nm[1]).contains(nm);
                matrix.excitation_nm.iter().copied().filter(within).collect()
            }
            Self::Fluorophores(all) => all.iter().flat_map(|dye| dye.absorption.kinks_nm(range_nm)).collect(),
        }
    }

    /// The wavelengths between which it emits anything, nm.
    pub fn emission_range_nm(&self) -> [f64; 2] {
        let extents: Vec<[f64; 2]> = match self {
            Self::Matrix(matrix) => vec![[matrix.emission_nm[0], matrix.emission_nm[matrix.emission_nm.len() - 1]]],
            Self::Fluorophores(all) => all.iter().map(|dye| dye.extent_nm).collect(),
        };
        extents.into_iter().fold([f64::INFINITY, 0.0], |[a, b], [first, last]| [a.min(first), b.max(last)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Outside;
    use proptest::prelude::*;

    fn band(from: f64, to: f64) -> Spectrum {
        Spectrum::tabulated(vec![from, to], vec![1.0; 2], Outside::Zero).unwrap()
    }

    /// A photon at 400 nm that leaves between 500 and 600 nm: the mean of 1/λ over photons spread as e λ.
    #[test]
    fn a_dye_of_yield_one_hands_on_every_photon_and_loses_their_difference_in_energy() {
        let dye = Fluorophore::new(band(390.0, 410.0), band(500.0, 600.0), 1.0, [360.0, 830.0]).unwrap();
        let all = Fluorescence::Fluorophores(vec![dye]);
        // ∫ dλ / ∫ λ dλ from 500 to 600 is 1/550.
        let [returned] = all.returned(&[400.0], [360.0, 830.0])[..] else { panic!("one wavelength, one share") };
        assert!((returned - 400.0 / 550.0).abs() < 1e-12, "{returned}");
        // Photons: power over energy, which goes as λ.
        let photons: f64 = simpson([500.0, 600.0]).iter().map(|(nm, w)| w * all.eval(400.0, *nm) * nm / 400.0).sum();
        assert!((photons - 1.0).abs() < 1e-9, "{photons}");
        assert_eq!(all.emission_range_nm(), [500.0, 600.0]);
    }

    #[test]
    fn what_is_no_dye_and_no_matrix_is_refused() {
        let range = [360.0, 830.0];
        let dye = |emission, yields| Fluorophore::new(Spectrum::ONE, emission, yields, range);
        assert!(matches!(dye(Spectrum::ZERO, 1.0), Err(OpticsError::NotPositive { .. })));
        assert!(matches!(dye(Spectrum::ONE, 1.5), Err(OpticsError::AboveOne { .. })));
        assert!(dye(Spectrum::ONE, f64::NAN).is_err());
        let matrix = |rows: &[Vec<f64>]| ReradiationMatrix::new(vec![400.0, 500.0], vec![500.0, 600.0], rows);
        assert!(matrix(&[vec![0.0, 1.0], vec![1.0, 0.0]]).is_ok());
        assert!(matrix(&[vec![0.0, 1.0]]).is_err() && matrix(&[vec![0.0; 3], vec![0.0; 3]]).is_err());
        assert!(matrix(&[vec![0.0, -1.0], vec![1.0, 0.0]]).is_err());
    }

    proptest! {
        /// A matrix of products is the dye that it was made of, at its nodes and between them; what comes back is the integral of each.
        #[test]
        fn a_matrix_of_a_dye_is_that_dye(yields in 0.1..1.0, excitation in 401.0..479.0, emission in 501.0..699.0) {
            let a = Spectrum::tabulated(vec![400.0, 440.0, 480.0], vec![0.2, 0.9, 0.1], Outside::Zero).unwrap();
            let e = Spectrum::tabulated(vec![500.0, 530.0, 700.0], vec![0.0, 3.0, 1.0], Outside::Zero).unwrap();
            let dye = Fluorophore::new(a, e, yields, [360.0, 830.0]).unwrap();
            let dye = Fluorescence::Fluorophores(vec![dye]);
            // The factor λᵢ bends its rows: so many that between them there is nothing to see.
            let excitation_nm: Vec<f64> = (0..=320).map(|i| 400.0 + 0.25 * f64::from(i)).collect();
            let emission_nm = vec![500.0, 530.0, 700.0];
            // From within: at its ends it jumps.
            let within = |nm: f64, [from, to]: [f64; 2]| nm.clamp(f64::next_up(from), f64::next_down(to));
            let row = |i: &f64| emission_nm.iter().map(|o| dye.eval(within(*i, [400.0, 480.0]), within(*o, [500.0, 700.0]))).collect();
            let rows: Vec<Vec<f64>> = excitation_nm.iter().map(row).collect();
            let matrix = Fluorescence::Matrix(ReradiationMatrix::new(excitation_nm, emission_nm, &rows).unwrap());
            let (of_dye, of_matrix) = (dye.eval(excitation, emission), matrix.eval(excitation, emission));
            prop_assert!((of_dye - of_matrix).abs() <= 1e-5 * of_dye, "{of_dye} {of_matrix}");
            let range = [520.0, 640.5];
            let (of_dye, of_matrix) = (dye.returned(&[excitation], range)[0], matrix.returned(&[excitation], range)[0]);
            prop_assert!((of_dye - of_matrix).abs() <= 1e-5 * of_dye, "{of_dye} {of_matrix}");
        }
    }
}
