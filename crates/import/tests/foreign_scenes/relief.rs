//! Normal and bump maps of Mitsuba and pbrt: what they say arrives in the scene, what cannot be honoured is listed with its line.

use super::{imported, said, scene};
use etalon_import::{Imported, import_bytes};
use etalon_scene::{Bitangent, Object, Relief, Terminator, TextureFilter, UvMap, Wrap};

/// The only object.
fn object(imported: &Imported) -> Object {
    scene(imported).objects.into_iter().next().expect("an object")
}

/// What a file says of its only object, all of which is honoured.
fn relief(kind: &str, text: &str) -> Relief {
    let imported = imported(kind, text);
    assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    object(&imported).relief.unwrap_or_else(|| panic!("a map\n{}", imported.text))
}

const BITMAP: &str = "<string name=\"filename\" value=\"chequers.png\"/>";

/// A rectangle of Mitsuba with more keys, under a map of some kind with its keys and its texture, which begins on line 3.
fn mitsuba(shape: &str, kind: &str, texture: &str) -> String {
    format!(
        "<scene version=\"3.0.0\"><shape type=\"rectangle\">{shape}\n\n<bsdf type=\"{kind}\">\n\
         <boolean name=\"use_shadowing_function\" value=\"false\"/>{texture}\n<bsdf type=\"diffuse\"/></bsdf></shape></scene>"
    )
}

#[test]
fn heights_of_mitsuba_count_by_their_luminance() {
    let bitmap = |keys: &str| format!("<texture type=\"bitmap\">{BITMAP}{keys}</texture>");
    let scale = "<float name=\"scale\" value=\"0.25\"/>";
    let flipped = "<boolean name=\"flip_normals\" value=\"true\"/>";
    let raw = r#"<boolean name="raw" value="true"/><string name="wrap_mode" value="clamp"/><transform name="to_uv"><scale x="4" y="3"/>
        <translate x="0.25" y="0.1"/></transform>"#;
    let srgb = |byte: f64| ((byte / 255.0 + 0.055) / 1.055).powf(2.4);
    let luminance = |of: &dyn Fn(f64) -> f64| (0.2126 + 0.7152) * of(40.0) + 0.0722 * of(60.0);
    let cases = [
        (mitsuba("", "bumpmap", &bitmap("")), 1.0, luminance(&srgb)),
        (mitsuba("", "bumpmap", &format!("{scale}{}", bitmap(raw))), 0.25, luminance(&|byte| byte / 255.0)),
        // Its outer side is the other one, toward which heights are measured.
        (mitsuba(flipped, "bumpmap", &format!("{scale}{}", bitmap(raw))), -0.25, luminance(&|byte| byte / 255.0)),
    ];
    for (text, height, dark) in cases {
        let Relief::Heights { texture, height_m, .. } = relief("xml", &text) else { panic!("heights") };
        assert_eq!(height_m, height);
        // (40, 40, 60), in the upper right and the lower left: alike, whichever way v is counted.
        assert!((texture.image.texel(1, 0)[0] - dark).abs() < 1e-6, "{:?} is not {dark}", texture.image.texel(1, 0));
        if text.contains("clamp") {
            let lies = UvMap::scaled([4.0, -3.0], [0.25, 0.9]);
            assert_eq!((texture.wrap, texture.uv_map), ([Wrap::Clamp; 2], lies));
        }
    }
}

#[test]
fn normals_of_mitsuba_stand_in_its_frame() {
    let map = |shape: &str, keys: &str| {
        let texture = format!("<texture name=\"normalmap\" type=\"bitmap\">{BITMAP}{keys}</texture>");
        let Relief::Normals { texture, strength, bitangent, .. } =
            relief("xml", &mitsuba(shape, "normalmap", &texture))
        else {
            panic!("normals")
        };
        assert_eq!((bitangent, texture.uv_map), (Bitangent::AcrossU, UvMap::scaled([1.0, -1.0], [0.0, 1.0])));
        (texture, strength)
    };
    let raw = "<boolean name=\"raw\" value=\"true\"/>";
    let (linear, strength) = map("", raw);
    assert_eq!((strength, linear.filter), ([1.0; 2], TextureFilter::Bilinear));
    assert!((linear.image.linear_texels().nth(1).expect("a texel")[2] - 60.0 / 255.0).abs() < 1e-6);
    // As in the program, an image that is not said to be raw is decoded.
    let (decoded, strength) =
        map("<boolean name=\"flip_normals\" value=\"true\"/>", "<string name=\"filter_type\" value=\"nearest\"/>");
    assert_eq!((strength, decoded.filter), ([-1.0, 1.0], TextureFilter::Nearest));
    assert!(decoded.image.linear_texels().nth(1).expect("a texel")[2] < 0.1);
}

const MESH: &str = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 1 0 0 1 ] \"integer indices\" [ 0 1 2 ]\n";

#[test]
fn maps_of_pbrt_arrive_in_its_axes() {
    let heights = "Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"chequers.png\" \"float scale\" 0.5 \"float uscale\" 4\n\
        Texture \"d\" \"float\" \"scale\" \"texture tex\" \"h\" \"float scale\" -3\n";
    for (reversed, height) in [("", -1.5), ("ReverseOrientation\n", 1.5)] {
        let text = format!(
            "Camera \"perspective\"\nWorldBegin\n{heights}MakeNamedMaterial \"m\" \"string type\" \"conductor\" \
             \"texture displacement\" \"d\"\n{reversed}NamedMaterial \"m\"\n{MESH}"
        );
        let Relief::Heights { texture, height_m, .. } = relief("pbrt", &text) else { panic!("heights") };
        assert_eq!((height_m, texture.uv_map), (height, UvMap::scaled([4.0, 1.0], [0.0; 2])));
        // The mean of (40, 40, 60), by the curve of sRGB.
        let srgb = |byte: f64| ((byte / 255.0 + 0.055) / 1.055).powf(2.4);
        let mean = (2.0 * srgb(40.0) + srgb(60.0)) / 3.0;
        assert!((texture.image.texel(1, 0)[0] - mean).abs() < 1e-6, "{:?}", texture.image.texel(1, 0));
    }
    // A product with left-handed axes changes its sign in ours, and the tangent that of its side.
    for (mirror, reversed, strength) in [
        ("", "", [1.0, -1.0]),
        ("Scale -1 1 1\n", "", [1.0, 1.0]),
        ("", "ReverseOrientation\n", [-1.0, -1.0]),
        ("Scale -1 1 1\n", "ReverseOrientation\n", [-1.0, 1.0]),
    ] {
        let text = format!(
            "{mirror}Camera \"perspective\"\nWorldBegin\nMaterial \"diffuse\" \"string normalmap\" \"chequers.png\"\n{reversed}{MESH}"
        );
        let Relief::Normals { texture, strength: stated, bitangent, .. } = relief("pbrt", &text) else {
            panic!("normals")
        };
        assert_eq!(
            (stated, bitangent, texture.uv_map),
            (strength, Bitangent::AcrossU, UvMap::IDENTITY),
            "{mirror}{reversed}"
        );
        assert!((texture.image.linear_texels().nth(1).expect("a texel")[2] - 60.0 / 255.0).abs() < 1e-6);
    }
    // What is equally high everywhere bends nothing.
    for constant in ["\"texture displacement\" \"c\"", "\"float displacement\" 2"] {
        let text = format!(
            "WorldBegin\nTexture \"c\" \"float\" \"constant\" \"float value\" 0.5\nMaterial \"diffuse\" {constant}\n{MESH}"
        );
        let imported = imported("pbrt", &text);
        assert_eq!((object(&imported).relief, said(&imported)), (None, Vec::new()));
    }
}

/// Both lose light, and grazing light is dimmed unless it says otherwise.
#[test]
fn maps_of_mitsuba_lose_light_and_those_of_pbrt_mirror_it() {
    let bitmap = |name: &str| format!("<texture {name} type=\"bitmap\">{BITMAP}</texture>");
    for (kind, name) in [("bumpmap", ""), ("normalmap", "name=\"normalmap\"")] {
        let text = mitsuba("", kind, &bitmap(name));
        assert_eq!(relief("xml", &text).terminator(), Terminator::Lost);
        let shadowed = text.replace("<boolean name=\"use_shadowing_function\" value=\"false\"/>", "");
        assert_eq!(relief("xml", &shadowed).terminator(), Terminator::Shadowed);
        assert_eq!(relief("xml", &text.replace("\"false\"", "\"true\"")).terminator(), Terminator::Shadowed);
    }
    let text = format!("WorldBegin\nMaterial \"diffuse\" \"string normalmap\" \"chequers.png\"\n{MESH}");
    assert_eq!(relief("pbrt", &text).terminator(), Terminator::Mirrored);
}

#[test]
fn a_map_that_cannot_be_honoured_is_listed_with_its_line() {
    let bitmap = format!("<texture type=\"bitmap\">{BITMAP}</texture>");
    let bumpy = |keys: &str| mitsuba("", "bumpmap", keys);
    let nearest = "<texture type=\"bitmap\"><string name=\"filename\" value=\"chequers.png\"/>\
        <string name=\"filter_type\" value=\"nearest\"/></texture>";
    let within = |before: &str, after: &str| {
        let inner = format!(
            "<bsdf type=\"diffuse\"/>{bitmap}<boolean name=\"use_shadowing_function\" value=\"false\"/></bsdf>"
        );
        format!(
            "<scene version=\"3.0.0\"><shape type=\"rectangle\">\n\n{before}<bsdf type=\"bumpmap\">{inner}{after}</shape></scene>"
        )
    };
    let pbrt = |before: &str, material: &str| format!("WorldBegin\n{before}\n{material}\n{MESH}");
    let mix = "MakeNamedMaterial \"m\" \"string normalmap\" \"chequers.png\"";
    let named = "\"string normalmap\" \"chequers.png\" ";
    let heights = "Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"chequers.png\"";
    // Text, what is said, and whether a map is left.
    let cases = [
        (
            "xml",
            bumpy(&format!("{bitmap}<boolean name=\"flip_invalid_normals\" value=\"false\"/>")),
            "line 4: <boolean name=\"flip_invalid_normals\" value=\"false\"> is ignored",
            true,
        ),
        (
            "xml",
            bumpy("<texture type=\"checkerboard\"/>"),
            "line 3: the \"bumpmap\" is left out: it has no bitmap",
            false,
        ),
        ("xml", bumpy(""), "line 3: the \"bumpmap\" is left out: it has no bitmap", false),
        (
            "xml",
            bumpy(nearest),
            "line 4: heights without interpolation have no slopes: the bump map has no effect",
            false,
        ),
        (
            "xml",
            bumpy(&bitmap.replace("chequers", "no")),
            "line 4: the image is left out: \"no.png\" cannot be read: there is no no.png",
            false,
        ),
        (
            "xml",
            within("<bsdf type=\"blendbsdf\"><bsdf type=\"diffuse\"/>", "</bsdf>"),
            "line 3: a normal or bump map of a part of a blend is left out",
            false,
        ),
        (
            "xml",
            within(
                "<bsdf type=\"bumpmap\"><boolean name=\"use_shadowing_function\" value=\"false\"/>",
                &format!("{bitmap}</bsdf>"),
            ),
            "line 3: the \"bumpmap\" around another map is left out",
            true,
        ),
        (
            "pbrt",
            pbrt(heights, &format!("Material \"diffuse\" {named}\"texture displacement\" \"h\"")),
            "line 3: \"texture displacement\" is ignored",
            true,
        ),
        (
            "pbrt",
            pbrt("", "Material \"diffuse\" \"string normalmap\" \"no.png\""),
            "line 3: the normal map is left out: \"no.png\" cannot be read: there is no no.png",
            false,
        ),
        (
            "pbrt",
            pbrt(mix, "Material \"mix\" \"string materials\" [ \"m\" \"m\" ]"),
            "line 3: the normal or bump map of a part of it, \"m\", is left out",
            false,
        ),
        (
            "pbrt",
            pbrt(heights, "Material \"interface\" \"texture displacement\" \"h\""),
            "line 3: \"texture displacement\" is ignored",
            false,
        ),
        (
            "pbrt",
            pbrt("Texture \"w\" \"float\" \"wrinkled\"", "Material \"diffuse\" \"texture displacement\" \"w\""),
            "line 2: the texture \"wrinkled\" is not known: it becomes 0.5",
            false,
        ),
        (
            "pbrt",
            pbrt(
                &heights.replace("\"chequers.png\"", "\"chequers.png\" \"float scale\" -1"),
                "Material \"conductor\" \"texture roughness\" \"h\"",
            ),
            "line 3: a negative \"roughness\" becomes 0",
            false,
        ),
    ];
    for (kind, text, line, left) in cases {
        let imported = imported(kind, &text);
        assert_eq!(said(&imported), [line], "{text}");
        assert_eq!(object(&imported).relief.is_some(), left, "{text}");
    }
    let text = pbrt("", "Material \"diffuse\" \"texture displacement\" \"h\"");
    let why = import_bytes("pbrt", text.as_bytes(), &|_| Err(String::new()), "", "a").unwrap_err();
    assert_eq!(why, "line 3: there is no texture \"h\"");
}
