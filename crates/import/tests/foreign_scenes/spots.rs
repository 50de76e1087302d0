//! Spots of Mitsuba, whose light falls off in proportion to the angle.

use etalon_optics::colour::{LUMINOUS_EFFICACY, cie_y_integral_nm, luminance_of};
use etalon_scene::LightKind;

use super::{imported, said, scene};

fn spot(keys: &str) -> (LightKind, Vec<String>) {
    let text = format!(
        "<scene version=\"3.0.0\"><shape type=\"sphere\"/><emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"30\"/>{keys}</emitter></scene>"
    );
    let imported = imported("xml", &text);
    (scene(&imported).lights[0].kind.clone(), said(&imported))
}

#[test]
fn a_soft_spot_is_a_luminaire_as_bright_as_the_spot() {
    let (kind, said) = spot("<float name=\"beam_width\" value=\"10\"/><rgb name=\"intensity\" value=\"4, 2, 1\"/>");
    let LightKind::Luminaire { nadir, photometry, intensity, .. } = kind else { panic!("{kind:?}") };
    assert_eq!((nadir, said), ([0.0, 0.0, 1.0], vec![]));
    assert!((photometry.reach_rad() - 30.0_f64.to_radians()).abs() < 1e-12 && photometry.most_cd() == 1.0);
    // Per candela of the file: 0.2126·4 + 0.7152·2 + 0.0722.
    let candelas = LUMINOUS_EFFICACY * cie_y_integral_nm() * luminance_of(|nm| intensity.eval(nm));
    let expected = LUMINOUS_EFFICACY * cie_y_integral_nm() * 2.353;
    assert!((candelas / expected - 1.0).abs() < 1e-3, "{candelas} {expected}");
}

#[test]
fn a_sharp_spot_stays_a_spot_and_one_of_a_black_body_is_listed() {
    let (kind, said) = spot("<float name=\"beam_width\" value=\"30\"/>");
    assert!(matches!(kind, LightKind::Spot { .. }) && said.is_empty(), "{said:?}");
    let (kind, said) = spot("<spectrum name=\"intensity\" type=\"blackbody\"/>");
    assert!(matches!(kind, LightKind::Spot { .. }) && said[0].contains("another curve"), "{said:?}");
}
