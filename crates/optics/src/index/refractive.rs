//! Dispersion formulas of transparent media.

use super::glasses::GLASSES;
use super::{Fit, OutsideFit, check_order, same_name};
use crate::error::{OpticsError, finite, index, non_negative};

/// Fraunhofer lines d (He), F and C (H), nm: the Abbe number is (n_d − 1)/(n_F − n_C).
const LINE_D_NM: f64 = 587.5618;
const LINE_F_NM: f64 = 486.1327;
const LINE_C_NM: f64 = 656.2725;

/// The wavelength, nm, that stands for a range of wavelengths: the helium line d, at which catalogues state indices, or what is nearest to it.
pub fn reference_nm([first, last]: [f64; 2]) -> f64 {
    LINE_D_NM.clamp(first, last)
}

/// Refractive index of a transparent medium, relative to vacuum.
#[derive(Clone, Debug, PartialEq)]
pub enum RefractiveIndex {
    /// The same at every wavelength; [`RefractiveIndex::constant`] checks that it is finite and above 0.
    Constant(f64),
    /// Sellmeier's formula.
    Sellmeier(Sellmeier),
    /// Cauchy's formula.
    Cauchy(Cauchy),
}

/// One resonance B·λ²/(λ² − C) of Sellmeier's formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SellmeierTerm {
    /// Strength, dimensionless.
    pub b: f64,
    /// Square of the resonance's wavelength, µm².
    pub c_um2: f64,
}

/// n² = 1 + Σ B·λ²/(λ² − C), λ in µm (W. Sellmeier 1871), with the range it was fitted for.
#[derive(Clone, Debug, PartialEq)]
pub struct Sellmeier {
    name: Option<&'static str>,
    terms: Vec<SellmeierTerm>,
    fit: Option<Fit>,
}

/// n = A + B/λ² + C/λ⁴, λ in µm (A.-L. Cauchy 1837), with the range it was fitted for.
#[derive(Clone, Debug, PartialEq)]
pub struct Cauchy {
    a: f64,
    b_um2: f64,
    c_um4: f64,
    fit: Option<Fit>,
}

impl Sellmeier {
    /// The resonances.
    pub fn terms(&self) -> &[SellmeierTerm] {
        &self.terms
    }

    #[inline]
    fn squared(&self, wavelength_nm: f64) -> f64 {
        let um2 = square(wavelength_nm * 1e-3);
        self.terms.iter().fold(1.0, |sum, term| sum + term.b * um2 / (um2 - term.c_um2))
    }
}

#[inline(always)]
fn square(x: f64) -> f64 {
    x * x
}

impl RefractiveIndex {
    /// Vacuum: 1.
    pub const VACUUM: Self = Self::Constant(1.0);

    /// The same at every wavelength.
    ///
    /// Fails if the index is not within [`INDEX_RANGE`](crate::INDEX_RANGE).
    pub fn constant(n: f64) -> Result<Self, OpticsError> {
        index("an index of refraction", n).map(Self::Constant)
    }

    /// Sellmeier's formula with any number of terms, and the range of its fit in nm if that is known.
    ///
    /// Fails without a term, for a coefficient that is not finite, for a negative C, for an empty range, and for a formula
    /// without a positive real index somewhere in its range.
    pub fn sellmeier(terms: Vec<SellmeierTerm>, fit_range_nm: Option<[f64; 2]>) -> Result<Self, OpticsError> {
        if terms.is_empty() {
            return Err(OpticsError::TooShort { what: "Sellmeier's formula", needed: 1, found: 0 });
        }
        for term in &terms {
            finite("a Sellmeier coefficient B", term.b)?;
            non_negative("a Sellmeier coefficient C (µm²)", term.c_um2)?;
        }
        let fit = fit_range_nm.map(Fit::new).transpose()?;
        Self::Sellmeier(Sellmeier { name: None, terms, fit }).checked_over_its_fit()
    }

    /// Cauchy's formula n = A + B/λ² + C/λ⁴ (λ in µm), and the range of its fit in nm if that is known.
    ///
    /// Fails for a coefficient that is not finite, for an empty range, and for a formula without a positive index somewhere
    /// in its range.
    pub fn cauchy(a: f64, b_um2: f64, c_um4: f64, fit_range_nm: Option<[f64; 2]>) -> Result<Self, OpticsError> {
        finite("the Cauchy coefficient A", a)?;
        finite("the Cauchy coefficient B (µm²)", b_um2)?;
        finite("the Cauchy coefficient C (µm⁴)", c_um4)?;
        let fit = fit_range_nm.map(Fit::new).transpose()?;
        Self::Cauchy(Cauchy { a, b_um2, c_um4, fit }).checked_over_its_fit()
    }

    /// A medium by its name, see [`RefractiveIndex::names`]; case does not matter, a space or underscore is a hyphen.
    pub fn named(name: &str) -> Option<Self> {
        let glass = GLASSES.iter().find(|glass| same_name(glass.name, name))?;
        let terms = glass.terms.iter().map(|&(b, c_um2)| SellmeierTerm { b, c_um2 }).collect();
        let fit = Fit { range_nm: glass.range_nm, outside: OutsideFit::Error };
        Some(Self::Sellmeier(Sellmeier { name: Some(glass.name), terms, fit: Some(fit) }))
    }

    /// The names that [`RefractiveIndex::named`] knows.
    pub fn names() -> impl Iterator<Item = &'static str> {
        GLASSES.iter().map(|glass| glass.name)
    }

    /// The same medium with another rule for wavelengths outside its fit.
    pub fn with_outside(mut self, outside: OutsideFit) -> Self {
        match &mut self {
            Self::Constant(_) => {}
            Self::Sellmeier(Sellmeier { fit, .. }) | Self::Cauchy(Cauchy { fit, .. }) => {
                if let Some(fit) = fit {
                    fit.outside = outside;
                }
            }
        }
        self
    }

    fn fit(&self) -> Option<&Fit> {
        match self {
            Self::Constant(_) => None,
            Self::Sellmeier(s) => s.fit.as_ref(),
            Self::Cauchy(c) => c.fit.as_ref(),
        }
    }

    /// The range of the fit, nm, if there is one and it is known.
    pub fn range_nm(&self) -> Option<[f64; 2]> {
        self.fit().map(|fit| fit.range_nm)
    }

    /// What holds outside [`RefractiveIndex::range_nm`].
    pub fn outside(&self) -> OutsideFit {
        self.fit().map_or(OutsideFit::Error, |fit| fit.outside)
    }

    /// Index at a wavelength in nm (in vacuum, above 0).
    ///
    /// NaN outside the fit under [`OutsideFit::Error`]; [`RefractiveIndex::check_range`] tells beforehand.
    #[inline]
    pub fn eval(&self, wavelength_nm: f64) -> f64 {
        let nm = self.fit().map_or(wavelength_nm, |fit| fit.admit(wavelength_nm));
        match self {
            Self::Constant(n) => *n,
            Self::Sellmeier(s) => s.squared(nm).sqrt(),
            Self::Cauchy(c) => {
                let w = 1.0 / square(nm * 1e-3);
                c.a + w * (c.b_um2 + w * c.c_um4)
            }
        }
    }

    /// Whether the index depends on the wavelength.
    pub fn is_dispersive(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Sellmeier(s) => s.terms.iter().any(|term| term.b != 0.0 && term.c_um2 != 0.0),
            Self::Cauchy(c) => c.b_um2 != 0.0 || c.c_um4 != 0.0,
        }
    }

    /// The Abbe number (n_d − 1)/(n_F − n_C); infinite without dispersion, NaN if the fit does not cover the three lines.
    pub fn abbe_number(&self) -> f64 {
        (self.eval(LINE_D_NM) - 1.0) / (self.eval(LINE_F_NM) - self.eval(LINE_C_NM))
    }

    /// Checks that the index is known, positive and real all over a closed range in nm.
    ///
    /// Fails with [`OpticsError::OutsideFit`] where the fit does not cover the range and does not clamp, and with
    /// [`OpticsError::NoRealIndex`] at a resonance or where n² is not positive (tested every nanometre).
    pub fn check_range(&self, range_nm: [f64; 2]) -> Result<(), OpticsError> {
        check_order(range_nm)?;
        if let Some(fit) = self.fit() {
            let name = || match self {
                Self::Sellmeier(Sellmeier { name: Some(name), .. }) => (*name).to_owned(),
                _ => "this index of refraction".to_owned(),
            };
            fit.check(name, range_nm)?;
        }
        let clamp = |nm: f64| self.fit().map_or(nm, |fit| nm.clamp(fit.range_nm[0], fit.range_nm[1]));
        let [first, last] = range_nm.map(clamp);
        if let Self::Sellmeier(s) = self {
            let resonances = s.terms.iter().filter(|term| term.b != 0.0).map(|term| 1e3 * term.c_um2.sqrt());
            if let Some(wavelength_nm) = resonances.into_iter().find(|nm| (first..=last).contains(nm)) {
                return Err(OpticsError::NoRealIndex { wavelength_nm });
            }
        }
        let steps = (last - first).ceil().max(1.0);
        for i in 0..=steps as u32 {
            let wavelength_nm = first + (last - first) * (f64::from(i) / steps);
            let n = self.eval(wavelength_nm);
            // Also false for NaN, the root of a negative n².
            if !(n > 0.0 && n.is_finite()) {
                return Err(OpticsError::NoRealIndex { wavelength_nm });
            }
            index("an index of refraction", n)?;
        }
        Ok(())
    }

    fn checked_over_its_fit(self) -> Result<Self, OpticsError> {
        if let Some(range_nm) = self.range_nm() {
            self.check_range(range_nm)?;
        }
        Ok(self)
    }
}
