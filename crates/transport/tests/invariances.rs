//! What no picture may depend on, tried on scenes made up by chance. This is how light is looked for, how the scene is turned, how large it is, and
//! whether its lights are rendered together or apart.

use crate::common::chance::{Chance, made};
use etalon_transport::{Control, prepare};
use serde_json::{Value, json};

/// Scenes that are tried; `INVARIANCES=1000` tries as many.
const SCENES: usize = 24;

/// Mean X, Y and Z of a picture, and their variances by the scatter of replicates.
fn means(scene: &Value, spp: u32, seed: u64) -> [(f64, f64); 3] {
    let mut scene = made(scene);
    (scene.integrator.spp, scene.integrator.seed) = (spp, seed);
    let prepared = prepare(&scene).unwrap_or_else(|error| panic!("{error}"));
    let film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
    let pixels = film.pixels().count() as f64;
    [0, 1, 2].map(|channel| {
        let mean = film.pixels().map(|pixel| pixel.xyz()[channel]).sum::<f64>() / pixels;
        let variance = film.pixels().map(|pixel| pixel.variance(|xyz| xyz).unwrap().0[channel]).sum::<f64>();
        (mean, variance / (pixels * pixels))
    })
}

/// Standard errors that a difference must exceed.
const MOST: f64 = 4.5;

/// A difference between the sums of the means of scenes.
struct Difference {
    /// In standard errors, the largest of three channels; infinite if it is no number.
    z: f64,
    /// The least relative difference of luminance that would have exceeded [`MOST`].
    resolves: f64,
}

fn difference(sides: [&[Value]; 2], spp: u32, seed: u64) -> Difference {
    let sum = |side: &[Value], seed: u64| {
        side.iter()
            .enumerate()
            .map(|(k, scene)| means(scene, spp, seed + k as u64))
            .fold([(0.0, 0.0); 3], |sum, of| std::array::from_fn(|c| (sum[c].0 + of[c].0, sum[c].1 + of[c].1)))
    };
    let [one, other] = [sum(sides[0], seed), sum(sides[1], seed + 100)];
    let scale = |c: usize| one[c].0.abs().max(other[c].0.abs());
    // Rounding, where there is no noise.
    let error = |c: usize| (one[c].1 + other[c].1).sqrt().max(1e-9 * scale(c)).max(f64::MIN_POSITIVE);
    let z = (0..3).map(|c| (one[c].0 - other[c].0) / error(c));
    let z = z.map(|z| if z.is_nan() { f64::INFINITY } else { z });
    let z = z.fold(0.0, |most: f64, z| if z.abs() > most.abs() { z } else { most });
    Difference { z, resolves: MOST * error(1) / scale(1) }
}

/// Both sides have the same mean; gives the relative difference that would have been seen. Bright rare paths make some z large by chance. Such a
/// pair is rendered twice more, with 16 times as many samples: only a difference that comes back with the same sign is one. With normal noise
/// this happens once in 10¹⁵ pairs.
fn same(what: &str, number: usize, sides: [&[Value]; 2]) -> Result<f64, String> {
    let Difference { z: first, resolves } = difference(sides, 128, 1000);
    if first.abs() < MOST {
        return Ok(resolves);
    }
    let [second, third] = [3000, 5000].map(|seed| difference(sides, 2048, seed).z);
    let stays = [second, third].iter().all(|z| z.abs() > MOST && z.signum() == first.signum());
    let texts =
        || sides.map(|side| side.iter().map(Value::to_string).collect::<Vec<_>>().join("\n")).join("\nagainst\n");
    if stays { Err(format!("scene {number}, {what}: z {first}, {second}, {third}\n{}", texts())) } else { Ok(resolves) }
}

/// The scene with x as y, y as z and z as x.
fn turned(value: &Value, key: &str) -> Value {
    const PLACES: [&str; 16] = [
        "position_m",
        "look_at_m",
        "direction",
        "center_m",
        "normal",
        "start_m",
        "end_m",
        "min_m",
        "max_m",
        "origin_m",
        "u_m",
        "v_m",
        "up",
        "sun_direction",
        "base_m",
        "axis",
    ];
    match value {
        Value::Array(list) if PLACES.contains(&key) => json!([list[2], list[0], list[1]]),
        Value::Array(list) => list.iter().map(|item| turned(item, "")).collect(),
        Value::Object(map) => map.iter().map(|(key, value)| (key.clone(), turned(value, key))).collect(),
        other => other.clone(),
    }
}

/// The scene with all lengths times `factor`.
fn larger(value: &Value, key: &str, factor: f64) -> Value {
    let times = |power: i32| json!(value.as_f64().expect("a number") * factor.powi(power));
    match value {
        Value::Number(_) if key.ends_with("_per_m") => times(-1),
        Value::Number(_) if key.ends_with("_m") => times(1),
        Value::Number(_) if key == "intensity" || key == "power" => times(2),
        Value::Array(list) if key.ends_with("_m") && !key.ends_with("_per_m") => {
            list.iter().map(|item| larger(item, "_m", factor)).collect()
        }
        Value::Array(list) => list.iter().map(|item| larger(item, key, factor)).collect(),
        Value::Object(map) if key.ends_with("_per_m") => {
            let mut spectrum = map.clone();
            match map["type"].as_str() {
                Some("tabulated") => spectrum["values"] = larger(&map["values"], "_per_m", factor),
                _ => spectrum["rgb"] = larger(&map["rgb"], "_per_m", factor),
            }
            Value::Object(spectrum)
        }
        Value::Object(map) => map.iter().map(|(key, value)| (key.clone(), larger(value, key, factor))).collect(),
        other => other.clone(),
    }
}

/// The scene with those of its lights alone that `keeps` says, counted over lamps and others; media shine where number 0 does.
fn with_lights(scene: &Value, keeps: impl Fn(usize) -> bool) -> Value {
    let mut scene = scene.clone();
    let mut count = 0;
    let mut next = || {
        count += 1;
        keeps(count)
    };
    for object in scene["objects"].as_array_mut().expect("objects") {
        if object.get("emission").is_some() && !next() {
            object.as_object_mut().expect("an object").remove("emission");
        }
    }
    let lights = scene["lights"].as_array_mut().expect("lights");
    lights.retain(|_| next());
    if !keeps(0) { dark(&scene) } else { scene }
}

/// The scene without the light of media.
fn dark(value: &Value) -> Value {
    match value {
        Value::Array(list) => list.iter().map(dark).collect(),
        Value::Object(map) => map
            .iter()
            .filter(|(key, _)| *key != "source_radiance")
            .map(|(key, value)| (key.clone(), dark(value)))
            .collect(),
        other => other.clone(),
    }
}

#[test]
fn pictures_depend_on_nothing_that_they_may_not_depend_on() {
    let count = std::env::var("INVARIANCES").ok().map_or(SCENES, |count| count.parse().expect("a number of scenes"));
    let mut chance = Chance(3);
    let (mut wrong, mut resolved) = (Vec::new(), Vec::new());
    for number in 0..count {
        let mut scene = chance.scene();
        scene["film"] = json!({"width": 8, "height": 8});
        scene["integrator"]["max_depth"] = json!(2 + chance.below(12));
        let way = |sampling: &str| {
            let mut scene = scene.clone();
            scene["integrator"]["light_sampling"] = json!(sampling);
            scene
        };
        let [mis, light, bsdf] = ["mis", "light", "bsdf"].map(way);
        // Skies that are images, and spectra that are drawn, stand in the world as they are.
        let has_image = scene["lights"].as_array().expect("lights").iter().any(|light| light.get("name").is_some());
        let odd = |k: usize| k % 2 == 1;
        let parts = [with_lights(&mis, odd), with_lights(&mis, |k| !odd(k))];
        let mut tries = vec![
            ("light by light", vec![light], vec![mis.clone()]),
            ("light by the BSDF", vec![bsdf], vec![mis.clone()]),
            ("larger", vec![larger(&mis, "", 7.0)], vec![mis.clone()]),
            ("lights apart", parts.into(), vec![mis.clone()]),
        ];
        if !has_image {
            tries.push(("turned", vec![turned(&mis, "")], vec![mis.clone()]));
        }
        for (what, one, other) in tries {
            match same(what, number, [&one, &other]) {
                Ok(relative) => resolved.push(relative),
                Err(difference) => wrong.push(difference),
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {count} scenes:\n{}", wrong.len(), wrong.join("\n\n"));
    // Of half of the pairs a difference of 20 % would have been seen.
    resolved.sort_by(f64::total_cmp);
    let median = resolved[resolved.len() / 2];
    assert!(median < 0.2, "{median}: {resolved:?}");
}
