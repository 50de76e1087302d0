//! What is left out of a scene that calls for it: the picture is that of a scene which says nothing of it, bit for bit. Solids within
//! others, polarisation and motion have tests of their own that leave them out.

use etalon_optics::colour::colour_matching;
use etalon_optics::{RefractiveIndex, Spectrum};
use etalon_scene::{
    AlbedoGrid, Image, ImageTexture, MaterialKind, NumberTexture, ParameterMut, Scene, SpectrumTexture, Texels,
    TextureFilter, Wrap,
};
use etalon_transport::plan::LaneModel;
use etalon_transport::{EffectName, Study, prepare, prepare_study};
use serde_json::{Value, json};
use std::sync::Arc;

use crate::common::rendering::{mean_y, parse, render};

/// What a material reflects.
fn reflectance(kind: &mut MaterialKind) -> &mut SpectrumTexture {
    kind.parameters_mut().into_iter().find_map(ParameterMut::reflectance).unwrap()
}

/// A room that calls for almost everything, in which all of it is seen.
fn room() -> Value {
    json!({
        "etalon": 1,
        "camera": {"type": "perspective", "position_m": [0, 1.2, 4], "look_at_m": [0, 0.5, 0], "vertical_fov_deg": 40,
            "lens": {"radius_m": 0.1, "focus_distance_m": 3}},
        "film": {"width": 16, "height": 12, "filter": {"type": "gaussian", "sigma_px": 0.5}, "bands_nm": [450, 650, 50]},
        "materials": {
            "stone": {"type": "lambert", "reflectance": {"type": "tabulated", "wavelengths_nm": [360, 550, 830], "values": [0.2, 0.4, 0.9]}},
            "glass": {"type": "dielectric", "interior": "N-SF11", "absorption_per_m": 2},
            "mirror": {"type": "mirror", "reflectance": 0.9}
        },
        "objects": [
            {"shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 3}, "material": "stone"},
            {"shape": {"type": "parallelogram", "origin_m": [-1, 3, -1], "u_m": [1, 0, 0], "v_m": [0, 0, 1]},
                "material": {"type": "black"}, "emission": {"radiance": {"type": "illuminant", "name": "D65"}}},
            {"shape": {"type": "sphere", "center_m": [-0.5, 0.4, 0.5], "radius_m": 0.4}, "material": "glass"},
            {"shape": {"type": "sphere", "center_m": [0.5, 0.4, 0], "radius_m": 0.4}, "material": "mirror"},
            {"shape": {"type": "mesh", "vertices_m": [[-1.5, 0, -1], [1.5, 0, -1], [0, 2, -1]], "triangles": [[0, 1, 2]],
                "normals": [[-1, 0, 1], [1, 0, 1], [0, 1, 1]]}, "material": "stone", "opacity": 0.75}
        ],
        "groups": {"things": {"objects": [
            {"shape": {"type": "box", "min_m": [0.9, 0, 0], "max_m": [1.2, 0.6, 0.5]}, "material": "stone"}]}},
        "instances": [{"group": "things"}],
        "lights": [
            {"type": "environment", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.1}},
            {"type": "point", "position_m": [1, 2, 1], "intensity": {"type": "illuminant", "name": "A"}}],
        "integrator": {"spp": 64, "wavelength_range_nm": [400, 700], "max_depth": 6}
    })
}

/// The index of the glass at the helium line d, at which catalogues state it.
fn index_of_glass() -> f64 {
    RefractiveIndex::named("N-SF11").unwrap().eval(587.5618)
}

fn without(effect: EffectName) -> Study {
    Study { without: vec![effect], ..Study::default() }
}

/// That leaving an effect out of `scene` gives the picture of `plain`, which differs from what the whole scene shows.
fn same(effect: EffectName, scene: &Scene, plain: &Scene) {
    let (left_out, plain) = (render(scene, &without(effect)), render(plain, &Study::default()));
    assert!(mean_y(&left_out) > 0.0);
    assert!(left_out.linear_rec709() == plain.linear_rec709(), "{effect} is not what was left out");
    assert!(render(scene, &Study::default()).linear_rec709() != plain.linear_rec709(), "{effect} is not seen");
}

#[test]
fn what_is_left_out_is_not_in_the_picture() {
    let whole = room();
    let plain: Vec<(EffectName, Vec<(&str, Value)>)> = vec![
        (EffectName::Dispersion, vec![("/materials/glass/interior", json!(index_of_glass()))]),
        (EffectName::Lens, vec![("/camera/lens/radius_m", json!(0))]),
        (
            EffectName::ShadowRays,
            vec![("/lights", json!([whole["lights"][0]])), ("/integrator/light_sampling", json!("bsdf"))],
        ),
        (EffectName::Mis, vec![("/integrator/light_sampling", json!("light"))]),
        (EffectName::Environment, vec![("/lights", json!([whole["lights"][1]]))]),
        (
            EffectName::SpecularChains,
            vec![("/materials/glass", json!({"type": "black"})), ("/materials/mirror", json!({"type": "black"}))],
        ),
        (EffectName::Absorption, vec![("/materials/glass/absorption_per_m", json!(0))]),
        (EffectName::ShadingNormals, vec![("/objects/4/shape/shading", json!("flat"))]),
        (EffectName::Masks, vec![("/objects/4/opacity", json!(1))]),
        (EffectName::Instances, vec![("/instances", json!([])), ("/groups", json!({}))]),
        (EffectName::WideFilter, vec![("/film/filter", json!({"type": "box"}))]),
        (EffectName::Bands, vec![("/film/bands_nm", json!(null))]),
    ];
    for (effect, edits) in plain {
        let mut edited = whole.clone();
        for (pointer, value) in edits {
            let (parent, key) = pointer.rsplit_once('/').unwrap();
            let parent = edited.pointer_mut(parent).unwrap();
            match parent {
                Value::Array(_) => unreachable!("{pointer}"),
                Value::Object(of) if value.is_null() => drop(of.remove(key)),
                _ => parent[key] = value,
            }
        }
        same(effect, &parse(&whole.to_string()), &parse(&edited.to_string()));
    }
}

/// A film on glass and one on metal, whose images go with the other images, and whose colours go with the wavelengths.
#[test]
fn films_that_are_left_out_leave_bare_surfaces() {
    let bare = room();
    let mut whole = bare.clone();
    let film = json!([{"thickness_nm": 120, "index": 1.9}, {"thickness_nm": 250, "index": "water"}]);
    whole["materials"]["glass"]["thin_film"] = film.clone();
    let metal = json!({"type": "conductor", "wavelengths_nm": [300, 900], "n": [2, 2], "k": [3, 3]});
    whole["materials"]["mirror"] = metal.clone();
    whole["materials"]["mirror"]["thin_film"] = film;
    let mut plain = bare;
    plain["materials"]["mirror"] = metal;
    let (whole, plain) = (parse(&whole.to_string()), parse(&plain.to_string()));
    same(EffectName::Interference, &whole, &plain);

    let image = || ImageTexture {
        filter: TextureFilter::Nearest,
        factor: [400.0; 3],
        ..ImageTexture::new(Image::new(2, 1, Texels::F32(vec![[0.25; 3], [0.75; 3]])))
    };
    let with = |thickness: NumberTexture| {
        let mut scene = whole.clone();
        for material in &mut scene.materials {
            for parameter in material.kind.parameters_mut() {
                if let ParameterMut::Film(film) = parameter {
                    film.layers[0].thickness_nm = thickness.clone();
                }
            }
        }
        scene
    };
    same(EffectName::Textures, &with(NumberTexture::Image(image())), &with(200.0.into()));

    // Grey light on what is grey but for its films: without wavelengths all pictures are grey.
    let grey = json!({
        "etalon": 1,
        "camera": {"type": "orthographic", "position_m": [0, 0, 2], "look_at_m": [0, 0, 0], "height_m": 1},
        "film": {"width": 2, "height": 2},
        "materials": {"soap": {"type": "dielectric", "interior": 1, "thin_film": [{"thickness_nm": 300, "index": 1.33}]}},
        "objects": [
            {"shape": {"type": "disk", "normal": [0, 0, 1], "radius_m": 3}, "material": "soap"},
            {"shape": {"type": "disk", "center_m": [0, 0, -1], "normal": [0, 0, 1], "radius_m": 9}, "material": {"type": "black"}}
        ],
        "lights": [{"type": "environment", "radiance": 1}],
        "integrator": {"spp": 64}
    });
    let scene = parse(&grey.to_string());
    let plan = |study: &Study| prepare_study(&scene, study).unwrap().plan().clone();
    assert_eq!(plan(&Study::default()).lane_model, LaneModel::Hero);
    assert_eq!(plan(&without(EffectName::Wavelengths)).lane_model, LaneModel::One);
    let film = etalon_oracle::laws::CoatedInterface::single(1.0, [1.33, 0.0, 300.0], 1.0);
    let reflected = film.waves(587.5618, 1.0).reflectance();
    let grey = mean_y(&render(&scene, &without(EffectName::Wavelengths)));
    // 256 paths of a probability near 0.06.
    assert!((grey - reflected).abs() < 6.0 * (reflected / 256.0).sqrt(), "{grey} {reflected}");
}

/// An image of two by one texels on the floor, and one on the lamp.
#[test]
fn images_that_are_left_out_leave_their_mean_colour() {
    let texels = [[0.75, 0.25, 0.125], [0.25, 0.5, 0.125]];
    let mean = json!([0.5, 0.375, 0.125]);
    let image = || ImageTexture {
        filter: TextureFilter::Nearest,
        ..ImageTexture::new(Image::new(2, 1, Texels::F32(texels.to_vec())))
    };
    let mut whole = room();
    whole["materials"]["stone"]["reflectance"] = json!({"type": "rgb", "rgb": mean});
    whole["objects"][1]["emission"]["radiance"] = json!({"type": "rgb", "rgb": mean});
    let plain = parse(&whole.to_string());
    for lamp in [false, true] {
        let mut scene = plain.clone();
        if lamp {
            let emission = scene.objects[1].emission.as_mut().unwrap();
            (emission.image, emission.radiance) = (Some(image()), Spectrum::ONE);
        } else {
            let stone = scene.materials.iter_mut().find(|material| material.name == "stone").unwrap();
            *reflectance(&mut stone.kind) = SpectrumTexture::Image(image());
        }
        same(EffectName::Textures, &scene, &plain);
    }
}

#[test]
fn without_wavelengths_every_spectrum_is_its_mean_as_the_eye_weighs_it() {
    // By half nanometres, where the study takes whole ones: 10⁻⁴ is far above what that leaves of tables that are smooth.
    let mean = |spectrum: &dyn Fn(f64) -> f64| {
        let (sum, total) = (0..=600).map(|i| 400.0 + 0.5 * f64::from(i)).fold((0.0, 0.0), |(sum, total), nm| {
            let weight = colour_matching(nm)[1];
            (sum + weight * spectrum(nm), total + weight)
        });
        sum / total
    };
    let mut whole = room();
    whole["lights"][1]["intensity"] = whole["lights"][0]["radiance"].clone();
    let mut grey = whole.clone();
    let stone = |nm: f64| if nm < 550.0 { 0.2 + 0.2 * (nm - 360.0) / 190.0 } else { 0.4 + 0.5 * (nm - 550.0) / 280.0 };
    grey["materials"]["stone"]["reflectance"] = json!(mean(&stone));
    grey["materials"]["glass"]["interior"] = json!(index_of_glass());
    let scene = parse(&whole.to_string());
    let radiance = |scene: &Scene| scene.objects[1].emission.as_ref().unwrap().radiance.clone();
    let lamp = radiance(&scene);
    grey["objects"][1]["emission"]["radiance"] = json!(mean(&|nm| lamp.eval(nm)));
    for light in 0..2 {
        let key = ["radiance", "intensity"][light];
        grey["lights"][light][key] = json!(0.1 * mean(&|nm| lamp.eval(nm)));
    }
    let (left_out, grey) =
        (render(&scene, &without(EffectName::Wavelengths)), render(&parse(&grey.to_string()), &Study::default()));
    for (left_out, grey) in left_out.linear_rec709().iter().zip(grey.linear_rec709()) {
        for c in 0..3 {
            assert!((left_out[c] - grey[c]).abs() <= 1e-4 * grey[c], "{left_out:?} is not {grey:?}");
        }
    }
}

/// Of sheets and images, under light that is the same at all wavelengths.
#[test]
fn without_wavelengths_images_keep_their_luminances_and_wave_plates_the_delay_of_one() {
    let square = |z: f64, material: Value| {
        json!({
            "shape": {"type": "parallelogram", "origin_m": [-1, -1, z], "u_m": [2, 0, 0], "v_m": [0, 2, 0]},
            "material": material
        })
    };
    let scene = |objects: Vec<Value>| {
        json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 5], "direction": [0, 0, -1], "height_m": 2},
            "film": {"width": 2, "height": 2},
            "objects": objects,
            "lights": [{"type": "environment", "radiance": 1}],
            "integrator": {"spp": 4}
        })
    };
    let close = |a: &Scene, b: &Scene, what: &str| {
        let [a, b] = [a, b].map(|scene| render(scene, &without(EffectName::Wavelengths)).linear_rec709());
        for (a, b) in a.iter().zip(&b) {
            // The luminance of what is grey is rounded once more.
            assert!((0..3).all(|c| (a[c] - b[c]).abs() <= 1e-6 * b[c]) && b[1] > 0.01, "{what}: {a:?} is not {b:?}");
        }
    };
    let printed = |texels: [[f32; 3]; 2], factor: [f64; 3]| {
        let floor = square(0.0, json!({"type": "lambert", "reflectance": 0.5}));
        let mut scene = parse(&scene(vec![floor]).to_string());
        let image = Image::new(2, 1, Texels::F32(texels.to_vec()));
        let texture = ImageTexture { filter: TextureFilter::Nearest, factor, ..ImageTexture::new(image) };
        *reflectance(&mut scene.materials[0].kind) = SpectrumTexture::Image(texture);
        scene
    };
    let luminances = [0.2126 * 0.25 + 0.7152 * 0.5 + 0.0722 * 0.125, 0.2126 * 0.125 + 0.7152 * 0.25 + 0.0722 * 0.5];
    let grey = printed(luminances.map(|y: f64| [y as f32; 3]), [1.0; 3]);
    close(&printed([[0.5, 0.5, 0.5], [0.25, 0.25, 2.0]], [0.5, 1.0, 0.25]), &grey, "image");

    // Between two polarisers as one: cos²(δ/2) of the light, δ in inverse proportion to the wavelength.
    let plates = |plate: Value| {
        let polariser = |z: f64| square(z, json!({"type": "polariser", "axis": [0, 1, 0]}));
        parse(&scene(vec![polariser(0.0), square(1.0, plate), polariser(2.0)]).to_string())
    };
    let retarder =
        |retardance_deg: f64| json!({"type": "retarder", "axis": [1, 1, 0], "retardance_deg": retardance_deg});
    let mut dispersive = retarder(120.0);
    dispersive["at_nm"] = json!(500);
    close(&plates(dispersive), &plates(retarder(120.0 * 500.0 / 587.5618)), "wave plate");
}

/// Under light that is the same at all wavelengths: each kind that treats them unlike calls for them, its like that does not calls for
/// none, and the picture of the first has a colour.
#[test]
fn materials_that_treat_wavelengths_unlike_call_for_them() {
    let red = json!({"type": "tabulated", "wavelengths_nm": [360, 830], "values": [0.1, 0.9]});
    let pairs = [
        (json!({"type": "lambert", "reflectance": red}), json!({"type": "lambert", "reflectance": 0.5})),
        (
            json!({"type": "oren-nayar", "reflectance": red, "roughness": 0.6}),
            json!({"type": "oren-nayar", "reflectance": 0.5, "roughness": 0.6}),
        ),
        (json!({"type": "mirror", "reflectance": red}), json!({"type": "mirror", "reflectance": 0.5})),
        (json!({"type": "plastic", "reflectance": red}), json!({"type": "plastic", "reflectance": 0.5})),
        (json!({"type": "conductor", "metal": "Cu"}), json!({"type": "mirror", "reflectance": 1})),
        (json!({"type": "conductor", "metal": "Au", "alpha": 0.3}), json!({"type": "mirror", "reflectance": 1})),
        (
            json!({"type": "polariser", "axis": [0, 1, 0], "transmittance": red}),
            json!({"type": "polariser", "axis": [0, 1, 0], "transmittance": 0.5}),
        ),
    ];
    for (coloured, plain) in pairs {
        let scene = |material: &Value| {
            let json = json!({
                "etalon": 1,
                "camera": {"type": "orthographic", "position_m": [0, 0, 5], "direction": [0, 0, -1], "height_m": 1},
                "film": {"width": 2, "height": 2},
                "objects": [{"shape": {"type": "disk", "normal": [0, 0, 1], "radius_m": 2}, "material": material}],
                "lights": [{"type": "environment", "radiance": 1}],
                "integrator": {"spp": 256}
            });
            parse(&json.to_string())
        };
        let runs = |material: &Value| prepare(&scene(material)).unwrap().plan().runs(EffectName::Wavelengths);
        assert!(runs(&coloured) && !runs(&plain), "{coloured}");
        let [x, y, z] = render(&scene(&coloured), &Study::default())
            .xyz()
            .fold([0.0; 3], |sum, xyz| [0, 1, 2].map(|c| sum[c] + xyz[c]));
        // All of these are red beside the light, whose three are alike.
        assert!(x > 1.05 * z && y > 1.05 * z, "{coloured}: {x} {y} {z}");
    }
}

/// Alone in their scene, so that no other surface calls for shadow rays.
#[test]
fn whatever_scatters_is_lit_by_lights_without_a_surface() {
    for material in [
        json!({"type": "lambert", "reflectance": 0.5}),
        json!({"type": "oren-nayar", "reflectance": 0.5, "roughness": 0.6}),
        json!({"type": "plastic", "reflectance": 0.5}),
        json!({"type": "plastic", "reflectance": 0, "alpha": 0.3}),
        json!({"type": "conductor", "metal": "Au", "alpha": 0.3}),
        json!({"type": "dielectric", "interior": 1.5, "alpha": 0.3}),
        json!({"type": "blend", "first": {"type": "black"}, "second": {"type": "oren-nayar", "reflectance": 0.5, "roughness": 0.6}, "weight": 0.5}),
    ] {
        let scene = json!({
            "etalon": 1,
            "camera": {"type": "orthographic", "position_m": [0, 0, 5], "direction": [0, 0, -1], "height_m": 1},
            "film": {"width": 2, "height": 2},
            "objects": [{"shape": {"type": "sphere", "radius_m": 2}, "material": material}],
            "lights": [{"type": "point", "position_m": [0, 1, 5], "intensity": 1}],
            "integrator": {"spp": 16}
        });
        assert!(mean_y(&render(&parse(&scene.to_string()), &Study::default())) > 0.0, "{material}");
    }
}

/// Where a grid says how much of what a medium takes is scattered: without absorption all of it is, without scattering the rest of the mean is
/// absorbed, and without wavelengths colours are grey.
#[test]
fn grids_of_albedos_are_left_out_with_what_they_stand_for() {
    let mut json = room();
    json["medium"] = json!({"extinction_per_m": 0.4, "albedo": 1});
    let bare = parse(&json.to_string());
    let with = |values: [f32; 6]| {
        let mut scene = bare.clone();
        let transform = scene.objects[0].transform.clone();
        let (box_m, cells) = ([[-2.0, 0.0, -2.0], [2.0, 2.0, 2.0]], [1, 2, 1]);
        let grid = AlbedoGrid { cells, channels: 3, values: values.into(), box_m, transform, wrap: Wrap::Clamp };
        scene.medium.as_mut().expect("it has one").albedo = Some(Arc::new(grid));
        scene
    };
    let grey = with([0.25, 0.25, 0.25, 0.75, 0.75, 0.75]);
    same(EffectName::Absorption, &without_glass_absorption(&grey), &without_glass_absorption(&bare));
    // White leaves nothing to be absorbed, and rounding must not make it less than nothing.
    let white = render(&with([1.0; 6]), &without(EffectName::Scattering));
    json["medium"] = json!({"extinction_per_m": 0, "albedo": 1});
    let clear = render(&parse(&json.to_string()), &Study::default());
    assert!((mean_y(&white) / mean_y(&clear) - 1.0).abs() < 1e-9);
    // A single wavelength has no whole nanometre beside it.
    let mut line = json.clone();
    line["film"].as_object_mut().expect("a film").remove("bands_nm");
    line["integrator"]["wavelength_range_nm"] = json!([550.2, 550.3]);
    line["medium"] = json!({"extinction_per_m": 0.4, "albedo": 1});
    let mut narrow = parse(&line.to_string());
    narrow.medium.as_mut().expect("it has one").albedo = grey.medium.as_ref().expect("it has one").albedo.clone();
    let _ = prepare_study(&narrow, &without(EffectName::Scattering)).unwrap();
    // Half of it in the mean.
    let half = render(&grey, &without(EffectName::Scattering));
    json["medium"] = json!({"absorption_per_m": 0.2});
    let absorbing = render(&parse(&json.to_string()), &Study::default());
    assert!((mean_y(&half) / mean_y(&absorbing) - 1.0).abs() < 1e-9);
}

/// The same, with glass that does not absorb.
fn without_glass_absorption(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.materials.iter_mut().for_each(|material| material.medium = None);
    scene
}
