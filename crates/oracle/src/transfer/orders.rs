//! The transfer equation on a grid of depths, scattering by scattering.

use std::f64::consts::PI;

use super::doubling::Fluxes;
use crate::quadrature::gauss_legendre_half;

/// Layers of the grid, and directions in each hemisphere.
const LAYERS: usize = 400;
const NODES: usize = 32;

/// What a slab makes of a beam along its normal, and of diffuse light.
///
/// Each order of scattering is the integral of the one before along every direction, μ dI/dτ = S − I, the source S being linear between the
/// depths of the grid. That errs by about (depth of a layer)²/12 of the curvature of S. `phase` has the mean 1 over the sphere and takes the
/// cosine of the angle by which light is turned.
#[must_use]
pub fn by_scattering_orders(depth: f64, albedo: f64, phase: impl Fn(f64) -> f64) -> [Fluxes; 2] {
    let solver = Solver::new(depth, albedo, phase);
    let beam = solver.follow(&|_, tau| (-tau).exp() / (2.0 * PI), true);
    let diffuse = solver.follow(&|mu, tau| (-tau / mu).exp(), false);
    [beam, diffuse]
}

struct Solver {
    step: f64,
    albedo: f64,
    /// Directions down (positive cosines), then up, with weights.
    directions: Vec<(f64, f64)>,
    /// Phase function averaged over the azimuth: from each direction, and from the normal, into each.
    between: Vec<Vec<f64>>,
    from_normal: Vec<f64>,
}

impl Solver {
    fn new(depth: f64, albedo: f64, phase: impl Fn(f64) -> f64) -> Self {
        let half: Vec<(f64, f64)> = gauss_legendre_half(NODES)
            .into_iter()
            // μ = x²: more directions near the horizon, where radiance changes fastest.
            .map(|(x, w)| (x * x, 2.0 * x * w))
            .collect();
        let directions: Vec<(f64, f64)> = half.iter().copied().chain(half.iter().map(|&(mu, w)| (-mu, w))).collect();
        const AZIMUTHS: usize = 256;
        let mean = |a: f64, b: f64| {
            let across = ((1.0 - a * a) * (1.0 - b * b)).sqrt();
            let at = |k: usize| phase(a * b + across * (PI * (k as f64 + 0.5) / AZIMUTHS as f64).cos());
            (0..AZIMUTHS).map(at).sum::<f64>() / AZIMUTHS as f64
        };
        let mut between: Vec<Vec<f64>> =
            directions.iter().map(|to| directions.iter().map(|from| mean(to.0, from.0)).collect()).collect();
        // Scattering keeps energy on these few directions too: each row of what leaves a direction is brought to the mean 1.
        for from in 0..directions.len() {
            let sum: f64 = directions.iter().enumerate().map(|(to, node)| 0.5 * node.1 * between[to][from]).sum();
            between.iter_mut().for_each(|row| row[from] /= sum);
        }
        let mut from_normal: Vec<f64> = directions.iter().map(|to| mean(to.0, 1.0)).collect();
        let sum: f64 = directions.iter().zip(&from_normal).map(|(node, p)| 0.5 * node.1 * p).sum();
        from_normal.iter_mut().for_each(|p| *p /= sum);
        Self { step: depth / LAYERS as f64, albedo, directions, between, from_normal }
    }

    /// `incident` gives the unscattered radiance along a cosine at a depth; of a beam, its irradiance over 2π.
    fn follow(&self, incident: &dyn Fn(f64, f64) -> f64, beam: bool) -> Fluxes {
        let count = self.directions.len();
        let depth_of = |k: usize| k as f64 * self.step;
        // The first source: unscattered light, scattered once.
        let mut source: Vec<Vec<f64>> = (0..=LAYERS)
            .map(|k| {
                (0..count)
                    .map(|to| {
                        let arriving: f64 = match beam {
                            true => self.from_normal[to] * incident(1.0, depth_of(k)),
                            false => {
                                self.scattered_into(to, |from| {
                                    let mu = self.directions[from].0;
                                    if mu > 0.0 { incident(mu, depth_of(k)) } else { 0.0 }
                                }) * 2.0
                            }
                        };
                        0.5 * self.albedo * arriving
                    })
                    .collect()
            })
            .collect();
        let depth = depth_of(LAYERS);
        let direct = match beam {
            true => (-depth).exp(),
            false => {
                let half = self.directions[..NODES].iter();
                half.map(|(mu, w)| 2.0 * w * mu * (-depth / mu).exp()).sum()
            }
        };
        let mut fluxes = Fluxes { reflected: 0.0, transmitted: direct };
        loop {
            let radiance = self.integrate(&source);
            // A beam brings an irradiance of 1, diffuse light of radiance 1 one of π.
            let whole = if beam { 2.0 * PI } else { 2.0 };
            let flux = |k: usize, range: std::ops::Range<usize>| -> f64 {
                range.map(|i| whole * self.directions[i].1 * self.directions[i].0.abs() * radiance[k][i]).sum()
            };
            let (up, down) = (flux(0, NODES..count), flux(LAYERS, 0..NODES));
            fluxes.reflected += up;
            fluxes.transmitted += down;
            if up + down < 1e-9 {
                return fluxes;
            }
            source = radiance
                .iter()
                .map(|row| (0..count).map(|to| self.albedo * self.scattered_into(to, |from| row[from])).collect())
                .collect();
        }
    }

    /// ½∫p I dμ.
    fn scattered_into(&self, to: usize, radiance: impl Fn(usize) -> f64) -> f64 {
        let directions = self.directions.iter().enumerate();
        directions.map(|(from, node)| 0.5 * node.1 * self.between[to][from] * radiance(from)).sum()
    }

    /// The radiance that a source makes, at each depth along each direction.
    fn integrate(&self, source: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut radiance = vec![vec![0.0; self.directions.len()]; LAYERS + 1];
        for (i, &(mu, _)) in self.directions.iter().enumerate() {
            let x = self.step / mu.abs();
            let passed = (-x).exp();
            // ∫ of a source that is linear over the layer: weights of its values at the near end and the far end.
            let mean = if x < 1e-4 { 1.0 - x / 2.0 } else { (1.0 - passed) / x };
            let (near, far) = (1.0 - mean, mean - passed);
            let mut last = 0.0;
            for k in 1..=LAYERS {
                let (from, to) = if mu > 0.0 { (k - 1, k) } else { (LAYERS + 1 - k, LAYERS - k) };
                last = last * passed + near * source[to][i] + far * source[from][i];
                radiance[to][i] = last;
            }
        }
        radiance
    }
}
