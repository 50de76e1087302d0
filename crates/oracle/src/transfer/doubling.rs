//! Slabs, by doubling: two layers on each other reflect and transmit what goes to and fro between them.
//!
//! Van de Hulst (1963); Hansen & Travis, *Light Scattering in Planetary Atmospheres*, Space Science Reviews 16 (1974), §3. Only means over
//! the azimuth are followed, which is all that fluxes, and beams along the normal, need.

use super::layer::{Layer, Matrix};
use super::phase::legendre;
use crate::quadrature::gauss_legendre_half;

/// Directions of the quadrature in each hemisphere.
const NODES: usize = 48;
/// The first layer has the slab's depth over two to this power. What the trapezoidal rule errs in it falls as the square of its depth;
/// rounding doubles with each step, to about 2e-9.
const DOUBLINGS: i32 = 24;

/// The shares of light that a slab reflects and transmits; what is missing to 1 is absorbed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluxes {
    /// Comes back.
    pub reflected: f64,
    /// Comes through, scattered or not.
    pub transmitted: f64,
}

/// A layer between two planes, without interfaces.
#[derive(Clone, Debug)]
pub struct Slab {
    /// Cosine and weight of each direction: ∫₀¹ f dμ = Σ w f. The last is that of a beam, of the weight 0.
    nodes: Vec<(f64, f64)>,
    layer: Layer,
}

impl Slab {
    /// Of this optical depth, albedo and Legendre moments of its phase function (of the mean 1), for a beam of this cosine to the normal.
    #[must_use]
    pub fn new(depth: f64, albedo: f64, moments: &[f64], beam_cosine: f64) -> Self {
        let mut nodes = gauss_legendre_half(NODES);
        nodes.push((beam_cosine, 0.0));
        let [onward, backward] = Self::scattered(&nodes, albedo, moments);
        let cosines: Vec<f64> = nodes.iter().map(|node| node.0).collect();
        let mut layer = Layer::thin(depth * f64::from(-DOUBLINGS).exp2(), &cosines, &onward, &backward);
        (0..DOUBLINGS).for_each(|_| layer.double());
        Self { nodes, layer }
    }

    /// What scatters onward and what is turned, by a phase function averaged over the azimuth.
    fn scattered(nodes: &[(f64, f64)], albedo: f64, moments: &[f64]) -> [Matrix; 2] {
        // Nodes resolve polynomials of the degree 2·NODES − 1.
        let moments = &moments[..moments.len().min(2 * NODES)];
        let polynomials: Vec<Vec<f64>> = nodes.iter().map(|node| legendre(node.0, moments.len())).collect();
        let phase = |i: usize, j: usize, turned: bool| -> f64 {
            let terms = moments.iter().zip(&polynomials[i]).zip(&polynomials[j]).enumerate();
            terms
                .map(|(k, ((moment, a), b))| {
                    let sign = if turned && k % 2 == 1 { -1.0 } else { 1.0 };
                    sign * (2.0 * k as f64 + 1.0) * moment * a * b
                })
                .sum()
        };
        [false, true].map(|turned| {
            let mut matrix = Matrix::zero(nodes.len());
            for i in 0..nodes.len() {
                for (j, node) in nodes.iter().enumerate() {
                    *matrix.at(i, j) = 0.5 * albedo * node.1 * phase(i, j, turned);
                }
            }
            matrix
        })
    }

    /// What becomes of diffuse light, the same from all directions.
    #[must_use]
    pub fn of_diffuse_light(&self) -> Fluxes {
        let flux = |matrix: &Matrix| {
            let leaving = (0..matrix.size).map(|i| matrix.row(i).iter().sum::<f64>());
            self.nodes.iter().zip(leaving).map(|((mu, w), radiance)| 2.0 * w * mu * radiance).sum()
        };
        Fluxes { reflected: flux(&self.layer.reflection), transmitted: flux(&self.layer.transmission) }
    }

    /// What becomes of the beam: by reciprocity what an eye sees along it of diffuse light of radiance 1, on the side of the light and on
    /// the other.
    #[must_use]
    pub fn of_beam(&self) -> Fluxes {
        let seen = |matrix: &Matrix| matrix.row(self.nodes.len() - 1).iter().sum();
        Fluxes { reflected: seen(&self.layer.reflection), transmitted: seen(&self.layer.transmission) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::known_slabs::{OF_BEAM, OF_DIFFUSE_LIGHT};
    use super::super::{HalfSpace, by_scattering_orders, henyey_greenstein, legendre_moments};
    use super::*;

    fn slab(depth: f64, albedo: f64, g: f64) -> Slab {
        Slab::new(depth, albedo, &legendre_moments(|x| henyey_greenstein(g, x), 2 * NODES), 1.0)
    }

    fn near(found: f64, known: f64, what: &str) {
        assert!((found - known).abs() < 1.01e-6, "{what}: {found} is not {known}");
    }

    #[test]
    fn isotropic_slabs_have_their_known_fluxes() {
        for (depth, transmitted) in OF_DIFFUSE_LIGHT {
            let found = slab(depth, 1.0, 0.0).of_diffuse_light();
            near(found.transmitted, transmitted, &format!("diffuse, {depth}"));
            near(found.reflected + found.transmitted, 1.0, "nothing is absorbed");
        }
        for (depth, transmitted) in OF_BEAM {
            let found = slab(depth, 1.0, 0.0).of_beam();
            near(found.transmitted, transmitted, &format!("beam, {depth}"));
            near(found.reflected + found.transmitted, 1.0, "nothing is absorbed");
        }
        for (depth, transmitted, reflected) in [(1.0, 0.474_746, 0.352_712), (5.0, 0.053_421, 0.476_339)] {
            let found = slab(depth, 0.9, 0.0).of_diffuse_light();
            near(found.transmitted, transmitted, "absorbs, transmitted");
            near(found.reflected, reflected, "absorbs, reflected");
        }
    }

    #[test]
    fn slabs_of_henyey_and_greenstein_have_their_known_fluxes() {
        for (g, depth, albedo, reflected, transmitted) in [
            (0.75, 2.0, 0.9, 0.097_395, 0.660_958),
            (0.5, 8.0, 0.99, 0.600_127, 0.243_831),
            (0.85, 8.0, 0.99, 0.302_149, 0.558_941),
            (0.85, 8.0, 1.0, 0.358_432, 0.641_568),
        ] {
            let found = slab(depth, albedo, g).of_beam();
            near(found.reflected, reflected, &format!("{g} {depth} {albedo}, reflected"));
            near(found.transmitted, transmitted, &format!("{g} {depth} {albedo}, transmitted"));
        }
    }

    #[test]
    fn a_thick_slab_is_a_half_space() {
        for albedo in [0.5, 0.9, 0.99] {
            let (slab, half_space) = (slab(300.0, albedo, 0.0), HalfSpace::new(albedo));
            near(slab.of_beam().reflected, half_space.plane_albedo(1.0), "plane albedo");
            near(slab.of_diffuse_light().reflected, half_space.diffuse_albedo(), "diffuse albedo");
        }
    }

    #[test]
    fn doubling_agrees_with_the_transfer_equation_order_by_order() {
        for (depth, albedo, g) in [(0.5, 0.9, 0.0), (1.0, 1.0, 0.0), (2.0, 0.9, 0.75), (1.0, 0.8, -0.4)] {
            let (doubled, summed) =
                (slab(depth, albedo, g), by_scattering_orders(depth, albedo, |x| henyey_greenstein(g, x)));
            for (a, b) in [
                (doubled.of_beam().reflected, summed[0].reflected),
                (doubled.of_beam().transmitted, summed[0].transmitted),
                (doubled.of_diffuse_light().reflected, summed[1].reflected),
                (doubled.of_diffuse_light().transmitted, summed[1].transmitted),
            ] {
                assert!((a - b).abs() < 2e-5, "{depth} {albedo} {g}: {a} is not {b}");
            }
        }
    }
}
