//! Error bars, quotes, stopping, comparison and the study, as a user meets them.

use std::path::{Path, PathBuf};

use etalon_picture::{ErrorInfo, read_exr, write_exr};
use serde_json::Value;

use crate::support::{etalon_line, pixel_bits, scene};

fn render(folder: &Path, name: &str, settings: &str) -> (PathBuf, Value) {
    let output = folder.join(name);
    let line = format!("render {{}} -o {{}} --json {settings}");
    let report = etalon_line(&line, [&scene("cornell.json"), &output]).expect(0).json();
    (output, report)
}

#[test]
fn a_render_knows_its_error_and_writes_it_down() {
    let folder = tempfile::tempdir().unwrap();
    let (output, report) = render(folder.path(), "a.exr", "--size 32x32 --spp 16");
    let error = &report["error"];
    let value = |key: &str| error[key].as_f64().unwrap();
    let interval: [f64; 2] = serde_json::from_value(error["interval_95"].clone()).unwrap();
    assert!(interval[0] < value("relative_rmse") && value("relative_rmse") < interval[1]);
    let file = read_exr(&output).unwrap();
    let info = ErrorInfo::from_attributes(&file.attributes).unwrap();
    assert_eq!(info.relative_rmse, f64::from(value("relative_rmse") as f32));
    assert_eq!(info.replicates, 4);
    // The picture's number is the root mean square of the pixels', for luminance; here for each channel of its own.
    for name in ["R", "G", "B"] {
        let errors = file.picture.channel(&format!("Error.{name}")).unwrap();
        assert!(errors.iter().all(|error| error.is_finite() && *error >= 0.0));
        assert!(errors.iter().any(|error| *error > 0.0));
    }
    let (output, report) = render(folder.path(), "b.exr", "--size 8x8 --spp 4 --replicates 1");
    assert_eq!(report["error"], Value::Null);
    assert!(read_exr(&output).unwrap().picture.channel("Error.R").is_none());
}

#[test]
fn a_render_that_ends_by_error_has_the_pixels_of_that_number_of_samples() {
    let folder = tempfile::tempdir().unwrap();
    let (stopped, report) = render(folder.path(), "a.exr", "--size 48x48 --error 20% --adaptive never");
    assert_eq!(report["reached"], "error");
    let spp = report["spp"].as_u64().unwrap();
    let error = report["error"]["relative_rmse"].as_f64().unwrap();
    // A pilot of a picture this small knows the error to a tenth or so.
    assert!((0.14..0.27).contains(&error), "{error} at {spp}");
    assert_eq!(report["predicted"]["samples"].as_f64().unwrap(), spp as f64);
    let (fixed, report) = render(folder.path(), "b.exr", &format!("--size 48x48 --spp {spp}"));
    assert_eq!(report["reached"], "samples");
    assert!(pixel_bits(&stopped).0 == pixel_bits(&fixed).0);
    let (_, report) = render(folder.path(), "c.exr", "--size 48x48 --error 1e-9 --time 1s --clock cpu");
    assert_eq!(report["reached"], "time");
    // The first pass must be whole, however slow the machine; these take milliseconds.
    assert!(report["seconds"].as_f64().unwrap() < 1.5);
    let ran = etalon_line("render {} -o {} --error 5", [&scene("cornell.json"), &folder.path().join("d.exr")]);
    ran.expect(2).says(["--error", "5%", "0.05"]);
}

#[test]
fn an_adaptive_render_takes_the_mean_number_of_samples_and_says_where_they_went() {
    let folder = tempfile::tempdir().unwrap();
    let (one, report) = render(folder.path(), "a.exr", "--size 48x48 --spp 64 --adaptive always --threads 1");
    let [least, most]: [u64; 2] = serde_json::from_value(report["adaptive"]["samples"].clone()).unwrap();
    // The lamp's edges are a small part of the box and most of its error; a quarter of the samples is spread evenly.
    assert!(report["adaptive"]["predicted_gain"].as_f64().unwrap() > 1.5 && (16..40).contains(&least) && most > 128);
    let paths = report["paths"].as_f64().unwrap() / (48.0 * 48.0);
    assert!((64.0..68.0).contains(&paths), "{paths}");
    let (three, _) = render(folder.path(), "b.exr", "--size 48x48 --spp 64 --adaptive always --threads 3");
    assert!(pixel_bits(&one).0 == pixel_bits(&three).0);
    let (_, report) = render(folder.path(), "c.exr", "--size 48x48 --spp 64");
    assert_eq!(report["adaptive"], Value::Null);
    // Samples are worth the same all over an integrating sphere.
    let output = folder.path().join("d.exr");
    let line = "render {} -o {} --size 32x32 --error 10% --json";
    let report = etalon_line(line, [&scene("integrating-sphere.json"), &output]).expect(0).json();
    assert_eq!((report["reached"].clone(), report["adaptive"]["used"].clone()), ("error".into(), false.into()));
}

#[test]
fn a_quote_names_machine_threads_and_version_and_prices_rise() {
    let line = "quote {} --size 48x48 --pilot 0.5s --threads 2 --clock cpu";
    let quote = etalon_line(&format!("{line} --json"), [&scene("cornell.json")]).expect(0).json();
    assert_eq!(quote["machine"]["threads"], 2);
    assert!(!quote["machine"]["processor"].as_str().unwrap().is_empty());
    assert_eq!(quote["machine"]["software"], format!("etalon {}", env!("CARGO_PKG_VERSION")));
    let estimates = quote["estimates"].as_array().unwrap();
    let errors: Vec<f64> =
        estimates.iter().map(|cost_estimate| cost_estimate["relative_rmse"].as_f64().unwrap()).collect();
    assert_eq!(
        errors.iter().map(|error| (error * 1000.0).round()).collect::<Vec<_>>(),
        [100.0, 50.0, 20.0, 10.0, 5.0, 1.0]
    );
    for pair in estimates.windows(2) {
        assert!(pair[0]["samples"].as_f64() < pair[1]["samples"].as_f64());
    }
    for cost_estimate in estimates {
        for key in ["samples", "seconds"] {
            let [low, high]: [f64; 2] =
                serde_json::from_value(cost_estimate[format!("{key}_interval")].clone()).unwrap();
            let value = cost_estimate[key].as_f64().unwrap();
            assert!(0.0 < low && low <= value && value <= high, "{cost_estimate}");
        }
    }
    let text = etalon_line(line, [&scene("cornell.json")]).expect(0).stdout;
    assert!(text.contains("2 threads") && text.contains("0.10 %"), "{text}");
}

/// One false alarm in a thousand comparisons is expected; of eight, one in a hundred runs of seeds never tried before.
#[test]
fn two_seeds_of_a_scene_are_the_same_and_a_planted_bias_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let (a, _) = render(folder.path(), "a.exr", "--size 48x48 --spp 16 --seed 1");
    for seed in 2..6 {
        let (b, _) = render(folder.path(), "b.exr", &format!("--size 48x48 --spp 16 --seed {seed}"));
        etalon_line("compare {} {}", [&a, &b]).expect(0);
    }
    // Half a per cent in one tile needs a render whose tiles are known to a tenth of that.
    let furnace = |name: &str, seed: u32| {
        let output = folder.path().join(name);
        let line = format!("render {{}} -o {{}} --size 48x48 --spp 256 --seed {seed}");
        etalon_line(&line, [&scene("furnace.json"), &output]).expect(0);
        output
    };
    let (a, b) = (furnace("c.exr", 1), furnace("d.exr", 2));
    etalon_line("compare {} {}", [&a, &b]).expect(0);
    let mut file = read_exr(&b).unwrap();
    let mut biased = etalon_picture::Picture::new(48, 48).unwrap();
    for channel in file.picture.channels() {
        let value = |(i, v): (usize, &f32)| {
            let in_tile = (16..32).contains(&(i % 48)) && (32..48).contains(&(i / 48));
            if in_tile && channel.name == "G" { v * 1.005 } else { *v }
        };
        biased.insert(&channel.name, channel.samples.iter().enumerate().map(value).collect()).unwrap();
    }
    file.picture = biased;
    write_exr(&b, &file.picture, &file.attributes).unwrap();
    let diff = folder.path().join("diff.png");
    let ran = etalon_line("compare {} {} --json --diff {}", [&a, &b, &diff]).expect(1);
    let json = ran.json();
    assert_eq!(json["test"]["differ"], true);
    let green = json["test"]["channels"].as_array().unwrap().iter().find(|c| c["channel"] == "G").unwrap();
    let crop: Vec<u64> = serde_json::from_value(green["worst"]["crop"].clone()).unwrap();
    let [left, right, top, bottom] = crop[..] else { panic!("{crop:?}") };
    assert!(left >= 16 && right <= 32 && top >= 32 && bottom <= 48, "{crop:?}");
    assert!(diff.exists());
    // Pictures without error bars are measured, not tested.
    let (c, _) = render(folder.path(), "e.exr", "--size 48x48 --spp 4 --replicates 1");
    let json = etalon_line("compare {} {} --json", [&c, &a]).expect(3).says(["errors are not known"]).json();
    assert_eq!((&json["test"], json["verdict"].as_str()), (&Value::Null, Some("untested")));
    assert!(json["note"].as_str().unwrap().contains("Error.R") && json["rmse"].as_f64().unwrap() > 0.0);
}

/// A picture with some of its pixels changed in one channel.
fn spoilt(from: &Path, to: &Path, channel: &str, pixels: std::ops::Range<usize>, value: f32) {
    let file = read_exr(from).unwrap();
    let mut picture = etalon_picture::Picture::new(file.picture.width(), file.picture.height()).unwrap();
    for other in file.picture.channels() {
        let mut samples = other.samples.clone();
        if other.name == channel {
            samples[pixels.clone()].fill(value);
        }
        picture.insert(&other.name, samples).unwrap();
    }
    write_exr(to, &picture, &file.attributes).unwrap();
}

#[test]
fn values_that_are_not_finite_differ_and_what_was_not_tested_has_a_status_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let (a, _) = render(folder.path(), "a.exr", "--size 40x24 --spp 8 --seed 1");
    let (b, _) = render(folder.path(), "b.exr", "--size 40x24 --spp 8 --seed 2");
    let c = folder.path().join("c.exr");
    let verdict = |a: &Path, b: &Path, status: i32| {
        let json = etalon_line("compare {} {} --json", [a, b]).expect(status).json();
        json["verdict"].as_str().unwrap().to_owned()
    };
    assert_eq!(verdict(&a, &b, 0), "within-noise");
    assert_eq!(verdict(&a, &a, 0), "equal");
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for pixels in [0..40 * 24, 85..86] {
            spoilt(&b, &c, "G", pixels.clone(), value);
            assert_eq!(verdict(&a, &c, 1), "differ");
            assert_eq!(verdict(&c, &a, 1), "differ");
            assert_eq!(verdict(&c, &c, 1), "differ");
            let json = etalon_line("compare {} {} --json", [&a, &c]).json();
            let first = [pixels.start % 40, pixels.start / 40];
            assert_eq!(json["non_finite"], serde_json::json!({ "pixels": pixels.len(), "first": first }));
        }
    }
    // Errors that are not finite hide any difference, also in one tile alone.
    for value in [f32::INFINITY, f32::NAN] {
        for pixels in [0..40 * 24, 85..86] {
            spoilt(&b, &c, "Error.R", pixels, value);
            assert_eq!(verdict(&a, &c, 3), "untested");
            etalon_line("compare {} {}", [&a, &c]).expect(3).says(["not known"]);
        }
    }
    // Without errors: equal values are equal, and NaN differs all the same.
    let (single, _) = render(folder.path(), "d.exr", "--size 40x24 --spp 4 --replicates 1");
    assert_eq!(verdict(&single, &single, 0), "equal");
    assert_eq!(verdict(&a, &single, 3), "untested");
    spoilt(&single, &c, "B", 7..8, f32::NAN);
    assert_eq!(verdict(&a, &c, 1), "differ");
}

/// 24 pairs of pictures whose pixels share paths, and 24 of one such and one whose pixels do not, in tiles of one block each. At a
/// significance of one in twenty 1.2 false alarms of 24 are expected at most, more than six once in 8000 times. Were the errors of a
/// block's pixels taken for independent, all pairs of the first kind would be called different.
/// What is left to see: a quarter of a tile's light, where the bound on the error of the tile is 3 % and its own is 1 %.
#[test]
fn pictures_whose_pixels_share_paths_are_the_same_and_a_planted_bias_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let one =
        |name, seed, how: &str| render(folder.path(), name, &format!("--size 32x32 --spp 32 --seed {seed} {how}")).0;
    let (mut both, mut either) = (0, 0);
    for seed in 0..24 {
        let (a, b) = (one("a.exr", 2 * seed, "--path-reuse 4x4"), one("b.exr", 2 * seed + 1, "--path-reuse 4x4"));
        let c = one("c.exr", 100 + seed, "");
        both += u32::from(etalon_line("compare {} {} --tile 4 --significance 0.05", [&a, &b]).status == 1);
        either += u32::from(etalon_line("compare {} {} --tile 4 --significance 0.05", [&a, &c]).status == 1);
    }
    assert!(both <= 6 && either <= 6, "{both} and {either} of 24");
    let (a, b) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    etalon_line("compare {} {}", [&a, &b]).expect(0);
    let mut file = read_exr(&b).unwrap();
    let brighter = |pixel: usize| if pixel % 32 >= 16 && pixel / 32 >= 16 { 1.25 } else { 1.0 };
    let mut biased = etalon_picture::Picture::new(32, 32).unwrap();
    for channel in file.picture.channels() {
        let samples = channel.samples.iter().enumerate().map(|(pixel, v)| v * brighter(pixel)).collect();
        biased.insert(&channel.name, samples).unwrap();
    }
    file.picture = biased;
    write_exr(&b, &file.picture, &file.attributes).unwrap();
    let json = etalon_line("compare {} {} --json", [&a, &b]).expect(1).json();
    assert_eq!(json["test"]["channels"][1]["worst"]["crop"], serde_json::json!([16, 32, 16, 32]));
}

/// 100 pairs. At a significance of one in a thousand more than two false alarms happen once in 6000 times; at one in twenty, where
/// five are to be expected, more than 14 happen once in 7000 times.
#[test]
#[ignore = "takes a minute: 200 renders"]
fn a_hundred_pairs_of_seeds_are_called_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let (mut alarms, mut twentieth) = (0, 0);
    for seed in 0..100 {
        let one = |name, seed| render(folder.path(), name, &format!("--size 48x48 --spp 32 --seed {seed}")).0;
        let (a, b) = (one("a.exr", 2 * seed), one("b.exr", 2 * seed + 1));
        alarms += u32::from(etalon_line("compare {} {}", [&a, &b]).status == 1);
        twentieth += u32::from(etalon_line("compare {} {} --significance 0.05", [&a, &b]).status == 1);
    }
    // docs/accuracy.md has the numbers.
    #[allow(clippy::print_stdout)]
    {
        println!("{alarms} of 100 are called different at 0.001, {twentieth} at 0.05");
    }
    assert!(alarms <= 2 && twentieth <= 14, "{alarms} and {twentieth} of 100");
}

/// Luminance of each pixel.
fn luminance(path: &Path) -> Vec<f64> {
    let picture = read_exr(path).unwrap().picture;
    let [r, g, b] = ["R", "G", "B"].map(|name| picture.channel(name).unwrap().to_vec());
    let y = |i: usize| 0.2126 * f64::from(r[i]) + 0.7152 * f64::from(g[i]) + 0.0722 * f64::from(b[i]);
    (0..r.len()).map(y).collect()
}

/// Scenes on which errors are tried, and the side of their pictures: small, for what takes the time are their references.
const SIX: [(&str, u32); 6] = [
    ("cornell-glass", 32),
    ("assignment", 24),
    ("integrating-sphere", 32),
    ("cornell", 32),
    ("metals", 32),
    ("thin-lens", 24),
];

/// Relative root mean square difference of two pictures of luminance, in units of a level.
fn relative_rms(a: &[f64], b: &[f64], level: f64) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / a.len() as f64).sqrt() / level
}

/// What pictures are held against: two pictures a and b that share no random number with each other nor with any picture.
struct Reference {
    halves: [Vec<f64>; 2],
    level: f64,
    /// Relative error of the mean of the two, by their difference: Var((a + b)/2) = Var(a − b)/4.
    own: f64,
}

/// The largest own error of a reference: a tenth of 2 %. It biases nothing (see [`Reference::error_of`]), and adds to the scatter of
/// an error that n pixels carry alike 2·(1/10)/√n of its square: 2 % of the error with 25 such pixels, where chance alone is 14 %.
const OWN: f64 = 0.002;

impl Reference {
    /// Takes more and more samples, each half a single sequence of points, until the mean is precise enough.
    fn new(render: &dyn Fn(u64, u64) -> Vec<f64>, spp: u64) -> Self {
        let mut samples = 4 * spp;
        loop {
            let halves = [101, 102].map(|seed| render(seed, samples));
            let level = 0.5 * halves.iter().flatten().sum::<f64>() / halves[0].len() as f64;
            let own = 0.5 * relative_rms(&halves[0], &halves[1], level);
            if own <= OWN {
                return Self { halves, level, own };
            }
            // On from there by the slope of most scenes; a steeper one ends sooner, a flatter one takes another round.
            samples = (samples as f64 * (1.05 * own / OWN).powf(1.0 / 0.6).clamp(1.3, 8.0)) as u64;
        }
    }

    /// The relative error of a picture p: the root of the mean of (p − a)(p − b), whose expectation is that of (p − truth)², since
    /// p, a and b are independent and have the same mean. It equals the squared distance to the mean of a and b less that mean's
    /// own squared error.
    fn error_of(&self, picture: &[f64]) -> f64 {
        let [a, b] = &self.halves;
        let products: f64 = picture.iter().zip(a).zip(b).map(|((p, a), b)| (p - a) * (p - b)).sum();
        (products / picture.len() as f64).sqrt() / self.level
    }
}

/// Pictures to 2 % twice and to 1 % once. Their error against a reference must be 1.7 to 2.3 % where 2 % were asked for.
#[test]
#[ignore = "takes some ten minutes of two processors: the table of docs/accuracy.md on errors"]
fn six_scenes_end_at_the_error_that_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let mut outside = Vec::new();
    for (name, side) in SIX {
        let file = scene(&format!("{name}.json"));
        let run = |settings: &str| {
            let output = folder.path().join("a.exr");
            let line = format!("render {{}} -o {{}} --size {side}x{side} --json {settings}");
            let report = etalon_line(&line, [&file, &output]).expect(0).json();
            (luminance(&output), report)
        };
        let number = |value: &Value| value.as_f64().unwrap();
        let pictures = [("2%", 1), ("2%", 2), ("1%", 1)].map(|(error, seed)| {
            let (picture, report) = run(&format!("--error {error} --seed {seed}"));
            (error, seed, picture, report)
        });
        let of = |report: &Value| report["spp"].as_u64().unwrap();
        let adaptive = if pictures[0].3["adaptive"]["used"] == true { "always" } else { "never" };
        let many = |seed, spp| run(&format!("--replicates 1 --spp {spp} --adaptive {adaptive} --seed {seed}")).0;
        let reference = Reference::new(&many, of(&pictures[0].3));
        for (error, seed, picture, report) in &pictures {
            let measured = reference.error_of(picture);
            if *error == "2%" && !(0.017..=0.023).contains(&measured) {
                outside.push(format!("{name}: {measured}"));
            }
            // The table is what this test is for.
            #[allow(clippy::print_stdout)]
            {
                println!(
                    "| {name} | {error} | {seed} | {adaptive} | {} | {:.2} % | {:.2} % | {:.2} % |",
                    of(report),
                    100.0 * number(&report["error"]["relative_rmse"]),
                    100.0 * measured,
                    100.0 * reference.own,
                );
            }
        }
    }
    assert!(outside.is_empty(), "{outside:?}");
}

/// Pictures of 64 × 64 pixels of other seeds than the quote's: they must take what was quoted, within a factor of 1.25, nine times of
/// ten, and lie in the quoted interval, which has a probability of 95 %: fewer than 19 of 24 would happen once in 1000 times. Times are of the
/// processor, so that other programs count little. In smaller pictures a few pixels carry the error of some scenes, and neither a quote nor a
/// picture knows it to better than a tenth.
#[test]
#[ignore = "takes some five minutes of two processors: the table of docs/accuracy.md on prices"]
fn six_scenes_take_the_time_that_was_quoted() {
    let folder = tempfile::tempdir().unwrap();
    let (mut tried, mut inside, mut wrong) = (0, 0, Vec::new());
    for (name, _) in SIX {
        let file = scene(&format!("{name}.json"));
        let quote = "quote {} --size 64x64 --clock cpu --seed 3 --error 2%,1% --json";
        let quote = etalon_line(quote, [&file]).expect(0).json();
        for (error, cost_estimate, seed) in [("2%", 0, 1), ("2%", 0, 2), ("1%", 1, 1), ("1%", 1, 2)] {
            let line = format!("render {{}} -o {{}} --size 64x64 --clock cpu --json --error {error} --seed {seed}");
            let report = etalon_line(&line, [&file, &folder.path().join("a.exr")]).expect(0).json();
            let number = |value: &Value| value.as_f64().unwrap();
            let before =
                number(&report["predicted"]["pilot_seconds"]) + number(&report["adaptive"]["exploration_seconds"]);
            let estimate = &quote["estimates"][cost_estimate];
            let (took, quoted) = (number(&report["seconds"]) - before, number(&estimate["seconds"]));
            let [low, high] = [0, 1].map(|end| number(&estimate["seconds_interval"][end]));
            let ratio = took / quoted;
            tried += 1;
            inside += u32::from((low..=high).contains(&took));
            if !(1.0 / 1.25..=1.25).contains(&ratio) {
                wrong.push(format!("{name}, {error}: {ratio}"));
            }
            // The table is what this test is for.
            #[allow(clippy::print_stdout)]
            {
                println!(
                    "| {name} | {error} | {seed} | {} | {quoted:.2} s ({low:.2} to {high:.2}) | {took:.2} s | {ratio:.2} |",
                    report["spp"]
                );
            }
        }
    }
    assert!(10 * wrong.len() <= tried, "{} of {tried}: {wrong:?}", wrong.len());
    assert!(inside >= 19, "{inside} of {tried} lie in the quoted interval");
}
