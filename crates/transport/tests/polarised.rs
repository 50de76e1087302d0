//! Polarised light in whole renders.

use etalon_oracle::statistics::Welford;
use etalon_oracle::truths::{Claim, truths};
use etalon_scene::Scene;
use etalon_transport::plan::EffectName;
use etalon_transport::{Control, Prepared, Study, prepare_study};
use serde_json::{Value, json};

fn parse(json: &str) -> Scene {
    etalon_scene::parse(json, "test").unwrap_or_else(|e| panic!("{e:?}")).0
}

fn prepared(scene: &Scene, polarised: bool) -> Prepared {
    prepare_study(scene, &Study { polarised, ..Study::default() }).unwrap()
}

/// Mean Y and its standard error over 32 seeds.
fn mean_y(scene: &Scene, polarised: bool, spp: u32) -> Welford {
    let mut estimate = Welford::new();
    for seed in 0..32 {
        let mut scene = scene.clone();
        (scene.integrator.seed, scene.integrator.spp) = (seed, spp);
        let prepared = prepared(&scene, polarised);
        let film = prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap();
        assert_eq!(film.counters.nonfinite, 0);
        estimate.push(film.xyz().map(|xyz| xyz[1]).sum::<f64>() / f64::from(film.width() * film.height()));
    }
    estimate
}

/// A glass plate at 45, 75 and 89°: unpolarised light that is followed with its polarisation, against the mean of s and p; and
/// the kernel without, against s and p averaged at each face. |z| < 5 on each; the errors, asserted below a third of the
/// difference of the two, tell one from the other by more than their sum.
#[test]
fn plates_read_what_polarised_light_does_and_the_other_kernel_what_averaged_light_does() {
    let mut tried = 0;
    for truth in truths().into_iter().filter(|truth| truth.claims.contains(&Claim::CarriesPolarisation)) {
        // The others have no averaged form beside them; `etalon verify` reads them.
        let Some(averaged_name) = truth.name.strip_suffix("-polarised") else { continue };
        let Some(averaged) = truths().into_iter().find(|other| other.name == averaged_name) else { continue };
        let scene = parse(&truth.scene);
        let apart = (truth.value() - averaged.value()).abs();
        for (polarised, value) in [(true, truth.value()), (false, averaged.value())] {
            let read = mean_y(&scene, polarised, 16);
            let (mean, error) = (read.mean(), read.standard_error());
            assert!(
                ((mean - value) / error).abs() < 5.0,
                "{} {polarised}: {mean} ± {error} is not {value}",
                truth.name
            );
            // At 89° the two differ by 0.7 %, which takes more samples to see than a test has.
            assert!(3.0 * error < apart || truth.name.contains("89"), "{}: {error} of {apart}", truth.name);
        }
        tried += 1;
    }
    assert!(tried >= 3);
}

/// A plate of index 1.5 under Brewster's angle, a lamp in the mirrored direction: every reflection, at either face, leaves s
/// alone. The eye looks along the plane of incidence with s upward in the picture, so S₁ = −S₀ in each sample.
#[test]
fn at_brewsters_angle_reflected_light_is_fully_polarised_in_s1() {
    let (sine, cosine) = 1.5_f64.atan().sin_cos();
    let scene = parse(
        &json!({
            "etalon": 1,
            "camera": {
                "type": "orthographic", "position_m": [sine, 0, cosine], "look_at_m": [0, 0, 0], "up": [0, 1, 0], "height_m": 1e-3
            },
            "film": {"width": 8, "height": 8},
            "objects": [
                {
                    "shape": {"type": "box", "min_m": [-20, -20, -0.01], "max_m": [20, 20, 0]},
                    "material": {"type": "dielectric", "interior": 1.5}
                },
                {
                    "shape": {"type": "disk", "center_m": [-sine, 0, cosine], "normal": [sine, 0, -cosine], "radius_m": 0.5},
                    "material": {"type": "black"}, "emission": {"radiance": 1}
                }
            ],
            "integrator": {"spp": 16}
        })
        .to_string(),
    );
    let prepared = prepared(&scene, true);
    let (mut lit, mut sum) = (0, 0.0);
    for pixel in 0..64 {
        for sample in 0..16 {
            let path = prepared.replay(pixel % 8, pixel / 8, sample);
            let [s1, s2, s3] = path.stokes.expect("the kernel carries polarisation");
            for (lane, s0) in path.radiance.iter().enumerate() {
                // r_p vanishes at the angle, which is rounded.
                assert!((s1[lane] + s0).abs() < 1e-12 && s2[lane].abs() < 1e-9 && s3[lane].abs() < 1e-9);
                lit += usize::from(*s0 > 0.0);
                sum += s0;
            }
        }
    }
    assert!(lit > 100 && sum > 0.0, "{lit} of 8192 lanes have light");
}

/// Two surfaces of glass under Brewster's angle, one after the other, and a lamp where the light that both reflect comes from.
/// With one plane of incidence s passes both: R_s²/2. With crossed planes what is s at one is p at the other, and nothing is
/// left. Averaged light does not know the difference and reads (R_s/2)² both times: as a frame would that is not turned.
#[test]
fn crossed_brewster_mirrors_are_dark_and_parallel_ones_twice_as_bright_as_averaged_light() {
    let (sine, cosine) = 1.5_f64.atan().sin_cos();
    let scene = |crossed: bool| {
        // A ray from the eye meets the first mirror at the origin, goes up along z and meets the second at (0, 0, 5).
        let first = [sine, 0.0, cosine];
        let second = if crossed { [0.0, sine, -cosine] } else { [sine, 0.0, -cosine] };
        let eye = [0, 1, 2].map(|i| -3.0 * (f64::from(u8::from(i == 2)) - 2.0 * cosine * first[i]));
        let onward = [0, 1, 2].map(|i| f64::from(u8::from(i == 2)) + 2.0 * cosine * second[i]);
        let lamp = [2.0 * onward[0], 2.0 * onward[1], 5.0 + 2.0 * onward[2]];
        let disk = |center: [f64; 3], normal: [f64; 3]| json!({"type": "disk", "center_m": center, "normal": normal, "radius_m": 0.5});
        let glass = json!({"type": "dielectric", "interior": 1.5, "exterior": 1});
        parse(
            &json!({
                "etalon": 1,
                "camera": {"type": "orthographic", "position_m": eye, "look_at_m": [0, 0, 0], "up": [0, 1, 0], "height_m": 1e-3},
                "film": {"width": 8, "height": 8},
                "objects": [
                    {"shape": disk([0.0; 3], first), "material": glass},
                    {"shape": disk([0.0, 0.0, 5.0], second), "material": glass},
                    {
                        "shape": disk(lamp, onward.map(|v| -v)),
                        "material": {"type": "black"}, "emission": {"radiance": 1}
                    }
                ],
                "integrator": {"roulette": false}
            })
            .to_string(),
        )
    };
    let r_s = ((1.0 - 2.25) / (1.0 + 2.25_f64)).powi(2);
    for (crossed, polarised, value) in [
        (false, true, 0.5 * r_s * r_s),
        (false, false, 0.25 * r_s * r_s),
        (true, false, 0.25 * r_s * r_s),
        (true, true, 0.0),
    ] {
        let read = mean_y(&scene(crossed), polarised, 64);
        let (mean, error) = (read.mean(), read.standard_error());
        // Brewster's angle is rounded, so that a little p is left, with probability one in a thousand millions.
        assert!((mean - value).abs() <= 5.0 * error + 1e-9, "{crossed} {polarised}: {mean} ± {error} is not {value}");
        assert!(error < 0.1 * r_s * r_s * 0.25 || value == 0.0, "the test sees too little: {error}");
        assert!(value > 0.0 || mean < 1e-9, "{mean} comes through crossed mirrors");
    }
}

#[test]
fn a_scene_that_polarises_nothing_is_the_same_to_the_bit() {
    let scene =
        parse(&std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cornell.json")).unwrap());
    let mut scene = scene;
    (scene.film.width, scene.film.height, scene.integrator.spp) = (24, 24, 4);
    let film = |polarised| {
        let prepared = prepared(&scene, polarised);
        assert_eq!(prepared.plan().runs(EffectName::Polarisation), polarised);
        prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap()
    };
    assert!(film(true).pixels().eq(film(false).pixels()));
}

/// An eye that looks along −z through sheets, the first next to it, at a lamp of radiance 1.
fn through(sheets: &[Value], film: &Value) -> Scene {
    let lamp = json!({
        "shape": {"type": "disk", "center_m": [0, 0, -9], "normal": [0, 0, 1], "radius_m": 5},
        "material": {"type": "black"}, "emission": {"radiance": 1}
    });
    let objects: Vec<Value> = sheets
        .iter()
        .enumerate()
        .map(|(i, sheet)| {
            json!({
                "shape": {"type": "disk", "center_m": [0, 0, -1.0 - i as f64], "normal": [0, 0, 1], "radius_m": 3},
                "material": sheet
            })
        })
        .chain([lamp])
        .collect();
    parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 0], "look_at_m": [0, 0, -1], "height_m": 1},
            "film": film,
            "objects": objects,
            "integrator": {"spp": 16, "roulette": false}
        })
        .to_string(),
    )
}

/// What a camera measures is told along the right of its picture: turned about its axis, it sees all axes turned the other way.
#[test]
fn a_camera_that_is_turned_sees_axes_turned_the_other_way() {
    for roll in [0.0, 20.0, 65.0, 90.0, 130.0_f64] {
        let (sin, cos) = roll.to_radians().sin_cos();
        let mut scene = through(&[polariser(40.0)], &json!({"width": 8, "height": 8}));
        scene.camera.up = [-sin, cos, 0.0];
        let (sin_2, cos_2) = (2.0 * (40.0 - roll).to_radians()).sin_cos();
        let read = stokes(&scene);
        let close = |i: usize, truth: f64| (read[i] - truth).abs() < 1e-12;
        assert!(close(0, 0.5) && close(1, 0.5 * cos_2) && close(2, 0.5 * sin_2), "turned by {roll}°: {read:?}");
    }
}

fn polariser(degrees: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!({"type": "polariser", "axis": [cos, sin, 0]})
}

fn retarder(degrees: f64, retardance_deg: f64) -> Value {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!({"type": "retarder", "axis": [cos, sin, 0], "retardance_deg": retardance_deg})
}

/// S₀ … S₃ of one path, at its first wavelength: nothing in these scenes is left to chance but the wavelengths.
fn stokes(scene: &Scene) -> [f64; 4] {
    let path = prepare_study(scene, &Study::default()).unwrap().replay(3, 2, 5);
    let [s1, s2, s3] = path.stokes.expect("sheets call for polarisation");
    [path.radiance[0], s1[0], s2[0], s3[0]]
}

#[test]
fn sheets_call_for_polarisation_and_obey_malus() {
    let film = json!({"width": 8, "height": 8});
    let close = |read: [f64; 4], truth: [f64; 4], what: &str| {
        (0..4).for_each(|i| assert!((read[i] - truth[i]).abs() < 1e-12, "{what}: {read:?} is not {truth:?}"));
    };
    for degrees in [0.0, 25.0, 45.0, 90.0_f64] {
        let (sin_2, cos_2) = (2.0 * degrees.to_radians()).sin_cos();
        let malus = 0.5 * degrees.to_radians().cos().powi(2);
        let read = stokes(&through(&[polariser(degrees), polariser(0.0)], &film));
        close(read, [malus, malus * cos_2, malus * sin_2, 0.0], "two polarisers");
        let read = stokes(&through(&[polariser(90.0), polariser(degrees), polariser(0.0)], &film));
        close(read, [sin_2 * sin_2 / 8.0, -sin_2 * sin_2 / 8.0, 0.0, 0.0], "three polarisers");
        // The fast axis along the picture's right: light along +45° becomes left-handed, and a half-wave plate mirrors it.
        let read = stokes(&through(&[retarder(0.0, 90.0), polariser(45.0)], &film));
        close(read, [0.5, 0.0, 0.0, -0.5], "a quarter of a wave");
        let read = stokes(&through(&[retarder(degrees, 180.0), polariser(0.0)], &film));
        let (sin_4, cos_4) = (4.0 * degrees.to_radians()).sin_cos();
        close(read, [0.5, 0.5 * cos_4, 0.5 * sin_4, 0.0], "half a wave");
    }
    // What is not an ideal polariser: T = .8 along the axis and .2 of that across it.
    let leaky = json!({"type": "polariser", "axis": [1, 0, 0], "transmittance": 0.8, "extinction": 0.2});
    close(stokes(&through(&[leaky], &film)), [0.48, 0.32, 0.0, 0.0], "a leaky polariser");
    // Taken for unpolarised, crossed polarisers are grey filters one behind the other.
    let crossed = through(&[polariser(0.0), polariser(90.0)], &film);
    let without = Study { without: vec![EffectName::Polarisation], ..Study::default() };
    let averaged = prepare_study(&crossed, &without).unwrap();
    assert!((averaged.replay(3, 2, 5).radiance[0] - 0.25).abs() < 1e-12 && !averaged.plan().approximations.is_empty());
}

/// A film that records Stokes parameters holds what the paths of its pixels do, and no bit of its S₀ is another.
#[test]
fn films_hold_the_stokes_parameters_of_their_paths() {
    let sheets = [retarder(20.0, 70.0), polariser(60.0)];
    let [plain, stokes] =
        [false, true].map(|stokes| through(&sheets, &json!({"width": 4, "height": 4, "stokes": stokes})));
    let render = |scene: &Scene| {
        let prepared = prepare_study(scene, &Study::default()).unwrap();
        (prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap(), prepared)
    };
    let ((plain, _), (film, prepared)) = (render(&plain), render(&stokes));
    assert!(plain.pixels().eq(film.pixels()) && !plain.records_stokes() && plain.stokes_rec709(0, 0).is_none());
    let [[s1, _], [s2, error], [s3, _]] = film.stokes_rec709(1, 2).unwrap();
    // The share that each parameter is of the radiance is the same at every wavelength.
    let path = prepared.replay(1, 2, 0);
    let share = path.stokes.unwrap().map(|s| s[0] / path.radiance[0]);
    let rgb = etalon_optics::colour::rec709_from_xyz(film.pixel(1, 2).xyz());
    for c in 0..3 {
        for (read, share) in [(s1[c], share[0]), (s2[c], share[1]), (s3[c], share[2])] {
            assert!((f64::from(read) - share * rgb[c]).abs() < 1e-6, "{read} is not {share} of {}", rgb[c]);
        }
        assert!(error[c].is_finite());
    }
}

/// A sheet's axis turns with its object, and with the instance that places it.
#[test]
fn the_axis_of_a_sheet_goes_where_its_object_goes() {
    let turned = |object: Value, instance: Value| {
        let mut scene: Value = serde_json::from_str(
            &json!({
                "etalon": 1,
                "camera": {"type": "orthographic", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "height_m": 1},
                "film": {"width": 8, "height": 8},
                "groups": {"sheet": {"objects": [{
                    "shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 0, 1], "radius_m": 3},
                    "material": {"type": "polariser", "axis": [1, 0, 0]}
                }]}},
                "instances": [{"group": "sheet"}],
                "lights": [{"type": "environment", "radiance": 1}],
                "integrator": {"roulette": false}
            })
            .to_string(),
        )
        .unwrap();
        scene["groups"]["sheet"]["objects"][0]["transform"] = object;
        scene["instances"][0]["transform"] = instance;
        stokes(&parse(&scene.to_string()))
    };
    let by = |degrees: f64| json!([{"rotate": {"axis": [0, 0, 1], "angle_deg": degrees}}]);
    for (object, instance) in [(0.0, 0.0), (30.0, 0.0), (0.0, 30.0), (20.0, 50.0)] {
        let [s0, s1, s2, _] = turned(by(object), by(instance));
        let (sin, cos) = (2.0 * (object + instance).to_radians()).sin_cos();
        assert!((s0 - 0.5).abs() < 1e-12 && (s1 - 0.5 * cos).abs() < 1e-12 && (s2 - 0.5 * sin).abs() < 1e-12);
    }
}
