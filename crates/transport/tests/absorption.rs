//! Media that absorb, against closed forms and against each other.

use etalon_optics::RefractiveIndex;
use etalon_oracle::truths::{Claim, truths};
use etalon_scene::{Image, ImageTexture, MaterialKind, NumberTexture, Scene, Texels};
use etalon_transport::{EffectName, Study};
use serde_json::{Value, json};
use std::f64::consts::PI;

use crate::common::rendering::{mean_y, parse, render};

#[test]
fn truths_hold_and_reject_clear_glass() {
    let clear = Study { without: vec![EffectName::Absorption], ..Study::default() };
    let absorbing: Vec<_> = truths().into_iter().filter(|truth| truth.claims.contains(&Claim::Absorption)).collect();
    assert!(absorbing.len() >= 7);
    for truth in absorbing {
        let mut scene = parse(&truth.scene);
        scene.integrator.spp = 16;
        let film = render(&scene, &Study::default());
        // 16 · 32² paths of a value in [0, 1] scatter by less than 0.004.
        let error = (mean_y(&film) / truth.value() - 1.0).abs();
        assert!(error < 0.02, "{}: {} is not {}", truth.name, mean_y(&film), truth.value());
        assert_eq!((film.counters.nonfinite, film.counters.lost_media), (0, 0), "{}", truth.name);
        let error = (mean_y(&render(&scene, &clear)) / truth.value() - 1.0).abs();
        assert!(error > 0.05, "{}: the mutant is not seen", truth.name);
    }
}

/// A square metre of an image of a slab of index 1 and thickness `depth_m`, before a sky of 1.
fn slab(material: &Value, depth_m: f64, range_nm: [f64; 2]) -> Scene {
    parse(
        &json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 1},
            "film": {"width": 4, "height": 4},
            "objects": [{"shape": {"type": "box", "min_m": [-3, -3, -depth_m], "max_m": [3, 3, 0]}, "material": material}],
            "lights": [{"type": "environment", "radiance": 1}],
            "integrator": {"spp": 16, "wavelength_range_nm": range_nm, "roulette": false}
        })
        .to_string(),
    )
}

#[test]
fn each_wavelength_is_absorbed_by_its_own_coefficient() {
    let table = json!({"type": "tabulated", "wavelengths_nm": [400, 500, 700], "values": [3, 1, 0]});
    let material = json!({"type": "dielectric", "interior": 1, "absorption_per_m": table});
    let clear = json!({"type": "dielectric", "interior": 1});
    for (nm, per_m) in [(450.0, 2.0_f64), (500.0, 1.0), (600.0, 0.5)] {
        let range = [nm - 0.01, nm + 0.01];
        let share = mean_y(&render(&slab(&material, 0.8, range), &Study::default()))
            / mean_y(&render(&slab(&clear, 0.8, range), &Study::default()));
        // Within 0.01 nm σ changes by 2e-4 at most, so T by 1.6e-4 of itself, whatever wavelengths are drawn.
        assert!((share / (-0.8 * per_m).exp() - 1.0).abs() < 2e-4, "{nm}: {share}");
    }
    // Together, by four wavelengths of each path, whose weighted mean is the integral: within its noise.
    let study = Study::default();
    let whole = render(&slab(&material, 0.8, [400.0, 700.0]), &study);
    let bare = render(&slab(&clear, 0.8, [400.0, 700.0]), &study);
    let (got, white) = (mean_y(&whole), mean_y(&bare));
    assert!(got / white > (-0.8_f64 * 1.5).exp() && got / white < 1.0, "{got} of {white}");
}

/// What passes a hole in the surface of an absorbing body is in the body, as what goes through its surface is: paths and shadow rays.
#[test]
fn a_hole_in_an_absorbing_body_leads_into_it() {
    let body = |opacity: f64, core: Value| {
        let material = json!({"type": "dielectric", "interior": 1, "absorption_per_m": 2});
        let mut scene: Value = json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 0.5},
            "film": {"width": 4, "height": 4},
            "objects": [
                {"shape": {"type": "box", "min_m": [-3, -3, -2], "max_m": [3, 3, 0]}, "material": material, "opacity": opacity},
                {"shape": {"type": "box", "min_m": [-1, -1, -1.5], "max_m": [1, 1, -0.5]}}
            ],
            "lights": [{"type": "directional", "direction": [0, 0.6, -0.8], "irradiance": 1}],
            "integrator": {"spp": 16}
        });
        for (key, value) in core.as_object().unwrap() {
            scene["objects"][1][key] = value.clone();
        }
        mean_y(&render(&parse(&scene.to_string()), &Study::default()))
    };
    // Half a metre of it lies before the core.
    let lamp = |opacity| body(opacity, json!({"material": {"type": "black"}, "emission": {"radiance": 1}}));
    let white = |opacity| body(opacity, json!({"material": {"type": "lambert", "reflectance": 1}}));
    let seen = lamp(1.0);
    for opacity in [0.0, 0.5] {
        assert!((lamp(opacity) / seen - 1.0).abs() < 1e-9, "{opacity}: {} is not {seen}", lamp(opacity));
    }
    // The light comes in aslant, 0.5 m/0.8. Through a hole it finds the core; through the surface itself shadow rays do not go.
    let bare = json!({"material": {"type": "lambert", "reflectance": 1}, "transform": [{"translate_m": [0, 0, 1]}]});
    let share = white(0.0) / body(0.0, bare);
    assert!((share / (-2.0 * (0.5 + 0.5 / 0.8_f64)).exp() - 1.0).abs() < 1e-9, "{share}");
}

/// A material whose roughness an image says, 0.5 everywhere, among others of which none has a share.
fn at_one_half(of: impl Fn(f64) -> MaterialKind) -> MaterialKind {
    let image = ImageTexture::new(Image::new(1, 1, Texels::F32(vec![[0.5; 3]])));
    let parts = [0.25, 0.5, 1.0].map(|roughness| (roughness, of(roughness * roughness)));
    MaterialKind::Blend { parts: parts.to_vec(), by: NumberTexture::Image(image) }
}

#[test]
fn glass_whose_roughness_an_image_says_absorbs_as_glass_of_that_roughness() {
    let glass = |index: f64| {
        move |alpha: f64| MaterialKind::RoughDielectric {
            interior: RefractiveIndex::Constant(index),
            exterior: RefractiveIndex::VACUUM,
            facets: alpha.into(),
            compensated: true,
            priority: None,
            film: None,
        }
    };
    let material = json!({"type": "dielectric", "interior": 1, "absorption_per_m": 2});
    let mut scene = slab(&material, 0.4, [400.0, 700.0]);
    let clear =
        mean_y(&render(&slab(&json!({"type": "dielectric", "interior": 1}), 0.4, [400.0, 700.0]), &Study::default()));
    // Facets between equal media let everything pass straight on: e^(−2·0.4) is left.
    scene.materials[0].kind = at_one_half(glass(1.0));
    assert!((mean_y(&render(&scene, &Study::default())) / clear / (-0.8_f64).exp() - 1.0).abs() < 1e-9);
    // Rough glass that bends light, seen and lit from within and without: the very same paths.
    scene.materials[0].kind = glass(1.5)(0.25);
    let own = render(&scene, &Study::default());
    scene.materials[0].kind = at_one_half(glass(1.5));
    assert_eq!(render(&scene, &Study::default()).linear_rec709(), own.linear_rec709());
    scene.materials[0].medium = None;
    assert!(mean_y(&render(&scene, &Study::default())) > 1.2 * mean_y(&own));
}

/// A shadow ray begins in the medium on the side of the surface to which it leads: a lamp behind rough glass and one within it shine through
/// glass that has a priority as through glass that states both its sides.
#[test]
fn shadow_rays_begin_in_the_solid_that_they_enter_and_not_in_the_one_that_they_leave() {
    let mean = |priority: Option<u32>, lamp_z_m: f64, light_sampling: &str| {
        let mut glass = json!({"type": "dielectric", "interior": 1.5, "alpha": 0.4, "absorption_per_m": 2});
        if let Some(priority) = priority {
            glass["priority"] = json!(priority);
        }
        let lamp = json!({"type": "sphere", "center_m": [0, 0, lamp_z_m], "radius_m": 0.3});
        let film = render(
            &parse(
                &json!({
                    "etalon": 1,
                    "camera": {"type": "orthographic", "position_m": [0, 0, 3], "direction": [0, 0, -1], "height_m": 1},
                    "film": {"width": 8, "height": 8},
                    "objects": [
                        {"shape": {"type": "box", "min_m": [-3, -3, -1], "max_m": [3, 3, 0]}, "material": glass},
                        {"shape": lamp, "material": {"type": "black"}, "emission": {"radiance": 1}}
                    ],
                    "integrator": {"spp": 64, "light_sampling": light_sampling}
                })
                .to_string(),
            ),
            &Study::default(),
        );
        assert_eq!(film.counters.lost_media, 0);
        mean_y(&film)
    };
    for lamp_z_m in [-2.0, -0.5] {
        for light_sampling in ["light", "mis"] {
            let [tracked, stated] = [Some(1), None].map(|priority| mean(priority, lamp_z_m, light_sampling));
            // The same paths: rounding may send one of the 4096 elsewhere. In the medium of the wrong side they read 1.2 to 5 times as much.
            assert!((tracked / stated - 1.0).abs() < 0.01, "{lamp_z_m} {light_sampling}: {tracked} is not {stated}");
        }
    }
}

#[test]
fn a_transmittance_at_a_depth_is_met_at_that_depth_and_squared_at_twice_it() {
    let material = json!({"type": "dielectric", "interior": 1, "transmittance": 0.3, "transmittance_depth_m": 0.25});
    let shown = |depth_m| mean_y(&render(&slab(&material, depth_m, [400.0, 700.0]), &Study::default()));
    let clear = json!({"type": "dielectric", "interior": 1});
    let white = mean_y(&render(&slab(&clear, 1.0, [400.0, 700.0]), &Study::default()));
    for (depth_m, share) in [(0.25, 0.3), (0.5, 0.09), (0.125, 0.3_f64.sqrt())] {
        assert!((shown(depth_m) / white / share - 1.0).abs() < 1e-9, "{depth_m}");
    }
    // A colour shows as itself under the white of Rec. 709, whose four digits are 3e-4 beside D65.
    let green = json!({"type": "dielectric", "interior": 1, "transmittance": {"type": "rgb", "rgb": [0.2, 0.6, 0.3]},
        "transmittance_depth_m": 0.25});
    let mut scene = slab(&green, 0.25, [360.0, 830.0]);
    let daylight = etalon_optics::Spectrum::illuminant(etalon_optics::Illuminant::D65, 1.0).unwrap();
    scene.lights[0].kind = etalon_scene::LightKind::Environment { radiance: daylight };
    scene.integrator.spp = 4096;
    let film = render(&scene, &Study::default());
    let n = film.linear_rec709().len() as f64;
    for (c, want) in [0.2, 0.6, 0.3].into_iter().enumerate() {
        let got = film.linear_rec709().iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
        // 65,536 points of four wavelengths.
        assert!((got - want).abs() < 2e-3, "{c}: {got}");
    }
}

/// A world twice as large with half the coefficient is the same picture, bit for bit: lengths are metres, not units of the
/// frame.
#[test]
fn a_world_scaled_by_a_power_of_two_with_its_coefficients_shows_the_same_bits() {
    let scene = |scale: f64| {
        let per_m = 1.7 / scale;
        let ball = json!({"type": "dielectric", "interior": "N-BK7", "alpha": 0.3, "absorption_per_m": per_m});
        let glass = json!({"type": "dielectric", "interior": 1.4, "absorption_per_m": per_m});
        let at = |v: [f64; 3]| json!(v.map(|x| x * scale));
        let text = json!({
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": at([0.0, 1.0, 4.0]), "look_at_m": [0, 0, 0],
                "vertical_fov_deg": 40},
            "film": {"width": 24, "height": 18},
            "objects": [
                {"shape": {"type": "sphere", "center_m": at([0.5, 0.0, 0.0]), "radius_m": 0.5 * scale}, "material": ball},
                {"shape": {"type": "sphere", "center_m": at([-0.6, 0.0, 0.0]), "radius_m": 0.5 * scale}, "material": glass},
                {"shape": {"type": "disk", "center_m": at([0.0, -0.75, 0.0]), "normal": [0, 1, 0], "radius_m": 3.0 * scale},
                    "material": {"type": "lambert", "reflectance": 0.5}},
                {"shape": {"type": "sphere", "center_m": at([0.0, 3.0, 0.0]), "radius_m": 0.5 * scale},
                    "material": {"type": "black"}, "emission": {"radiance": 5}}
            ],
            "integrator": {"spp": 4}
        });
        render(&parse(&text.to_string()), &Study::default())
    };
    let one = scene(1.0);
    for scale in [4.0, 1.0 / 1024.0] {
        assert!(scene(scale).pixels().eq(one.pixels()), "{scale}");
    }
}

/// Light that reaches a floor straight from a lamp of intensity 1 two metres above it, all within an absorbing body of index 1 that
/// carries a priority: what stands between them lets through what its opacity leaves, and each stretch is absorbed once.
#[test]
fn a_shadow_ray_is_stopped_dimmed_and_absorbed_by_what_it_meets_within_a_medium() {
    let read_by = |between: Option<Value>, spp: u32| {
        let mut objects = vec![
            json!({
                "shape": {"type": "box", "min_m": [-9, -9, -9], "max_m": [9, 9, 9]},
                "material": {"type": "dielectric", "interior": 1, "priority": 0, "absorption_per_m": 0.5}
            }),
            json!({
                "shape": {"type": "disk", "center_m": [0, 0, 3], "normal": [0, 0, 1], "radius_m": 1},
                "material": {"type": "lambert", "reflectance": 0.5}
            }),
        ];
        objects.extend(between);
        let scene = json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 3.25], "direction": [0, 0, -1], "height_m": 0.001},
            "film": {"width": 2, "height": 2},
            "objects": objects,
            "lights": [{"type": "point", "position_m": [0, 0, 5], "intensity": 1}],
            "integrator": {"spp": spp, "max_depth": 2, "roulette": false}
        });
        mean_y(&render(&parse(&scene.to_string()), &Study::default()))
    };
    let read = |between| read_by(between, 64);
    let sheet_at = |height_m: f64, opacity: f64| {
        let shape = json!({"type": "disk", "center_m": [0, 0, height_m], "normal": [0, 0, 1], "radius_m": 1});
        Some(json!({"shape": shape, "material": {"type": "black"}, "opacity": opacity}))
    };
    let sheet = |opacity| sheet_at(4.0, opacity);
    let ball = |priority: u32| {
        let material = json!({"type": "dielectric", "interior": 1.5, "priority": priority});
        Some(json!({"shape": {"type": "sphere", "center_m": [0, 0, 4], "radius_m": 0.5}, "material": material}))
    };
    // (ρ/π)·I/d² over 2 m, absorbed along them and along a quarter of a metre to the eye; the picture's size changes 1e-6 of it.
    let clear = 0.5 / PI / 4.0 * (-0.5_f64 * 2.25).exp();
    let close = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 1e-3, "{got} is not {want}");
    close(read(None), clear);
    // 64 samples of a half in each of four pixels: the mean of a shadow ray's share, not of a choice, has no noise.
    close(read(sheet(0.5)), 0.5 * clear);
    assert_eq!(read(sheet(1.0)), 0.0);
    // Between the eye and the floor, where the eye's ray passes it by choice and the shadow ray again by its share, it is no vertex: two
    // edges still reach the lamp. 16384 choices of a half: five standard errors are .04 of them.
    let seen = read_by(sheet_at(3.1, 0.5), 4096);
    assert!((seen / (0.25 * clear) - 1.0).abs() < 0.04, "{seen}");
    assert_eq!(read(ball(1)), 0.0, "glass that is there stops a shadow ray");
}
