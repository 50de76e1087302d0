//! Directions drawn from a mixture, and their densities.

use super::specular_image::View;
use super::{
    DirectionTarget, GuidedTarget, GuidedTargets, LEVEL, MAX_SPECULAR_IMAGES, MOST_BODIES, Shows, SpecularImage,
};
use crate::bsdf::{BsdfSample, lambert};
use crate::mis::Density;
use crate::surface::Scattering;
use etalon_geometry::SurfacePoint;
use etalon_optics::{Lanes, Vec3};

/// The share of the directions that a body has at a point of a surface of normal `n`.
#[inline(always)]
pub(crate) fn share_of(body: &impl DirectionTarget, each: f64, from: Vec3<f64>, n: Vec3<f64>) -> f64 {
    if body.is_seen(from, n) { each } else { 0.0 }
}

/// Whether a number falls into the share that begins at `begin`.
#[inline(always)]
pub(crate) fn is_within(u: f64, begin: f64, share: f64) -> bool {
    (u >= begin) & (u < begin + share)
}

/// Where in it.
#[inline(always)]
pub(crate) fn place_within(u: f64, begin: f64, share: f64) -> f64 {
    (u - begin) / share
}

/// The share of the directions that images have together, where `light` is the weight of all and `most` what they have at most.
#[inline(always)]
pub(crate) fn specular_image_share(light: f32, most: f64) -> f64 {
    most * f64::from(light / (light + LEVEL))
}

/// What a target of this share adds to the density of a direction that it draws with `density`, sr⁻¹.
#[inline(always)]
pub(crate) fn density_of(share: f64, density: f64) -> f64 {
    let density = share * density;
    if share > 0.0 { density } else { 0.0 }
}

/// The density of a direction where guided targets have a part of all directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mixture {
    /// By the cosine alone, sr⁻¹.
    pub own: f64,
    /// The part that guided targets have.
    pub part: f64,
    /// What they add, sr⁻¹.
    pub of_guided_targets: f64,
}

impl Mixture {
    /// Nothing is drawn toward guided targets.
    pub(crate) const NONE: Self = Self { own: 1.0, part: 0.0, of_guided_targets: 0.0 };

    /// What a direction is worth, against one drawn by the cosine alone, if the guided targets had `times` of what they have.
    #[inline(always)]
    pub(crate) fn factor(&self, times: f64) -> f64 {
        self.own / ((1.0 - times * self.part) * self.own + times * self.of_guided_targets)
    }
}

/// The images of lamps that a point of a surface of normal `n` sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VisibleImages<'a> {
    pub images: &'a [SpecularImage],
    pub from: Vec3<f32>,
    pub n: Vec3<f32>,
    /// Of each image.
    pub weights: &'a [f32; MAX_SPECULAR_IMAGES],
    /// The share of the directions that all have together.
    pub share: f64,
}

/// A direction that was drawn toward an image, where that image is, and its number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aimed {
    pub wi: Vec3<f64>,
    number: usize,
    view: View,
}

impl VisibleImages<'_> {
    /// A direction toward one of them, drawn in proportion to its weight, for `u` in [0, 1]²; none where it was drawn in vain, since by way of
    /// that ball it meets nothing of the lamp. So that part of all directions is drawn by the cosine alone.
    #[inline]
    pub(crate) fn aim(&self, [u1, u2]: [f64; 2]) -> Option<Aimed> {
        let light = self.light();
        let mut rest = u1 * light;
        let mut chosen = None;
        for (number, &weight) in self.weights.iter().enumerate().take(self.images.len()) {
            let weight = f64::from(weight);
            if weight > 0.0 {
                chosen = Some((number, (rest / weight).min(1.0)));
                if rest < weight {
                    break;
                }
                rest -= weight;
            }
        }
        let (number, place) = chosen?;
        let image = &self.images[number];
        let view = image.view(&image.ball.eye(self.from), self.n);
        if view.weight <= 0.0 {
            return None;
        }
        let wi = view.aim([place, u2]);
        self.is_shown(image, wi).then_some(Aimed { wi, number, view })
    }

    /// What all of them add to the density of a direction, sr⁻¹; `aimed` is known of it already.
    #[inline]
    pub(crate) fn density(&self, wi: Vec3<f64>, aimed: Option<&Aimed>) -> f64 {
        let each = self.share / self.light();
        let mut density = 0.0;
        for (number, image) in self.images.iter().enumerate() {
            let share = each * f64::from(self.weights[number]);
            let of_image = match aimed {
                Some(aimed) if aimed.number == number => aimed.view.density(wi),
                _ if share > 0.0 && self.is_shown(image, wi) => {
                    let view = image.view(&image.ball.eye(self.from), self.n);
                    if view.weight > 0.0 { view.density(wi) } else { 0.0 }
                }
                _ => continue,
            };
            density += density_of(share, of_image);
        }
        density
    }

    /// The sum of all weights.
    #[inline]
    fn light(&self) -> f64 {
        self.weights.iter().take(self.images.len()).map(|&weight| f64::from(weight)).sum()
    }

    /// Whether an image's lamp is met along `wi` by way of its ball, about.
    #[inline]
    fn is_shown(&self, image: &SpecularImage, wi: Vec3<f64>) -> bool {
        let wi = wi.cast();
        image.ball.is_met(self.from, wi) && image.is_shown(&image.ball.hand_on(self.from, wi))
    }
}

impl GuidedTargets {
    /// [`Scattering::sample`], with a share of the directions of diffuse surfaces drawn toward guided targets: what is drawn as if by the
    /// BSDF alone, and the densities that tell what it is worth.
    #[inline]
    pub(crate) fn sample<const N: usize>(
        &self,
        point: &SurfacePoint<f64>,
        scattering: &Scattering<'_>,
        lambda_nm: &Lanes<f64, N>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<(BsdfSample<N>, Mixture)> {
        let alone = || scattering.sample(lambda_nm, wo, u).map(|drawn| (drawn, Mixture::NONE));
        if !self.aim() {
            return alone();
        }
        let Some(reflectance) = scattering.diffuse(lambda_nm) else { return alone() };
        let (wi, cos, mixture) = self.diffuse(point, wo, [u[1], u[2]])?;
        let drawn = BsdfSample {
            wi,
            weight: reflectance,
            density: Density::SolidAngle(lambert::density(cos)),
            lane_density: Lanes::ONE,
            eta: 1.0,
        };
        Some((drawn, mixture))
    }

    /// A direction from a diffuse surface, its cosine, and the densities that tell what it is worth; none where it was drawn in vain.
    #[inline]
    pub(crate) fn diffuse(
        &self,
        point: &SurfacePoint<f64>,
        wo: Vec3<f64>,
        u: [f64; 2],
    ) -> Option<(Vec3<f64>, f64, Mixture)> {
        let by_cosine = |u| lambert::direction(point.normal, wo, u);
        if self.aim() {
            return self.draw(point.position, lambert::toward(point.normal, wo), u, |u| by_cosine(u).0);
        }
        let (wi, cos) = by_cosine(u);
        (cos > 0.0).then_some((wi, cos, Mixture::NONE))
    }

    /// A direction from a diffuse surface of normal `n`, where `by_cosine` draws those that are aimed at nothing; none where it was drawn in
    /// vain.
    #[inline]
    fn draw(
        &self,
        from: Vec3<f64>,
        n: Vec3<f64>,
        [u1, u2]: [f64; 2],
        by_cosine: impl FnOnce([f64; 2]) -> Vec3<f64>,
    ) -> Option<(Vec3<f64>, f64, Mixture)> {
        let (bodies, each) = self.bodies_aimed_at();
        let mut shares = [0.0; MOST_BODIES];
        let (mut part, mut toward) = (0.0, None);
        for (body, share) in bodies.iter().zip(&mut shares) {
            *share = match body {
                GuidedTarget::Sphere(sphere) => share_of(sphere, each, from, n),
                GuidedTarget::Box(body) => share_of(body, each, from, n),
            };
            if is_within(u1, part, *share) {
                toward = Some((body, place_within(u1, part, *share)));
            }
            part += *share;
        }
        let mut weights = [0.0; MAX_SPECULAR_IMAGES];
        let seen = self.see(from.cast(), n.cast(), &mut weights);
        let begin = part;
        part += seen.share;
        let (wi, aimed) = if let Some((body, place)) = toward {
            (body.aim(from, [place, u2]), None)
        } else if u1 < part {
            let place = place_within(u1, begin, seen.share);
            let aimed = seen.aim([place, u2]);
            let aimed = aimed?;
            (aimed.wi, Some(aimed))
        } else {
            (by_cosine([place_within(u1, part, 1.0 - part), u2]), None)
        };
        let cos = n.dot(wi);
        if cos <= 0.0 || cos.is_nan() {
            return None;
        }
        let of_bodies = bodies.iter().zip(shares).fold(0.0, |sum, (body, share)| {
            sum + match body {
                GuidedTarget::Sphere(sphere) => density_of(share, sphere.density(from, wi)),
                GuidedTarget::Box(body) => density_of(share, body.density(from, wi)),
            }
        });
        let of_images = if seen.share > 0.0 { seen.density(wi, aimed.as_ref()) } else { 0.0 };
        let own = lambert::density(cos);
        Some((wi, cos, Mixture { own, part, of_guided_targets: of_bodies + of_images }))
    }

    /// The images that a point of a surface of normal `n` sees.
    fn see<'a>(
        &'a self,
        from: Vec3<f32>,
        n: Vec3<f32>,
        weights: &'a mut [f32; MAX_SPECULAR_IMAGES],
    ) -> VisibleImages<'a> {
        let images = self.specular_images_aimed_at();
        let mut light = 0.0;
        for (image, weight) in images.iter().zip(&mut *weights) {
            let eye = image.ball.eye(from);
            *weight = match image.ball.shows {
                Shows::Mirrored => image.weight_mirrored(&eye, n),
                Shows::Refracted(index) => image.view_refracted(index, &eye, n).weight,
            };
            light += *weight;
        }
        VisibleImages { images, from, n, weights, share: specular_image_share(light, self.share) }
    }
}
