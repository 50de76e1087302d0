//! Renderers, and holding what they read to a truth.

use super::Truth;
use crate::{Verdict, statistics::z_verdict, subjects::Reading};

/// A whole renderer.
pub trait Renders {
    /// Renders the truth's scene and reads its quantity off the picture.
    ///
    /// # Errors
    /// Why it could not, as a sentence: a refused scene, an unsupported feature.
    fn render(&mut self, truth: &Truth) -> Result<Reading, String>;
}

/// The part of a reading's resolvable bias that paths which were cut may make up at most.
pub const CUT_SHARE: f64 = 0.1;

/// Holds what a renderer measured to the truth, at the significance of one test
/// ([`Budget::each`](crate::statistics::Budget::each) of the number of truths judged together).
///
/// It fails when the reading differs by more than noise and the truth's tolerance explain, when any sample was not finite, and
/// **when the noise is so large that a bias of [`must_see`](Truth::must_see), or one of the truth's known mistakes, could pass**:
/// such a reading shows nothing, and the evidence says how many times the samples it takes. The resolvable bias is in units of
/// the value.
///
/// It also fails when paths were cut that may have carried more than [`CUT_SHARE`] of that bias: what was left out would no longer be small
/// beside what the test sees. A smaller part could still hide as much of an error of the other sign. So it is added to the resolvable bias.
pub fn judge(truth: &Truth, reading: &Reading, significance: f64) -> Verdict {
    judge_to(truth, reading, significance, truth.must_resolve())
}

/// The same of a reading that must be able to see a bias of `needed`, in units of the value. With infinity it fails where it is wrong, not where it
/// shows nothing: as one of many seeds that show something together.
pub fn judge_to(truth: &Truth, reading: &Reading, significance: f64, needed: f64) -> Verdict {
    if reading.nonfinite > 0 {
        return Verdict::broken(&truth.name, format!("{} samples were not finite numbers", reading.nonfinite));
    }
    let mut verdict = z_verdict(&truth.name, &reading.estimate, truth.value(), truth.tolerance(), significance);
    if verdict.pass && verdict.resolvable_bias > needed {
        let noise = (verdict.resolvable_bias - truth.tolerance()) / (needed - truth.tolerance()).max(0.0);
        let nearest = truth.mistakes().iter().find(|mistake| (mistake.value - truth.value()).abs() <= needed);
        let what = match nearest {
            Some(mistake) => format!("\"{}\" ({:.10})", mistake.what, mistake.value),
            None => format!("a bias of {} %", 100.0 * needed / truth.value().abs()),
        };
        return verdict
            .without_power(&format!("too noisy to exclude {what}: take {:.1} times the samples", noise * noise));
    }
    if reading.cut_bias > 0.0 || reading.cut_bias.is_nan() {
        let most = CUT_SHARE * verdict.resolvable_bias;
        verdict.evidence += &format!("; paths that were cut may have caused a bias of {:.1e}", reading.cut_bias);
        // What is not a number is not small.
        let small = reading.cut_bias <= most;
        if !small {
            verdict.pass = false;
            verdict.evidence += &format!(", more than {most:.1e}");
            return verdict;
        }
        verdict.resolvable_bias += reading.cut_bias;
    }
    if !verdict.pass {
        let noise = verdict.resolvable_bias;
        let likely = truth.mistakes().iter().find(|mistake| (reading.estimate.mean - mistake.value).abs() <= noise);
        if let Some(mistake) = likely {
            verdict.evidence += &format!("; this is what one reads with \"{}\"", mistake.what);
        }
    }
    verdict
}
