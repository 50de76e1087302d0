//! Directions toward bodies that cast caustics.
//!
//! Light that a mirror or a body of glass throws on a diffuse surface is found by the walk alone: no shadow ray goes through. Drawn by
//! the cosine, few directions meet a small body, and those few bear all of its light. So a diffuse surface draws a share of its
//! directions toward such bodies, uniformly in the cone that a sphere fills, or by area on what is seen of the box around any other
//! body, and the rest by the cosine. All are weighed by the density of the mixture (Veach 1997, §9.2.4: the one-sample model with the
//! balance heuristic), so that the estimate is unbiased whatever the share. Light that shadow rays find too is weighed as before, by the
//! cosine's density on both sides: any two weights will do that add up to one.
//!
//! The share is taken from the light that comes in otherwise. Whether that pays is a matter of the scene, and is tried before the
//! picture, with random numbers of which it uses none (`trial.rs`).

mod hull;
#[cfg(test)]
mod tests;
mod trial;

pub(crate) use hull::Hull;
pub(crate) use trial::{Trial, try_casters};

use crate::bsdf::{Bsdf, BsdfSample, lambert};
use crate::light::{LightTable, Round};
use crate::mis::Density;
use crate::surface::{Scattering, Surfaces};
use etalon_geometry::{Aabb, Geometry, Primitive, PrimitiveId, SurfacePoint};
use etalon_optics::{Lanes, Real, Vec3};

/// Most bodies that are aimed at, the largest first.
pub(crate) const MOST_CASTERS: usize = 8;

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

/// Those of a scene that directions are drawn toward.
#[derive(Clone, Debug, Default)]
pub(crate) struct Casters {
    pub(crate) bodies: Vec<Caster>,
    /// The share of the directions that each has where it is seen.
    pub(crate) each: f64,
}

impl Casters {
    /// The scene's own mirrors and bodies of glass, where there are lamps that a walk may run into; none is aimed at yet.
    pub(crate) fn new(surfaces: &Surfaces, geometry: &Geometry, lights: &LightTable) -> Self {
        if !lights.lights().iter().any(|light| light.emitter().is_some()) {
            return Self::default();
        }
        let (mut bodies, mut boxes): (Vec<Caster>, Vec<(u32, Aabb)>) = (Vec::new(), Vec::new());
        for (i, &object) in surfaces.object_of.first().into_iter().flatten().enumerate() {
            let Some(of_object) = surfaces.objects.get(object as usize) else { continue };
            let bsdf = &surfaces.bsdfs[of_object.material];
            let hands_on = !bsdf.has_solid_angle_part() && !matches!(bsdf, Bsdf::Black);
            if !hands_on || of_object.emission.is_some() {
                continue;
            }
            match (geometry.primitive(PrimitiveId(i as u32)), boxes.last_mut()) {
                (Primitive::Sphere(sphere), _) => {
                    bodies.push(Caster::Sphere(Round {
                        centre: sphere.centre(),
                        radius: sphere.radius(),
                        front: true,
                    }));
                }
                (part, Some((of, body))) if *of == object => *body = body.union(part.bounds()),
                (part, _) => boxes.push((object, part.bounds())),
            }
        }
        bodies.extend(boxes.into_iter().map(|(_, body)| Caster::Box(body.into())));
        bodies.sort_by(|a, b| b.size().total_cmp(&a.size()));
        bodies.truncate(MOST_CASTERS);
        Self { bodies, each: 0.0 }
    }

    /// The bodies that directions are drawn toward: none where none has a share.
    pub(crate) fn aimed_at(&self) -> &[Caster] {
        if self.each > 0.0 { &self.bodies } else { &[] }
    }
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

/// What a body of this share adds to the density of a direction, sr⁻¹.
#[inline(always)]
pub(crate) fn density_of(body: &impl Target, share: f64, from: Vec3<f64>, wi: Vec3<f64>) -> f64 {
    let density = share * body.density(from, wi);
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
        let bodies = self.aimed_at();
        let alone = || scattering.sample(lambda_nm, wo, u).map(|drawn| (drawn, Mixture::NONE));
        if bodies.is_empty() {
            return alone();
        }
        let Some(reflectance) = scattering.diffuse(lambda_nm) else { return alone() };
        let (from, n) = (point.position, lambert::toward(point.normal, wo));
        let (mut total, mut aimed) = (0.0, None);
        let mut shares = [0.0; MOST_CASTERS];
        for (body, share) in bodies.iter().zip(&mut shares) {
            *share = match body {
                Caster::Sphere(round) => share_of(round, self.each, from, n),
                Caster::Box(body) => share_of(body, self.each, from, n),
            };
            if is_within(u[1], total, *share) {
                let u = [place_within(u[1], total, *share), u[2]];
                aimed = Some(match body {
                    Caster::Sphere(round) => Target::aim(round, from, u),
                    Caster::Box(body) => body.aim(from, u),
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
        let of_casters = bodies.iter().zip(shares).fold(0.0, |sum, (body, share)| {
            sum + match body {
                Caster::Sphere(round) => density_of(round, share, from, wi),
                Caster::Box(body) => density_of(body, share, from, wi),
            }
        });
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
