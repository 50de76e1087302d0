//! Laws of a BSDF at single pairs of directions: sanity, reciprocity, the weight of a sample, étendue.

use proptest::prelude::*;

use super::directions::{few_directions, for_all, unit_vectors};
use crate::{
    Verdict,
    subjects::{DeltaLobe, Density, Scatters},
    vector::{Vec3, add, cross, distance_max, dot, frame, is_finite, length, normalize, representable, scale},
};

/// Bound on relative errors of products of a few dozen roundings.
const RELATIVE_BOUND: f64 = 256.0;

/// Cases of each property; each is a pair of directions and a wavelength.
const CASES: u32 = 512;

/// Directions within this many ε of each other are one to a computation of a few dozen roundings.
const NEARBY: f64 = 64.0;

fn pairs(subject: &dyn Scatters) -> impl Strategy<Value = ([f64; 3], [f64; 3], f64)> + use<> {
    let (both, epsilon) = (subject.two_sided(), subject.epsilon());
    let wavelengths = prop::sample::select(subject.wavelengths_nm());
    (unit_vectors(both, epsilon), unit_vectors(true, epsilon), wavelengths)
}

/// Index of the medium on the side of a direction.
pub(super) fn side_index(subject: &dyn Scatters, direction: Vec3, wavelength_nm: f64) -> f64 {
    subject.index(direction[2] > 0.0, wavelength_nm)
}

/// The most by which a function of two directions changes, to first order, when both move by [`NEARBY`] ε in any direction without
/// leaving their sides: what rounding may do to it that is as good as exact for directions nearby (backward stability; Higham, *Accuracy
/// and Stability of Numerical Algorithms*, §1.5). It is measured on the subject, so that nothing needs to be known of how it computes.
fn variation(of: impl Fn(Vec3, Vec3) -> f64, wo: Vec3, wi: Vec3, epsilon: f64) -> f64 {
    let here = of(wo, wi);
    let moves = |w: Vec3| {
        let (s, t) = frame(w);
        let step = NEARBY * epsilon;
        let moved = move |(sign, axis)| representable(normalize(add(w, scale(sign * step, axis))), epsilon);
        [(1.0, s), (-1.0, s), (1.0, t), (-1.0, t)].map(moved).into_iter().filter(move |moved| moved[2] * w[2] > 0.0)
    };
    let most = |there: f64, most: f64| (there - here).abs().max(most);
    let by_wo = moves(wo).map(|moved| of(moved, wi)).fold(0.0, |so_far, there| most(there, so_far));
    let by_wi = moves(wi).map(|moved| of(wo, moved)).fold(0.0, |so_far, there| most(there, so_far));
    // A gradient is at most √2 times the larger of its components along two axes.
    std::f64::consts::SQRT_2 * (by_wo + by_wi)
}

/// What rounding may do to light that is refracted by a facet, relatively, where the facet's cosine on one side is taken from that on the
/// other by Snell's law, as √(1 − η²(1 − cos²)): η, its square and the difference err by some 8 ε together, which is nothing but near
/// the critical angle. There the cosine is small, and f goes with its square at most. No direction nearby shows this: it is as if the index were
/// another by an ε.
fn snell_rounding([n_o, n_i]: [f64; 2], wo: Vec3, wi: Vec3, epsilon: f64) -> f64 {
    if wo[2] * wi[2] > 0.0 {
        return 0.0;
    }
    // The facet that sends one direction into the other (Walter et al. 2007, eq. 16).
    let facet = normalize(add(scale(n_o, wo), scale(n_i, wi)));
    let least = dot(wo, facet).abs().min(dot(wi, facet).abs());
    // Where there is no facet, for equal indices straight on, nothing is refracted.
    if least > 0.0 { 8.0 * epsilon / (least * least) } else { 0.0 }
}

/// f and pdf are finite, not negative, and wherever f lets light through pdf finds it.
pub fn f_and_pdf_are_proper(subject: &dyn Scatters, seed: u64) -> Verdict {
    const LAW: &str = "f and pdf are finite, not negative, and pdf > 0 wherever f > 0";
    for_all(LAW, pairs(subject), CASES, seed, |(wo, wi, wavelength_nm)| {
        let (f, pdf) = (subject.f(wo, wi, wavelength_nm), subject.pdf(wo, wi, wavelength_nm));
        let evidence = format!("wo {wo:?}, wi {wi:?}, {wavelength_nm} nm: f {f:e}, pdf {pdf:e}");
        let proper = f.is_finite() && pdf.is_finite() && f >= 0.0 && pdf >= 0.0;
        if !proper || (f * wi[2] != 0.0 && pdf == 0.0) {
            return Verdict::broken(LAW, evidence);
        }
        Verdict::bounded(LAW, 0.0, 0.0, evidence)
    })
}

/// Helmholtz reciprocity with indices (Veach 1997, §5.2): f(wo, wi)/n_o² is symmetric, and the delta lobes come in pairs whose
/// weights satisfy w(wo→wi)·n_i²/n_o² = w(wi→wo)·n_o²/n_i². To 256 ε relative.
///
/// Where f changes fast, at grazing angles and near total reflection, an arithmetic that takes the same cosine once from `wo` and once
/// from `wi` misses that without being wrong: it is exact for directions a few roundings away. So what misses the bound may differ, besides, by
/// what f itself changes when both directions move by 64 ε, and, where light is refracted, by what rounding does to Snell's law.
///
/// A delta lobe's partner is looked for within √ε, because near the critical angle directions are that ill-conditioned; there
/// weights are compared to √ε too.
pub fn is_reciprocal(subject: &dyn Scatters, seed: u64) -> Verdict {
    const LAW: &str = "f(wo, wi)/n² is symmetric";
    let epsilon = subject.epsilon();
    for_all(LAW, pairs(subject), CASES, seed, |(wo, wi, wavelength_nm)| {
        let (n_o, n_i) = (side_index(subject, wo, wavelength_nm), side_index(subject, wi, wavelength_nm));
        let forth = subject.f(wo, wi, wavelength_nm) / (n_o * n_o);
        let back = subject.f(wi, wo, wavelength_nm) / (n_i * n_i);
        let largest = forth.abs().max(back.abs());
        let error = if largest == 0.0 { 0.0 } else { (forth - back).abs() / largest };
        let mut bound = RELATIVE_BOUND * epsilon;
        if error > bound {
            let there = variation(|wo, wi| subject.f(wo, wi, wavelength_nm), wo, wi, epsilon) / (n_o * n_o);
            let reverse = variation(|wo, wi| subject.f(wo, wi, wavelength_nm), wi, wo, epsilon) / (n_i * n_i);
            bound += there.max(reverse) / largest + snell_rounding([n_o, n_i], wo, wi, epsilon);
        }
        let smooth = Verdict::bounded(
            LAW,
            error,
            bound,
            format!("wo {wo:?}, wi {wi:?}, {wavelength_nm} nm: f/n² {forth:e} one way, {back:e} the other"),
        );
        let lobes = subject.deltas(wo, wavelength_nm);
        let sharp =
            lobes.iter().filter(|lobe| lobe.weight > 0.0).map(|lobe| reversed(subject, wo, lobe, wavelength_nm));
        Verdict::worst_of(LAW, std::iter::once(smooth).chain(sharp))
    })
}

/// A surface without grain looks the same turned about its normal: f and pdf of two directions turned together stay what they are, to
/// 256 ε relative and what rounding the turned directions may do to them. For subjects that have no grain; it is in no suite.
pub fn is_isotropic(subject: &dyn Scatters, seed: u64) -> Verdict {
    const LAW: &str = "f and pdf are the same turned about the normal";
    let epsilon = subject.epsilon();
    let strategy = (pairs(subject), 0.0..std::f64::consts::TAU);
    for_all(LAW, strategy, CASES, seed, |((wo, wi, wavelength_nm), angle)| {
        let (sin, cos) = angle.sin_cos();
        let turned = |w: Vec3| representable([cos * w[0] - sin * w[1], sin * w[0] + cos * w[1], w[2]], epsilon);
        let f = |wo: Vec3, wi: Vec3| subject.f(wo, wi, wavelength_nm);
        let pdf = |wo: Vec3, wi: Vec3| subject.pdf(wo, wi, wavelength_nm);
        let judged = |name: &str, of: &dyn Fn(Vec3, Vec3) -> f64| {
            let (here, there) = (of(wo, wi), of(turned(wo), turned(wi)));
            let largest = here.abs().max(there.abs());
            let error = if largest == 0.0 { 0.0 } else { (here - there).abs() / largest };
            let mut bound = RELATIVE_BOUND * epsilon;
            if error > bound {
                bound += variation(of, wo, wi, epsilon) / largest;
            }
            let story =
                format!("wo {wo:?}, wi {wi:?}, {wavelength_nm} nm: {name} {here:e}, turned by {angle} rad {there:e}");
            Verdict::bounded(LAW, error, bound, story)
        };
        Verdict::worst_of(LAW, [judged("f", &f), judged("pdf", &pdf)])
    })
}

fn reversed(subject: &dyn Scatters, wo: Vec3, lobe: &DeltaLobe, wavelength_nm: f64) -> Verdict {
    const LAW: &str = "a delta lobe has its reverse";
    let epsilon = subject.epsilon();
    let (n_o, n_i) = (side_index(subject, wo, wavelength_nm), side_index(subject, lobe.wi, wavelength_nm));
    let ratio = (n_i / n_o).powi(2);
    let back = subject.deltas(lobe.wi, wavelength_nm);
    let partner = back.iter().min_by(|a, b| distance_max(a.wi, wo).total_cmp(&distance_max(b.wi, wo)));
    // cosθ of the lobe amplifies the rounding of its direction when it is followed back.
    let sensitivity = 1.0 / (lobe.wi[2].abs() * wo[2].abs()).max(epsilon.sqrt());
    let Some(partner) = partner.filter(|partner| distance_max(partner.wi, wo) <= 64.0 * epsilon.sqrt()) else {
        return Verdict::broken(LAW, format!("wo {wo:?} → {lobe:?}, but seen from there the lobes are {back:?}"));
    };
    let (forth, reverse) = (lobe.weight * ratio, partner.weight / ratio);
    let error = (forth - reverse).abs() / forth.max(reverse);
    let evidence = format!(
        "wo {wo:?} ↔ wi {:?}, {wavelength_nm} nm: {forth:e} one way, {reverse:e} the other (indices taken out)",
        lobe.wi
    );
    Verdict::bounded(LAW, error, RELATIVE_BOUND * epsilon * sensitivity * sensitivity, evidence)
}

/// What `sample` returns is what `f`, `pdf` and `deltas` say: weight = f·|cosθ|/pdf, the same pdf, a unit direction, and for
/// delta lobes weight = lobe weight / probability of a lobe that `deltas` lists. To 256 ε relative.
pub fn sample_is_consistent(subject: &dyn Scatters, seed: u64) -> Verdict {
    const LAW: &str = "a sample weighs f·cos/pdf";
    let epsilon = subject.epsilon();
    let numbers = (0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64);
    let wavelengths = prop::sample::select(subject.wavelengths_nm());
    let strategy = (unit_vectors(subject.two_sided(), epsilon), numbers, wavelengths);
    for_all(LAW, strategy, CASES, seed, |(wo, (u, v, w), wavelength_nm)| {
        let numbers = representable([u, v, w], epsilon).map(|x| x.min(1.0 - epsilon));
        let Some(drawn) = subject.sample(wo, numbers, wavelength_nm) else {
            return Verdict::bounded(LAW, 0.0, RELATIVE_BOUND * epsilon, format!("wo {wo:?}: absorbed"));
        };
        let story = format!("wo {wo:?}, u {numbers:?}, {wavelength_nm} nm: {drawn:?}");
        if !is_finite(drawn.wi) || !drawn.weight.is_finite() || drawn.weight < 0.0 {
            return Verdict::broken(LAW, story);
        }
        let stretch = (length(drawn.wi) - 1.0).abs();
        let relative = |a: f64, b: f64| if a == b { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) };
        let (error, against) = match drawn.density {
            Density::SolidAngle(density) => {
                let pdf = subject.pdf(wo, drawn.wi, wavelength_nm);
                let weight = subject.f(wo, drawn.wi, wavelength_nm) * drawn.wi[2].abs() / pdf;
                if density.is_nan() || density <= 0.0 {
                    return Verdict::broken(LAW, format!("{story}: a density must be above 0"));
                }
                (
                    relative(weight, drawn.weight).max(relative(pdf, density)),
                    format!("f·cos/pdf {weight:e}, pdf {pdf:e}"),
                )
            }
            Density::Delta(probability) => {
                let lobes = subject.deltas(wo, wavelength_nm);
                let near =
                    lobes.iter().min_by(|a, b| distance_max(a.wi, drawn.wi).total_cmp(&distance_max(b.wi, drawn.wi)));
                let Some(lobe) = near.filter(|lobe| distance_max(lobe.wi, drawn.wi) <= RELATIVE_BOUND * epsilon) else {
                    return Verdict::broken(LAW, format!("{story} is none of the lobes {lobes:?}"));
                };
                let weight = lobe.weight / lobe.probability;
                (relative(weight, drawn.weight).max(relative(lobe.probability, probability)), format!("{lobe:?}"))
            }
        };
        let error = if error.is_nan() { f64::NAN } else { error.max(stretch) };
        Verdict::bounded(LAW, error, RELATIVE_BOUND * epsilon, format!("{story} against {against}"))
    })
}

/// Étendue: a bundle of rays through a delta lobe keeps n²·cosθ·dω. The Jacobian of the lobe's direction is taken by central
/// differences with a step of h = ε^(1/3), whose error is h² times the third derivative, which grows as 1/cos⁴ towards grazing
/// and the critical angle: the bound is h²(200 + 4/cos⁴) relative, cos the smaller of the two cosines.
///
/// Lobes within .1 of grazing on either side, where the curvature is unbounded, are left out. A subject without delta lobes
/// passes with nothing tried and says so.
pub fn etendue_is_conserved(subject: &dyn Scatters, seed: u64) -> Verdict {
    const LAW: &str = "delta lobes keep étendue, n²·cosθ·dω";
    let epsilon = subject.epsilon();
    let step = epsilon.cbrt();
    let mut verdicts = Vec::new();
    for wavelength_nm in subject.wavelengths_nm() {
        for wo in few_directions(subject.two_sided(), epsilon, seed) {
            for lobe in subject.deltas(wo, wavelength_nm) {
                if lobe.wi[2].abs() < 0.1 || wo[2].abs() < 0.1 || lobe.weight == 0.0 {
                    continue;
                }
                let grazing = lobe.wi[2].abs().min(wo[2].abs());
                let bound = step * step * (200.0 + 4.0 / grazing.powi(4));
                verdicts.push(lobe_etendue(subject, wo, &lobe, wavelength_nm, step, bound));
            }
        }
    }
    if verdicts.is_empty() {
        return Verdict::bounded(LAW, 0.0, 200.0 * step * step, "no delta lobe to try");
    }
    Verdict::worst_of(LAW, verdicts)
}

fn lobe_etendue(
    subject: &dyn Scatters,
    wo: Vec3,
    lobe: &DeltaLobe,
    wavelength_nm: f64,
    step: f64,
    bound: f64,
) -> Verdict {
    const LAW: &str = "delta lobes keep étendue, n²·cosθ·dω";
    let (s, t) = frame(normalize(wo));
    let follow = |offset: Vec3| {
        let moved = representable(normalize(add(wo, offset)), subject.epsilon());
        let lobes = subject.deltas(moved, wavelength_nm);
        let nearest = lobes.iter().min_by(|a, b| distance_max(a.wi, lobe.wi).total_cmp(&distance_max(b.wi, lobe.wi)));
        // The offset really made, after rounding the direction.
        nearest.map(|found| (moved, found.wi))
    };
    let derivative = |axis: Vec3| {
        let (from, low) = follow(scale(-step, axis))?;
        let (to, high) = follow(scale(step, axis))?;
        let made = add(to, scale(-1.0, from));
        Some((made, add(high, scale(-1.0, low))))
    };
    let (Some((a, da)), Some((b, db))) = (derivative(s), derivative(t)) else {
        return Verdict::broken(LAW, format!("the lobe {lobe:?} of wo {wo:?} vanishes beside it"));
    };
    // Areas on the unit sphere, as the component of the cross product along the direction.
    let before = dot(cross(a, b), normalize(wo)).abs();
    let after = dot(cross(da, db), normalize(lobe.wi)).abs();
    let (n_o, n_i) = (side_index(subject, wo, wavelength_nm), side_index(subject, lobe.wi, wavelength_nm));
    let ratio = (n_i * n_i * lobe.wi[2].abs() * after) / (n_o * n_o * wo[2].abs() * before);
    let evidence = format!("wo {wo:?}, {wavelength_nm} nm, {lobe:?}: étendue changes by the factor {ratio:.9}");
    Verdict::bounded(LAW, (ratio - 1.0).abs(), bound, evidence)
}
