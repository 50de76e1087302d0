//! Scenes of Mitsuba and pbrt: what they say arrives in the scene, what cannot be honoured is listed with its line.

mod bounds;
mod brushed;
mod checkers;
mod coordinates;
mod filters;
mod grids;
mod images;
mod included;
mod lamps;
mod losses;
mod measured;
mod media;
mod metals;
mod older;
mod parameters;
mod pbrt_directives;
mod principled;
mod refused;
mod relief;
mod seeds;
mod sheets;
mod sides;
mod slides;
mod spots;
mod stand_ins;
mod surroundings;
mod tints;
mod translucent;
mod varying;
mod vertex_colours;

use etalon_import::{Imported, import_bytes};
use etalon_scene::{EnvironmentProjection, LightKind, MaterialKind, Projection, Scene, Shape, SpectrumTexture, UvMap};

const PNG: &[u8] = include_bytes!("../../../scene/tests/files/chequers.png");
const BSDF: &[u8] = include_bytes!("../../../scene/tests/files/paint.bsdf");
/// A triangle without texture coordinates.
const BARE: &[u8] =
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const GRAIN: &[u8] = include_bytes!("../../../scene/tests/files/grain.bsdf");
const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
const INCLUDED: &[u8] = br#"<scene version="3.0.0">
  <bsdf type="twosided" id="red"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.1, 0.05"/></bsdf></bsdf>
</scene>"#;

/// A grid of two cells.
fn vol(channels: i32, values: &[f32]) -> Vec<u8> {
    let head = [1, 1, 1, 2, channels].into_iter().flat_map(i32::to_le_bytes);
    let numbers = [0.0, 0.0, 0.0, 9.0, 9.0, 9.0].iter().chain(values).flat_map(|number: &f32| number.to_le_bytes());
    b"VOL\x03".iter().copied().chain(head).chain(numbers).collect()
}

fn near(name: &str) -> Result<Vec<u8>, String> {
    match name {
        "chequers.png" => Ok(PNG.to_vec()),
        "paint.bsdf" => Ok(BSDF.to_vec()),
        "cut.bsdf" => Ok(BSDF[..99].to_vec()),
        "grain.bsdf" => Ok(GRAIN.to_vec()),
        "bare.ply" => Ok(BARE.to_vec()),
        "a.obj" => Ok(OBJ.to_vec()),
        // cos 30° and sin 30° times the place.
        "pane.obj" => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 0.8660254 -0.5\nvt 0.5 0.8660254\nvt 1.3660254 0.3660254\n\
f 1/1 2/2 3/3\nf 2/2 4/4 3/3\n"
            .to_vec()),
        "bare-pane.obj" => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n".to_vec()),
        "bent-pane.obj" => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0.6 0 0.8\nf 1//1 2//2 3//1\n".to_vec()),
        "flat.obj" => Ok(b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_vec()),
        "turned.obj" => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\n".to_vec()),
        "normals.obj" => Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n".to_vec()),
        "smoke.vol" => Ok(vol(1, &[0.5, 1.5])),
        "coloured.vol" => Ok(vol(3, &[0.75, 0.375, 0.0, 0.375, 0.375, 0.0])),
        "inc.xml" => Ok(INCLUDED.to_vec()),
        "inc.pbrt" => Ok(b"Shape \"sphere\" \"float radius\" 2\n".to_vec()),
        "itself.xml" => Ok(br#"<scene version="3.0.0"><include filename="itself.xml"/></scene>"#.to_vec()),
        "itself.pbrt" => Ok(b"Include \"itself.pbrt\"".to_vec()),
        "painted.ply" => Ok(vertex_colours::PLY.as_bytes().to_vec()),
        other => Err(format!("there is no {other}")),
    }
}

fn imported(kind: &str, text: &str) -> Imported {
    import_bytes(kind, text.as_bytes(), &near, "x/", "a").unwrap_or_else(|why| panic!("{why}"))
}

fn scene(imported: &Imported) -> Scene {
    imported.parse("model", None).unwrap_or_else(|errors| panic!("{errors}\n{}", imported.text)).scene
}

/// What a material does on the side that it has.
fn on_its_side(kind: &MaterialKind) -> &MaterialKind {
    match kind {
        MaterialKind::TwoSided { front, back } if **front == MaterialKind::Black => back,
        MaterialKind::TwoSided { front, .. } => front,
        kind => kind,
    }
}

fn refusal(kind: &str, text: &str) -> String {
    import_bytes(kind, text.as_bytes(), &near, "", "a").unwrap_err()
}

fn said(imported: &Imported) -> Vec<String> {
    imported.left_out.iter().map(|l| format!("{}: {}", l.place, l.what)).collect()
}

const MITSUBA: &str = r#"<?xml version="1.0"?>
<scene version="3.0.0">
  <default name="spp" value="33"/>
  <default name="width" value="300"/>
  <include filename="inc.xml"/>
  <integrator type="path"><integer name="max_depth" value="7"/><boolean name="hide_emitters" value="true"/></integrator>
  <sensor type="thinlens">
    <float name="fov" value="40"/><float name="aperture_radius" value="0.1"/><float name="focus_distance" value="3"/>
    <transform name="to_world"><lookat origin="1, 2, 6" target="1, 2, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="$width"/><integer name="height" value="200"/><rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
  </sensor>
  <bsdf type="diffuse" id="tiles">
    <texture type="bitmap" name="reflectance"><string name="filename" value="chequers.png"/>
      <transform name="to_uv"><scale x="4" y="3"/><translate x="0.25" y="0.1"/></transform></texture>
  </bsdf>
  <shape type="rectangle" id="floor"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform><ref id="tiles"/></shape>
  <shape type="sphere" id="ball"><point name="center" x="-1" y="0.5" z="0"/><float name="radius" value="0.5"/><ref id="red"/></shape>
  <shape type="sphere" id="egg"><transform name="to_world"><scale x="1" y="2" z="1"/></transform>
    <bsdf type="dielectric"><string name="int_ior" value="water"/><float name="ext_ior" value="1"/></bsdf></shape>
  <shape type="obj" id="sail"><string name="filename" value="a.obj"/><boolean name="flip_normals" value="true"/>
    <bsdf type="mask"><float name="opacity" value="0.25"/><bsdf type="roughconductor"><string name="material" value="Au"/>
      <float name="alpha" value="0.2"/></bsdf></bsdf><emitter type="area"><spectrum name="radiance" value="400:0.5, 700:2"/></emitter></shape>
  <shape type="shapegroup" id="stick"><shape type="cylinder"><float name="radius" value="0.05"/></shape></shape>
  <shape type="instance" id="here"><ref id="stick"/><transform name="to_world"><translate x="-2"/></transform></shape>
  <shape type="instance"><ref id="stick"/></shape>
  <shape type="hair"/>
  <emitter type="point"><point name="position" x="-2" y="2" z="2"/><rgb name="intensity" value="0.5 0.7 1"/></emitter>
  <emitter type="constant"><float name="radiance" value="0.25"/></emitter>
</scene>"#;

#[test]
fn a_mitsuba_scene_arrives_with_its_camera_shapes_materials_and_lights() {
    let imported = imported("xml", MITSUBA);
    let scene = scene(&imported);
    assert_eq!((scene.film.width, scene.film.height), (300, 200));
    assert_eq!(scene.camera.position_m, [1.0, 2.0, 6.0]);
    assert_eq!(scene.camera.forward, [0.0, 0.0, -1.0]);
    let Projection::Perspective { vertical_fov_rad, lens, .. } = &scene.camera.projection else {
        panic!("perspective")
    };
    // 40° across 300 pixels.
    let vertical = 2.0 * (20.0_f64.to_radians().tan() * 200.0 / 300.0).atan();
    assert!((vertical_fov_rad - vertical).abs() < 1e-12);
    assert!(lens.is_some());
    assert_eq!((scene.integrator.spp, scene.integrator.max_depth), (33, Some(7)));
    let object = |name: &str| scene.objects.iter().find(|o| o.name == name).unwrap_or_else(|| panic!("{name}"));
    let kind = |name: &str| &scene.materials[object(name).material].kind;
    let MaterialKind::Lambert { reflectance: SpectrumTexture::Image(image) } = on_its_side(kind("floor")) else {
        panic!("tiles")
    };
    // v is counted from the top there: 1 − (3v + 0.1).
    assert_eq!(image.uv_map, UvMap::scaled([4.0, -3.0], [0.25, 0.9]));
    assert!(matches!(kind("ball"), MaterialKind::Lambert { .. }));
    let sail = object("sail");
    assert_eq!(sail.opacity, 0.25);
    assert!(matches!(on_its_side(kind("sail")), MaterialKind::RoughConductor { .. }));
    assert!(matches!(kind("sail"), MaterialKind::TwoSided { front, .. } if **front == MaterialKind::Black));
    // Its normals are flipped, so it shines from its back.
    let emission = sail.emission.as_ref().expect("it shines");
    assert_eq!(format!("{:?}", emission.sides), "Back");
    assert!((emission.radiance.eval(550.0) - 1.25).abs() < 1e-12);
    assert_eq!(emission.radiance.eval(720.0), 0.0);
    // A stretched ball is an instance of one.
    assert!(scene.objects.iter().all(|o| o.name != "egg"), "a stretched ball is placed by an instance");
    assert_eq!(scene.instances.len(), 3);
    assert!(matches!(scene.lights[0].kind, LightKind::Point { .. }));
    assert!(matches!(scene.lights[1].kind, LightKind::Environment { .. }));
}

#[test]
fn a_camera_of_mitsuba_whose_transform_mirrors_has_a_mirrored_picture() {
    let mirrored = MITSUBA.replace("<lookat", "<scale x=\"-1\"/><lookat");
    let camera = |text: &str| scene(&imported("xml", text)).camera;
    assert_eq!(camera(&mirrored), etalon_scene::Camera { mirrored: true, ..camera(MITSUBA) });
    assert_eq!(said(&imported("xml", &mirrored)), said(&imported("xml", MITSUBA)));
}

/// There a mirroring transform turns triangles inside out, but not what has normals of its own.
#[test]
fn a_mirrored_mesh_of_mitsuba_shines_from_the_side_that_it_does_there() {
    for (file, keys, scale, side) in [
        ("a.obj", "", "1", "Front"),
        ("a.obj", "", "-1 1 1", "Back"),
        ("a.obj", "<boolean name=\"flip_normals\" value=\"true\"/>", "-1 1 1", "Front"),
        ("normals.obj", "", "-1 1 1", "Front"),
        ("normals.obj", "<boolean name=\"face_normals\" value=\"true\"/>", "-1 1 1", "Back"),
    ] {
        let text = format!(
            r#"<scene version="3.0.0"><shape type="obj"><string name="filename" value="{file}"/>{keys}
            <transform name="to_world"><scale value="{scale}"/></transform><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape></scene>"#
        );
        let scene = scene(&imported("xml", &text));
        let emission = scene.objects[0].emission.as_ref().expect("it shines");
        assert_eq!(format!("{:?}", emission.sides), side, "{file} {keys} {scale}");
    }
}

#[test]
fn what_mitsuba_says_and_we_cannot_is_listed_with_its_line() {
    let imported = imported("xml", MITSUBA);
    let said = said(&imported);
    assert_eq!(said, ["line 27: the shape \"hair\" (curves) is not seen and has no shadow"]);
}

#[test]
fn every_property_that_nobody_asks_for_is_listed() {
    // A name that no program knows, in each kind of element.
    for (element, tail) in [
        ("<shape type=\"sphere\"><float name=\"odd\" value=\"1\"/>", "</shape>"),
        ("<emitter type=\"constant\"><float name=\"odd\" value=\"1\"/>", "</emitter>"),
        ("<shape type=\"sphere\"><bsdf type=\"diffuse\"><float name=\"odd\" value=\"1\"/></bsdf>", "</shape>"),
        (
            "<sensor type=\"perspective\"><float name=\"fov\" value=\"9\"/><film type=\"hdrfilm\"><float name=\"odd\" value=\"1\"/></film>",
            "</sensor>",
        ),
        ("<integrator type=\"path\"><float name=\"odd\" value=\"1\"/>", "</integrator>"),
        ("<medium type=\"homogeneous\"><float name=\"odd\" value=\"1\"/>", "</medium>"),
    ] {
        let text = format!("<scene version=\"3.0.0\">\n<shape type=\"cube\"/>\n{element}{tail}\n</scene>");
        let said = said(&imported("xml", &text));
        assert!(said.iter().any(|l| l.starts_with("line 3: ")), "{element}: {said:?}");
    }
}

#[test]
fn a_sky_of_pbrt_is_a_square_of_equal_areas_in_its_axes() {
    // Without a mirroring transform the world is mirrored in x, and the sky with it: +x of the light, the right edge, is −x here.
    let plain = "WorldBegin\nLightSource \"infinite\" \"string filename\" \"chequers.png\" \"float scale\" 2\nShape \"sphere\"\n";
    // Mirrored, the axes are ours; a turn by 90° about x takes +z to −y and +y to +z.
    let turned =
        format!("Scale -1 1 1\nCamera \"perspective\"\n{}", plain.replace("LightS", "Rotate 90 1 0 0\nLightS"));
    for (text, right, forward, up) in [
        (format!("Camera \"perspective\"\n{plain}"), [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        (turned, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]),
    ] {
        let imported = imported("pbrt", &text);
        let scene = scene(&imported);
        let LightKind::ImageEnvironment(sky) = &scene.lights[0].kind else { panic!("a sky") };
        assert_eq!(sky.projection, EnvironmentProjection::EqualArea);
        for (found, expected) in [(sky.right, right), (sky.forward, forward), (sky.up, up)] {
            assert!(
                found.iter().zip(expected).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-12),
                "{found:?} is not {expected:?}"
            );
        }
        // (1, 1, 1) at scale 2 has the luminance 2.
        assert!((etalon_optics::colour::luminance_of(|nm| sky.white.eval(nm)) - 2.0).abs() < 1e-9);
        assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    }
}

#[test]
fn a_sky_of_mitsuba_arrives_with_its_turn() {
    let text = r#"<scene version="3.0.0"><emitter type="envmap"><string name="filename" value="chequers.png"/><float name="scale" value="2"/>
        <transform name="to_world"><rotate y="1" angle="90"/></transform></emitter><shape type="sphere"/></scene>"#;
    let scene = scene(&imported("xml", text));
    let LightKind::ImageEnvironment(sky) = &scene.lights[0].kind else { panic!("a sky") };
    assert_eq!(sky.projection, EnvironmentProjection::LatitudeLongitudeAtPoles);
    // A quarter turn about y takes the middle of the image from +z to +x; to its right, seen from within, then lies +z.
    for (found, expected) in [(sky.forward, [1.0, 0.0, 0.0]), (sky.up, [0.0, 1.0, 0.0]), (sky.right, [0.0, 0.0, 1.0])] {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} is not {expected:?}");
    }
}

const PBRT: &str = r#"
# A comment.
Film "rgb" "integer xresolution" 300 "integer yresolution" [ 200 ] "string filename" "a.exr"
LookAt 1 2 6  1 2 0  0 1 0
Camera "perspective" "float fov" 40 "float lensradius" 0.1 "float focaldistance" 3
Sampler "zsobol" "integer pixelsamples" 33
Integrator "volpath" "integer maxdepth" 6
PixelFilter "box"
WorldBegin
LightSource "infinite" "rgb L" [ 0.25 0.25 0.25 ]
LightSource "point" "blackbody I" 5000 "float scale" 2 "point3 from" [ -2 2 2 ]
Texture "tiles" "spectrum" "imagemap" "string filename" "chequers.png" "float uscale" 4 "float vscale" 3
MakeNamedMaterial "floor" "string type" "diffuse" "texture reflectance" "tiles"
AttributeBegin
  NamedMaterial "floor"
  Shape "trianglemesh" "point3 P" [ 3 0 3  -3 0 3  -3 0 -3  3 0 -3 ] "integer indices" [ 0 1 2  0 2 3 ]
    "point2 uv" [ 0 0  1 0  1 1  0 1 ]
AttributeEnd
AttributeBegin
  Translate -1 0.5 0
  Material "coateddiffuse" "rgb reflectance" [ 0.6 0.1 0.05 ] "float roughness" 0.04 "float g" 0.5
  AreaLightSource "diffuse" "spectrum L" [ 400 1 700 1 ]
  Shape "sphere" "float radius" 0.5
AttributeEnd
Material "dielectric" "spectrum eta" "glass-BK7"
Include "inc.pbrt"
ObjectBegin "stick"
  Material "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float roughness" 0.25 "bool remaproughness" false
  Shape "cylinder" "float radius" 0.05 "float zmin" 0
ObjectEnd
AttributeBegin
  Translate -2 0 0
  ObjectInstance "stick"
AttributeEnd
Shape "curve" "point3 P" [ 0 0 0 1 1 1 2 2 2 3 3 3 ]
MakeNamedMedium "fog" "float g" 0
"#;

#[test]
fn a_pbrt_scene_arrives_with_its_camera_shapes_materials_and_lights() {
    let imported = imported("pbrt", PBRT);
    let scene = scene(&imported);
    assert_eq!((scene.film.width, scene.film.height), (300, 200));
    let Projection::Perspective { vertical_fov_rad, lens, .. } = &scene.camera.projection else {
        panic!("perspective")
    };
    assert!((vertical_fov_rad - 40.0_f64.to_radians()).abs() < 1e-12, "the angle is that of the shorter side");
    assert!(lens.is_some());
    assert_eq!((scene.integrator.spp, scene.integrator.max_depth), (33, Some(7)));
    // Without a mirroring transform the axes are left-handed: the world arrives mirrored in x.
    assert_eq!(scene.camera.position_m, [-1.0, 2.0, 6.0]);
    assert!(imported.added.iter().any(|a| a.contains("mirrored along x")), "{:?}", imported.added);
    let LightKind::Point { position_m, intensity } = &scene.lights[1].kind else { panic!("a point") };
    assert_eq!(*position_m, [2.0, 2.0, 2.0]);
    // Any light but a colour has the luminance of its scale.
    assert!((etalon_optics::colour::luminance_of(|nm| intensity.eval(nm)) - 2.0).abs() < 1e-9);
    let Shape::Sphere { radius_m, .. } = &scene.objects[1].shape else { panic!("the coated ball") };
    assert_eq!((scene.objects[1].transform.translation_m, *radius_m), ([1.0, 0.5, 0.0], 0.5));
    let MaterialKind::Plastic { facets: Some(facets), .. } = &scene.materials[scene.objects[1].material].kind else {
        panic!("coated")
    };
    assert!((facets.alpha[0] - 0.2).abs() < 1e-12, "roughness is the square of alpha");
    let radiance = &scene.objects[1].emission.as_ref().expect("it shines").radiance;
    assert!((etalon_optics::colour::luminance_of(|nm| radiance.eval(nm)) - 1.0).abs() < 1e-9);
    let MaterialKind::Dielectric { interior, .. } = &scene.materials[scene.objects[2].material].kind else {
        panic!("glass")
    };
    assert!((interior.eval(587.5618) - 1.5168).abs() < 1e-4);
    assert_eq!(scene.instances.len(), 1);
}

/// The first found by a fuzzer, which made the sum of a number as large as it can be and one.
#[test]
fn a_depth_beyond_all_limits_is_the_largest_that_a_scene_can_say() {
    let shape = "Shape \"sphere\" \"float radius\" 2\n";
    let pbrt = format!("Integrator \"path\" \"integer maxdepth\" 30000000000000000000\nWorldBegin\n{shape}");
    let mitsuba = r#"<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="30000000000000000000"/></integrator>
        <shape type="sphere"/></scene>"#;
    for (kind, text) in [("pbrt", pbrt.as_str()), ("xml", mitsuba)] {
        let json: serde_json::Value = serde_json::from_str(&imported(kind, text).text).unwrap();
        assert_eq!(json["integrator"]["max_depth"], u32::MAX, "{kind}");
    }
}

#[test]
fn what_pbrt_says_and_we_cannot_is_listed_with_its_line() {
    let said = said(&imported("pbrt", PBRT));
    for line in
        ["line 21: \"float g\" is ignored", "line 35: the shape \"curve\" (curves) is not seen and has no shadow"]
    {
        assert!(said.iter().any(|l| l == line), "{line}\n{said:#?}");
    }
    assert_eq!(said.len(), 2, "{said:#?}");
}

#[test]
fn a_camera_that_is_mirrored_leaves_the_world_as_it_is() {
    let text = "Scale -1 1 1\nLookAt 1 2 6 1 2 0 0 1 0\nCamera \"perspective\"\nWorldBegin\nTranslate 5 0 0\nShape \"sphere\"\n";
    let scene = scene(&imported("pbrt", text));
    assert_eq!(scene.camera.position_m, [1.0, 2.0, 6.0]);
    assert_eq!(scene.objects[0].transform.translation_m, [5.0, 0.0, 0.0]);
}

/// The import and the scene agree on what is stretched: this one was taken for a ball, and refused as one.
#[test]
fn a_ball_that_is_stretched_by_less_than_a_millionth_arrives_as_an_instance() {
    for (stretch, instances) in [("1.0000008", 1), ("1.0000001", 0)] {
        let text = format!("WorldBegin\nLightSource \"infinite\"\nScale 1 1 {stretch}\nShape \"sphere\"\n");
        assert_eq!(scene(&imported("pbrt", &text)).instances.len(), instances, "{stretch}");
    }
}
