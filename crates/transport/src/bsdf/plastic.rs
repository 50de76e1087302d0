//! Plastic: a diffuse ground under a clear coat, seen from vacuum, on both sides.
//!
//! The coat reflects as a smooth or rough dielectric. What it lets in, T(µ) = 1 − R(µ), is scattered by the ground, and what
//! does not get out is reflected back down, r_i of it, by the inside of the coat:
//! f = f_coat + T(µ_o) T(µ_i)·ρ/(π n² (1 − ρ r_i)), r_i = 1 − T_avg/n². The relation of r_i to T_avg = 2∫Tµ dµ is étendue's, so
//! that a white ground returns all that the coat lets in (Walsh 1926; Duntley 1942). T is exact for a smooth coat; for a
//! rough one 1 − R of its facets, tabulated: light that facets hide from one another enters the ground.
//! Or that light is lost: T is then what facets refract and do not hide, and r_i is what they reflect from below and do not hide, less than
//! 1 − T_avg/n².
//! Where the light that is reflected back down is lost, the ground is f = T(µ_o) T(µ_i)·ρ/π of a smooth T. Both are models of other renderers.
//!
//! A tint multiplies what the coat reflects, f_coat, and nothing else.

use super::albedo::{self, Azimuths, LossTable};
use super::glass_losses::{let_by, mean_transmittance};
use super::microfacet::{Distribution, Facet, Facing, MEAN_ERROR, mean_over_facets};
use super::mueller::{Lobe, PolarisedLoss};
use super::table_store::Tabulated;
use super::{BsdfSample, Drawn, Properties, Shading};
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
use crate::spectral::PathSpectrum;
use crate::texture::PathTexture;
use crate::warp::cosine_hemisphere;
use etalon_optics::{Lanes, RefractiveIndex, Vec3, fresnel};
use etalon_scene::{InternalReflection, Microfacets};
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// A coated diffuse surface.
#[derive(Clone, Debug)]
pub struct Plastic {
    reflectance: PathTexture,
    coat: RefractiveIndex,
    /// 1 − r_i: of diffuse light from below, what the coat does not return.
    let_out: PathSpectrum,
    internal_reflection: InternalReflection,
    rough: Option<Box<Rough>>,
    /// Share that is left of what the coat reflects, and its mean over the spectrum.
    tint: Option<Box<(PathTexture, f64)>>,
    /// Whether the coat's index depends on the wavelength.
    dispersive: bool,
    /// Index of the coat by which the lobe is chosen: every wavelength chooses alike.
    reference: f64,
    /// What the ground gives back of light that the coat let in, the mean over wavelengths and over an image; for that choice.
    ground: f64,
}

#[derive(Clone, Debug)]
struct Rough {
    distribution: Distribution,
    /// T(µ); `None` is that of a smooth coat.
    transmittance: Option<Arc<LossTable>>,
    /// The least and the largest index.
    eta: [f64; 2],
    /// Whether light that facets hide enters the ground.
    compensated: bool,
    /// What the coat lets in of polarised light, where that is carried.
    polarised: Option<Arc<PolarisedLoss>>,
}

/// What comes back from the ground under a coat, at one wavelength.
#[derive(Clone, Copy)]
struct Ground {
    /// n² of the coat.
    n2: f64,
    /// 1 − r_i of the coat.
    let_out: f64,
    internal_reflection: InternalReflection,
}

impl Plastic {
    /// A ground of albedo `reflectance` under a coat of index `coat`, smooth if it has no facets. With them stands whether light that they hide
    /// enters the ground.
    pub fn new(
        reflectance: PathTexture,
        coat: RefractiveIndex,
        facets: Option<(&Microfacets, bool)>,
        internal_reflection: InternalReflection,
        range_nm: [f64; 2],
    ) -> Self {
        let [first, last] = range_nm;
        let steps = || (0..=64).map(move |i| first + (last - first) * f64::from(i) / 64.0);
        let eta = albedo::extremes(range_nm, |nm| coat.eval(nm));
        let rough = facets.map(|(facets, compensated)| {
            let distribution = Distribution::new(facets);
            let through_facets = internal_reflection != InternalReflection::Lost;
            let transmittance = through_facets.then(|| coat_table(&distribution, eta, compensated));
            Box::new(Rough { distribution, transmittance, eta, compensated, polarised: None })
        });
        let table = rough.as_ref().and_then(|rough| rough.transmittance.as_ref());
        let mean_transmittance = |index: f64| match table {
            Some(table) => table.average(index),
            None => mean_transmittance(index),
        };
        let returned = match &rough {
            Some(rough) if !rough.compensated => Some(returned_table(&rough.distribution, eta)),
            _ => None,
        };
        let let_out = PathSpectrum::tabulate(range_nm, |nm| {
            let index = coat.eval(nm);
            match &returned {
                Some(table) => 1.0 - table.average(index),
                None => mean_transmittance(index) / (index * index),
            }
        });
        let middle = 0.5 * (first + last);
        let (dispersive, reference) = (coat.is_dispersive(), coat.eval(middle));
        let base = |nm: f64| {
            let index = coat.eval(nm);
            let ground = Ground { n2: index * index, let_out: let_out.eval(nm), internal_reflection };
            ground.of(reflectance.mean(nm)) * mean_transmittance(index)
        };
        let ground = steps().map(base).sum::<f64>() / 65.0;
        Self { reflectance, coat, let_out, internal_reflection, rough, tint: None, dispersive, reference, ground }
    }

    /// The same, of whose coat's reflection a share is left.
    pub fn with_tint(mut self, tint: PathTexture, [first, last]: [f64; 2]) -> Self {
        let mean = (0..=64).map(|i| tint.mean(first + (last - first) * f64::from(i) / 64.0)).sum::<f64>() / 65.0;
        self.tint = Some(Box::new((tint, mean)));
        self
    }

    /// What is left of what the coat reflects.
    fn left<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, at: &Shading<'_>) -> Option<Lanes<f64, N>> {
        self.tint.as_ref().map(|tint| tint.0.lanes(lambda_nm, at.texture_point()))
    }

    /// See [`Properties`]: a coat without width is a mirror over the diffuse ground. It is made for vacuum.
    pub(super) fn properties(facets: Option<&Microfacets>) -> Properties {
        match facets {
            None => Properties { solid_angle: true, ..Properties::mirror("a smooth coat") },
            Some(facets) => Properties::of_facets(facets),
        }
    }

    /// How light comes back from the ground under a coat of this index.
    fn ground(&self, wavelength_nm: f64, n: f64) -> Ground {
        let (let_out, internal_reflection) = (self.let_out.eval(wavelength_nm), self.internal_reflection);
        Ground { n2: n * n, let_out, internal_reflection }
    }

    /// The frame of the coat's facets.
    fn facing(&self, at: &Shading<'_>, n: Vec3<f64>, wo: Vec3<f64>) -> Option<Facing> {
        match &self.rough {
            Some(rough) => rough.distribution.facing(at, n, wo),
            None => Facing::new(n, wo),
        }
    }

    /// T of the coat in a direction of its frame.
    fn transmittance(&self, w: Vec3<f64>, index: f64) -> f64 {
        match self.rough.as_ref().and_then(|rough| rough.transmittance.as_ref()) {
            Some(table) => table.eval(w, index),
            None => fresnel::dielectric(w.z.min(1.0), index).map_or(0.0, |f| f.transmittance),
        }
    }

    /// By how much the coat prefers light that swings across the plane of incidence on its way in or out, (T_s − T_p)/(T_s + T_p), and
    /// the same of light that swings at 45° to it.
    fn diattenuation(&self, w: Vec3<f64>, index: f64) -> [f64; 2] {
        match self.rough.as_ref().filter(|rough| rough.transmittance.is_some()) {
            Some(rough) => rough.polarised.as_ref().map_or([0.0; 2], |polarised| polarised.eval(w, index)),
            None => {
                let mu = w.z.min(1.0);
                let passed = |cos_t: f64| mueller::dielectric_transmission(mu, index, cos_t)[0][1];
                [fresnel::dielectric(mu, index).map_or(0.0, |f| passed(f.cos_t)), 0.0]
            }
        }
    }

    /// What it does to polarised light, in the frames of `x`: the coat reflects as a dielectric, and what the ground has
    /// depolarised leaves by the coat, and has come in by it.
    pub(super) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        (wo, wi, x): (Vec3<f64>, Vec3<f64>, Vec3<f64>),
        lobe: Lobe,
    ) -> Option<[Matrix; N]> {
        let facing = self.facing(at, n, wo)?;
        let (local_o, local_i) = (facing.wo, facing.local(wi));
        if lobe != Lobe::SolidAngle {
            return Some(lambda_nm.0.map(|nm| mueller::dielectric_reflection(local_o.z.min(1.0), self.coat.eval(nm))));
        }
        let facets = self.rough.as_ref().map(|rough| rough.distribution.reflection(local_o, local_i));
        let reflectance: Lanes<f64, N> = self.reflectance.lanes(lambda_nm, at.texture_point());
        let left = self.left(lambda_nm, at).unwrap_or(Lanes::ONE);
        Some(std::array::from_fn(|lane| {
            let nm = lambda_nm[lane];
            let index = self.coat.eval(nm);
            let coat = facets.as_ref().map_or((0.0, mueller::IDENTITY), |facets| {
                let reflectance = fresnel::dielectric(facets.cos, index).map_or(1.0, |f| f.reflectance);
                (left[lane] * reflectance * facets.term, mueller::dielectric_reflection(facets.cos, index))
            });
            let [(t_o, a_o), (t_i, a_i)] =
                [local_o, local_i].map(|w| (self.transmittance(w, index), self.diattenuation(w, index)));
            let ground = t_o * t_i * self.ground(nm, index).of(reflectance[lane]) * FRAC_1_PI;
            let s = |w: Vec3<f64>| self.rough.as_ref().map_or(n.cross(w), |rough| rough.distribution.s(&facing, n, w));
            mueller::mixed([coat, (ground, super::mueller::forgotten(s, (wo, wi, x), a_o, a_i))])
        }))
    }

    /// Makes the table that [`Plastic::mueller`] needs: what the facets of a rough coat do not reflect of each state they let in.
    pub(super) fn prepare_polarisation(&mut self) {
        if let Some(rough) = self.rough.as_mut().filter(|rough| rough.transmittance.is_some()) {
            let Rough { distribution, eta, .. } = &**rough;
            rough.polarised = Some(match rough.compensated {
                true => PolarisedLoss::shared(Tabulated::Coat, *eta, distribution, let_in),
                false => PolarisedLoss::shared(Tabulated::LossyCoat, *eta, distribution, |facet, eta| {
                    let_by(distribution, facet, eta)
                }),
            });
        }
    }

    /// The probability of the coat's lobe, where the coat lets in this share at its index of reference.
    fn coat_share(&self, passed: f64) -> f64 {
        let (mut coat, ground) = (1.0 - passed, passed * self.ground);
        if let Some(tint) = &self.tint {
            // A tenth is drawn for places of an image that are brighter than its mean.
            coat *= tint.1.max(0.1);
        }
        // Never 0: at normal incidence an index near 1 reflects next to nothing, but not nothing.
        coat / (coat + ground)
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let Some(facing) = self.facing(at, n, wo) else { return (Lanes::ZERO, Lanes::ZERO) };
        let (wo, wi) = (facing.wo, facing.local(wi));
        if wi.z <= 0.0 {
            return (Lanes::ZERO, Lanes::ZERO);
        }
        let facets = self.rough.as_ref().map(|rough| rough.distribution.reflection(wo, wi));
        let diffuse = wi.z * FRAC_1_PI;
        let passed_o = self.transmittance(wo, self.reference);
        let reflectance: Lanes<f64, N> = self.reflectance.lanes(lambda_nm, at.texture_point());
        // T(µ_o) T(µ_i), what the ground makes of it, and f·|cos θ_i| of the coat's facets without its tint.
        let coat = |nm: f64, index: f64, passed_o: f64| {
            let passed = passed_o * self.transmittance(wi, index);
            let reflected = facets.as_ref().map_or(0.0, |facets| {
                let reflectance = fresnel::dielectric(facets.cos, index).map_or(1.0, |f| f.reflectance);
                reflectance * facets.term * wi.z
            });
            (passed, self.ground(nm, index), reflected)
        };
        let (of_ground, mut of_coat) = match self.dispersive {
            // The coat does the same in every lane.
            false => {
                let (passed, ground, reflected) = coat(lambda_nm[0], self.reference, passed_o);
                (reflectance.map(|rho| passed * ground.of(rho) * diffuse), Lanes::splat(reflected))
            }
            true => {
                let mut of_both = [Lanes::ZERO; 2];
                for lane in 0..N {
                    let index = self.coat.eval(lambda_nm[lane]);
                    let (passed, ground, reflected) = coat(lambda_nm[lane], index, self.transmittance(wo, index));
                    of_both[0][lane] = passed * ground.of(reflectance[lane]) * diffuse;
                    of_both[1][lane] = reflected;
                }
                (of_both[0], of_both[1])
            }
        };
        if let Some(left) = self.left(lambda_nm, at) {
            of_coat *= left;
        }
        let f_cos = of_ground + of_coat;
        let share = self.coat_share(passed_o);
        let mut density = (1.0 - share) * diffuse;
        if let Some(facets) = &facets {
            density += share * facets.density;
        }
        (f_cos, Lanes::splat(density))
    }

    pub(super) fn draw<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<Drawn<N>> {
        let facing = self.facing(at, n, wo)?;
        let [u_lobe, u1, u2] = u;
        let share = self.coat_share(self.transmittance(facing.wo, self.reference));
        let wi = match &self.rough {
            _ if u_lobe >= share => facing.world(cosine_hemisphere([u1, u2])),
            Some(rough) => {
                facing.world(facing.wo.reflected_about(rough.distribution.visible_normal(facing.wo, [u1, u2])))
            }
            None => {
                let mu = facing.wo.z.min(1.0);
                let reflected = |index: f64| fresnel::dielectric(mu, index).map_or(1.0, |f| f.reflectance) / share;
                let mut weight = match self.dispersive {
                    true => Lanes::from_fn(|lane| reflected(self.coat.eval(lambda_nm[lane]))),
                    false => Lanes::splat(reflected(self.reference)),
                };
                if let Some(left) = self.left(lambda_nm, at) {
                    weight *= left;
                }
                let (wi, density) = (wo.reflected_about(n).renormalized(), Density::Delta);
                return Some(Drawn::Sample(BsdfSample { wi, weight, density, lane_density: Lanes::ONE, eta: 1.0 }));
            }
        };
        Drawn::reflected(wi, facing.local(wi).z)
    }
}

impl Ground {
    /// ρ/(n²(1 − ρ r_i)); where the ground colours light only once, ρ/(n²(1 − r_i)); where that light is lost, ρ.
    #[inline(always)]
    fn of(self, rho: f64) -> f64 {
        let Self { n2, let_out, internal_reflection } = self;
        match internal_reflection {
            InternalReflection::Coloured => rho / (n2 * (1.0 - rho * (1.0 - let_out))),
            InternalReflection::Uncoloured => rho / (n2 * let_out),
            InternalReflection::Lost => rho,
        }
    }
}

/// What facets of a coat let in, whose index lies within `eta`.
fn coat_table(distribution: &Distribution, eta: [f64; 2], compensated: bool) -> Arc<LossTable> {
    let reflected = |cos: f64, eta: f64| fresnel::dielectric(cos, eta).map_or(1.0, |f| f.reflectance);
    let let_in = |wo: Vec3<f64>, eta: f64| match compensated {
        true => 1.0 - mean_over_facets(distribution, wo, Some(eta), |f| reflected(f.cos, eta) * f.mirrored),
        false => mean_over_facets(distribution, wo, Some(eta), |facet| let_by(distribution, facet, eta)[0]),
    };
    let of = if compensated { Tabulated::Coat } else { Tabulated::LossyCoat };
    albedo::shared(of, distribution, eta, || LossTable::new(Azimuths::of(distribution), eta, MEAN_ERROR, let_in))
}

/// What they reflect of light from below.
fn returned_table(distribution: &Distribution, eta: [f64; 2]) -> Arc<LossTable> {
    albedo::shared(Tabulated::UnderCoat, distribution, eta, || {
        LossTable::new(Azimuths::All, eta, MEAN_ERROR, |wo, eta| {
            mean_over_facets(distribution, wo, Some(1.0 / eta), |facet| {
                facet.mirrored * fresnel::dielectric(facet.cos, 1.0 / eta).map_or(1.0, |f| f.reflectance)
            })
        })
    })
}

/// What a facet of a coat of index `eta` lets in: (T₀, T₁), all of unpolarised light but what leaves by reflection, and how much more
/// of s than of p, halved.
pub(super) fn let_in(facet: &Facet, eta: f64) -> [f64; 2] {
    // Total reflection, at a coat of less than vacuum's index, treats both alike.
    let Some(f) = fresnel::dielectric(facet.cos, eta) else { return [1.0 - facet.mirrored, 0.0] };
    let difference = 0.5 * (f.r_s * f.r_s - f.r_p * f.r_p);
    [1.0 - f.reflectance * facet.mirrored, -difference * facet.mirrored]
}
