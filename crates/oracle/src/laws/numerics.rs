//! Laws of the small functions that everything stands on: frames, MIS weights, film sums, wavelength sampling.

use std::f64::consts::TAU;

use crate::{
    Uniform, Verdict, quadrature,
    statistics::{Budget, Welford, z_verdict},
    vector::{Vec3, cross, distance_max, dot, is_finite, normalize, representable, representable_scalar},
};

/// A frame about a unit normal is orthonormal and right-handed, everywhere: 1e5 random normals, the axes with zeros of both
/// signs, and normals within 1e-12…1 of −z, where Frisvad's basis loses every digit. To 8 ε.
///
/// The subject maps a unit normal to two vectors that complete it, (s, t, n) right-handed.
pub fn frame_is_orthonormal(
    mut frame: impl FnMut([f64; 3]) -> ([f64; 3], [f64; 3]),
    epsilon: f64,
    seed: u64,
) -> Verdict {
    const LAW: &str = "a frame about a normal is orthonormal and right-handed";
    let mut numbers = Uniform::new(seed);
    let mut normals: Vec<Vec3> = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            for zeros in 0..4 {
                let mut n = [if zeros & 1 == 0 { 0.0 } else { -0.0 }; 3];
                n[(axis + 1) % 3] = if zeros & 2 == 0 { 0.0 } else { -0.0 };
                n[axis] = sign;
                normals.push(n);
            }
        }
    }
    for i in 0..100_000 {
        let n = if i % 2 == 0 {
            numbers.direction()
        } else {
            let (tilt, phi) = (numbers.log_between(1e-12, 1.0), numbers.between(0.0, TAU));
            [tilt * phi.cos(), tilt * phi.sin(), -(1.0 - tilt * tilt).max(0.0).sqrt()]
        };
        normals.push(representable(normalize(n), epsilon));
    }
    let verdicts = normals.into_iter().map(|n| {
        let (s, t) = frame(n);
        let story = format!("n {n:?}: s {s:?}, t {t:?}");
        if !is_finite(s) || !is_finite(t) {
            return Verdict::broken(LAW, story);
        }
        let errors = [dot(s, s) - 1.0, dot(t, t) - 1.0, dot(s, t), dot(s, n), dot(t, n), distance_max(cross(s, t), n)];
        let error = errors.into_iter().fold(0.0, |worst: f64, x| worst.max(x.abs()));
        Verdict::bounded(LAW, error, 8.0 * epsilon, story)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Weights of multiple importance sampling of two ways add up to 1, whatever the two densities, as far apart or as large as
/// the subject's type holds; the weight of a density of 0 is 0, and none is NaN. To 4 ε. (3e20 against 2e20 overflows f32
/// when squared; with the power heuristic it is 9/13.)
///
/// The subject maps (own density, other density) to the weight of the own.
pub fn mis_weights_add_up(mut weight: impl FnMut(f64, f64) -> f64, epsilon: f64, seed: u64) -> Verdict {
    const LAW: &str = "the weights of two ways of sampling add up to 1";
    let mut numbers = Uniform::new(seed);
    // Two thirds of the exponents that the type has, on either side of 1.
    let reach: f64 = if epsilon > 1e-10 { 1e25 } else { 1e200 };
    let fixed = [(3e20, 2e20), (1.0, 1.0), (1.0, 0.0), (1e-20, 3e-20), (reach, 1.0 / reach)];
    let verdicts = (0..4000).map(|i| {
        let (a, b) = if let Some(pair) = fixed.get(i) {
            *pair
        } else {
            let a = numbers.log_between(1.0 / reach, reach);
            (a, if i % 2 == 0 { a * numbers.log_between(1e-3, 1e3) } else { numbers.log_between(1.0 / reach, reach) })
        };
        let (a, b) = (representable_scalar(a, epsilon), representable_scalar(b, epsilon));
        let (own, other) = (weight(a, b), if b == 0.0 { 0.0 } else { weight(b, a) });
        let story = format!("densities {a:e} and {b:e}: weights {own:e} and {other:e}");
        if !(0.0..=1.0).contains(&own) || !(0.0..=1.0).contains(&other) {
            return Verdict::broken(LAW, story);
        }
        // The larger density never weighs less.
        if (a > b && own < other) || (a < b && own > other) {
            return Verdict::broken(LAW, story);
        }
        Verdict::bounded(LAW, (own + other - 1.0).abs(), 4.0 * epsilon, story)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// A film's mean of 2²⁴ samples is the mean of the samples, to 1e-6 relative: f32 sums lose 1 % of a million samples of .1
/// and a quarter of 2²⁶.
///
/// The subject takes in the samples one by one and answers their mean.
pub fn film_mean_is_exact(mean: impl FnOnce(&mut dyn Iterator<Item = f64>) -> f64) -> Verdict {
    const LAW: &str = "a film's mean is the mean of its samples";
    const COUNT: u32 = 1 << 24;
    // All alike, so that their rounding errors do not cancel.
    let exact = f64::from(0.1_f32);
    let got = mean(&mut (0..COUNT).map(|_| exact));
    let story = format!("{COUNT} samples of {exact} average to {got}");
    Verdict::bounded(LAW, (got / exact - 1.0).abs(), 1e-6, story)
}

/// Wavelengths are sampled with the density that is stated for them: ∫density = 1 over the range, every sample within it, the
/// ends u = 0 and u just below 1 included, and E[g/density] = ∫g for ten test functions by a z-test each.
///
/// `sample` maps u in [0, 1) to a wavelength, `density` a wavelength to its density per nm.
pub fn wavelengths_follow_density(
    mut sample: impl FnMut(f64) -> f64,
    density: impl Fn(f64) -> f64,
    range_nm: [f64; 2],
    epsilon: f64,
    budget: Budget,
    seed: u64,
) -> Verdict {
    const LAW: &str = "wavelengths are sampled with the stated density, normalised over the sampled range";
    const SAMPLES: u32 = 262_144;
    let [first, last] = range_nm;
    // Piece by piece: a tabulated density has corners at whole nanometres.
    let pieces = ((last - first).ceil() as u32).max(1);
    let integrate = |g: &dyn Fn(f64) -> f64| -> f64 {
        (0..pieces)
            .map(|i| {
                let at = |j: u32| first + (last - first) * f64::from(j) / f64::from(pieces);
                quadrature::interval(g, at(i), at(i + 1), 1e-12).value
            })
            .sum()
    };
    let total = integrate(&density);
    let mut verdicts = vec![Verdict::bounded(
        LAW,
        (total - 1.0).abs(),
        1e-6,
        format!("the density integrates to {total:.9} over {first} to {last} nm"),
    )];
    for u in [0.0, 0.5, 1.0 - epsilon] {
        let wavelength_nm = sample(u);
        let outside = (first - wavelength_nm).max(wavelength_nm - last).max(0.0);
        let empty = density(wavelength_nm.clamp(first, last)) <= 0.0;
        let story = format!("u = {u} gives {wavelength_nm} nm");
        let broken = wavelength_nm.is_nan() || empty;
        verdicts.push(if broken {
            Verdict::broken(LAW, story)
        } else {
            Verdict::bounded(LAW, outside, 4.0 * epsilon * last, story)
        });
    }
    let each = budget.split(10).each();
    for k in 0..10_u32 {
        // Smooth bumps across the range, the last ones at its very ends.
        let middle = first + (last - first) * f64::from(k) / 9.0;
        let bump = move |x: f64| (-((x - middle) / (0.08 * (last - first))).powi(2)).exp();
        let truth = integrate(&bump);
        let mut numbers = Uniform::new(seed ^ u64::from(k));
        let moments: Welford = (0..SAMPLES)
            .map(|_| {
                let wavelength_nm = sample(numbers.number());
                bump(wavelength_nm) / density(wavelength_nm)
            })
            .collect();
        verdicts.push(z_verdict(LAW, &moments.estimate(), truth, 1e-6 * truth, each));
    }
    Verdict::worst_of(LAW, verdicts)
}

#[cfg(test)]
mod tests {
    use super::{super::SINGLE, *};

    /// Duff et al. (2017).
    fn duff(n: Vec3) -> (Vec3, Vec3) {
        let sign = 1.0_f64.copysign(n[2]);
        let a = -1.0 / (sign + n[2]);
        let b = n[0] * n[1] * a;
        ([1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]], [b, sign + n[1] * n[1] * a, -n[1]])
    }

    /// Frisvad (2012), with its case for the pole.
    fn frisvad(n: Vec3) -> (Vec3, Vec3) {
        if n[2] < -0.999_999_9 {
            return ([0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]);
        }
        let (a, b) = (1.0 / (1.0 + n[2]), -n[0] * n[1] / (1.0 + n[2]));
        ([1.0 - n[0] * n[0] * a, b, -n[0]], [b, 1.0 - n[1] * n[1] * a, -n[1]])
    }

    #[test]
    fn duffs_frame_passes_and_frisvads_is_rejected() {
        frame_is_orthonormal(duff, f64::EPSILON, 1).assert();
        assert!(!frame_is_orthonormal(frisvad, f64::EPSILON, 1).pass);
        assert!(!frame_is_orthonormal(|n| (duff(n).1, duff(n).0), f64::EPSILON, 1).pass, "left-handed");
    }

    #[test]
    fn ratios_pass_and_squares_overflow() {
        let ratio = |a: f64, b: f64| if a == 0.0 { 0.0 } else { 1.0 / (1.0 + (b / a) * (b / a)) };
        mis_weights_add_up(ratio, f64::EPSILON, 1).assert();
        let squares = |a: f64, b: f64| f64::from((a as f32).powi(2) / ((a as f32).powi(2) + (b as f32).powi(2)));
        assert!(!mis_weights_add_up(squares, SINGLE, 1).pass);
        assert!(!mis_weights_add_up(|_, _| 0.49, f64::EPSILON, 1).pass);
        assert!(!mis_weights_add_up(|a, b| ratio(b, a), f64::EPSILON, 1).pass, "weights swapped");
        let single = |a: f64, b: f64| {
            let r = b as f32 / a as f32;
            f64::from(1.0 / (1.0 + r * r))
        };
        mis_weights_add_up(single, SINGLE, 1).assert();
    }

    #[test]
    fn double_sums_pass_and_single_sums_are_rejected() {
        let mean = |samples: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = samples.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
            sum / count
        };
        film_mean_is_exact(mean).assert();
        let single = |samples: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = samples.fold((0.0_f32, 0.0), |(sum, count), x| (sum + x as f32, count + 1.0));
            f64::from(sum) / count
        };
        assert!(!film_mean_is_exact(single).pass);
    }

    #[test]
    fn a_normalised_density_passes_and_a_peers_is_rejected() {
        // A density that falls linearly to a third.
        let range = [360.0, 830.0];
        let width = range[1] - range[0];
        let density = move |x: f64| (1.5 - (x - range[0]) / width) / width;
        let sample = move |u: f64| range[0] + width * (1.5 - (2.25 - 2.0 * u).sqrt());
        let budget = Budget::for_tests(1);
        wavelengths_follow_density(sample, density, range, f64::EPSILON, budget, 1).assert();
        let unnormalised = move |x: f64| 0.999 * density(x);
        assert!(!wavelengths_follow_density(sample, unnormalised, range, f64::EPSILON, budget, 1).pass);
        let uniform = move |u: f64| range[0] + width * u;
        assert!(!wavelengths_follow_density(uniform, density, range, f64::EPSILON, budget, 1).pass);
        let beyond = move |u: f64| sample(u) + 1.0;
        assert!(!wavelengths_follow_density(beyond, density, range, f64::EPSILON, budget, 1).pass);
    }
}
