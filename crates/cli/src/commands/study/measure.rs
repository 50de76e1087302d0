//! Measures choices side by side.

use std::sync::Arc;

use etalon_control::SampleAllocation;
use etalon_control::adaptive::{Goal, explore};
use etalon_scene::Scene;
use etalon_transport::{Control, Extent, Film, ImageError, Prepared, prepare_study};
use serde::Serialize;

use super::choices::{self, BASELINE, Choice};
use crate::machine::{Clock, ClockKind};

/// How far a study goes.
pub(super) struct Effort {
    /// Seconds of rendering for each choice.
    pub seconds: f64,
    /// Times that for the reference.
    pub reference: f64,
    pub threads: usize,
    /// Only choices whose group or name contains one of these; all if there are none.
    pub only: Vec<String>,
    pub seed: u64,
}

/// What a study found about a scene.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SceneStudy {
    pub scene: String,
    pub width: u32,
    pub height: u32,
    /// What is known of the answer beforehand: the mean Y.
    pub truth: Option<f64>,
    pub reference: Reference,
    pub rows: Vec<Row>,
    /// The scene as it is, after more and more samples, and the reference last.
    #[serde(skip)]
    pub pictures: Vec<Stage>,
}

/// A picture at some number of samples.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub samples: u32,
    pub seconds: f64,
    /// Relative; `None` where it is not known.
    pub error: Option<f64>,
    /// XYZ of each pixel, row after row.
    pub xyz: Vec<[f64; 3]>,
}

/// The picture that the others are held against.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Reference {
    pub samples: u32,
    pub seconds: f64,
    pub mean_y: f64,
    /// Its own relative error; `null` if no light was found.
    pub relative_rmse: Option<f64>,
    /// Whether rare bright paths carry its error, so that neither it nor the errors held against it are known well.
    pub heavy_tailed: bool,
}

/// A choice at its largest number of samples.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub group: &'static str,
    pub choice: String,
    /// Seconds of rendering.
    pub seconds: f64,
    pub samples: u32,
    pub rays_per_path: f64,
    pub shadow_rays_per_path: f64,
    /// Relative error against the reference, whose own is taken off; `null` where nothing is left.
    pub error: Option<f64>,
    /// Relative error by the scatter of its own replicates: without bias.
    pub scatter: Option<f64>,
    /// 1/(error²·s).
    pub efficiency: Option<f64>,
    /// Time a sample over that of the baseline.
    pub relative_cost: f64,
    /// Mean of the difference to the reference (or to the truth, where it is known), in units of its mean.
    /// `null` if that is 0.
    pub bias: Option<f64>,
    /// That over its standard error.
    pub z: Option<f64>,
    /// −d ln error / d ln samples over the points measured.
    pub slope: Option<f64>,
    pub points: Vec<Point>,
    pub approximations: Vec<String>,
}

/// A choice at some number of samples.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Point {
    pub samples: u32,
    pub seconds: f64,
    pub error: Option<f64>,
    pub scatter: Option<f64>,
}

struct Runner {
    choice: Choice,
    prepared: Prepared,
    film: Film,
    /// How samples are spread, once an exploration has said it.
    allocation: Option<Arc<SampleAllocation>>,
    samples: u32,
    seconds: f64,
    points: Vec<Point>,
}

/// Seconds of processor time over threads, so that other programs do not count.
fn timed<T>(threads: usize, work: impl FnOnce() -> T) -> (T, f64) {
    let clock = Clock::start(ClockKind::Cpu, threads);
    let done = work();
    (done, clock.seconds())
}

impl Runner {
    fn new(choice: Choice, seed: u64) -> Result<Self, String> {
        let mut scene = choice.scene.clone();
        scene.integrator.seed = seed;
        let prepared = prepare_study(&scene, &choice.study).map_err(|error| error.to_string())?;
        let film = prepared.film();
        Ok(Self { choice, prepared, film, allocation: None, samples: 0, seconds: 0.0, points: Vec::new() })
    }

    fn advance(&mut self, samples: u32, threads: usize) -> Result<(), String> {
        let whole = self.prepared.whole(Some(threads));
        if self.choice.adaptive && self.allocation.is_none() {
            // Its time counts: it is what uneven shares cost.
            let goal = Goal { samples: EXPLORED_FOR, relative_rmse: None };
            let (found, seconds) =
                timed(threads, || explore(&self.prepared, whole.rect, &goal, Some(threads), &|| false, &|_| ()));
            self.allocation = Some(found.map_err(|error| error.to_string())?.allocation);
            self.seconds += seconds;
        }
        let (stage, replicates) = (self.samples..samples, self.prepared.scene().integrator.replicates);
        let tiles = self.allocation.as_ref().map(|allocation| allocation.tiles(whole.rect, stage.clone(), replicates));
        let (done, seconds) = timed(threads, || match tiles {
            None => {
                let extent = Extent { samples: stage, ..whole };
                self.prepared.render_onto(&mut self.film, &extent, &|_| Control::Continue)
            }
            Some(tiles) => {
                self.prepared.render_tiles_onto(&mut self.film, &tiles, Some(threads), &|_| Control::Continue)
            }
        });
        done.map_err(|error| error.to_string())?;
        self.samples = samples;
        self.seconds += seconds;
        Ok(())
    }

    fn stage(&self, error: Option<f64>) -> Stage {
        Stage { samples: self.samples, seconds: self.seconds, error, xyz: self.film.xyz().collect() }
    }

    fn scatter(&self) -> Option<f64> {
        let error = self.film.error(self.prepared.whole(None).rect).filter(ImageError::is_known)?;
        Some(error.relative_rmse)
    }
}

/// Samples a pixel of which an adaptive picture's exploration is a part: what a study reaches.
const EXPLORED_FOR: u32 = 128;

/// First number of samples a pixel, and the factor to the next: a replicate of four has whole powers of two.
const FIRST: u32 = 4;
const FACTOR: u32 = 4;

/// Studies a scene; `said` hears what is being done.
pub(super) fn study(
    name: &str,
    scene: &Scene,
    truth: Option<f64>,
    effort: &Effort,
    said: &dyn Fn(&str),
) -> Result<SceneStudy, String> {
    let plan = prepare_study(scene, &Default::default()).map_err(|error| error.to_string())?.plan().clone();
    let wanted = |choice: &Choice| {
        let named = |part: &String| choice.name.contains(part.as_str()) || choice.group.contains(part.as_str());
        choice.name == BASELINE || effort.only.is_empty() || effort.only.iter().any(named)
    };
    let mut runners: Vec<Runner> = choices::of(scene, &plan)
        .into_iter()
        .filter(wanted)
        // A forced effect may contradict the scene; then there is no such choice.
        .filter_map(|choice| Runner::new(choice, effort.seed).ok())
        .collect();

    said(&format!("{name}: reference"));
    let mut reference_choice = choices::of(scene, &plan).swap_remove(0);
    reference_choice.scene.integrator.replicates = 4;
    // Any other seed: the reference's numbers are not those of the choices.
    let mut reference = Runner::new(reference_choice, effort.seed ^ 0x5265_6665_7265_6e63)?;
    let mut next = FIRST;
    loop {
        reference.advance(next, effort.threads)?;
        // To double the samples takes as long again as all of them did.
        if 2.0 * reference.seconds > effort.seconds * effort.reference {
            break;
        }
        next *= 2;
    }
    let truth_picture: Vec<f64> = reference.film.xyz().map(|xyz| xyz[1]).collect();
    let mean_y = truth_picture.iter().sum::<f64>() / truth_picture.len() as f64;
    let known = reference.scatter();
    let own = known.unwrap_or(0.0);
    let heavy_tailed = reference.film.error(reference.prepared.whole(None).rect).is_some_and(|e| e.is_heavy_tailed());

    // All choices at one number of samples, then all at the next: what disturbs the machine disturbs all alike.
    let mut pictures = Vec::new();
    let mut next = FIRST;
    loop {
        let mut went_on = false;
        for runner in &mut runners {
            let so_far = runner.seconds;
            if so_far > 0.0 && so_far * f64::from(FACTOR) > effort.seconds {
                continue;
            }
            said(&format!("{name}: {} at {next} samples", runner.choice.name));
            runner.advance(next, effort.threads)?;
            let error = error_to(&runner.film, &truth_picture, mean_y, own);
            let scatter = runner.scatter();
            runner.points.push(Point { samples: next, seconds: runner.seconds, error, scatter });
            if runner.choice.name == BASELINE {
                pictures.push(runner.stage(error.or(scatter)));
            }
            went_on = true;
        }
        if !went_on {
            break;
        }
        next *= FACTOR;
    }
    pictures.push(reference.stage(known));
    let baseline = runners[0].seconds / f64::from(runners[0].samples);
    let rows = runners.iter().map(|runner| row(runner, baseline, truth, mean_y, own)).collect();
    Ok(SceneStudy {
        scene: name.to_owned(),
        width: scene.film.width,
        height: scene.film.height,
        truth,
        reference: Reference {
            samples: reference.samples,
            seconds: reference.seconds,
            mean_y,
            relative_rmse: known,
            heavy_tailed,
        },
        rows,
        pictures,
    })
}

/// √(mean (Y − reference)²/mean² − own²), `None` where the reference's own error explains it.
fn error_to(film: &Film, reference: &[f64], mean_y: f64, own: f64) -> Option<f64> {
    let squares: f64 = film.xyz().zip(reference).map(|(xyz, r)| (xyz[1] - r) * (xyz[1] - r)).sum();
    let square = squares / reference.len() as f64 / (mean_y * mean_y) - own * own;
    // Below the reference's own error the difference of two squares is noise.
    (square > own * own).then(|| square.sqrt())
}

fn row(runner: &Runner, baseline: f64, truth: Option<f64>, reference_y: f64, own: f64) -> Row {
    let last = runner.points[runner.points.len() - 1];
    let whole = runner.prepared.whole(None).rect;
    let pixels = whole.area() as f64;
    let (level, own) = truth.map_or((reference_y, own), |truth| (truth, 0.0));
    let bias = Some((runner.film.mean_y(whole) - level) / level).filter(|bias| bias.is_finite());
    // Pixels are independent, so the mean of all has the error of one over the root of their number.
    let z = last.scatter.or(last.error).zip(bias).map(|(scatter, bias)| bias / (scatter.hypot(own) / pixels.sqrt()));
    let counters = &runner.film.counters;
    let error = last.error.or(last.scatter);
    Row {
        group: runner.choice.group,
        choice: runner.choice.name.clone(),
        seconds: runner.seconds,
        samples: runner.samples,
        rays_per_path: counters.rays as f64 / counters.paths as f64,
        shadow_rays_per_path: counters.shadow_rays as f64 / counters.paths as f64,
        error,
        scatter: last.scatter,
        efficiency: error.filter(|&error| error > 0.0).map(|error| 1.0 / (error * error * runner.seconds)),
        relative_cost: runner.seconds / f64::from(runner.samples) / baseline,
        bias,
        z: z.filter(|z| z.is_finite()),
        slope: slope(&runner.points),
        points: runner.points.clone(),
        approximations: runner.prepared.plan().approximations.clone(),
    }
}

/// The points whose error no later one exceeds. Where rare bright paths carry the error, a few samples have met none of them and
/// look better than many.
pub(super) fn believable(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let exceeded = |index: usize| points[index + 1..].iter().any(|later| later.1 > points[index].1);
    (0..points.len()).filter(|&index| !exceeded(index)).map(|index| points[index]).collect()
}

/// Least squares through the logarithms.
fn slope(points: &[Point]) -> Option<f64> {
    let seen: Vec<(f64, f64)> = points
        .iter()
        .filter_map(|point| Some((f64::from(point.samples), point.scatter.or(point.error)?)))
        .filter(|(_, error)| *error > 0.0 && error.is_finite())
        .collect();
    let logs: Vec<(f64, f64)> = believable(&seen).into_iter().map(|(n, error)| (n.ln(), error.ln())).collect();
    if logs.len() < 2 {
        return None;
    }
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let (sxy, sxx) =
        logs.iter().fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mx) * (y - my), xx + (x - mx) * (x - mx)));
    Some(-sxy / sxx)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_is_that_of_a_power_law() {
        let point = |samples: u32| Point {
            samples,
            seconds: 1.0,
            error: None,
            scatter: Some(3.0 * f64::from(samples).powf(-0.75)),
        };
        let slope_of = slope(&[4, 16, 64].map(point)).unwrap();
        assert!((slope_of - 0.75).abs() < 1e-12);
        assert_eq!(slope(&[point(4)]), None);
        // Four samples that have not met what sixteen have.
        let lucky = Point { scatter: Some(0.001), ..point(4) };
        assert!((slope(&[lucky, point(16), point(64)]).unwrap() - 0.75).abs() < 1e-12);
    }
}
