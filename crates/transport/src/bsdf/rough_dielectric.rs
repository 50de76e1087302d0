//! Rough interface between two transparent media: GGX facets that reflect and refract by Fresnel's equations, and what
//! light that meets several facets adds.
//!
//! Single scattering is that of Walter et al. 2007. What it loses comes back as diffuse light on both sides (after Kulla &
//! Conty 2017), with A, B the mean losses seen from above and from below, M the larger of the two and T_a the mean
//! transmittance from above, so that Fresnel's reciprocity T_a n_a² = T_b n_b² holds of what is passed on:
//!
//! | | f | share of the loss |
//! |---|---|---|
//! | above ↔ above | (1 − T_a B/M) ℓ_a(µ_o) ℓ_a(µ_i)/(πA) | 1 − T_a B/M |
//! | above → below | T_a n_a²/(n_b² π M) ℓ_a(µ_o) ℓ_b(µ_i) | T_a B/M |
//! | below ↔ below | (1 − T_b A/M) ℓ_b(µ_o) ℓ_b(µ_i)/(πB) | 1 − T_b A/M |
//!
//! Facets bend each wavelength by its own angle, but a rough interface sends every wavelength everywhere: all lanes go on
//! along the hero's direction, each with its own value and its own density of that direction.

use super::film::{PathFilm, PowerShares};
use super::microfacet::Distribution;
use super::rough_boundary::Boundary;
use super::{BsdfSample, Drawn, Properties, Shading};
use crate::media::Interface;
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
use etalon_optics::{Complex, Lanes, RefractiveIndex, Vec3, fresnel, snell};
use etalon_scene::Microfacets;
use std::f64::consts::FRAC_1_PI;

/// Rough interface of two transparent media.
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    distribution: Distribution,
    compensated: bool,
    /// What coats each facet; then nothing is compensated.
    film: Option<Box<PathFilm>>,
    /// What the interface is by itself.
    own: Boundary,
    /// What it is between the same interior and other media, if it bounds a solid among others.
    others: Vec<Boundary>,
}

/// Where and how a facet is met: the wavelength, nm, texture coordinates, and whether from the exterior.
#[derive(Clone, Copy)]
struct Place {
    nm: f64,
    uv: [f64; 2],
    from_outside: bool,
}

/// What [`RoughDielectric::between`] finds.
struct Between {
    /// What one facet scatters, sr⁻¹, and the cosine at which light meets it, from above where it refracts.
    facet: Option<(f64, f64)>,
    /// What light that meets several adds, sr⁻¹.
    several: f64,
    density: f64,
    /// n of the side of `wi`, refracted, over that of `wo`: as Fresnel's equations take it.
    eta: f64,
}

impl RoughDielectric {
    /// An interface with `interior` behind the outward normal and `exterior` before it, with or without the light that
    /// meets several facets. Of facets of two widths it is always without: from the denser side total reflection begins at another cosine
    /// for each azimuth, and a table that blurs this would return more than it receives in single directions.
    pub fn new(
        interior: RefractiveIndex,
        exterior: RefractiveIndex,
        facets: &Microfacets,
        compensated: bool,
        range_nm: [f64; 2],
    ) -> Self {
        let distribution = Distribution::new(facets);
        let compensated = compensated && distribution.isotropic_alpha().is_some();
        let own = Boundary::new(interior, exterior, distribution, compensated, range_nm);
        Self { distribution, compensated, film: None, own, others: Vec::new() }
    }

    /// The same with a film on each facet; of facets that are not compensated.
    #[must_use]
    pub fn coated(self, film: Option<PathFilm>) -> Self {
        debug_assert!(film.is_none() || !self.compensated, "a film reflects each angle otherwise than the tables say");
        Self { film: film.map(Box::new), ..self }
    }

    /// What a facet does to light that it meets at the cosine `cos` from the side of `n[0]`; `eta` = n[1]/n[0].
    fn facet(&self, place: Place, cos: f64, (n, eta): ([f64; 2], f64)) -> PowerShares {
        match &self.film {
            Some(film) => {
                PowerShares::of(&film.fresnel(place.nm, cos, (n[0], Complex::real(n[1])), place.from_outside, place.uv))
            }
            None => match fresnel::dielectric(cos, eta) {
                Some(f) => PowerShares { reflected: f.reflectance, transmitted: f.transmittance },
                None => PowerShares { reflected: 1.0, transmitted: 0.0 },
            },
        }
    }

    /// See [`Properties`]. It states its own media, unless it bounds a solid with a priority.
    pub(super) fn properties(facets: &Microfacets) -> Properties {
        Properties::of_facets(facets)
    }

    /// Makes it the boundary of a solid that may border on any of `media`.
    pub(crate) fn prepare_media(&mut self, media: &[RefractiveIndex], range_nm: [f64; 2]) {
        let interior = &self.own.interior;
        let others = media.iter().filter(|medium| *medium != interior && **medium != self.own.exterior);
        let boundary = |medium: &RefractiveIndex| {
            Boundary::new(interior.clone(), medium.clone(), self.distribution, self.compensated, range_nm)
        };
        self.others = others.map(boundary).collect();
    }

    /// What it is at a place, and whether the side of `wo`, on that of the normal or not, is the exterior; `None` where the same
    /// medium is on both sides.
    fn boundary(&self, interface: Option<Interface<'_>>, above: bool) -> Option<(&Boundary, bool)> {
        let Some(Interface { incident, transmitted }) = interface else { return Some((&self.own, above)) };
        let interior = &self.own.interior;
        let (other, from_outside) = if transmitted == interior { (incident, true) } else { (transmitted, false) };
        if other == interior {
            return None;
        }
        if *other == self.own.exterior {
            return Some((&self.own, from_outside));
        }
        self.others.iter().find(|boundary| boundary.exterior == *other).map(|boundary| (boundary, from_outside))
    }

    /// What one wavelength does between two directions; `None` where there is nothing, and `sample` passes straight through.
    fn between(
        &self,
        (boundary, from_outside): (&Boundary, bool),
        wavelength_nm: f64,
        uv: [f64; 2],
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> Option<Between> {
        let sides = boundary.sides(wavelength_nm, from_outside, wo);
        let eta = sides.n[1] / sides.n[0];
        if eta == 1.0 {
            return None;
        }
        let place = Place { nm: wavelength_nm, uv, from_outside };
        let mu = wi.z.abs();
        let (mut facet, mut density) = (None, 0.0);
        let (side, share, per) = if wi.z > 0.0 {
            let facets = self.distribution.reflection(wo, wi);
            let shares = self.facet(place, facets.cos, (sides.n, eta));
            facet = Some((shares.reflected * facets.term, facets.cos));
            let chosen = if self.film.is_some() { shares.reflection_probability() } else { shares.reflected };
            density = chosen * facets.density;
            (0, 1.0 - sides.crossing, 1.0)
        } else {
            // In an order that does not depend on which of the two is `wo`, so that the BSDF is reciprocal to the last bits.
            let facets = if from_outside {
                self.distribution.refraction(wo, sides.n[0], wi, sides.n[1])
            } else {
                self.distribution.refraction(-wi, sides.n[1], -wo, sides.n[0])
            };
            if let Some(facets) = facets {
                let (eta_above, g_o) =
                    if from_outside { (eta, facets.g_above) } else { (sides.n[0] / sides.n[1], facets.g_below) };
                let n_above = if from_outside { sides.n } else { [sides.n[1], sides.n[0]] };
                let above = self.facet(Place { from_outside: true, ..place }, facets.cos_above, (n_above, eta_above));
                let transmittance = above.transmitted;
                let f = transmittance * facets.common * facets.g_above * facets.g_below * (sides.n[0] * sides.n[0]);
                facet = Some((f, facets.cos_above));
                let chosen = match &self.film {
                    None => transmittance,
                    Some(_) if from_outside => above.transmission_probability(),
                    // A film that absorbs reflects otherwise from below.
                    Some(_) => {
                        let cos_below = fresnel::refracted_cosine(facets.cos_above, eta_above).unwrap_or(0.0);
                        self.facet(place, cos_below, (sides.n, eta)).transmission_probability()
                    }
                };
                density = chosen * facets.common * g_o * (sides.n[1] * sides.n[1]);
            }
            (1, sides.crossing, eta * eta)
        };
        let mut several = 0.0;
        if sides.loss_o > 0.0 {
            let loss_i = sides.loss_i(side, wi);
            if sides.mean_loss[side] > 0.0 {
                several = share * sides.loss_o * loss_i * FRAC_1_PI / (sides.mean_loss[side] * per);
            }
            density = (1.0 - sides.loss_o) * density + sides.loss_o * share * sides.diffuse(side, mu);
        }
        Some(Between { facet, several, density, eta })
    }

    /// f·|cos θ_i| and the density of `wi` at one wavelength.
    fn of_wavelength(
        &self,
        boundary: (&Boundary, bool),
        wavelength_nm: f64,
        uv: [f64; 2],
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (f64, f64) {
        let Some(Between { facet, several, density, .. }) = self.between(boundary, wavelength_nm, uv, wo, wi) else {
            return (0.0, 0.0);
        };
        ((facet.map_or(0.0, |(f, _)| f) + several) * wi.z.abs(), density)
    }

    /// What it does to polarised light, in the frames of `x`: its facets do as a smooth interface, light that meets several
    /// forgets all but the way in and out.
    pub(super) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        (wo, wi, x): (Vec3<f64>, Vec3<f64>, Vec3<f64>),
    ) -> Option<[Matrix; N]> {
        let Some((boundary, from_outside)) = self.boundary(at.media(), n.dot(wo) > 0.0) else {
            return Some([mueller::IDENTITY; N]);
        };
        let facing = self.distribution.facing(at, n, wo)?;
        let (local_o, local_i) = (facing.wo, facing.local(wi));
        Some(lambda_nm.0.map(|nm| {
            let Some(Between { facet, several, eta, .. }) =
                self.between((boundary, from_outside), nm, at.uv, local_o, local_i)
            else {
                return mueller::IDENTITY;
            };
            let (single, cos) = facet.unwrap_or((0.0, 1.0));
            let matrix = if let Some(film) = &self.film {
                let reflects = local_i.z > 0.0;
                let (inside, outside) = (boundary.interior.eval(nm), boundary.exterior.eval(nm));
                // Both ways pass the same waves, and the facet's cosine is then that above.
                let from_outside = from_outside || !reflects;
                let [near, far] = if from_outside { [outside, inside] } else { [inside, outside] };
                let waves = film.fresnel(nm, cos, (near, Complex::real(far)), from_outside, at.uv);
                mueller::of_waves(if reflects { &waves.reflection } else { &waves.transmission })
            } else if local_i.z > 0.0 {
                mueller::dielectric_reflection(cos, eta)
            } else {
                // The facet's cosine is that above.
                let eta = if from_outside { eta } else { 1.0 / eta };
                let cos_t = fresnel::refracted_cosine(cos, eta).unwrap_or(0.0);
                mueller::dielectric_transmission(cos, eta, cos_t)
            };
            let forgotten = match boundary.compensation.as_ref().and_then(|c| c.polarised.as_ref()) {
                Some([outside, inside]) => {
                    let (near, far) = if from_outside { (outside, inside) } else { (inside, outside) };
                    let side_i = if local_i.z > 0.0 { near } else { far };
                    // The tables are over interior/exterior.
                    let eta = if from_outside { eta } else { 1.0 / eta };
                    let (a_o, a_i) = (near.eval(local_o, eta), side_i.eval(local_i, eta));
                    super::mueller::forgotten(|w| n.cross(w), (wo, wi, x), a_o, a_i)
                }
                None => mueller::DEPOLARISER,
            };
            mueller::mixed([(single, matrix), (several, forgotten)])
        }))
    }

    /// Makes the tables that [`RoughDielectric::mueller`] needs.
    pub(super) fn prepare_polarisation(&mut self) {
        let distribution = self.distribution;
        self.own.prepare_polarisation(&distribution);
        self.others.iter_mut().for_each(|boundary| boundary.prepare_polarisation(&distribution));
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let Some(boundary) = self.boundary(at.media(), n.dot(wo) > 0.0) else { return (Lanes::ZERO, Lanes::ZERO) };
        let Some(facing) = self.distribution.facing(at, n, wo) else { return (Lanes::ZERO, Lanes::ZERO) };
        let wi = facing.local(wi);
        if wi.z == 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let of_lane = |lane: usize| self.of_wavelength(boundary, lambda_nm[lane], at.uv, facing.wo, wi);
        if !boundary.0.dispersive && self.film.is_none() {
            let (f_cos, density) = of_lane(0);
            return (Lanes::splat(f_cos), Lanes::splat(density));
        }
        let both: [(f64, f64); N] = std::array::from_fn(of_lane);
        (Lanes::from_fn(|lane| both[lane].0), Lanes::from_fn(|lane| both[lane].1))
    }

    pub(super) fn draw<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        let straight_on = |lanes: Lanes<f64, N>| {
            let (wi, density) = (-wo, Density::Delta);
            Some(Drawn::Sample(BsdfSample { wi, weight: lanes, density, lane_density: lanes, eta: 1.0 }))
        };
        let Some((boundary, from_outside)) = self.boundary(at.media(), n.dot(wo) > 0.0) else {
            return straight_on(Lanes::ONE);
        };
        let facing = self.distribution.facing(at, n, wo)?;
        let [u_lobe, u1, u2] = u;
        let hero = boundary.sides(lambda_nm[0], from_outside, facing.wo);
        let eta = hero.n[1] / hero.n[0];
        if eta == 1.0 {
            return straight_on(if boundary.dispersive { Lanes::ONE.hero_only() } else { Lanes::ONE });
        }
        let wi = if u_lobe < hero.loss_o {
            let crosses = u_lobe < hero.loss_o * hero.crossing;
            let (_, tables) = hero.tables?;
            if crosses { -tables[1].sample([u1, u2]) } else { tables[0].sample([u1, u2]) }
        } else {
            let u_facet = (u_lobe - hero.loss_o) / (1.0 - hero.loss_o);
            let h = self.distribution.visible_normal(facing.wo, [u1, u2]);
            let cos_o = facing.wo.dot(h).min(1.0);
            let refracted = match &self.film {
                Some(_) => fresnel::refracted_cosine(cos_o, eta).map(|cos_t| {
                    let place = Place { nm: lambda_nm[0], uv: at.uv, from_outside };
                    (self.facet(place, cos_o, (hero.n, eta)).reflection_probability(), cos_t)
                }),
                None => fresnel::dielectric(cos_o, eta).map(|f| (f.reflectance, f.cos_t)),
            };
            match refracted {
                Some((reflection, cos_t)) if u_facet >= reflection => {
                    let wi = snell::refract_with_cosines(facing.wo, h, eta, cos_o, cos_t);
                    // A facet may refract back to the side that the light came from, where the model has no light.
                    if wi.z >= 0.0 {
                        return None;
                    }
                    wi
                }
                _ => {
                    let wi = facing.wo.reflected_about(h);
                    if wi.z <= 0.0 {
                        return None;
                    }
                    wi
                }
            }
        };
        let crossed = wi.z < 0.0;
        let wi = facing.world(wi);
        // Of the direction as it came out, rounding included.
        if (facing.local(wi).z < 0.0) != crossed {
            return None;
        }
        Some(Drawn::Direction(wi, if crossed { eta } else { 1.0 }))
    }
}
