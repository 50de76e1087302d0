//! Metals of Mitsuba.

use etalon_scene::{MaterialKind, Metal, SpectrumTexture};

use super::{imported, on_its_side, said, scene};

fn metal(bsdf: &str) -> MaterialKind {
    listed(bsdf, &[])
}

fn listed(bsdf: &str, losses: &[&str]) -> MaterialKind {
    let text = format!("<scene version=\"3.0.0\"><shape type=\"sphere\">{bsdf}</shape></scene>");
    let imported = imported("xml", &text);
    assert_eq!(said(&imported), losses);
    let scene = scene(&imported);
    on_its_side(&scene.materials[scene.objects[0].material].kind).clone()
}

/// The name "none" is what Mitsuba takes where no metal is named: it reflects all light.
#[test]
fn a_conductor_without_a_metal_is_a_perfect_mirror() {
    for bsdf in
        ["<bsdf type=\"conductor\"/>", "<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>"]
    {
        assert!(matches!(metal(bsdf), MaterialKind::Mirror { .. }), "{bsdf}");
    }
    let rough = metal("<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.2\"/></bsdf>");
    let MaterialKind::RoughConductor { metal: Metal::Reflectance(SpectrumTexture::Uniform(reflectance)), .. } = rough
    else {
        panic!("{rough:?}")
    };
    assert_eq!(reflectance.eval(500.0), 1.0);
}

/// Without an eta it is 0 but for rounding, without a k that is 1, as those of "none".
#[test]
fn a_metal_of_its_own_has_what_is_left_out_of_none() {
    let index = |keys: &str| {
        let kind = metal(&format!("<bsdf type=\"conductor\">{keys}</bsdf>"));
        let MaterialKind::Conductor { metal: Metal::Index(index), .. } = kind else { panic!("{kind:?}") };
        index.eval(550.0)
    };
    assert_eq!(index("<spectrum name=\"k\" value=\"3\"/>"), (1e-9, 3.0));
    assert_eq!(index("<spectrum name=\"eta\" value=\"0.5\"/>"), (0.5, 1.0));
}

/// Gold's, per channel of a renderer of three: red is reflected more than blue.
#[test]
fn an_index_as_a_colour_becomes_a_smooth_spectrum() {
    let bsdf = "<bsdf type=\"conductor\"><rgb name=\"eta\" value=\"0.143, 0.375, 1.442\"/><rgb name=\"k\" value=\"3.983, 2.386, 1.603\"/></bsdf>";
    let loss = "line 1: a colour as eta or k becomes a smooth spectrum of that colour";
    let kind = listed(bsdf, &[loss]);
    let MaterialKind::Conductor { metal: Metal::Index(index), .. } = kind else { panic!("{kind:?}") };
    for (nm, [n, k]) in [(640.0, [0.143, 3.983]), (450.0, [1.442, 1.603])] {
        let found = index.eval(nm);
        assert!((found.0 - n).abs() < 0.15 && (found.1 - k).abs() < 0.4, "{nm} nm: {found:?}");
    }
}
