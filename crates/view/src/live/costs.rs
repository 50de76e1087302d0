//! What an effect costs: the same picture with and without it, measured here and now.

use std::time::Instant;

use etalon_control::Pilot;
use etalon_scene::Scene;
use etalon_transport::{EffectName, Prepared, Study, prepare_study};
use serde::Serialize;

use crate::picture::whole;

/// Rounds of samples that are compared, in units of the replicates.
const ROUNDS: [u32; 4] = [1, 2, 4, 8];
/// Seconds that one effect may take before no further round is begun.
const MOST_S: f64 = 4.0;

/// What an effect costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct EffectCost {
    /// Which.
    pub effect: EffectName,
    /// Time of a path with the effect, in units of that without it.
    pub path_time: f64,
    /// Time to the same relative error with the effect, in units of that without it; `null` where an error is not known.
    pub time_to_error: Option<f64>,
    /// Relative standard error of that.
    pub uncertainty: Option<f64>,
    /// Samples a pixel that both took.
    pub samples: u32,
    /// Why it could not be measured.
    pub problem: Option<String>,
}

/// Measures every effect that is simulated because the scene calls for it, one after the other; `is_wanted` ends it.
pub(crate) fn of_all(
    prepared: &Prepared,
    scene: &Scene,
    study: &Study,
    threads: usize,
    is_wanted: &dyn Fn() -> bool,
    tell: &dyn Fn(EffectCost),
) {
    let called_for = prepared.plan().effects.iter().filter(|effect| effect.on && effect.study.is_none());
    for effect in called_for {
        if !is_wanted() {
            return;
        }
        let mut without = study.clone();
        without.without.push(effect.name);
        let cost = match prepare_study(scene, &without) {
            Ok(other) => of(effect.name, prepared, &other, threads),
            Err(error) => Err(error.to_string()),
        };
        tell(cost.unwrap_or_else(|problem| EffectCost {
            effect: effect.name,
            path_time: f64::NAN,
            time_to_error: None,
            uncertainty: None,
            samples: 0,
            problem: Some(problem),
        }));
    }
}

/// Compares two pilots of the same pixels and samples, which take turns so that a machine that slows down slows both.
fn of(effect: EffectName, with: &Prepared, without: &Prepared, threads: usize) -> Result<EffectCost, String> {
    let film = &with.scene().film;
    let rect = whole([film.width, film.height]);
    let pilot = |prepared| Pilot::new(prepared, rect, None, Some(threads)).map_err(|error| error.to_string());
    let (mut a, mut b) = (pilot(with)?, pilot(without)?);
    let start = Instant::now();
    let clock = || start.elapsed().as_secs_f64();
    // Caches and clocks warm up on samples that count for neither.
    pilot(with)?.advance(a.first_step(), &clock, &|_| ());
    pilot(without)?.advance(b.first_step(), &clock, &|_| ());
    let mut samples = 0;
    for rounds in ROUNDS {
        samples = rounds * a.first_step();
        a.advance(samples, &clock, &|_| ());
        b.advance(samples, &clock, &|_| ());
        if clock() > MOST_S {
            break;
        }
    }
    let (Some(&a), Some(&b)) = (a.points().last(), b.points().last()) else {
        return Err("nothing was traced".to_owned());
    };
    let path_time = a.seconds / b.seconds;
    let ratio = path_time * (a.relative_rmse / b.relative_rmse).powi(2);
    let is_known = ratio.is_finite() && b.relative_rmse > 0.0;
    let uncertainty = 2.0 * a.uncertainty.hypot(b.uncertainty);
    Ok(EffectCost {
        effect,
        path_time,
        time_to_error: is_known.then_some(ratio),
        uncertainty: (is_known && uncertainty.is_finite()).then_some(uncertainty),
        samples,
        problem: None,
    })
}
