//! Slabs that scatter light as small dipoles do, with its polarisation: doubling of thin layers for the Stokes parameters I, Q and U.
//!
//! Lord Rayleigh (1871); Chandrasekhar, *Radiative Transfer* (1950), §16. Radiance has three Fourier terms in the azimuth φ: 1, cos φ and
//! cos 2φ; U has their sines. They do not mix, so each is doubled alone. Light that is unpolarised at first never gets a circular part.

use std::f64::consts::{PI, TAU};

use super::layer::{Layer, Matrix};
use crate::quadrature::gauss_legendre_half;
use crate::vector::{Vec3, dot};

/// Directions of the quadrature in each hemisphere.
const NODES: usize = 20;
/// The first layer has the slab's depth over two to this power. The trapezoidal rule errs in it as the square of its depth: about 1e-9 in all.
const DOUBLINGS: i32 = 16;
/// Weight of a direction that is only looked along: too small to count, large enough to divide by.
const LOOKED_ALONG: f64 = 1e-12;
/// I, Q and U.
const PARAMETERS: usize = 3;

/// What becomes of I, Q and U, by rows.
type Mueller = [[f64; PARAMETERS]; PARAMETERS];

/// Which way light leaves a slab that the sun shines on from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaving {
    /// Through the upper face.
    Upward,
    /// Through the lower face.
    Downward,
}

/// The direction of light at this cosine to the vertical, and two axes across it: one in the vertical plane, one horizontal. The axes of one side
/// are mirror images of those of the other.
pub(super) fn frame(leaving: Leaving, cosine: f64, azimuth: f64) -> [Vec3; 3] {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (sin, cos) = azimuth.sin_cos();
    let up = if leaving == Leaving::Upward { 1.0 } else { -1.0 };
    [[sine * cos, sine * sin, up * cosine], [cosine * cos, cosine * sin, -up * sine], [-sin, cos, 0.0]]
}

/// The phase matrix of a dipole between two directions. The wave that it sends along an axis is that part of the wave that shakes it. For
/// unpolarised light its mean over the sphere is 1.
fn dipole(to: [Vec3; 3], from: [Vec3; 3]) -> Mueller {
    let [a, b, c, d] = [(1, 1), (1, 2), (2, 1), (2, 2)].map(|(i, j)| dot(to[i], from[j]));
    let (a2, b2, c2, d2) = (a * a, b * b, c * c, d * d);
    let rows = [
        [0.5 * (a2 + b2 + c2 + d2), 0.5 * (a2 - b2 + c2 - d2), a * b + c * d],
        [0.5 * (a2 + b2 - c2 - d2), 0.5 * (a2 - b2 - c2 + d2), a * b - c * d],
        [a * c + b * d, a * c - b * d, a * d + b * c],
    ];
    rows.map(|row| row.map(|value| 1.5 * value))
}

/// A slab of air: it scatters and does not absorb.
#[derive(Clone, Debug)]
pub struct Air {
    /// Cosine and weight of each direction: ∫₀¹ f dμ = Σ w f.
    nodes: Vec<(f64, f64)>,
    /// One for each Fourier term in the azimuth.
    modes: [Layer; 3],
}

impl Air {
    /// Of this optical depth, for suns and eyes at these cosines to the vertical.
    #[must_use]
    pub fn new(depth: f64, cosines: &[f64]) -> Self {
        Self::of(depth, cosines, dipole)
    }

    /// The same slab for a renderer that drops polarisation at each scattering.
    #[must_use]
    pub fn unpolarised(depth: f64, cosines: &[f64]) -> Self {
        Self::of(depth, cosines, |to, from| {
            let mut matrix = [[0.0; PARAMETERS]; PARAMETERS];
            matrix[0][0] = dipole(to, from)[0][0];
            matrix
        })
    }

    fn of(depth: f64, cosines: &[f64], phase_matrix: impl Fn([Vec3; 3], [Vec3; 3]) -> Mueller) -> Self {
        let mut nodes = gauss_legendre_half(NODES);
        // Once for suns and once for eyes, so that no eye looks into the sun's own beam.
        nodes.extend(cosines.iter().chain(cosines).map(|&cosine| (cosine, LOOKED_ALONG)));
        let rows: Vec<f64> = nodes.iter().flat_map(|node| [node.0; PARAMETERS]).collect();
        let modes = [0, 1, 2].map(|mode| {
            let [onward, backward] =
                [Leaving::Downward, Leaving::Upward].map(|to| scattered(&nodes, to, mode, &phase_matrix));
            let mut layer = Layer::thin(depth * f64::from(-DOUBLINGS).exp2(), &rows, &onward, &backward);
            (0..DOUBLINGS).for_each(|_| layer.double());
            layer
        });
        Self { nodes, modes }
    }

    /// I, Q and U of the light that leaves at a cosine and an azimuth, without the sun's own beam. The sun stands at the cosine `sun` and the
    /// azimuth 0, and its irradiance across its beam is π. Q is what swings in the vertical plane, less what swings across it. Azimuths are
    /// those that light goes toward. Below is a diffuse ground of the albedo `ground`.
    ///
    /// # Panics
    /// If the slab was not made for one of the cosines.
    #[must_use]
    pub fn seen(&self, sun: f64, leaving: Leaving, cosine: f64, azimuth: f64, ground: f64) -> [f64; PARAMETERS] {
        let nodes = || self.nodes.iter().map(|node| node.0);
        let sun = nodes().position(|node| node == sun).expect("the slab was made for this sun");
        let eye = nodes().rposition(|node| node == cosine).expect("the slab was made for this eye");
        // Radiance of the sun's direction, over its weight, in the part that goes round so often.
        let of_sun = |mode: usize| if mode == 0 { 0.5 } else { 1.0 } / self.nodes[sun].1;
        let mut sum = [0.0; PARAMETERS];
        for (mode, layer) in self.modes.iter().enumerate() {
            let matrix = if leaving == Leaving::Upward { &layer.reflection } else { &layer.transmission };
            let (sin, cos) = (mode as f64 * azimuth).sin_cos();
            for (k, along) in [cos, cos, sin].into_iter().enumerate() {
                sum[k] += along * of_sun(mode) * matrix.row(PARAMETERS * eye + k)[PARAMETERS * sun];
            }
        }
        // The ground shines alike toward all directions, and sees its own light again in the slab.
        let Layer { reflection, transmission } = &self.modes[0];
        let irradiance = |radiance: &dyn Fn(&[f64]) -> f64, matrix: &Matrix| -> f64 {
            let nodes = self.nodes.iter().enumerate();
            TAU * nodes.map(|(i, (mu, w))| w * mu * radiance(matrix.row(PARAMETERS * i))).sum::<f64>()
        };
        let even = |row: &[f64]| row.iter().step_by(PARAMETERS).sum::<f64>();
        let first = irradiance(&|row| of_sun(0) * row[PARAMETERS * sun], transmission);
        let again = irradiance(&even, reflection);
        let shine = ground / PI * first / (1.0 - ground / PI * again);
        let matrix = if leaving == Leaving::Upward { transmission } else { reflection };
        for (k, sum) in sum.iter_mut().enumerate() {
            *sum += shine * even(matrix.row(PARAMETERS * eye + k));
        }
        sum
    }
}

/// The part of what scatters that goes round so often along the azimuth, from all directions downward to those of a side, with weights.
fn scattered(
    nodes: &[(f64, f64)],
    to: Leaving,
    mode: usize,
    phase_matrix: &impl Fn([Vec3; 3], [Vec3; 3]) -> Mueller,
) -> Matrix {
    // Enough for products of two such terms, up to cos 4φ.
    const AZIMUTHS: usize = 6;
    let mut matrix = Matrix::zero(PARAMETERS * nodes.len());
    for (i, out) in nodes.iter().enumerate() {
        for (j, node) in nodes.iter().enumerate() {
            let from = frame(Leaving::Downward, node.0, 0.0);
            for k in 0..AZIMUTHS {
                let azimuth = TAU * k as f64 / AZIMUTHS as f64;
                let (sin, cos) = (mode as f64 * azimuth).sin_cos();
                let scattered = phase_matrix(frame(to, out.0, azimuth), from);
                // ∫ over the azimuths of what comes in: I and Q go with cos mφ, U with sin mφ.
                for (row, values) in scattered.iter().enumerate() {
                    for (column, value) in values.iter().enumerate() {
                        let along = match (row == 2, column == 2) {
                            (false, true) => -sin,
                            (true, false) => sin,
                            _ => cos,
                        };
                        let share = 0.5 * node.1 / AZIMUTHS as f64;
                        *matrix.at(PARAMETERS * i + row, PARAMETERS * j + column) += share * along * value;
                    }
                }
            }
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::super::AirByOrders;
    use super::*;

    fn near(found: [f64; 3], known: [f64; 3], most: f64, what: &str) {
        let apart = (0..3).map(|k| (found[k] - known[k]).abs()).fold(0.0, f64::max);
        assert!(apart < most, "{what}: {found:?} is not {known:?}");
    }

    #[test]
    fn air_has_the_published_stokes_parameters() {
        // Natraj, Li & Yung (2009), τ = 0.5, μ₀ = 0.2, no ground; their azimuths count from the sun's.
        let slab = Air::new(0.5, &[0.2, 0.02, 0.4, 1.0]);
        for (cosine, degrees, known) in [
            (0.02, 0.0, [0.441_298_02, -0.017_531_41, 0.0]),
            (0.4, 0.0, [0.168_890_20, 0.011_195_11, 0.0]),
            (1.0, 0.0, [0.053_004_96, 0.037_558_59, 0.0]),
            (0.02, 60.0, [0.300_912_08, -0.159_656_01, 0.073_655_28]),
            (0.4, 60.0, [0.127_524_50, -0.060_660_38, 0.052_938_67]),
            (1.0, 60.0, [0.053_004_96, -0.018_779_30, 0.032_526_69]),
        ] {
            let [i, q, u] = slab.seen(0.2, Leaving::Upward, cosine, f64::to_radians(degrees), 0.0);
            // Twice as many directions meet what grazes to 2e-8, too.
            let most = if cosine < 0.1 { 2e-7 } else { 2e-8 };
            near([i, -q, u], known, most, &format!("{cosine}, {degrees}°"));
        }
    }

    #[test]
    fn doubling_agrees_with_the_transfer_equation_order_by_order() {
        for (depth, sun, ground) in [(0.5, 0.2, 0.0), (0.5, 0.6, 0.8), (1.0, 0.8, 0.25)] {
            let (doubled, summed) = (Air::new(depth, &[sun, 0.4]), AirByOrders::new(depth, sun, ground));
            for leaving in [Leaving::Upward, Leaving::Downward] {
                for (eye, azimuth) in [(0.4, 0.0), (0.4, 1.0), (0.4, 2.5), (sun, 1.0)] {
                    let found = doubled.seen(sun, leaving, eye, azimuth, ground);
                    near(
                        found,
                        summed.seen(leaving, eye, azimuth),
                        1e-5,
                        &format!("{depth} {sun} {ground} {leaving:?}"),
                    );
                }
            }
        }
    }

    #[test]
    fn what_scatters_loses_nothing() {
        let Air { nodes, modes } = Air::new(2.0, &[]);
        let Layer { reflection, transmission } = &modes[0];
        for from in 0..NODES {
            let leaves = |matrix: &Matrix| -> f64 {
                nodes
                    .iter()
                    .enumerate()
                    .map(|(i, (mu, w))| mu * w * matrix.row(PARAMETERS * i)[PARAMETERS * from])
                    .sum()
            };
            let (mu, w) = nodes[from];
            let share = (leaves(reflection) + leaves(transmission)) / (mu * w);
            assert!((share - 1.0).abs() < 1e-9, "from {mu}: {share}");
        }
    }
}
