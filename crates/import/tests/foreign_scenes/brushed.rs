//! Roughness that differs along u and across it.

use etalon_scene::{FacetMasking, MaterialKind, Microfacets};

use super::{imported, said, scene};

/// The facets of the last object.
fn facets(kind: &str, text: &str) -> (Option<Microfacets>, Vec<String>) {
    let imported = imported(kind, text);
    let scene = scene(&imported);
    let object = scene.objects.last().expect("an object");
    let facets = scene.materials[object.material].kind.microfacets().next().copied();
    (facets, said(&imported).into_iter().filter(|what| what.contains("rough") || what.contains("width")).collect())
}

fn widths(u: f64, v: f64) -> Option<Microfacets> {
    Some(Microfacets::ggx([u, v], 0.0))
}

/// The same with the masking of Mitsuba, which is that of each direction by itself.
fn apart(u: f64, v: f64) -> Option<Microfacets> {
    widths(u, v).map(|facets| Microfacets { masking: FacetMasking::Separable, ..facets })
}

fn mitsuba(shape: &str, bsdf: &str, numbers: &str) -> String {
    format!(
        r#"<scene version="3.0.0"><shape type="{shape}"><string name="filename" value="normals.obj"/><bsdf type="{bsdf}">
        <string name="distribution" value="ggx"/>{numbers}</bsdf></shape></scene>"#
    )
}

const TWO: &str = r#"<float name="alpha_u" value="0.04"/><float name="alpha_v" value="0.36"/>"#;

#[test]
fn widths_of_mitsuba_arrive() {
    for bsdf in ["roughconductor", "roughdielectric"] {
        assert_eq!(facets("xml", &mitsuba("rectangle", bsdf, TWO)), (apart(0.04, 0.36), vec![]), "{bsdf}");
    }
    let equal = r#"<float name="alpha_u" value="0.3"/><float name="alpha_v" value="0.3"/>"#;
    assert_eq!(facets("xml", &mitsuba("rectangle", "roughconductor", equal)), (apart(0.3, 0.3), vec![]));
    // One of them smooth: the least width that there is.
    let smooth = r#"<float name="alpha_u" value="0"/><float name="alpha_v" value="0.3"/>"#;
    assert_eq!(facets("xml", &mitsuba("rectangle", "roughconductor", smooth)).0, apart(1e-4, 0.3));
    // Without texture coordinates it has no directions: √(0.04·0.36).
    let (found, said) = facets("xml", &mitsuba("obj", "roughconductor", TWO));
    assert!((found.unwrap().alpha[0] - 0.12).abs() < 1e-12 && found.unwrap().is_isotropic(), "{found:?}");
    assert!(said.len() == 1 && said[0].contains("geometric mean of both widths"), "{said:?}");
}

fn pbrt(material: &str, uv: &str) -> String {
    format!(
        "WorldBegin\nMaterial {material}\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 ] {uv}\n"
    )
}

#[test]
fn roughnesses_of_pbrt_arrive() {
    let uv = "\"point2 uv\" [ 0 0 1 0 0 1 ]";
    let rough = "\"float uroughness\" 0.04 \"float vroughness\" 0.25";
    for kind in ["conductor", "dielectric", "coateddiffuse"] {
        let material = format!("\"{kind}\" {rough}");
        assert_eq!(facets("pbrt", &pbrt(&material, uv)), (widths(0.2, 0.5), vec![]), "{kind}");
        let plain = format!("{material} \"bool remaproughness\" false");
        assert_eq!(facets("pbrt", &pbrt(&plain, uv)), (widths(0.04, 0.25), vec![]), "{kind}");
    }
    let (found, said) = facets("pbrt", &pbrt(&format!("\"conductor\" {rough}"), ""));
    assert!((found.unwrap().alpha[0] - 0.1_f64.sqrt()).abs() < 1e-12 && found.unwrap().is_isotropic(), "{found:?}");
    assert!(said.len() == 1 && said[0].contains("geometric mean of both widths"), "{said:?}");
}

/// A part of a mixture loses its directions with the whole.
#[test]
fn mixtures_without_texture_coordinates_have_no_directions() {
    let text = pbrt("\"mix\" \"string materials\" [ \"a\" \"b\" ] \"float amount\" 0.5", "").replace(
        "WorldBegin\n",
        "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"conductor\" \"float uroughness\" 0.04 \"float vroughness\" 0.25\n\
         MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"float roughness\" 0.09\n",
    );
    let imported = imported("pbrt", &text);
    let scene = scene(&imported);
    let kind = &scene.materials[scene.objects[0].material].kind;
    let MaterialKind::Blend { parts, .. } = kind else { panic!("{kind:?}") };
    assert_eq!(parts.len(), 2);
    assert!(kind.microfacets().all(Microfacets::is_isotropic));
}
