//! Images that say what shines, how rough it is, how much of it is there.

use super::{imported, on_its_side, said, scene};
use etalon_scene::{MaterialKind, NumberTexture, SpectrumTexture, UvMap};

#[test]
fn surfaces_that_shine_by_an_image_arrive() {
    let mitsuba = r#"<scene version="3.0.0"><shape type="rectangle"><emitter type="area">
        <texture type="bitmap" name="radiance"><string name="filename" value="chequers.png"/></texture></emitter></shape></scene>"#;
    let pbrt = "WorldBegin\nAreaLightSource \"diffuse\" \"string filename\" \"chequers.png\" \"float scale\" 3\n\
        Shape \"disk\" \"float radius\" 1\n";
    // v from below, while Mitsuba counts from above.
    for (kind, text, factor, scale) in [("xml", mitsuba, 1.0, [1.0, -1.0]), ("pbrt", pbrt, 3.0, [1.0, 1.0])] {
        let imported = imported(kind, text);
        let scene = scene(&imported);
        let emission = scene.placed_objects().find_map(|object| object.emission.as_ref()).expect("a lamp");
        let image = emission.image.as_ref().unwrap_or_else(|| panic!("{kind}: an image"));
        assert_eq!((image.factor, image.uv_map.matrix), ([factor; 3], UvMap::scaled(scale, [0.0; 2]).matrix), "{kind}");
        // The image; a disk of pbrt, whose coordinates are polar, is a mesh.
        assert_eq!(imported.files.len(), if kind == "pbrt" { 2 } else { 1 });
        assert!(!said(&imported).iter().any(|what| what.contains("does not emit")), "{:?}", said(&imported));
    }
}

/// The program takes the coordinates of the image from those of the surface by the rows of the matrix, and counts v from the top.
#[test]
fn images_of_mitsuba_are_turned_sheared_and_moved() {
    let map = r#"<transform name="to_uv"><matrix value="0.5 -2 0 0.125  3 0.25 0 4  0 0 1 0  0 0 0 1"/></transform>"#;
    let turned =
        r#"<transform name="to_uv"><rotate z="1" angle="30"/><scale x="2" y="3"/><translate x="0.25"/></transform>"#;
    for (text, [[a, b], [c, d]], [u0, v0]) in [(map, [[0.5, -2.0], [3.0, 0.25]], [0.125, 4.0]), {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        (turned, [[2.0 * cos, -2.0 * sin], [3.0 * sin, 3.0 * cos]], [0.25, 0.0])
    }] {
        let bitmap = format!(
            "<texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"chequers.png\"/>{text}</texture>"
        );
        let scene_of = |shape: &str| {
            let imported = imported(
                "xml",
                &format!(
                    "<scene version=\"3.0.0\"><shape type=\"{shape}\"><bsdf type=\"diffuse\">{bitmap}</bsdf></shape></scene>"
                ),
            );
            assert_eq!(said(&imported), Vec::<String>::new());
            scene(&imported)
        };
        for shape in ["rectangle", "sphere"] {
            let scene = scene_of(shape);
            let MaterialKind::Lambert { reflectance: SpectrumTexture::Image(image) } =
                on_its_side(&scene.materials[0].kind)
            else {
                panic!("an image")
            };
            for [u, v] in [[0.0, 0.0], [0.25, 0.75], [1.0, 0.5]] {
                // On a sphere v is counted from the pole there.
                let theirs = if shape == "sphere" { 1.0 - v } else { v };
                let (right, down) = (a * u + b * theirs + u0, c * u + d * theirs + v0);
                let [found_right, found_up] = image.uv_map.at([u, v]);
                let off = (found_right - right).abs() + (found_up - (1.0 - down)).abs();
                assert!(off < 1e-12, "{shape}: {:?} at {u}, {v}", image.uv_map);
            }
        }
    }
}

/// What a roughness by an image becomes: the numbers at which parts of a blend stand, each with the width of its part.
fn widths(kind: &MaterialKind) -> Vec<(f64, f64)> {
    let kind = on_its_side(kind);
    let MaterialKind::Blend { parts, by: NumberTexture::Image(_) } = kind else { panic!("{kind:?}") };
    let width = |kind: &MaterialKind| match kind {
        MaterialKind::RoughConductor { facets, .. }
        | MaterialKind::RoughDielectric { facets, .. }
        | MaterialKind::Plastic { facets: Some(facets), .. } => facets.alpha[0],
        MaterialKind::Conductor { .. } | MaterialKind::Dielectric { .. } => 0.0,
        other => panic!("{other:?}"),
    };
    parts.iter().map(|(number, part)| (*number, width(part))).collect()
}

fn image_of(kind: &MaterialKind) -> &etalon_scene::ImageTexture {
    let MaterialKind::Blend { by: NumberTexture::Image(image), .. } = on_its_side(kind) else { panic!("{kind:?}") };
    image
}

#[test]
fn roughness_by_an_image_says_the_width_that_its_program_means() {
    let mitsuba = |plugin: &str, keys: &str| {
        format!(
            r#"<scene version="3.0.0"><shape type="rectangle"><bsdf type="{plugin}"><string name="distribution" value="ggx"/>
            <texture type="bitmap" name="alpha"><string name="filename" value="chequers.png"/>{keys}</texture></bsdf></shape></scene>"#
        )
    };
    let pbrt = |material: &str, keys: &str| {
        format!(
            "WorldBegin\nTexture \"r\" \"float\" \"imagemap\" \"string filename\" \"chequers.png\" \"float scale\" 0.5\n\
             Material \"{material}\" \"texture roughness\" \"r\"{keys}\n\
             Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 1 0 0 1 ]\n"
        )
    };
    // Mitsuba: α as it stands, or by sRGB; pbrt: α², or α where nothing is remapped.
    let raw = "<boolean name=\"raw\" value=\"true\"/>";
    let same = |v: f64| v;
    let alpha_of: [fn(f64) -> f64; 6] = [same, same, f64::sqrt, same, same, f64::sqrt];
    let cases = [
        ("xml", mitsuba("roughconductor", raw), 1.0),
        ("xml", mitsuba("roughconductor", ""), 1.0),
        ("pbrt", pbrt("coateddiffuse", ""), 0.5),
        ("pbrt", pbrt("coateddiffuse", " \"bool remaproughness\" false"), 0.5),
        ("xml", mitsuba("roughdielectric", raw), 1.0),
        ("pbrt", pbrt("dielectric", ""), 0.5),
    ];
    let mut means = Vec::new();
    for ((kind, text, factor), alpha_of) in cases.into_iter().zip(alpha_of) {
        let imported = imported(kind, &text);
        let scene = scene(&imported);
        let material = &scene.materials[scene.objects[0].material].kind;
        let widths = widths(material);
        assert!(widths.len() >= 2, "{text}");
        for (number, alpha) in widths {
            // A node is 0, or a root taken and squared again.
            assert!((alpha_of(number) - alpha).abs() < 1e-12, "{number} says {alpha} in {text}");
        }
        let image = image_of(material);
        assert_eq!(image.factor, [factor; 3]);
        means.push(image.image.mean()[0]);
        assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    }
    // The curve of sRGB makes grey darker; pbrt decodes PNG files by it.
    assert!(means[1] < means[0], "{means:?}");
    assert_eq!(means[2], means[3]);
    assert_eq!([means[4], means[5]], [means[0], means[2]]);
}

#[test]
fn opacity_and_weights_by_an_image_arrive() {
    let mitsuba = r#"<scene version="3.0.0"><texture type="bitmap" id="t"><string name="filename" value="chequers.png"/></texture>
        <shape type="rectangle"><bsdf type="mask"><ref name="opacity" id="t"/><bsdf type="blendbsdf"><ref name="weight" id="t"/>
            <bsdf type="diffuse"/><bsdf type="conductor"/></bsdf></bsdf></shape></scene>"#;
    let pbrt = "WorldBegin\nTexture \"t\" \"float\" \"imagemap\" \"string filename\" \"chequers.png\"\n\
        MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string type\" \"conductor\"\n\
        Material \"mix\" \"string materials\" [ \"a\" \"b\" ] \"texture amount\" \"t\"\n\
        Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 1 0 0 1 ] \"texture alpha\" \"t\"\n";
    for (kind, text) in [("xml", mitsuba), ("pbrt", pbrt)] {
        let imported = imported(kind, text);
        let scene = scene(&imported);
        let object = &scene.objects[0];
        assert!(object.opacity_image.is_some(), "{kind}");
        assert_eq!(image_of(&scene.materials[object.material].kind).image.width, 2, "{kind}");
        assert!(said(&imported).is_empty(), "{kind}: {:?}", said(&imported));
    }
}
