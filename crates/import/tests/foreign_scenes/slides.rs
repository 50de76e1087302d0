//! Projectors of Mitsuba, and spots with a texture.

use std::f64::consts::PI;

use etalon_scene::{EvenOn, LightKind, SlideLight};

use super::{imported, said, scene};

/// The light of an emitter, and what is listed.
fn slide(emitter: &str) -> (SlideLight, Vec<String>) {
    let imported = imported("xml", &format!("<scene version=\"3.0.0\"><shape type=\"sphere\"/>{emitter}</scene>"));
    let kind = scene(&imported).lights[0].kind.clone();
    let LightKind::Slide(slide) = kind else { panic!("{kind:?}") };
    (*slide, said(&imported))
}

/// Fields of 1 and 0.5, of which Mitsuba shows the first at its (0, 0).
const BOARD: &str = "<texture type=\"checkerboard\" name=\"NAME\"><rgb name=\"color0\" value=\"1\"/><rgb name=\"color1\" value=\"0.5\"/>\
    <transform name=\"to_uv\"><scale x=\"0.5\" y=\"1\"/></transform></texture>";

fn shown(slide: &SlideLight, uv: [f64; 2]) -> f64 {
    slide.image.eval(uv)[0]
}

#[test]
fn a_projector_is_a_point_with_a_slide() {
    let board = BOARD.replace("NAME", "irradiance");
    let keys = format!("{board}<float name=\"scale\" value=\"3\"/><float name=\"fov\" value=\"60\"/>");
    let place = "<transform name=\"to_world\"><scale value=\"2\"/><translate x=\"1\" y=\"2\" z=\"3\"/></transform>";
    let (found, said) = slide(&format!("<emitter type=\"projector\">{keys}{place}</emitter>"));
    assert!(said.is_empty(), "{said:?}");
    assert_eq!((found.lamp.position_m(), found.even_on), (Some([1.0, 2.0, 3.0]), EvenOn::Screen));
    // Along +z with y up, right is −x.
    assert_eq!((found.direction, found.right, found.up), ([0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    let tangent = 30.0_f64.to_radians().tan();
    assert!(found.tangents.iter().all(|t| (t - tangent).abs() < 1e-12), "{:?}", found.tangents);
    // Mitsuba brings π E z/(z² cos θ) with z in units of the lamp, of D65.
    let white = found.lamp.spectrum();
    let luminance = |s: &etalon_optics::Spectrum| etalon_optics::colour::luminance_of(|nm| s.eval(nm));
    assert!((luminance(white) / (PI * 3.0 * 2.0) - 1.0).abs() < 1e-3, "{}", luminance(white));
    assert!((white.eval(450.0) / white.eval(600.0) / (117.008 / 90.0062) - 1.0).abs() < 1e-3);
    // Its (0, 0) is the upper left corner; half of a board lies along u, which is one field wide.
    for (uv, value) in [([0.1, 0.9], 1.0), ([0.9, 0.9], 1.0), ([0.1, 0.1], 0.5), ([0.9, 0.1], 0.5)] {
        assert_eq!(shown(&found, uv), value, "{uv:?}");
    }
}

#[test]
fn a_mirrored_projector_throws_a_mirrored_picture() {
    let gradient = BOARD.replace("NAME", "irradiance").replace("x=\"0.5\"", "x=\"1\"");
    let mirror = "<transform name=\"to_world\"><scale x=\"-1\" y=\"1\" z=\"1\"/></transform>";
    let (plain, _) =
        slide(&format!("<emitter type=\"projector\"><float name=\"fov\" value=\"60\"/>{gradient}</emitter>"));
    let (mirrored, _) =
        slide(&format!("<emitter type=\"projector\"><float name=\"fov\" value=\"60\"/>{gradient}{mirror}</emitter>"));
    for uv in [[0.1, 0.9], [0.7, 0.2]] {
        assert_eq!(shown(&plain, uv), shown(&mirrored, [1.0 - uv[0], uv[1]]));
    }
    assert!(shown(&plain, [0.1, 0.9]) != shown(&plain, [0.9, 0.9]));
}

#[test]
fn a_projector_of_one_colour_lights_its_frame() {
    let keys = "<rgb name=\"irradiance\" value=\"1, 0.5, 0.25\"/><float name=\"fov\" value=\"90\"/>";
    let (found, said) = slide(&format!("<emitter type=\"projector\">{keys}</emitter>"));
    assert!(said.is_empty() && shown(&found, [0.3, 0.6]) == 1.0, "{said:?}");
    let luminance = etalon_optics::colour::luminance_of(|nm| found.lamp.spectrum().eval(nm));
    let expected = PI * (0.2126 + 0.7152 * 0.5 + 0.0722 * 0.25);
    assert!((luminance / expected - 1.0).abs() < 1e-2, "{luminance} {expected}");
}

#[test]
fn the_texture_of_a_spot_is_turned_by_half_of_a_circle() {
    let board = BOARD.replace("NAME", "texture");
    for beam in [10.0, 40.0] {
        let keys =
            format!("<float name=\"cutoff_angle\" value=\"40\"/><float name=\"beam_width\" value=\"{beam}\"/>{board}");
        let (found, said) = slide(&format!("<emitter type=\"spot\">{keys}</emitter>"));
        assert!(said.is_empty(), "{said:?}");
        assert_eq!(found.even_on, EvenOn::Sphere);
        assert_eq!(matches!(found.lamp, LightKind::Spot { .. }), beam == 40.0);
        let tangent = 40.0_f64.to_radians().tan();
        assert!(found.tangents.iter().all(|t| (t - tangent).abs() < 1e-12), "{:?}", found.tangents);
        // Its (0, 0) is the lower right corner.
        for (uv, value) in [([0.9, 0.1], 1.0), ([0.1, 0.1], 1.0), ([0.9, 0.9], 0.5), ([0.1, 0.9], 0.5)] {
            assert_eq!(shown(&found, uv), value, "{uv:?}");
        }
    }
    let backward = format!("<float name=\"cutoff_angle\" value=\"120\"/>{board}");
    let imported = imported(
        "xml",
        &format!(
            "<scene version=\"3.0.0\"><shape type=\"sphere\"/><emitter type=\"spot\">{backward}</emitter></scene>"
        ),
    );
    assert!(said(&imported).iter().any(|line| line.contains("shines backward")), "{:?}", said(&imported));
}

#[test]
fn a_slide_without_a_width_is_refused() {
    for (x, y, z) in [(0, 1, 1), (1, 0, 1), (1, 1, 0)] {
        let flat = format!("<transform name=\"to_world\"><scale x=\"{x}\" y=\"{y}\" z=\"{z}\"/></transform>");
        let board = BOARD.replace("NAME", "texture");
        for keys in [
            format!("<emitter type=\"projector\"><float name=\"fov\" value=\"40\"/>{flat}</emitter>"),
            format!("<emitter type=\"spot\">{board}{flat}</emitter>"),
        ] {
            let text = format!("<scene version=\"3.0.0\"><shape type=\"sphere\"/>{keys}</scene>");
            assert!(super::refusal("xml", &text).contains("flattens it"), "{keys}");
        }
    }
}
