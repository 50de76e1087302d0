//! Media: what fills bodies and the space around them.

use etalon_scene::{MaterialKind, Medium, MediumDensity, PhaseFunction, Scene};

use super::{imported, said, scene};

/// The medium of an object.
fn within(scene: &Scene, object: usize) -> &Medium {
    scene.materials[scene.objects[object].material].medium.as_ref().expect("it has a medium")
}

/// Absorption and scattering at a wavelength.
fn coefficients(medium: &Medium, nm: f64) -> [f64; 2] {
    [medium.absorption.eval(nm), medium.scattering.eval(nm)]
}

fn near(found: [f64; 2], known: [f64; 2]) {
    assert!((0..2).all(|k| (found[k] - known[k]).abs() < 1e-12), "{found:?} is not {known:?}");
}

/// What is around the camera ends at a boundary that has it inside and nothing outside. Other surfaces in it do not matter.
#[test]
fn fog_of_pbrt_around_the_camera_ends_at_the_boundary_of_its_body() {
    let of = |outside: &str| {
        let text = format!(
            "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"float sigma_a\" 1\nMediumInterface \"\" \"fog\"\n\
             Camera \"perspective\"\nWorldBegin\nShape \"sphere\" \"float radius\" 0.1\n\
             MediumInterface \"fog\" \"{outside}\"\nMaterial \"interface\"\nShape \"sphere\""
        );
        scene(&imported("pbrt", &text)).medium.is_some()
    };
    assert_eq!(["", "fog"].map(of), [false, true]);
}

#[test]
fn media_of_mitsuba_arrive() {
    let text = r#"<scene version="3.0.0">
  <sensor type="perspective"><ref name="medium" id="haze"/></sensor>
  <medium type="homogeneous" id="haze"><float name="albedo" value="0.5"/><float name="sigma_t" value="0.02"/></medium>
  <shape type="sphere"><bsdf type="null"/>
    <medium name="interior" type="homogeneous"><float name="albedo" value="0.8"/><float name="sigma_t" value="2"/><float name="scale" value="3"/>
      <phase type="hg"><float name="g" value="0.6"/></phase></medium></shape>
  <shape type="sphere"><bsdf type="dielectric"><float name="int_ior" value="1.4"/><float name="ext_ior" value="1"/></bsdf>
    <medium name="interior" type="homogeneous"><spectrum name="albedo" value="400:0.5, 700:1"/><spectrum name="sigma_t" value="400:2, 700:4"/>
      <phase type="blendphase"><float name="weight" value="0.25"/><phase type="hg"><float name="g" value="0.9"/></phase><phase type="isotropic"/></phase>
    </medium></shape>
  <shape type="cube"><bsdf type="null"/>
    <medium name="interior" type="heterogeneous"><float name="scale" value="5"/><float name="albedo" value="1"/>
      <volume name="sigma_t" type="gridvolume"><string name="filename" value="smoke.vol"/>
        <transform name="to_world"><scale value="2"/></transform></volume>
      <phase type="tabphase"><string name="values" value="1, 2, 5"/></phase></medium></shape>
  <shape type="sphere"><bsdf type="diffuse"/><ref name="interior" id="haze"/></shape>
</scene>"#;
    let imported = imported("xml", text);
    let scene = scene(&imported);
    near(coefficients(scene.medium.as_ref().expect("haze"), 500.0), [0.01, 0.01]);
    let fog = within(&scene, 0);
    assert_eq!(scene.materials[scene.objects[0].material].kind, MaterialKind::Boundary { priority: None });
    near(coefficients(fog, 500.0), [6.0 * 0.2, 6.0 * 0.8]);
    assert_eq!(fog.phase, PhaseFunction::HenyeyGreenstein { g: 0.6 });
    let glass = within(&scene, 1);
    let kind = &scene.materials[scene.objects[1].material].kind;
    assert!(matches!(kind, MaterialKind::Dielectric { priority: None, .. }), "{kind:?}");
    near(coefficients(glass, 550.0), [0.75, 2.25]);
    assert_eq!(glass.phase, PhaseFunction::DoubleHenyeyGreenstein { g: [0.9, 0.0], weight: 0.75 });
    let smoke = within(&scene, 2);
    near(coefficients(smoke, 550.0), [0.0, 5.0]);
    let MediumDensity::Grid(grid) = &smoke.density else { panic!("{:?}", smoke.density) };
    assert_eq!((grid.cells, grid.box_m), ([1, 1, 2], [[0.0; 3], [1.0; 3]]));
    assert_eq!((&grid.values[..], grid.transform.linear[0][0]), (&[0.5, 1.5][..], 2.0));
    let PhaseFunction::Tabulated(table) = &smoke.phase else { panic!("{:?}", smoke.phase) };
    // Backward is first there: −1, 0 and 1 are the cosines.
    assert_eq!(table.values, [1.0, 2.0, 5.0]);
    assert!((table.cosines[0], table.cosines[2]) == (-1.0, 1.0) && table.cosines[1].abs() < 1e-15, "{table:?}");
    // Nothing of it comes out of a body that lets no light in.
    assert!(scene.materials[scene.objects[3].material].medium.is_none());
    assert_eq!(said(&imported), Vec::<String>::new());
}

/// What lets light in, or may be met from within, holds its medium.
#[test]
fn bodies_that_are_neither_glass_nor_null_hold_their_media() {
    let medium = r#"<medium name="interior" type="homogeneous"><float name="albedo" value="0.5"/><float name="sigma_t" value="3"/></medium>"#;
    let bodies = [
        (r#"<bsdf type="principled"><float name="spec_trans" value="0.5"/></bsdf>"#, true),
        (r#"<bsdf type="blendbsdf"><bsdf type="dielectric"/><bsdf type="diffuse"/></bsdf>"#, true),
        (r#"<bsdf type="thindielectric"/>"#, true),
        (r#"<bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="diffuse"/></bsdf>"#, true),
        (r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#, true),
        (r#"<bsdf type="principled"><float name="metallic" value="0.5"/></bsdf>"#, false),
        (r#"<bsdf type="roughplastic"/>"#, false),
    ];
    for (bsdf, holds) in bodies {
        let text = format!(
            r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="sphere">{bsdf}{medium}</shape></scene>"#
        );
        let imported = imported("xml", &text);
        let scene = scene(&imported);
        let found = scene.materials[scene.objects[0].material].medium.is_some();
        assert_eq!(found, holds, "{bsdf}");
        assert!(said(&imported).iter().all(|what| !what.contains("medium")), "{:?}", said(&imported));
        if holds {
            near(coefficients(within(&scene, 0), 500.0), [1.5, 1.5]);
        }
    }
    let sheet =
        format!(r#"<scene version="3.0.0"><shape type="rectangle"><bsdf type="polarizer"/>{medium}</shape></scene>"#);
    let imported = imported("xml", &sheet);
    scene(&imported);
    assert!(said(&imported).iter().any(|what| what.contains("medium of a polarising sheet")), "{:?}", said(&imported));
}

/// Mitsuba's integrators for media do not count the way through a pane as an edge. Without a limit on edges that changes nothing.
#[test]
fn a_limit_on_depth_that_does_not_count_panes_stays_one() {
    for (integrator, depth, bsdf, counts) in [
        ("volpath", "6", "thindielectric", false),
        ("volpathmis", "6", "polarizer", false),
        ("path", "6", "thindielectric", true),
        ("volpath", "-1", "thindielectric", true),
        ("volpath", "6", "dielectric", true),
    ] {
        let text = format!(
            r#"<scene version="3.0.0"><integrator type="{integrator}"><integer name="max_depth" value="{depth}"/></integrator>
<sensor type="perspective"/><shape type="sphere"><bsdf type="{bsdf}"/></shape></scene>"#
        );
        assert_eq!(scene(&imported("xml", &text)).integrator.count_panes, counts, "{integrator} {depth} {bsdf}");
    }
}

/// A heterogeneous medium ends where its volume does, which is the box from 0 to 1, even if it is the same everywhere in it.
#[test]
fn a_volume_that_is_the_same_everywhere_ends_at_its_box() {
    let of = |stated: &str| {
        let text = format!(
            r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="sphere"><bsdf type="null"/>
  <medium name="interior" type="heterogeneous"><float name="albedo" value="0.5"/>{stated}</medium></shape></scene>"#
        );
        let imported = imported("xml", &text);
        let scene = scene(&imported);
        let medium = within(&scene, 0);
        near(coefficients(medium, 500.0), [1.5, 1.5]);
        let MediumDensity::Grid(grid) = &medium.density else { panic!("{:?}", medium.density) };
        assert_eq!((grid.box_m, grid.values.iter().all(|value| *value == 1.0)), ([[0.0; 3], [1.0; 3]], true));
        grid.transform.linear[0][0]
    };
    assert_eq!(of(r#"<float name="sigma_t" value="3"/>"#), 1.0);
    let volume = r#"<volume name="sigma_t" type="constvolume"><float name="value" value="3"/>
      <transform name="to_world"><scale value="2"/></transform></volume>"#;
    assert_eq!(of(volume), 2.0);
}

/// Two cells, (0.75, 0.375, 0) and (0.375, 0.375, 0): each has the mean of its channels, 0.375 and 0.25. The grid has the colour of their
/// mean, (1.8, 1.2, 0). As an albedo it keeps both.
#[test]
fn grids_of_colours_keep_their_density_and_their_mean_colour() {
    let of = |albedo: &str| {
        format!(
            r#"<scene version="3.0.0"><sensor type="perspective"/><shape type="cube"><bsdf type="null"/>
  <medium name="interior" type="heterogeneous"><float name="scale" value="2"/>{albedo}
    <volume name="sigma_t" type="gridvolume"><string name="filename" value="coloured.vol"/></volume></medium></shape></scene>"#
        )
    };
    let first = imported("xml", &of(r#"<float name="albedo" value="1"/>"#));
    let scattering = scene(&first);
    let medium = within(&scattering, 0);
    // Channels in the other order would make it blue.
    let extinction = |nm| coefficients(medium, nm)[1];
    assert!(extinction(650.0) > 4.0 * extinction(450.0), "{} {}", extinction(650.0), extinction(450.0));
    let MediumDensity::Grid(grid) = &medium.density else { panic!("{:?}", medium.density) };
    assert_eq!((grid.cells, &grid.values[..]), ([1, 1, 2], &[0.375, 0.25][..]));
    assert!(said(&first).iter().any(|what| what.contains("keeps one colour")), "{:?}", said(&first));
    let albedo = r#"<volume name="albedo" type="gridvolume"><string name="filename" value="coloured.vol"/></volume>"#;
    let second = imported("xml", &of(albedo));
    let second = scene(&second);
    let medium = within(&second, 0);
    // All of it is scattered, but for what the grid says.
    assert_eq!(coefficients(medium, 650.0)[1], extinction(650.0));
    let grid = medium.albedo.as_ref().expect("a grid of albedos");
    assert_eq!((grid.cells, &grid.values[..]), ([1, 1, 2], &[0.75, 0.375, 0.0, 0.375, 0.375, 0.0][..]));
    let plain = of(albedo).replace("heterogeneous", "homogeneous").replace(
        "gridvolume\"><string name=\"filename\" value=\"coloured.vol\"/></volume></medium>",
        "constvolume\"><float name=\"value\" value=\"1\"/></volume></medium>",
    );
    assert!(within(&scene(&imported("xml", &plain)), 0).albedo.is_some(), "of a homogeneous medium, too");
}

#[test]
fn media_of_pbrt_arrive() {
    let text = r#"MakeNamedMedium "haze" "string type" "homogeneous" "float sigma_a" 0.25 "float sigma_s" 0.5 "float g" -0.3
MediumInterface "" "haze"
Camera "perspective"
WorldBegin
MakeNamedMedium "smoke" "string type" "uniformgrid" "integer nx" 2 "integer ny" 1 "integer nz" 1 "float density" [ 0.5 1 ]
  "point3 p0" [ 0 0 0 ] "point3 p1" [ 2 1 1 ] "float sigma_a" 0 "float sigma_s" 4 "float scale" 0.5
AttributeBegin
MediumInterface "smoke" "haze"
Material "interface"
Shape "sphere"
AttributeEnd
AttributeBegin
MediumInterface "smoke" ""
Material "dielectric" "float eta" 1.33
Shape "sphere"
AttributeEnd
"#;
    let imported = imported("pbrt", text);
    let scene = scene(&imported);
    let haze = scene.medium.as_ref().expect("haze");
    near(coefficients(haze, 500.0), [0.25, 0.5]);
    assert_eq!(haze.phase, PhaseFunction::HenyeyGreenstein { g: -0.3 });
    for object in 0..2 {
        let smoke = within(&scene, object);
        near(coefficients(smoke, 500.0), [0.0, 2.0]);
        let MediumDensity::Grid(grid) = &smoke.density else { panic!("{:?}", smoke.density) };
        // A layer of empty cells is around it.
        assert_eq!((grid.cells, grid.box_m), ([4, 3, 3], [[-1.0; 3], [3.0, 2.0, 2.0]]));
        let filled: Vec<(usize, f32)> = grid.values.iter().copied().enumerate().filter(|(_, v)| *v != 0.0).collect();
        assert_eq!(filled, [(17, 0.5), (18, 1.0)]);
        // The world is mirrored, as its camera does not.
        assert_eq!(grid.transform.linear[0][0], -1.0);
    }
    assert_eq!(scene.materials[scene.objects[0].material].kind, MaterialKind::Boundary { priority: None });
    let said = said(&imported);
    assert!(said.len() == 1 && said[0].contains("pbrt cuts it off"), "{said:?}");
}

/// A sensor has one medium, with a name or without.
#[test]
fn a_medium_that_a_sensor_refers_to_is_around_all_bodies() {
    for stated in [r#"<ref id="fog"/>"#, r#"<ref name="medium" id="fog"/>"#] {
        let text = format!(
            r#"<scene version="3.0.0"><medium type="homogeneous" id="fog"><float name="sigma_t" value="2"/></medium>
<sensor type="perspective">{stated}</sensor><shape type="sphere"/></scene>"#
        );
        let imported = imported("xml", &text);
        let around = scene(&imported).medium.unwrap_or_else(|| panic!("{stated}"));
        near(coefficients(&around, 500.0), [0.5, 1.5]);
        assert!(said(&imported).is_empty(), "{:?}", said(&imported));
    }
}
