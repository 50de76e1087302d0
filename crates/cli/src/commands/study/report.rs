//! A study in words and tables.

use std::fmt::Write;

use super::StudyReport;
use super::measure::{Row, SceneStudy};
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
Seconds are processor time over threads. The **error** is the root mean square over all pixels of the error of luminance, in \
units of the picture's mean luminance, against the reference (whose own error is taken off) or, where that is no longer larger \
than the reference's, by the scatter of the picture's own replicates. **Slope** is how the scatter falls with the number of \
samples n, as n to the power −slope: 0.5 for independent numbers. **Efficiency** is 1/(error² · seconds), in units of the scene \
as it is. **Bias** is the difference of the mean luminance to the reference's (or to the truth, where that is known), with its z: \
beyond ±4 it is no accident. Time a sample is relative to the scene as it is.";

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
        format!("{:+.2} %", 100.0 * row.bias),
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
    format!(
        "{} × {} pixels. Reference: {} samples a pixel, error {}, mean luminance {:.5}.{truth}",
        study.width,
        study.height,
        reference.samples,
        percent(reference.relative_rmse),
        reference.mean_y
    )
}

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

/// The verdict on the samplers: time to the same error, independent numbers over Owen-Sobol.
pub(super) fn samplers(report: &StudyReport) -> Vec<(String, f64, f64, f64)> {
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
            let gain = sobol.efficiency? / independent.efficiency?;
            Some((study.scene.clone(), gain, sobol.slope?, independent.slope?))
        })
        .collect()
}

/// The whole study as Markdown; plots are files beside it.
pub(super) fn markdown(report: &StudyReport, plots: &[(String, Vec<String>)]) -> String {
    let mut text = format!("# What accuracy costs in time\n\n{}\n\n{LEGEND}\n", heading(report));
    let samplers = samplers(report);
    if !samplers.is_empty() {
        text.push_str("\n## Owen-Sobol against independent numbers\n\n");
        text.push_str(
            "| scene | time to the same error, independent over Sobol | slope of Sobol | slope of independent |\n",
        );
        text.push_str("|---|---:|---:|---:|\n");
        for (scene, gain, sobol, independent) in samplers {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "| {scene} | {gain:.2} | {sobol:.2} | {independent:.2} |");
        }
    }
    for study in &report.scenes {
        let _ = write!(text, "\n## {}\n\n{}\n\n", study.scene, about(study));
        let _ = writeln!(text, "| {} |", columns().join(" | "));
        let _ = writeln!(text, "|---|{}", "---:|".repeat(columns().len() - 1));
        for row in &study.rows {
            let _ = writeln!(text, "| {} |", cells(row, study).join(" | "));
        }
        for (_, files) in plots.iter().filter(|(scene, _)| *scene == study.scene) {
            text.push('\n');
            for file in files {
                let _ = writeln!(text, "![{file}]({file})");
            }
        }
    }
    text
}
