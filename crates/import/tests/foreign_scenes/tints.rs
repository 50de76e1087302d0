//! What is left of the light of glass and metals.

use etalon_optics::Spectrum;
use etalon_scene::{Encoding, Image, MaterialKind, SpectrumTexture};

use super::{imported, on_its_side, said, scene};

fn material(bsdf: &str) -> (MaterialKind, Vec<String>) {
    let imported = imported("xml", &format!("<scene version=\"3.0.0\"><shape type=\"sphere\">{bsdf}</shape></scene>"));
    (on_its_side(&scene(&imported).materials[0].kind).clone(), said(&imported))
}

fn tints(kind: &MaterialKind) -> [f64; 2] {
    let MaterialKind::Tinted { reflected, transmitted, .. } = kind else { panic!("{kind:?}") };
    [reflected, transmitted].map(|tint| match tint {
        SpectrumTexture::Uniform(spectrum) => spectrum.eval(550.0),
        other => panic!("{other:?}"),
    })
}

#[test]
fn factors_of_glass_and_metals_are_tints() {
    let both =
        "<float name=\"specular_reflectance\" value=\"0.5\"/><float name=\"specular_transmittance\" value=\"0.25\"/>";
    for plugin in ["dielectric", "roughdielectric", "thindielectric"] {
        let (kind, said) = material(&format!("<bsdf type=\"{plugin}\">{both}</bsdf>"));
        assert_eq!(tints(&kind), [0.5, 0.25], "{plugin}");
        let listed = said.iter().filter(|line| line.contains("differs by up to 1.3 %")).count();
        assert_eq!((listed, said.len()), if plugin == "thindielectric" { (1, 1) } else { (0, 0) }, "{said:?}");
    }
    let one = "<float name=\"specular_reflectance\" value=\"0.5\"/>";
    for keys in
        ["<string name=\"material\" value=\"Au\"/>", "<float name=\"eta\" value=\"1\"/><float name=\"k\" value=\"2\"/>"]
    {
        for plugin in ["conductor", "roughconductor"] {
            let (kind, said) = material(&format!("<bsdf type=\"{plugin}\">{keys}{one}</bsdf>"));
            assert_eq!((tints(&kind), said), ([0.5, 1.0], vec![]), "{plugin}");
        }
    }
    // A rough mirror reflects as much at every angle.
    let (kind, said) = material(&format!("<bsdf type=\"roughconductor\">{one}</bsdf>"));
    assert_eq!((tints(&kind), said), ([0.5, 1.0], vec![]));
    let (kind, _) = material("<bsdf type=\"dielectric\"><float name=\"specular_reflectance\" value=\"1\"/></bsdf>");
    assert!(matches!(kind, MaterialKind::Dielectric { .. }));
}

#[test]
fn principled_glass_passes_the_root_of_its_base_at_each_face() {
    let glass = |base: &str| format!("<bsdf type=\"principled\"><float name=\"spec_trans\" value=\"1\"/>{base}</bsdf>");
    let (kind, _) = material(&glass("<float name=\"base_color\" value=\"0.25\"/>"));
    assert_eq!(tints(&kind), [1.0, 0.5]);
    let (kind, _) = material(&glass("<rgb name=\"base_color\" value=\"0.2, 0.6, 0.1\"/>"));
    let whole = Spectrum::rgb_reflectance([0.2, 0.6, 0.1]).unwrap().eval(550.0);
    assert!((tints(&kind)[1].powi(2) - whole).abs() < 1e-3);
    let (kind, _) = material(&glass("<float name=\"base_color\" value=\"1\"/>"));
    assert!(!matches!(kind, MaterialKind::Tinted { .. }));
}

/// Of an image it is an image of the roots, and the same file in two encodings has two.
#[test]
fn principled_glass_of_an_image_passes_the_roots_of_its_texels() {
    let glass = |raw: bool| {
        format!(
            "<bsdf type=\"principled\"><float name=\"spec_trans\" value=\"1\"/><texture type=\"bitmap\" name=\"base_color\">\
             <string name=\"filename\" value=\"chequers.png\"/><boolean name=\"raw\" value=\"{raw}\"/></texture></bsdf>"
        )
    };
    let shape = |raw: bool| format!("<shape type=\"rectangle\">{}</shape>", glass(raw));
    let imported = imported("xml", &format!("<scene version=\"3.0.0\">{}{}</scene>", shape(false), shape(true)));
    assert_eq!(said(&imported), Vec::<String>::new());
    let materials = scene(&imported).materials;
    let images = [0, 1].map(|i| {
        let MaterialKind::Tinted { transmitted: SpectrumTexture::Image(image), .. } = &materials[i].kind else {
            panic!("{:?}", materials[i].kind)
        };
        image.image.clone()
    });
    for (image, encoding) in images.iter().zip([Encoding::Auto, Encoding::Linear]) {
        let (base, _) = Image::decode(super::PNG, encoding).expect("an image");
        assert_eq!((image.width, image.height), (base.width, base.height));
        for (root, texel) in image.linear_texels().zip(base.linear_texels()) {
            let off = [0, 1, 2].map(|c| (root[c] - texel[c].sqrt()).abs());
            // Half of a step of 16 bits.
            assert!(off.iter().all(|off| *off <= 0.51 / 65535.0), "{root:?} of {texel:?}");
        }
    }
}
