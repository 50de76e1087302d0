//! Colours of meshes that materials of Mitsuba show.

use etalon_scene::MaterialKind;

use super::{imported, on_its_side, said, scene};

/// Two triangles with colours of their vertices, as bytes, and of their faces.
pub(super) const PLY: &str = "ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar r
property uchar g
property uchar b
element face 2
property list uchar int vertex_indices
property float r
property float g
property float b
end_header
0 0 0 0 255 0
1 0 0 255 255 255
1 1 0 0 0 0
0 1 0 255 0 0
3 0 1 2 0.25 0.5 0.75
3 0 2 3 0.5 0.5 1.5
";

fn of(shape: &str, name: &str, keys: &str) -> String {
    format!(
        r#"<scene version="3.0.0"><bsdf type="diffuse" id="paint"><texture type="mesh_attribute" name="reflectance">
        <string name="name" value="{name}"/>{keys}</texture></bsdf>
<shape type="{shape}"><string name="filename" value="painted.ply"/><ref id="paint"/></shape></scene>"#
    )
}

#[test]
fn colours_of_vertices_and_of_faces_arrive() {
    let vertices = imported("xml", &of("ply", "vertex_color", ""));
    assert_eq!(said(&vertices), Vec::<String>::new());
    let vertices = scene(&vertices);
    assert_eq!(vertices.objects[0].shape.vertex_colours(), [[0.0, 1.0, 0.0], [1.0; 3], [0.0; 3], [1.0, 0.0, 0.0]]);
    let MaterialKind::Lambert { reflectance } = on_its_side(&vertices.materials[0].kind) else { panic!("diffuse") };
    assert_eq!(reflectance.vertex_colours(), Some([1.0; 3]));
    let faces = imported("xml", &of("ply", "face_color", "<float name=\"scale\" value=\"0.5\"/>"));
    assert_eq!(said(&faces), Vec::<String>::new());
    let faces = scene(&faces);
    let colours = faces.objects[0].shape.vertex_colours();
    assert_eq!((colours.len(), colours[0], colours[3]), (6, [0.125, 0.25, 0.375], [0.25, 0.25, 0.75]));
}

#[test]
fn what_meshes_do_not_have_becomes_grey_and_is_listed() {
    for (shape, name) in [("ply", "vertex_other"), ("sphere", "vertex_color")] {
        let imported = imported("xml", &of(shape, name, ""));
        assert!(said(&imported)[0].contains("mesh_attribute"), "{:?}", said(&imported));
        let scene = scene(&imported);
        let MaterialKind::Lambert { reflectance } = on_its_side(&scene.materials[0].kind) else { panic!("diffuse") };
        assert_eq!(reflectance, &etalon_optics::Spectrum::Constant(0.5).into());
    }
    // 1.5 of blue is no reflectance.
    let bright = imported("xml", &of("ply", "face_color", ""));
    assert!(said(&bright)[0].contains("clamped"), "{:?}", said(&bright));
    assert_eq!(scene(&bright).objects[0].shape.vertex_colours()[3], [0.5, 0.5, 1.0]);
}
