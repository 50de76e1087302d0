//! Smooth interface between two transparent media: the Fresnel equations choose between reflection and refraction.
//!
//! Where the index depends on wavelength, the hero alone keeps the refracted direction: another lane's light would have
//! gone elsewhere. Reflection is shared by all lanes, each with its own probability of having chosen it, which the
//! balance heuristic over lanes needs (Wilkie et al. 2014, eq. 5). A thin film gives each lane such a probability, too.

use super::film::{PathFilm, PowerShares, chosen};
use super::{BsdfSample, Properties};
use crate::media::Interface;
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
use etalon_optics::fresnel::StackFresnel;
use etalon_optics::{Complex, Lanes, RefractiveIndex, Vec3, fresnel, snell};

/// Smooth interface of two transparent media.
#[derive(Clone, Debug)]
pub struct Dielectric {
    interior: RefractiveIndex,
    exterior: RefractiveIndex,
    dispersive: bool,
    film: Option<Box<PathFilm>>,
}

impl Dielectric {
    /// An interface with `interior` behind the outward normal and `exterior` before it, and perhaps a film between them.
    pub fn new(interior: RefractiveIndex, exterior: RefractiveIndex, film: Option<PathFilm>) -> Self {
        let dispersive = interior.is_dispersive() || exterior.is_dispersive();
        Self { interior, exterior, dispersive, film: film.map(Box::new) }
    }

    /// Whether it is coated.
    pub(crate) fn is_coated(&self) -> bool {
        self.film.is_some()
    }

    /// See [`Properties`]. It states its own media, unless it bounds a solid with a priority.
    pub(super) fn properties() -> Properties {
        Properties::pane("a smooth interface of two media")
    }

    /// The indices behind and before the outward normal, if they are the same at every wavelength; and otherwise `None`.
    pub(crate) fn constant_indices(&self) -> Option<[f64; 2]> {
        match (&self.interior, &self.exterior) {
            (RefractiveIndex::Constant(interior), RefractiveIndex::Constant(exterior)) => Some([*interior, *exterior]),
            _ => None,
        }
    }

    /// The indices behind and before the outward normal at a wavelength.
    pub(crate) fn indices(&self, wavelength_nm: f64) -> [f64; 2] {
        [self.interior.eval(wavelength_nm), self.exterior.eval(wavelength_nm)]
    }

    fn relative<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        (cos, from_outside, interface): (f64, bool, Option<Interface<'_>>),
        reflectance: f64,
    ) -> Lanes<f64, N> {
        Lanes::from_fn(|lane| match lane {
            0 => 1.0,
            _ => {
                let eta = self.eta(lambda_nm[lane], from_outside, interface);
                fresnel::dielectric_reflectance(cos, eta).0 / reflectance
            }
        })
    }

    /// n_transmitted / n_incident for a path that arrives on the outside, or on the inside.
    fn eta(&self, lambda_nm: f64, from_outside: bool, interface: Option<Interface<'_>>) -> f64 {
        if let Some(media) = interface {
            return media.transmitted.eval(lambda_nm) / media.incident.eval(lambda_nm);
        }
        let (inside, outside) = (self.interior.eval(lambda_nm), self.exterior.eval(lambda_nm));
        if from_outside { inside / outside } else { outside / inside }
    }

    /// The indices on the side that a path arrives on and on the other.
    fn sides(&self, lambda_nm: f64, from_outside: bool, interface: Option<Interface<'_>>) -> [f64; 2] {
        if let Some(media) = interface {
            return [media.incident.eval(lambda_nm), media.transmitted.eval(lambda_nm)];
        }
        let (inside, outside) = (self.interior.eval(lambda_nm), self.exterior.eval(lambda_nm));
        if from_outside { [outside, inside] } else { [inside, outside] }
    }

    /// What it does with its film at the cosine `cos`, for a path that arrives on the outward side of the normal or not.
    fn coated(
        &self,
        film: &PathFilm,
        (wavelength_nm, cos, uv): (f64, f64, [f64; 2]),
        above: bool,
        interface: Option<Interface<'_>>,
    ) -> StackFresnel {
        let [incident, transmitted] = self.sides(wavelength_nm, above, interface);
        // Among solids the normal may be another's whose boundary coincides with this one's; the media tell.
        let from_outside = match interface {
            Some(media) if media.incident != media.transmitted => *media.transmitted == self.interior,
            _ => above,
        };
        film.fresnel(wavelength_nm, cos, (incident, Complex::real(transmitted)), from_outside, uv)
    }

    /// What the interface does to polarised light that it turns at the cosine `cos`: seen from outside or not, reflected or not.
    pub(super) fn mueller(
        &self,
        wavelength_nm: f64,
        (cos, uv): (f64, [f64; 2]),
        (from_outside, reflects): (bool, bool),
        interface: Option<Interface<'_>>,
    ) -> Matrix {
        if let Some(film) = &self.film {
            let fresnel = self.coated(film, (wavelength_nm, cos, uv), from_outside, interface);
            return mueller::of_waves(if reflects { &fresnel.reflection } else { &fresnel.transmission });
        }
        let eta = self.eta(wavelength_nm, from_outside, interface);
        match fresnel::refracted_cosine(cos, eta) {
            Some(cos_t) if !reflects => mueller::dielectric_transmission(cos, eta, cos_t),
            _ => mueller::dielectric_reflection(cos, eta),
        }
    }

    /// The probability of reflection at a wavelength.
    pub(super) fn reflection_probability(
        &self,
        wavelength_nm: f64,
        (n, uv): (Vec3<f64>, [f64; 2]),
        wo: Vec3<f64>,
        interface: Option<Interface<'_>>,
    ) -> f64 {
        let above = n.dot(wo) > 0.0;
        let cos = n.dot(wo).abs().min(1.0);
        match &self.film {
            Some(film) => {
                PowerShares::of(&self.coated(film, (wavelength_nm, cos, uv), above, interface)).reflection_probability()
            }
            None => fresnel::dielectric_reflectance(cos, self.eta(wavelength_nm, above, interface)).0,
        }
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        (n, uv): (Vec3<f64>, [f64; 2]),
        wo: Vec3<f64>,
        u: f64,
        interface: Option<Interface<'_>>,
    ) -> Option<BsdfSample<N>> {
        if let Some(film) = &self.film {
            return self.sample_coated(film, lambda_nm, (n, uv), wo, u, interface);
        }
        let from_outside = n.dot(wo) > 0.0;
        let eta = self.eta(lambda_nm[0], from_outside, interface);
        Some(self.turned(lambda_nm, &turn(n, wo, eta, u), (eta, from_outside), interface))
    }

    /// A direction where there is a film: the shares of light decide, of which it may absorb the rest.
    fn sample_coated<const N: usize>(
        &self,
        film: &PathFilm,
        lambda_nm: &Lanes<f64, N>,
        (n, uv): (Vec3<f64>, [f64; 2]),
        wo: Vec3<f64>,
        u: f64,
        interface: Option<Interface<'_>>,
    ) -> Option<BsdfSample<N>> {
        let above = n.dot(wo) > 0.0;
        let n = if above { n } else { -n };
        // Rounding may carry the product of two unit vectors past 1.
        let cos = n.dot(wo).min(1.0);
        let shares = lambda_nm.0.map(|nm| PowerShares::of(&self.coated(film, (nm, cos, uv), above, interface)));
        let reflects = u < shares[0].reflection_probability();
        let (weight, lane_density) = chosen(&shares, reflects);
        if reflects {
            let wi = wo.reflected_about(n).renormalized();
            return Some(BsdfSample { wi, weight, density: Density::Delta, lane_density, eta: 1.0 });
        }
        let eta = self.eta(lambda_nm[0], above, interface);
        let wi = snell::refract_with_cosines(wo, n, eta, cos, fresnel::refracted_cosine(cos, eta)?);
        let (weight, lane_density) = match self.is_dispersive(interface) {
            false => (weight, lane_density),
            true => (weight.hero_only(), lane_density.hero_only()),
        };
        // As without a film.
        let weight = weight / (eta * eta);
        Some(BsdfSample { wi, weight, density: Density::Delta, lane_density, eta })
    }

    /// Whether wavelengths are refracted by angles of their own.
    #[inline(always)]
    fn is_dispersive(&self, interface: Option<Interface<'_>>) -> bool {
        match interface {
            Some(media) => media.incident.is_dispersive() || media.transmitted.is_dispersive(),
            None => self.dispersive,
        }
    }

    /// The sample of a direction in which the interface has sent the hero, for which its relative index is `eta`.
    #[inline(always)]
    pub(crate) fn turned<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        turn: &Turn,
        (eta, from_outside): (f64, bool),
        interface: Option<Interface<'_>>,
    ) -> BsdfSample<N> {
        let &Turn { wi, reflects, reflectance, cos } = turn;
        let lane_density = match self.is_dispersive(interface) {
            false => Lanes::ONE,
            true if reflects => self.relative(lambda_nm, (cos, from_outside, interface), reflectance),
            true => Lanes::ONE.hero_only(),
        };
        // T/(1 − R) = 1 in exact arithmetic; radiance is compressed into the denser medium, or spread from it.
        let weight = if reflects { lane_density } else { lane_density / (eta * eta) };
        let eta = if reflects { 1.0 } else { eta };
        BsdfSample { wi, weight, density: Density::Delta, lane_density, eta }
    }
}

/// Where an interface sends the hero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    /// Toward the light; a unit vector.
    pub wi: Vec3<f64>,
    /// Whether it is reflected, and how likely that was.
    pub reflects: bool,
    /// See above.
    pub reflectance: f64,
    /// Cosine of incidence.
    pub cos: f64,
}

/// Reflects or refracts at an interface with outward normal `n` and relative index `eta` = n_transmitted / n_incident, by a number
/// `u` in [0, 1); without branches, so that a loop over interfaces is vectorised.
#[inline(always)]
pub(crate) fn turn(n: Vec3<f64>, wo: Vec3<f64>, eta: f64, u: f64) -> Turn {
    let n = if n.dot(wo) > 0.0 { n } else { -n };
    // Rounding may carry the product of two unit vectors past 1.
    let cos = n.dot(wo);
    let cos = if cos < 1.0 { cos } else { 1.0 };
    let (reflectance, cos_t) = fresnel::dielectric_reflectance(cos, eta);
    let reflects = u < reflectance;
    let reflected = wo.reflected_about(n).renormalized();
    let refracted = snell::refract_with_cosines(wo, n, eta, cos, cos_t);
    let choose = |a: f64, b: f64| if reflects { a } else { b };
    let wi =
        Vec3::new(choose(reflected.x, refracted.x), choose(reflected.y, refracted.y), choose(reflected.z, refracted.z));
    Turn { wi, reflects, reflectance, cos }
}
