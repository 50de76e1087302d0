//! Laws of a BSDF as a whole: its density integrates to one, its samples follow it, it creates no energy.

use super::{
    cells::{Cells, expected, rest},
    directions::few_directions,
    scattering::side_index,
};
use crate::{
    Uniform, Verdict,
    quadrature::{Cone, Integral, directions},
    statistics::{Budget, Welford, chi_square_verdict, normal_two_sided_tail, resolvable_bias, z_verdict},
    subjects::{Density, Scatters},
    vector::{Vec3, distance_max, representable},
};

/// Samples a direction of a statistical law. At a suite's significance of about 1e-9 a test of a mean then sees
/// 9·σ/256 ≈ 0.035 σ.
const SAMPLES: u32 = 65_536;

/// Absolute error asked of quadratures over the sphere, and the most evaluations spent on one.
const QUADRATURE_TOLERANCE: f64 = 1e-7;
const QUADRATURE_EVALUATIONS: usize = 1_000_000;

fn cases(subject: &dyn Scatters, seed: u64) -> Vec<(Vec3, f64)> {
    let directions = few_directions(subject.two_sided(), subject.epsilon(), seed);
    let along = |wavelength_nm: f64| directions.iter().map(move |wo| (*wo, wavelength_nm)).collect::<Vec<_>>();
    subject.wavelengths_nm().into_iter().flat_map(along).collect()
}

fn draw(subject: &dyn Scatters, numbers: &mut Uniform) -> [f64; 3] {
    representable(numbers.triple(), subject.epsilon())
}

/// The share of light that is scattered at all, from the density: ∫pdf + Σ delta probabilities.
fn scattered_share(subject: &dyn Scatters, wo: Vec3, wavelength_nm: f64) -> Integral {
    let smooth =
        directions(|wi| subject.pdf(wo, wi, wavelength_nm), Cone::SPHERE, QUADRATURE_TOLERANCE, QUADRATURE_EVALUATIONS);
    let sharp: f64 = subject.deltas(wo, wavelength_nm).iter().map(|lobe| lobe.probability).sum();
    Integral { value: smooth.value + sharp, error: smooth.error }
}

/// ∫pdf over the sphere plus the delta lobes' probabilities is the probability that `sample` answers: 1 for a subject that
/// always does.
///
/// Deterministic where the total is 1 within the quadrature's error (and the subject's rounding); elsewhere the shortfall
/// must equal the share of 65536 samples that were absorbed, by a z-test.
pub fn pdf_integrates_to_one(subject: &dyn Scatters, budget: Budget, seed: u64) -> Verdict {
    const LAW: &str = "the density of a BSDF integrates to one";
    let cases = cases(subject, seed);
    let significance = budget.split(cases.len()).each();
    let verdicts = cases.into_iter().enumerate().map(|(i, (wo, wavelength_nm))| {
        let total = scattered_share(subject, wo, wavelength_nm);
        let bound = total.error.max(1e-6) + 64.0 * subject.epsilon();
        let story =
            format!("wo {wo:?}, {wavelength_nm} nm: ∫pdf + Σ probabilities = {:.9} ± {:.1e}", total.value, total.error);
        let missing = 1.0 - total.value;
        if missing <= bound || missing.is_nan() {
            return Verdict::bounded(LAW, missing.abs(), bound, story);
        }
        let mut numbers = Uniform::new(seed ^ (i as u64) << 32);
        let absorbed =
            (0..SAMPLES).filter(|_| subject.sample(wo, draw(subject, &mut numbers), wavelength_nm).is_none()).count();
        let share = absorbed as f64 / f64::from(SAMPLES);
        let spread = (missing * (1.0 - missing).max(0.0) / f64::from(SAMPLES)).sqrt();
        // A subject that absorbs everything leaves nothing to chance.
        let z = if share == missing { 0.0 } else { (share - missing) / spread };
        let seen = resolvable_bias(spread, significance);
        let story = format!("{story}, and {absorbed} of {SAMPLES} samples were absorbed");
        Verdict::tested(LAW, z, normal_two_sided_tail(z), significance, seen, story)
    });
    Verdict::worst_of(LAW, verdicts)
}

/// χ² of 65536 samples a direction against the density, in 512 cells of equal solid angle, with one more cell for each delta
/// lobe and one for absorption. Cells' expectations come from quadrature of `pdf`, cell by cell, and are as exact as that.
pub fn samples_follow_pdf(subject: &dyn Scatters, budget: Budget, seed: u64) -> Verdict {
    const LAW: &str = "samples are distributed as the density says";
    let cases = cases(subject, seed);
    let significance = budget.split(cases.len()).each();
    let verdicts = cases.into_iter().enumerate().map(|(i, (wo, wavelength_nm))| {
        let lobes = subject.deltas(wo, wavelength_nm);
        let pdf = |wi: Vec3| subject.pdf(wo, wi, wavelength_nm);
        let mut cells = Cells::new(Cone::SPHERE);
        let (mut sharp, mut absorbed) = (vec![0_u64; lobes.len()], 0_u64);
        let mut numbers = Uniform::new(seed ^ (i as u64) << 32);
        for _ in 0..SAMPLES {
            let Some(drawn) = subject.sample(wo, draw(subject, &mut numbers), wavelength_nm) else {
                absorbed += 1;
                continue;
            };
            match drawn.density {
                Density::SolidAngle(_) => {
                    if !cells.count(drawn.wi, || pdf(drawn.wi)) {
                        return Verdict::broken(LAW, format!("wo {wo:?}: {drawn:?} is no direction"));
                    }
                }
                Density::Delta(_) => {
                    let distance = |j: &usize| distance_max(lobes[*j].wi, drawn.wi);
                    let Some(lobe) = (0..lobes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
                        return Verdict::broken(LAW, format!("wo {wo:?}: {drawn:?}, but deltas() lists none"));
                    };
                    sharp[lobe] += 1;
                }
            }
        }
        let mut probabilities = cells.integrals(pdf, SAMPLES);
        probabilities.extend(lobes.iter().map(|lobe| Integral { value: lobe.probability, error: 0.0 }));
        probabilities.push(rest(&probabilities, 1e-6));
        let observed: Vec<u64> = cells.observed.into_iter().chain(sharp).chain([absorbed]).collect();
        let expected = expected(&probabilities, SAMPLES);
        chi_square_verdict(LAW, &observed, &expected, significance, &format!("wo {wo:?}, {wavelength_nm} nm"))
    });
    Verdict::worst_of(LAW, verdicts)
}

/// Directional albedo with the indices taken out, ∫ f·|cosθ|·(n_i/n_o)² dω + Σ weights·(n_i/n_o)²: the share of a white
/// furnace's light that comes back.
fn albedo(subject: &dyn Scatters, wo: Vec3, wavelength_nm: f64) -> Integral {
    let n_o = side_index(subject, wo, wavelength_nm);
    let share = |wi: Vec3| (side_index(subject, wi, wavelength_nm) / n_o).powi(2);
    let smooth = directions(
        |wi| subject.f(wo, wi, wavelength_nm) * wi[2].abs() * share(wi),
        Cone::SPHERE,
        QUADRATURE_TOLERANCE,
        QUADRATURE_EVALUATIONS,
    );
    let sharp: f64 = subject.deltas(wo, wavelength_nm).iter().map(|lobe| lobe.weight * share(lobe.wi)).sum();
    Integral { value: smooth.value + sharp, error: smooth.error }
}

/// The albedo of a subject in each of the cases that the laws try, by quadrature.
///
/// Two laws read them, and finding them takes longer than either.
#[derive(Clone, Debug)]
pub struct Albedos {
    cases: Vec<(Vec3, f64, Integral)>,
    epsilon: f64,
    seed: u64,
}

impl Albedos {
    /// Those of a subject.
    #[must_use]
    pub fn new(subject: &dyn Scatters, seed: u64) -> Self {
        let of = |(wo, wavelength_nm)| (wo, wavelength_nm, albedo(subject, wo, wavelength_nm));
        Self { cases: cases(subject, seed).into_iter().map(of).collect(), epsilon: subject.epsilon(), seed }
    }

    /// See [`energy_is_not_created`].
    pub fn create_no_energy(&self) -> Verdict {
        const LAW: &str = "a surface returns no more light than it receives";
        let verdicts = self.cases.iter().map(|(wo, wavelength_nm, albedo)| {
            let bound = albedo.error.max(1e-6) + 64.0 * self.epsilon;
            let story = format!("wo {wo:?}, {wavelength_nm} nm: albedo {:.9} ± {:.1e}", albedo.value, albedo.error);
            let excess = if albedo.value.is_nan() { f64::NAN } else { (albedo.value - 1.0).max(0.0) };
            Verdict::bounded(LAW, excess, bound, story)
        });
        Verdict::worst_of(LAW, verdicts)
    }

    /// See [`furnace_agrees`]. The subject must be the one whose albedos these are.
    pub fn agree_with_samples(&self, subject: &dyn Scatters, budget: Budget) -> Verdict {
        const LAW: &str = "sampled and integrated albedo agree";
        let significance = budget.split(self.cases.len()).each();
        let verdicts = self.cases.iter().enumerate().map(|(i, &(wo, wavelength_nm, albedo))| {
            let n_o = side_index(subject, wo, wavelength_nm);
            let mut numbers = Uniform::new(self.seed ^ (i as u64) << 32);
            let weights: Welford = (0..SAMPLES)
                .map(|_| {
                    subject.sample(wo, draw(subject, &mut numbers), wavelength_nm).map_or(0.0, |drawn| {
                        drawn.weight * (side_index(subject, drawn.wi, wavelength_nm) / n_o).powi(2)
                    })
                })
                .collect();
            let tolerance = albedo.error.max(1e-6) + 256.0 * self.epsilon;
            let mut verdict = z_verdict(LAW, &weights.estimate(), albedo.value, tolerance, significance);
            verdict.evidence = format!("wo {wo:?}, {wavelength_nm} nm: {}", verdict.evidence);
            verdict
        });
        Verdict::worst_of(LAW, verdicts)
    }
}

/// A BSDF returns no more light than it receives: its albedo in a white furnace is at most 1, in the deterministic
/// quadrature of f and delta weights.
pub fn energy_is_not_created(subject: &dyn Scatters, seed: u64) -> Verdict {
    Albedos::new(subject, seed).create_no_energy()
}

/// The white furnace, sampled: the mean weight of 65536 samples is the albedo that quadrature finds, by a z-test.
///
/// This is what sees a sampler that misses a part of the BSDF, counts a lobe twice, or weighs it by the wrong density.
pub fn furnace_agrees(subject: &dyn Scatters, budget: Budget, seed: u64) -> Verdict {
    Albedos::new(subject, seed).agree_with_samples(subject, budget)
}
