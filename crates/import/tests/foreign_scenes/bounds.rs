//! Files that ask for far more than they hold: refused with their line, in bounded time and memory.

use std::cell::Cell;

use etalon_import::import_bytes;

use super::{imported, near, refusal};

fn mitsuba(elements: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{elements}\n<shape type=\"sphere\"><ref id=\"m\"/></shape></scene>")
}

#[test]
fn materials_within_themselves_are_refused() {
    for material in [
        "<bsdf type=\"mask\" id=\"m\"><ref id=\"m\"/></bsdf>",
        "<bsdf type=\"twosided\" id=\"m\"><ref id=\"n\"/></bsdf><bsdf type=\"bumpmap\" id=\"n\"><ref id=\"m\"/></bsdf>",
        "<bsdf type=\"blendbsdf\" id=\"m\"><bsdf type=\"diffuse\"/><ref id=\"m\"/></bsdf>",
    ] {
        let why = refusal("xml", &mitsuba(material));
        assert_eq!(why, "line 2: this <bsdf> refers to itself", "{material}");
    }
    let shape = "<bsdf type=\"diffuse\" id=\"m\"/><shape type=\"merge\" id=\"s\">\n<ref id=\"s\"/></shape>";
    assert_eq!(refusal("xml", &mitsuba(shape)), "line 2: this <shape> refers to itself");
    let integrator = "<integrator type=\"stokes\" id=\"i\"><ref id=\"i\"/></integrator>";
    assert_eq!(refusal("xml", &mitsuba(integrator)), "line 2: this <integrator> refers to itself");
}

#[test]
fn long_chains_of_references_are_refused() {
    let chain = |length: usize| {
        let links = (1..length).map(|i| format!("<bsdf type=\"mask\" id=\"m{i}\"><ref id=\"m{}\"/></bsdf>\n", i - 1));
        let last = format!("<bsdf type=\"twosided\" id=\"m\"><ref id=\"m{}\"/></bsdf>", length - 1);
        mitsuba(&format!("<bsdf type=\"diffuse\" id=\"m0\"/>{}{last}", links.collect::<String>()))
    };
    imported("xml", &chain(50));
    let why = refusal("xml", &chain(100_000));
    assert!(why.starts_with("line ") && why.contains("nested more than 64 deep"), "{why}");
}

#[test]
fn materials_that_double_are_shared_up_to_a_limit() {
    let doubling = |levels: usize| {
        let blend = |i: usize| {
            let (id, of) = (if i == levels { "m".to_owned() } else { format!("m{i}") }, i - 1);
            format!("<bsdf type=\"blendbsdf\" id=\"{id}\"><ref id=\"m{of}\"/><ref id=\"m{of}\"/></bsdf>\n")
        };
        mitsuba(&format!("<bsdf type=\"diffuse\" id=\"m0\"/>{}", (1..=levels).map(blend).collect::<String>()))
    };
    assert_eq!(imported("xml", &doubling(9)).text.matches("lambert").count(), 512);
    let why = refusal("xml", &doubling(60));
    assert!(why.starts_with("line 11: a blend of 1024 materials and 10 levels"), "{why}");

    let mix = |levels: usize, other: fn(usize) -> usize| {
        let mix = |i: usize| {
            let (one, two) = (i - 1, other(i));
            format!("MakeNamedMaterial \"m{i}\" \"string type\" \"mix\" \"string materials\" [\"m{one}\" \"m{two}\"]\n")
        };
        let mixes: String = (1..=levels).map(mix).collect();
        format!("WorldBegin MakeNamedMaterial \"m0\"\n{mixes}NamedMaterial \"m{levels}\" Shape \"sphere\"")
    };
    assert!(imported("pbrt", &mix(9, |i| i - 1)).text.matches("lambert").count() >= 512);
    let why = refusal("pbrt", &mix(60, |i| i - 1));
    assert!(why.starts_with("line 11: a blend of 1024 materials and 10 levels"), "{why}");
    let why = refusal("pbrt", &mix(60, |_| 0));
    assert!(why.starts_with("line 34: a blend of 34 materials and 33 levels"), "{why}");
}

#[test]
fn shapes_that_double_are_refused() {
    let merge = |i: usize| {
        let of = i - 1;
        format!("<shape type=\"merge\" id=\"s{i}\"><ref id=\"s{of}\"/><ref id=\"s{of}\"/></shape>\n")
    };
    let shapes: String = (1..50).map(merge).collect();
    let text = format!("<scene version=\"3.0.0\">\n<shape type=\"merge\" id=\"s0\"/>{shapes}</scene>");
    let why = refusal("xml", &text);
    assert!(why.starts_with("line 2: references make more than"), "{why}");
}

#[test]
fn parameters_that_double_are_refused() {
    let double = |i: usize| format!("<default name=\"a{i}\" value=\"$a{of}$a{of}\"/>\n", of = i - 1);
    let text =
        mitsuba(&format!("<default name=\"a0\" value=\"0123456789\"/>{}", (1..60).map(double).collect::<String>()));
    let why = refusal("xml", &text);
    // Parameter n has 10 · 2^n bytes, and those before it as many together.
    assert_eq!(why, "line 21: with $a19 the values of parameters are longer than 16777216 bytes");
}

#[test]
fn a_file_that_is_named_again_is_read_once() {
    let reads = Cell::new(0);
    let counting = |name: &str| {
        reads.set(reads.get() + 1);
        near(name)
    };
    let texture =
        "<texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"chequers.png\"/></texture>";
    let shape = format!("<shape type=\"rectangle\"><bsdf type=\"diffuse\">{texture}</bsdf></shape>\n");
    let text = format!("<scene version=\"3.0.0\">{}</scene>", shape.repeat(100));
    let made = import_bytes("xml", text.as_bytes(), &counting, "", "a").unwrap();
    assert_eq!((reads.get(), made.files.len()), (1, 1));

    reads.set(0);
    let ply = |name: &str| {
        reads.set(reads.get() + 1);
        assert_eq!(name, "a.ply");
        let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
        let faces =
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        Ok(format!("{head}{faces}").into_bytes())
    };
    let text = format!("WorldBegin\n{}", "Shape \"plymesh\" \"string filename\" \"a.ply\"\n".repeat(100));
    let made = import_bytes("pbrt", text.as_bytes(), &ply, "", "a").unwrap();
    assert_eq!((reads.get(), made.files.len()), (1, 1));
}

#[test]
fn what_is_left_out_is_listed_up_to_a_limit_and_then_counted() {
    let text = format!("WorldBegin Shape \"sphere\"\n{}", "Strange 1\n".repeat(5000));
    let made = imported("pbrt", &text);
    assert_eq!(made.left_out.len(), 1001);
    assert_eq!(made.left_out[1000].what, "4000 more things are not listed");
}

#[test]
fn equal_names_are_told_apart_in_linear_time() {
    let text = format!("WorldBegin\n{}Shape \"sphere\"", "MakeNamedMaterial \"a\"\n".repeat(100_000));
    let made = imported("pbrt", &text);
    assert!(made.text.contains("\"a 100000\"") && !made.text.contains("\"a 100001\""));
}
