//! Measured BRDFs: the tables of [`MeasuredBrdf`](etalon_scene::MeasuredBrdf), seen and lit from any two directions.
//!
//! # Formula
//!
//! With h = (o + i)/|o + i|, f(o, i) cos θ_i = S(V⁻¹(q), λ) D(q)/(4 σ(p)). Here p is the place of the direction `o` to the viewer in the unit
//! square, and q the place of h: x = √(2θ/π), y = (φ + π)/2π. A direction is drawn as published: two numbers go through the warp by luminance
//! and then through the warp V by visible normals. The result is q, and `i` is the mirror image of `o` at h. The density of `i` is
//!
//! p_luminance(V⁻¹(q)) p_V(q) / (2π² x sin θ_h · 4 (o·h)).
//!
//! The first factor of the denominator is dω_h/dx dy, the second is dω_i/dω_h.
//!
//! # Parameters and conventions
//!
//! - The viewer takes the place of the measured light, as in the readers by the authors of the format: paths begin at the viewer, and light
//!   goes both ways alike. Data need not be reciprocal; what is asked is always this order.
//! - x of the tables is the direction of growing u, turned by an angle. Seen from outside y lies to its left, also where v is mirrored. On the
//!   back y lies where it does on the front. Of an isotropic material x is the direction to the viewer itself.
//! - The azimuth of a viewer outside of the file's is brought into them by its symmetry, and that of the light with it.
//! - If light is found nowhere by the warps, there is none: where the density is 0, so is f.
//! - The density has a pole along the normal, where x sin θ_h is 0. The pole can be integrated. Exactly there, the density is that of a facet
//!   2⁻⁵³ rad away.
//! - Measured is intensity alone: the surface depolarises.
//!
//! # Source
//!
//! J. Dupuy & W. Jakob 2018, *An Adaptive Parameterization for Efficient Material Acquisition and Rendering*, ACM Transactions on Graphics
//! 37(6), section 4; W. Jakob, *Mitsuba 3*, plugin `measured`, for the order of directions and for the azimuths of anisotropic files.

use super::{Drawn, Properties, Shading};
use etalon_optics::{Frame, Lanes, Real, Vec3, angle::atan2_turns};
use etalon_scene::{MeasuredSurface, Slices, Symmetry};
use std::f64::consts::{PI, TAU};

/// A measured surface, alike on both sides.
#[derive(Clone, Debug)]
pub struct Measured {
    surface: MeasuredSurface,
    /// Cosine and sine of the angle of its x axis from growing u.
    rotation: [f64; 2],
}

/// A viewer in the frame of the tables.
struct Viewer {
    frame: Frame<f64>,
    /// Signs by which the frame's x, y and z become those of the tables.
    signs: Vec3<f64>,
    /// The direction, z > 0.
    wo: Vec3<f64>,
    /// Its place in the square.
    place: [f64; 2],
    /// The slices of the tables for it.
    slices: Slices,
}

impl Measured {
    /// A surface of a scene.
    pub fn new(surface: &MeasuredSurface) -> Self {
        let (sin, cos) = surface.rotation_rad.sin_cos();
        Self { surface: surface.clone(), rotation: [cos, sin] }
    }

    /// See [`Properties`].
    pub(super) fn properties(surface: &MeasuredSurface) -> Properties {
        Properties { dark: surface.brdf.is_zero(), takes_tangents: !surface.is_isotropic(), ..Properties::SOLID_ANGLE }
    }

    /// The viewer at a point; `None` exactly along the surface.
    fn viewer(&self, n: Vec3<f64>, at: &Shading<'_>, wo: Vec3<f64>) -> Option<Viewer> {
        let brdf = &self.surface.brdf;
        let s = match brdf.symmetry() {
            Symmetry::Isotropic => {
                Some(wo - n * n.dot(wo)).filter(|along| along.length_squared() > f64::EPSILON * f64::EPSILON)
            }
            _ => Some(at.rotated_tangent(n, self.rotation)),
        };
        let frame = match s {
            Some(s) => {
                let s = s.normalized();
                Frame { s, t: n.cross(s), n }
            }
            None => Frame::from_normal(n),
        };
        let local = frame.to_local(wo);
        let z = if local.z < 0.0 { -1.0 } else { 1.0 };
        // Into the azimuths of the tables, whose ends are −0 and −½ turn.
        let away = |component: f64| if component.is_sign_negative() { 1.0 } else { -1.0 };
        let signs = match brdf.symmetry() {
            Symmetry::Isotropic | Symmetry::None => Vec3::new(1.0, 1.0, z),
            Symmetry::HalfTurn => Vec3::new(away(local.y), away(local.y), z),
            Symmetry::Mirrors => Vec3::new(away(local.x), away(local.y), z),
        };
        let wo = signed(local, signs);
        let turns = match brdf.symmetry() {
            Symmetry::Isotropic => 0.0,
            _ => atan2_turns(wo.y, wo.x),
        };
        let theta = polar_turns(wo);
        let slices = brdf.light(TAU * theta, TAU * turns);
        (wo.z > 0.0).then(|| Viewer { frame, signs, wo, place: [across(theta), turns + 0.5], slices })
    }

    pub(super) fn eval<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
    ) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let seen = self.viewer(n, at, wo).and_then(|viewer| self.seen(lambda_nm, &viewer, viewer.local(wi)));
        seen.map_or((Lanes::ZERO, Lanes::ZERO), |(f_cos, density)| (f_cos, Lanes::splat(density)))
    }

    /// f cos θ_i and the density for light from a direction of the tables' frame; `None` where there is neither.
    fn seen<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        viewer: &Viewer,
        wi: Vec3<f64>,
    ) -> Option<(Lanes<f64, N>, f64)> {
        if wi.z <= 0.0 {
            return None;
        }
        let (brdf, slices) = (&self.surface.brdf, &viewer.slices);
        let h = (viewer.wo + wi).normalized();
        let theta = polar_turns(h);
        let facet = [across(theta), atan2_turns(h.y, h.x) + 0.5];
        let (place, of_normals) = brdf.vndf().invert(slices, facet);
        let density = of_normals * brdf.luminance().density(slices, place) / turned(theta, h, viewer.wo.dot(h));
        // It is infinite where both directions lie along the surface, opposite to each other.
        if !(density > 0.0 && density.is_finite()) {
            return None;
        }
        let facets = brdf.facets(facet, viewer.place)?;
        let nm = match self.surface.at_nm {
            Some(nm) => [nm; N],
            None => lambda_nm.0,
        };
        Some((Lanes(brdf.spectra(slices, place, nm)) * facets, density))
    }

    pub(super) fn draw<const N: usize>(
        &self,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: [f64; 2],
    ) -> Option<Drawn<N>> {
        let viewer = self.viewer(n, at, wo)?;
        let brdf = &self.surface.brdf;
        let [x, y] = brdf.vndf().sample(&viewer.slices, brdf.luminance().sample(&viewer.slices, u));
        let (sin, cos) = f64::sin_cos_turns(0.25 * x * x);
        // Azimuths count from −½ turn.
        let (sin_phi, cos_phi) = f64::sin_cos_turns(y);
        let h = Vec3::new(-sin * cos_phi, -sin * sin_phi, cos);
        let wi = viewer.world(viewer.wo.reflected_about(h));
        Drawn::reflected(wi, viewer.local(wi).z)
    }
}

impl Viewer {
    /// A direction of the world in the frame of the tables.
    fn local(&self, w: Vec3<f64>) -> Vec3<f64> {
        signed(self.frame.to_local(w), self.signs)
    }

    /// A direction of the tables' frame in the world, brought back to unit length.
    fn world(&self, w: Vec3<f64>) -> Vec3<f64> {
        self.frame.to_world(signed(w, self.signs)).renormalized()
    }
}

fn signed(w: Vec3<f64>, signs: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(w.x * signs.x, w.y * signs.y, w.z * signs.z)
}

/// The angle of a direction from z, turns.
fn polar_turns(w: Vec3<f64>) -> f64 {
    atan2_turns((w.x * w.x + w.y * w.y).sqrt(), w.z)
}

/// √(2θ/π) of an angle in turns up to ¼, which rounding may pass.
fn across(theta_turns: f64) -> f64 {
    (2.0 * theta_turns.sqrt()).min(1.0)
}

/// dω_i/dx dy of the facet `h` at an angle from the normal, for a viewer at this cosine to it.
fn turned(theta_turns: f64, h: Vec3<f64>, cos: f64) -> f64 {
    // As far from the pole as rounding tells directions apart.
    let least = 0.5 * f64::EPSILON;
    let (sin, x) = ((h.x * h.x + h.y * h.y).sqrt().max(least), across(theta_turns.max(least / TAU)));
    2.0 * PI * PI * x * sin * 4.0 * cos
}
