//! Parameters of a Mitsuba scene, and the folders of its files.

use etalon_import::{Imported, Options, import_bytes_with};

const SCENE: &str = r#"<scene version="3.0.0">
  <default name="spp" value="16"/><default name="red" value="0.5"/>
  <path value="textures"/><path value="more/textures"/>
  <sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
  <shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="$red 0.2 0.1"/></bsdf></shape>
  <shape type="ply"><string name="filename" value="thing.ply"/></shape>
  <emitter type="constant"/>
</scene>"#;

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// With files only where `exists` says.
fn import(scene: &str, given: &[(&str, &str)], exists: &str) -> Result<Imported, String> {
    let near = |name: &str| {
        if name == exists { Ok(PLY.as_bytes().to_vec()) } else { Err(format!("there is no {name}")) }
    };
    let parameters = given.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    import_bytes_with("xml", scene.as_bytes(), &near, "", "scene.xml", &Options { parameters, ..Options::default() })
}

#[test]
fn given_parameters_stand_for_defaults_and_unknown_ones_are_refused() {
    let of = |given: &[(&str, &str)]| import(SCENE, given, "thing.ply").map(|imported| imported.text);
    let plain = of(&[]).unwrap();
    assert!(plain.contains("\"spp\": 16") && plain.contains("0.5"), "{plain}");
    let given = of(&[("spp", "4"), ("spp", "64"), ("red", "0.25")]).unwrap();
    assert!(given.contains("\"spp\": 64") && given.contains("0.25"), "the last of a name counts: {given}");
    let why = of(&[("blue", "1")]).unwrap_err();
    assert!(why.contains("\"blue\"") && why.contains("nothing in the scene"), "{why}");
    // A parameter without a default may be given, too.
    let bare = SCENE.replace(r#"<default name="spp" value="16"/>"#, "");
    assert!(import(&bare, &[], "thing.ply").unwrap_err().contains("$spp"));
    assert!(import(&bare, &[("spp", "4")], "thing.ply").is_ok());
    // Other kinds know nothing of parameters.
    let parameters = vec![("a".to_owned(), "1".to_owned())];
    let near = |_: &str| Err("nothing".to_owned());
    let options = Options { parameters, ..Options::default() };
    let why = import_bytes_with("ply", PLY.as_bytes(), &near, "", "a.ply", &options).unwrap_err();
    assert!(why.contains("only scenes of Mitsuba"), "{why}");
}

#[test]
fn files_are_looked_for_in_the_folders_that_the_scene_names_the_last_one_first() {
    for folder in ["thing.ply", "textures/thing.ply", "more/textures/thing.ply"] {
        let imported = import(SCENE, &[], folder).unwrap();
        assert!(imported.left_out.iter().all(|left_out| !left_out.what.contains("path")), "{:?}", imported.left_out);
    }
    let why = import(SCENE, &[], "elsewhere/thing.ply").unwrap_err();
    assert!(why.contains("thing.ply"), "{why}");
    let many = SCENE.replace(r#"<path value="textures"/>"#, &r#"<path value="a"/>"#.repeat(40));
    assert!(import(&many, &[], "thing.ply").unwrap_err().contains("folders"));
}

/// Tests run in the folder of their package.
#[test]
fn what_is_not_beside_a_scene_is_looked_for_in_the_working_folder() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("elsewhere");
    std::fs::create_dir_all(&folder).unwrap();
    let imported = |name: &str, file: &str| {
        let scene = folder.join(name);
        std::fs::write(&scene, SCENE.replace("thing.ply", file)).unwrap();
        etalon_import::import(&scene, "", &Options::default()).map_err(|error| error.to_string())
    };
    assert_eq!(imported("found.xml", "fuzz\\seeds\\ply\\ascii.ply").unwrap().taken_over.meshes, 1);
    assert!(imported("missing.xml", "fuzz/seeds/ply/none.ply").unwrap_err().contains("cannot be read"));
}
