//! Every field of a file arrives in the model.

mod cameras;
mod materials;

use crate::common::{EVERYTHING, Parts, RIGHT};
use etalon_optics::index::SellmeierTerm;
use etalon_optics::spectrum::Outside;
use etalon_optics::{
    ComplexIndex, Fluorescence, Fluorophore, Illuminant, OutsideFit, RefractiveIndex, ReradiationMatrix, Spectrum,
};
use etalon_scene::*;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

fn scene(text: &str) -> Scene {
    parse(text, "test.json").unwrap_or_else(|errors| panic!("{errors}")).0
}

#[test]
fn camera_film_and_integrator() {
    let scene = scene(EVERYTHING);
    // 1/f = 1/z + 1/s for the sensor's distance s behind a lens that is in focus at z.
    let sensor_m = 1.0 / (1.0 / 0.05 - 1.0 / 2.0);
    let Projection::Perspective { vertical_fov_rad, lens } = &scene.camera.projection else { panic!("perspective") };
    // A few roundings each way.
    assert!((vertical_fov_rad - 2.0 * (0.012_f64 / sensor_m).atan()).abs() < 1e-15);
    assert_eq!(lens, &Some(ThinLens { radius_m: 0.0125, focus_distance_m: 2.0 }));
    assert_eq!(scene.camera.position_m, [1.0, 2.0, 3.0]);
    assert_eq!((scene.camera.forward, scene.camera.up), ([0.0, 0.0, -1.0], [0.0, 1.0, 0.0]));
    let filter = Filter::Mitchell { radius_px: 1.5, b: 0.25, c: 0.5 };
    let bands = Bands::new([400.0, 700.0, 10.0], [380.0, 780.0]).ok();
    assert!(bands.is_some());
    assert_eq!(scene.film, Film { width: 320, height: 200, filter, sample_border: false, stokes: true, bands });
    assert_eq!(
        scene.integrator,
        Integrator {
            spp: 16,
            replicates: 8,
            seed: u64::MAX,
            sampler: SamplerKind::Independent,
            max_depth: Some(8),
            count_panes: false,
            hide_lights: true,
            roulette: false,
            light_sampling: LightSampling::Light,
            light_selection: LightSelection::Power,
            light_tracing: LightTracing::Never,
            wavelength_range_nm: [380.0, 780.0],
            path_reuse: PathReuse::Block4x2,
        }
    );
}

#[test]
fn defaults() {
    let scene = scene(&RIGHT.text());
    assert_eq!(
        scene.integrator,
        Integrator {
            spp: 64,
            replicates: 4,
            seed: 0,
            sampler: SamplerKind::Sobol,
            max_depth: None,
            count_panes: true,
            hide_lights: false,
            roulette: true,
            light_sampling: LightSampling::Mis,
            light_selection: LightSelection::Auto,
            light_tracing: LightTracing::Auto,
            wavelength_range_nm: [360.0, 830.0],
            path_reuse: PathReuse::None,
        }
    );
    assert_eq!(scene.film.filter, Filter::Box);
    assert_eq!(scene.camera.up, [0.0, 1.0, 0.0]);
    let object = &scene.objects[0];
    assert_eq!((object.name.as_str(), object.material, &object.emission), ("objects[0]", 0, &None));
    assert_eq!(object.shape, Shape::Sphere { center: [0.0; 3], radius_m: 1.0 });
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(object.transform, Transform { linear: identity, translation_m: [0.0; 3] });
    assert_eq!(scene.lights[0].name, "lights[0]");
}

#[test]
fn objects_and_lights() {
    let scene = scene(EVERYTHING);
    let [ball, sheet, disk, panel, pyramid, block] = scene.objects.as_slice() else { panic!("six") };
    assert_eq!(panel.name, "panel");
    assert_eq!((ball.name.as_str(), ball.material), ("ball", 0));
    assert_eq!(ball.shape, Shape::Sphere { center: [1.0, 0.0, 0.0], radius_m: 0.5 });
    assert_eq!(sheet.shape, Shape::Parallelogram { origin: [0.0; 3], u: [1.0, 0.0, 0.0], v: [0.0, 2.0, 0.0] });
    let radiance = Spectrum::rgb_emission([4.0, 4.0 * 0.8, 2.0], Illuminant::A).expect("right");
    assert_eq!(sheet.emission, Some(Emission { radiance, image: None, sides: EmissionSides::Both }));
    assert_eq!((sheet.name.as_str(), sheet.material), ("objects[1]", 13));
    assert_eq!(
        disk.shape,
        Shape::Disk {
            center: [0.0, 1.0, 0.0],
            normal: [0.0, -0.6, 0.8],
            radius_m: 2.0,
            coordinates: DiskCoordinates::Polar,
        }
    );
    let radiance = Spectrum::blackbody(5000.0, 1e-3).expect("right");
    assert_eq!(disk.emission, Some(Emission { radiance, image: None, sides: EmissionSides::Front }));
    let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let corner = -(1.0 / 3.0_f64.sqrt()) as f32;
    let normals = vec![[corner; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let uvs = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5]];
    let colours = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.25, 1.0]];
    assert_eq!(pyramid.shape, Shape::Mesh(Arc::new(Mesh { vertices, triangles, normals, uvs, colours })));
    assert_eq!((pyramid.name.as_str(), pyramid.material), ("pyramid", 41));
    // By hand: (x, y, z) → (2x, −2y, 6z) → a quarter turn: (2y, 2x, 6z) → moved → x and y swapped, moved.
    let linear = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 6.0]];
    assert_eq!(pyramid.transform, Transform { linear, translation_m: [25.0, 16.0, 37.0] });
    assert_eq!(block.material, 9);

    let kinds: Vec<&LightKind> = scene.lights[..4].iter().map(|l| &l.kind).collect();
    let day = Spectrum::illuminant(Illuminant::D65, 3.0).expect("right");
    let within = Spectrum::tabulated(vec![400.0, 700.0], vec![1.0, 1.0], Outside::Zero).expect("right");
    assert_eq!(
        kinds,
        [
            &LightKind::Point { position_m: [0.0, 9.0, 0.0], intensity: day },
            &LightKind::Directional { direction: [0.0, -1.0, 0.0], irradiance: within },
            &LightKind::Environment { radiance: Spectrum::Constant(0.25) },
            &LightKind::Spot {
                position_m: [0.0, 3.0, 0.0],
                axis: [0.0, -1.0, 0.0],
                half_angles_rad: [std::f64::consts::FRAC_PI_4, FRAC_PI_2],
                intensity: Spectrum::Constant(2.0),
            },
        ]
    );
    assert_eq!(scene.lights[0].name, "bulb");
    assert_eq!(scene.lights[2].name, "lights[2]");
    let LightKind::Beam(laser) = &scene.lights[10].kind else { panic!("a beam") };
    let wanted = Beam {
        position_m: [1.0, 2.0, 3.0],
        direction: [0.0, -1.0, 0.0],
        radius_m: 0.125,
        half_angle_rad: std::f64::consts::FRAC_PI_4,
        profile: BeamProfile::Gaussian,
        power: Spectrum::Constant(0.25),
    };
    assert_eq!(laser, &wanted);
    let LightKind::Beam(parallel) = &scene.lights[11].kind else { panic!("a beam") };
    assert_eq!((parallel.half_angle_rad, parallel.profile), (0.0, BeamProfile::Uniform));
    let slide = scene.lights[14].kind.slide().expect("a slide");
    assert_eq!((slide.direction, slide.right, slide.up), ([0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]));
    let [right, up] = slide.tangents;
    assert!((right - 1.0).abs() < 1e-15 && up == 0.5 * right && slide.even_on == EvenOn::Sphere);
    assert_eq!(slide.image.eval([0.25, 0.25]), [1.0; 3]);
    assert_eq!(scene.lights[15].kind.slide().expect("a slide").even_on, EvenOn::Screen);
}

#[test]
fn a_box_is_a_closed_mesh_whose_normals_point_outward() {
    let scene = scene(EVERYTHING);
    let Shape::Mesh(mesh) = &scene.objects[5].shape else { panic!("a mesh") };
    let Mesh { vertices, triangles, .. } = &**mesh;
    assert_eq!((vertices.len(), triangles.len()), (8, 12));
    let mut edges = std::collections::HashMap::new();
    let (mut volume, mut area) = (0.0, 0.0);
    for t in triangles {
        let [a, b, c] = t.map(|i| vertices[i as usize]);
        let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        // The divergence theorem: six times the volume is Σ a·n, positive only for outward normals.
        volume += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6.0;
        area += 0.5 * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
        }
    }
    assert_eq!((volume, area), (6.0, 22.0));
    // Closed and oriented: each edge is walked once each way.
    assert!(edges.iter().all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1)));
}

#[test]
fn rotations_are_proper_and_exact_at_quarter_turns() {
    let linear = |axis: &str, angle: &str| {
        let objects = format!(
            "[{{\"shape\": {{\"type\": \"sphere\", \"radius_m\": 1}}, \"material\": \"white\", \
             \"transform\": [{{\"rotate\": {{\"axis\": {axis}, \"angle_deg\": {angle}}}}}]}}]"
        );
        scene(&Parts { objects: &objects, ..RIGHT }.text()).objects[0].transform.linear
    };
    assert_eq!(linear("[0, 0, 7]", "90"), [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(linear("[0, 0, 7]", "-270"), linear("[0, 0, 1]", "450"));
    assert_eq!(linear("[3, 0, 0]", "180"), [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
    assert_eq!(linear("[0, 1, 0]", "-1e-30"), linear("[0, 1, 0]", "0"));
    // Hard case 18: the axis (1, 2, 3) is normalised; ‖RᵀR − 1‖ < 4ε for unit axes to one rounding.
    let r = linear("[1, 2, 3]", "77");
    for i in 0..3 {
        for j in 0..3 {
            let dot: f64 = (0..3).map(|k| r[k][i] * r[k][j]).sum();
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((dot - expected).abs() < 4.0 * f64::EPSILON, "{i}{j}: {dot}");
        }
    }
    // The axis stays where it is.
    let axis = [1.0, 2.0, 3.0];
    for i in 0..3 {
        let turned: f64 = (0..3).map(|k| r[i][k] * axis[k]).sum();
        assert!((turned - axis[i]).abs() < 1e-14);
    }
}

#[test]
fn needles_are_kept_and_only_triangles_without_area_are_dropped() {
    let objects = "[{\"shape\": {\"type\": \"mesh\", \"vertices_m\": \
        [[0,0,0],[1e5,0,0],[5e4,1,0],[1e-300,0,0],[0,1e-300,0],[1,1,1],[2,2,2],[3,3,3],[1e300,0,0]], \
        \"triangles\": [[0,1,2],[0,3,4],[5,6,7],[0,0,1]]}, \"material\": \"white\"}]";
    // The last vertex is too far for the squares of distances; without it all is well.
    assert!(parse(&Parts { objects, ..RIGHT }.text(), "test.json").is_err());
    let objects = objects.replace("[1e300,0,0]", "[0,0,1]");
    let scene = scene(&Parts { objects: &objects, ..RIGHT }.text());
    let Shape::Mesh(mesh) = &scene.objects[0].shape else { panic!("a mesh") };
    let triangles = &mesh.triangles;
    assert_eq!(triangles, &[[0, 1, 2], [0, 3, 4]]);
}

#[test]
fn a_file_is_read_from_the_disk() {
    let missing = load("no/such/scene.json").expect_err("there is none");
    assert!(matches!(missing, LoadError::Io { .. }), "{missing}");
    let path = std::env::temp_dir().join(format!("etalon-scene-test-{}.json", std::process::id()));
    std::fs::write(&path, format!("\u{feff}{EVERYTHING}")).expect("written");
    assert_eq!(load(&path).expect("right").0, scene(EVERYTHING));
    std::fs::write(&path, b"{\n\"etalon\": \"\xFF\"}").expect("written");
    let Err(LoadError::Invalid(errors)) = load(&path) else { panic!("it is not UTF-8") };
    std::fs::remove_file(&path).expect("removed");
    let problem = &errors.problems[0];
    assert_eq!((problem.code, problem.line, problem.column), (Code::NotUtf8, 2, 12));
    assert_eq!(&errors.text[problem.span.start..problem.span.end], "\u{fffd}");
}

#[test]
fn groups_come_after_what_they_place_and_transforms_make_an_instance_each() {
    let scene = scene(EVERYTHING);
    let names: Vec<&str> = scene.groups.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["ball", "pair", "unused"]);
    let [ball, pair, unused] = scene.groups.as_slice() else { panic!("three") };
    assert_eq!((ball.objects.len(), ball.objects[0].name.as_str()), (1, "groups.ball.objects[0]"));
    let tube = Shape::Cylinder { start: [0.0; 3], end: [0.0, 1.0, 0.0], radius_m: 1.0, capped: false };
    assert_eq!((&unused.objects[0].shape, &unused.instances), (&tube, &Vec::new()));
    let stretched = Transform { linear: [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, -3.0]], translation_m: [0.0; 3] };
    let instance = |name: &str, group, transform| Instance { name: name.to_owned(), group, transform, motion: None };
    assert_eq!(pair.instances, [instance("two[0]", 0, Transform::IDENTITY), instance("two[1]", 0, stretched)]);
    let moved = Transform { translation_m: [0.0, 0.0, 9.0], ..Transform::IDENTITY };
    let [first, alone, rolls] = scene.instances.as_slice() else { panic!("three") };
    assert_eq!((first, alone), (&instance("instances[0]", 1, moved), &instance("alone", 0, Transform::IDENTITY)));
    // From −0.5 s to 1.5 s: in the middle, at 0.5 s, halfway between the keyframes.
    let twice = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    assert_eq!(rolls.transform, Transform { linear: twice, translation_m: [2.0, 0.0, 1.0] });
    let keyframes = &rolls.motion.as_ref().expect("it moves").keyframes;
    assert_eq!((keyframes.len(), keyframes[1].time_s, keyframes[1].mirrors()), (2, 1.0, false));
    assert_eq!(keyframes[1].transform.translation_m, [4.0, 0.0, 2.0]);
    // A keyframe that is the only one moves nothing.
    assert_eq!((scene.camera.shutter_s, scene.camera.moves()), ([-0.5, 1.5], false));
    assert_eq!(scene.placed_objects().count(), scene.objects.len() + 1);
}

/// The frames of a sequence are made so.
#[test]
fn a_scene_whose_shutter_is_opened_later_is_that_of_a_file_that_says_so() {
    let text = |shutter_s: &str| {
        let camera = format!(
            r#"{{"type": "perspective", "position_m": [0, 1, 5], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40, "shutter_s": {shutter_s},
            "keyframes": [{{"time_s": 1}}, {{"time_s": 4, "transform": [{{"rotate": {{"axis": [0, 1, 0], "angle_deg": 90}}}}]}}]}}"#
        );
        let turn = r#"[{"rotate": {"axis": [1, 2, 3], "angle_deg": 50}}, {"translate_m": [1, 2, 3]}]"#;
        let keyframes = format!(r#"[{{"time_s": 0}}, {{"time_s": 1.5, "transform": {turn}}}]"#);
        let groups =
            format!(r#"{{"moon": {{}}, "earth": {{"instances": [{{"group": "moon", "keyframes": {keyframes}}}]}}}}"#);
        format!(
            r#"{{"etalon": 1, "camera": {camera}, "film": {{"width": 4, "height": 3}}, "groups": {groups},
            "instances": [{{"group": "earth", "keyframes": {keyframes}}}, {{"group": "moon", "transform": {turn}}}]}}"#
        )
    };
    let stated = |shutter_s: &str| scene(&text(shutter_s));
    let mut moved = stated("[0, 0]");
    for [open, close] in [[0.3, 0.3], [0.25, 0.75], [1.0, 2.5], [-3.0, -1.0], [4.0, 9.0], [0.0, 0.0]] {
        moved.set_shutter([open, close]);
        assert_eq!(moved, stated(&format!("[{open:?}, {close:?}]")));
    }
    assert!(!moved.camera.moves() && !moved.instances[0].moves([0.0, 0.0]));
    assert!(moved.instances[0].moves([0.0, 0.5]) && !moved.instances[0].moves([2.0, 3.0]));
    assert!(!moved.instances[1].moves([0.0, 0.5]));
}

#[test]
fn a_camera_moves_as_a_thing_does_in_a_group_so_placed() {
    let camera = r#"{"type": "orthographic", "position_m": [0, 0, 5], "direction": [0, 0, -1], "height_m": 1, "shutter_s": [0, 2],
        "keyframes": [{"time_s": 0}, {"time_s": 2, "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": 90}}]}]}"#;
    let scene = scene(&Parts { camera, ..RIGHT }.text());
    let moving = scene.camera.motion.as_ref().expect("it moves");
    assert_eq!((moving.position_m, moving.forward, moving.up), ([0.0, 0.0, 5.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]));
    // In the middle of the time it has gone an eighth of the circle around the y axis.
    let half = 0.5_f64.sqrt();
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-14);
    assert!(near(scene.camera.position_m, [5.0 * half, 0.0, 5.0 * half]), "{:?}", scene.camera);
    assert!(near(scene.camera.forward, [-half, 0.0, -half]) && near(scene.camera.up, [0.0, 1.0, 0.0]));
}

#[test]
fn meters() {
    let scene = scene(EVERYTHING);
    let kinds: Vec<&MeterKind> = scene.meters.iter().map(|meter| &meter.kind).collect();
    let [irradiance, grid, flux, radiance] = kinds[..] else { panic!("four meters") };
    assert_eq!(irradiance, &MeterKind::Irradiance { position_m: [0.0, 0.75, 0.0], normal: [0.0, 1.0, 0.0] });
    let edges_m = [[0.0, 0.0, 2.0], [1.0, 0.0, 0.0]];
    assert_eq!(grid, &MeterKind::IrradianceGrid { origin_m: [0.0; 3], edges_m, cells: [3, 2] });
    assert_eq!(flux, &MeterKind::Flux { origin_m: [0.0; 3], edges_m: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] });
    let MeterKind::Radiance { half_angle_rad, direction, .. } = radiance else { panic!("radiance") };
    assert_eq!((*half_angle_rad, *direction), (1.0_f64.to_radians(), [0.0, 0.0, -1.0]));
    let names: Vec<&str> = scene.meters.iter().map(|meter| meter.name.as_str()).collect();
    assert_eq!(names, ["desk", "floor", "meters[2]", "meters[3]"]);

    // Centres of cells along u, then along v; the normal along u × v.
    let places: Vec<[f64; 3]> = grid
        .receivers()
        .iter()
        .map(|receiver| match receiver {
            Receiver::Plane { origin_m, edges_m, normal } => {
                assert_eq!((*edges_m, *normal), ([[0.0; 3]; 2], [0.0, 1.0, 0.0]));
                *origin_m
            }
            Receiver::Cone { .. } => panic!("a plane"),
        })
        .collect();
    assert_eq!(places[0], [0.25, 0.0, 2.0 / 6.0]);
    assert_eq!(places[3], [0.75, 0.0, 2.0 / 6.0]);
    assert_eq!(places.len(), 6);

    let measured = scene.measured(32).unwrap();
    assert_eq!((measured.film.width, measured.film.height, measured.integrator.replicates), (9, 32, 1));
    assert!(Scene { meters: Vec::new(), ..scene }.measured(32).is_none());
}

#[test]
fn light_in_photometric_units() {
    let scene = scene(EVERYTHING);
    // Y of a spectrum, in cd or lm.
    let of = |spectrum: &Spectrum| 683.002 * 106.856_917 * etalon_optics::colour::luminance_of(|nm| spectrum.eval(nm));
    let close = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 1e-8, "{got} is not {want}");
    let values: Vec<f64> = scene.lights[4..].iter().map(|light| of(light.kind.spectrum())).collect();
    let whole = 4.0 * std::f64::consts::PI;
    // The spot's inner angle is four fifths of 90°.
    let spot = 0.5 * whole * (1.0 - 0.5 * 72_f64.to_radians().cos());
    for (value, want) in values.iter().zip([100.0, 800.0 / whole, 800.0 / spot, 5e4, 100.0, 3000.0]) {
        close(*value, want);
    }
    close(values[7], 60.0);
    let LightKind::Sky(sky) = &scene.lights[9].kind else { panic!("a sky") };
    assert_eq!((sky.number, sky.up, sky.ground), (12, [0.0, 1.0, 0.0], 0.125));
    close(sky.sun[1], 0.6);
    assert!(sky.needs_sun());
    close(values[9], 5.0);
    let LightKind::Daylight(sky) = &scene.lights[12].kind else { panic!("a sky") };
    assert_eq!((sky.turbidity, sky.up, sky.ground), (4.0, [0.0, 1.0, 0.0], 0.25));
    close(sky.sun[1], 0.6);
    close(of(&sky.mean), 0.5);
    let panel = scene.objects.iter().find(|object| object.name == "panel").expect("it is there");
    close(of(&panel.emission.as_ref().expect("it shines").radiance), 500.0);
    assert!(!scene.lights[5].kind.spectrum().is_zero() && scene.lights[5].kind.spectrum().is_constant());
}
