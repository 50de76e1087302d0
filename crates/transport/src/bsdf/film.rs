//! Thin films as paths meet them: a property of an interface, which says how much light goes each way and in which phase.
//!
//! A film has no extent. Light goes where it would go without one; only its amplitudes are those of the whole stack
//! ([`etalon_optics::fresnel::stack`]). The wave is as long as the film is thick many times over: no interference is lost to its coherence.

use etalon_optics::fresnel::{Layer, StackFresnel, stack, stack_leaving};
use etalon_optics::{Complex, Lanes};
use etalon_scene::ThinFilm;

/// A thin film prepared for paths.
#[derive(Clone, Debug)]
pub struct PathFilm {
    film: ThinFilm,
}

impl PathFilm {
    /// The film of a material, if it has one.
    pub fn of(film: Option<&ThinFilm>) -> Option<Self> {
        film.map(|film| Self { film: film.clone() })
    }

    /// Whether its thickness differs from place to place.
    pub(super) fn varies(&self) -> bool {
        self.film.images().next().is_some()
    }

    /// What the coated interface does at the cosine `cos` to light of a wavelength, nm, that comes from a medium of the index `incident`
    /// and meets the first layer first (`from_outside`) or last, at texture coordinates.
    pub(crate) fn fresnel(
        &self,
        wavelength_nm: f64,
        cos: f64,
        (incident, substrate): (f64, Complex),
        from_outside: bool,
        uv: [f64; 2],
    ) -> StackFresnel {
        let nm = self.film.at_nm.unwrap_or(wavelength_nm);
        stack(cos, nm, incident, self.layers(nm, from_outside, uv), substrate)
    }

    /// [`PathFilm::fresnel`] for light from a medium of the index `within`, where its cosine is `cos_within`, that leaves into vacuum at
    /// the cosine `cos`, through the last layer first.
    pub(super) fn fresnel_leaving(
        &self,
        wavelength_nm: f64,
        (cos_within, cos): (f64, f64),
        within: f64,
        uv: [f64; 2],
    ) -> StackFresnel {
        let nm = self.film.at_nm.unwrap_or(wavelength_nm);
        stack_leaving((cos_within, cos), nm, within, self.layers(nm, false, uv), 1.0)
    }

    /// The layers, the one that light meets last first.
    fn layers(&self, nm: f64, from_outside: bool, uv: [f64; 2]) -> impl Iterator<Item = Layer> {
        let layers = &self.film.layers;
        (0..layers.len()).map(move |i| {
            let layer = &layers[if from_outside { layers.len() - 1 - i } else { i }];
            Layer { index: layer.index.eval(nm), thickness_nm: layer.thickness_nm.eval(uv) }
        })
    }
}

/// The shares of unpolarised power that go either way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PowerShares {
    pub reflected: f64,
    pub transmitted: f64,
}

impl PowerShares {
    pub(super) fn of(fresnel: &StackFresnel) -> Self {
        Self { reflected: fresnel.reflection.power(), transmitted: fresnel.transmission.power() }
    }

    /// The probability of reflection where one of the two must be chosen; 1 where nothing is transmitted.
    pub(super) fn reflection_probability(&self) -> f64 {
        let both = self.reflected + self.transmitted;
        if both > 0.0 { self.reflected / both } else { 1.0 }
    }

    /// The probability of transmission.
    pub(super) fn transmission_probability(&self) -> f64 {
        let both = self.reflected + self.transmitted;
        if both > 0.0 { self.transmitted / both } else { 0.0 }
    }
}

/// Of a choice between the two that the hero makes: the weights of the lanes, and each lane's own probability of it over the hero's.
pub(super) fn chosen<const N: usize>(shares: &[PowerShares; N], reflects: bool) -> (Lanes<f64, N>, Lanes<f64, N>) {
    let probability = |shares: &PowerShares| {
        if reflects { shares.reflection_probability() } else { shares.transmission_probability() }
    };
    let hero = probability(&shares[0]);
    let weight = |lane: usize| if reflects { shares[lane].reflected } else { shares[lane].transmitted };
    (Lanes::from_fn(|lane| weight(lane) / hero), Lanes::from_fn(|lane| probability(&shares[lane]) / hero))
}
