//! The whole chain against closed forms.
//!
//! Every statistical test has a significance of 1e-6. With 65,536 pixels it sees, with the power that the verdict states, a bias of the mean
//! of 0.03 standard deviations and of the variance of 5 %; with 262,144 pixels half of that.

use etalon_optics::spectrum::{Blackbody, Outside, Tabulated};
use etalon_oracle::statistics::{Estimate, z_verdict};

use super::*;
use crate::{Attribute, Attributes, ExrFile, Picture, Window, encode_exr};

const SIGNIFICANCE: f64 = 1e-6;

fn sensor() -> Sensor {
    Sensor {
        pixel_pitch_m: 5e-6,
        exposure_s: 0.02,
        numerical_aperture: Some(0.125),
        lens_transmittance: 1.0,
        channels: vec![channel("mono", QuantumEfficiency::Constant(0.5))],
        mosaic: None,
        full_well_e: 60_000,
        dark_current_e_per_s: 150.0,
        read_noise_e: 4.0,
        gain_e_per_dn: 2.5,
        black_level_dn: 200.0,
        bits: 16,
        prnu: 0.0,
        dsnu_e: 0.0,
        pattern_seed: 3,
    }
}

fn channel(name: &str, quantum_efficiency: QuantumEfficiency) -> SensorChannel {
    SensorChannel { name: name.to_owned(), quantum_efficiency }
}

fn table(nm: &[f64], values: &[f64], outside: Outside) -> QuantumEfficiency {
    QuantumEfficiency::Table(Tabulated::new(nm.to_vec(), values.to_vec(), outside).unwrap())
}

/// A picture of one radiance everywhere, in bands of 20 nm from 490 to 550 nm.
fn flat(width: usize, height: usize, radiance: f32) -> ExrFile {
    let mut picture = Picture::new(width, height).unwrap();
    for nm in [500, 520, 540] {
        picture.insert(&format!("S0.{nm},000000nm"), vec![radiance; width * height]).unwrap();
    }
    ExrFile { picture, attributes: Attributes::new() }
}

/// Mean electrons for a radiance of 1 in [`flat`] on [`sensor`], by EMVA's rule for one wavelength. That is 50.34 photons for 1 µm², 1 ms, 1 µm and
/// 1 µW/cm², here with more digits. It is taken at the middle wavelength, since photons grow evenly with it.
fn electrons_of_radiance_1() -> f64 {
    // f/4: E = πL/(4 · 4²); 60 nm; 100 µW/cm² are 1 W/m².
    let irradiance_uw_cm2 = std::f64::consts::PI / 64.0 * 60.0 * 100.0;
    0.5 * 50.341_165_67 * 25.0 * 20.0 * 0.52 * irradiance_uw_cm2
}

fn shoot(file: &ExrFile, sensor: &Sensor, seed: u64) -> RawFrame {
    let settings = ExposureSettings { seed, ..ExposureSettings::default() };
    SensorExposure::new(file, sensor).unwrap().frame(&settings).unwrap()
}

fn dn(frame: &RawFrame) -> Vec<f64> {
    frame.picture.require("DN").unwrap().iter().map(|v| f64::from(*v)).collect()
}

/// Mean and variance.
fn moments(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    [mean, values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)]
}

#[track_caller]
fn agrees(what: &str, found: f64, error: f64, truth: f64) {
    let verdict = z_verdict(what, &Estimate::new(found, error), truth, 0.0, SIGNIFICANCE);
    assert!(verdict.pass, "{verdict:?}");
}

/// µ = black + (µₑ + µ_d)/g and σ² = (µₑ + µ_d + σ_r²)/g² + 1/12.
#[test]
fn a_flat_field_has_the_mean_and_the_variance_of_the_photon_transfer_curve() {
    let sensor = sensor();
    let mut curve = Vec::new();
    for electrons in [0.0, 5.0, 100.0, 2000.0, 40_000.0] {
        let radiance = (electrons / electrons_of_radiance_1()) as f32;
        let values = dn(&shoot(&flat(512, 512, radiance), &sensor, 1));
        let [mean, variance] = moments(&values);
        let raised = electrons + 150.0 * 0.02;
        let truth = (raised + 16.0) / 6.25 + 1.0 / 12.0;
        let n = values.len() as f64;
        agrees("mean", mean, (truth / n).sqrt(), 200.0 + raised / 2.5);
        agrees("variance", variance, truth * (2.0 / n).sqrt(), truth);
        curve.push((mean, variance, truth * (2.0 / n).sqrt()));
    }
    // The slope of the curve is the system gain K = 1/g.
    let (low, high) = (curve[0], curve[4]);
    let slope = (high.1 - low.1) / (high.0 - low.0);
    agrees("slope", slope, high.2 / (high.0 - low.0), 1.0 / 2.5);
}

/// Each part of a fine Planck spectrum raises η λ/(hc) electrons a joule: by a sum of its own over 0.01 nm, with constants of its own.
#[test]
fn electrons_of_a_black_body_are_those_of_a_quadrature() {
    let body = Blackbody::new(3000.0, 1e-3).unwrap();
    let mut picture = Picture::new(1, 1).unwrap();
    for nm in 400..=700 {
        picture.insert(&format!("S0.{nm},000000nm"), vec![body.eval(f64::from(nm)) as f32]).unwrap();
    }
    let file = ExrFile { picture, attributes: Attributes::new() };
    let (nodes, values) = ([380.0, 450.3, 560.0, 700.9], [0.1, 0.55, 0.7, 0.2]);
    let sensor = Sensor { channels: vec![channel("G", table(&nodes, &values, Outside::Zero))], bits: 12, ..sensor() };
    let settings = ExposureSettings { electrons: true, ..ExposureSettings::default() };
    let frame = SensorExposure::new(&file, &sensor).unwrap().frame(&settings).unwrap();
    let found = f64::from(frame.picture.require("meanPhotoelectrons").unwrap()[0]);

    let efficiency = |nm: f64| {
        let i = nodes.iter().rposition(|node| *node <= nm).unwrap().min(2);
        values[i] + (values[i + 1] - values[i]) * (nm - nodes[i]) / (nodes[i + 1] - nodes[i])
    };
    // 1/(hc) = 5.034116567e24 photons a joule and metre.
    let photons: f64 = (0..30_100)
        .map(|i| 399.505 + 0.01 * f64::from(i))
        .map(|nm| 0.01 * efficiency(nm) * body.eval(nm) * 5.034_116_567e24 * nm * 1e-9)
        .sum();
    let truth = photons * std::f64::consts::PI * 0.125 * 0.125 * 25e-12 * 0.02;
    // Bands of 1 nm are even: that leaves 1e-5; a float of the file 1e-7.
    assert!((found / truth - 1.0).abs() < 3e-5, "{found} is not {truth}");
}

/// The picture of a compound lens states its sin θ₀. The sensor's own counts more.
#[test]
fn the_lens_of_the_picture_gives_the_cone_of_light_where_the_sensor_states_none() {
    let mut file = flat(1, 1, 1e-3);
    file.attributes.insert(IMAGE_NUMERICAL_APERTURE.to_owned(), Attribute::Double(0.25));
    let mean = |sine| {
        let sensor = Sensor { numerical_aperture: sine, ..sensor() };
        let exposure = SensorExposure::new(&file, &sensor).unwrap();
        let frame = exposure.frame(&ExposureSettings::default()).unwrap();
        (exposure.sines(), frame.channels[0].mean_photo_e / (1e-3 * electrons_of_radiance_1()))
    };
    for (stated, sines, times) in [(None, [0.25; 2], 4.0), (Some(0.125), [0.125, 0.25], 1.0)] {
        let (found, electrons) = mean(stated);
        assert_eq!(found, sines);
        assert!((electrons / times - 1.0).abs() < 1e-6, "{electrons}");
    }
}

#[test]
fn a_full_well_and_the_largest_number_both_saturate() {
    let bright = flat(16, 16, 1e6);
    let sensor = Sensor { read_noise_e: 0.0, ..sensor() };
    let well = shoot(&bright, &sensor, 1);
    assert!(dn(&well).iter().all(|v| *v == 200.0 + 60_000.0 / 2.5));
    assert_eq!((well.channels[0].saturated, well.channels[0].below_zero), (256, 0));
    let numbers = shoot(&bright, &Sensor { bits: 10, ..sensor.clone() }, 1);
    assert!(dn(&numbers).iter().all(|v| *v == 1023.0));
    assert_eq!(numbers.channels[0].saturated, 256);
    // Without a black level half of the noise is cut, and said to be.
    let dark = Sensor { black_level_dn: 0.0, dark_current_e_per_s: 0.0, read_noise_e: 20.0, ..sensor };
    let dark = shoot(&flat(64, 64, 0.0), &dark, 1);
    assert!(dn(&dark).iter().all(|v| *v >= 0.0));
    agrees("share below zero", dark.channels[0].below_zero as f64 / 4096.0, 0.5 / 64.0, 0.475);
}

/// The covariance of two exposures of one sensor is that of its fixed pattern: (PRNU² µₑ² + DSNU²)/g².
#[test]
fn the_fixed_pattern_is_of_the_sensor_and_grows_with_the_signal() {
    let sensor = Sensor { prnu: 0.02, dsnu_e: 6.0, ..sensor() };
    for electrons in [0.0, 500.0, 8000.0, 32_000.0] {
        let file = flat(256, 256, (electrons / electrons_of_radiance_1()) as f32);
        let frames = [1, 2].map(|seed| dn(&shoot(&file, &sensor, seed)));
        let [a, b] = frames.each_ref().map(|values| moments(values)[0]);
        let n = frames[0].len() as f64;
        let covariance = frames[0].iter().zip(&frames[1]).map(|(x, y)| (x - a) * (y - b)).sum::<f64>() / n;
        let pattern = ((0.02 * electrons).powi(2) + 36.0) / 6.25;
        let whole = pattern + (electrons + 19.0) / 6.25 + 1.0 / 12.0;
        agrees("covariance", covariance, ((whole * whole + pattern * pattern) / n).sqrt(), pattern);
        // Another specimen has another pattern.
        let other = dn(&shoot(&file, &Sensor { pattern_seed: 4, ..sensor.clone() }, 2));
        let covariance = frames[0].iter().zip(&other).map(|(x, y)| (x - a) * (y - b)).sum::<f64>() / n;
        agrees("covariance of two specimens", covariance, whole / n.sqrt(), 0.0);
    }
}

#[test]
fn an_exposure_has_the_same_bytes_on_any_number_of_threads_and_in_any_part() {
    let sensor = Sensor { prnu: 0.01, dsnu_e: 1.0, ..sensor() };
    let file = flat(37, 29, 1e-3);
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = ExposureSettings { seed: 9, frame: 2, electrons: true };
        let frame = pool.install(|| SensorExposure::new(&file, &sensor).unwrap().frame(&settings).unwrap());
        encode_exr(&frame.picture, &Attributes::new()).unwrap()
    };
    let one = bytes(1);
    assert!([2, 3, 16].into_iter().all(|threads| bytes(threads) == one));

    let whole = dn(&shoot(&file, &sensor, 9));
    let mut part = flat(5, 4, 1e-3);
    let window = Window { origin_px: [11, 7], frame_px: [37, 29] };
    part.picture = part.picture.in_frame(window).unwrap();
    let part = dn(&shoot(&part, &sensor, 9));
    for (i, value) in part.iter().enumerate() {
        assert_eq!(*value, whole[(7 + i / 5) * 37 + 11 + i % 5]);
    }
    // Another frame or seed is another exposure.
    let exposure = SensorExposure::new(&file, &sensor).unwrap();
    let next = exposure.frame(&ExposureSettings { seed: 9, frame: 1, ..ExposureSettings::default() }).unwrap();
    assert_ne!(dn(&next), whole);
    assert_ne!(dn(&shoot(&file, &sensor, 10)), whole);
}

/// Numbers that must not change, whatever the machine. They were computed once; a change of the algorithm changes them.
#[test]
fn an_exposure_has_these_numbers_on_every_machine() {
    let sensor = Sensor { prnu: 0.01, dsnu_e: 1.0, ..sensor() };
    let levels: Vec<f64> = [0.0, 2e-6, 1e-3, 2e-2]
        .into_iter()
        .flat_map(|radiance| dn(&shoot(&flat(3, 1, radiance), &sensor, 5)))
        .collect();
    assert_eq!(levels, PINNED);
}

const PINNED: [f64; 12] = [200.0, 202.0, 200.0, 201.0, 204.0, 201.0, 936.0, 980.0, 946.0, 15457.0, 15579.0, 15291.0];

#[test]
fn a_mosaic_has_one_channel_a_pixel_and_without_it_each_pixel_has_all() {
    let channels = vec![
        channel("R", QuantumEfficiency::Constant(0.1)),
        channel("G", QuantumEfficiency::Constant(0.4)),
        channel("B", QuantumEfficiency::Constant(0.2)),
    ];
    let mosaic = Mosaic::new(&[vec![0, 1], vec![1, 2]]).unwrap();
    let mut sensor = Sensor { channels, mosaic: Some(mosaic), ..sensor() };
    let file = flat(4, 4, (10_000.0 / electrons_of_radiance_1()) as f32);
    let settings = ExposureSettings { electrons: true, ..ExposureSettings::default() };
    let frame = SensorExposure::new(&file, &sensor).unwrap().frame(&settings).unwrap();
    let means = frame.picture.require("meanPhotoelectrons").unwrap();
    for (i, mean) in means.iter().enumerate() {
        let want = [[2000.0, 8000.0], [8000.0, 4000.0]][i / 4 % 2][i % 2];
        assert!((f64::from(*mean) / want - 1.0).abs() < 1e-6, "{i}: {mean}");
    }
    let told: Vec<_> = frame.channels.iter().map(|report| (report.name.as_str(), report.pixels)).collect();
    assert_eq!(told, [("R", 4), ("G", 8), ("B", 4)]);
    // The noise at the mean of green: 8000 + 3 + 16 + 2.5²/12.
    assert!((frame.channels[1].signal_to_noise - 8000.0 / 8019.52_f64.sqrt()).abs() < 1e-3);
    assert_eq!(frame.samples16().unwrap().channels, 1);

    sensor.mosaic = None;
    let frame = shoot(&file, &sensor, 1);
    let names: Vec<_> = frame.picture.channels().iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, ["DN.R", "DN.G", "DN.B"]);
    let colour = frame.samples16().unwrap();
    assert_eq!((colour.channels, colour.samples.len()), (3, 48));
    assert_eq!(f64::from(colour.samples[1]), f64::from(frame.picture.require("DN.G").unwrap()[0]));
    // Parts of a frame keep the phase of the mosaic, to the left of it too.
    let mosaic = Mosaic::new(&[vec![0, 1, 2]]).unwrap();
    assert_eq!([-4, -1, 0, 1, 5].map(|column| mosaic.at(column, -7)), [2, 2, 0, 1, 2]);
}

#[test]
fn what_is_no_light_is_counted_with_its_place_and_never_cut() {
    let mut file = flat(3, 2, 1e-3);
    let mut picture = Picture::new(3, 2).unwrap();
    for channel in file.picture.channels() {
        let mut samples = channel.samples.clone();
        if channel.name == "S0.500,000000nm" {
            (samples[1], samples[4], samples[5]) = (f32::NAN, -1.0, f32::INFINITY);
        }
        picture.insert(&channel.name, samples).unwrap();
    }
    file.picture = picture;
    let frame = shoot(&file, &sensor(), 1);
    assert_eq!(frame.unusable, UnusablePixels { count: 3, first: Some([1, 0]) });
    assert_eq!(frame.channels[0].pixels, 3);
    assert_eq!(dn(&frame).iter().map(|v| v.is_nan()).collect::<Vec<_>>(), [false, true, false, false, true, true]);
    assert!(frame.samples16().unwrap_err().to_string().contains("write an EXR"));
    // A band that the channel does not respond to has no part in it.
    let red = table(&[512.0, 560.0], &[0.5, 0.5], Outside::Zero);
    let frame = shoot(&file, &Sensor { channels: vec![channel("red", red)], ..sensor() }, 1);
    assert_eq!(frame.unusable.count, 0);
}

/// Bands with errors of 3 % each add up to at most 3 % of 10,000 electrons, whose own noise is √(10,000 + 3 + 16 + 2.5²/12).
#[test]
fn the_noise_of_the_render_is_told_beside_that_of_the_sensor() {
    let radiance = (10_000.0 / electrons_of_radiance_1()) as f32;
    let mut file = flat(8, 8, radiance);
    for nm in [500, 520, 540] {
        file.picture.insert(&format!("Error.S0.{nm},000000nm"), vec![0.03 * radiance; 64]).unwrap();
    }
    let found = shoot(&file, &sensor(), 1).channels[0].render_noise.unwrap();
    let truth = 300.0 / (10_000.0_f64 + 3.0 + 16.0 + 6.25 / 12.0).sqrt();
    assert!((found.over_sensor_noise.unwrap() / truth - 1.0).abs() < 1e-6, "{found:?} {truth}");
    assert_eq!(found.unknown, 0);
    assert_eq!(shoot(&flat(8, 8, radiance), &sensor(), 1).channels[0].render_noise, None);
    let mut unknown = flat(8, 8, radiance);
    for nm in [500, 520, 540] {
        unknown.picture.insert(&format!("Error.S0.{nm},000000nm"), vec![f32::INFINITY; 64]).unwrap();
    }
    let found = shoot(&unknown, &sensor(), 1).channels[0].render_noise.unwrap();
    assert_eq!((found.over_sensor_noise, found.unknown), (None, 64));
}

#[test]
fn what_cannot_be_exposed_is_refused_with_the_reason() {
    let refused = |file: &ExrFile, sensor: &Sensor| SensorExposure::new(file, sensor).unwrap_err().to_string();
    let none = ExrFile { picture: Picture::from_rgb(1, 1, &[[0.5; 3]]).unwrap(), attributes: Attributes::new() };
    assert!(refused(&none, &sensor()).contains("--bands"));
    let mut one = none.clone();
    one.picture.insert("S0.550,000000nm", vec![1.0]).unwrap();
    assert!(refused(&one, &sensor()).contains("single spectral band"));
    let short = table(&[500.0, 600.0], &[0.5, 0.5], Outside::Hold);
    let short = Sensor { channels: vec![channel("G", short)], ..sensor() };
    let why = refused(&flat(1, 1, 1.0), &short);
    assert!(why.contains("channel G is known from 500 to 600 nm") && why.contains("from 490 to 550 nm"), "{why}");
    assert!(refused(&flat(1, 1, 1.0), &Sensor { numerical_aperture: None, ..sensor() }).contains("f_number"));
    for wrong in [
        Sensor { pixel_pitch_m: 0.0, ..sensor() },
        Sensor { numerical_aperture: Some(1.5), ..sensor() },
        Sensor { prnu: 0.2, ..sensor() },
        Sensor { bits: 17, ..sensor() },
        Sensor { full_well_e: 0, ..sensor() },
        Sensor { gain_e_per_dn: f64::NAN, ..sensor() },
        Sensor { channels: vec![channel("x", QuantumEfficiency::Constant(60.0))], ..sensor() },
        Sensor { mosaic: Some(Mosaic::new(&[vec![1]]).unwrap()), ..sensor() },
    ] {
        assert!(refused(&flat(1, 1, 1.0), &wrong).starts_with("the sensor cannot be:"));
    }
    assert!(Mosaic::new(&[]).is_err() && Mosaic::new(&[vec![0, 1], vec![0]]).is_err());
}

/// Of a table that is even from 500 to 600 nm, ∫ λ dλ from 550 to 600 nm is 28,750 of 55,000.
#[test]
fn light_beyond_the_bands_is_told_and_a_raw_file_says_what_it_was_made_with() {
    let wide = Sensor { channels: vec![channel("G", table(&[500.0, 600.0], &[0.5, 0.5], Outside::Zero))], ..sensor() };
    let mut file = flat(1, 1, 1e-3);
    let report = &shoot(&file, &wide, 1).channels[0];
    assert!((report.share_outside - 28_750.0 / 55_000.0).abs() < 1e-12, "{report:?}");
    assert!(!SensorExposure::new(&file, &wide).unwrap().states_unit());
    for (name, text) in [("emissiveUnits", "W.m^-2.sr^-1"), ("sceneSha256", "abc"), ("frameSettings", "{}")] {
        file.attributes.insert(name.to_owned(), Attribute::Text(text.to_owned()));
    }
    assert!(SensorExposure::new(&file, &wide).unwrap().states_unit());
    let [software, sensor_json, sensor_sha256] = ["etalon 1", "{}", "0f"].map(str::to_owned);
    let info = RawInfo { software, sensor_json, sensor_sha256, seed: u64::MAX, frame: 7 };
    let attributes = info.attributes(&file.attributes);
    let names: Vec<_> = attributes.keys().map(String::as_str).collect();
    assert_eq!(names, ["exposedBy", "sceneSha256", "sensor", "sensorFrame", "sensorSeed", "sensorSha256"]);
    assert_eq!(attributes["sensorSeed"], Attribute::Text("18446744073709551615".to_owned()));
}
