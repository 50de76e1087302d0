//! Holding a reading to a truth.

use super::Truth;
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
    let needed = truth.must_resolve();
    if verdict.pass && verdict.resolvable_bias > needed {
        let noise = (verdict.resolvable_bias - truth.tolerance) / (needed - truth.tolerance).max(0.0);
        let nearest = truth.mistakes.iter().find(|mistake| (mistake.value - truth.value).abs() <= needed);
        let what = match nearest {
            Some(mistake) => format!("\"{}\" ({:.10})", mistake.what, mistake.value),
            None => format!("a bias of {} %", 100.0 * truth.must_see),
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
