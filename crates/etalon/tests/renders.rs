//! The facade gives the films of the integrator below it, answers instead of panics, and files that can be read.

use etalon::{Aov, Channels, PixelRect, QuoteSettings, Reached, RenderError, SceneBuilder, Settings, json};

/// A grey ball under an even sky and a lamp.
fn ball() -> SceneBuilder {
    SceneBuilder::new()
        .camera(
            json!({ "type": "perspective", "position_m": [0, 1, 5], "look_at_m": [0, 0.5, 0], "vertical_fov_deg": 40 }),
        )
        .film(24, 16)
        .material("grey", json!({ "type": "lambert", "reflectance": 0.5 }))
        .object(json!({ "name": "ball", "shape": { "type": "sphere", "radius_m": 1 }, "material": "grey" }))
        .light(json!({ "type": "environment", "radiance": 1 }))
        .light(json!({ "type": "point", "position_m": [3, 4, 2], "intensity": 10 }))
}

#[test]
fn a_render_has_the_film_of_the_integrator() {
    let mut scene = ball().build().unwrap();
    scene.keep_bands([450.0, 650.0, 100.0]).unwrap();
    assert!(scene.keep_bands([450.0, 680.0, 100.0]).is_err());
    let renderer = scene.prepare().unwrap();
    let render = renderer.render(&Settings { samples: Some(32), ..Default::default() }).unwrap();
    let direct = etalon_transport::prepare(&scene.model).unwrap();
    let limits = etalon_control::Limits {
        samples: 32,
        relative_rmse: None,
        seconds: None,
        adaptivity: etalon::Adaptivity::Never,
    };
    let film = etalon_control::render_within(&direct, render.rect(), &limits, Some(1), &|| 0.0, &()).unwrap().film;
    assert_eq!(render.rgb_pixels(), film.linear_rec709());
    assert_eq!(render.bands_nm(), [450.0, 550.0, 650.0]);
    for (x, y) in render.rect().pixels() {
        let error = render.rgb_error(x, y).unwrap();
        assert!(error.iter().all(|error| error.is_finite()), "{x} {y}: {error:?}");
    }
}

#[test]
fn an_exr_holds_what_was_asked_for_and_is_read_back() {
    let channels = Channels::new(&[Aov::Depth, Aov::Object], false);
    let mut scene = ball().build().unwrap();
    scene.keep_bands([450.0, 650.0, 100.0]).unwrap();
    let renderer = scene.prepare().unwrap();
    let crop = PixelRect { x0: 4, y0: 2, x1: 20, y1: 14 };
    let settings = Settings { samples: Some(8), crop: Some(crop), channels, ..Default::default() };
    let render = renderer.render(&settings).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.exr");
    render.write_exr(&path).unwrap();
    let file = etalon::picture_files::read_exr(&path).unwrap();
    for channel in ["R", "Error.G", "S0.550,000000nm", "Z", "ObjectId"] {
        assert_eq!(file.picture.require(channel).unwrap().len(), 16 * 12, "{channel}");
    }
    let whole = render.exr().unwrap().picture;
    assert_eq!(file.picture.channels().len(), whole.channels().len());
    for channel in whole.channels() {
        let read = file.picture.require(&channel.name).unwrap();
        assert!(read.iter().zip(&channel.samples).all(|(a, b)| a.to_bits() == b.to_bits()), "{}", channel.name);
    }
    // The middle of the ball is the object; nothing was rendered outside of the crop.
    assert_eq!(render.features(12, 8).unwrap().object, 1.0);
    assert_eq!(renderer.object_names(), ["ball"]);
    assert!(render.rgb(0, 0).is_none() && render.band(0, 0, 0).is_none() && render.features(0, 0).is_none());
    assert!(render.band(12, 8, 3).is_none() && render.stokes_band(12, 8, 1, 0).is_none());
    let clipping = render.write_png(folder.path().join("ball.png"), -4.0).unwrap();
    assert_eq!(clipping.any, 0);
}

#[test]
fn a_render_to_an_error_reaches_it_and_costs_what_was_quoted() {
    let renderer = ball().build().unwrap().prepare().unwrap();
    let quote = renderer.quote(&QuoteSettings { errors: vec![0.02], ..Default::default() }).unwrap();
    let render = renderer.render(&Settings { error: Some(0.02), ..Default::default() }).unwrap();
    assert_eq!(render.reached(), Reached::Error);
    // The estimate of the error is itself uncertain; a pilot aims at the error with some room.
    assert!(render.error().unwrap().relative_rmse < 0.03);
    let samples = f64::from(render.samples());
    let [least, most] = quote.estimates[0].samples_interval;
    assert!(samples > 0.3 * least && samples < 3.0 * most, "{samples} of {least} to {most}");
}

#[test]
fn what_makes_no_sense_is_an_error() {
    let renderer = ball().build().unwrap().prepare().unwrap();
    let refused = |settings: Settings| renderer.render(&settings).unwrap_err();
    let crop = |x0, y0, x1, y1| Settings { crop: Some(PixelRect { x0, y0, x1, y1 }), ..Default::default() };
    assert!(matches!(refused(crop(0, 0, 25, 16)), RenderError::Outside { size: [24, 16], .. }));
    assert!(matches!(refused(crop(5, 0, 5, 16)), RenderError::Setting(_)));
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(Settings { error: Some(wrong), ..Default::default() }), RenderError::Setting(_)));
        assert!(matches!(refused(Settings { seconds: Some(wrong), ..Default::default() }), RenderError::Setting(_)));
    }
    assert!(matches!(refused(Settings { threads: Some(0), ..Default::default() }), RenderError::Setting(_)));
    assert!(matches!(renderer.replay(24, 0, 0), Err(RenderError::Outside { .. })));
    assert!(renderer.replay(23, 15, 0).is_ok());

    let dark = SceneBuilder::new()
        .camera(json!({ "type": "orthographic", "position_m": [0, 0, 5], "direction": [0, 0, -1], "height_m": 2 }))
        .film(8, 8)
        .object(json!({ "shape": { "type": "sphere", "radius_m": 1 }, "material": { "type": "lambert", "reflectance": 0.5 } }));
    let dark = dark.build().unwrap().prepare().unwrap();
    let error = dark.render(&Settings { error: Some(0.01), ..Default::default() }).unwrap_err();
    assert!(matches!(error, RenderError::NoLight { .. }), "{error}");
}

#[test]
fn a_built_scene_may_refer_to_files_in_memory() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n0 1 0\n3 0 1 2\n";
    let object = json!({ "shape": { "type": "mesh", "file": "one.ply" }, "material": { "type": "lambert", "reflectance": 0.5 } });
    let with = ball().object(object);
    assert!(with.build().is_err(), "there is no such file");
    let scene = with.clone().file("one.ply", ply).build().unwrap();
    assert_eq!(scene.model.objects.len(), 2);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("one.ply"), ply).unwrap();
    let of_folder = with.build_in(folder.path()).unwrap();
    assert_eq!(of_folder.sha256, scene.sha256, "the hash is that of the text and the bytes of the file");
}
