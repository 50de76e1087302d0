//! Directions toward bodies that cast caustics.
//!
//! Light that a mirror or a body of glass throws on a diffuse surface is found by the walk alone: no shadow ray goes through. Drawn by
//! the cosine, few directions meet a small body, and those few bear all of its light. So a diffuse surface draws a share of its
//! directions toward such bodies, uniformly in the cone that a sphere fills, or by area on what is seen of the box around any other
//! body, and the rest by the cosine. All are weighed by the density of the mixture (Veach 1997, §9.2.4: the one-sample model with the
//! balance heuristic), so that the estimate is unbiased whatever the share. Light that shadow rays find too is weighed as before, by the
//! cosine's density on both sides: any two weights will do that add up to one.
//!
//! What a smooth ball shows of a lamp is aimed at more closely ([`SpecularImage`]): each image with a share in proportion to the light that it
//! brings, and all with half of `share` where they bring as much as a lamp that fills [`LEVEL`]. Beside images whole bodies of glass may
//! have a small share: through them the bright spots are seen that they throw themselves.
//!
//! The share is taken from the light that comes in otherwise. Whether that pays is a matter of the scene, and is tried before the
//! picture, with random numbers of which it uses none ([`tune`](crate::render::tune)).

mod connections;
mod hull;
mod mixture;
mod refracting_bodies;
mod specular_image;
mod specular_objects;
#[cfg(test)]
mod tests;

pub(crate) use connections::{SeedNumbers, SpecularConnections, USUAL_SHARES};
pub(crate) use hull::Hull;
pub(crate) use mixture::{
    Aimed, Mixture, VisibleImages, density_of, is_within, place_within, share_of, specular_image_share,
};
pub(crate) use refracting_bodies::RefractingBodies;
pub(crate) use specular_image::{Ball, Eye, Shows, SpecularImage};
pub(crate) use specular_objects::SpecularObjects;

use crate::bsdf::Bsdf;
use crate::light::{LightTable, visible_sum};
use crate::surface::{ObjectSurface, Surfaces};
use etalon_geometry::{Aabb, Geometry, Primitive, PrimitiveId, ShapeSampler, SphereSampler};
use etalon_optics::Vec3;

/// Most bodies that are aimed at, the largest first.
pub(crate) const MOST_BODIES: usize = 8;

/// Most images of lamps that are aimed at, the largest balls' first.
pub(crate) const MAX_SPECULAR_IMAGES: usize = 16;
/// The light that comes in otherwise, about: this many steradians of the brightest lamp, times the cosine over π. Where images bring as
/// much they have half of the share that they may have.
const LEVEL: f32 = 0.03;
/// What whole lenses have together beside images, as a part of what images have at most.
const OF_LENSES: f64 = 1.0 / 6.0;

/// Something that directions can be drawn toward. No function has branches, so that a loop over points is vectorised.
pub(crate) trait DirectionTarget {
    /// Whether it can be aimed at from a point: from outside, and unless it is wholly behind a surface of normal `n` there.
    fn is_seen(&self, from: Vec3<f64>, n: Vec3<f64>) -> bool;
    /// A direction toward it from where it is seen, for `u` in [0, 1]².
    fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Vec3<f64>;
    /// The density of that, sr⁻¹; not a number where it cannot be seen.
    fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64;
}

impl DirectionTarget for SphereSampler {
    #[inline(always)]
    fn is_seen(&self, from: Vec3<f64>, n: Vec3<f64>) -> bool {
        let toward = self.centre - from;
        (toward.length_squared() > self.radius * self.radius) & (toward.dot(n) > -self.radius)
    }

    #[inline(always)]
    fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
        self.sample(from, u).wi
    }

    #[inline(always)]
    fn density(&self, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        self.density(from, wi)
    }
}

/// A body that casts caustics, as directions are drawn toward it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum GuidedTarget {
    Sphere(SphereSampler),
    Box(Hull),
}

impl GuidedTarget {
    /// A direction toward it.
    #[inline]
    pub(crate) fn aim(&self, from: Vec3<f64>, u: [f64; 2]) -> Vec3<f64> {
        match self {
            Self::Sphere(sphere) => sphere.aim(from, u),
            Self::Box(body) => body.aim(from, u),
        }
    }

    /// A place of the box around it, for `u` in [0, 1)³; of a large body, one that is not much farther from a point than the body is.
    pub(crate) fn place_near(&self, from: Vec3<f64>, u: [f64; 3]) -> Vec3<f64> {
        match self {
            Self::Sphere(sphere) => sphere.centre + Vec3::from_array(u.map(|u| (2.0 * u - 1.0) * sphere.radius)),
            Self::Box(hull) => hull.place_near(from, u),
        }
    }

    /// Whether a point is outside of it, so that it can be aimed at.
    pub(crate) fn can_be_aimed_at(&self, from: Vec3<f64>) -> bool {
        match self {
            Self::Sphere(sphere) => (sphere.centre - from).length_squared() > sphere.radius * sphere.radius,
            Self::Box(hull) => hull.is_outside(from),
        }
    }

    fn size(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => 2.0 * sphere.radius,
            Self::Box(hull) => Vec3::from_array(hull.extent).length(),
        }
    }
}

/// What directions are drawn toward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum GuidedBy {
    #[default]
    Nothing,
    /// Whole bodies.
    Bodies,
    /// Images of lamps in balls.
    Images,
    /// Images of lamps, and whole bodies that bend light.
    ImagesAndLenses,
}

/// Those of a scene that directions are drawn toward.
#[derive(Clone, Debug, Default)]
pub(crate) struct GuidedTargets {
    pub(crate) bodies: Vec<GuidedTarget>,
    /// Those of them that bend light.
    pub(crate) lenses: Vec<GuidedTarget>,
    pub(crate) images: Vec<SpecularImage>,
    /// Which of them are.
    pub(crate) guided_by: GuidedBy,
    /// The share of the directions that bodies have where all are seen, and that images have at most.
    pub(crate) share: f64,
}

/// Nothing to aim at.
pub(crate) static NO_TARGETS: GuidedTargets = GuidedTargets {
    bodies: Vec::new(),
    lenses: Vec::new(),
    images: Vec::new(),
    guided_by: GuidedBy::Nothing,
    share: 0.0,
};

impl GuidedTargets {
    /// The scene's own mirrors and bodies of glass, where there are lamps that a walk may run into; none is aimed at yet.
    pub(crate) fn new(surfaces: &Surfaces, geometry: &Geometry, lights: &LightTable, range_nm: [f64; 2]) -> Self {
        if !lights.lights().iter().any(|light| light.emitter().is_some()) {
            return Self::default();
        }
        let bodies = specular_bodies(surfaces, geometry, |of| {
            surfaces.properties[of.material].is_specular() && of.emission.is_none()
        });
        let mut balls: Vec<_> = bodies
            .iter()
            .filter_map(|(body, bsdf)| match body {
                GuidedTarget::Sphere(ball) => Some((*ball, *bsdf)),
                GuidedTarget::Box(_) => None,
            })
            .collect();
        // With whether they bend light.
        let mut bodies: Vec<(GuidedTarget, bool)> =
            bodies.into_iter().map(|(body, bsdf)| (body, matches!(bsdf.untinted(), Bsdf::Dielectric(_)))).collect();
        bodies.sort_by(|a, b| b.0.size().total_cmp(&a.0.size()));
        bodies.truncate(MOST_BODIES);
        balls.sort_by(|a, b| b.0.radius.total_cmp(&a.0.radius));
        // Thousands of lamps are not looked at where nothing shows them.
        let lamps = if balls.is_empty() { Vec::new() } else { lamps(surfaces, geometry, lights, range_nm) };
        let lamps = &lamps;
        let shown = balls.iter().flat_map(|&(ball, bsdf)| {
            let shows = match bsdf.untinted() {
                Bsdf::Mirror(_) | Bsdf::Conductor(_) => Some(Shows::Mirrored),
                Bsdf::Dielectric(glass) => {
                    let [interior, exterior] = glass.indices(IMAGE_NM);
                    let index = interior / exterior;
                    // What bends light less shows lamps nearly where they are; a bubble shows none to speak of.
                    (index > LEAST_INDEX).then_some(Shows::Refracted(index as f32))
                }
                _ => None,
            };
            let ball = shows.map(|shows| Ball::new(ball, shows));
            ball.into_iter()
                .flat_map(|ball| lamps.iter().map(move |&(lamp, radiance)| SpecularImage::new(ball, lamp, radiance)))
        });
        let images = shown.take(MAX_SPECULAR_IMAGES).collect();
        let lenses = bodies.iter().filter(|body| body.1).map(|body| body.0).collect();
        Self {
            bodies: bodies.into_iter().map(|body| body.0).collect(),
            lenses,
            images,
            guided_by: GuidedBy::Nothing,
            share: 0.0,
        }
    }

    /// The bodies that directions are drawn toward, and the share of each where it is seen.
    pub(crate) fn bodies_aimed_at(&self) -> (&[GuidedTarget], f64) {
        match self.guided_by {
            GuidedBy::Bodies => (&self.bodies, self.share / self.bodies.len() as f64),
            GuidedBy::ImagesAndLenses => (&self.lenses, OF_LENSES * self.share / self.lenses.len() as f64),
            GuidedBy::Nothing | GuidedBy::Images => (&[], 0.0),
        }
    }

    /// The images that directions are drawn toward.
    pub(crate) fn specular_images_aimed_at(&self) -> &[SpecularImage] {
        match self.guided_by {
            GuidedBy::Images | GuidedBy::ImagesAndLenses => &self.images,
            GuidedBy::Nothing | GuidedBy::Bodies => &[],
        }
    }

    /// Whether directions are drawn toward anything.
    pub(crate) fn aim(&self) -> bool {
        self.guided_by != GuidedBy::Nothing
    }
}

/// The spheres, then the boxes around other bodies, of the scene's own objects that `are` such, and what they do to light.
pub(crate) fn specular_bodies<'a>(
    surfaces: &'a Surfaces,
    geometry: &Geometry,
    are: impl Fn(&ObjectSurface) -> bool,
) -> Vec<(GuidedTarget, &'a Bsdf)> {
    let mut bodies = Vec::new();
    let mut boxes: Vec<(u32, Aabb, &Bsdf)> = Vec::new();
    for (i, &object) in surfaces.object_of.first().into_iter().flatten().enumerate() {
        let Some(of_object) = surfaces.objects.get(object as usize) else { continue };
        if !are(of_object) {
            continue;
        }
        let bsdf = &surfaces.bsdfs[of_object.material];
        match (geometry.primitive(PrimitiveId(i as u32)), boxes.last_mut()) {
            (Primitive::Sphere(sphere), _) => bodies.push((GuidedTarget::Sphere(sphere.sampler()), bsdf)),
            (part, Some((of, body, _))) if *of == object => *body = body.union(part.bounds()),
            (part, _) => boxes.push((object, part.bounds(), bsdf)),
        }
    }
    bodies.extend(boxes.into_iter().map(|(_, body, bsdf)| (GuidedTarget::Box(body.into()), bsdf)));
    bodies
}

/// The wavelength at which balls of glass are looked through, nm: one in the middle, from which images differ little.
const IMAGE_NM: f64 = 550.0;
/// Of what bends light less than this no image is looked for.
const LEAST_INDEX: f64 = 1.05;

/// Spheres around the lamps that a walk may run into, one for each object, with their radiance relative to the brightest.
fn lamps(
    surfaces: &Surfaces,
    geometry: &Geometry,
    lights: &LightTable,
    range_nm: [f64; 2],
) -> Vec<(SphereSampler, f64)> {
    let mut lamps: Vec<(u32, Option<SphereSampler>, Aabb, f64)> = Vec::new();
    for light in lights.lights() {
        let Some(emitter) = light.emitter() else { continue };
        let primitive = emitter.surface.primitive;
        let Some(&object) = surfaces.object_of.first().and_then(|of| of.get(primitive.0 as usize)) else { continue };
        if emitter.surface.instance != 0 {
            continue;
        }
        let bounds = geometry.primitive(primitive).bounds();
        match lamps.last_mut() {
            Some((of, sphere, body, _)) if *of == object => (*sphere, *body) = (None, body.union(bounds)),
            _ => {
                let sphere = light.area().and_then(|light| match &light.shape {
                    ShapeSampler::Sphere(sphere) => Some(sphere.sampler()),
                    _ => None,
                });
                lamps.push((object, sphere, bounds, visible_sum(light.spectrum(), range_nm)));
            }
        }
    }
    let brightest = lamps.iter().map(|lamp| lamp.3).fold(0.0, f64::max);
    let around = |body: Aabb| SphereSampler { centre: body.centre(), radius: 0.5 * body.extent().length() };
    lamps
        .into_iter()
        .map(|(_, sphere, body, bright)| (sphere.unwrap_or_else(|| around(body)), bright / brightest))
        .collect()
}
