//! What surfaces do to the polarisation of light: the Mueller matrix of each BSDF over its first element, which is the BSDF
//! itself.
//!
//! | surface | matrix |
//! |---|---|
//! | smooth interface, metal, mirror | Fresnel's, in the plane of incidence |
//! | facets of a rough one | the same at the facet that turns one direction into the other: masking is no matter of polarisation |
//! | light that met several facets | forgets its polarisation, but for what lets it in and out ([`PolarisedLoss`]) |
//! | thin pane | the orders of reflection between its faces, added as Stokes vectors |
//! | plastic | its coat's, and light that its ground depolarised, which the coat polarises on its way out |
//! | polariser, retarder | by its axis, whatever the plane of incidence |
//! | diffuse surface | depolarises |
//! | blend | the sum of its parts, each by its share of the light |
//!
//! Around a shading normal ([`Shading`]) the matrix is that of the directions as the BSDF takes them, in the frame of the real
//! ones: polarisation follows the shading, and stays physical.

use super::albedo::{NODES, node};
use super::microfacet::{Facet, Ggx, mean_over_facets};
use super::{Bsdf, Shading, shading};
use crate::polarisation::across;
use crate::polarisation::mueller::{self, DEPOLARISER, IDENTITY, Matrix, Mueller};
use etalon_optics::{Lanes, Vec3};
use rayon::prelude::*;

/// How a direction came about that a matrix is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// By one of the directions that alone carry light, with this number for the choice of lobe.
    Delta(f64),
    /// As one of many: the whole part without deltas counts.
    SolidAngle,
}

impl Bsdf {
    /// What it does to the Stokes vector of light that comes along −`wi` and leaves along `wo`, over its first element; `None`
    /// depolarises.
    pub fn mueller<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        wi: Vec3<f64>,
        lobe: Lobe,
    ) -> Option<Mueller<N>> {
        let x = match self {
            Self::PolarisingSheet(sheet) => sheet.x(at, wo),
            _ => plane_of_incidence(at, wo, wi, lobe),
        };
        let rows = |matrices| Mueller::of(matrices, x);
        match at.is_bent() {
            false => self.mueller_around(lambda_nm, at.normal, at, (wo, wi, x), lobe).map(rows),
            true => {
                let (viewer, direction) = shading::as_scattered(at, wo, wi);
                let plane = plane_of_incidence(at, viewer, direction, lobe);
                let n = at.shading_normal();
                self.mueller_around(lambda_nm, n, at, (viewer, direction, plane), lobe).map(rows)
            }
        }
    }

    /// [`Bsdf::mueller`] with `n` for the only normal, in the frames of `x`.
    pub(super) fn mueller_around<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        (wo, wi, x): (Vec3<f64>, Vec3<f64>, Vec3<f64>),
        lobe: Lobe,
    ) -> Option<[Matrix; N]> {
        // Rounding may carry the product of two unit vectors past 1.
        let cos = n.dot(wo).abs().min(1.0);
        match self {
            Self::Mirror(_) => Some([mueller::MIRROR; N]),
            Self::Conductor(metal) => Some(metal.mueller(lambda_nm, at.uv, cos, at.media())),
            Self::Dielectric(glass) => {
                let side = (n.dot(wo) > 0.0, n.dot(wo) * n.dot(wi) > 0.0);
                Some(lambda_nm.0.map(|nm| glass.mueller(nm, cos, side, at.media())))
            }
            Self::ThinDielectric(pane) => {
                let reflects = n.dot(wo) * n.dot(wi) > 0.0;
                Some(lambda_nm.0.map(|nm| pane.mueller(nm, cos, reflects)))
            }
            Self::PolarisingSheet(sheet) => Some(lambda_nm.0.map(|nm| sheet.mueller(nm))),
            Self::RoughConductor(metal) => metal.mueller(lambda_nm, n, at.uv, wo, wi),
            Self::RoughDielectric(_) if lobe != Lobe::SolidAngle => Some([IDENTITY; N]),
            Self::RoughDielectric(glass) => glass.mueller(lambda_nm, n, at.media(), (wo, wi, x)),
            Self::Plastic(plastic) => plastic.mueller(lambda_nm, n, at.uv, (wo, wi, x), lobe),
            Self::Blend(blend) => blend.mueller(lambda_nm, n, at, (wo, wi, x), lobe),
            Self::Lambert(_) | Self::OrenNayar(_) | Self::Black => None,
        }
    }

    /// Makes the tables that [`Bsdf::mueller`] needs and nothing else does.
    pub fn prepare_polarisation(&mut self) {
        match self {
            Self::RoughDielectric(glass) => glass.prepare_polarisation(),
            Self::Plastic(plastic) => plastic.prepare_polarisation(),
            Self::Blend(blend) => blend.prepare_polarisation(),
            Self::Lambert(_)
            | Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::RoughConductor(_)
            | Self::OrenNayar(_)
            | Self::ThinDielectric(_)
            | Self::PolarisingSheet(_)
            | Self::Black => {}
        }
    }
}

/// A vector at right angles to the plane in which light is turned from −`wi` to `wo`.
fn plane_of_incidence(at: &Shading<'_>, wo: Vec3<f64>, wi: Vec3<f64>, lobe: Lobe) -> Vec3<f64> {
    let (of_turn, of_surface) = (wo.cross(wi), at.shading_normal().cross(wo));
    // A facet decides the plane where there are facets. Where the surface itself does, light may go straight on.
    let straight_on = f64::EPSILON;
    match lobe {
        Lobe::SolidAngle if of_turn.length_squared() > straight_on * straight_on => of_turn,
        Lobe::Delta(_) if at.is_bent() && of_turn.length_squared() > straight_on => of_turn,
        // Along the normal every plane is one of incidence.
        _ => across(of_surface, wo),
    }
}

/// What single scattering loses of polarised light, for the shares of it that swing across and along the plane of incidence of
/// the surface: ℓ₁/ℓ₀, where a Stokes vector S loses ℓ₀S₀ + ℓ₁S₁.
///
/// By energy conservation alone: of each state what is not scattered is lost. Light that met several facets leaves by the loss's
/// own diattenuation, and comes in by it: then every state keeps its energy, and a white furnace stays white and unpolarised.
#[derive(Clone, Debug)]
pub(super) struct PolarisedLoss {
    /// The relative index of the first row, and what one row more adds; 0 for a single row.
    eta: f64,
    step: f64,
    rows: Vec<[f64; NODES]>,
}

impl PolarisedLoss {
    /// Of facets that lose `loss` of each, (ℓ₀, ℓ₁) with s and p those of the facet, for relative indices within `eta`.
    pub(super) fn new(eta: [f64; 2], ggx: &Ggx, loss: impl Fn(&Facet, f64) -> [f64; 2] + Sync) -> Self {
        let count = if eta[0] == eta[1] { 1 } else { 2 };
        let step = eta[1] - eta[0];
        let row = |r: usize| {
            let eta = eta[0] + step * r as f64;
            let at = |i: usize| {
                let mu = node(i).max(1e-6);
                // Seen from either side, so cut for the denser one.
                let mean = |of: &dyn Fn(&Facet) -> f64| mean_over_facets(ggx, mu, Some(eta.min(1.0 / eta)), of);
                let lost = mean(&|facet| loss(facet, eta)[0]);
                let turned = mean(&|facet| loss(facet, eta)[1] * cos_of_twice_the_turn(facet));
                if lost > 0.0 { (turned / lost).clamp(-1.0, 1.0) } else { 0.0 }
            };
            let values: Vec<f64> = (0..NODES).into_par_iter().map(at).collect();
            std::array::from_fn(|i| values[i])
        };
        Self { eta: eta[0], step, rows: (0..count).map(row).collect() }
    }

    /// ℓ₁/ℓ₀ at the cosine `mu`.
    pub(super) fn eval(&self, mu: f64, eta: f64) -> f64 {
        let i = ((mu.sqrt() * (NODES - 1) as f64) as usize).min(NODES - 2);
        let share = ((mu - node(i)) / (node(i + 1) - node(i))).min(1.0);
        let along = |row: &[f64; NODES]| row[i] + share * (row[i + 1] - row[i]);
        match self.rows.as_slice() {
            [first, second] => {
                let between = ((eta - self.eta) / self.step).clamp(0.0, 1.0);
                (1.0 - between) * along(first) + between * along(second)
            }
            rows => along(&rows[0]),
        }
    }
}

/// cos 2φ, φ the angle between the facet's plane of incidence and that of the surface, for a direction in the xz plane.
fn cos_of_twice_the_turn(facet: &Facet) -> f64 {
    // The surface's s is y; the facet's is at right angles to the direction and the facet's normal.
    let s = facet.wo.cross(facet.h);
    let squared = s.length_squared();
    // Met along its normal a facet treats s and p alike.
    if squared > 0.0 { 2.0 * s.y * s.y / squared - 1.0 } else { 0.0 }
}

/// The matrix of light that a surface of normal `n` lets in and out with the diattenuations `a_i` and `a_o` and forgets within.
pub(super) fn forgotten(n: Vec3<f64>, (wo, wi, x): (Vec3<f64>, Vec3<f64>, Vec3<f64>), a_o: f64, a_i: f64) -> Matrix {
    if a_o == 0.0 && a_i == 0.0 {
        return DEPOLARISER;
    }
    let vector = |a: f64, w: Vec3<f64>, k: Vec3<f64>| mueller::linear(a, across(n.cross(w), w), k, across(x, w));
    mueller::forgotten(vector(a_o, wo, wo), vector(a_i, wi, -wi))
}
