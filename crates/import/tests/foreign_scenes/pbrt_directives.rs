//! Directives and parameters of pbrt that are easily lost.

use std::f64::consts::PI;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use etalon_import::{Imported, import_bytes};
use etalon_scene::{Encoding, Image, MaterialKind, Metal, NumberTexture, Shape, SpectrumTexture};
use serde_json::Value;

use super::{BSDF, PNG, imported, near, said, scene};

fn of(text: &str) -> Imported {
    imported("pbrt", &format!("WorldBegin\n{text}\n"))
}

fn json(imported: &Imported) -> Value {
    serde_json::from_str(&imported.text).unwrap()
}

fn kind(text: &str) -> (MaterialKind, Vec<String>) {
    let imported = of(&format!("{text}\nShape \"sphere\""));
    let scene = scene(&imported);
    (scene.materials[scene.objects[0].material].kind.clone(), said(&imported))
}

#[test]
fn coated_metal_has_the_roughness_of_the_metal() {
    let (coated, said) = kind(
        "Material \"coatedconductor\" \"float interface.roughness\" 0.01 \"float conductor.roughness\" 0.25 \
         \"spectrum conductor.eta\" \"metal-Au-eta\" \"spectrum conductor.k\" \"metal-Au-k\" \"float thickness\" 0.02",
    );
    let widths: Vec<f64> = coated.microfacets().map(|facets| facets.alpha[0]).collect();
    assert_eq!(widths, [0.5]);
    assert!(said.len() == 1 && said[0].contains("the coat is left out"), "{said:?}");
    // Without a roughness of its own the metal is smooth.
    let (smooth, _) =
        kind("Material \"coatedconductor\" \"float interface.roughness\" 0.25 \"rgb reflectance\" [ 0.5 0.5 0.5 ]");
    assert!(matches!(smooth, MaterialKind::Conductor { .. }), "{smooth:?}");
}

#[test]
fn a_compressed_mesh_is_inflated() {
    // `BARE`, as `gzip.compress` of Python writes it.
    let text = "H4sIAAAAAAACA12N4QrDIAyE/+cp7gmGrg9UgkYasCrqRt3Tz/VHB+Ugd3wJuRIHhVx37uDmVGEfhiTKLqnjLbXLgYVKzWXmgRDz\
        vDzuYNzB5/oR2Ansfx+1dbzcxhV6VayavDppJMmvm7CXSgZTZM9pMJ0W/PxJX7F0ePm0AAAA";
    let file = STANDARD.decode(text).unwrap();
    let with = |bytes: Vec<u8>| {
        let near = move |name: &str| if name == "a.ply.gz" { Ok(bytes.clone()) } else { near(name) };
        import_bytes("pbrt", b"WorldBegin\nShape \"plymesh\" \"string filename\" \"a.ply.gz\"\n", &near, "", "a")
    };
    assert_eq!(scene(&with(file.clone()).unwrap()).objects.len(), 1);
    let why = with(file[..40].to_vec()).unwrap_err();
    assert!(why.contains("line 2: \"a.ply.gz\": it cannot be inflated"), "{why}");
}

#[test]
fn what_a_film_does_to_a_picture_is_listed() {
    let text = "Film \"rgb\" \"string sensor\" \"canon_eos_5d\" \"float iso\" 400 \"float maxcomponentvalue\" 10\n\
        Camera \"perspective\" \"float shutterclose\" 0.5\nWorldBegin\nShape \"sphere\"\n";
    let said = said(&imported("pbrt", text));
    for part in [
        "line 1: the sensor \"canon_eos_5d\" is left out",
        "line 1: its exposure is ignored: a factor of 4",
        "line 1: \"maxcomponentvalue\" is ignored: bright samples are not clamped",
        "line 2: its exposure is ignored: a factor of 0.5",
    ] {
        assert!(said.iter().any(|line| line.starts_with(part)), "{part}: {said:#?}");
    }
    assert_eq!(said.len(), 4, "{said:#?}");
    let plain = "Film \"rgb\" \"string sensor\" \"cie1931\" \"float iso\" 100\nCamera \"perspective\"\nWorldBegin\nShape \"sphere\"\n";
    assert!(super::said(&imported("pbrt", plain)).is_empty());
}

#[test]
fn a_measured_material_arrives_with_its_file_on_both_sides() {
    let imported = of("Material \"measured\" \"string filename\" \"paint.bsdf\"\nShape \"sphere\"");
    assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    assert!(imported.files.iter().any(|file| file.bytes == BSDF));
    let scene = scene(&imported);
    assert!(matches!(scene.materials[scene.objects[0].material].kind, MaterialKind::Measured { .. }));
    let grain = of(
        "Material \"measured\" \"string filename\" \"grain.bsdf\"\nShape \"plymesh\" \"string filename\" \"bare.ply\"",
    );
    assert!(said(&grain).iter().any(|line| line.contains("the grain of its measured material")), "{:?}", said(&grain));
}

/// What the light has at scale 1 is a luminance of 1.
#[test]
fn lights_have_the_power_or_the_illuminance_that_is_stated() {
    let scale = |text: &str, key: &str| {
        let imported = of(&format!("LightSource {text}\nShape \"sphere\""));
        assert!(said(&imported).is_empty(), "{:?}", said(&imported));
        json(&imported)["lights"][0][key]["scale"].as_f64().unwrap()
    };
    let near = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found}, {expected}");
    near(scale("\"point\" \"float power\" 100 \"float scale\" 2", "intensity"), 200.0 / (4.0 * PI));
    near(scale("\"point\" \"rgb I\" [ 1 0.5 0 ] \"float power\" 100", "intensity"), 100.0 / (4.0 * PI));
    let [outer, inner] = [40.0_f64, 30.0].map(|deg| deg.to_radians().cos());
    let solid_angle = 2.0 * PI * (1.0 - inner + 0.5 * (inner - outer));
    let spot = "\"spot\" \"float coneangle\" 40 \"float conedeltaangle\" 10 \"float power\" 3";
    near(scale(spot, "intensity"), 3.0 / solid_angle);
    near(scale("\"distant\" \"float illuminance\" 500", "irradiance"), 500.0);
    near(scale("\"infinite\" \"float illuminance\" 500", "radiance"), 500.0 / PI);
}

#[test]
fn area_lights_have_their_power_by_their_area() {
    let radiance = |area: &str, shape: &str| {
        let imported = of(&format!("AreaLightSource \"diffuse\" {area}\nScale 2 2 2\nShape {shape}"));
        let losses = said(&imported).into_iter().filter(|line| line.contains("power")).count();
        (json(&imported)["objects"][0]["emission"]["radiance"]["scale"].as_f64().unwrap(), losses)
    };
    let near = |(found, losses): (f64, usize), expected: f64, expected_losses: usize| {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found}, {expected}");
        assert_eq!(losses, expected_losses);
    };
    // pbrt takes the area of a ball before its transform, that of meshes after it.
    near(radiance("\"float power\" 100", "\"sphere\" \"float radius\" 3"), 100.0 / (36.0 * PI * PI), 0);
    let both = "\"float power\" 100 \"bool twosided\" true \"float scale\" 3";
    near(radiance(both, "\"disk\" \"float radius\" 3"), 300.0 / (2.0 * 9.0 * PI * PI), 0);
    // Two triangles of an area of 2 each have the power each.
    let square = "\"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  1 1 0  0 1 0 ] \"integer indices\" [ 0 1 2  0 2 3 ]";
    near(radiance("\"float power\" 100", square), 100.0 / (2.0 * PI), 0);
    let patch = "\"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0 ]";
    near(radiance("\"float power\" 100", patch), 100.0 / (4.0 * PI), 0);
    // Of unlike ones the sum is kept: areas of 2 and 4.
    let unlike = "\"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  1 1 0  0 2 0 ] \"integer indices\" [ 0 1 2  0 2 3 ]";
    near(radiance("\"float power\" 100", unlike), 200.0 / (6.0 * PI), 1);
}

#[test]
fn each_face_of_a_mesh_file_is_a_lamp_of_its_power() {
    let head = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
    let points = "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n-1 0 0\n";
    let radiances = |faces: &str| {
        let ply = format!("{head}element face {}\n{points}{faces}", faces.lines().count());
        let near = |name: &str| if name == "a.ply" { Ok(ply.clone().into_bytes()) } else { near(name) };
        // The second time the file is known, and stretched to twice its area.
        let shape = "Shape \"plymesh\" \"string filename\" \"a.ply\"\n";
        let text = format!("WorldBegin\nAreaLightSource \"diffuse\" \"float power\" 100\n{shape}Scale 2 1 1\n{shape}");
        let imported = import_bytes("pbrt", text.as_bytes(), &near, "", "a").unwrap();
        let losses = said(&imported).into_iter().filter(|line| line.contains("power")).count();
        let objects = &json(&imported)["objects"];
        ([0, 1].map(|i: usize| objects[i]["emission"]["radiance"]["scale"].as_f64().unwrap()), losses)
    };
    let check = |faces: &str, lamps: f64, area: f64, expected_losses: usize| {
        let (found, losses) = radiances(faces);
        for (found, area) in [(found[0], area), (found[1], 2.0 * area)] {
            let expected = lamps * 100.0 / (PI * area);
            assert!((found / expected - 1.0).abs() < 1e-12, "{faces}: {found}, {expected}");
        }
        assert_eq!(losses, expected_losses, "{faces}");
    };
    check("3 0 1 2\n3 0 2 3\n", 2.0, 1.0, 0);
    check("4 0 1 2 3\n", 1.0, 1.0, 0);
    check("4 0 1 2 3\n3 0 3 4\n", 2.0, 1.5, 2);
}

#[test]
fn the_end_of_a_motion_does_not_move_its_start() {
    let imported =
        of("Translate 1 0 0\nActiveTransform EndTime\nTranslate 0 5 0\nRotate 90 0 0 1\nActiveTransform All\n\
        Translate 0 0 2\nShape \"sphere\"");
    assert_eq!(scene(&imported).objects[0].transform.translation_m, [1.0, 0.0, 2.0]);
    assert_eq!(said(&imported), ["line 3: motion is not read: things stay where they are when the shutter opens"]);
}

#[test]
fn patches_without_texture_coordinates_have_those_of_the_unit_square() {
    let imported = of("Texture \"tiles\" \"spectrum\" \"imagemap\" \"string filename\" \"chequers.png\"\n\
        Material \"diffuse\" \"texture reflectance\" \"tiles\"\n\
        Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0  2 0 0  2 1 0 ] \"integer indices\" [ 0 1 2 3  1 4 3 5 ]");
    let scene = scene(&imported);
    let Shape::Mesh(mesh) = &scene.objects[0].shape else { panic!("a mesh") };
    let of_vertex = |x: [f64; 3]| -> Vec<[f32; 2]> {
        mesh.vertices.iter().zip(&mesh.uvs).filter(|(vertex, _)| **vertex == x).map(|(_, uv)| *uv).collect()
    };
    assert_eq!((of_vertex([1.0, 1.0, 0.0]), of_vertex([0.0; 3])), (vec![[1.0, 1.0], [0.0, 1.0]], vec![[0.0; 2]]));
    let reflectance = &scene.materials[scene.objects[0].material].kind;
    assert!(matches!(reflectance, MaterialKind::Lambert { reflectance: SpectrumTexture::Image(_) }));
    assert_eq!(said(&imported).len(), 1, "{:?}", said(&imported));
}

#[test]
fn textures_are_mixed_and_chequerboards_are_numbers() {
    let board =
        "Texture \"board\" \"float\" \"checkerboard\" \"float uscale\" 4 \"float tex1\" 0.25 \"float tex2\" 0.75\n";
    let reflectance = |keys: &str| {
        let text = format!(
            "{board}Texture \"made\" \"spectrum\" \"mix\" {keys}\nMaterial \"diffuse\" \"texture reflectance\" \"made\""
        );
        let (MaterialKind::Lambert { reflectance }, said) = kind(&text) else { panic!("diffuse") };
        assert!(said.is_empty(), "{said:?}");
        reflectance
    };
    let SpectrumTexture::Uniform(mean) = reflectance("\"float tex1\" 0.5 \"float tex2\" 1 \"float amount\" 0.25")
    else {
        panic!("a number")
    };
    assert_eq!(mean.eval(550.0), 0.625);
    assert!(!matches!(reflectance("\"float tex1\" 0.5 \"texture amount\" \"board\""), SpectrumTexture::Uniform(_)));
    let parts =
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string type\" \"conductor\"\n";
    let (blend, said) = kind(&format!(
        "{board}{parts}Material \"mix\" \"string materials\" [ \"a\" \"b\" ] \"texture amount\" \"board\""
    ));
    let MaterialKind::Blend { by: NumberTexture::Image(weight), .. } = &blend else { panic!("{blend:?}") };
    assert!((weight.uv_map.at([1.0, 0.0])[0] - 2.0).abs() < 1e-12, "{:?}", weight.uv_map);
    assert!(said.is_empty(), "{said:?}");
}

#[test]
fn an_image_of_which_the_mean_is_taken_is_named() {
    let textures = "Texture \"stone\" \"spectrum\" \"imagemap\" \"string filename\" \"chequers.png\" \"float scale\" 0.5\n\
         Texture \"dark\" \"spectrum\" \"scale\" \"float scale\" 0.25 \"texture tex\" \"stone\"\n\
         Texture \"board\" \"spectrum\" \"checkerboard\" \"float tex1\" 0.25 \"float tex2\" 0.75\n\
         Texture \"dim\" \"spectrum\" \"scale\" \"float scale\" 0.5 \"texture tex\" \"board\"\n\
         Texture \"mixed\" \"spectrum\" \"mix\" \"texture tex1\" \"dark\" \"texture tex2\" \"board\"\n";
    let (image, _) = Image::decode(PNG, Encoding::Auto).unwrap();
    let mean = image.mean()[0];
    for (name, what, expected) in [
        ("stone", "image", 0.5 * mean),
        ("dark", "image", 0.125 * mean),
        ("mixed", "image", 0.125 * mean),
        ("dim", "chequerboard", 0.25),
    ] {
        let (kind, said) = kind(&format!(
            "{textures}Texture \"whole\" \"spectrum\" \"scale\" \"float tex\" 0.8 \"texture scale\" \"{name}\"\n\
             Material \"diffuse\" \"texture reflectance\" \"whole\""
        ));
        let named = format!("the mean of the {what} \"{name}\" is used");
        assert!(said.iter().any(|line| line.contains(&named)), "{said:?}");
        let MaterialKind::Lambert { reflectance: SpectrumTexture::Uniform(reflectance) } = kind else {
            panic!("{name}: {kind:?}")
        };
        let found = reflectance.eval(550.0);
        // The spectrum of a colour is fitted to 2·10⁻⁵; a mean lost or taken twice is off by a quarter and more.
        assert!((found - 0.8 * expected).abs() < 1e-4, "{name}: {found}, {expected}");
    }
}

#[test]
fn a_texture_that_is_stated_anew_is_another_number() {
    let board = |number: f64| {
        format!("Texture \"a\" \"float\" \"checkerboard\" \"float tex1\" {number} \"float tex2\" {number}\n")
    };
    let shape = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"texture alpha\" \"a\"\n";
    let imported = of(&format!("{}{shape}{}{shape}", board(0.25), board(0.75)));
    let scene = scene(&imported);
    assert_eq!([0, 1].map(|i: usize| scene.objects[i].opacity), [0.25, 0.75]);
}

#[test]
fn a_metal_of_two_kinds_is_listed() {
    let metal = |keys: &str| {
        let (kind, said) = kind(&format!("Material \"conductor\" {keys}"));
        let MaterialKind::Conductor { metal: Metal::Index(index), .. } = kind else { panic!("{kind:?}") };
        (index.eval(550.0), said)
    };
    let [gold, copper] = ["Au", "Cu"].map(|name| {
        let (index, said) = metal(&format!("\"spectrum eta\" \"metal-{name}-eta\" \"spectrum k\" \"metal-{name}-k\""));
        assert!(said.is_empty(), "{said:?}");
        index
    });
    assert_eq!(metal(""), (copper, Vec::new()));
    assert_eq!(metal("\"float eta\" 0.5 \"float k\" 3"), ((0.5, 3.0), Vec::new()));
    let listed =
        |name: &str| vec![format!("line 2: eta and k are of two kinds: the metal \"metal-{name}\" is used for both")];
    for (keys, name, index) in [
        ("\"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Cu-k\"", "Au", gold),
        ("\"spectrum eta\" \"metal-Au-eta\"", "Au", gold),
        ("\"float eta\" 0.5 \"spectrum k\" \"metal-Au-k\"", "Au", gold),
        ("\"rgb eta\" [ 0.2 0.9 1.1 ]", "Cu", copper),
        ("\"float k\" 3", "Cu", copper),
    ] {
        assert_eq!(metal(keys), (index, listed(name)), "{keys}");
    }
}

#[test]
fn attributes_are_parameters_of_what_follows() {
    let imported =
        of("AttributeBegin\nAttribute \"shape\" \"float radius\" 2\nAttribute \"material\" \"float roughness\" 0.25\n\
        Material \"conductor\"\nShape \"sphere\"\nShape \"sphere\" \"float radius\" 3\nAttributeEnd\nShape \"sphere\"");
    assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    let scene = scene(&imported);
    let radius = |i: usize| match &scene.objects[i].shape {
        Shape::Sphere { radius_m, .. } => *radius_m,
        other => panic!("{other:?}"),
    };
    assert_eq!([0, 1, 2].map(radius), [2.0, 3.0, 1.0]);
    assert!(matches!(scene.materials[scene.objects[0].material].kind, MaterialKind::RoughConductor { .. }));
}

#[test]
fn attributes_that_nothing_reads_are_listed() {
    let imported = of("Attribute \"shape\" \"float radius\" 2 \"float radios\" 3\nShape \"sphere\"\nShape \"disk\"");
    assert_eq!(said(&imported), ["line 2: \"float radios\" is ignored: no directive that follows reads it"]);
    let many: String = (0..65).map(|i| format!(" \"float x{i}\" 1")).collect();
    let said = said(&of(&format!("Attribute \"light\"{many}\nShape \"sphere\"")));
    assert_eq!(said.len(), 65, "{said:?}");
    assert!(said[0].contains("\"float x64\" is ignored: attributes state more than 64"), "{said:?}");
}

#[test]
fn what_attributes_hold_is_limited() {
    let texture = "Texture \"a\" \"float\" \"constant\"\n".repeat(300);
    let text = format!("WorldBegin\nAttribute \"texture\" \"string b\" \"{}\"\n{texture}", "b".repeat(1 << 20));
    let why = import_bytes("pbrt", text.as_bytes(), &near, "", "a").unwrap_err();
    assert!(why.contains("values by Attribute"), "{why}");
}

#[test]
fn what_stands_for_spaces_metals_and_parts_of_shapes_is_listed() {
    let imported = of(
        "ColorSpace \"srgb\"\nColorSpace \"rec2020\"\nMaterial \"conductor\" \"spectrum eta\" \"metal-CuZn-eta\" \"spectrum k\" \"metal-CuZn-k\"\n\
        Shape \"sphere\" \"float zmax\" 0.5 \"float phimax\" 90\nShape \"disk\" \"float innerradius\" 0.5\nShape \"sphere\" \"float zmin\" -1",
    );
    assert_eq!(
        said(&imported),
        [
            "line 3: the colours that follow are of the space \"rec2020\": they are read as those of sRGB",
            "line 4: the metal \"metal-CuZn\" (brass) is not known: it becomes copper",
            "line 5: phimax and zmax are ignored: the whole sphere is used",
            "line 6: innerradius is ignored: the whole disk is used",
        ]
    );
}

#[test]
fn glasses_of_pbrt_have_their_dispersion() {
    let (glass, said) = kind("Material \"dielectric\" \"spectrum eta\" \"glass-SF10\"");
    let MaterialKind::Dielectric { interior, .. } = &glass else { panic!("{glass:?}") };
    assert!((interior.eval(587.5618) - 1.72825).abs() < 1e-5 && (interior.eval(486.1) - 1.74648).abs() < 1e-4);
    assert!(said.is_empty(), "{said:?}");
    let (metal, said) = kind("Material \"conductor\" \"rgb eta\" [ 0.2 0.9 1.1 ] \"rgb k\" [ 3.9 2.4 2.2 ]");
    assert!(matches!(metal, MaterialKind::Conductor { .. }) && said.len() == 1, "{said:?}");
}

#[test]
fn a_grid_emits_if_its_light_is_the_same_everywhere() {
    let medium = |keys: &str| {
        let imported = of(&format!(
            "MakeNamedMedium \"fire\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ 1 2 ] {keys}\n\
             MediumInterface \"fire\" \"\"\nMaterial \"interface\"\nShape \"sphere\""
        ));
        let scene = json(&imported);
        let found = scene["objects"][0]["material"]["medium"]["source_radiance"]["scale"].as_f64();
        (found, said(&imported).into_iter().filter(|line| line.contains("Le")).count())
    };
    assert_eq!(medium("\"rgb Le\" [ 1 0.5 0 ] \"float Lescale\" [ 3 3 ]"), (Some(3.0), 1));
    assert_eq!(medium("\"rgb Le\" [ 1 0.5 0 ]"), (Some(1.0), 1));
    assert_eq!(medium("\"rgb Le\" [ 1 0.5 0 ] \"float Lescale\" [ 1 3 ]"), (None, 1));
    assert_eq!(medium(""), (None, 0));
}
