//! Air once more, scattering by scattering on a grid of depths, without Stokes parameters.
//!
//! A dipole is shaken by the field at its place. The mean of E Eᵀ, summed over all directions of light, says all of it: a tensor of three by
//! three. The dipole sends toward each direction the part of the field across it.

use std::f64::consts::{PI, TAU};

use super::air::{Leaving, frame};
use crate::quadrature::gauss_legendre_half;
use crate::vector::{Vec3, dot};

/// Layers of the grid, and directions: by cosine in each hemisphere, and along the azimuth.
const LAYERS: usize = 256;
const NODES: usize = 24;
const AZIMUTHS: usize = 6;
/// Scatterings end where they change the field by less.
const SMALL: f64 = 1e-9;

/// The mean of E Eᵀ: its trace is the radiance, or a sum of radiances.
type Field = [[f64; 3]; 3];

fn combined(terms: &[(f64, &Field)]) -> Field {
    std::array::from_fn(|i| std::array::from_fn(|j| terms.iter().map(|(factor, field)| factor * field[i][j]).sum()))
}

/// What of a field swings across a direction.
fn across(direction: Vec3, field: &Field) -> Field {
    // Fields are symmetric but for rounding, which must not grow from one scattering to the next: so both products.
    let right: Vec3 = std::array::from_fn(|i| dot(field[i], direction));
    let left: Vec3 = std::array::from_fn(|j| (0..3).map(|i| direction[i] * field[i][j]).sum());
    let both = dot(right, direction);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            field[i][j] - direction[i] * left[j] - right[i] * direction[j] + direction[i] * direction[j] * both
        })
    })
}

/// Unpolarised light of the radiance 1 along a direction.
fn unpolarised(direction: Vec3) -> Field {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| 0.5 * (if i == j { 1.0 } else { 0.0 } - direction[i] * direction[j]))
    })
}

/// Radiance after a way of this optical length whose source goes evenly from one value to another.
fn after(before: &Field, length: f64, source: [&Field; 2]) -> Field {
    let lost = -(-length).exp_m1();
    let mean = lost / length;
    combined(&[(1.0 - lost, before), (mean - 1.0 + lost, source[0]), (1.0 - mean, source[1])])
}

/// A slab of air above a diffuse ground, under a sun at the azimuth 0 whose irradiance across its beam is π.
#[derive(Clone, Debug)]
pub struct AirByOrders {
    /// Optical depth of a layer of the grid.
    step: f64,
    /// What is scattered at each depth of the grid, before the part across a direction is taken.
    sources: Vec<Field>,
    /// Radiance of the ground.
    shine: f64,
}

impl AirByOrders {
    /// Of this optical depth, for a sun at this cosine to the vertical and a ground of this albedo.
    #[must_use]
    pub fn new(depth: f64, sun: f64, ground: f64) -> Self {
        let step = depth / LAYERS as f64;
        let half: Vec<(f64, f64)> = gauss_legendre_half(NODES)
            .into_iter()
            // μ = x²: more directions near the horizon, where radiance changes fastest.
            .map(|(x, w)| (x * x, 2.0 * x * w))
            .collect();
        let scattered = 3.0 / (8.0 * PI);
        let beam = unpolarised(frame(Leaving::Downward, sun, 0.0)[0]);
        let at = |k: usize| k as f64 * step;
        let of_sun: Vec<Field> =
            (0..=LAYERS).map(|k| combined(&[(PI * (-at(k) / sun).exp() * scattered, &beam)])).collect();
        let mut slab = Self { step, sources: of_sun.clone(), shine: 0.0 };
        loop {
            let mut next = of_sun.clone();
            let mut irradiance = PI * sun * (-depth / sun).exp();
            for &(cosine, weight) in &half {
                for k in 0..AZIMUTHS {
                    let azimuth = TAU * k as f64 / AZIMUTHS as f64;
                    let share = weight * TAU / AZIMUTHS as f64;
                    for leaving in [Leaving::Downward, Leaving::Upward] {
                        slab.follow(leaving, cosine, azimuth, |depth, light| {
                            next[depth] = combined(&[(1.0, &next[depth]), (share * scattered, light)]);
                            if leaving == Leaving::Downward && depth == LAYERS {
                                irradiance += share * cosine * (0..3).map(|i| light[i][i]).sum::<f64>();
                            }
                        });
                    }
                }
            }
            let change = |(a, b): (&Field, &Field)| {
                (0..9).map(|i| (a[i / 3][i % 3] - b[i / 3][i % 3]).abs()).fold(0.0, f64::max)
            };
            let changed = next.iter().zip(&slab.sources).map(change).fold(0.0, f64::max);
            assert!(next.iter().flatten().flatten().all(|value| value.is_finite()), "the field is not finite");
            (slab.sources, slab.shine) = (next, ground / PI * irradiance);
            if changed < SMALL {
                return slab;
            }
        }
    }

    /// Tells the light at each depth of the grid along a direction, and returns what leaves.
    fn follow(&self, leaving: Leaving, cosine: f64, azimuth: f64, mut tell: impl FnMut(usize, &Field)) -> Field {
        let direction = frame(leaving, cosine, azimuth)[0];
        let depth = |k: usize| if leaving == Leaving::Downward { k } else { LAYERS - k };
        let source = |k: usize| across(direction, &self.sources[depth(k)]);
        let mut light = match leaving {
            Leaving::Downward => [[0.0; 3]; 3],
            Leaving::Upward => combined(&[(self.shine, &unpolarised(direction))]),
        };
        tell(depth(0), &light);
        let mut before = source(0);
        for k in 1..=LAYERS {
            let here = source(k);
            light = after(&light, self.step / cosine, [&before, &here]);
            tell(depth(k), &light);
            before = here;
        }
        light
    }

    /// I, Q and U of what leaves, without the sun's own beam, as [`super::Air::seen`] has them.
    #[must_use]
    pub fn seen(&self, leaving: Leaving, cosine: f64, azimuth: f64) -> [f64; 3] {
        let light = self.follow(leaving, cosine, azimuth, |_, _| ());
        let [_, l, r] = frame(leaving, cosine, azimuth);
        let between = |a: Vec3, b: Vec3| (0..3).map(|i| a[i] * dot(light[i], b)).sum::<f64>();
        [between(l, l) + between(r, r), between(l, l) - between(r, r), 2.0 * between(l, r)]
    }
}
