//! Laws of a light that is sampled by direction.

use super::cells::{Cells, expected, rest};
use crate::{
    Uniform, Verdict,
    quadrature::directions,
    statistics::{Budget, Welford, chi_square_verdict, z_verdict},
    subjects::Emits,
    vector::{Vec3, add, cross, dot, frame, is_finite, length, normalize, representable, scale},
};

const SAMPLES: u32 = 65_536;
const RELATIVE_BOUND: f64 = 256.0;
const QUADRATURE_EVALUATIONS: usize = 1_000_000;

/// What a light's sample says is what its `pdf` and `radiance` say in that direction: equal to 256 ε relative, a unit
/// direction, a positive density, and a direction that meets the light. 4000 samples.
pub fn light_sample_is_consistent(subject: &dyn Emits, from_m: [f64; 3], seed: u64) -> Verdict {
    const LAW: &str = "a light's sample agrees with its density and its radiance";
    let epsilon = subject.epsilon();
    let bound = RELATIVE_BOUND * epsilon;
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..4000).map(|i| {
        let mut u = [numbers.number(), numbers.number()];
        // The corners of the unit square are where mappings break.
        if i < 8 {
            u = [
                [0.0, 0.0],
                [0.0, 0.5],
                [0.5, 0.0],
                [1.0 - epsilon; 2],
                [0.0, 1.0 - epsilon],
                [1.0 - epsilon, 0.0],
                [0.5, 0.5],
                [0.25, 0.75],
            ][i];
        }
        let Some(drawn) = subject.sample(from_m, u) else {
            return Verdict::bounded(LAW, 0.0, bound, format!("from {from_m:?}, u {u:?}: no light"));
        };
        let (pdf, radiance) = (subject.pdf(from_m, drawn.wi), subject.radiance(from_m, drawn.wi));
        let story = format!("from {from_m:?}, u {u:?}: {drawn:?}; pdf() {pdf:e}, radiance() {radiance:e}");
        let sane = is_finite(drawn.wi)
            && drawn.pdf > 0.0
            && drawn.pdf.is_finite()
            && drawn.radiance >= 0.0
            && drawn.distance_m > 0.0;
        if !sane {
            return Verdict::broken(LAW, story);
        }
        let relative = |a: f64, b: f64| if a == b { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) };
        // On the very rim of a light rounding may put the direction past it; samples in the interior may not be there.
        let inside = u.iter().all(|x| (1e-3..=1.0 - 1e-3).contains(x));
        let missed = pdf == 0.0 || radiance == 0.0;
        if missed && drawn.radiance > 0.0 && !inside {
            return Verdict::bounded(LAW, 0.0, bound, story);
        }
        let error =
            relative(pdf, drawn.pdf).max(relative(radiance, drawn.radiance)).max((length(drawn.wi) - 1.0).abs());
        Verdict::bounded(LAW, error, bound, story)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// ∫pdf dω = 1, by quadrature over the light's extent, and 0 outside it at 1000 directions.
///
/// The bound is the larger of `tolerance` and the quadrature's own error, which is that of the light's rim: a light whose
/// rim is not a circle about the extent's axis leaves some 1e-4.
pub fn light_pdf_integrates_to_one(subject: &dyn Emits, from_m: [f64; 3], tolerance: f64, seed: u64) -> Verdict {
    const LAW: &str = "the density of a light integrates to one";
    let cone = subject.extent(from_m);
    let total = directions(|wi| subject.pdf(from_m, wi), cone, 0.1 * tolerance, QUADRATURE_EVALUATIONS);
    let mut numbers = Uniform::new(seed);
    let mut stray = 0.0_f64;
    for _ in 0..1000 {
        let wi = numbers.direction();
        // A hair of room for the rim itself.
        if cone.one_minus_cos < 2.0 && cone.coordinates(wi).0 > 1.0 + 1e-6 {
            stray = stray.max(subject.pdf(from_m, wi) + subject.radiance(from_m, wi));
        }
    }
    let story = format!("from {from_m:?}: ∫pdf = {:.9} ± {:.1e}", total.value, total.error);
    if stray != 0.0 {
        return Verdict::broken(LAW, format!("{story}, but {stray:e} outside the extent {cone:?}"));
    }
    Verdict::bounded(LAW, (total.value - 1.0).abs(), total.error.max(tolerance), story)
}

/// χ² of 65536 sampled directions against the density, in 16 × 32 cells of equal solid angle over the light's extent, with one
/// cell for refusals. A direction beyond the extent contradicts it.
pub fn light_samples_follow_pdf(subject: &dyn Emits, from_m: [f64; 3], budget: Budget, seed: u64) -> Verdict {
    const LAW: &str = "a light's samples are distributed as its density says";
    let mut cells = Cells::new(subject.extent(from_m));
    let pdf = |wi: Vec3| subject.pdf(from_m, wi);
    let mut refused = 0_u64;
    let mut numbers = Uniform::new(seed);
    for _ in 0..SAMPLES {
        match subject.sample(from_m, [numbers.number(), numbers.number()]) {
            None => refused += 1,
            Some(drawn) if cells.count(drawn.wi, || pdf(drawn.wi)) => {}
            Some(drawn) => return Verdict::broken(LAW, format!("from {from_m:?}: {drawn:?} is beyond the extent")),
        }
    }
    let mut probabilities = cells.integrals(pdf, SAMPLES);
    for cell in &mut probabilities {
        // A sample on the very rim, whose direction rounding moves past the light, is pooled with other small cells rather than
        // called impossible: that a sample has a density is the business of `light_sample_is_consistent`.
        cell.value = cell.value.max(f64::MIN_POSITIVE);
    }
    probabilities.push(rest(&probabilities, 1e-4));
    cells.observed.push(refused);
    chi_square_verdict(
        LAW,
        &cells.observed,
        &expected(&probabilities, SAMPLES),
        budget.each(),
        &format!("from {from_m:?}"),
    )
}

/// The irradiance that a light's samples give a surface with the given unit normal, Σ L·cos⁺/pdf, against the true one, W·m⁻²·nm⁻¹.
///
/// `tolerance` is relative and deterministic: the subject's rounding.
pub fn light_gives_irradiance(
    subject: &dyn Emits,
    from_m: [f64; 3],
    normal: [f64; 3],
    truth: f64,
    tolerance: f64,
    budget: Budget,
    seed: u64,
) -> Verdict {
    const LAW: &str = "a light's samples give the irradiance of its closed form";
    let mut numbers = Uniform::new(seed);
    let normal: Vec3 = normalize(normal);
    let readings: Welford = (0..SAMPLES)
        .map(|_| {
            let u = representable([numbers.number(), numbers.number(), 0.0], subject.epsilon());
            subject
                .sample(from_m, [u[0], u[1]])
                .map_or(0.0, |drawn| drawn.radiance * dot(drawn.wi, normal).max(0.0) / drawn.pdf)
        })
        .collect();
    let mut verdict = z_verdict(LAW, &readings.estimate(), truth, tolerance * truth.abs(), budget.each());
    verdict.evidence = format!("from {from_m:?}: {}", verdict.evidence);
    verdict
}

/// The samples fill the light's solid angle, no more and no less: E[1/pdf] = Ω. 65536 samples.
///
/// `tolerance` is relative and deterministic: the subject's rounding.
pub fn light_fills_its_solid_angle(
    subject: &dyn Emits,
    from_m: [f64; 3],
    solid_angle_sr: f64,
    tolerance: f64,
    budget: Budget,
    seed: u64,
) -> Verdict {
    const LAW: &str = "a light's samples fill the solid angle that it subtends";
    let mut numbers = Uniform::new(seed);
    let readings: Welford = (0..SAMPLES)
        .map(|_| {
            let u = representable([numbers.number(), numbers.number(), 0.0], subject.epsilon());
            subject.sample(from_m, [u[0], u[1]]).map_or(0.0, |drawn| 1.0 / drawn.pdf)
        })
        .collect();
    let mut verdict = z_verdict(LAW, &readings.estimate(), solid_angle_sr, tolerance * solid_angle_sr, budget.each());
    verdict.evidence = format!("from {from_m:?}: {}", verdict.evidence);
    verdict
}

/// The closed forms that a light states, its [solid angle](Emits::solid_angle_sr) and its [irradiance](Emits::irradiance) on a
/// surface that faces it and on one turned away by 50°, against its samples; nothing for a light that states none.
#[must_use]
pub fn light_closed_forms(subject: &dyn Emits, from_m: [f64; 3], budget: Budget, seed: u64) -> Vec<Verdict> {
    // The statistical error, 1e-3 or so, is larger; this keeps a noise-free light's rounding from failing.
    let tolerance = RELATIVE_BOUND * subject.epsilon();
    let mut verdicts = Vec::new();
    if let Some(solid_angle) = subject.solid_angle_sr(from_m) {
        verdicts.push(light_fills_its_solid_angle(subject, from_m, solid_angle, tolerance, budget, seed));
    }
    let axis = normalize(subject.extent(from_m).axis);
    let (across, _) = frame(axis);
    let (sine, cosine) = 50.0_f64.to_radians().sin_cos();
    for normal in [axis, normalize(add(scale(cosine, axis), scale(sine, across)))] {
        if let Some(truth) = subject.irradiance(from_m, normal) {
            verdicts.push(light_gives_irradiance(subject, from_m, normal, truth, tolerance, budget, seed));
        }
    }
    verdicts
}

/// A light sampled uniformly over the solid angle it subtends: 1/pdf is that solid angle, sr, in *every* sample, so that a
/// far light is noise-free. Relative bound `tolerance`; 4000 samples.
pub fn light_is_uniform_in_solid_angle(
    subject: &dyn Emits,
    from_m: [f64; 3],
    solid_angle_sr: f64,
    tolerance: f64,
    seed: u64,
) -> Verdict {
    const LAW: &str = "a light's samples are uniform in the solid angle it subtends";
    let mut numbers = Uniform::new(seed);
    let verdicts = (0..4000).map(|_| {
        let u = [numbers.number(), numbers.number()];
        let Some(drawn) = subject.sample(from_m, u) else {
            return Verdict::broken(LAW, format!("from {from_m:?}, u {u:?}: no sample"));
        };
        let error = (drawn.pdf * solid_angle_sr - 1.0).abs();
        let story = format!("from {from_m:?}, u {u:?}: 1/pdf {:e}, solid angle {solid_angle_sr:e}", 1.0 / drawn.pdf);
        Verdict::bounded(LAW, error, tolerance, story)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Solid angle of a sphere of radius r at distance d ≥ r of its centre, sr: 2π·s²/(1 + √(1 − s²)), s = r/d, exact for far
/// spheres; 4π from inside.
#[must_use]
pub fn sphere_solid_angle(radius_m: f64, distance_m: f64) -> f64 {
    let s = radius_m / distance_m;
    if s >= 1.0 {
        return 4.0 * std::f64::consts::PI;
    }
    let cosine = ((distance_m - radius_m) * (distance_m + radius_m)).sqrt() / distance_m;
    std::f64::consts::TAU * s * s / (1.0 + cosine)
}

/// Solid angle of a triangle seen from the origin, sr (Van Oosterom & Strackee 1983).
#[must_use]
pub fn triangle_solid_angle(corners_m: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = corners_m;
    let (la, lb, lc) = (length(a), length(b), length(c));
    let denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    2.0 * dot(a, cross(b, c)).abs().atan2(denominator)
}

/// Solid angle of a centred rectangle of the given sides at a height above its centre, sr:
/// 4·atan(a·b/(h·√(a² + b² + h²))) with half sides a, b.
#[must_use]
pub fn rectangle_solid_angle(width_m: f64, length_m: f64, height_m: f64) -> f64 {
    let (a, b, h) = (0.5 * width_m, 0.5 * length_m, height_m);
    4.0 * (a * b / (h * (a * a + b * b + h * h).sqrt())).atan()
}

/// The whole set of laws for a light seen from one point; `budget` is that of each statistical one, of which there are at
/// most four. `pdf_tolerance` as in [`light_pdf_integrates_to_one`].
#[must_use]
pub fn light_laws(
    subject: &dyn Emits,
    from_m: [f64; 3],
    pdf_tolerance: f64,
    budget: Budget,
    seed: u64,
) -> Vec<Verdict> {
    let mut verdicts = vec![
        light_sample_is_consistent(subject, from_m, seed),
        light_pdf_integrates_to_one(subject, from_m, pdf_tolerance, seed),
        light_samples_follow_pdf(subject, from_m, budget, seed),
    ];
    verdicts.extend(light_closed_forms(subject, from_m, budget, seed));
    verdicts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::Cone;
    use std::f64::consts::PI;

    #[test]
    fn solid_angles_have_their_known_values() {
        assert!((sphere_solid_angle(1.0, 2.0) - 2.0 * PI * (1.0 - 0.75_f64.sqrt())).abs() < 1e-14);
        assert!((sphere_solid_angle(1e-9, 1.0) / (PI * 1e-18) - 1.0).abs() < 1e-12);
        assert_eq!(sphere_solid_angle(2.0, 1.0), 4.0 * PI);
        // An octant, and a cube's face seen from its centre in two halves.
        assert!((triangle_solid_angle([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]]) - 0.5 * PI).abs() < 1e-14);
        let halves = [
            [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]],
            [[-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]],
        ];
        assert!((halves.map(triangle_solid_angle).iter().sum::<f64>() - 4.0 * PI / 6.0).abs() < 1e-14);
        // A cube's face seen from its centre is a sixth of the sphere.
        assert!((rectangle_solid_angle(2.0, 2.0, 1.0) - 4.0 * PI / 6.0).abs() < 1e-14);
        let cone = Cone::new([0.0, 0.0, 1.0], 0.5_f64.asin());
        assert!((2.0 * PI * cone.one_minus_cos - sphere_solid_angle(1.0, 2.0)).abs() < 1e-14);
    }
}
