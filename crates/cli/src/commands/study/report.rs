//! A study in words and tables.

use std::fmt::Write;

use super::StudyReport;
use super::measure::{Point, Row, SceneStudy, believable};
use crate::progress::{duration, percent, two_digits};

/// The columns of the table of a scene.
const COLUMNS: [&str; 11] = [
    "choice",
    "seconds",
    "samples",
    "rays/path",
    "shadow rays/path",
    "error",
    "slope",
    "time/sample",
    "efficiency",
    "bias",
    "z",
];

/// What the columns mean.
pub(super) const LEGEND: &str = "\
Seconds are processor time divided by the number of threads. The **error** is the root mean square over all pixels of the \
error of luminance, divided by the mean luminance of the picture. It is measured against the reference, and the error of \
the reference is subtracted. If it is no larger than the error of the reference, it comes from the scatter of the \
replicates of the picture instead. **Slope**: with n samples the scatter falls as n to the power −slope. Independent \
numbers have a slope of 0.5. **Efficiency** is 1/(error² · seconds), relative to the scene as it is. **Bias** is the \
difference of the mean luminance from that of the reference, or from the truth where it is known. z is the bias divided by \
its standard error. A z beyond ±4 is hardly chance. Time per sample is relative to the scene as it is. Some choices trace \
one path at a time, although the scene as it is traces many at once. They say so, and their times compare with the row \
\"one path at a time\".";

/// The cells of a row.
pub(super) fn cells(row: &Row, study: &SceneStudy) -> [String; 11] {
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "–".to_owned());
    let unit = study.rows[0].efficiency;
    [
        row.choice.clone(),
        two_digits(row.seconds),
        row.samples.to_string(),
        format!("{:.2}", row.rays_per_path),
        format!("{:.2}", row.shadow_rays_per_path),
        or_dash(row.error.map(percent)),
        or_dash(row.slope.map(|slope| format!("{slope:.2}"))),
        format!("{:.2}", row.relative_cost),
        or_dash(row.efficiency.zip(unit).map(|(own, unit)| two_digits(own / unit))),
        or_dash(row.bias.map(|bias| format!("{:+.2} %", 100.0 * bias))),
        or_dash(row.z.map(|z| format!("{z:+.1}"))),
    ]
}

pub(super) fn columns() -> [&'static str; 11] {
    COLUMNS
}

/// One line about the reference.
pub(super) fn about(study: &SceneStudy) -> String {
    let reference = &study.reference;
    let truth = study.truth.map_or_else(String::new, |truth| format!(" The mean luminance is known to be {truth}."));
    let tails = match reference.heavy_tailed {
        true => {
            " Rare bright paths cause most of the error, so the errors, efficiencies and slopes of this scene are inaccurate."
        }
        false => "",
    };
    format!(
        "{} × {} pixels. Reference: {} samples a pixel, error {}, mean luminance {:.5}.{truth}{tails}",
        study.width,
        study.height,
        reference.samples,
        reference.relative_rmse.map_or_else(|| "unknown (no sample found light)".to_owned(), percent),
        reference.mean_y
    )
}

/// Errors of which a headline states the time, the smallest first.
const ERRORS: [f64; 5] = [0.01, 0.02, 0.05, 0.1, 0.2];

/// Groups of choices that leave the picture and its error bars as they are, so that their times to an error can be compared.
const SAME_PICTURE: [&str; 6] = ["where samples go", "paths", "sampler", "wavelengths", "direct light", "roulette"];

/// What a scene costs, and which choice changes that most, in a few sentences.
pub(super) fn headline(study: &SceneStudy) -> String {
    let baseline = &study.rows[0];
    let reached = falling(&baseline.points);
    let cost = ERRORS.iter().find_map(|&error| Some((error, time_to(&reached, error)?)));
    let cost = match (cost, baseline.error) {
        (Some((error, seconds)), _) => format!("{} error after {}.", percent(error), duration(seconds)),
        (None, Some(error)) => format!("{} error after {}.", percent(error), duration(baseline.seconds)),
        (None, None) => return "No error was found.".to_owned(),
    };
    if study.reference.heavy_tailed {
        return format!("{cost} Rare bright paths cause most of the error, so choices cannot be compared well.");
    }
    let compared = |row: &&Row| {
        SAME_PICTURE.contains(&row.group)
            && row.choice != "three channels (RGB)"
            && row.z.is_none_or(|z| z.abs() < 4.0)
            && row.error.is_some_and(|error| error > ROUNDING)
    };
    // Time to the same error, over that of the scene as it is.
    let ratio = |row: &Row| Some(baseline.efficiency? / row.efficiency?);
    let ratios = study.rows[1..].iter().filter(compared).filter_map(|row| Some((row.choice.as_str(), ratio(row)?)));
    let mut ratios: Vec<(&str, f64)> = ratios.collect();
    ratios.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut said = vec![cost];
    if let Some(&(choice, ratio)) = ratios.first()
        && ratio < 1.0 / NOTABLE
    {
        said.push(format!("Best change: {choice}, {} of the time for the same error.", two_digits(ratio)));
    }
    if let Some(&(choice, ratio)) = ratios.last()
        && ratio > NOTABLE
    {
        said.push(format!("Worst: {choice}, {} times as long.", two_digits(ratio)));
    }
    said.join(" ")
}

/// Errors below this are of rounding, not of chance: a choice without noise has no time to an error.
const ROUNDING: f64 = 1e-6;

/// Ratios of times nearer to 1 are not worth a sentence.
const NOTABLE: f64 = 1.1;

/// One line about the whole.
pub(super) fn heading(report: &StudyReport) -> String {
    format!(
        "Measured by `{}` ({}{}) on {} threads of {}, in {}.",
        report.command,
        report.machine.software,
        report.commit.as_ref().map(|commit| format!(", commit {commit}")).unwrap_or_default(),
        report.machine.threads,
        report.machine.processor,
        duration(report.seconds)
    )
}

/// What one scene says about the samplers.
pub(super) struct Verdict {
    pub scene: String,
    /// Time to the same error, independent numbers over Owen-Sobol; `None` where there is no error.
    pub gain: Option<f64>,
    /// Whether rare bright paths make that poorly known.
    pub heavy_tailed: bool,
    pub sobol_slope: Option<f64>,
    pub independent_slope: Option<f64>,
}

impl Verdict {
    /// The cells of a table.
    pub(super) fn cells(&self) -> [String; 4] {
        let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"));
        let scene = if self.heavy_tailed { format!("{} (rare paths)", self.scene) } else { self.scene.clone() };
        [scene, number(self.gain), number(self.sobol_slope), number(self.independent_slope)]
    }
}

/// The verdict on the samplers.
pub(super) fn samplers(report: &StudyReport) -> Vec<Verdict> {
    report
        .scenes
        .iter()
        .filter_map(|study| {
            let find = |name: &str| study.rows.iter().find(|row| row.choice == name);
            let baseline = &study.rows[0];
            // The baseline is the one of the two that the scene says.
            let independent = find("independent numbers").unwrap_or(baseline);
            let sobol = find("Owen-Sobol").unwrap_or(baseline);
            if std::ptr::eq(independent, sobol) {
                return None;
            }
            Some(Verdict {
                scene: study.scene.clone(),
                gain: time_ratio(&independent.points, &sobol.points),
                heavy_tailed: study.reference.heavy_tailed,
                sobol_slope: sobol.slope,
                independent_slope: independent.slope,
            })
        })
        .collect()
}

/// What a default sampler may lose on a scene.
const TOLERATED: f64 = 0.95;

/// All scenes together in a sentence.
pub(super) fn verdict(samplers: &[Verdict]) -> String {
    let known: Vec<(&str, f64)> = samplers.iter().filter_map(|one| Some((one.scene.as_str(), one.gain?))).collect();
    let sooner = known.iter().filter(|(_, gain)| *gain > 1.0).count();
    let worse: Vec<String> = known
        .iter()
        .filter(|(_, gain)| *gain < TOLERATED)
        .map(|(scene, gain)| format!("{scene} ({gain:.2})"))
        .collect();
    let poorly: Vec<&str> = samplers.iter().filter(|one| one.heavy_tailed).map(|one| one.scene.as_str()).collect();
    let poorly = match poorly.as_slice() {
        [] => String::new(),
        names => format!(
            " On these scenes rare bright paths cause most of the error, so this is inaccurate: {}.",
            names.join(", ")
        ),
    };
    let lost = if worse.is_empty() { "none".to_owned() } else { worse.join(", ") };
    format!(
        "Owen-Sobol reaches the same error sooner on {sooner} of {} scenes. Scenes on which it loses more than 5 %: {lost}.{poorly}",
        known.len()
    )
}

/// Time of `a` over that of `b` to the smallest error that both have reached.
fn time_ratio(a: &[Point], b: &[Point]) -> Option<f64> {
    let [a, b] = [a, b].map(falling);
    let smallest = |points: &[(f64, f64)]| points.last().map(|point| point.1);
    let error = smallest(&a)?.max(smallest(&b)?);
    Some(time_to(&a, error)? / time_to(&b, error)?)
}

/// Seconds and errors of points, as far as they can be believed.
fn falling(points: &[Point]) -> Vec<(f64, f64)> {
    let seen: Vec<(f64, f64)> = points
        .iter()
        .filter_map(|point| Some((point.seconds, point.error.or(point.scatter)?)))
        .filter(|(_, error)| *error > 0.0)
        .collect();
    believable(&seen)
}

/// When the error, which falls from point to point, passed `error`: as a power of time between the two points about it.
fn time_to(points: &[(f64, f64)], error: f64) -> Option<f64> {
    let after = points.iter().position(|point| point.1 <= error)?;
    let Some(before) = after.checked_sub(1) else {
        // It may have been reached before: the time is an upper bound.
        return Some(points[after].0);
    };
    let ((t0, e0), (t1, e1)) = (points[before], points[after]);
    Some(t0 * ((e0 / error).ln() / (e0 / e1).ln() * (t1 / t0).ln()).exp())
}

/// The whole study as Markdown; pictures and plots are files beside it.
pub(super) fn markdown(report: &StudyReport, files: &[(String, Vec<String>)]) -> String {
    let mut text = format!("# What accuracy costs in time\n\n{}\n\n{LEGEND}\n", heading(report));
    let samplers = samplers(report);
    if !samplers.is_empty() {
        let _ = write!(text, "\n## Owen-Sobol against independent numbers\n\n{}\n\n", verdict(&samplers));
        text.push_str(
            "| scene | time to the same error, independent over Sobol | slope of Sobol | slope of independent |\n",
        );
        text.push_str("|---|---:|---:|---:|\n");
        for scene in &samplers {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "| {} |", scene.cells().join(" | "));
        }
    }
    for study in &report.scenes {
        let files = files.iter().find(|(scene, _)| *scene == study.scene).map_or(&[][..], |(_, files)| files);
        let _ = write!(text, "\n## {}\n\n{} {}\n\n", study.scene, headline(study), about(study));
        let _ = writeln!(text, "| {} |", columns().join(" | "));
        let _ = writeln!(text, "|---|{}", "---:|".repeat(columns().len() - 1));
        for row in &study.rows {
            let _ = writeln!(text, "| {} |", cells(row, study).join(" | "));
        }
        text.push('\n');
        for file in files {
            let _ = writeln!(text, "![{file}]({file})");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::measure::Reference;
    use super::*;

    fn points(constant: f64, slope: f64) -> Vec<Point> {
        [4_u32, 16, 64]
            .map(|samples| Point {
                samples,
                seconds: 0.1 * f64::from(samples),
                error: Some(constant * f64::from(samples).powf(-slope)),
                scatter: None,
            })
            .to_vec()
    }

    /// 1/√n meets n^−1 at the smallest error of the slower, 1/8, after 64 samples: the other takes 8.
    #[test]
    fn the_time_to_an_error_is_read_between_the_points() {
        let ratio = time_ratio(&points(1.0, 0.5), &points(1.0, 1.0)).unwrap();
        assert!((ratio - 8.0).abs() < 1e-9, "{ratio}");
        let ratio = time_ratio(&points(1.0, 0.5), &points(1.1, 0.5)).unwrap();
        assert!((ratio - 1.0 / 1.21).abs() < 1e-9, "{ratio}");
        assert_eq!(time_ratio(&points(0.0, 0.5), &points(0.0, 0.5)), None);
    }

    /// A choice of this group and name, whose efficiency is this many times that of the scene as it is.
    fn choice(group: &'static str, name: &str, efficiency: f64) -> Row {
        let points = points(0.8, 0.5);
        let last = points[2];
        Row {
            group,
            choice: name.to_owned(),
            seconds: last.seconds,
            samples: last.samples,
            rays_per_path: 2.0,
            shadow_rays_per_path: 1.0,
            error: last.error,
            scatter: last.scatter,
            efficiency: Some(efficiency),
            relative_cost: 1.0,
            bias: Some(0.0),
            z: Some(0.5),
            slope: Some(0.5),
            points,
            approximations: Vec::new(),
        }
    }

    /// Errors are 40, 20 and 10 % after 0.4, 1.6 and 6.4 s.
    #[test]
    fn a_headline_states_the_cost_and_the_choices_that_change_it_most() {
        let biased = Row { z: Some(9.0), ..choice("roulette", "no roulette", 50.0) };
        let without_noise = Row { error: Some(1e-9), ..choice("direct light", "lights only", 1e12) };
        let mut study = SceneStudy {
            scene: "box".to_owned(),
            width: 8,
            height: 8,
            truth: None,
            reference: Reference {
                samples: 64,
                seconds: 1.0,
                mean_y: 1.0,
                relative_rmse: Some(0.01),
                heavy_tailed: false,
            },
            rows: vec![
                choice("baseline", "as it is", 1.0),
                choice("where samples go", "adaptive", 4.0),
                choice("sampler", "independent numbers", 0.5),
                // Each of these makes another picture, or has no noise.
                choice("wavelengths", "three channels (RGB)", 8.0),
                choice("effects", "without lens", 9.0),
                biased,
                without_noise,
            ],
            pictures: Vec::new(),
        };
        assert_eq!(
            headline(&study),
            "10 % error after 6.4 s. Best change: adaptive, 0.25 of the time for the same error. \
             Worst: independent numbers, 2.0 times as long."
        );
        study.rows.truncate(1);
        assert_eq!(headline(&study), "10 % error after 6.4 s.");
        study.reference.heavy_tailed = true;
        assert!(headline(&study).ends_with("choices cannot be compared well."));
    }

    #[test]
    fn a_sampler_that_loses_is_named() {
        let one = |scene: &str, gain| Verdict {
            scene: scene.to_owned(),
            gain,
            heavy_tailed: scene == "glass",
            sobol_slope: None,
            independent_slope: None,
        };
        let said = verdict(&[one("box", Some(2.0)), one("fog", Some(0.96)), one("glass", Some(0.9)), one("sky", None)]);
        assert!(
            said.contains("1 of 3") && said.contains("5 %: glass (0.90).") && said.ends_with("inaccurate: glass."),
            "{said}"
        );
        assert_eq!(one("sky", None).cells(), ["sky", "–", "–", "–"]);
    }
}
