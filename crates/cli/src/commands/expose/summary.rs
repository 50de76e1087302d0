//! What is said of an exposure: signal, noise, saturation, and what may be wrong with it.

use std::path::{Path, PathBuf};

use etalon_picture::expose::{ChannelReport, RawFrame, RenderNoise, SensorExposure};
use miette::{Report, Severity, miette};
use serde::Serialize;

use crate::progress::{percent, two_digits};

/// The noise of a render is small beside that of the sensor up to this share. It then makes the whole noise at most 2 % larger.
const SMALL: f64 = 0.2;

/// The share of a sensor's response that a picture may leave out without a warning.
const LEFT_OUT: f64 = 0.01;

/// What `--json` prints.
#[derive(Serialize)]
pub(super) struct ExposureJson {
    picture: String,
    sensor: String,
    sensor_sha256: String,
    seed: u64,
    frames: Vec<FrameJson>,
}

/// What it prints of one exposure.
#[derive(Serialize)]
pub(super) struct FrameJson {
    frame: u32,
    outputs: Vec<String>,
    unusable_pixels: usize,
    channels: Vec<ChannelJson>,
}

#[derive(Serialize)]
struct ChannelJson {
    channel: String,
    pixels: usize,
    mean_photoelectrons: f64,
    mean_dn: f64,
    signal_to_noise: f64,
    saturated_pixels: usize,
    below_zero_pixels: usize,
    /// Share of the response to an even spectrum that lies outside of the bands.
    response_outside_bands: f64,
    /// The noise of the render over that of the sensor, at most; null where it is not known.
    render_over_sensor_noise: Option<f64>,
}

impl ExposureJson {
    pub(super) fn new(picture: &Path, sensor: &Path, sha256: &str, seed: u64, frames: Vec<FrameJson>) -> Self {
        let [picture, sensor] = [picture, sensor].map(|path| path.display().to_string());
        Self { picture, sensor, sensor_sha256: sha256.to_owned(), seed, frames }
    }
}

impl FrameJson {
    pub(super) fn new(frame: u32, outputs: &[PathBuf], raw: &RawFrame) -> Self {
        let channels = raw.channels.iter().map(|report| ChannelJson {
            channel: report.name.clone(),
            pixels: report.pixels,
            mean_photoelectrons: report.mean_photo_e,
            mean_dn: report.mean_dn,
            signal_to_noise: report.signal_to_noise,
            saturated_pixels: report.saturated,
            below_zero_pixels: report.below_zero,
            response_outside_bands: report.share_outside,
            render_over_sensor_noise: report.render_noise.and_then(|noise| noise.over_sensor_noise),
        });
        let outputs = outputs.iter().map(|path| path.display().to_string()).collect();
        Self { frame, outputs, unusable_pixels: raw.unusable.count, channels: channels.collect() }
    }
}

/// What was written, and if `whole` what became of the light.
pub(super) fn describe(outputs: &[PathBuf], raw: &RawFrame, whole: bool) -> String {
    let names: Vec<String> = outputs.iter().map(|path| path.display().to_string()).collect();
    let mut text = format!("wrote {}: {} × {} pixels", names.join(", "), raw.picture.width(), raw.picture.height());
    if whole {
        raw.channels.iter().for_each(|report| text += &format!("\n  {}", of_channel(report)));
    }
    text
}

fn of_channel(report: &ChannelReport) -> String {
    if report.pixels == 0 {
        return format!("{}: no pixels", report.name);
    }
    let mut text = format!(
        "{}: mean signal {:.1} e⁻, {:.1} DN; signal-to-noise ratio of a pixel with the mean signal {:.1}",
        report.name, report.mean_photo_e, report.mean_dn, report.signal_to_noise
    );
    if report.signal_to_noise > 0.0 {
        text += &format!(" ({:.1} dB)", 20.0 * report.signal_to_noise.log10());
    }
    text += &format!("; saturated {}", share(report.saturated, report.pixels));
    match report.render_noise {
        Some(RenderNoise { over_sensor_noise: Some(ratio), .. }) => {
            text += &format!("; noise of the render at most {} of the sensor's", percent(ratio));
        }
        _ => text += "; noise of the render not known",
    }
    text
}

/// What may be wrong with an exposure.
pub(super) fn warnings(picture: &Path, exposure: &SensorExposure, raw: &RawFrame) -> Vec<Report> {
    let path = picture.display();
    let mut found = Vec::new();
    if !exposure.states_unit() {
        found.push(miette!(
            severity = Severity::Warning,
            code = "no-unit",
            "`{path}` does not state the unit of its bands; they are read as W/(m² sr nm)"
        ));
    }
    let [used, of_lens] = exposure.sines();
    if (used / of_lens - 1.0).abs() > 0.01 {
        found.push(miette!(
            severity = Severity::Warning,
            code = "other-lens",
            help = "leave \"f_number\" and \"numerical_aperture\" out of the sensor, and the lens of the picture is used",
            "`{path}` was rendered through a lens with sin θ = {of_lens:.4}, and the sensor states {used:.4}, which is used"
        ));
    }
    if let Some([x, y]) = raw.unusable.first {
        found.push(miette!(
            severity = Severity::Warning,
            code = "not-light",
            help = "their digital numbers are NaN",
            "`{path}`: the light of {} pixels is not finite or negative, first in column {x}, row {y}",
            raw.unusable.count
        ));
    }
    for report in raw.channels.iter().filter(|report| report.pixels > 0) {
        found.extend(of_light(report));
        found.extend(of_noise(report));
    }
    found
}

/// Light that is missing, and numbers that were cut at 0.
fn of_light(report: &ChannelReport) -> Vec<Report> {
    let mut found = Vec::new();
    let name = &report.name;
    if report.share_outside > LEFT_OUT {
        found.push(miette!(
            severity = Severity::Warning,
            code = "light-outside-bands",
            help = "render with bands over all wavelengths to which the sensor responds",
            "channel {name}: {} of its response to an even spectrum is outside of the bands of the picture, and that light is missing",
            percent(report.share_outside)
        ));
    }
    if report.below_zero > 0 {
        found.push(miette!(
            severity = Severity::Warning,
            code = "below-zero",
            help = "raise \"black_level_dn\" of the sensor",
            "channel {name}: the noise takes {} of the pixels below 0, where the digital number is cut",
            share(report.below_zero, report.pixels)
        ));
    }
    found
}

/// A render whose noise would be taken for that of the sensor.
fn of_noise(report: &ChannelReport) -> Vec<Report> {
    let mut found = Vec::new();
    let (name, Some(noise)) = (&report.name, report.render_noise) else { return found };
    if noise.unknown > 0 {
        found.push(miette!(
            severity = Severity::Warning,
            code = "unknown-error",
            help = "render with more samples, so that each band of each pixel has some",
            "channel {name}: the error of {} of the pixels is not known, because a band has too few samples",
            share(noise.unknown, report.pixels)
        ));
    }
    if let Some(ratio) = noise.over_sensor_noise.filter(|ratio| *ratio > SMALL) {
        let times = (ratio / SMALL) * (ratio / SMALL);
        found.push(miette!(
            severity = Severity::Warning,
            code = "render-noise",
            help = format!("{} times the samples bring it to {}", two_digits(times), percent(SMALL)),
            "channel {name}: the noise of the render itself may be {} of the noise of the sensor",
            percent(ratio)
        ));
    }
    found
}

/// A number of pixels as a part of all.
fn share(count: usize, of: usize) -> String {
    percent(count as f64 / of as f64)
}
