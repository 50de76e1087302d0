//! What scattering needs to know of a point besides directions, and scattering around a normal that is not the surface's.
//!
//! # Shading normals
//!
//! A mesh that stands for a smooth surface scatters around normals interpolated between its vertices. They contradict the
//! flat triangles that rays meet, and the contradiction is settled so:
//!
//! 1. **The triangle decides sides.** What is reflected, what is transmitted, which side emits and from which side a ray
//!    leaves follow from the geometric normal alone. A wall lets no light through, whatever its vertices' normals.
//! 2. A shading normal on the far side of the triangle is turned around.
//! 3. A viewer below the horizon of the shading normal counts as its mirror image in that horizon. No silhouette turns
//!    black.
//! 4. A direction that the BSDF scatters to the wrong side of the triangle is replaced by its mirror image in the
//!    triangle's plane: the BSDF becomes f(ω) + f(ω mirrored) over those of the two that belong to the side.
//!
//! Mirroring keeps solid angles, so a surface scatters as much as its BSDF does: a white furnace stays white. Light still
//! ends where the triangle turns away from a lamp, not where the shading normal does; finer meshes close the gap. As with
//! every shading normal, scattering is not reciprocal (Veach 1996, *Non-symmetric Scattering in Light Transport
//! Algorithms*). Paths from the camera are estimated rightly. Paths from lights ask [`eval`] for the camera's own answer, and at smooth surfaces
//! [`sample_viewer`] for the way back.
//!
//! # Maps that lose light
//!
//! Other renderers lose what a normal or bump map sends through the surface. A map may ask for it (`terminator`). Then rules 3 and 4 ask for the
//! horizon of the normal m before the map.
//!
//! - If the viewer is in front of m and behind the map's normal, or the other way round, the map's normal is turned by half a turn about m (Schüßler et
//!   al. 2017, *Microfacet-based Normal Mapping for Robust Monte Carlo Path Tracing*).
//! - If this holds for the light, the light is lost.
//! - A shadowed map dims what is left by 2/(1 + √(1 + a tan²θ)). θ is the angle between the light and m. a is an eighth of tan² of the angle between both
//!   normals, at most 1 (Estevez, Lecocq & Stein 2019, *A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem*).
//! - What goes straight through a pane is neither lost nor dimmed.

use super::{Bsdf, BsdfSample, Drawn};
use crate::media::Interface;
use crate::mis::Density;
use crate::texture::TexturePoint;
use etalon_optics::{Frame, Lanes, Vec3};
use etalon_scene::Terminator;
use std::borrow::Cow;

/// A surface point as scattering sees it.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    /// Unit normal of the surface itself, on its own outward side.
    pub normal: Vec3<f64>,
    /// Unit normal to scatter around, on the same side, where it is another one.
    bent: Option<Vec3<f64>>,
    /// What a map that loses light has changed.
    unmapped: Option<Unmapped>,
    /// Texture coordinates; 0 on a surface without.
    pub uv: [f64; 2],
    /// The colour between the vertices around; white on a surface without.
    colour: [f64; 3],
    /// The axis of a polarising sheet; 0 on other surfaces.
    pub axis: Vec3<f64>,
    /// The unit direction of growing u, for materials with a grain; 0 where there is none.
    tangent: Vec3<f64>,
    /// Whether v grows to the right of it, seen from outside.
    mirrored: bool,
    /// The media on both sides, where the place decides them and not the material.
    media: Option<Interface<'a>>,
}

/// The normal before a map, and how much the map dims grazing light.
#[derive(Clone, Copy, Debug)]
struct Unmapped {
    normal: Vec3<f64>,
    /// a of the shadow: 0 dims nothing.
    dimming: f64,
}

impl<'a> Shading<'a> {
    /// Of a surface that is what it looks like, without texture coordinates.
    pub fn flat(normal: Vec3<f64>) -> Self {
        let none = Vec3::new(0.0, 0.0, 0.0);
        Self {
            normal,
            bent: None,
            unmapped: None,
            uv: [0.0; 2],
            colour: [1.0; 3],
            axis: none,
            tangent: none,
            mirrored: false,
            media: None,
        }
    }

    /// The same with texture coordinates.
    #[must_use]
    pub fn with_uv(self, uv: [f64; 2]) -> Self {
        Self { uv, ..self }
    }

    /// The same with the colour between the vertices around.
    #[must_use]
    pub(crate) fn with_colour(self, colour: [f64; 3]) -> Self {
        Self { colour, ..self }
    }

    /// The place as textures see it.
    #[inline]
    pub(crate) fn texture_point(&self) -> TexturePoint {
        TexturePoint { uv: self.uv, colour: self.colour }
    }

    /// The same with the axis of a polarising sheet.
    #[must_use]
    pub fn with_axis(self, axis: Vec3<f64>) -> Self {
        Self { axis, ..self }
    }

    /// The same with the directions in which the point moves with u and with v, of any length.
    #[must_use]
    pub fn with_tangents(self, [u, v]: [Vec3<f64>; 2]) -> Self {
        let mirrored = self.normal.cross(u).dot(v) < 0.0;
        Self { tangent: u.normalized(), mirrored, ..self }
    }

    /// The unit tangent at right angles to the normal `n`, which is on the outward side, turned from growing u toward growing v by an
    /// angle of this cosine and sine. Where u has no direction, as at the pole of a sphere, any tangent stands for it.
    pub(super) fn rotated_tangent(&self, n: Vec3<f64>, [cos, sin]: [f64; 2]) -> Vec3<f64> {
        let tangent = self.tangent - n * n.dot(self.tangent);
        // Along the normal but for rounding it has no direction.
        let along_u = match tangent.length_squared() > f64::EPSILON {
            true => tangent.normalized(),
            false => Frame::from_normal(n).s,
        };
        let left = n.cross(along_u);
        (along_u * cos + left * if self.mirrored { -sin } else { sin }).normalized()
    }

    /// The same between two media.
    #[must_use]
    pub(crate) fn between(self, media: Option<Interface<'a>>) -> Self {
        Self { media, ..self }
    }

    /// The media on both sides, where the place decides them.
    pub(super) fn media(&self) -> Option<Interface<'a>> {
        self.media
    }

    /// The same with a unit vector to scatter around; one on the other side of the surface is turned around.
    #[must_use]
    pub fn bent_to(self, shading_normal: Vec3<f64>) -> Self {
        let cos = shading_normal.dot(self.normal);
        let turned = if cos < 0.0 { -shading_normal } else { shading_normal };
        // Along the surface it has no sides.
        Self { bent: (cos != 0.0 && turned != self.normal).then_some(turned), ..self }
    }

    /// The same with the unit normal that a map makes of the one to scatter around.
    #[must_use]
    pub(crate) fn mapped_to(self, normal: Vec3<f64>, terminator: Terminator) -> Self {
        let (before, bent) = (self.shading_normal(), self.bent_to(normal));
        let dimming = match terminator {
            Terminator::Mirrored => return bent,
            Terminator::Lost => 0.0,
            Terminator::Shadowed => (0.125 * tan_squared(before.dot(bent.shading_normal()))).clamp(0.0, 1.0),
        };
        Self { unmapped: Some(Unmapped { normal: before, dimming }), ..bent }
    }

    /// The unit normal to scatter around.
    pub fn shading_normal(&self) -> Vec3<f64> {
        self.bent.unwrap_or(self.normal)
    }

    pub(crate) fn is_bent(&self) -> bool {
        self.bent.is_some()
    }

    /// The mirror image of a direction in the surface.
    fn mirrored(&self, d: Vec3<f64>) -> Vec3<f64> {
        (d - self.normal * (2.0 * self.normal.dot(d))).renormalized()
    }

    /// The viewer on its own side of the shading normal's horizon (rule 3).
    pub(super) fn viewer(&self, wo: Vec3<f64>) -> Vec3<f64> {
        let n = self.horizon();
        let cos = n.dot(wo);
        if cos * self.normal.dot(wo) < 0.0 { (wo - n * (2.0 * cos)).renormalized() } else { wo }
    }

    /// Whether the BSDF may scatter to `d` in the name of a direction on the side of `wi` (rule 4).
    fn belongs(&self, d: Vec3<f64>, wi: Vec3<f64>) -> bool {
        self.horizon().dot(d) * self.normal.dot(wi) > 0.0
    }

    /// The normal whose horizon rules 3 and 4 ask for.
    fn horizon(&self) -> Vec3<f64> {
        self.unmapped.map_or_else(|| self.shading_normal(), |unmapped| unmapped.normal)
    }

    /// Whether a map that loses light changes the side that a direction is on.
    fn changes_side(&self, d: Vec3<f64>) -> bool {
        self.unmapped.is_some_and(|unmapped| unmapped.normal.dot(d) * self.shading_normal().dot(d) <= 0.0)
    }

    /// The same as a viewer on its own side of the horizon sees it: no map that loses light changes the viewer's side.
    #[inline]
    pub(super) fn seen_by(&self, viewer: Vec3<f64>) -> Cow<'_, Self> {
        if self.changes_side(viewer) { Cow::Owned(self.turned()) } else { Cow::Borrowed(self) }
    }

    /// The same with the normal of a map that loses light turned by half a turn about the one before.
    fn turned(self) -> Self {
        let (n, horizon) = (self.shading_normal(), self.horizon());
        Self { bent: Some((horizon * (2.0 * horizon.dot(n)) - n).renormalized()), ..self }
    }

    /// The share of light from a direction that a map leaves.
    fn share_left(&self, wi: Vec3<f64>) -> f64 {
        match self.unmapped {
            Some(_) if self.changes_side(wi) => 0.0,
            Some(Unmapped { normal, dimming }) if dimming > 0.0 => {
                2.0 / (1.0 + (1.0 + dimming * tan_squared(normal.dot(wi))).sqrt())
            }
            _ => 1.0,
        }
    }

    /// The same of light that a surface scatters to a viewer: what goes straight through a pane is neither lost nor dimmed.
    fn share_left_by(&self, bsdf: &Bsdf, viewer: Vec3<f64>, wi: Vec3<f64>) -> f64 {
        let n = self.shading_normal();
        if bsdf.is_pane() && n.dot(viewer) * n.dot(wi) < 0.0 { 1.0 } else { self.share_left(wi) }
    }
}

/// tan² of the angle of a cosine.
fn tan_squared(cos: f64) -> f64 {
    (1.0 / (cos * cos) - 1.0).max(0.0)
}

/// [`Bsdf::eval`] around a bent normal.
pub(super) fn eval<const N: usize>(
    bsdf: &Bsdf,
    lambda_nm: &Lanes<f64, N>,
    at: &Shading<'_>,
    wo: Vec3<f64>,
    wi: Vec3<f64>,
) -> (Lanes<f64, N>, Lanes<f64, N>) {
    let viewer = at.viewer(wo);
    let at = &*at.seen_by(viewer);
    let n = at.shading_normal();
    let mut sum = (Lanes::ZERO, Lanes::ZERO);
    for direction in [wi, at.mirrored(wi)] {
        let left = at.share_left(direction);
        if left > 0.0 && at.belongs(direction, wi) {
            let (f_cos, density) = bsdf.eval_around(lambda_nm, n, at, viewer, direction);
            sum = (sum.0 + f_cos * left, sum.1 + density);
        }
    }
    sum
}

/// The directions as the BSDF takes them, of two around a bent normal: of those that `wi` may stand for the first.
pub(super) fn as_scattered(at: &Shading<'_>, wo: Vec3<f64>, wi: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>) {
    (at.viewer(wo), if at.belongs(wi, wi) { wi } else { at.mirrored(wi) })
}

/// [`Bsdf::sample`] around a bent normal.
pub(super) fn sample<const N: usize>(
    bsdf: &Bsdf,
    lambda_nm: &Lanes<f64, N>,
    at: &Shading<'_>,
    wo: Vec3<f64>,
    u: [f64; 3],
) -> Option<BsdfSample<N>> {
    let viewer = at.viewer(wo);
    let at = &*at.seen_by(viewer);
    let n = at.shading_normal();
    let drawn = bsdf.draw_around(lambda_nm, n, at, viewer, u)?;
    let meant = drawn.wi();
    let left = at.share_left_by(bsdf, viewer, meant);
    if left == 0.0 {
        return None;
    }
    // The side that the BSDF meant is the one that the triangle gives it.
    let wi = if at.normal.dot(meant) * n.dot(meant) < 0.0 { at.mirrored(meant) } else { meant };
    if at.normal.dot(wi) == 0.0 {
        return None;
    }
    match drawn {
        Drawn::Sample(sample @ BsdfSample { density: Density::Delta, .. }) => {
            Some(BsdfSample { wi, weight: sample.weight * left, ..sample })
        }
        Drawn::Sample(BsdfSample { eta, .. }) | Drawn::Direction(_, eta) => {
            // Both directions that this one may stand for.
            let (f_cos, density) = eval(bsdf, lambda_nm, at, wo, wi);
            BsdfSample::scattered(wi, f_cos, density, eta)
        }
    }
}

/// [`Bsdf::sample_viewer`] around a bent normal.
///
/// [`sample`] takes a viewer to a direction in three steps: rule 3, reflection or refraction about the shading normal n, rule 4. Each is undone, from
/// the last. Mirror images may have come from either of two directions; one is drawn, and counts for both. All steps but refraction keep solid
/// angles, and refraction changes them by n·ω and n². Power is measured by the triangle's own normal g (Veach 1997, §5.3). So it is multiplied by
/// |n·ωᵢ| |g·ωₒ| / (|n·ωₒ| |g·ωᵢ|), with n·ω of the directions as the BSDF takes them.
pub(super) fn sample_viewer<const N: usize>(
    bsdf: &Bsdf,
    lambda_nm: &Lanes<f64, N>,
    at: &Shading<'_>,
    wi: Vec3<f64>,
    u: [f64; 3],
    [u_meant, u_viewer]: [f64; 2],
) -> Option<(BsdfSample<N>, f64)> {
    let meant = [wi, at.mirrored(wi)].map(|direction| at.belongs(direction, wi).then_some(direction));
    let (meant, ways) = one_of(meant, u_meant)?;
    // Around the normal that such a viewer sees.
    let back = |n: Vec3<f64>| {
        let around = Shading { bent: Some(n), ..*at };
        let Drawn::Sample(seen @ BsdfSample { density: Density::Delta, .. }) =
            bsdf.draw_around(lambda_nm, n, &around, meant, u)?
        else {
            unreachable!("smooth surfaces have one way back");
        };
        (at.seen_by(seen.wi).shading_normal() == n).then_some((seen, n))
    };
    let turned = at.unmapped.map(|_| at.turned().shading_normal());
    let backs = [back(at.shading_normal()), turned.and_then(back)];
    let (u_normal, u_viewer) = match at.unmapped {
        Some(_) if u_viewer < 0.5 => (0.0, 2.0 * u_viewer),
        Some(_) => (1.0, 2.0 * u_viewer - 1.0),
        None => (0.0, u_viewer),
    };
    let ((mut seen, n), normals) = one_of(backs, u_normal)?;
    let (viewer, horizon) = (seen.wi, at.horizon());
    let left = Shading { bent: Some(n), ..*at }.share_left_by(bsdf, viewer, meant);
    let below = (viewer - horizon * (2.0 * horizon.dot(viewer))).renormalized();
    let viewers = [viewer, below].map(|wo| at.belongs(viewer, wo).then_some(wo));
    let (wo, more_ways) = one_of(viewers, u_viewer)?;
    seen.wi = wo;
    let [g_i, g_o] = [wi, wo].map(|direction| at.normal.dot(direction).abs());
    let [n_i, n_o] = [meant, viewer].map(|direction| n.dot(direction).abs());
    let power = ways * more_ways * (n_i * g_o) / (n_o * g_i);
    power.is_finite().then_some((seen, power * normals * left))
}

/// One of those that there are, and how many there are.
fn one_of<T>(directions: [Option<T>; 2], u: f64) -> Option<(T, f64)> {
    match directions {
        [Some(first), Some(second)] => Some((if u < 0.5 { first } else { second }, 2.0)),
        [only, None] | [None, only] => Some((only?, 1.0)),
    }
}
