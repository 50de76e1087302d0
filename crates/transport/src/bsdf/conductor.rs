//! Smooth metal: Fresnel reflection from a complex refractive index n + ik, relative to the medium it stands in (vacuum, if
//! media are not tracked), s and p averaged.

use super::film::PathFilm;
use super::metal::PathMetal;
use super::{BsdfSample, Properties};
use crate::media::Interface;
use crate::mis::Density;
use crate::polarisation::mueller::{self, Matrix};
use crate::texture::TexturePoint;
use etalon_optics::fresnel::StackFresnel;
use etalon_optics::{Complex, Lanes, Vec3, fresnel};
use etalon_scene::Metal;

/// Smooth metal.
#[derive(Clone, Debug)]
pub struct Conductor {
    metal: PathMetal,
    film: Option<PathFilm>,
}

impl Conductor {
    /// A smooth surface of this metal, perhaps coated.
    pub fn new(metal: PathMetal, film: Option<PathFilm>) -> Self {
        Self { metal, film }
    }

    /// See [`Properties`].
    pub(super) fn properties(metal: &Metal, coated: bool) -> Properties {
        let dark = match metal {
            Metal::Reflectance(reflectance) => !coated && reflectance.is_zero(),
            Metal::Index(_) => false,
        };
        Properties { dark, takes_medium: true, ..Properties::mirror("smooth metal") }
    }

    /// n and k in every lane, relative to the medium in front of the metal.
    fn relative_index<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        place: TexturePoint,
        interface: Option<Interface<'_>>,
    ) -> [(f64, f64); N] {
        let mut index = self.metal.lanes(lambda_nm, place);
        if let Some(media) = interface {
            for ((n, k), nm) in index.iter_mut().zip(lambda_nm.0) {
                let around = media.incident.eval(nm);
                (*n, *k) = (*n / around, *k / around);
            }
        }
        index
    }

    /// What the coated metal does at the cosine `cos`, in every lane.
    fn coated<const N: usize>(
        &self,
        film: &PathFilm,
        lambda_nm: &Lanes<f64, N>,
        place: TexturePoint,
        cos: f64,
        interface: Option<Interface<'_>>,
    ) -> [StackFresnel; N] {
        let index = self.metal.lanes(lambda_nm, place);
        std::array::from_fn(|lane| {
            let (nm, (n, k)) = (lambda_nm[lane], index[lane]);
            let around = interface.map_or(1.0, |media| media.incident.eval(nm));
            // Both sides are coated alike.
            film.fresnel(nm, cos, (around, Complex::new(n, k)), true, place.uv)
        })
    }

    /// What reflection at the cosine `cos` does to polarised light.
    pub(super) fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        place: TexturePoint,
        cos: f64,
        interface: Option<Interface<'_>>,
    ) -> [Matrix; N] {
        if let Some(film) = &self.film {
            return self.coated(film, lambda_nm, place, cos, interface).map(|f| mueller::of_waves(&f.reflection));
        }
        self.relative_index(lambda_nm, place, interface).map(|(n, k)| mueller::conductor_reflection(cos, n, k))
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        place: TexturePoint,
        wo: Vec3<f64>,
        interface: Option<Interface<'_>>,
    ) -> Option<BsdfSample<N>> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos_o = n.dot(wo).abs().min(1.0);
        let weight = match &self.film {
            Some(film) => Lanes(self.coated(film, lambda_nm, place, cos_o, interface).map(|f| f.reflection.power())),
            None => {
                let index = self.relative_index(lambda_nm, place, interface);
                Lanes(index.map(|(n, k)| fresnel::conductor(cos_o, n, k).reflectance))
            }
        };
        Some(BsdfSample {
            wi: wo.reflected_about(n).renormalized(),
            weight,
            density: Density::Delta,
            lane_density: Lanes::ONE,
            eta: 1.0,
        })
    }
}
