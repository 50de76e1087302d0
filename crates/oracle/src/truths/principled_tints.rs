//! Lobes of a [principled](super::principled) surface that have the colour of the base, but not its luminance: under D65 their luminance is that of
//! white.

use serde_json::{Value, json};

use super::{
    Claim, Truth,
    principled::plate,
    principled_lobes::{DIFFUSE, GLOSSY, Surface, direction, grazing},
    scene::rgba_png,
};
use crate::vector::{add, dot, normalize};

pub(super) fn truths() -> Vec<Truth> {
    let rgb = [0.7, 0.2, 0.1];
    let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    let colour = json!({ "type": "rgb", "rgb": rgb });
    // 8 bits of sRGB that lie nearest, and the luminance that they say.
    let image = json!({ "type": "image", "file": "base.png" });
    let png = || rgba_png(&[[218, 124, 89, 255]]);
    let metal = json!(1.0);
    let highlight = Surface { specular_tint: 1.0, ..GLOSSY };
    let cloth = Surface { sheen: 0.7, base: 0.0, ..DIFFUSE };
    // The base shines diffusely, too: as a grey one of its luminance `y`.
    let of = |name: &'static str, base: &Value, key: (&str, &Value), surface: Surface, y: f64, angles: [f64; 3]| {
        let [o, i, apart] = angles;
        let (to_viewer, to_light) = (direction(o, 20.0), direction(i, 20.0 + apart));
        let mut material = surface.json();
        material["reflectance"] = base.clone();
        material[key.0] = key.1.clone();
        let shown = Surface { base: y, ..surface };
        let light = json!({
            "type": "directional", "direction": to_light.map(|v| -v), "irradiance": { "type": "illuminant", "name": "D65" }
        });
        let mut scene = plate(to_viewer, &material).light(light);
        if base == &image {
            scene = scene.file("base.png", png());
        }
        let value = shown.f_cos(to_viewer, to_light);
        let lobe = Surface { base: 0.0, ..surface }.f_cos(to_viewer, to_light);
        Truth::new(name, &scene, value, "f cos θ_i of a white tint and a grey base of the same luminance")
            .because("A tint is the base's reflectance over its luminance under D65, so that of the tinted lobe does not change.")
            .confirmed("spherical triangles", 1e-9, move || shown.by_angles(o, i, apart))
            .allows(2e-4 * value, "luminances of primaries of four digits; the spectrum that stands for a colour shows it to 1e-4")
            .or_else("no lobe", value - lobe)
            .claims(Claim::PhotometricSensor)
            .sees(2e-3)
    };
    let at = [70.0, 55.0, 160.0];
    let srgb = |v: f64| ((v / 255.0 + 0.055) / 1.055).powf(2.4);
    let of_image = 0.2126 * srgb(218.0) + 0.7152 * srgb(124.0) + 0.0722 * srgb(89.0);
    let [o, i] = [direction(70.0, 20.0), direction(55.0, 180.0)];
    let head_on = ((1.6 - 1.0) / 2.6_f64).powi(2);
    // F₀ by the base itself is smaller by its luminance.
    let facets = GLOSSY.f_cos(o, i) / GLOSSY.fresnel(dot(o, normalize(add(o, i))));
    let v = grazing(dot(o, normalize(add(o, i))));
    let darker = |y: f64| facets * (1.0 - y) * head_on * (1.0 - v);
    let sheen = cloth.f_cos(o, i);
    let tinted = |name, base, y: f64| {
        let truth = of(name, base, ("specular_tint", &metal), highlight, y, at);
        let value = truth.value();
        truth.or_else("the base itself as tint", value - darker(y))
    };
    let sheen_tint = json!(0.8);
    let of_cloth =
        of("principled-coloured-sheen-in-daylight", &colour, ("sheen_tint", &sheen_tint), cloth, luminance, at);
    let value = of_cloth.value();
    vec![
        tinted("principled-coloured-highlight-in-daylight", &colour, luminance),
        tinted("principled-highlight-coloured-by-an-image-in-daylight", &image, of_image),
        of_cloth.or_else("the base itself as tint", value - 0.8 * (1.0 - luminance) * sheen),
    ]
}
