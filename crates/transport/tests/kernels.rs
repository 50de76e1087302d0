//! The kernel law, on every ready-made scene: each kernel that covers a scene gives its image, and what a scene does not
//! call for changes nothing and costs no count.

use etalon_oracle::statistics::Welford;
use etalon_scene::Scene;
use etalon_transport::plan::LaneModel;
use etalon_transport::{Carried, Control, EffectName, Film, Plan, Prepared, Study, prepare_study};

/// The ready-made scenes at a size and number of samples that a test can afford.
fn scenes() -> Vec<(String, Scene)> {
    crate::common::ready_made([24, 18], 4)
}

fn prepared(scene: &Scene, force: &[EffectName]) -> Prepared {
    prepare_study(scene, &Study { force: force.to_vec(), ..Study::default() }).unwrap()
}

fn render(prepared: &Prepared) -> Film {
    prepared.render(&prepared.whole(None), &|_| Control::Continue).unwrap()
}

#[test]
fn forcing_what_a_scene_does_not_call_for_leaves_every_bit_as_it_is() {
    let mut tried = 0;
    for (name, scene) in scenes() {
        let plan = prepared(&scene, &[]);
        let plain = render(&plan);
        assert_eq!(plain.counters.nonfinite, 0, "{name}");
        // Wavelengths that are not needed add noise of their own: they are held to the mean, below.
        let adds_noise = |effect: &EffectName| {
            plan.plan().lane_model == LaneModel::One
                && matches!(effect, EffectName::Wavelengths | EffectName::Dispersion | EffectName::Polarisation)
        };
        let can_be_forced =
            |force: &[EffectName]| Plan::new(&scene, &Study { force: force.to_vec(), ..Study::default() }).is_ok();
        let unneeded: Vec<EffectName> = EffectName::ALL
            .into_iter()
            .filter(|effect| !plan.plan().runs(*effect) && !adds_noise(effect) && can_be_forced(&[*effect]))
            .collect();
        let changes = |force: &[EffectName]| {
            let forced = prepared(&scene, force);
            for effect in force {
                assert!(forced.plan().runs(*effect), "{name}: {effect} is not forced");
            }
            !render(&forced).pixels().eq(plain.pixels())
        };
        // All of them at once: bits that one of them changes no other mends. Only then one by one, to name it.
        if !can_be_forced(&unneeded) || changes(&unneeded) {
            let changing: Vec<_> = unneeded.iter().filter(|effect| changes(&[**effect])).collect();
            assert!(changing.is_empty(), "{name}: {changing:?} change the picture");
            assert!(!can_be_forced(&unneeded), "{name}: {unneeded:?} change the picture together");
        }
        tried += unneeded.len();
    }
    assert!(tried >= 20, "only {tried} pairs were tried");
}

#[test]
fn shared_lanes_and_hero_lanes_agree_bit_for_bit_where_nothing_disperses() {
    let mut tried = 0;
    for (name, scene) in scenes() {
        if prepared(&scene, &[]).plan().lane_model == LaneModel::Hero {
            continue;
        }
        let shared = prepared(&scene, &[EffectName::Wavelengths]);
        let hero = prepared(&scene, &[EffectName::Dispersion]);
        assert_eq!((shared.plan().lane_model, hero.plan().lane_model), (LaneModel::Shared, LaneModel::Hero));
        assert!(render(&shared).pixels().eq(render(&hero).pixels()), "{name}");
        tried += 1;
    }
    assert!(tried >= 10);
}

/// Means of (a − b)/mean(b) over seeds, in X, Y and Z of the whole film, with both on the same random numbers: |t| < 6 with
/// 31 degrees of freedom is exceeded by a right pair once in 10⁶. What the test could see is asserted.
fn assert_same_mean(name: &str, mut a: Prepared, mut b: Prepared, sees: f64) {
    let mut differences = [Welford::new(); 3];
    let mut scale = 0.0;
    let mean = |prepared: &mut Prepared, seed| {
        prepared.reseed(seed);
        let film = render(prepared);
        let n = film.pixels().count() as f64;
        film.xyz().fold([0.0; 3], |sum, xyz| std::array::from_fn(|c| sum[c] + xyz[c] / n))
    };
    for seed in 0..32 {
        let (a, b) = (mean(&mut a, seed), mean(&mut b, seed));
        (0..3).for_each(|c| differences[c].push(a[c] - b[c]));
        scale += b[1] / 32.0;
    }
    for (c, difference) in differences.iter().enumerate() {
        let (mean, error) = (difference.mean(), difference.standard_error());
        // Two ways to sum the same numbers differ by their rounding.
        let rounding = 1e-6 * scale;
        assert!(error <= sees * scale, "{name}: the test sees too little, {} of Y", error / scale);
        assert!(mean.abs() <= 6.0 * error + rounding, "{name}: component {c} is off by {mean} ± {error}");
    }
}

#[test]
fn one_lane_and_four_agree_in_the_mean_and_one_lane_has_no_noise_of_colour() {
    let mut tried = 0;
    for (name, scene) in scenes() {
        if prepared(&scene, &[]).plan().lane_model != LaneModel::One {
            continue;
        }
        assert_same_mean(&name, prepared(&scene, &[]), prepared(&scene, &[EffectName::Wavelengths]), 2e-3);
        let film = render(&prepared(&scene, &[]));
        let xyz: Vec<_> = film.xyz().collect();
        let [x, y, z] = *xyz.iter().find(|xyz| xyz[1] > 0.0).unwrap();
        for pixel in &xyz {
            // One number times one colour: two roundings.
            assert!((pixel[0] - pixel[1] * x / y).abs() <= 4.0 * f64::EPSILON * pixel[0], "{name}");
            assert!((pixel[2] - pixel[1] * z / y).abs() <= 4.0 * f64::EPSILON * pixel[2], "{name}");
        }
        tried += 1;
    }
    assert!(tried >= 2);
}

fn carrying(scene: &Scene, carried: Carried) -> Prepared {
    prepare_study(scene, &Study { carried: Some(carried), ..Study::default() }).unwrap()
}

#[test]
fn one_wavelength_and_four_agree_with_eight_in_the_mean() {
    // Walls of three colours; glass that disperses.
    for (name, scene) in scenes().into_iter().filter(|(name, _)| name.starts_with("cornell")) {
        for carried in [Carried::OneWavelength, Carried::FourWavelengths] {
            assert_same_mean(&name, carrying(&scene, carried), prepared(&scene, &[]), 0.05);
        }
    }
}

/// A plane under a sky, both coloured: channels multiply one by one, (0.5·0.2, 0.9·0.7, 0.3·0.8). Spectra of the same colours
/// show another product, which is what such renderers get wrong.
#[test]
fn three_channels_multiply_one_by_one_and_wavelengths_do_not() {
    let scene = serde_json::json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 2, 0.1], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20},
        "film": {"width": 4, "height": 4},
        "materials": {"paint": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.2, 0.7, 0.8]}}},
        "objects": [{"material": "paint", "shape": {"type": "disk", "center_m": [0, 0, 0], "normal": [0, 1, 0], "radius_m": 50}}],
        "lights": [{"type": "environment", "radiance": {"type": "rgb", "rgb": [0.5, 0.9, 0.3]}}],
        "integrator": {"spp": 256}
    });
    let (scene, _) = etalon_scene::parse(&scene.to_string(), "paint").unwrap();
    let shown = |prepared: Prepared| render(&prepared).linear_rec709()[5].map(f64::from);
    let rgb = shown(carrying(&scene, Carried::ThreeChannels));
    for (channel, expected) in rgb.into_iter().zip([0.1, 0.63, 0.24]) {
        // The colours go through spectra and back: matching functions at 1 nm, matrices with some digits.
        assert!((channel - expected).abs() < 1e-3, "{rgb:?}");
    }
    let spectral = shown(prepared(&scene, &[]));
    assert!((spectral[0] - 0.1).abs() > 0.01, "{spectral:?}: these spectra multiply as colours do");
    let mut narrow = scene;
    narrow.integrator.wavelength_range_nm = [500.0, 600.0];
    assert!(prepare_study(&narrow, &Study { carried: Some(Carried::ThreeChannels), ..Study::default() }).is_err());
}

#[test]
fn what_a_scene_does_not_call_for_is_counted_zero_times_and_what_it_does_is_counted() {
    type Count = fn(&Film) -> u64;
    let counted: [(EffectName, Count); 5] = [
        (EffectName::ShadowRays, |film| film.counters.shadow_rays),
        (EffectName::Lens, |film| film.counters.lens_draws),
        (EffectName::Environment, |film| film.counters.environment_lookups),
        (EffectName::Dispersion, |film| film.counters.lane_weights),
        (EffectName::Motion, |film| film.counters.time_draws),
    ];
    let mut seen = [[false; 2]; 5];
    for (name, scene) in scenes() {
        let prepared = prepared(&scene, &[]);
        let film = render(&prepared);
        for (i, (effect, count)) in counted.iter().enumerate() {
            let on = match effect {
                // Media whose extinction varies call for the lanes' weights too.
                EffectName::Dispersion => prepared.plan().lane_model == LaneModel::Hero,
                other => prepared.plan().runs(*other),
            };
            assert_eq!(count(&film) > 0, on, "{name}: {effect}");
            seen[i][usize::from(on)] = true;
        }
    }
    assert!(seen.iter().all(|both| both[0] && both[1]), "{seen:?}: some effect is always on, or never");
}
