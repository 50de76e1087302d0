//! Cameras with lenses of many surfaces: both drivers, what a lens calls for, what is left out, and a white field.

use etalon_scene::{Projection, Scene};
use etalon_transport::plan::LaneModel;
use etalon_transport::{Control, EffectName, Film, PathLoop, Prepared, Study, prepare, prepare_study};
use serde_json::{Value, json};

/// A ball on a floor, or nothing, under a white sky, through a biconvex lens behind a stop.
fn scene(medium: &Value, coating: &str, edits: &[(&str, Value)]) -> Scene {
    let mut scene = json!({
        "etalon": 1,
        "camera": {
            "type": "compound-lens", "position_m": [0, 0.3, 2], "look_at_m": [0, 0.3, 0], "sensor_height_m": 0.03, "focus_distance_m": 2,
            "lens": { "coating": coating, "surfaces": [
                { "semi_aperture_mm": 6, "thickness_mm": 4, "stop": true },
                { "radius_mm": 50, "thickness_mm": 5, "medium": medium, "semi_aperture_mm": 12 },
                { "radius_mm": -50, "semi_aperture_mm": 12, "aspheric": [1e-6] } ] }
        },
        "film": { "width": 25, "height": 19, "filter": { "type": "gaussian", "sigma_px": 0.5 } },
        "materials": { "red": { "type": "lambert", "reflectance": { "type": "rgb", "rgb": [0.7, 0.2, 0.1] } },
            "glass": { "type": "dielectric", "interior": 1.5, "transmittance": 0.5, "transmittance_depth_m": 0.3 } },
        "objects": [
            { "shape": { "type": "sphere", "center_m": [0, 0.3, 0], "radius_m": 0.3 }, "material": "glass" },
            { "shape": { "type": "parallelogram", "origin_m": [-2, 0, 2], "u_m": [4, 0, 0], "v_m": [0, 0, -4] }, "material": "red" }
        ],
        "lights": [ { "type": "environment", "radiance": 1 }, { "type": "point", "position_m": [1, 2, 1], "intensity": 2 } ],
        "integrator": { "spp": 16, "wavelength_range_nm": [380, 780] }
    });
    for (pointer, value) in edits {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        scene.pointer_mut(parent).unwrap()[key] = value.clone();
    }
    let (scene, warnings) = etalon_scene::parse(&scene.to_string(), "test").unwrap_or_else(|e| panic!("{e}"));
    assert!(warnings.iter().all(|warning| warning.code == etalon_scene::Code::NoObjects), "{warnings:?}");
    scene
}

fn render(prepared: &Prepared) -> Film {
    prepared.render(&prepared.whole(Some(2)), &|_| Control::Continue).unwrap()
}

/// Nothing but a white sky.
fn white(medium: &Value, coating: &str, spp: u32) -> Scene {
    let sky = json!([{ "type": "environment", "radiance": 1 }]);
    scene(medium, coating, &[("/objects", json!([])), ("/lights", sky), ("/integrator/spp", json!(spp))])
}

#[test]
fn both_drivers_leave_the_same_film() {
    let grey = [("/materials/red", json!({ "type": "lambert", "reflectance": 0.5 }))];
    let moving = [
        ("/camera/shutter_s", json!([0, 1])),
        ("/camera/keyframes", json!([{ "time_s": 0 }, { "time_s": 1, "transform": [{ "translate_m": [0.1, 0, 0] }] }])),
    ];
    let bands = [("/film/bands_nm", json!([450, 650, 50]))];
    let lone = [("/integrator/sampler", json!("independent"))];
    for medium in [json!(1.5168), json!("N-BK7")] {
        for edits in [&[][..], &grey, &moving, &bands, &lone] {
            for polarised in [false, true] {
                let scene = scene(&medium, "none", edits);
                let [batch, scalar] = [PathLoop::Batch, PathLoop::Scalar].map(|path_loop| {
                    let study = Study { path_loop: Some(path_loop), polarised, ..Study::default() };
                    render(&prepare_study(&scene, &study).unwrap())
                });
                assert_eq!(batch.counters, scalar.counters, "{medium} {edits:?}");
                assert!(batch == scalar, "{medium} {edits:?}: the films differ");
                assert_eq!(batch.counters.nonfinite, 0);
            }
        }
    }
}

#[test]
fn a_glass_that_disperses_calls_for_dispersion() {
    let plan = |medium: &Value| prepare(&scene(medium, "ideal", &[])).unwrap();
    let (constant, dispersive) = (plan(&json!(1.5168)), plan(&json!("N-BK7")));
    assert!(constant.plan().runs(EffectName::Lens) && dispersive.plan().runs(EffectName::Lens));
    assert_eq!(constant.plan().lane_model, LaneModel::Shared);
    assert_eq!(dispersive.plan().lane_model, LaneModel::Hero);
    // Without dispersion the glass has its index at the line d.
    let study = Study { without: vec![EffectName::Dispersion], ..Study::default() };
    let index = etalon_optics::RefractiveIndex::named("N-BK7").unwrap().eval(587.5618);
    let left_out = render(&prepare_study(&scene(&json!("N-BK7"), "ideal", &[]), &study).unwrap());
    let plain = render(&plan(&json!(index)));
    assert!(left_out.linear_rec709() == plain.linear_rec709());
    assert!(left_out.linear_rec709() != render(&dispersive).linear_rec709());
}

#[test]
fn without_its_lens_a_camera_is_a_pinhole_of_the_same_view() {
    let scene = scene(&json!(1.5168), "ideal", &[]);
    let Projection::CompoundLens(lens) = &scene.camera.projection else { panic!("a compound lens") };
    let mut plain = scene.clone();
    plain.camera.projection = Projection::Perspective { vertical_fov_rad: 2.0 * lens.half_view().atan(), lens: None };
    let study = Study { without: vec![EffectName::Lens], ..Study::default() };
    let left_out = render(&prepare_study(&scene, &study).unwrap());
    assert!(left_out.linear_rec709() == render(&prepare(&plain).unwrap()).linear_rec709());
}

/// The middle of the film reads 1, whatever the wavelength: the chromatic change of the cone of this lens is within a percent. The corner
/// reads what a lens of f/4 with a stop in front lets there.
#[test]
fn a_white_field_is_white_in_the_middle_and_darker_in_the_corner() {
    for medium in [json!(1.5168), json!("N-BK7")] {
        let film = render(&prepare(&white(&medium, "ideal", 4096)).unwrap());
        let middle = film.pixel(12, 9).xyz()[1];
        let corner = film.pixel(0, 0).xyz()[1];
        // 4096 samples of a number that varies by half: 0.8 %; the hero alone carries eight times the variance of its wavelengths.
        assert!((middle - 1.0).abs() < 0.04, "{medium}: {middle}");
        assert!(corner > 0.2 && corner < 0.95, "{medium}: {corner}");
    }
    let bare = render(&prepare(&white(&json!(1.5168), "none", 4096)).unwrap()).pixel(12, 9).xyz()[1];
    // Two faces, each (1 − R), R = 0.0422.
    assert!((bare - 0.9174).abs() < 0.02, "{bare}");
}

#[test]
fn neighbouring_pixels_do_not_share_its_paths() {
    let scene = scene(&json!(1.5168), "ideal", &[("/integrator/path_reuse", json!("2x2"))]);
    let Err(error) = prepare(&scene) else { panic!("it is refused") };
    assert!(error.to_string().contains("compound lens"), "{error}");
}

/// A path that the lens blocks is a sample that brings nothing, and says so.
#[test]
fn blocked_paths_are_told() {
    let prepared = prepare(&white(&json!(1.5168), "ideal", 64)).unwrap();
    let told = (0..64).any(|sample| {
        let replay = prepared.replay(0, 0, sample);
        replay.xyz == [0.0; 3] && format!("{:?}", replay.events).contains("blocked by the lens")
    });
    assert!(told);
}
