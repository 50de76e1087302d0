//! Slabs that scatter alike in all directions, by the equation for their source function.
//!
//! Light that scatters alike to all sides forgets where it came from. So one function of depth says all, the source function:
//! S(t) = ϖJ₀(t) + ½ϖ∫E₁(|t − t′|)S(t′) dt′. J₀ is the mean radiance of light that was not scattered yet (Milne, Schwarzschild; Chandrasekhar,
//! *Radiative Transfer*, §13). No direction is discretised: integrals over them are exponential integrals Eₙ.

use super::doubling::Fluxes;

/// Cells of depth on two grids, in each of which S is even. They are thin at the faces, where S is steep. Fluxes err as the square of the width of
/// cells, so what both grids say is extrapolated to cells of no width.
const CELLS: [usize; 2] = [80, 160];
/// Scatterings end where they change S by less.
const SMALL: f64 = 1e-12;

/// E₂ and E₃, of Eₙ(x) = ∫₁^∞ e^(−xt)/tⁿ dt.
fn exponential_integrals(x: f64) -> [f64; 2] {
    if x == 0.0 {
        return [1.0, 0.5];
    }
    let e_1 = if x < 1.0 {
        // −γ − ln x − Σ (−x)ᵏ/(k·k!).
        let (mut sum, mut power) = (-0.577_215_664_901_532_9 - x.ln(), 1.0);
        for k in 1..25 {
            power *= -x / f64::from(k);
            sum -= power / f64::from(k);
        }
        sum
    } else {
        // e⁻ˣ/(x + 1 − 1²/(x + 3 − 2²/(x + 5 − …))), from far down.
        let below = (1..150_u32).rev().map(f64::from).fold(0.0, |below, k| k * k / (x + 2.0 * k + 1.0 - below));
        (-x).exp() / (x + 1.0 - below)
    };
    let e_2 = (-x).exp() - x * e_1;
    [e_2, 0.5 * ((-x).exp() - x * e_2)]
}

fn e_3(x: f64) -> f64 {
    exponential_integrals(x)[1]
}

/// A slab that scatters alike in all directions.
#[derive(Clone, Debug)]
pub struct IsotropicSlab {
    depth: f64,
    grids: [Grid; 2],
}

impl IsotropicSlab {
    /// Of this optical depth and albedo of a single scattering.
    #[must_use]
    pub fn new(depth: f64, albedo: f64) -> Self {
        Self { depth, grids: CELLS.map(|cells| Grid::new(depth, albedo, cells)) }
    }

    fn extrapolated(&self, value: impl Fn(&Grid) -> f64) -> f64 {
        let [coarse, fine] = self.grids.each_ref().map(value);
        fine + (fine - coarse) / 3.0
    }

    /// What scattering sends to each face, 2∫S E₂, and what goes straight.
    fn fluxes(&self, source: impl Fn(&Grid) -> Vec<f64>, straight: f64) -> Fluxes {
        let depth = self.depth;
        let reflected = |grid: &Grid| 2.0 * grid.sum(&source(grid), |a, b| e_3(a) - e_3(b));
        let scattered = |grid: &Grid| 2.0 * grid.sum(&source(grid), |a, b| e_3(depth - b) - e_3(depth - a));
        Fluxes { reflected: self.extrapolated(reflected), transmitted: straight + self.extrapolated(scattered) }
    }

    /// What becomes of diffuse light, the same from all directions.
    #[must_use]
    pub fn of_diffuse_light(&self) -> Fluxes {
        // J₀ = ½E₂ for a radiance of 1.
        self.fluxes(|grid| grid.source(|a, b| 0.5 * (e_3(a) - e_3(b))), 2.0 * e_3(self.depth))
    }

    /// What becomes of a beam at this cosine to the normal.
    #[must_use]
    pub fn of_beam(&self, mu_0: f64) -> Fluxes {
        self.fluxes(|grid| grid.source_of_beam(mu_0), (-self.depth / mu_0).exp())
    }

    /// The radiance along μ over that of a white Lambertian surface in the same beam.
    #[must_use]
    pub fn radiance_factor(&self, mu: f64, mu_0: f64) -> f64 {
        self.extrapolated(|grid| grid.sum(&grid.source_of_beam(mu_0), |a, b| (-a / mu).exp() - (-b / mu).exp()))
    }

    /// The same above a ground that reflects all light diffusely.
    ///
    /// The beam's light and what the slab sends back make the ground shine as T(μ₀)/(1 − R). The eye sees the share T(μ) of that.
    #[must_use]
    pub fn radiance_factor_above_white(&self, mu: f64, mu_0: f64) -> f64 {
        let shine = self.of_beam(mu_0).transmitted / (1.0 - self.of_diffuse_light().reflected);
        self.radiance_factor(mu, mu_0) + self.of_beam(mu).transmitted * shine
    }
}

/// Cells of depth.
#[derive(Clone, Debug)]
struct Grid {
    albedo: f64,
    /// Edges of the cells, from 0 to the slab's depth.
    edges: Vec<f64>,
    /// The mean over a cell of ½∫E₁ over another.
    between: Vec<Vec<f64>>,
}

impl Grid {
    fn new(depth: f64, albedo: f64, cells: usize) -> Self {
        let share = |k: usize| (0.5 * std::f64::consts::PI * k as f64 / cells as f64).sin().powi(2);
        let edges: Vec<f64> = (0..=cells).map(|k| depth * share(k)).collect();
        // E₃″ is E₁, so ∫∫E₁(|t − t′|) is a difference of differences of E₃, and where both are of one cell twice its width beside.
        let apart: Vec<Vec<f64>> = edges.iter().map(|a| edges.iter().map(|b| e_3((a - b).abs())).collect()).collect();
        let between = (0..cells)
            .map(|i| {
                let width = edges[i + 1] - edges[i];
                let integral = |j: usize| {
                    let corners = apart[i][j + 1] + apart[i + 1][j] - apart[i][j] - apart[i + 1][j + 1];
                    if i == j { 2.0 * width + corners } else { corners }
                };
                (0..cells).map(|j| 0.5 * integral(j) / width).collect()
            })
            .collect();
        Self { albedo, edges, between }
    }

    /// S in each cell, for the integrals of J₀ over them.
    fn source(&self, first: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let cells = self.edges.windows(2);
        let once: Vec<f64> = cells.map(|cell| self.albedo * first(cell[0], cell[1]) / (cell[1] - cell[0])).collect();
        let mut source = once.clone();
        loop {
            let arriving = |row: &Vec<f64>| row.iter().zip(&source).map(|(share, s)| share * s).sum::<f64>();
            let rows = self.between.iter().zip(&once);
            let next: Vec<f64> = rows.map(|(row, once)| once + self.albedo * arriving(row)).collect();
            let change = next.iter().zip(&source).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            source = next;
            if change < SMALL {
                return source;
            }
        }
    }

    /// S for a beam at this cosine to the normal, of the irradiance π on the face: J₀ is e^(−t/μ₀)/4μ₀.
    fn source_of_beam(&self, mu_0: f64) -> Vec<f64> {
        self.source(|a, b| 0.25 * ((-a / mu_0).exp() - (-b / mu_0).exp()))
    }

    /// ∫S times a weight, whose integral over a cell is given.
    fn sum(&self, source: &[f64], weight: impl Fn(f64, f64) -> f64) -> f64 {
        source.iter().zip(self.edges.windows(2)).map(|(s, cell)| s * weight(cell[0], cell[1])).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::known_slabs::{OF_BEAM, OF_DIFFUSE_LIGHT};
    use super::super::{HalfSpace, Slab};
    use super::*;
    use crate::quadrature::interval;

    #[test]
    fn exponential_integrals_are_integrals() {
        for x in [1e-6, 0.01, 0.5, 0.999, 1.0, 1.001, 3.0, 20.0] {
            for (n, found) in [2, 3].into_iter().zip(exponential_integrals(x)) {
                // With t = 1/μ.
                let known =
                    interval(|mu| if mu == 0.0 { 0.0 } else { mu.powi(n - 2) * (-x / mu).exp() }, 0.0, 1.0, 1e-14)
                        .value;
                assert!((found - known).abs() < 1e-13, "E{n}({x}): {found} is not {known}");
            }
        }
    }

    #[test]
    fn slabs_have_their_known_fluxes() {
        for (depth, diffuse) in OF_DIFFUSE_LIGHT {
            let found = IsotropicSlab::new(depth, 1.0).of_diffuse_light();
            assert!((found.transmitted - diffuse).abs() < 5e-6, "diffuse, {depth}: {}", found.transmitted);
            assert!((found.transmitted + found.reflected - 1.0).abs() < 1e-9, "{depth}: something is lost");
        }
        for (depth, beam) in OF_BEAM {
            let found = IsotropicSlab::new(depth, 1.0).of_beam(1.0).transmitted;
            assert!((found - beam).abs() < 5e-6, "beam, {depth}: {found}");
        }
    }

    #[test]
    fn it_agrees_with_doubling() {
        for (depth, albedo, cosine) in [(0.5, 0.9, 1.0), (5.0, 0.9, 0.5), (2.0, 0.99, 0.7)] {
            let (slab, doubled) = (IsotropicSlab::new(depth, albedo), Slab::new(depth, albedo, &[1.0], cosine));
            for (a, b) in
                [(slab.of_beam(cosine), doubled.of_beam()), (slab.of_diffuse_light(), doubled.of_diffuse_light())]
            {
                let apart = (a.reflected - b.reflected).abs().max((a.transmitted - b.transmitted).abs());
                assert!(apart < 5e-6, "{depth} {albedo} {cosine}: {a:?} is not {b:?}");
            }
        }
    }

    #[test]
    fn a_thick_slab_is_a_half_space_as_is_a_lossless_one_above_white() {
        for (mu, mu_0) in [(1.0, 1.0), (1.0, 0.6), (0.3, 0.8)] {
            let (slab, half_space) = (IsotropicSlab::new(40.0, 0.9), HalfSpace::new(0.9));
            let (found, known) = (slab.radiance_factor(mu, mu_0), half_space.radiance_factor(mu, mu_0));
            assert!((found - known).abs() < 1e-4, "{mu} {mu_0}: {found} is not {known}");
            let (slab, half_space) = (IsotropicSlab::new(8.0, 1.0), HalfSpace::new(1.0));
            let (found, known) = (slab.radiance_factor_above_white(mu, mu_0), half_space.radiance_factor(mu, mu_0));
            assert!((found - known).abs() < 3e-5, "{mu} {mu_0}: {found} is not {known}");
        }
    }
}
