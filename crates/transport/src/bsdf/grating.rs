//! A diffraction grating: each order of each wavelength is one direction.
//!
//! With ĝ across the grooves, the parts along the surface of the directions toward viewer and light add up to mλ/Λ·ĝ (the grating equation, also
//! for light that does not lie across the grooves). It takes solid angles times cosines to equal ones, so the radiance of an order is its
//! efficiency times what arrives. An order whose direction would lie beneath the surface carries nothing.
//!
//! The order is drawn by its efficiency, the same at all wavelengths. In any but the 0th the hero alone goes on: other lanes' light would have gone
//! elsewhere, as behind dispersive glass. What a grating leaves is unpolarised: efficiencies say nothing of phases.

use super::{BsdfSample, Properties, Shading};
use crate::mis::Density;
use crate::texture::PathTexture;
use etalon_optics::{Lanes, Real, Vec3};
use etalon_scene::{Grating as Stated, Grooves};

/// A grating.
#[derive(Clone, Debug)]
pub struct Grating {
    reflectance: PathTexture,
    stated: Stated,
    efficiency: f64,
    /// Of the angle by which straight grooves are turned, cosine and sine.
    turned: [f64; 2],
}

impl Grating {
    /// A grating, whose efficiencies have a factor at each wavelength.
    pub fn new(reflectance: PathTexture, stated: Stated) -> Self {
        let turned = match stated.grooves {
            Grooves::Straight(rotation_rad) => [rotation_rad.cos(), rotation_rad.sin()],
            Grooves::Circles => [1.0, 0.0],
        };
        Self { reflectance, efficiency: stated.efficiency(), stated, turned }
    }

    /// See [`Properties`].
    pub(super) fn properties(grating: &Stated) -> Properties {
        let properties = if grating.transmits {
            Properties::sheet("a transmission grating")
        } else {
            Properties::mirror("a grating")
        };
        Properties { dark: grating.efficiency() == 0.0, takes_tangents: true, ..properties }
    }

    /// The unit vector across the grooves at a place, in the plane across the normal `n` on the outward side.
    fn across_grooves(&self, n: Vec3<f64>, at: &Shading<'_>) -> Vec3<f64> {
        let turned = match self.stated.grooves {
            Grooves::Straight(_) => self.turned,
            Grooves::Circles => {
                let [u, v] = at.uv.map(|coordinate| coordinate - 0.5);
                let length = (u * u + v * v).sqrt();
                if length > 0.0 { [u / length, v / length] } else { [1.0, 0.0] }
            }
        };
        at.rotated_tangent(n, turned)
    }

    pub(super) fn sample<const N: usize>(
        &self,
        lambda_nm: &Lanes<f64, N>,
        n: Vec3<f64>,
        at: &Shading<'_>,
        wo: Vec3<f64>,
        u: f64,
    ) -> Option<BsdfSample<N>> {
        // Rounding may leave a number above the sum of all: the last order then.
        let mut left = u * self.efficiency;
        let order = self.stated.orders.iter().find(|(_, efficiency)| {
            left -= efficiency;
            left < 0.0
        });
        let (order, _) = order.or_else(|| self.stated.orders.iter().rev().find(|order| order.1 > 0.0))?;
        let waves = f64::from(*order) * self.stated.at_nm.unwrap_or(lambda_nm[0]) / self.stated.period_nm;
        let cos = n.dot(wo);
        let along = n * cos - wo + self.across_grooves(n, at) * waves;
        let cos2 = 1.0 - along.length_squared();
        if cos2 <= 0.0 {
            return None;
        }
        let to_other_side = if self.stated.transmits { -1.0 } else { 1.0 };
        let wi = along + n * (cos2.sqrt_nonnegative().copysign(cos) * to_other_side);
        let together = *order == 0 || self.stated.at_nm.is_some();
        let lane_density = if together { Lanes::ONE } else { Lanes::ONE.hero_only() };
        let weight = self.reflectance.lanes(lambda_nm, at.texture_point()) * self.efficiency * lane_density;
        Some(BsdfSample { wi: wi.renormalized(), weight, density: Density::Delta, lane_density, eta: 1.0 })
    }
}
