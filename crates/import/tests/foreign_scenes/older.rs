//! Mitsuba's files of version 0.x.

use etalon_optics::Spectrum;
use etalon_scene::{MaterialKind, SpectrumTexture};

use super::{imported, on_its_side, said, scene};

/// Names with capitals, `lookAt`, scales of texture coordinates, and what only 0.x has: colours after the curve of sRGB, channels in a spectrum.
const OLD: &str = r##"<scene version="0.6.0">
<integrator type="path"><integer name="maxDepth" value="5"/></integrator>
<sensor type="perspective"><float name="fov" value="40"/>
  <transform name="toWorld"><lookAt origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
  <film type="ldrfilm"><integer name="width" value="64"/><integer name="height" value="48"/></film></sensor>
<bsdf type="diffuse" id="a"><srgb name="diffuseReflectance" value="0.5 0.5 0.5"/></bsdf>
<bsdf type="diffuse" id="b"><srgb name="reflectance" value="#808080"/></bsdf>
<bsdf type="diffuse" id="c"><spectrum name="reflectance" value="0.2, 0.4, 0.6"/></bsdf>
<bsdf type="diffuse" id="d"><texture type="bitmap" name="reflectance"><string name="filename" value="chequers.png"/>
  <float name="uscale" value="4"/><float name="vscale" value="3"/><float name="voffset" value="0.25"/></texture></bsdf>
<bsdf type="diffuse" id="e"><texture type="bitmap" name="reflectance"><string name="filename" value="chequers.png"/>
  <transform name="to_uv"><scale x="4" y="3" z="1"/><translate x="0" y="0.25" z="0"/></transform></texture></bsdf>
<bsdf type="dielectric" id="f"><float name="intIOR" value="1.7"/><float name="extIOR" value="1"/></bsdf>
<shape type="sphere"><transform name="toWorld"><translate x="2"/></transform><ref id="a"/></shape>
<shape type="sphere"><ref id="b"/></shape><shape type="sphere"><ref id="c"/></shape>
<shape type="rectangle"><ref id="d"/></shape><shape type="rectangle"><ref id="e"/></shape>
<shape type="sphere"><ref id="f"/></shape></scene>"##;

fn material(number: usize) -> MaterialKind {
    let scene = scene(&imported("xml", OLD));
    on_its_side(&scene.materials[scene.objects[number].material].kind).clone()
}

fn grey(number: usize) -> f64 {
    match material(number) {
        MaterialKind::Lambert { reflectance: SpectrumTexture::Uniform(spectrum) } => spectrum.eval(550.0),
        other => panic!("{other:?}"),
    }
}

#[test]
fn names_of_version_0_are_those_of_version_3() {
    let imported = imported("xml", OLD);
    let scene = scene(&imported);
    assert_eq!(scene.integrator.max_depth, Some(5));
    assert_eq!((scene.film.width, scene.film.height), (64, 48));
    assert_eq!(scene.camera.position_m, [0.0, 0.0, 5.0]);
    assert!(
        said(&imported).iter().all(|what| !what.contains("ignored") && !what.contains("version")),
        "{:?}",
        said(&imported)
    );
    let MaterialKind::Dielectric { interior, .. } = material(5) else { panic!("{:?}", material(5)) };
    assert!((interior.eval(550.0) - 1.7).abs() < 1e-12);
}

#[test]
fn colours_after_the_curve_of_srgb_become_linear() {
    // ((0.5 + 0.055)/1.055)^2.4 and the same of 128/255.
    assert!((grey(0) - 0.214_041).abs() < 1e-5, "{}", grey(0));
    assert!((grey(1) - 0.215_861).abs() < 1e-5, "{}", grey(1));
    let MaterialKind::Lambert { reflectance: SpectrumTexture::Uniform(three) } = material(2) else { panic!() };
    assert!(three.eval(620.0) < 0.3 && three.eval(450.0) > 0.5 && !matches!(three, Spectrum::Constant(_)));
}

#[test]
fn scales_of_texture_coordinates_are_a_transform() {
    assert_eq!(format!("{:?}", material(3)), format!("{:?}", material(4)));
}

#[test]
fn absorption_and_scattering_are_an_extinction_and_an_albedo() {
    let text = r#"<scene version="0.5.0"><sensor type="perspective"/><shape type="sphere"><bsdf type="null"/>
  <medium name="interior" type="homogeneous"><rgb name="sigmaA" value="0.5 0.5 0.5"/><rgb name="sigmaS" value="1.5 1.5 1.5"/>
  <float name="scale" value="2"/></medium></shape></scene>"#;
    let imported = imported("xml", text);
    let scene = scene(&imported);
    let medium = scene.materials[scene.objects[0].material].medium.as_ref().expect("it holds one");
    assert!(
        (medium.absorption.eval(550.0) - 1.0).abs() < 1e-3 && (medium.scattering.eval(550.0) - 3.0).abs() < 1e-3,
        "{medium:?}"
    );
    assert!(said(&imported).iter().all(|what| !what.contains("ignored")), "{:?}", said(&imported));
}

#[test]
fn what_is_rough_and_diffuse_becomes_diffuse() {
    let text = r#"<scene version="0.5.0"><sensor type="perspective"/><shape type="sphere"><bsdf type="roughdiffuse">
  <rgb name="diffuseReflectance" value="0.3"/><float name="alpha" value="0.4"/></bsdf></shape></scene>"#;
    let imported = imported("xml", text);
    let kind = scene(&imported).materials[0].kind.clone();
    let MaterialKind::Lambert { reflectance: SpectrumTexture::Uniform(spectrum) } = on_its_side(&kind) else {
        panic!("{kind:?}")
    };
    assert!((spectrum.eval(550.0) - 0.3).abs() < 1e-3);
    let said = said(&imported);
    assert!(said.len() == 1 && said[0].contains("becomes diffuse"), "{said:?}");
}
