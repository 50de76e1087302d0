//! Media that absorb: light that goes d metres through one is multiplied by e^(−σd), σ the absorption coefficient in m⁻¹ at its
//! wavelength (Bouguer 1729, Lambert 1760, Beer 1852).
//!
//! Which medium a stretch of a path runs through is known in two ways. Where solids carry priorities, the medium that fills
//! each place is. A dielectric that states both its sides says it itself: a path that meets it from within has come through
//! its interior, and one that goes through it goes on in there, or leaves it. What such a body holds is surrounded by its
//! interior as long as it is not itself such a body.

use crate::media::{Media, MediumStack};
use crate::spectral::PathSpectrum;
use crate::surface::{Surface, Surfaces};
use etalon_geometry::{Geometry, Passed, Ray};
use etalon_optics::{Lanes, exp_neg};

/// The absorption of the body that a path is in, where no priority says it: the coefficient in m⁻¹, if it absorbs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EnclosingMedium<'a>(Option<&'a PathSpectrum>);

impl<'a> EnclosingMedium<'a> {
    /// The body that holds the origin of a ray: that of the first surface along it, whatever stands before that, which says
    /// what it holds, if the ray comes to it from within.
    pub(crate) fn around(geometry: &Geometry, surfaces: &'a Surfaces, ray: &Ray<f64>) -> Self {
        let mut passed = Passed::NOTHING;
        while let Some(hit) = geometry.next_hit(ray, &passed) {
            let point = geometry.surface(ray, &hit);
            let surface = surfaces.of(&point);
            if surface.interior().is_some() {
                return Self(None).before(&surface, point.normal.dot(ray.direction) < 0.0);
            }
            passed.pass(&hit, hit.t);
        }
        Self(None)
    }

    /// Corrected by the surface that the path has met, from its front or from within.
    pub(crate) fn before(self, surface: &Surface<'a>, from_front: bool) -> Self {
        match surface.interior() {
            Some(interior) if !from_front => Self(interior.absorption.as_ref()),
            _ => self,
        }
    }

    /// Behind the surface, which the path has met from its front or from within.
    pub(crate) fn beyond(self, surface: &Surface<'a>, from_front: bool) -> Self {
        match surface.interior() {
            Some(interior) if from_front => Self(interior.absorption.as_ref()),
            Some(_) => Self(None),
            None => self,
        }
    }
}

/// Absorption along paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Absorption {
    /// Metres in a unit of the frame.
    pub unit_m: f64,
}

impl Absorption {
    /// The share of light that comes through a stretch of this `length`, in units of the frame, in each lane.
    #[inline]
    pub(crate) fn transmittance<const N: usize>(
        &self,
        enclosing: EnclosingMedium<'_>,
        media: Option<&Media>,
        stack: &MediumStack,
        lambda_nm: &Lanes<f64, N>,
        length: f64,
    ) -> Lanes<f64, N> {
        let Some(coefficient) = enclosing.0.or_else(|| media.and_then(|media| media.absorption(stack))) else {
            return Lanes::ONE;
        };
        let length_m = length * self.unit_m;
        Lanes::from_fn(|lane| {
            let per_m = coefficient.eval(lambda_nm[lane]);
            // Nothing is lost on an endless way through what is clear.
            if per_m > 0.0 { exp_neg(per_m * length_m) } else { 1.0 }
        })
    }
}
