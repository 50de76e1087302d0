//! What is left out of a scene that calls for it: the picture is that of a scene which says nothing of it, bit for bit. Solids within
//! others, polarisation and motion have tests of their own that leave them out.

use etalon_optics::colour::colour_matching;
use etalon_optics::{RefractiveIndex, Spectrum};
use etalon_scene::{Image, ImageTexture, Scene, SpectrumTexture, Texels, TextureFilter};
use etalon_transport::{EffectName, Study};
use serde_json::{Value, json};

#[path = "common/rendering.rs"]
mod rendering;
use rendering::{mean_y, parse, render};

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
            *stone.kind.reflectance_mut().unwrap() = SpectrumTexture::Image(image());
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
