//! What a primitive is made of: scattering, emission and the light it belongs to.

use crate::bsdf::{Bsdf, BsdfSample, Shading};
use crate::coordinates::Coordinates;
use crate::spectral::PathSpectrum;
use etalon_geometry::{Hit, PrimitiveId, SurfacePoint};
use etalon_optics::{Lanes, Real, Vec3};
use etalon_scene::EmissionSides;

/// What belongs to one object.
#[derive(Clone, Debug)]
pub(crate) struct ObjectSurface {
    pub material: usize,
    pub emission: Option<Emission>,
    pub coordinates: Coordinates,
}

/// What a surface emits.
#[derive(Clone, Debug)]
pub(crate) struct Emission {
    pub radiance: PathSpectrum,
    pub sides: EmissionSides,
}

/// Look-up from primitives to what they are made of.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surfaces {
    /// Scattering of each material.
    pub bsdfs: Vec<Bsdf>,
    pub objects: Vec<ObjectSurface>,
    /// Object of each primitive.
    pub object_of: Vec<u32>,
    /// Light of each primitive, [`NO_LIGHT`] without one.
    pub light_of: Vec<u32>,
}

pub(crate) const NO_LIGHT: u32 = u32::MAX;

/// The surface at a point.
pub(crate) struct Surface<'a> {
    pub object: u32,
    pub bsdf: &'a Bsdf,
    pub light: Option<u32>,
    emission: Option<&'a Emission>,
    coordinates: &'a Coordinates,
}

impl Surfaces {
    #[inline]
    pub(crate) fn of(&self, primitive: PrimitiveId) -> Surface<'_> {
        let object = self.object_of[primitive.0 as usize];
        let of_object = &self.objects[object as usize];
        let light = self.light_of[primitive.0 as usize];
        Surface {
            object,
            bsdf: &self.bsdfs[of_object.material],
            light: (light != NO_LIGHT).then_some(light),
            emission: of_object.emission.as_ref(),
            coordinates: &of_object.coordinates,
        }
    }
}

impl<'a> Surface<'a> {
    /// Scattering at a point of it.
    #[inline]
    pub(crate) fn scattering<R: Real>(&self, point: &SurfacePoint<R>, hit: &Hit<R>) -> Scattering<'a, R> {
        Scattering { bsdf: self.bsdf, at: self.coordinates.at(point.normal, hit.primitive, hit.uv) }
    }

    /// The radiance emitted along `wo` where the normal is `n`, if that side emits.
    #[inline]
    pub(crate) fn emission_along<R: Real>(&self, n: Vec3<R>, wo: Vec3<R>) -> Option<&'a PathSpectrum> {
        let emission = self.emission?;
        let front = n.dot(wo) > R::ZERO;
        let emits = match emission.sides {
            EmissionSides::Front => front,
            EmissionSides::Back => !front,
            EmissionSides::Both => true,
        };
        emits.then_some(&emission.radiance)
    }
}

/// Scattering at one point.
pub(crate) struct Scattering<'a, R> {
    bsdf: &'a Bsdf,
    at: Shading<R>,
}

impl<R: Real> Scattering<'_, R> {
    /// See [`Bsdf::eval`].
    #[inline]
    pub(crate) fn eval<const N: usize>(&self, lambda_nm: &Lanes<f64, N>, wo: Vec3<R>, wi: Vec3<R>) -> (Lanes<R, N>, R) {
        self.bsdf.eval(lambda_nm, &self.at, wo, wi)
    }

    /// See [`Bsdf::sample`].
    #[inline]
    pub(crate) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        wo: Vec3<R>,
        u: [R; 3],
    ) -> Option<BsdfSample<R, N>> {
        self.bsdf.sample(lambda_nm, &self.at, wo, u)
    }
}
