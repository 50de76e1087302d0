//! What a renderer can hand to the oracle: traits over plain numbers.

use crate::{generators::Shape, quadrature::Cone, statistics::Estimate};

/// How likely a sampled direction was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Probability density with respect to solid angle, sr⁻¹.
    SolidAngle(f64),
    /// Probability of this direction, one of a countable set.
    Delta(f64),
}

/// A sampled direction of scattering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered {
    /// Unit vector towards the light, leaving the surface.
    pub wi: [f64; 3],
    /// f·|cosθ|/pdf, or for a delta lobe its weight over its probability; for radiance, so with the factor
    /// (n_o/n_i)² on transmission.
    pub weight: f64,
    /// Its density, including the probability of having chosen this lobe.
    pub density: Density,
}

/// A direction into which a finite share of light is scattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeltaLobe {
    /// Unit vector towards the light, leaving the surface.
    pub wi: [f64; 3],
    /// Outgoing radiance per incident radiance: R for reflection, T·(n_o/n_i)² for transmission.
    pub weight: f64,
    /// Probability with which [`Scatters::sample`] chooses it.
    pub probability: f64,
}

/// A BSDF: how a point of a surface scatters light.
///
/// All directions are unit vectors in the local frame whose z axis is the surface normal and leave the surface: `wo`
/// towards the camera, `wi` towards the light. Radiance flows from `wi` to `wo`.
pub trait Scatters {
    /// f(wo, wi) in sr⁻¹, without the cosine and without delta lobes, at a wavelength in nm.
    fn f(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> f64;

    /// Density of [`sample`](Self::sample) with respect to solid angle, sr⁻¹; its integral over the sphere and the
    /// probabilities of the delta lobes add up to the probability that `sample` answers at all.
    fn pdf(&self, wo: [f64; 3], wi: [f64; 3], wavelength_nm: f64) -> f64;

    /// Draws a direction from three uniform numbers in [0, 1); `None` when the light is absorbed.
    fn sample(&self, wo: [f64; 3], u: [f64; 3], wavelength_nm: f64) -> Option<Scattered>;

    /// Every delta lobe seen from `wo`; none by default.
    fn deltas(&self, wo: [f64; 3], wavelength_nm: f64) -> Vec<DeltaLobe> {
        let _ = (wo, wavelength_nm);
        Vec::new()
    }

    /// Index of refraction of the medium above (z > 0) or below the surface; 1 by default.
    fn index(&self, above: bool, wavelength_nm: f64) -> f64 {
        let _ = (above, wavelength_nm);
        1.0
    }

    /// Whether light may arrive at and leave from the lower side (z < 0), so that it is tried; true by default.
    fn two_sided(&self) -> bool {
        true
    }

    /// Wavelengths to try, nm; 550 by default.
    fn wavelengths_nm(&self) -> Vec<f64> {
        vec![550.0]
    }

    /// Machine epsilon of the arithmetic; that of f64 by default, [`crate::laws::SINGLE`] for f32.
    fn epsilon(&self) -> f64 {
        f64::EPSILON
    }
}

/// A direction in which a light was sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitted {
    /// Unit vector from the lit point towards the light.
    pub wi: [f64; 3],
    /// Distance to the light, m.
    pub distance_m: f64,
    /// Radiance that arrives along it with nothing in between.
    pub radiance: f64,
    /// Density with respect to solid angle at the lit point, sr⁻¹.
    pub pdf: f64,
}

/// A light of finite extent, sampled by direction.
pub trait Emits {
    /// Draws a direction towards the light from a point in m and two uniform numbers; `None` when it cannot light it.
    fn sample(&self, from_m: [f64; 3], u: [f64; 2]) -> Option<Emitted>;

    /// Density of [`sample`](Self::sample) with respect to solid angle, sr⁻¹.
    fn pdf(&self, from_m: [f64; 3], wi: [f64; 3]) -> f64;

    /// Radiance that arrives from direction `wi` with nothing in between; 0 past the light.
    fn radiance(&self, from_m: [f64; 3], wi: [f64; 3]) -> f64;

    /// A cone that holds the light seen from a point, to spare the quadrature the empty sky.
    fn extent(&self, from_m: [f64; 3]) -> Cone {
        let _ = from_m;
        Cone::SPHERE
    }

    /// The solid angle that the light subtends, sr, if its closed form is known: the laws then hold the samples to it.
    fn solid_angle_sr(&self, from_m: [f64; 3]) -> Option<f64> {
        let _ = from_m;
        None
    }

    /// The irradiance on a surface of this unit normal with nothing in between, W·m⁻²·nm⁻¹, if its closed form is known: the
    /// laws then hold the samples to it.
    fn irradiance(&self, from_m: [f64; 3], normal: [f64; 3]) -> Option<f64> {
        let _ = (from_m, normal);
        None
    }

    /// Machine epsilon of the arithmetic.
    fn epsilon(&self) -> f64 {
        f64::EPSILON
    }
}

/// Where a ray met a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter: the point is origin + t·direction, whatever the direction's length.
    pub t: f64,
    /// Unit geometric normal.
    pub normal: [f64; 3],
}

/// Something a ray can hit.
pub trait Intersects {
    /// The nearest hit with t in (0, t_max).
    fn intersect(&self, origin_m: [f64; 3], direction: [f64; 3], t_max: f64) -> Option<Hit>;

    /// Whether there is any hit with t in (0, t_max); a subject with a query of its own for shadow rays asks that.
    fn occluded(&self, origin_m: [f64; 3], direction: [f64; 3], t_max: f64) -> bool {
        self.intersect(origin_m, direction, t_max).is_some()
    }
}

/// What makes something that rays can hit of shapes: a renderer's shapes with its tree.
pub trait Builds {
    /// Makes one thing of several shapes. A shape without an area, or too small for the subject's arithmetic, may be left
    /// out, if it is left out alone as well.
    fn build(&self, shapes: &[Shape]) -> Box<dyn Intersects>;

    /// Whether the subject knows such shapes.
    fn takes(&self, shape: &Shape) -> bool {
        let _ = shape;
        true
    }

    /// Machine epsilon of the arithmetic: rays and shapes are rounded to what it can represent.
    fn epsilon(&self) -> f64 {
        f64::EPSILON
    }
}

/// What a renderer measured on a truth's scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The measured quantity with its standard error.
    pub estimate: Estimate,
    /// Samples that were NaN or infinite. A good renderer has none, and a truth fails with any.
    pub nonfinite: u64,
    /// Largest absolute bias that paths may have caused which the renderer cut for no reason of the scene's; 0 if there were none.
    /// [`Truth::bias_of_cut_paths`](crate::truths::Truth::bias_of_cut_paths) bounds it. What cannot be bounded is infinite.
    pub cut_bias: f64,
}
