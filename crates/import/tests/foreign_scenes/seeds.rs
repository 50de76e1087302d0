//! The inputs from which fuzzing begins: they reach the readers that they are made for.

use etalon_import::{Imported, import_bytes};

use super::{said, scene};

/// A scene and the file that it names, which follows the first byte 0xff.
fn seed(bytes: &[u8]) -> Imported {
    let end = bytes.iter().position(|byte| *byte == 0xff).expect("a file follows the scene");
    let near = |_: &str| Ok(bytes[end + 1..].to_vec());
    import_bytes("xml", &bytes[..end], &near, "", "a").unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn seeds_with_meshes_and_grids_are_read_to_their_end() {
    let meshes = seed(include_bytes!("../../fuzz/seeds/mitsuba/serialized.xml"));
    assert_eq!((said(&meshes), scene(&meshes).objects.len(), meshes.files.len()), (Vec::new(), 1, 1));
    let grids = seed(include_bytes!("../../fuzz/seeds/mitsuba/volume.xml"));
    assert_eq!((said(&grids), scene(&grids).objects.len(), grids.files.len()), (Vec::new(), 2, 2));
}
