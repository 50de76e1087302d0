//! Scenes that are damaged: refused with their line, never a panic.

use super::{MITSUBA, PBRT, near, refusal};
use etalon_import::import_bytes;
use proptest::prelude::*;

#[test]
fn a_damaged_mitsuba_scene_is_refused_with_its_line() {
    for (text, part) in [
        (
            "<scene version=\"3.0.0\">\n<shape type=\"sphere\"><float name=\"radius\" value=\"x\"/></shape></scene>",
            "line 2: \"x\" is not a number",
        ),
        (
            "<scene version=\"3.0.0\">\n<shape type=\"sphere\"><ref id=\"gone\"/></shape></scene>",
            "line 2: nothing has the id \"gone\"",
        ),
        ("<scene version=\"3.0.0\">\n<shape type=\"$kind\"/></scene>", "line 2: no <default> gives $kind a value"),
        (
            "<scene version=\"3.0.0\"><shape type=\"obj\"><string name=\"filename\" value=\"b.obj\"/></shape></scene>",
            "\"b.obj\" cannot be read",
        ),
        ("<scene version=\"3.0.0\"><include filename=\"itself.xml\"/></scene>", "more than"),
        ("<scene version=\"3.0.0\"></scene>", "it has no surfaces"),
        ("<scene>", "the root node was opened but never closed"),
        ("<world/>", "<world> is not a Mitsuba scene"),
    ] {
        let why = refusal("xml", text);
        assert!(why.contains(part), "{text}: {why}");
    }
}

#[test]
fn a_damaged_pbrt_scene_is_refused_with_its_line() {
    for (text, part) in [
        ("WorldBegin\nShape \"sphere\" \"float radius\" [ 1 2 ]", "line 2: \"radius\" is not one number"),
        ("WorldBegin\nTranslate 1 2", "line 2: 3 numbers should follow"),
        ("WorldBegin\nShape \"sphere", "line 2: a quote is not closed"),
        ("WorldBegin\nAttributeEnd", "line 2: this end has no matching begin"),
        ("WorldBegin\nNamedMaterial \"x\"", "line 2: there is no material \"x\""),
        (
            "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 7 ]",
            "index 7",
        ),
        ("WorldBegin\nShape \"plymesh\" \"string filename\" \"b.ply\"", "\"b.ply\" cannot be read"),
        ("Include \"itself.pbrt\"", "more than 64"),
        ("WorldBegin", "it has no surfaces"),
        ("WorldBegin\nObjectBegin \"a\"", "is not ended"),
    ] {
        let why = refusal("pbrt", text);
        assert!(why.contains(part), "{text}: {why}");
    }
}

/// Changes some bytes of a text, so that it stays text.
fn changed(text: &str, at: usize, with: [u8; 3]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    let at = at % (bytes.len() - 3);
    let letters = b" \"[]<>/=.-019aexyz$#\n";
    for (byte, w) in bytes[at..at + 3].iter_mut().zip(with) {
        *byte = letters[w as usize % letters.len()];
    }
    String::from_utf8(bytes).unwrap_or_default()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_change_of_letters_makes_an_import_panic(at in 0_usize..8000, with in any::<[u8; 3]>(), xml in any::<bool>()) {
        let (kind, text) = if xml { ("xml", MITSUBA) } else { ("pbrt", PBRT) };
        if let Ok(imported) = import_bytes(kind, changed(text, at, with).as_bytes(), &near, "", "a") {
            let _ = imported.parse("a", None);
        }
    }
}
