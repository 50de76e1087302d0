//! Every kind of error: its code, its path and its place, in a file that is right but for that.

mod common;

use common::{Parts, RIGHT};
use etalon_scene::{Code, Problem, Severity};

/// Where `«…»` stands in a text: the text without the marks, and line, column and bytes of what is between them.
fn unmarked(marked: &str) -> (String, usize, usize, std::ops::Range<usize>) {
    let start = marked.find('«').expect("a mark");
    let end = marked.find('»').expect("a closing mark") - '«'.len_utf8();
    let before = &marked[..start];
    let line = before.lines().count().max(1) + usize::from(before.ends_with('\n'));
    let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
    (marked.replace(['«', '»'], ""), line, column, start..end)
}

fn problems(text: &str) -> Vec<Problem> {
    match etalon_scene::parse(text, "test.json") {
        Ok((_, warnings)) => warnings,
        Err(errors) => errors.problems,
    }
}

/// Asserts that a text has exactly one problem, at the marked place.
#[track_caller]
fn one(severity: Severity, code: Code, path: &str, marked: &str) -> Problem {
    let (text, line, column, bytes) = unmarked(marked);
    let found = problems(&text);
    let [problem] = found.as_slice() else { panic!("{} problems, not one: {found:#?}\n{text}", found.len()) };
    assert_eq!((problem.severity, problem.code), (severity, code), "{problem}");
    assert_eq!(problem.json_path, path, "{problem}");
    assert_eq!(problem.span.start..problem.span.end, bytes, "{problem}");
    assert_eq!((problem.line, problem.column), (line, column), "{problem}");
    problem.clone()
}

#[track_caller]
fn error(code: Code, path: &str, parts: Parts<'_>) -> Problem {
    one(Severity::Error, code, path, &parts.text())
}

#[track_caller]
fn hinted(code: Code, path: &str, hint: &str, parts: Parts<'_>) {
    let problem = error(code, path, parts);
    assert!(problem.hint.as_deref().is_some_and(|h| h.contains(hint)), "{problem}");
}

fn objects(objects: &str) -> Parts<'_> {
    Parts { objects, ..RIGHT }
}
fn camera(camera: &str) -> Parts<'_> {
    Parts { camera, ..RIGHT }
}
fn materials(materials: &str) -> Parts<'_> {
    Parts { materials, objects: "[{\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": \"m\"}]", ..RIGHT }
}
fn lights(lights: &str) -> Parts<'_> {
    Parts { lights, ..RIGHT }
}
fn integrator(integrator: &str) -> Parts<'_> {
    Parts { integrator, ..RIGHT }
}

/// An object of a shape, perhaps with a transform.
fn shaped(shape: &str, transform: &str) -> String {
    format!("[{{\"shape\": {shape}, \"material\": \"white\", \"transform\": {transform}}}]")
}

#[test]
fn the_scene_that_the_tests_change_is_right() {
    assert_eq!(problems(&RIGHT.text()), []);
}

#[test]
fn syntax_errors_that_stop_the_parser() {
    for (marked, path) in [
        ("«»", "$"),
        ("   \n", "$"),
        ("{\"etalon\": 1, «]»", "$"),
        ("«{»\"etalon\": 1", "$"),
        ("{\"etalon\": «:» 1}", "$"),
        ("{\"etalon\": 1} «{»}", "$"),
        ("{\"etalon\": «nul»}", "$"),
        ("{\"etalon\" «1»}", "$"),
        ("{\"etalon\": «\"»abc\n}", "$"),
    ] {
        let found = problems(&marked.replace(['«', '»'], ""));
        assert_eq!(found.len(), 1, "{marked}: {found:#?}");
        assert_eq!((found[0].code, found[0].json_path.as_str()), (Code::Syntax, path), "{marked}");
        if marked.contains('«') {
            let (_, line, column, bytes) = unmarked(marked);
            assert_eq!((found[0].line, found[0].column), (line, column), "{marked}: {}", found[0]);
            assert_eq!(found[0].span.start, bytes.start, "{marked}: {}", found[0]);
        }
    }
}

#[test]
fn liberties_with_json_are_errors_and_hide_nothing() {
    for (integrator, message) in [
        ("{\"spp\": 4«,»}", "comma after the last"),
        ("{\"spp\": 4 «/* why */»}", "no comments"),
        ("{\"spp\": 4} «// why»", "no comments"),
        ("{\"spp\": 4«» \"seed\": 1}", "comma is missing"),
        ("{«spp»: 4}", "key without quotes"),
        ("{«'spp'»: 4}", "single quotes"),
        ("{\"spp\": «0x10»}", "hexadecimal"),
        ("{\"spp\": «+4»}", "starts with +"),
        ("{\"spp\": «4.»}", "after its point"),
        ("{\"wavelength_range_nm\": [«.4e3», 700]}", "starts with its point"),
        ("{\"wavelength_range_nm\": [«0400», 700]}", "needless 0"),
        ("{\"comment\": \"a«\\x»41\"}", "escape"),
        ("{\"comment\": \"a«\t»b\"}", "control character"),
        ("{\"comment\":«\u{a0}»\"\"}", "blank"),
    ] {
        let problem = error_anywhere(Code::Syntax, integrator);
        assert!(problem.message.contains(message), "{problem}");
        if integrator.contains("0400") {
            // The only one that leaves nothing to go on with.
            continue;
        }
        // A second error, of meaning, must come along.
        let both =
            Parts {
                integrator: &integrator.replace(['«', '»'], ""), film: "{\"width\": -1, \"height\": 1}", ..RIGHT
            };
        let codes: Vec<Code> = problems(&both.text()).iter().map(|p| p.code).collect();
        assert_eq!(codes, [Code::OutOfRange, Code::Syntax], "{integrator}");
    }
    for spelling in ["NaN", "-Infinity"] {
        error_anywhere(Code::NotFinite, &format!("{{\"wavelength_range_nm\": [«{spelling}», 700]}}"));
    }
}

/// One error in the integrator, of which only code and place count.
#[track_caller]
fn error_anywhere(code: Code, integrator: &str) -> Problem {
    let (text, line, column, bytes) = unmarked(&Parts { integrator, ..RIGHT }.text());
    let found = problems(&text);
    let [problem] = found.as_slice() else { panic!("{integrator}: {found:#?}") };
    assert_eq!((problem.code, problem.line, problem.column), (code, line, column), "{problem}");
    assert_eq!(problem.span.start..problem.span.end, bytes, "{problem}");
    problem.clone()
}

#[test]
fn two_errors_of_syntax_come_together() {
    let text = Parts { integrator: "{\"spp\": 4,}", lights: "[] /* none */", ..RIGHT }.text();
    let codes: Vec<Code> = problems(&text).iter().map(|p| p.code).collect();
    assert_eq!(codes, [Code::NoLight, Code::Syntax, Code::Syntax]);
}

#[test]
fn depth_is_limited() {
    let deep = format!("{}«[»{}", "[".repeat(64), "]".repeat(65));
    let (text, ..) = unmarked(&deep);
    let found = problems(&text);
    assert_eq!((found.len(), found[0].code, found[0].column), (1, Code::Limit, 65));
    // However deep: no stack is used up.
    assert_eq!(problems(&"[".repeat(1_000_000))[0].code, Code::Limit);
    assert_eq!(problems(&"{\"a\":".repeat(1_000_000))[0].code, Code::Limit);
    // Comments hide brackets from the count; the parser has a bound of its own.
    assert!(!problems(&format!("/*\"*/{}", "[".repeat(1_000_000))).is_empty());
}

#[test]
fn length_is_limited() {
    let found = problems(&" ".repeat(etalon_scene::json::MAX_BYTES + 1));
    assert_eq!((found.len(), found[0].code), (1, Code::Limit));
}

#[test]
fn at_most_a_thousand_problems_are_kept_and_the_rest_counted() {
    let many = format!("[{}0]", "1, ".repeat(4999));
    let found = problems(&Parts { objects: &many, ..RIGHT }.text());
    assert_eq!(found.len(), etalon_scene::json::MAX_PROBLEMS + 1);
    let last = found.last().expect("one");
    assert_eq!((last.code, last.message.as_str()), (Code::Limit, "4000 more errors are not shown"));
}

#[test]
fn another_version() {
    error(Code::Version, "$.etalon", Parts { etalon: "«2»", ..RIGHT });
    error(Code::WrongType, "$.etalon", Parts { etalon: "«\"1\"»", ..RIGHT });
}

#[test]
fn missing_keys() {
    let problem = error(Code::MissingKey, "$.film", Parts { film: "«{»\"width\": 3}", ..RIGHT });
    assert_eq!(problem.hint.as_deref(), Some("\"height\": Height, pixels"));
    error(Code::MissingKey, "$.objects[0]", objects("[«{»\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}}]"));
    hinted(
        Code::MissingKey,
        "$.lights[0]",
        "\"point\"",
        lights(
            "[{\"type\": \"environment\", \"radiance\": 1}, «{»}]"
                .replace("{\"type\": \"environment\", \"radiance\": 1}, ", "")
                .as_str(),
        ),
    );
    let found = problems("{}");
    let missing: Vec<&str> = found.iter().map(|p| p.message.as_str()).collect();
    assert_eq!(missing, ["missing key \"etalon\"", "missing key \"camera\"", "missing key \"film\""]);
}

#[test]
fn unknown_keys_and_what_was_meant() {
    hinted(
        Code::UnknownKey,
        "$.objects[0].shape.raduis_m",
        "\"radius_m\"",
        objects("[{\"shape\": {\"type\": \"sphere\", «\"raduis_m\"»: 1}, \"material\": \"white\"}]"),
    );
    hinted(
        Code::UnknownKey,
        "$.film.depth",
        "\"width\", \"height\", \"filter\"",
        Parts { film: "{\"width\": 1, \"height\": 1, «\"depth\"»: 3}", ..RIGHT },
    );
    hinted(
        Code::UnknownKey,
        "$.film[\"wid th\"]",
        "there already",
        Parts { film: "{\"width\": 1, \"height\": 1, «\"wid th\"»: 3}", ..RIGHT },
    );
    hinted(
        Code::UnknownKey,
        "$.objects[0].shape.Type",
        "\"type\"",
        objects("[{\"shape\": {«\"Type\"»: \"sphere\", \"radius_m\": 1}, \"material\": \"white\"}]"),
    );
    // Another variant's key.
    error(
        Code::UnknownKey,
        "$.camera.vertical_fov_deg",
        camera(
            "{\"type\": \"orthographic\", \"position_m\": [0,0,1], \"look_at_m\": [0,0,0], \"height_m\": 1, «\"vertical_fov_deg\"»: 3}",
        ),
    );
}

#[test]
fn what_a_misspelt_key_holds_is_checked_too() {
    let text = objects("[{\"shape\": {\"tpye\": \"sphere\", \"raduis_m\": -1}, \"material\": \"white\"}]").text();
    let codes: Vec<Code> = problems(&text).iter().map(|p| p.code).collect();
    assert_eq!(codes, [Code::UnknownKey, Code::UnknownKey, Code::OutOfRange]);
}

#[test]
fn duplicate_keys() {
    let problem = error(
        Code::DuplicateKey,
        "$.film.width",
        Parts { film: "{\"width\": 1, \"height\": 1, «\"width\"»: 3}", ..RIGHT },
    );
    let related = problem.related.expect("the first");
    assert_eq!((related.line, related.column, related.label.as_str()), (4, 10, "first here"));
    error(Code::DuplicateKey, "$.spectra.grey", Parts { spectra: "{\"grey\": 0.5, «\"grey\"»: 0.1}", ..RIGHT });
    error(Code::DuplicateKey, "$.materials.m", materials("{\"m\": {\"type\": \"black\"}, «\"m\"»: 3}"));
}

#[test]
fn wrong_types() {
    error(Code::WrongType, "$.film.width", Parts { film: "{\"width\": «[]», \"height\": 1}", ..RIGHT });
    hinted(
        Code::WrongType,
        "$.film.width",
        "remove the quotes",
        Parts { film: "{\"width\": «\"64\"», \"height\": 1}", ..RIGHT },
    );
    hinted(Code::WrongType, "$.integrator.seed", "leave the key out", integrator("{\"seed\": «null»}"));
    error(Code::WrongType, "$.integrator.roulette", integrator("{\"roulette\": «1»}"));
    error(Code::WrongType, "$.objects", objects("«{}»"));
    error(Code::WrongType, "$.objects[0]", objects("[«7»]"));
    error(
        Code::WrongType,
        "$.objects[0].name",
        objects("[{\"name\": «7», \"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": \"white\"}]"),
    );
    error(
        Code::WrongType,
        "$.objects[0].material",
        objects("[{\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": «true»}]"),
    );
    error(Code::WrongType, "$.lights[0].radiance", lights("[{\"type\": \"environment\", \"radiance\": «[1]»}]"));
    error(
        Code::WrongType,
        "$.materials.m.interior",
        materials("{\"m\": {\"type\": \"dielectric\", \"interior\": «[]»}}"),
    );
    error(Code::WrongType, "$.materials", Parts { materials: "«[]»", objects: "[]", ..RIGHT });
    assert_eq!(problems("[]")[0].json_path, "$");
}

#[test]
fn wrong_lengths() {
    error(
        Code::WrongLength,
        "$.camera.position_m",
        camera(
            "{\"type\": \"perspective\", \"position_m\": «[»0, 5], \"look_at_m\": [0, 0, 0], \"vertical_fov_deg\": 40}",
        ),
    );
    error(
        Code::WrongLength,
        "$.lights[0].radiance",
        lights(
            "[{\"type\": \"environment\", \"radiance\": «{»\"type\": \"tabulated\", \"wavelengths_nm\": [300, 900], \"values\": [1]}}]",
        ),
    );
    error(
        Code::WrongLength,
        "$.lights[0].radiance",
        lights(
            "[{\"type\": \"environment\", \"radiance\": «{»\"type\": \"tabulated\", \"wavelengths_nm\": [300], \"values\": [1], \"outside\": \"zero\"}}]",
        ),
    );
    error(
        Code::WrongLength,
        "$.materials.m.interior",
        materials(
            "{\"m\": {\"type\": \"dielectric\", \"interior\": «{»\"type\": \"sellmeier\", \"b\": [1, 2], \"c_um2\": [0.01], \"range_nm\": [300, 900]}}}",
        ),
    );
    error(
        Code::WrongLength,
        "$.materials.m",
        materials("{\"m\": «{»\"type\": \"conductor\", \"wavelengths_nm\": [300, 900], \"n\": [1, 1], \"k\": [3]}}"),
    );
}

#[test]
fn numbers_that_are_not_finite() {
    error(Code::NotFinite, "$.lights[0].radiance", lights("[{\"type\": \"environment\", \"radiance\": «1e999»}]"));
    error(
        Code::NotFinite,
        "$.objects[0].shape.vertices_m[1][2]",
        objects(&shaped(
            "{\"type\": \"mesh\", \"vertices_m\": [[0,0,0],[1,0,«-1e400»],[0,1,0]], \"triangles\": [[0,1,2]]}",
            "[]",
        )),
    );
}

#[test]
fn numbers_out_of_range() {
    for (film, path) in [
        ("{\"width\": «0», \"height\": 1}", "$.film.width"),
        ("{\"width\": «1.5», \"height\": 1}", "$.film.width"),
        ("{\"width\": 1, \"height\": «70000»}", "$.film.height"),
        ("{\"width\": 65536, \"height\": «65536»}", "$.film.height"),
        (
            "{\"width\": 1, \"height\": 1, \"filter\": {\"type\": \"tent\", \"radius_px\": «0»}}",
            "$.film.filter.radius_px",
        ),
        (
            "{\"width\": 1, \"height\": 1, \"filter\": {\"type\": \"gaussian\", \"sigma_px\": «-1»}}",
            "$.film.filter.sigma_px",
        ),
    ] {
        error(Code::OutOfRange, path, Parts { film, ..RIGHT });
    }
    for (text, path) in [
        ("{\"spp\": «0»}", "$.integrator.spp"),
        ("{\"seed\": «-1»}", "$.integrator.seed"),
        ("{\"seed\": «18446744073709551616»}", "$.integrator.seed"),
        ("{\"max_depth\": «0»}", "$.integrator.max_depth"),
        ("{\"wavelength_range_nm\": «[700, 400]»}", "$.integrator.wavelength_range_nm"),
        ("{\"wavelength_range_nm\": [«0», 400]}", "$.integrator.wavelength_range_nm[0]"),
    ] {
        error(Code::OutOfRange, path, integrator(text));
    }
    error(
        Code::OutOfRange,
        "$.objects[0].shape.radius_m",
        objects(&shaped("{\"type\": \"sphere\", \"radius_m\": «-2»}", "[]")),
    );
    error(
        Code::OutOfRange,
        "$.camera.vertical_fov_deg",
        camera(
            "{\"type\": \"perspective\", \"position_m\": [0, 0, 5], \"look_at_m\": [0, 0, 0], \"vertical_fov_deg\": «180»}",
        ),
    );
    error(
        Code::OutOfRange,
        "$.materials.m.interior",
        materials("{\"m\": {\"type\": \"dielectric\", \"interior\": «0»}}"),
    );
    error(
        Code::OutOfRange,
        "$.spectra.grey.wavelengths_nm[1]",
        Parts {
            spectra: "{\"grey\": {\"type\": \"tabulated\", \"wavelengths_nm\": [300, «200», 900], \"values\": [0, 0, 0]}}",
            ..RIGHT
        },
    );
    // No index between the resonances of this formula.
    error(
        Code::OutOfRange,
        "$.materials.m.interior",
        materials(
            "{\"m\": {\"type\": \"dielectric\", \"interior\": «{»\"type\": \"sellmeier\", \"b\": [1], \"c_um2\": [0.25], \"range_nm\": [300, 900]}}}",
        ),
    );
    error(
        Code::OutOfRange,
        "$.materials.m.interior.range_nm",
        materials(
            "{\"m\": {\"type\": \"dielectric\", \"interior\": {\"type\": \"cauchy\", \"a\": 1.5, \"range_nm\": «[900, 300]»}}}",
        ),
    );
    error(
        Code::OutOfRange,
        "$.lights[0].radiance",
        lights("[{\"type\": \"environment\", \"radiance\": «{»\"type\": \"blackbody\", \"temperature_k\": 1e200}}]"),
    );
    error(
        Code::OutOfRange,
        "$.objects[0]",
        objects(&shaped("{\"type\": \"sphere\", \"radius_m\": 1}", "[{\"scale\": 1e200}]").replacen('{', "«{»", 1)),
    );
    error(
        Code::OutOfRange,
        "$.objects[0]",
        objects(&shaped("{\"type\": \"sphere\", \"radius_m\": 1e-200}", "[]").replacen('{', "«{»", 1)),
    );
}

#[test]
fn words_that_cannot_stand_there() {
    hinted(Code::UnknownWord, "$.integrator.sampler", "\"sobol\"", integrator("{\"sampler\": «\"Sobol'\"»}"));
    hinted(
        Code::UnknownWord,
        "$.integrator.sampler",
        "\"sobol\", \"independent\"",
        integrator("{\"sampler\": «\"halton\"»}"),
    );
    hinted(
        Code::UnknownWord,
        "$.objects[0].shape.type",
        "\"sphere\"",
        objects(&shaped("{\"type\": «\"shpere\"», \"radius_m\": 1}", "[]")),
    );
    hinted(
        Code::UnknownWord,
        "$.lights[0].type",
        "\"directional\"",
        lights("[{\"type\": «\"laser\"», \"radiance\": 1}]"),
    );
    error(Code::WrongType, "$.lights[0].type", lights("[{\"type\": «4», \"radiance\": 1}]"));
}

#[test]
fn names_that_nothing_defines() {
    let object = |material: &str| {
        format!("[{{\"shape\": {{\"type\": \"sphere\", \"radius_m\": 1}}, \"material\": {material}}}]")
    };
    hinted(Code::UnknownName, "$.objects[0].material", "\"white\"", objects(&object("«\"whit\"»")));
    hinted(
        Code::UnknownName,
        "$.objects[0].material",
        "\"materials\" at the top",
        Parts { materials: "{}", ..objects(&object("«\"whit\"»")) },
    );
    hinted(
        Code::UnknownName,
        "$.lights[0].radiance",
        "\"grey\"",
        lights("[{\"type\": \"environment\", \"radiance\": «\"gray\"»}]"),
    );
    hinted(
        Code::UnknownName,
        "$.spectra.a",
        "\"grey\"",
        Parts { spectra: "{\"grey\": 0.5, \"a\": «\"garey\"»}", ..RIGHT },
    );
    hinted(
        Code::UnknownName,
        "$.materials.m.interior",
        "\"N-BK7\"",
        materials("{\"m\": {\"type\": \"dielectric\", \"interior\": «\"n-bk7\"»}}"),
    );
    hinted(
        Code::UnknownName,
        "$.materials.m.metal",
        "\"Au\"",
        materials("{\"m\": {\"type\": \"conductor\", \"metal\": «\"gold\"»}}"),
    );
    hinted(
        Code::UnknownName,
        "$.materials.m.metal",
        "\"Ag\", \"Au\"",
        materials("{\"m\": {\"type\": \"conductor\", \"metal\": «\"unobtainium\"»}}"),
    );
}

#[test]
fn spectra_in_a_circle() {
    error(Code::Circular, "$.spectra.me", Parts { spectra: "{\"grey\": 0.5, «\"me\"»: \"me\"}", ..RIGHT });
    // Whoever leads into a circle is not in it: both members are reported, and only they matter.
    let found = problems(&Parts { spectra: "{\"grey\": \"b\", \"b\": \"c\", \"c\": \"b\"}", ..RIGHT }.text());
    assert!(found.iter().all(|p| p.code == Code::Circular) && found.len() >= 2, "{found:#?}");
}

#[test]
fn keys_that_go_together() {
    let view = |rest: &str| format!("{{\"type\": \"perspective\", \"position_m\": [0, 0, 5], {rest}}}");
    error(
        Code::KeyConflict,
        "$.camera.direction",
        camera(&view("\"look_at_m\": [0, 0, 0], «\"direction\"»: [0, 0, -1], \"vertical_fov_deg\": 40")),
    );
    error(
        Code::KeyConflict,
        "$.camera.horizontal_fov_deg",
        camera(&view("\"look_at_m\": [0, 0, 0], «\"horizontal_fov_deg\"»: 40, \"vertical_fov_deg\": 40")),
    );
    error(Code::MissingKey, "$.camera", camera(&view("\"vertical_fov_deg\": 40").replacen('{', "«{»", 1)));
    error(Code::MissingKey, "$.camera", camera(&view("\"look_at_m\": [0, 0, 0]").replacen('{', "«{»", 1)));
    error(
        Code::MissingKey,
        "$.camera.sensor_height_m",
        camera(&view("\"look_at_m\": [0, 0, 0], «\"sensor_height_m\"»: 0.024")),
    );
    let lens = |rest: &str| view(&format!("\"look_at_m\": [0, 0, 0], \"vertical_fov_deg\": 40, \"lens\": {rest}"));
    error(
        Code::KeyConflict,
        "$.camera.lens.f_number",
        camera(
            &lens("{\"radius_m\": 0, «\"f_number\"»: 2, \"focus_distance_m\": 5}")
                .replace("40,", "40, \"focal_length_m\": 0.05,"),
        ),
    );
    error(Code::MissingKey, "$.camera.lens", camera(&lens("«{»\"focus_distance_m\": 5}")));
    error(Code::MissingKey, "$.camera.lens.f_number", camera(&lens("{\"f_number\": «2», \"focus_distance_m\": 5}")));
    error(
        Code::OutOfRange,
        "$.camera.lens.focus_distance_m",
        camera(&view(
            "\"look_at_m\": [0, 0, 0], \"focal_length_m\": 0.05, \"sensor_width_m\": 0.036, \"lens\": {\"f_number\": 2, \"focus_distance_m\": «0.05»}",
        )),
    );
    error(
        Code::KeyConflict,
        "$.objects[0].transform[0].scale",
        objects(&shaped("{\"type\": \"sphere\", \"radius_m\": 1}", "[{\"translate_m\": [0, 0, 1], «\"scale\"»: 2}]")),
    );
    error(
        Code::MissingKey,
        "$.objects[0].transform[0]",
        objects(&shaped("{\"type\": \"sphere\", \"radius_m\": 1}", "[«{»}]")),
    );
    error(
        Code::KeyConflict,
        "$.materials.m.wavelengths_nm",
        materials(
            "{\"m\": {\"type\": \"conductor\", \"metal\": \"Au\", «\"wavelengths_nm\"»: [300, 900], \"n\": [1, 1], \"k\": [1, 1]}}",
        ),
    );
    error(
        Code::MissingKey,
        "$.materials.m.wavelengths_nm",
        materials("{\"m\": {\"type\": \"conductor\", «\"wavelengths_nm\"»: [300, 900], \"n\": [1, 1]}}"),
    );
    error(
        Code::KeyConflict,
        "$.materials.m.reflectance.white",
        materials(
            "{\"m\": {\"type\": \"lambert\", \"reflectance\": {\"type\": \"rgb\", \"rgb\": [1, 0, 0], \"white\": «\"E\"»}}}",
        ),
    );
}

#[test]
fn vectors_without_direction_and_degenerate_views() {
    error(
        Code::ZeroVector,
        "$.lights[0].direction",
        lights("[{\"type\": \"directional\", \"direction\": «[0, 0, 0]», \"irradiance\": 1}]"),
    );
    error(
        Code::ZeroVector,
        "$.objects[0].shape.normal",
        objects(&shaped("{\"type\": \"disk\", \"normal\": «[0, -0.0, 0]», \"radius_m\": 1}", "[]")),
    );
    error(
        Code::ZeroVector,
        "$.objects[0].transform[0].rotate.axis",
        objects(&shaped(
            "{\"type\": \"sphere\", \"radius_m\": 1}",
            "[{\"rotate\": {\"axis\": «[0, 0, 0]», \"angle_deg\": 9}}]",
        )),
    );
    error(
        Code::DegenerateView,
        "$.camera.look_at_m",
        camera(
            "{\"type\": \"perspective\", \"position_m\": [1, 2, 3], \"look_at_m\": «[1, 2, 3]», \"vertical_fov_deg\": 40}",
        ),
    );
    error(
        Code::DegenerateView,
        "$.camera.up",
        camera(
            "{\"type\": \"orthographic\", \"position_m\": [1, 2, 3], \"direction\": [0, 0, -1], \"up\": «[0, 0, 5]», \"height_m\": 1}",
        ),
    );
    // The default `up` has no place of its own: the camera has.
    error(
        Code::DegenerateView,
        "$.camera",
        camera(
            "«{»\"type\": \"orthographic\", \"position_m\": [1, 2, 3], \"direction\": [0, 1e-9, 0], \"height_m\": 1}",
        ),
    );
}

#[test]
fn degenerate_shapes_and_transforms() {
    error(
        Code::DegenerateShape,
        "$.objects[0].shape",
        objects(&shaped(
            "«{»\"type\": \"parallelogram\", \"origin_m\": [0,0,0], \"u_m\": [1, 2, 3], \"v_m\": [-2, -4, -6]}",
            "[]",
        )),
    );
    error(
        Code::DegenerateShape,
        "$.objects[0].shape",
        objects(&shaped(
            "«{»\"type\": \"parallelogram\", \"origin_m\": [0,0,0], \"u_m\": [0, 0, 0], \"v_m\": [1, 0, 0]}",
            "[]",
        )),
    );
    error(
        Code::DegenerateShape,
        "$.objects[0].shape.max_m",
        objects(&shaped("{\"type\": \"box\", \"min_m\": [0,0,0], \"max_m\": «[1, 0, 1]»}", "[]")),
    );
    let sphere = "{\"type\": \"sphere\", \"radius_m\": 1}";
    error(Code::SingularTransform, "$.objects[0].transform[0].scale", objects(&shaped(sphere, "[{\"scale\": «0»}]")));
    error(
        Code::SingularTransform,
        "$.objects[0].transform[0].scale",
        objects(&shaped(sphere, "[{\"scale\": «[1, 0, 1]»}]")),
    );
    error(
        Code::SingularTransform,
        "$.objects[0].transform[0].matrix",
        objects(&shaped(sphere, "[{\"matrix\": «[[1, 2, 3, 0], [2, 4, 6, 0], [0, 0, 1, 0]]»}]")),
    );
    // Each step is sound, the product has underflowed.
    error(
        Code::SingularTransform,
        "$.objects[0].transform",
        objects(&shaped(sphere, "«[»{\"scale\": 1e-200}, {\"scale\": 1e-200}]")),
    );
    error(Code::NotSimilarity, "$.objects[0].transform", objects(&shaped(sphere, "«[»{\"scale\": [1, 2, 1]}]")));
    error(
        Code::NotSimilarity,
        "$.objects[0].transform",
        objects(&shaped(
            "{\"type\": \"disk\", \"normal\": [0, 0, 1], \"radius_m\": 1}",
            "«[»{\"matrix\": [[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]}]",
        )),
    );
}

#[test]
fn similarities_may_mirror_and_be_written_with_seven_digits() {
    for transform in [
        "[{\"scale\": [-2, 2, 2]}]",
        "[{\"scale\": -1e-9}, {\"rotate\": {\"axis\": [1, 2, 3], \"angle_deg\": 77}}]",
        "[{\"matrix\": [[0.7071068, -0.7071068, 0, 3], [0.7071068, 0.7071068, 0, 0], [0, 0, -1, 0]]}]",
    ] {
        assert_eq!(problems(&objects(&shaped("{\"type\": \"sphere\", \"radius_m\": 1}", transform)).text()), []);
    }
}

#[test]
fn meshes() {
    let mesh = |vertices: &str, triangles: &str| {
        shaped(&format!("{{\"type\": \"mesh\", \"vertices_m\": {vertices}, \"triangles\": {triangles}}}"), "[]")
    };
    let square = "[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]";
    let problem =
        error(Code::IndexOutOfRange, "$.objects[0].shape.triangles[1]", objects(&mesh(square, "[[0,1,2],«[0,2,4]»]")));
    assert_eq!(problem.hint.as_deref(), Some("the mesh has 4, counted from 0 to 3"));
    error(Code::OutOfRange, "$.objects[0].shape.triangles[0][2]", objects(&mesh(square, "[[0,1,«-1»]]")));
    error(
        Code::EmptyMesh,
        "$.objects[0].shape",
        objects(&mesh(square, "[]").replace("{\"type\": \"mesh\"", "«{»\"type\": \"mesh\"")),
    );
    error(
        Code::EmptyMesh,
        "$.objects[0].shape",
        objects(&mesh(square, "[[0,1,1]]").replace("{\"type\": \"mesh\"", "«{»\"type\": \"mesh\"")),
    );
    let problem = one(
        Severity::Warning,
        Code::DegenerateTriangles,
        "$.objects[0].shape",
        &objects(
            &mesh("[[0,0,0],[1,0,0],[1,1,0],[3,0,0]]", "[[0,1,2],[0,1,3],[2,2,0]]")
                .replace("{\"type\": \"mesh\"", "«{»\"type\": \"mesh\""),
        )
        .text(),
    );
    assert_eq!(problem.message, "2 of the 3 triangles of objects[0] have no area and were dropped at load");
    // An error in one triangle hides none in another.
    let found = problems(&objects(&mesh(square, "[[0,1,9],[0,\"1\",2],[8,1,2]]")).text());
    let codes: Vec<Code> = found.iter().map(|p| p.code).collect();
    assert_eq!(codes, [Code::IndexOutOfRange, Code::WrongType, Code::IndexOutOfRange]);
}

#[test]
fn reflectances_and_emissions() {
    error(
        Code::Reflectance,
        "$.materials.m.reflectance",
        materials("{\"m\": {\"type\": \"lambert\", \"reflectance\": «1.5»}}"),
    );
    error(
        Code::Reflectance,
        "$.materials.m.reflectance",
        materials("{\"m\": {\"type\": \"mirror\", \"reflectance\": «-0.1»}}"),
    );
    error(
        Code::Reflectance,
        "$.materials.m.reflectance.rgb[1]",
        materials("{\"m\": {\"type\": \"lambert\", \"reflectance\": {\"type\": \"rgb\", \"rgb\": [0, «2», 0]}}}"),
    );
    error(
        Code::Reflectance,
        "$.materials.m.reflectance.values[1]",
        materials(
            "{\"m\": {\"type\": \"lambert\", \"reflectance\": {\"type\": \"tabulated\", \"wavelengths_nm\": [300, 900], \"values\": [0.1, «0.6»], \"scale\": 2}}}",
        ),
    );
    error(
        Code::Reflectance,
        "$.materials.m.reflectance",
        materials("{\"m\": {\"type\": \"lambert\", \"reflectance\": «{»\"type\": \"illuminant\", \"name\": \"E\"}}}"),
    );
    error(
        Code::Reflectance,
        "$.materials.m.reflectance",
        materials(
            "{\"m\": {\"type\": \"lambert\", \"reflectance\": «{»\"type\": \"blackbody\", \"temperature_k\": 300}}}",
        ),
    );
    error(Code::NegativeEmission, "$.lights[0].radiance", lights("[{\"type\": \"environment\", \"radiance\": «-1»}]"));
    error(
        Code::NegativeEmission,
        "$.lights[0].radiance.rgb[2]",
        lights("[{\"type\": \"environment\", \"radiance\": {\"type\": \"rgb\", \"rgb\": [1, 1, «-1e-9»]}}]"),
    );
}

#[test]
fn a_named_spectrum_is_blamed_once_and_where_it_is_written() {
    let problem = error(
        Code::Reflectance,
        "$.spectra.grey",
        Parts {
            spectra: "{\"grey\": «1.5»}",
            materials: "{\"white\": {\"type\": \"lambert\", \"reflectance\": \"grey\"}, \"other\": {\"type\": \"mirror\", \"reflectance\": \"grey\"}}",
            lights: "[{\"type\": \"environment\", \"radiance\": \"grey\"}]",
            ..RIGHT
        },
    );
    let related = problem.related.expect("the use");
    assert_eq!((related.line, related.label.as_str()), (6, "used here"));
}

#[test]
fn wavelengths_outside_what_is_known() {
    let problem = error(
        Code::OutsideFit,
        "$.materials.m.interior",
        materials("{\"m\": {\"type\": \"dielectric\", \"interior\": «\"diamond\"»}}"),
    );
    assert_eq!(problem.message, "diamond is known from 226 to 760 nm only, and 360 to 830 nm are rendered");
    error(
        Code::OutsideFit,
        "$.materials.m.exterior",
        materials(
            "{\"m\": {\"type\": \"dielectric\", \"interior\": 1.5, \"exterior\": «{»\"type\": \"cauchy\", \"a\": 1.4, \"range_nm\": [400, 900]}}}",
        ),
    );
    error(
        Code::OutsideFit,
        "$.materials.m",
        materials("{\"m\": «{»\"type\": \"conductor\", \"wavelengths_nm\": [400, 900], \"n\": [1, 1], \"k\": [1, 1]}}"),
    );
    error(
        Code::OutsideFit,
        "$.lights[0].radiance",
        lights(
            "[{\"type\": \"environment\", \"radiance\": «{»\"type\": \"tabulated\", \"wavelengths_nm\": [400, 700], \"values\": [1, 1]}}]",
        ),
    );
    let within = Parts {
        integrator: "{\"wavelength_range_nm\": [400, 700]}",
        ..materials("{\"m\": {\"type\": \"dielectric\", \"interior\": \"diamond\"}}")
    };
    assert_eq!(problems(&within.text()), []);
    let clamped = materials(
        "{\"m\": {\"type\": \"dielectric\", \"interior\": {\"type\": \"glass\", \"name\": \"diamond\", \"outside_fit\": \"clamp\"}}}",
    );
    assert_eq!(problems(&clamped.text()), []);
    // D65 ends at 830 nm; and no eye sees beyond.
    let infrared = Parts {
        integrator: "{\"wavelength_range_nm\": [400, 900]}",
        ..lights("[{\"type\": \"environment\", \"radiance\": {\"type\": \"illuminant\", \"name\": \"D65\"}}]")
    };
    let codes: Vec<Code> = problems(&infrared.text()).iter().map(|p| p.code).collect();
    assert_eq!(codes, [Code::OutsideFit, Code::InvisibleWavelengths]);
}

#[test]
fn odd_scenes_are_warned_about() {
    one(Severity::Warning, Code::NoObjects, "$.objects", &objects("«[»]").text());
    let dark = lights("[]").text();
    one(Severity::Warning, Code::NoLight, "$", &dark.replacen('{', "«{»", 1));
    let zero = lights("[{\"type\": \"environment\", \"radiance\": 0}]").text();
    one(Severity::Warning, Code::NoLight, "$", &zero.replacen('{', "«{»", 1));
    one(
        Severity::Warning,
        Code::InvisibleWavelengths,
        "$.integrator.wavelength_range_nm",
        &integrator("{\"wavelength_range_nm\": «[300, 700]»}").text(),
    );
}

#[test]
fn columns_count_characters_and_lines_end_in_any_way() {
    let problem =
        &problems("{\"comment\": \"äöü€𝄞\", \"etalon\": 2}").into_iter().find(|p| p.code == Code::Version).expect("it");
    assert_eq!((problem.line, problem.column), (1, 32));
    for end in ["\n", "\r\n", "\r"] {
        let text = format!("{{{end}{end}  \"etalon\": 2}}");
        let problem = problems(&text).into_iter().find(|p| p.code == Code::Version).expect("it");
        assert_eq!((problem.line, problem.column), (3, 13), "{end:?}");
    }
    // A byte order mark is not part of the text.
    let marked = format!("\u{feff}{}", RIGHT.text());
    assert_eq!(problems(&marked), []);
}

#[test]
fn messages_for_a_terminal() {
    let errors = etalon_scene::parse("{\"etalon\": 2}", "room.json").expect_err("wrong");
    assert_eq!(errors.summary(), "room.json: 3 errors");
    let lines: Vec<String> = errors.to_string().lines().map(str::to_owned).collect();
    assert_eq!(lines[0], "room.json: 3 errors");
    assert_eq!(
        lines[3],
        "room.json:1:12: error[version]: $.etalon: version 2 of the format is not known (this program reads 1)"
    );
}
