//! The list of truths itself: complete, consistent, confirmed, and equal to what is published.

use std::collections::{BTreeMap, HashSet};
use std::fmt::Write as _;

use etalon_oracle::{
    statistics::Estimate,
    subjects::Reading,
    truths::{Claim, Quantity, REMOVED, SET_VERSION, Truth, exchange_files, judge, judge_to, truths},
};

fn find(name: &str) -> Truth {
    truths().into_iter().find(|truth| truth.name == name).unwrap_or_else(|| panic!("no truth is named {name}"))
}

#[test]
fn there_are_at_least_forty_each_with_its_own_name_derivation_and_a_scene_that_parses() {
    let list = truths();
    assert!(list.len() >= 40, "{}", list.len());
    let names: HashSet<_> = list.iter().map(|truth| truth.name.clone()).collect();
    assert_eq!(names.len(), list.len());
    for truth in &list {
        let word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.".contains(c);
        assert!(truth.name.chars().all(word), "{}", truth.name);
        assert!(truth.derivation.ends_with(['.', '!']) && !truth.formula.is_empty(), "{}", truth.name);
        assert!(truth.value().is_finite(), "{}", truth.name);
        assert!(truth.value() >= 0.0 || truth.quantity != Quantity::Radiance, "{}", truth.name);
        let scene: serde_json::Value = serde_json::from_str(&truth.scene).unwrap();
        assert_eq!(scene["etalon"], 1, "{}", truth.name);
        for mistake in truth.mistakes() {
            let apart = (mistake.value - truth.value()).abs();
            assert!(apart > 2.0 * truth.tolerance(), "{}: \"{}\" is {}", truth.name, mistake.what, mistake.value);
        }
        let white: serde_json::Value = serde_json::from_str(&truth.white_scene()).unwrap();
        assert_eq!((&white["film"], &white["camera"]), (&scene["film"], &scene["camera"]), "{}", truth.name);
    }
}

#[test]
fn second_opinions_agree() {
    let mut confirmed = 0;
    for truth in truths() {
        let Some(opinion) = &truth.second_opinion else { continue };
        confirmed += 1;
        let second = opinion.value();
        let difference = (second - truth.value()).abs() / truth.value().abs();
        assert!(
            difference <= opinion.tolerance,
            "{}: {} by {}, {} by formula",
            truth.name,
            second,
            opinion.how,
            truth.value()
        );
    }
    assert!(confirmed >= 40, "only {confirmed} truths have a second opinion");
}

#[test]
#[allow(clippy::approx_constant, reason = "published decimals, not constants")]
fn values_are_the_published_ones() {
    let rho_over_pi = 0.5 / std::f64::consts::PI;
    for (name, value, digits) in [
        ("room-cube", 1.0, 1e-15),
        ("room-cut-at-8", 0.996_093_75, 1e-15),
        ("integrating-sphere", 1.273_239_54, 1e-8),
        ("parallel-plates-lower", 1.538_461_54, 1e-8),
        ("parallel-plates-upper", 1.076_923_08, 1e-8),
        ("sphere-light-overhead", 0.785_398_163 * rho_over_pi, 1e-9),
        ("disk-light", 1.570_796_33 * rho_over_pi, 1e-8),
        ("square-light", 1.740_839_50 * rho_over_pi, 1e-8),
        ("triangle-light", 0.302_299_894 * rho_over_pi, 1e-9),
        ("view-factor-facing-squares", 0.5 * 0.199_824_896, 1e-9),
        ("view-factor-disks", 0.5 * 0.381_966_011 * std::f64::consts::FRAC_PI_4, 1e-9),
        ("plate-at-0-degrees", 0.923_076_923, 1e-9),
        ("plate-at-45-degrees", 0.904_326_791, 1e-9),
        ("plate-at-75-degrees", 0.596_092_048, 1e-9),
        ("plate-at-89.99-degrees", 5.073_096_17e-4, 1e-12),
        ("plate-at-75-degrees-polarised", 0.618_148_516, 1e-9),
        ("2-plates-at-normal-incidence", 0.857_142_857, 1e-9),
        ("eye-in-glass", 2.25, 1e-15),
        ("glass-water-glass-at-30-degrees", 0.914_048, 1e-6),
        ("lens-share-of-the-aperture", 0.16, 1e-12),
        ("planck-5000-kelvin-at-560-nanometres", 1e-4 * 12_762.191_5, 1e-8),
    ] {
        let truth = find(name);
        assert!((truth.value() - value).abs() <= digits, "{name}: {} is not {value}", truth.value());
    }
}

fn reading(mean: f64, standard_error: f64) -> Reading {
    Reading { estimate: Estimate::new(mean, standard_error), nonfinite: 0, cut_bias: 0.0 }
}

#[test]
fn a_right_and_quiet_reading_passes_a_wrong_or_noisy_one_does_not() {
    let truth = find("eye-in-glass");
    let significance = 1e-8;
    judge(&truth, &reading(2.2501, 1e-4), significance).assert();
    assert!(!judge(&truth, &reading(2.26, 1e-4), significance).pass);
    let without = judge(&truth, &reading(1.0001, 1e-4), significance);
    assert!(!without.pass && without.evidence.contains("not scaled by n²"), "{without}");
    let noisy = judge(&truth, &reading(2.3, 0.1), significance);
    assert!(!noisy.pass && noisy.evidence.contains("times the samples"), "{noisy}");
    assert!(!judge(&truth, &Reading { nonfinite: 1, ..reading(2.25, 1e-4) }, significance).pass);
    assert!(!judge(&truth, &reading(f64::NAN, 1e-4), significance).pass);
    assert!(!judge(&truth, &reading(2.25, f64::NAN), significance).pass);
    // Whatever the noise, what is wrong is wrong.
    judge_to(&truth, &reading(2.3, 0.1), significance, f64::INFINITY).assert();
    for wrong in [reading(2.26, 1e-4), reading(3.0, 0.1), Reading { nonfinite: 1, ..reading(2.25, 0.1) }] {
        assert!(!judge_to(&truth, &wrong, significance, f64::INFINITY).pass, "{wrong:?}");
    }
    assert!(!judge_to(&truth, &reading(2.25, f64::NAN), significance, f64::INFINITY).pass);
}

#[test]
fn paths_that_were_cut_count_by_what_they_may_have_carried() {
    let truth = find("light-through-a-mirror-tunnel");
    let significance = 5.7e-9;
    let judged = |cut, throughput, paths| {
        let cut_bias = truth.bias_of_cut_paths(cut, throughput, paths, significance);
        judge(&truth, &Reading { cut_bias, ..reading(0.5, 1e-6) }, significance)
    };
    // Seen: 8.9e-6 + 1e-5 that single precision is allowed. A Poisson count of one excludes means above 22.2.
    let seen = judged(0, 0.0, 1).resolvable_bias;
    let one = judged(1, 1.0, 134_000_000);
    one.assert();
    assert!(
        one.evidence.contains("may have caused a bias of 1.7e-7") && (one.resolvable_bias / seen - 1.009).abs() < 1e-3,
        "{one}"
    );
    // A hundredth of the paths, a hundred times the throughput, a thousand cut, or a bound that is none: too much may be missing.
    for (cut, throughput, paths) in [
        (1, 1.0, 1_340_000),
        (1, 100.0, 134_000_000),
        (1000, 1.0, 134_000_000),
        (1, f64::MAX, u64::MAX),
        (1, f64::NAN, 1),
    ] {
        let refused = judged(cut, throughput, paths);
        assert!(!refused.pass && refused.evidence.contains("more than 1."), "{refused}");
    }
    // Nobody has said how bright this room may be.
    let room = find("room-cube");
    assert_eq!(room.bias_of_cut_paths(1, 1.0, u64::MAX, significance), f64::INFINITY);
    assert!(!judge(&room, &Reading { cut_bias: f64::INFINITY, ..reading(1.0, 1e-6) }, significance).pass);
    assert_eq!(room.bias_of_cut_paths(0, 0.0, 1, significance), 0.0);
}

#[test]
fn darkness_must_be_dark() {
    let truth = find("square-light-turned-away");
    judge(&truth, &reading(0.0, 0.0), 1e-8).assert();
    assert!(!judge(&truth, &reading(1e-9, 0.0), 1e-8).pass);
}

#[test]
fn every_exported_scene_keeps_to_the_neutral_form_and_every_truth_is_listed() {
    let list = truths();
    let files = exchange_files(&list);
    let text = |path: &str| -> &str {
        let file = files.iter().find(|file| file.path == path).unwrap_or_else(|| panic!("{path} is not exported"));
        std::str::from_utf8(&file.bytes).unwrap()
    };
    let json = |path: &str| -> serde_json::Value { serde_json::from_str(text(path)).unwrap() };
    let form = jsonschema::validator_for(&json("neutral.schema.json")).unwrap();
    // Scenes of the whole format are held to its schema by the tests of the crate that reads it.
    for truth in list.iter().filter(|truth| !truth.claims.contains(&Claim::WholeFormat)) {
        let scene = json(&format!("scenes/{}.json", truth.name));
        let errors: Vec<_> = form.iter_errors(&scene).map(|error| error.to_string()).collect();
        assert!(errors.is_empty() && truth.files.is_empty(), "{}: {errors:?}", truth.name);
    }
    let index = json("truths.json");
    assert_eq!((&index["version"], &index["removed"]), (&SET_VERSION.into(), &REMOVED.into()));
    let digest = index["digest"].as_str().unwrap();
    let neutral = list.iter().filter(|truth| !truth.claims.contains(&Claim::WholeFormat)).count();
    for said in [
        format!("version {SET_VERSION} of the set, with the digest `{digest}`"),
        format!("{} truths: {neutral} are in the neutral form", list.len()),
    ] {
        assert!(text("README.md").contains(&said), "the README does not say: {said}");
    }
    assert!(text("LICENSE-MIT").starts_with("MIT License") && text("LICENSE-APACHE").contains("Apache License"));
    let entries = index["truths"].as_array().unwrap();
    assert_eq!(entries.len(), list.len());
    for (entry, truth) in entries.iter().zip(&list) {
        assert_eq!(entry["name"], truth.name.as_str());
        assert_eq!(entry["value"], truth.value());
        let scene = json(entry["scene"].as_str().unwrap());
        assert_eq!((&entry["width"], &entry["height"]), (&scene["film"]["width"], &scene["film"]["height"]));
        if let Some(white) = entry["white_scene"].as_str() {
            let white = json(white);
            assert_eq!(white["film"], scene["film"], "{}: the same film", truth.name);
            assert_eq!(white["integrator"]["wavelength_range_nm"], entry["band_nm"]);
        }
        for claim in entry["claims"].as_array().unwrap() {
            let named = format!("| `{}` |", claim.as_str().unwrap());
            assert!(text("README.md").contains(&named), "the README explains {claim}");
        }
    }
    // A key that the form does not know, and a sphere of no size, are seen.
    let mut wrong = json(&format!("scenes/{}.json", list[0].name));
    wrong["films"] = 1.into();
    assert!(!form.is_valid(&wrong));
}

/// The list of names and values that goes with a version of the set: a line with the version, and one for each truth with its name, value and
/// quantity.
#[derive(Clone, Debug, PartialEq)]
struct Kept {
    version: [u32; 3],
    truths: BTreeMap<String, (f64, String)>,
}

/// Where the list is.
const KEPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/truths.lock");

fn version(text: &str) -> [u32; 3] {
    let numbers: Vec<u32> = text.split('.').map(|number| number.parse().expect("a version has numbers")).collect();
    numbers.try_into().expect("a version has three numbers")
}

impl Kept {
    /// The list of the truths as they are.
    fn now() -> Self {
        let line = |truth: Truth| (truth.name.clone(), (truth.value(), truth.quantity.name().to_owned()));
        Self { version: version(SET_VERSION), truths: truths().into_iter().map(line).collect() }
    }

    fn read(text: &str) -> Self {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let first =
            lines.next().and_then(|line| line.strip_prefix("version ")).expect("the first line has the version");
        let line = |line: &str| {
            let [name, value, quantity] = line.split(' ').collect::<Vec<_>>().try_into().expect("three words a line");
            (name.to_owned(), (value.parse().expect("a number"), quantity.to_owned()))
        };
        Self { version: version(first), truths: lines.map(line).collect() }
    }

    fn text(&self) -> String {
        let [major, minor, patch] = self.version;
        let mut text = "# The names, values and quantities of all truths. ETALON_UPDATE_SNAPSHOTS=1 cargo test --release -p etalon-oracle --test truths\n\
             # writes this file; raise SET_VERSION before.\n"
            .to_owned();
        let _ = writeln!(text, "version {major}.{minor}.{patch}");
        for (name, (value, quantity)) in &self.truths {
            let _ = writeln!(text, "{name} {value:?} {quantity}");
        }
        text
    }

    /// Names that are gone, names whose truths read something else, and new names.
    fn changes(&self, now: &Self) -> [Vec<String>; 3] {
        // Values are computed, and what is 0 may be a rounding error instead.
        let alike = |(a, of_a): &(f64, String), (b, of_b): &(f64, String)| {
            of_a == of_b && (a - b).abs() <= 1e-9 * a.abs().max(b.abs()) + 1e-15
        };
        let names = |of: &Self, keep: &dyn Fn(&String) -> bool| -> Vec<String> {
            of.truths.keys().filter(|name| keep(name)).cloned().collect()
        };
        let [was, is] = [self, now].map(|list| |name: &String| list.truths.get(name));
        [
            names(self, &|name| is(name).is_none()),
            names(self, &|name| is(name).is_some_and(|is| !alike(&self.truths[name], is))),
            names(now, &|name| was(name).is_none()),
        ]
    }

    /// The smallest version that may follow with these changes.
    fn least_version(&self, [gone, changed, added]: &[Vec<String>; 3]) -> [u32; 3] {
        let [major, minor, patch] = self.version;
        match () {
            () if !gone.is_empty() || !changed.is_empty() => [major + 1, 0, 0],
            () if !added.is_empty() => [major, minor + 1, 0],
            () => [major, minor, patch],
        }
    }
}

/// Who has results for a version of the set can rely on its names and values.
#[test]
fn names_and_values_stay_within_a_version_of_the_set() {
    let mut now = Kept::now();
    assert!(REMOVED.iter().all(|name| !now.truths.contains_key(*name)), "a truth in REMOVED is there");
    let update = "ETALON_UPDATE_SNAPSHOTS=1 cargo test --release -p etalon-oracle --test truths";
    let writes = std::env::var_os("ETALON_UPDATE_SNAPSHOTS").is_some();
    if let Ok(text) = std::fs::read_to_string(KEPT) {
        let before = Kept::read(&text);
        let changes = before.changes(&now);
        let [major, minor, patch] = before.least_version(&changes);
        let [gone, changed, added] = &changes;
        let listed = changes.iter().all(Vec::is_empty) && before.version == now.version;
        assert!(
            listed || writes && now.version >= [major, minor, patch],
            "names or values of truths changed: raise SET_VERSION from {:?} to {major}.{minor}.{patch} or more, and run `{update}`\n\
             gone: {gone:?}\nchanged: {changed:?}\nadded: {added:?}",
            before.version
        );
        let unlisted: Vec<&String> = gone.iter().filter(|name| !REMOVED.contains(&name.as_str())).collect();
        assert!(unlisted.is_empty(), "REMOVED must list {unlisted:?}");
        // The last digits of what did not change stay as they are.
        for (name, line) in before.truths {
            if let Some(kept) = now.truths.get_mut(&name).filter(|_| !changed.contains(&name)) {
                *kept = line;
            }
        }
    } else {
        assert!(writes, "{KEPT} is not there: run `{update}`");
    }
    if writes {
        std::fs::write(KEPT, now.text()).expect("the list can be written");
    }
}

#[test]
fn a_version_follows_from_what_changed() {
    let kept = |version: [u32; 3], truths: &[(&str, f64, &str)]| {
        let line = |&(name, value, quantity): &(&str, f64, &str)| (name.to_owned(), (value, quantity.to_owned()));
        Kept { version, truths: truths.iter().map(line).collect() }
    };
    let before = kept([2, 3, 4], &[("a", 1.0, "S0"), ("b", 0.0, "S1")]);
    assert_eq!(Kept::read(&before.text()), before);
    let follows = |truths: &[(&str, f64, &str)]| before.least_version(&before.changes(&kept([2, 3, 4], truths)));
    assert_eq!(follows(&[("a", 1.0 + 0.9e-9, "S0"), ("b", -1e-16, "S1")]), [2, 3, 4]);
    assert_eq!(follows(&[("a", 1.0, "S0"), ("b", 0.0, "S1"), ("c", 5.0, "S0")]), [2, 4, 0]);
    for changed in [
        &[("a", 1.0 + 1.1e-9, "S0"), ("b", 0.0, "S1")],
        &[("a", 1.0, "meters"), ("b", 0.0, "S1")],
        &[("a", 1.0, "S0"), ("c", 0.0, "S1")],
    ] {
        assert_eq!(follows(changed), [3, 0, 0], "{changed:?}");
    }
    assert_eq!(follows(&[("a", 1.0, "S0")]), [3, 0, 0]);
}
