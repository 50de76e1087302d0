//! What stands around bodies of Mitsuba, and around its scenes.

use etalon_scene::{LightKind, MaterialKind, Scene};

use super::{imported, refusal, said, scene};

const HAZE: &str = r#"<medium type="homogeneous" id="haze"><float name="albedo" value="0"/><float name="sigma_t" value="0.5"/></medium>"#;
const GLASS: &str = r#"<bsdf type="dielectric"/>"#;
const FOG: &str = r#"<shape type="sphere"><bsdf type="null"/><ref name="interior" id="haze"/></shape>"#;

/// A scene of an integrator with haze, and what was said of it.
fn with_haze(integrator: &str, sensor: &str, shapes: &str) -> (Scene, Vec<String>) {
    let imported = imported(
        "xml",
        &format!(
            r#"<scene version="3.0.0"><integrator type="{integrator}"/><sensor type="perspective">{sensor}</sensor>{HAZE}{shapes}</scene>"#
        ),
    );
    (scene(&imported), said(&imported))
}

/// The extinction at 500 nm of what fills an object, 0 for nothing.
fn extinction(scene: &Scene, object: usize) -> f64 {
    let medium = &scene.materials[scene.objects[object].material].medium;
    medium.as_ref().map_or(0.0, |medium| medium.absorption.eval(500.0))
}

/// The camera stands in a ball of haze, which ends where the ball does.
#[test]
fn haze_around_the_camera_ends_at_the_boundary_of_its_body() {
    let inside = r#"<ref id="haze"/>"#;
    let (scene, lines) = with_haze("volpath", inside, FOG);
    assert!(scene.medium.is_none() && lines.is_empty(), "{lines:?}");
    assert_eq!(extinction(&scene, 0), 0.5);
    // Without such a body it has no end, and glass states what is on both of its sides.
    let plate = r#"<shape type="rectangle"><bsdf type="diffuse"/></shape>"#;
    assert!(with_haze("volpath", inside, plate).0.medium.is_some());
    let glass = format!(r#"{FOG}<shape type="sphere"><float name="radius" value="0.5"/>{GLASS}</shape>"#);
    let (scene, lines) = with_haze("volpath", inside, &glass);
    assert!(scene.medium.is_some());
    assert!(lines.iter().any(|line| line.contains("beside glass it fills all space")), "{lines:?}");
}

#[test]
fn what_is_outside_of_a_body_fills_the_body_around_it() {
    let inner = |bsdf: &str| {
        format!(
            r#"{FOG}<shape type="sphere"><float name="radius" value="0.5"/>{bsdf}<ref name="exterior" id="haze"/></shape>"#
        )
    };
    let priority = |scene: &Scene, object: usize| match scene.materials[scene.objects[object].material].kind {
        MaterialKind::Boundary { priority } => priority,
        _ => None,
    };
    // A hollow in the haze, and glass in it.
    for (bsdf, own) in [(r#"<bsdf type="null"/>"#, Some(2)), (GLASS, None)] {
        let (scene, said) = with_haze("volpath", "", &inner(bsdf));
        assert!(scene.medium.is_none(), "nothing surrounds the scene");
        assert_eq!([extinction(&scene, 0), extinction(&scene, 1)], [0.5, 0.0]);
        assert_eq!([priority(&scene, 0), priority(&scene, 1)], [Some(1), own]);
        // Glass may be an open surface between two media, which no body says.
        let stated = &scene.materials[scene.objects[1].material].exterior_medium;
        assert_eq!(stated.as_ref().map(|medium| medium.absorption.eval(500.0)), own.is_none().then_some(0.5));
        assert_eq!(said, Vec::<String>::new());
    }
    // A medium of its own, three deep, in any order.
    let smoke = |name: &str, more: &str| {
        format!(
            r#"<medium type="homogeneous" id="{name}"><float name="albedo" value="0"/><float name="sigma_t" value="{more}"/></medium>"#
        )
    };
    let body = |inside: &str, outside: &str| {
        format!(
            r#"<shape type="sphere"><bsdf type="null"/><ref name="interior" id="{inside}"/><ref name="exterior" id="{outside}"/></shape>"#
        )
    };
    let shapes = [smoke("a", "2"), smoke("b", "3"), body("b", "a"), body("a", "haze"), FOG.to_owned()].concat();
    let (scene, said) = with_haze("volpath", "", &shapes);
    assert_eq!(
        [0, 1, 2].map(|object| (extinction(&scene, object), priority(&scene, object))),
        [(3.0, Some(3)), (2.0, Some(2)), (0.5, Some(1))]
    );
    assert!(scene.medium.is_none() && said.is_empty(), "{said:?}");
    // Bodies that say to be outside of each other end somewhere.
    let shapes = [smoke("a", "2"), smoke("b", "3"), body("b", "a"), body("a", "b")].concat();
    assert_eq!(with_haze("volpath", "", &shapes).0.objects.len(), 2);
    let lone = format!(r#"{FOG}<shape type="sphere"><bsdf type="null"/></shape>"#);
    assert_eq!(priority(&with_haze("volpath", "", &lone).0, 0), None);
    let alone = format!(r#"<shape type="sphere">{GLASS}<ref name="exterior" id="haze"/></shape>"#);
    let (scene, said) = with_haze("volpath", r#"<ref id="haze"/>"#, &alone);
    assert!(scene.medium.is_some() && said.is_empty(), "{said:?}");
    assert!(scene.materials.iter().all(|material| material.exterior_medium.is_none()));
    let (scene, said) = with_haze("volpath", "", &alone);
    assert!(scene.medium.is_none() && scene.materials.iter().any(|material| material.exterior_medium.is_some()));
    assert!(matches!(&said[..], [what] if what.contains("the sensor is in none")), "{said:?}");
}

#[test]
fn glass_that_is_turned_over_has_its_media_on_the_other_sides() {
    let glass = |stated: &str| {
        format!(r#"<shape type="sphere"><boolean name="flip_normals" value="true"/>{GLASS}{stated}</shape>"#)
    };
    let (inside, outside) = (r#"<ref name="interior" id="haze"/>"#, r#"<ref name="exterior" id="haze"/>"#);
    for (stated, media) in [
        (inside, [None, Some(0.5)]),
        (outside, [Some(0.5), Some(0.0)]),
        (&format!("{inside}{outside}"), [Some(0.5), Some(0.5)]),
        ("", [None, None]),
    ] {
        let (scene, _) = with_haze("volpath", "", &glass(stated));
        let material = &scene.materials[scene.objects[0].material];
        let found = [&material.medium, &material.exterior_medium];
        assert_eq!(found.map(|medium| medium.as_ref().map(|medium| medium.absorption.eval(500.0))), media, "{stated}");
    }
}

#[test]
fn glass_that_states_no_medium_holds_the_haze_around_it() {
    let glass = format!(r#"<shape type="sphere">{GLASS}</shape>"#);
    let (scene, said) = with_haze("volpath", r#"<ref id="haze"/>"#, &glass);
    assert_eq!(extinction(&scene, 0), 0.5);
    assert_eq!(said, Vec::<String>::new());
    // Clear glass says so by what is outside of it.
    let clear = format!(r#"<shape type="sphere">{GLASS}<ref name="exterior" id="haze"/></shape>"#);
    assert_eq!(extinction(&with_haze("volpath", r#"<ref id="haze"/>"#, &clear).0, 0), 0.0);
    // Which bodies hold others is not worked out.
    let (scene, said) = with_haze("volpath", "", &format!("{FOG}{glass}"));
    assert_eq!(extinction(&scene, 1), 0.0);
    assert!(matches!(&said[..], [what] if what.contains("it states no medium")), "{said:?}");
}

#[test]
fn integrators_that_ignore_media_leave_them_out() {
    let fog = |bsdf: &str| format!(r#"<shape type="sphere">{bsdf}<ref name="interior" id="haze"/></shape>"#);
    for integrator in ["path", "direct", "prb"] {
        let (scene, said) = with_haze(integrator, r#"<ref id="haze"/>"#, &fog(GLASS));
        assert!(scene.medium.is_none() && extinction(&scene, 0) == 0.0, "{integrator}");
        assert!(said.iter().all(|what| what.contains(&format!("the integrator \"{integrator}\""))), "{said:?}");
        assert_eq!(said.len(), 1, "{said:?}");
    }
    for integrator in ["volpath", "volpathmis", "prbvolpath"] {
        let (scene, said) = with_haze(integrator, r#"<ref id="haze"/>"#, &fog(GLASS));
        assert!(scene.medium.is_some() && extinction(&scene, 0) == 0.5 && said.is_empty(), "{integrator}: {said:?}");
    }
    // Wherever the integrator stands.
    let last = format!(
        r#"<scene version="3.0.0"><sensor type="perspective"/>{HAZE}{}<integrator type="path"/></scene>"#,
        fog(GLASS)
    );
    assert_eq!(extinction(&scene(&imported("xml", &last)), 0), 0.0);
}

#[test]
fn a_volume_may_say_color() {
    let of = |name: &str| {
        format!(
            r#"<scene version="3.0.0"><integrator type="volpath"/><sensor type="perspective"/><shape type="sphere">{GLASS}
            <medium name="interior" type="homogeneous"><float name="albedo" value="0"/>
            <volume name="sigma_t" type="constvolume"><float name="{name}" value="3"/></volume></medium></shape></scene>"#
        )
    };
    for name in ["value", "color"] {
        assert_eq!(extinction(&scene(&imported("xml", &of(name))), 0), 3.0);
    }
    let why = refusal("xml", &of("colour"));
    assert!(why.contains("line 3: the volume \"constvolume\" has no \"value\""), "{why}");
}

#[test]
fn a_spot_in_a_shape_shines_beside_it() {
    let text = r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="rectangle">
        <emitter type="spot"><rgb name="intensity" value="10"/><float name="cutoff_angle" value="30"/></emitter></shape></scene>"#;
    let imported = imported("xml", text);
    let scene = scene(&imported);
    assert!(
        matches!(&scene.lights[..], [light] if matches!(light.kind, LightKind::Luminaire { .. })),
        "{:?}",
        scene.lights
    );
    // What shines reflects nothing unless it says so.
    assert_eq!(scene.materials[scene.objects[0].material].kind, MaterialKind::Black);
    assert_eq!((said(&imported), imported.added.clone()), (Vec::new(), Vec::new()));
}

#[test]
fn what_follows_the_scene_is_left_out() {
    let of = |more: &str| {
        format!(r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="sphere"/></scene>{more}"#)
    };
    let followed = imported("xml", &of("\n<shape type=\"sphere\"/>"));
    assert_eq!(scene(&followed).objects.len(), 1);
    assert_eq!(said(&followed), ["line 1: what follows </scene> is left out, as in Mitsuba"]);
    assert_eq!(said(&imported("xml", &of("\n<!-- the end -->\n"))), Vec::<String>::new());
    // What is wrong before the end stays an error.
    let why = refusal("xml", r#"<scene version="3.0.0"><shape></scene><shape type="sphere"/>"#);
    assert!(why.contains("expected 'shape' tag, not 'scene'"), "{why}");
}

#[test]
fn emitters_are_hidden_only_where_that_is_asked_for() {
    for (value, hides) in [("true", true), ("false", false)] {
        let text = format!(
            r#"<scene version="3.0.0"><integrator type="path"><boolean name="hide_emitters" value="{value}"/></integrator>
            <sensor type="perspective"/><shape type="sphere"/></scene>"#
        );
        let imported = imported("xml", &text);
        assert_eq!(said(&imported), Vec::<String>::new());
        assert_eq!(scene(&imported).integrator.hide_lights, hides, "{value}");
    }
}
