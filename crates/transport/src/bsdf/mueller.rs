//! What surfaces do to the polarisation of light: the Mueller matrix of each BSDF over its first element, which is the BSDF
//! itself.
//!
//! | surface | matrix |
//! |---|---|
//! | smooth interface, metal, mirror | Fresnel's, in the plane of incidence |
//! | facets of a rough one | the same at the facet that turns one direction into the other: masking is no matter of polarisation |
//! | light that met several facets | forgets its polarisation, but for what lets it in and out ([`PolarisedLoss`]) |
//! | thin pane | the orders of reflection between its faces, added as Stokes vectors |
//! | thin film | that of the stack's complex amplitudes, in place of the bare interface's |
//! | plastic | its coat's, and light that its ground depolarised, which the coat polarises on its way out |
//! | polariser, retarder | by its axis, whatever the plane of incidence |
//! | diffuse surface, translucent sheet, grating, measured or principled surface | depolarises |
//! | blend | the sum of its parts, each by its share of the light |
//!
//! Around a shading normal ([`Shading`]) the matrix is that of the directions as the BSDF takes them, in the frame of the real
//! ones: polarisation follows the shading, and stays physical.

use super::albedo::{Azimuths, NODES, all_turns, node};
use super::microfacet::{Distribution, Facet, mean_over_facets};
use super::table_store::{SharedTables, Table, Tabulated};
use super::{Bsdf, Shading, shading};
use crate::polarisation::across;
use crate::polarisation::mueller::{self, DEPOLARISER, IDENTITY, Matrix, Mueller};
use etalon_optics::{Lanes, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

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
        let at = &at.seen_by(at.viewer(wo));
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
            Self::Conductor(metal) => Some(metal.mueller(lambda_nm, at.texture_point(), cos, at.media())),
            Self::Dielectric(glass) => {
                let side = (n.dot(wo) > 0.0, n.dot(wo) * n.dot(wi) > 0.0);
                Some(lambda_nm.0.map(|nm| glass.mueller(nm, (cos, at.uv), side, at.media())))
            }
            Self::ThinDielectric(pane) => {
                let reflects = n.dot(wo) * n.dot(wi) > 0.0;
                Some(lambda_nm.0.map(|nm| pane.mueller(nm, (cos, at.uv), reflects)))
            }
            Self::PolarisingSheet(sheet) => Some(lambda_nm.0.map(|nm| sheet.mueller(nm))),
            Self::RoughConductor(metal) => metal.mueller(lambda_nm, n, at, wo, wi),
            Self::RoughDielectric(_) if lobe != Lobe::SolidAngle => Some([IDENTITY; N]),
            Self::RoughDielectric(glass) => glass.mueller(lambda_nm, n, at, (wo, wi, x)),
            Self::Plastic(plastic) => plastic.mueller(lambda_nm, n, at, (wo, wi, x), lobe),
            Self::Blend(blend) => blend.mueller(lambda_nm, n, at, (wo, wi, x), lobe),
            Self::TwoSided(both) => both.mueller(lambda_nm, n, at, (wo, wi, x), lobe),
            Self::Tinted(tinted) => tinted.mueller(lambda_nm, n, at, (wo, wi, x), lobe),
            Self::Lambert(_)
            | Self::OrenNayar(_)
            | Self::Translucent(_)
            | Self::Grating(_)
            | Self::Fluorescent(_)
            | Self::Measured(_)
            | Self::Principled(_)
            | Self::Black => None,
        }
    }

    /// Makes the tables that [`Bsdf::mueller`] needs and nothing else does.
    pub fn prepare_polarisation(&mut self) {
        match self {
            Self::RoughDielectric(glass) => glass.prepare_polarisation(),
            Self::Plastic(plastic) => plastic.prepare_polarisation(),
            Self::Blend(blend) => blend.prepare_polarisation(),
            Self::TwoSided(both) => both.prepare_polarisation(),
            Self::Tinted(tinted) => tinted.bsdf_mut().prepare_polarisation(),
            Self::Lambert(_)
            | Self::Mirror(_)
            | Self::Conductor(_)
            | Self::Dielectric(_)
            | Self::RoughConductor(_)
            | Self::OrenNayar(_)
            | Self::Translucent(_)
            | Self::ThinDielectric(_)
            | Self::PolarisingSheet(_)
            | Self::Grating(_)
            | Self::Fluorescent(_)
            | Self::Measured(_)
            | Self::Principled(_)
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

/// What single scattering loses of polarised light: (ℓ₁, ℓ₂)/ℓ₀, where a Stokes vector S loses ℓ₀S₀ + ℓ₁S₁ + ℓ₂S₂. S₁ counts the light that
/// swings across the plane of incidence of the surface, S₂ that at 45°, turned from there as seen by the light that leaves. Facets of one
/// width treat both senses of 45° alike: ℓ₂ = 0.
///
/// By energy conservation alone: of each state what is not scattered is lost. Light that met several facets leaves by the loss's
/// own diattenuation, and comes in by it: then every state keeps its energy, and a white furnace stays white and unpolarised.
#[derive(Clone, Debug)]
pub(super) struct PolarisedLoss {
    /// The relative index of the first row, and what one row more adds; 0 for a single row.
    eta: f64,
    step: f64,
    azimuths: Azimuths,
    /// At each node in azimuth.
    rows: Vec<Vec<[[f64; 2]; NODES]>>,
}

impl PolarisedLoss {
    /// The same as [`PolarisedLoss::new`], from where all tables are kept; `loss` follows from `of`.
    pub(super) fn shared(
        of: Tabulated,
        eta: [f64; 2],
        distribution: &Distribution,
        loss: impl Fn(&Facet, f64) -> [f64; 2] + Sync,
    ) -> Arc<Self> {
        static KNOWN: SharedTables<PolarisedLoss> = SharedTables::new();
        KNOWN.get(of, distribution, eta, || Self::new(eta, distribution, loss))
    }

    /// Of facets that lose `loss` of each, (ℓ₀, ℓ₁) with s and p those of the facet, for relative indices within `eta`.
    pub(super) fn new(
        eta: [f64; 2],
        distribution: &Distribution,
        loss: impl Fn(&Facet, f64) -> [f64; 2] + Sync,
    ) -> Self {
        let count = if eta[0] == eta[1] { 1 } else { 2 };
        let step = eta[1] - eta[0];
        let azimuths = Azimuths::of(distribution);
        let row = |r: usize| {
            let eta = eta[0] + step * r as f64;
            let at = |k: usize| {
                // Along the normal facets of two widths still prefer a state, by the azimuth from which that is reached.
                let steepest = if distribution.isotropic_alpha().is_some() { 1.0 } else { 1.0 - 1e-9 };
                let wo = azimuths.direction(node(k % NODES).clamp(1e-6, steepest), (k / NODES) as f64);
                // Seen from either side, so cut for the denser one.
                let mean =
                    |of: &dyn Fn(&Facet) -> f64| mean_over_facets(distribution, wo, Some(eta.min(1.0 / eta)), of);
                let lost = mean(&|facet| loss(facet, eta)[0]);
                let turned = |component: usize| {
                    let turned = mean(&|facet| loss(facet, eta)[1] * of_twice_the_turn(facet)[component]);
                    if lost > 0.0 { (turned / lost).clamp(-1.0, 1.0) } else { 0.0 }
                };
                // Along an axis of the surface both senses of 45° are alike, too.
                let on_axis = [0, azimuths.count() - 1].contains(&(k / NODES));
                [turned(0), if on_axis { 0.0 } else { turned(1) }]
            };
            let values: Vec<[f64; 2]> = (0..azimuths.count() * NODES).into_par_iter().map(at).collect();
            values.chunks(NODES).map(|values| std::array::from_fn(|i| values[i])).collect()
        };
        Self { eta: eta[0], step, azimuths, rows: (0..count).map(row).collect() }
    }

    /// (ℓ₁, ℓ₂)/ℓ₀ in a direction on either side of the surface.
    pub(super) fn eval(&self, w: Vec3<f64>, eta: f64) -> [f64; 2] {
        // One quarter of azimuths is tabulated. Its mirror image, and what is seen from below, turn the other way.
        let senses = [1.0, if (w.x * w.y < 0.0) != (w.z < 0.0) { -1.0 } else { 1.0 }];
        [0, 1].map(|component| senses[component] * self.component(component, w, eta))
    }

    fn component(&self, component: usize, w: Vec3<f64>, eta: f64) -> f64 {
        let mu = w.z.abs();
        let i = ((mu.sqrt() * (NODES - 1) as f64) as usize).min(NODES - 2);
        let share = ((mu - node(i)) / (node(i + 1) - node(i))).min(1.0);
        let turn = self.azimuths.place(w);
        let along = |row: &Vec<[[f64; 2]; NODES]>| {
            let at = |turn: usize| {
                let [a, b] = [row[turn][i][component], row[turn][i + 1][component]];
                a + share * (b - a)
            };
            let first = at(turn.index);
            if turn.share == 0.0 { first } else { first + turn.share * (at(turn.index + 1) - first) }
        };
        match self.rows.as_slice() {
            [first, second] => {
                let between = ((eta - self.eta) / self.step).clamp(0.0, 1.0);
                (1.0 - between) * along(first) + between * along(second)
            }
            rows => along(&rows[0]),
        }
    }
}

impl Table for PolarisedLoss {
    const SORT: &'static str = "polarised-losses";

    fn to_numbers(&self) -> Vec<f64> {
        let rows = self.rows.iter().flat_map(|row| row.as_flattened().as_flattened());
        [self.eta, self.step].into_iter().chain(rows.copied()).collect()
    }

    fn from_numbers(numbers: &[f64], distribution: &Distribution) -> Option<Self> {
        let azimuths = Azimuths::of(distribution);
        let (&[eta, step], numbers) = numbers.split_first_chunk()?;
        let (pairs, []) = numbers.as_chunks() else { return None };
        let rows: Vec<_> =
            pairs.chunks(azimuths.count() * NODES).map(|row| all_turns(row, azimuths)).collect::<Option<_>>()?;
        // One row of a single index, or two.
        (1..=2).contains(&rows.len()).then_some(Self { eta, step, azimuths, rows })
    }
}

/// cos 2φ and sin 2φ, φ the angle of the facet's s from the surface's, seen by the light that leaves.
fn of_twice_the_turn(facet: &Facet) -> [f64; 2] {
    // The surface's s is at right angles to the direction and the surface's normal; the facet's to the direction and the facet's normal.
    let (wo, s) = (facet.wo, facet.wo.cross(facet.h));
    let (sin2, squared) = (wo.x * wo.x + wo.y * wo.y, s.length_squared());
    // Met along its normal a facet treats s and p alike.
    if squared == 0.0 {
        return [0.0; 2];
    }
    let across = match wo.y {
        0.0 => Vec3::new(0.0, 1.0, 0.0),
        _ => Vec3::new(-wo.y, wo.x, 0.0) * (1.0 / sin2.sqrt()),
    };
    let (cos, sin) = (s.dot(across), s.dot(wo.cross(across)));
    [2.0 * cos * cos / squared - 1.0, 2.0 * cos * sin / squared]
}

/// The matrix of light that a surface lets in and out with the diattenuations `a_i` and `a_o` and forgets within; `s` says which direction
/// is at right angles to the plane of incidence of one in the world.
pub(super) fn forgotten(
    s: impl Fn(Vec3<f64>) -> Vec3<f64>,
    (wo, wi, x): (Vec3<f64>, Vec3<f64>, Vec3<f64>),
    a_o: [f64; 2],
    a_i: [f64; 2],
) -> Matrix {
    if a_o == [0.0; 2] && a_i == [0.0; 2] {
        return DEPOLARISER;
    }
    let vector = |a: [f64; 2], w: Vec3<f64>, k: Vec3<f64>| mueller::linear(a, across(s(w), w), k, across(x, w));
    // Light that comes in sees 45° turned the other way.
    mueller::forgotten(vector(a_o, wo, wo), vector([a_i[0], -a_i[1]], wi, -wi))
}
