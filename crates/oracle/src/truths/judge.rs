//! Holding a reading to a truth.

use super::{Mistake, Truth};
use crate::{Verdict, statistics::z_verdict, subjects::Reading};

/// Holds what a renderer measured to the truth, at the significance of one test
/// ([`Budget::each`](crate::statistics::Budget::each) of the number of truths judged together).
///
/// It fails when the reading differs by more than noise and the truth's tolerance explain, when any sample was not finite, and
/// **when the noise is so large that a bias of [`must_see`](Truth::must_see), or one of the truth's known mistakes, could pass**:
/// such a reading shows nothing, and the evidence says how many times the samples it takes. The resolvable bias is in units of
/// the value.
pub fn judge(truth: &Truth, reading: &Reading, significance: f64) -> Verdict {
    if reading.nonfinite > 0 {
        return Verdict::broken(&truth.name, format!("{} samples were not finite numbers", reading.nonfinite));
    }
    let mut verdict = z_verdict(&truth.name, &reading.estimate, truth.value, truth.tolerance, significance);
    let apart = |mistake: &Mistake| (mistake.value - truth.value).abs();
    let nearest = truth.mistakes.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
    let mistaken = nearest.map_or(f64::INFINITY, apart);
    // Of nothing there is no relative bias: a dark picture is held to its mistakes alone.
    let relative = if truth.value == 0.0 { f64::INFINITY } else { truth.must_see * truth.value };
    let needed = mistaken.min(relative);
    if verdict.pass && verdict.resolvable_bias > needed {
        let noise = (verdict.resolvable_bias - truth.tolerance) / (needed - truth.tolerance).max(0.0);
        let what = match nearest {
            Some(mistake) if mistaken <= relative => format!("\"{}\" ({:.10})", mistake.what, mistake.value),
            _ => format!("a bias of {} %", 100.0 * truth.must_see),
        };
        return verdict
            .without_power(&format!("too noisy to exclude {what}: take {:.1} times the samples", noise * noise));
    }
    if !verdict.pass {
        let noise = verdict.resolvable_bias;
        let likely = truth.mistakes.iter().find(|mistake| (reading.estimate.mean - mistake.value).abs() <= noise);
        if let Some(mistake) = likely {
            verdict.evidence += &format!("; this is what one reads with \"{}\"", mistake.what);
        }
    }
    verdict
}
