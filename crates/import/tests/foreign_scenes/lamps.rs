//! Lamps of Mitsuba: numbers that say how bright they are, and shapes that are stretched.

use etalon_import::import_bytes;
use etalon_optics::{Illuminant, Spectrum};
use etalon_scene::{LightKind, Scene, Shape};
use glam::DVec3;

use super::{imported, near, said, scene};

/// A lamp of each kind whose light is said by one element, named as the kind wants it.
fn lamps(value: &str) -> Scene {
    let named = |name: &str| value.replace("NAME", name);
    let text = format!(
        r#"<scene version="3.0.0">
<emitter type="constant">{radiance}</emitter>
<emitter type="point">{intensity}</emitter>
<emitter type="directional">{irradiance}</emitter>
<emitter type="spot">{intensity}</emitter>
<emitter type="projector">{irradiance}<float name="fov" value="40"/></emitter>
<shape type="rectangle"><emitter type="area">{radiance}</emitter></shape></scene>"#,
        radiance = named("radiance"),
        intensity = named("intensity"),
        irradiance = named("irradiance"),
    );
    let imported = imported("xml", &text);
    assert_eq!(said(&imported), Vec::<String>::new());
    scene(&imported)
}

/// There a number is the brightness of D65 in the spectral variants, and of white in the others, as a grey colour is. A `spectrum` of one number
/// is of equal energy.
#[test]
fn a_number_as_light_is_white_and_a_spectrum_of_one_number_of_equal_energy() {
    let by_colour = lamps("<rgb name=\"NAME\" value=\"3\"/>");
    for number in ["<float name=\"NAME\" value=\"3\"/>", "<integer name=\"NAME\" value=\"3\"/>"] {
        let by_number = lamps(number);
        assert_eq!(format!("{:?}", by_number.lights), format!("{:?}", by_colour.lights), "{number}");
        assert_eq!(
            format!("{:?}", by_number.objects[0].emission),
            format!("{:?}", by_colour.objects[0].emission),
            "{number}"
        );
    }
    let LightKind::Environment { radiance } = &by_colour.lights[0].kind else { panic!("a sky") };
    assert_eq!(*radiance, Spectrum::rgb_emission([3.0; 3], Illuminant::D65).unwrap());
    let by_spectrum = lamps("<spectrum name=\"NAME\" value=\"3\"/>");
    let LightKind::Environment { radiance } = &by_spectrum.lights[0].kind else { panic!("a sky") };
    assert_eq!(*radiance, Spectrum::Constant(3.0));
}

fn lamp(plugin: &str, keys: &str) -> (Scene, Vec<String>) {
    let text = format!(
        "<scene version=\"3.0.0\">\n<shape type=\"{plugin}\">{keys}<emitter type=\"area\"><rgb name=\"radiance\" value=\"2\"/></emitter>\
         </shape></scene>"
    );
    let imported = imported("xml", &text);
    (scene(&imported), said(&imported))
}

fn stretched(plugin: &str, keys: &str, scale: &str) -> (Scene, Vec<String>) {
    lamp(plugin, &format!("{keys}<transform name=\"to_world\"><scale {scale}/><translate x=\"5\"/></transform>"))
}

#[test]
fn a_cylinder_that_is_stretched_along_its_axis_shines_as_one() {
    let keys = "<point name=\"p0\" x=\"0\" y=\"1\" z=\"0\"/><point name=\"p1\" x=\"0\" y=\"3\" z=\"0\"/><float name=\"radius\" value=\"0.5\"/>";
    let (scene, said) = stretched("cylinder", keys, "x=\"2\" y=\"4\" z=\"2\"");
    assert_eq!(said, Vec::<String>::new());
    let object = &scene.objects[0];
    assert!(object.emission.is_some() && scene.instances.is_empty());
    let Shape::Cylinder { start, end, radius_m, .. } = &object.shape else { panic!("{:?}", object.shape) };
    let at = |p: &[f64; 3]| {
        let (p, t) = (DVec3::from(*p), &object.transform);
        DVec3::from_array([0, 1, 2].map(|k| DVec3::from(t.linear[k]).dot(p) + t.translation_m[k]))
    };
    assert!(at(start).abs_diff_eq(DVec3::new(5.0, 4.0, 0.0), 1e-12), "{}", at(start));
    assert!(at(end).abs_diff_eq(DVec3::new(5.0, 12.0, 0.0), 1e-12), "{}", at(end));
    assert!((radius_m - 1.0).abs() < 1e-12);
}

#[test]
fn other_lamps_that_are_stretched_shine_as_meshes_of_their_area() {
    // π a b; 4π r² with a transform that stretches by less than a per cent; the ellipse of the tube by Ramanujan's formula.
    let tube = std::f64::consts::PI * (3.0 * 3.0 - (5.0_f64 * 7.0).sqrt()) * 2.0;
    for (plugin, keys, scale, area) in [
        ("disk", "", "x=\"2\" y=\"3\" z=\"1\"", 6.0 * std::f64::consts::PI),
        ("sphere", "<float name=\"radius\" value=\"0.5\"/>", "x=\"1\" y=\"1\" z=\"1.00001\"", std::f64::consts::PI),
        ("cylinder", "<point name=\"p1\" x=\"0\" y=\"0\" z=\"2\"/>", "x=\"1\" y=\"2\" z=\"1\"", tube),
    ] {
        let (scene, said) = stretched(plugin, keys, scale);
        let kind = if plugin == "cylinder" { "tube" } else { plugin };
        assert_eq!(said, [format!("line 2: a stretched {kind} that shines becomes a mesh of 256 sectors")]);
        let object = &scene.objects[0];
        assert!(object.emission.is_some() && scene.instances.is_empty(), "{plugin}");
        let Shape::Mesh(mesh) = &object.shape else { panic!("{:?}", object.shape) };
        let linear = object.transform.linear.map(DVec3::from);
        let at = |i: u32| DVec3::from_array(linear.map(|row| row.dot(mesh.vertices[i as usize].into())));
        let found: f64 =
            mesh.triangles.iter().map(|&[a, b, c]| 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).length()).sum();
        assert!((found / area - 1.0).abs() < 1e-4, "{plugin}: {found} is not {area}");
        assert_eq!(object.transform.translation_m, [5.0, 0.0, 0.0]);
    }
}

/// A line of a file asks for a mesh: however many there are, it is one file.
#[test]
fn all_lamps_of_a_kind_share_their_mesh() {
    let lamp = "<shape type=\"sphere\"><transform name=\"to_world\"><scale x=\"2\" y=\"1\" z=\"1\"/></transform><emitter type=\"area\"/></shape>";
    let text = format!("<scene version=\"3.0.0\">{}</scene>", lamp.repeat(5));
    let imported = import_bytes("xml", text.as_bytes(), &near, "", "a").unwrap();
    assert_eq!((imported.files.len(), scene(&imported).objects.len()), (1, 5));
}
