//! Polarisers and retarders of Mitsuba.

use etalon_scene::{MaterialKind, PolarisingSheet, Scene};

use super::{imported, said, scene};

/// Two rectangles in the plane z = 0 before a camera on the side `z`, the second one turned by 30° about its normal.
fn of(bsdf: &str, z: f64) -> String {
    format!(
        r#"<scene version="3.0.0">
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, {z}" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<shape type="rectangle" id="one">{bsdf}</shape>
<shape type="rectangle" id="two"><transform name="to_world"><scale x="3"/><rotate z="1" angle="30"/></transform>{bsdf}</shape>
</scene>"#
    )
}

/// Axes of both in the world.
fn axes(scene: &Scene) -> Vec<[f64; 3]> {
    let in_world = |name: &str| {
        let object = scene.objects.iter().find(|object| object.name == name).expect("a sheet");
        let MaterialKind::PolarisingSheet { axis, .. } = scene.materials[object.material].kind else {
            panic!("a sheet")
        };
        // As normals are: by the inverse of the transpose, here of a stretch along x before a turn.
        let stretch = if name == "two" { 3.0 } else { 1.0 };
        let (sin, cos) = (if name == "two" { 30.0_f64 } else { 0.0 }).to_radians().sin_cos();
        let [x, y] = [axis[0] / stretch, axis[1]];
        let [x, y] = [x * cos - y * sin, x * sin + y * cos];
        let length = x.hypot(y);
        [x / length, y / length, axis[2]]
    };
    ["one", "two"].map(in_world).into()
}

fn at(degrees: f64) -> [f64; 3] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [cos, sin, 0.0]
}

fn alike(found: [f64; 3], want: [f64; 3]) -> bool {
    let dot: f64 = (0..3).map(|k| found[k] * want[k]).sum();
    (dot.abs() - 1.0).abs() < 1e-12
}

#[test]
fn axes_stand_where_the_frame_of_the_rectangle_has_them() {
    // As Mitsuba 3.9.1 has them: polarisers are turned against their angle, from whichever side they are seen.
    for (angle, z, expected) in
        [("0", 5.0, [0.0, 30.0]), ("90", 5.0, [90.0, 120.0]), ("20", 5.0, [-20.0, 10.0]), ("20", -5.0, [-20.0, 10.0])]
    {
        let polariser = format!(r#"<bsdf type="polarizer"><spectrum name="theta" value="{angle}"/></bsdf>"#);
        let imported = imported("xml", &of(&polariser, z));
        assert_eq!(said(&imported), Vec::<String>::new());
        for (found, want) in axes(&scene(&imported)).into_iter().zip(expected) {
            assert!(alike(found, at(want)), "{angle} from {z}: {found:?} is not {want}°");
        }
    }
}

#[test]
fn retarders_are_turned_by_their_angle() {
    let retarder = r#"<bsdf type="retarder"><float name="theta" value="20"/></bsdf>"#;
    for (found, want) in axes(&scene(&imported("xml", &of(retarder, 5.0)))).into_iter().zip([20.0, 50.0]) {
        assert!(alike(found, at(want)), "{found:?} is not {want}°");
    }
}

#[test]
fn what_sheets_say_arrives() {
    let polariser = r#"<bsdf type="polarizer"><float name="transmittance" value="0.75"/></bsdf>"#;
    let MaterialKind::PolarisingSheet { sheet: PolarisingSheet::Polariser { transmittance, extinction }, .. } =
        scene(&imported("xml", &of(polariser, 5.0))).materials[0].kind.clone()
    else {
        panic!("a polariser")
    };
    assert_eq!((transmittance.eval(550.0), extinction), (0.75, 0.0));
    let imported = imported("xml", &of(r#"<bsdf type="retarder"><float name="delta" value="180"/></bsdf>"#, 5.0));
    let MaterialKind::PolarisingSheet { sheet: PolarisingSheet::Retarder { retardance_rad, at_nm }, .. } =
        scene(&imported).materials[0].kind
    else {
        panic!("a retarder")
    };
    assert_eq!((retardance_rad, at_nm), (std::f64::consts::PI, None));
    assert!(said(&imported).iter().all(|line| line.contains("twice as much at 60°")), "{:?}", said(&imported));
}

#[test]
fn sheets_without_a_like_let_as_much_light_through_and_are_listed() {
    for (shape, bsdf, opacity) in [
        ("sphere", r#"<bsdf type="polarizer"/>"#, 0.5),
        ("sphere", r#"<bsdf type="retarder"/>"#, 0.0),
        ("rectangle", r#"<bsdf type="circular"><float name="transmittance" value="0.5"/></bsdf>"#, 0.75),
    ] {
        let imported =
            imported("xml", &format!(r#"<scene version="3.0.0"><shape type="{shape}">{bsdf}</shape></scene>"#));
        let said = said(&imported);
        assert!(said.iter().any(|line| line.contains("cannot be converted")), "{bsdf}: {said:?}");
        assert_eq!(scene(&imported).objects[0].opacity, opacity, "{bsdf}");
    }
    // That does not polarise; half of the light passes all the same.
    let grey = imported("xml", &of(r#"<bsdf type="polarizer"><boolean name="polarizing" value="false"/></bsdf>"#, 5.0));
    assert_eq!((said(&grey), scene(&grey).objects[0].opacity), (Vec::new(), 0.5));
}

/// A square in the plane z = 0 as a mesh, and the axis of each of its parts in the world: in the frame that begins with growing u, or with the
/// first edge of a triangle without texture coordinates.
#[test]
fn axes_on_flat_meshes_stand_where_the_frames_of_their_triangles_have_them() {
    let placed = |file: &str, further: &str| {
        let text = format!(
            r#"<scene version="3.0.0"><shape type="obj" id="pane"><string name="filename" value="{file}"/>{further}
            <bsdf type="polarizer"><spectrum name="theta" value="20"/></bsdf></shape></scene>"#
        );
        let imported = imported("xml", &text);
        let scene = scene(&imported);
        let axis = |object: &etalon_scene::Object| match scene.materials[object.material].kind {
            MaterialKind::PolarisingSheet { axis, .. } => Some(axis),
            _ => None,
        };
        (said(&imported), scene.objects.iter().map(axis).collect::<Vec<_>>())
    };
    // Growing u points to 30° in the file; a polariser is turned against its angle.
    for (further, want) in [("", 10.0), (r#"<boolean name="flip_normals" value="true"/>"#, 50.0)] {
        let (said, axes) = placed("pane.obj", further);
        assert_eq!((said.len(), axes.len()), (0, 1), "{said:?}");
        assert!(alike(axes[0].unwrap(), at(want)), "{axes:?} is not {want}°");
    }
    // Without texture coordinates each triangle has its own first edge: along x, and along y.
    let (said, axes) = placed("bare-pane.obj", "");
    assert_eq!((said.len(), axes.len()), (0, 2), "{said:?}");
    assert!(alike(axes[0].unwrap(), at(-20.0)) && alike(axes[1].unwrap(), at(70.0)), "{axes:?}");
    // Normals that are not the same everywhere make another frame at each place.
    let (said, axes) = placed("bent-pane.obj", "");
    assert!(said[0].contains("on a curved mesh cannot be converted") && axes == [None], "{said:?} {axes:?}");
}
