//! The index of a metal, prepared for paths.

use crate::spectral::PathSpectrum;
use crate::texture::{PathTexture, TexturePoint};
use etalon_optics::{ComplexIndex, Lanes};
use etalon_scene::Metal;

/// n + ik of a metal relative to vacuum, perhaps another one at each place.
#[derive(Clone, Debug)]
pub enum PathMetal {
    /// The same everywhere.
    Index(ComplexIndex),
    /// 1 + ik of which such a share of light is reflected head-on ([`Metal::k_of`]).
    Reflectance(PathTexture),
}

impl PathMetal {
    /// Prepares a metal for wavelengths within `range_nm`.
    pub fn new(metal: &Metal, range_nm: [f64; 2]) -> Self {
        match metal {
            Metal::Index(index) => Self::Index(index.clone()),
            Metal::Reflectance(reflectance) => Self::Reflectance(PathTexture::new(reflectance, range_nm)),
        }
    }

    /// n and k in every lane at a place.
    #[inline]
    pub(super) fn lanes<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, place: TexturePoint) -> [(f64, f64); N] {
        match self {
            Self::Index(index) => lambda_nm.0.map(|nm| index.eval(nm)),
            Self::Reflectance(reflectance) => reflectance.lanes::<N>(lambda_nm, place).0.map(|r| (1.0, Metal::k_of(r))),
        }
    }
}

impl From<ComplexIndex> for PathMetal {
    fn from(index: ComplexIndex) -> Self {
        Self::Index(index)
    }
}

/// A smooth function of a metal's index, tabulated as the metal is.
#[derive(Clone, Debug)]
pub(super) enum OfMetal {
    /// At each wavelength.
    Spectrum(PathSpectrum),
    /// Values at equal steps of √R from 0 to 1, and how much larger the next is.
    Root(Vec<[f64; 2]>),
}

/// Steps of √R.
const STEPS: usize = 256;

impl OfMetal {
    pub(super) fn new(metal: &PathMetal, range_nm: [f64; 2], function: impl Fn(f64, f64) -> f64) -> Self {
        match metal {
            PathMetal::Index(index) => Self::Spectrum(PathSpectrum::tabulate(range_nm, |nm| {
                let (n, k) = index.eval(nm);
                function(n, k)
            })),
            PathMetal::Reflectance(_) => {
                let at = |i: usize| {
                    let root = i as f64 / STEPS as f64;
                    function(1.0, Metal::k_of(root * root))
                };
                Self::Root((0..STEPS).map(|i| [at(i), at(i + 1) - at(i)]).collect())
            }
        }
    }

    /// Of a function of the wavelength, nm, and the index there; `None` of a metal that may be another one at each place.
    pub(super) fn by_wavelength(
        metal: &PathMetal,
        range_nm: [f64; 2],
        function: impl Fn(f64, f64, f64) -> f64,
    ) -> Option<Self> {
        let index = |nm: f64| match metal {
            PathMetal::Index(index) => Some(index.eval(nm)),
            PathMetal::Reflectance(PathTexture::Uniform(spectrum)) => Some((1.0, Metal::k_of(spectrum.eval(nm)))),
            PathMetal::Reflectance(PathTexture::Image { .. } | PathTexture::VertexColours { .. }) => None,
        };
        index(range_nm[0])?;
        Some(Self::Spectrum(PathSpectrum::tabulate(range_nm, |nm| {
            let (n, k) = index(nm).unwrap_or((1.0, 0.0));
            function(nm, n, k)
        })))
    }

    /// The value for a metal of n + ik at a wavelength, nm.
    #[inline]
    pub(super) fn eval(&self, wavelength_nm: f64, k: f64) -> f64 {
        match self {
            Self::Spectrum(spectrum) => spectrum.eval(wavelength_nm),
            Self::Root(steps) => {
                let x = k / (4.0 + k * k).sqrt() * STEPS as f64;
                let i = (x as usize).min(STEPS - 1);
                let [value, step] = steps[i];
                value + (x - i as f64) * step
            }
        }
    }
}
