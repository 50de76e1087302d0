//! What is taken over, approximated and left out.

use etalon_import::{Loss, import_bytes};
use etalon_scene::{FacetDistribution, FacetMasking, MaterialKind, Metal, Microfacets};

use super::{imported, near, on_its_side, refusal, said, scene};

#[test]
fn what_stands_for_something_is_told_from_what_is_left_out() {
    let text = r#"<scene version="3.0.0">
<shape type="sphere"><bsdf type="velvet"/></shape>
<shape type="hair"><string name="filename" value="a"/></shape>
<shape type="sphere"><bsdf type="diffuse" id="one"/></shape>
<emitter type="constant"/></scene>"#;
    let imported = imported("xml", text);
    let of = |loss| imported.left_out.iter().filter(|l| l.loss == loss).map(|l| l.place.as_str()).collect::<Vec<_>>();
    assert_eq!((of(Loss::Approximated), of(Loss::LeftOut)), (vec!["line 2"], vec!["line 3"]));
    assert_eq!(imported.taken_over.words(), ["2 objects", "1 material", "1 light"]);
    // A reader of the scene sees the same.
    assert!(imported.text.contains("approximated: line 2") && imported.text.contains("left out: line 3"));
}

#[test]
fn a_scene_without_surfaces_names_what_was_left_out() {
    let hairs: String = (0..8).map(|_| "\n<shape type=\"hair\"/>").collect();
    let why = refusal("xml", &format!("<scene version=\"3.0.0\">{hairs}</scene>"));
    assert!(why.starts_with("it has no surfaces that can be read (line 2: the shape \"hair\""), "{why}");
    assert!(why.contains("line 6") && !why.contains("line 7") && why.ends_with("and 3 more)"), "{why}");
}

/// What a reference leads to is used, wherever it stands.
#[test]
fn a_reference_that_leads_somewhere_is_no_loss() {
    let text = r#"<scene version="3.0.0">
<texture type="checkerboard" id="board"/><spectrum id="light" value="2"/>
<bsdf type="diffuse" id="paint"><ref id="board" name="reflectance"/></bsdf>
<bsdf type="twosided" id="both"><ref id="paint"/></bsdf>
<medium type="homogeneous" id="fog"><float name="sigma_t" value="1"/></medium>
<emitter type="area" id="glow"><float name="radiance" value="2"/></emitter>
<shape type="rectangle"><ref id="both"/><ref id="glow"/></shape>
<shape type="rectangle"><ref id="paint" name="bsdf"/><emitter type="area"><ref id="light" name="radiance"/></emitter></shape>
<shape type="sphere"><bsdf type="null"/><ref id="fog" name="interior"/></shape>
</scene>"#;
    let imported = imported("xml", text);
    assert!(said(&imported).is_empty(), "{:#?}", said(&imported));
    assert_eq!(scene(&imported).objects.iter().filter(|object| object.emission.is_some()).count(), 2);
}

fn rough(plugin: &str, keys: &str) -> (MaterialKind, Vec<String>) {
    let imported = imported(
        "xml",
        &format!(
            "<scene version=\"3.0.0\"><shape type=\"rectangle\"><bsdf type=\"{plugin}\">{keys}</bsdf></shape></scene>"
        ),
    );
    let scene = scene(&imported);
    (on_its_side(&scene.materials[scene.objects[0].material].kind).clone(), said(&imported))
}

#[test]
fn facets_of_mitsuba_are_beckmann_s_unless_it_says_otherwise() {
    for (keys, distribution) in [
        ("", FacetDistribution::Beckmann),
        ("<string name=\"distribution\" value=\"beckmann\"/>", FacetDistribution::Beckmann),
        ("<string name=\"distribution\" value=\"ggx\"/>", FacetDistribution::Ggx),
    ] {
        for plugin in ["roughconductor", "roughdielectric", "roughplastic"] {
            let keys = format!("{keys}<float name=\"alpha\" value=\"0.25\"/>");
            let (kind, said) = rough(plugin, &keys);
            let expected = Microfacets { distribution, masking: FacetMasking::Separable, ..0.25.into() };
            assert_eq!(kind.microfacets().collect::<Vec<_>>(), [&expected], "{plugin} {keys}");
            assert!(said.iter().all(|line| line.contains("rough coat")), "{said:?}");
            if let MaterialKind::Plastic { compensated, .. } = kind {
                assert!(!compensated, "what facets hide is lost there");
            }
        }
    }
    // Of version 0.x.
    let (kind, said) = rough(
        "roughconductor",
        "<string name=\"distribution\" value=\"phong\"/><float name=\"alpha\" value=\"0.25\"/>",
    );
    let expected =
        Microfacets { distribution: FacetDistribution::Beckmann, masking: FacetMasking::Separable, ..0.25.into() };
    assert_eq!(kind.microfacets().collect::<Vec<_>>(), [&expected]);
    assert_eq!(said, ["line 1: the facets \"phong\" become Beckmann's of the same width"]);
    // A perfect mirror may be rough.
    let (kind, said) = rough("roughconductor", "<string name=\"material\" value=\"none\"/>");
    assert!(said.is_empty(), "{said:?}");
    assert!(matches!(kind, MaterialKind::RoughConductor { metal: Metal::Reflectance(_), compensated: false, .. }));
}

#[test]
fn gloss_of_mtl_becomes_coats_and_metals() {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let read = |mtl: &str| {
        let library = format!("newmtl m\n{mtl}");
        let near = |name: &str| if name == "a.mtl" { Ok(library.as_bytes().to_vec()) } else { near(name) };
        let imported = import_bytes("obj", obj.as_bytes(), &near, "x/", "a").unwrap();
        let scene = scene(&imported);
        (scene.materials[scene.objects[0].material].kind.clone(), said(&imported))
    };
    // By Blender's writer: roughness and metalness.
    let (kind, said) = read("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nPr 0.5\nPm 0\nNi 1.45\n");
    let MaterialKind::Plastic { coat, facets, .. } = &kind else { panic!("a coat, not {kind:?}") };
    assert!((coat.eval(550.0) - 1.45).abs() < 1e-6 && *facets == Some(0.25.into()) && said.is_empty(), "{said:?}");
    let (kind, said) = read("Kd 0.5 0.5 0.5\nPr 0.5\nPm 1\n");
    assert!(matches!(kind, MaterialKind::RoughConductor { .. }) && said.is_empty(), "{kind:?} {said:?}");
    let (kind, _) = read("Kd 0.5 0.5 0.5\nPr 0.5\nPm 0.25\n");
    assert!(matches!(kind, MaterialKind::Blend { .. }), "{kind:?}");
    // By Phong's exponent: α² = 2/(n + 2).
    let (kind, said) = read("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 30\n");
    let MaterialKind::Plastic { coat, facets: Some(facets), .. } = &kind else { panic!("a coat, not {kind:?}") };
    let head_on = ((coat.eval(550.0) - 1.0) / (coat.eval(550.0) + 1.0)).powi(2);
    assert!((head_on - 0.04).abs() < 1e-12 && (facets.alpha[0] - 0.25).abs() < 1e-12);
    assert_eq!(facets.distribution, FacetDistribution::Beckmann);
    assert!(said[0].contains("Phong"), "{said:?}");
    let (kind, _) = read("Kd 0 0 0\nKs 0.5 0.5 0.5\nNs 30\n");
    assert!(matches!(kind, MaterialKind::RoughConductor { .. }), "{kind:?}");
    // Without highlights, and without any specular colour, it is paint.
    for mtl in ["Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nillum 1\n", "Kd 0.5 0.5 0.5\nNs 30\n"] {
        let (kind, said) = read(mtl);
        assert!(matches!(kind, MaterialKind::Lambert { .. }) && said.is_empty(), "{kind:?} {said:?}");
    }
}

/// Modellers write meshes that have collapsed to a line. A scene refuses them.
#[test]
fn a_mesh_without_area_is_left_out() {
    let text = r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="sphere"/>
<shape type="obj"><string name="filename" value="flat.obj"/></shape></scene>"#;
    let imported = imported("xml", text);
    assert_eq!(scene(&imported).objects.len(), 1);
    assert_eq!(said(&imported), ["line 2: none of its triangles has an area: it is left out"]);
    let text = "WorldBegin Shape \"sphere\"\nShape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [0 0 0 1 0 0 2 0 0]";
    let imported = super::imported("pbrt", text);
    assert_eq!(scene(&imported).objects.len(), 1);
    assert!(said(&imported).iter().any(|what| what.contains("has an area")), "{:?}", said(&imported));
}

/// One line each, with what the picture lacks.
#[test]
fn what_has_no_counterpart_is_named_with_what_its_absence_changes() {
    let text = r#"<scene version="3.0.0"><sensor type="perspective"/>
<emitter type="sunsky"><float name="turbidity" value="3"/></emitter>
<shape type="bsplinecurve"><string name="filename" value="hair.txt"/><bsdf type="hair"/></shape>
<shape type="sdfgrid"><string name="filename" value="distances.vol"/></shape>
<shape type="ply"><string name="filename" value="painted.ply"/><bsdf type="blendbsdf"><texture type="mesh_attribute" name="weight">
<string name="name" value="face_share"/></texture><bsdf type="diffuse"/><bsdf type="conductor"/></bsdf></shape></scene>"#;
    let imported = imported("xml", text);
    assert_eq!(scene(&imported).objects.len(), 1);
    let expected = [
        "line 2: the emitter \"sunsky\" (a computed sky) gives no light",
        "line 3: the shape \"bsplinecurve\" (curves) is not seen and has no shadow",
        "line 4: the shape \"sdfgrid\" (a grid of distances) is not seen and has no shadow",
        "line 5: of meshes only colours are read, no numbers: \"face_share\" is 0.5 on the whole mesh",
    ];
    for line in expected {
        assert_eq!(said(&imported).iter().filter(|told| *told == line).count(), 1, "{line}\n{:#?}", said(&imported));
    }
}
