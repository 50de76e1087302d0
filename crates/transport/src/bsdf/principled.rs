//! The principled surface: the model of films and games, for scenes that were made with it. It is no law of physics.
//!
//! # Formula
//!
//! With h = (o + i)/|o + i|, cos θ_d = o·h, v(c) = (1 − c)⁵ and the base's reflectance ρ, f is the sum of four lobes.
//!
//! - Diffuse, (1 − m) ρ/π times a mixture by `flatness`. The one part is (1 − v_o/2)(1 − v_i/2) + R(v_o + v_i + v_o v_i (R − 1)), where
//!   R = 2 r cos² θ_d. The other is 1.25 (S(1/(cos θ_o + cos θ_i) − ½) + ½), where S = (1 + (R/2 − 1)v_o)(1 + (R/2 − 1)v_i).
//! - Sheen, (1 − m) s v_d, coloured by `sheen_tint`.
//! - Specular, F D G/(4 cos θ_o cos θ_i) with facets of the width α = r². F is (1 − m)(1 − t) times Fresnel's reflectance, plus (1 − m) t times
//!   Schlick's of a coloured dielectric, plus m times Schlick's of a metal: F₀ + (1 − F₀)v_d, where F₀ is ρ/Y ((n − 1)/(n + 1))² or ρ.
//! - Coat, ¼ c F_c D_c G_c, where F_c = 0.04 + 0.96 v_d: see [`ClearCoat`].
//!
//! m is `metallic`, t is `specular_tint`, s is `sheen`, c is `clear_coat`, and Y is the luminance of ρ under D65.
//!
//! # Limits
//!
//! f is reciprocal. It does not conserve energy: the lobes are added, not layered, so a white base gives back more than it gets. Light that meets several facets is lost. The surface depolarises.
//!
//! # Source
//!
//! B. Burley 2012, *Physically Based Shading at Disney*; B. Burley 2015, *Extending the Disney BRDF to a BSDF with Integrated Subsurface
//! Scattering*, SIGGRAPH course notes. The coat and the mixture by `metallic` are those of W. Jakob, *Mitsuba 3*, plugin `principled`.

use super::clear_coat::ClearCoat;
use super::microfacet::{Distribution, Facing};
use super::{Drawn, Properties, Shading};
use crate::texture::{PathTexture, TexturePoint};
use crate::warp::cosine_hemisphere;
use etalon_optics::colour::rec709_luminance;
use etalon_optics::{Illuminant, Lanes, RefractiveIndex, Vec3, fresnel};
use etalon_scene::{Microfacets, PrincipledLobes, SpectrumTexture};
use std::f64::consts::FRAC_1_PI;

/// A principled surface, alike on both sides.
#[derive(Clone, Debug)]
pub struct Principled {
    reflectance: PathTexture,
    index: RefractiveIndex,
    distribution: Distribution,
    lobes: PrincipledLobes,
    coat: Option<ClearCoat>,
    /// r = √α.
    roughness: f64,
    /// Whether the index depends on the wavelength.
    dispersive: bool,
    /// The index by which the lobe is chosen: every wavelength chooses alike.
    reference: f64,
    /// The mean of the reflectance over wavelengths, and over an image.
    mean: f64,
    /// Y, if it is the same everywhere.
    luminance: Option<f64>,
}

/// What the lobe is chosen by; they add up to 1.
struct Probabilities {
    diffuse: f64,
    specular: f64,
    coat: f64,
}

impl Principled {
    /// A base of albedo `reflectance` whose surface has an index of at least 1.
    pub fn new(
        reflectance: &SpectrumTexture,
        index: RefractiveIndex,
        facets: &Microfacets,
        lobes: PrincipledLobes,
        range_nm: [f64; 2],
    ) -> Self {
        let [first, last] = range_nm;
        let steps = (0..=64).map(|i| first + (last - first) * f64::from(i) / 64.0);
        let [along, across] = facets.alpha;
        // Of the spectrum itself, at wavelengths that are not rendered, too.
        let luminance = match reflectance {
            SpectrumTexture::Uniform(spectrum) => Some(Illuminant::D65.xyz_of_reflectance(|nm| spectrum.eval(nm))[1]),
            SpectrumTexture::Image(_) | SpectrumTexture::VertexColours { .. } => None,
        };
        let reflectance = PathTexture::new(reflectance, range_nm);
        Self {
            mean: steps.map(|nm| reflectance.mean(nm)).sum::<f64>() / 65.0,
            luminance,
            dispersive: index.is_dispersive(),
            reference: index.eval(0.5 * (first + last)),
            roughness: (along * across).sqrt().sqrt(),
            distribution: Distribution::new(facets),
            coat: (lobes.clear_coat > 0.0).then(|| ClearCoat::new(lobes.clear_coat_alpha)),
            reflectance,
            index,
            lobes,
        }
    }

    /// See [`Properties`].
    pub(super) fn properties(facets: &Microfacets) -> Properties {
        Properties::of_facets(facets)
    }

    /// The probability of each lobe for a viewer at a cosine to the normal.
    fn probabilities(&self, mu: f64) -> Probabilities {
        let lobes = &self.lobes;
        let (dielectric, metal) = (1.0 - lobes.metallic, lobes.metallic);
        // Never 0: facets are tilted where the surface is not.
        let v = 0.02 + 0.98 * grazing(mu);
        let untinted = (1.0 - lobes.specular_tint) * reflected(mu, self.reference);
        let tinted = lobes.specular_tint * schlick(head_on(self.reference), v);
        let diffuse = dielectric * (self.mean + 0.2 * lobes.sheen);
        let specular = dielectric * (untinted + tinted) + metal * schlick(self.mean, v);
        let coat = lobes.clear_coat * schlick(COAT_HEAD_ON, v) * mu;
        let all = diffuse + specular + coat;
        if all == 0.0 {
            // It reflects nothing, or next to nothing.
            return Probabilities { diffuse: 1.0, specular: 0.0, coat: 0.0 };
        }
        Probabilities { diffuse: diffuse / all, specular: specular / all, coat: coat / all }
    }

    /// ρ/Y at a place, 1 where Y is 0.
    fn tint<const N: usize>(&self, base: Lanes<f64, N>, at: TexturePoint) -> Lanes<f64, N> {
        let y = self.luminance.or_else(|| self.reflectance.colour(at).map(rec709_luminance)).unwrap_or(0.0);
        if y > 0.0 { base / y } else { Lanes::ONE }
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let facing = self.distribution.facing(at, n, wo);
        let seen = facing.and_then(|facing| self.seen(lambda_nm, at, facing.wo, facing.local(wi)));
        seen.map_or((Lanes::ZERO, Lanes::ZERO), |(f_cos, density)| (f_cos, Lanes::splat(density)))
    }

    /// f cos θ_i and the density for directions of the surface's frame; `None` where the light comes from below.
    fn seen<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> Option<(Lanes<f64, N>, f64)> {
        if wi.z <= 0.0 {
            return None;
        }
        let lobes = &self.lobes;
        let facets = self.distribution.reflection(wo, wi);
        let probabilities = self.probabilities(wo.z.min(1.0));
        let v = grazing(facets.cos);
        let base: Lanes<f64, N> = self.reflectance.lanes(lambda_nm, at.texture_point());
        let tint = if lobes.has_tints() { self.tint(base, at.texture_point()) } else { Lanes::ONE };
        let diffuse = (1.0 - lobes.metallic) * FRAC_1_PI * self.diffuse(wo.z, wi.z, facets.cos);
        let sheen = (1.0 - lobes.metallic) * lobes.sheen * v;
        let coat = self.coat.as_ref().map_or([0.0; 2], |coat| coat.reflection(wo, wi, facets.cos));
        let coated = 0.25 * lobes.clear_coat * schlick(COAT_HEAD_ON, v) * coat[0];
        let dielectric = |eta: f64| [reflected(facets.cos, eta), head_on(eta)];
        // Without dispersion it does the same in every lane.
        let of_all = (!self.dispersive).then(|| dielectric(self.reference));
        let f_cos = Lanes::from_fn(|lane| {
            let [reflected, head_on] = of_all.unwrap_or_else(|| dielectric(self.index.eval(lambda_nm[lane])));
            let untinted = (1.0 - lobes.specular_tint) * reflected;
            let tinted = lobes.specular_tint * schlick(tint[lane] * head_on, v);
            let fresnel = (1.0 - lobes.metallic) * (untinted + tinted) + lobes.metallic * schlick(base[lane], v);
            let of_sheen = 1.0 + lobes.sheen_tint * (tint[lane] - 1.0);
            (base[lane] * diffuse + of_sheen * sheen + fresnel * facets.term + coated) * wi.z
        });
        let density = probabilities.diffuse * wi.z * FRAC_1_PI
            + probabilities.specular * facets.density
            + probabilities.coat * coat[1];
        Some((f_cos, density))
    }

    /// π/ρ times the diffuse lobe, for cosines to the normal and to the facet half way.
    fn diffuse(&self, o: f64, i: f64, cos: f64) -> f64 {
        let [v_o, v_i] = [o, i].map(grazing);
        let r = 2.0 * self.roughness * cos * cos;
        let retro = r * (v_o + v_i + v_o * v_i * (r - 1.0));
        let burley = (1.0 - 0.5 * v_o) * (1.0 - 0.5 * v_i) + retro;
        if self.lobes.flatness == 0.0 {
            return burley;
        }
        let s = (1.0 + (0.5 * r - 1.0) * v_o) * (1.0 + (0.5 * r - 1.0) * v_i);
        let flat = 1.25 * (s * (1.0 / (o + i) - 0.5) + 0.5);
        burley + self.lobes.flatness * (flat - burley)
    }

    pub(super) fn draw<const N: usize>(
        &self,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        let facing: Facing = self.distribution.facing(at, n, wo)?;
        let [u_lobe, u1, u2] = u;
        let probabilities = self.probabilities(facing.wo.z.min(1.0));
        let wi = match &self.coat {
            _ if u_lobe < probabilities.diffuse => cosine_hemisphere([u1, u2]),
            Some(coat) if u_lobe >= 1.0 - probabilities.coat => coat.sample(facing.wo, [u1, u2]),
            _ => facing.wo.reflected_about(self.distribution.visible_normal(facing.wo, [u1, u2])),
        };
        let wi = facing.world(wi);
        Drawn::reflected(wi, facing.local(wi).z)
    }
}

/// What a coat reflects head-on.
const COAT_HEAD_ON: f64 = 0.04;

/// (1 − c)⁵ of a cosine.
fn grazing(cos: f64) -> f64 {
    let x = (1.0 - cos).max(0.0);
    let x2 = x * x;
    x2 * x2 * x
}

/// Schlick's reflectance of what reflects `head_on` head-on, where (1 − c)⁵ is `v`.
fn schlick(head_on: f64, v: f64) -> f64 {
    head_on + (1.0 - head_on) * v
}

/// What a dielectric of this index reflects head-on.
fn head_on(eta: f64) -> f64 {
    let r = (eta - 1.0) / (eta + 1.0);
    r * r
}

/// What it reflects at a cosine.
fn reflected(cos: f64, eta: f64) -> f64 {
    fresnel::dielectric(cos, eta).map_or(1.0, |f| f.reflectance)
}
