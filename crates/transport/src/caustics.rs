//! Directions toward bodies that cast caustics.
//!
//! Light that a mirror or a body of glass throws on a diffuse surface is found by the walk alone: no shadow ray goes through. Drawn by
//! the cosine, few directions meet a small body, and those few bear all of its light. So a diffuse surface draws a share of its
//! directions toward such bodies, uniformly in the cone that a sphere fills, or by area on what is seen of the box around any other
//! body, and the rest by the cosine. All are weighed by the density of the mixture (Veach 1997, §9.2.4: the one-sample model with the
//! balance heuristic), so that the estimate is unbiased whatever the share. Light that shadow rays find too is weighed as before, by the
//! cosine's density on both sides: any two weights will do that add up to one.
//!
//! What a smooth ball shows of a lamp is aimed at more closely ([`Image`]): each image with a share in proportion to the light that it
//! brings, and all with half of `share` where they bring as much as a lamp that fills [`LEVEL`].
//!
//! The share is taken from the light that comes in otherwise. Whether that pays is a matter of the scene, and is tried before the
//! picture, with random numbers of which it uses none (`trial.rs`).

mod hull;
mod image;
#[cfg(test)]
mod tests;
mod trial;

pub(crate) use hull::Hull;
pub(crate) use image::{Image, Mirrored, Pair, Refracted, Shows, View};
pub(crate) use trial::{Trial, try_casters};

use crate::bsdf::{Bsdf, BsdfSample, lambert};
use crate::light::{LightTable, Round, visible_sum};
use crate::mis::Density;
use crate::surface::{Scattering, Surfaces};
use etalon_geometry::{Aabb, Geometry, Primitive, PrimitiveId, SurfacePoint};
use etalon_optics::{Lanes, Real, Vec3};

/// Most bodies that are aimed at, the largest first.
const MOST_CASTERS: usize = 8;
/// Most of anything.
pub(crate) const MOST_TARGETS: usize = if MOST_CASTERS > MOST_IMAGES { MOST_CASTERS } else { MOST_IMAGES };

/// Most images of lamps that are aimed at, the largest balls' first.
pub(crate) const MOST_IMAGES: usize = 16;
/// The light that comes in otherwise, about: so many steradians of the brightest lamp, times the cosine over π. Where images bring as
/// much they have half of the share that they may have.
const LEVEL: f32 = 0.03;

/// Something that directions can be drawn toward. No function has branches, so that a loop over points is vectorised.
pub(crate) trait Target {
    /// Whether it can be aimed at from a point: from outside, and unless it is wholly behind a surface of normal `n` there.
    fn is_seen(&self, from: Vec3<f64>, n: Vec3<f64>) -> bool;
    /// A direction toward it from where it is seen, for `u` in [0, 1]².
    fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Vec3<f64>;
    /// The density of that, sr⁻¹; not a number where it cannot be seen.
    fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64;
}

impl Target for Round {
    #[inline(always)]
    fn is_seen(&self, from: Vec3<f64>, n: Vec3<f64>) -> bool {
        self.is_outside(from) & ((self.centre - from).dot(n) > -self.radius)
    }

    #[inline(always)]
    fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
        self.aim(from, u).wi
    }

    #[inline(always)]
    fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        self.density_of(from, wi)
    }
}

/// A body that casts caustics, as directions are drawn toward it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Caster {
    Sphere(Round),
    Box(Hull),
}

impl Caster {
    fn size(&self) -> f64 {
        match self {
            Self::Sphere(round) => 2.0 * round.radius,
            Self::Box(hull) => Vec3::from_array(hull.extent).length(),
        }
    }
}

/// What directions are drawn toward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Aims {
    #[default]
    Nothing,
    /// Whole bodies.
    Bodies,
    /// Images of lamps in balls.
    Images,
}

/// Those of a scene that directions are drawn toward.
#[derive(Clone, Debug, Default)]
pub(crate) struct Casters {
    pub(crate) bodies: Vec<Caster>,
    pub(crate) images: Vec<Image>,
    /// Which of them are.
    pub(crate) aims: Aims,
    /// The share of the directions that bodies have where all are seen, and that images have at most.
    pub(crate) share: f64,
}

impl Casters {
    /// The scene's own mirrors and bodies of glass, where there are lamps that a walk may run into; none is aimed at yet.
    pub(crate) fn new(surfaces: &Surfaces, geometry: &Geometry, lights: &LightTable, range_nm: [f64; 2]) -> Self {
        if !lights.lights().iter().any(|light| light.emitter().is_some()) {
            return Self::default();
        }
        let (mut bodies, mut boxes): (Vec<Caster>, Vec<(u32, Aabb)>) = (Vec::new(), Vec::new());
        let mut balls = Vec::new();
        for (i, &object) in surfaces.object_of.first().into_iter().flatten().enumerate() {
            let Some(of_object) = surfaces.objects.get(object as usize) else { continue };
            let bsdf = &surfaces.bsdfs[of_object.material];
            let hands_on = !bsdf.has_solid_angle_part() && !matches!(bsdf, Bsdf::Black);
            if !hands_on || of_object.emission.is_some() {
                continue;
            }
            match (geometry.primitive(PrimitiveId(i as u32)), boxes.last_mut()) {
                (Primitive::Sphere(sphere), _) => {
                    let ball = Round { centre: sphere.centre(), radius: sphere.radius(), front: true };
                    bodies.push(Caster::Sphere(ball));
                    balls.push((ball, bsdf));
                }
                (part, Some((of, body))) if *of == object => *body = body.union(part.bounds()),
                (part, _) => boxes.push((object, part.bounds())),
            }
        }
        bodies.extend(boxes.into_iter().map(|(_, body)| Caster::Box(body.into())));
        bodies.sort_by(|a, b| b.size().total_cmp(&a.size()));
        bodies.truncate(MOST_CASTERS);
        balls.sort_by(|a, b| b.0.radius.total_cmp(&a.0.radius));
        // Thousands of lamps are not looked at where nothing shows them.
        let lamps = if balls.is_empty() { Vec::new() } else { lamps(surfaces, geometry, lights, range_nm) };
        let shown = balls.iter().flat_map(|&(ball, bsdf)| {
            lamps.iter().filter_map(move |&(lamp, radiance)| {
                let pair = Pair::new(ball, lamp, radiance);
                match bsdf {
                    Bsdf::Mirror(_) | Bsdf::Conductor(_) => Some(Image::Mirrored(Mirrored(pair))),
                    Bsdf::Dielectric(glass) => {
                        let [interior, exterior] = glass.indices(IMAGE_NM);
                        let index = interior / exterior;
                        // What bends light less shows lamps nearly where they are; a bubble shows none to speak of.
                        (index > LEAST_INDEX).then_some(Image::Refracted(Refracted(pair, index as f32)))
                    }
                    _ => None,
                }
            })
        });
        let images = shown.take(MOST_IMAGES).collect();
        Self { bodies, images, aims: Aims::Nothing, share: 0.0 }
    }

    /// The bodies that directions are drawn toward, and the share of each where it is seen.
    pub(crate) fn bodies_aimed_at(&self) -> (&[Caster], f64) {
        match self.aims {
            Aims::Bodies => (&self.bodies, self.share / self.bodies.len() as f64),
            Aims::Nothing | Aims::Images => (&[], 0.0),
        }
    }

    /// The images that directions are drawn toward.
    pub(crate) fn images_aimed_at(&self) -> &[Image] {
        match self.aims {
            Aims::Images => &self.images,
            Aims::Nothing | Aims::Bodies => &[],
        }
    }

    /// Whether directions are drawn toward anything.
    pub(crate) fn aim(&self) -> bool {
        self.aims != Aims::Nothing
    }
}

/// The wavelength at which balls of glass are looked through, nm: one in the middle, from which images differ little.
const IMAGE_NM: f64 = 550.0;
/// Of what bends light less than this no image is looked for.
const LEAST_INDEX: f64 = 1.05;

/// Spheres around the lamps that a walk may run into, one for each object, with their radiance relative to the brightest.
fn lamps(surfaces: &Surfaces, geometry: &Geometry, lights: &LightTable, range_nm: [f64; 2]) -> Vec<(Round, f64)> {
    let mut lamps: Vec<(u32, Option<Round>, Aabb, f64)> = Vec::new();
    for light in lights.lights() {
        let Some(emitter) = light.emitter() else { continue };
        let primitive = emitter.surface.primitive;
        let Some(&object) = surfaces.object_of.first().and_then(|of| of.get(primitive.0 as usize)) else { continue };
        if emitter.surface.instance != 0 {
            continue;
        }
        let bounds = geometry.primitive(primitive).bounds();
        match lamps.last_mut() {
            Some((of, round, body, _)) if *of == object => (*round, *body) = (None, body.union(bounds)),
            _ => lamps.push((object, light.round(), bounds, visible_sum(light.spectrum(), range_nm))),
        }
    }
    let brightest = lamps.iter().map(|lamp| lamp.3).fold(0.0, f64::max);
    let around = |body: Aabb| Round { centre: body.centre(), radius: 0.5 * body.extent().length(), front: true };
    lamps
        .into_iter()
        .map(|(_, round, body, bright)| (round.unwrap_or_else(|| around(body)), bright / brightest))
        .collect()
}

/// The share of the directions that a body has at a point of a surface of normal `n`.
#[inline(always)]
pub(crate) fn share_of(body: &impl Target, each: f64, from: Vec3<f64>, n: Vec3<f64>) -> f64 {
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

/// The share of the directions that an image has, where `light` is the weight of all images and `most` what they have at most.
#[inline(always)]
pub(crate) fn share_of_image(weight: f32, light: f32, most: f64) -> f64 {
    most * f64::from(weight / (light + LEVEL))
}

/// What a target of this share adds to the density of a direction that it draws with `density`, sr⁻¹.
#[inline(always)]
pub(crate) fn density_of(share: f64, density: f64) -> f64 {
    let density = share * density;
    if share > 0.0 { density } else { 0.0 }
}

/// The density of a direction where casters have a part of all directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mixture {
    /// By the cosine alone, sr⁻¹.
    pub own: f64,
    /// The part that casters have.
    pub part: f64,
    /// What they add, sr⁻¹.
    pub of_casters: f64,
}

impl Mixture {
    /// Nothing is drawn toward casters.
    const NONE: Self = Self { own: 1.0, part: 0.0, of_casters: 0.0 };

    /// How much less a path is worth than the light that it was aimed at lets expect, so that roulette must not end it for that.
    #[inline(always)]
    pub(crate) fn aim_factor(&self) -> f64 {
        self.factor(1.0).min(1.0)
    }

    /// What a direction is worth, against one drawn by the cosine alone, if the casters had `times` of what they have.
    #[inline(always)]
    pub(crate) fn factor(&self, times: f64) -> f64 {
        #[cfg(test)]
        if tests::is_unweighed() {
            return 1.0;
        }
        self.own / ((1.0 - times * self.part) * self.own + times * self.of_casters)
    }
}

impl Casters {
    /// [`Scattering::sample`], with a share of the directions of diffuse surfaces drawn toward casters: what is drawn as if by the
    /// BSDF alone, and the densities that tell what it is worth.
    #[inline]
    pub(crate) fn sample<R: Real, const N: usize>(
        &self,
        point: &SurfacePoint<f64>,
        scattering: &Scattering<'_>,
        lambda_nm: &Lanes<f64, N>,
        wo: Vec3<f64>,
        u: [f64; 3],
    ) -> Option<(BsdfSample<R, N>, Mixture)> {
        let alone = || scattering.sample(lambda_nm, wo, u).map(|drawn| (drawn, Mixture::NONE));
        if !self.aim() {
            return alone();
        }
        let Some(reflectance) = scattering.diffuse(lambda_nm) else { return alone() };
        let (from, n) = (point.position, lambert::toward(point.normal, wo));
        let (bodies, each) = self.bodies_aimed_at();
        let images = self.images_aimed_at();
        let mut views = [View::NONE; MOST_IMAGES];
        let mut light = 0.0;
        for (image, view) in images.iter().zip(&mut views) {
            *view = match image {
                Image::Mirrored(image) => image.view(from.cast(), n.cast()),
                Image::Refracted(image) => image.view(from.cast(), n.cast()),
            };
            light += view.weight;
        }
        let (mut total, mut aimed) = (0.0, None);
        let mut shares = [0.0; MOST_TARGETS];
        for (number, share) in shares.iter_mut().enumerate().take(bodies.len() + images.len()) {
            *share = match bodies.get(number) {
                Some(Caster::Sphere(round)) => share_of(round, each, from, n),
                Some(Caster::Box(body)) => share_of(body, each, from, n),
                None => share_of_image(views[number - bodies.len()].weight, light, self.share),
            };
            if is_within(u[1], total, *share) {
                let u = [place_within(u[1], total, *share), u[2]];
                aimed = Some(match bodies.get(number) {
                    Some(Caster::Sphere(round)) => Target::aim(round, from, u),
                    Some(Caster::Box(body)) => body.aim(from, u),
                    None => views[number - bodies.len()].aim(u),
                });
            }
            total += *share;
        }
        let wi = match aimed {
            Some(wi) => wi,
            None => lambert::direction(point.normal, wo, [place_within(u[1], total, 1.0 - total), u[2]]).0,
        };
        let cos = n.dot(wi);
        if cos <= 0.0 || cos.is_nan() {
            return None;
        }
        let (of_bodies, of_images) = shares.split_at(bodies.len());
        let of_bodies = bodies.iter().zip(of_bodies).fold(0.0, |sum, (body, &share)| {
            sum + match body {
                Caster::Sphere(round) => density_of(share, round.density_of(from, wi)),
                Caster::Box(body) => density_of(share, body.density(from, wi)),
            }
        });
        let views = views.iter().take(images.len()).zip(of_images);
        let of_casters = views.fold(of_bodies, |sum, (view, &share)| sum + density_of(share, view.density(wi)));
        let own = lambert::density(cos);
        let drawn = BsdfSample {
            wi,
            weight: reflectance,
            density: Density::SolidAngle(own),
            lane_density: Lanes::ONE,
            eta: 1.0,
        };
        Some((drawn, Mixture { own, part: total, of_casters }))
    }
}
