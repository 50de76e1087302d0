//! Keys, types, words and ranges.

use super::*;

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
        ("{\"width\": 1, \"height\": 1, \"filter\": {\"type\": \"mitchell\", \"c\": «1.5»}}", "$.film.filter.c"),
        ("{\"width\": 1, \"height\": 1, \"filter\": {\"type\": \"lanczos\", \"lobes\": «17»}}", "$.film.filter.lobes"),
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
        "$.lights[0]",
        lights(
            "[«{»\"type\": \"beam\", \"position_m\": [0, 3, 0], \"direction\": [0, -1, 0], \"radius_m\": 1e-200, \"power\": 1}]",
        ),
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
        integrator("{\"sampler\": «\"lattice\"»}"),
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
        lights("[{\"type\": «\"aurora\"», \"radiance\": 1}]"),
    );
    error(Code::WrongType, "$.lights[0].type", lights("[{\"type\": «4», \"radiance\": 1}]"));
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
fn a_priority_replaces_the_exterior() {
    error(
        Code::KeyConflict,
        "$.objects[0].material.priority",
        objects(
            "[{\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": {\"type\": \"dielectric\", \"interior\": 1.5, \
             \"exterior\": 1.33, «\"priority\"»: 2}}]",
        ),
    );
}

#[test]
fn a_medium_outside_needs_both_sides_stated() {
    let medium = "{\"absorption_per_m\": 1}";
    error(
        Code::KeyConflict,
        "$.materials.m.priority",
        materials(&format!(
            "{{\"m\": {{\"type\": \"dielectric\", \"interior\": 1.5, \"exterior_medium\": {medium}, «\"priority\"»: 2}}}}"
        )),
    );
    error(
        Code::KeyConflict,
        "$.materials.m",
        materials(&format!(
            "{{\"m\": «{{»\"type\": \"blend\", \"weight\": 0.5, \"first\": {{\"type\": \"black\"}}, \"second\": {{\"type\": \"dielectric\", \
             \"interior\": 1.5, \"exterior_medium\": {medium}}}}}}}"
        )),
    );
}

#[test]
fn words_of_other_programs() {
    let word = Code::UnknownWord;
    hinted(
        word,
        "$.materials.m.type",
        "\"lambert\"",
        materials("{\"m\": {\"type\": «\"diffuse\"», \"reflectance\": 1}}"),
    );
    hinted(
        word,
        "$.materials.m.type",
        "\"dielectric\"",
        materials("{\"m\": {\"type\": «\"glass\"», \"interior\": 1.5}}"),
    );
    hinted(
        word,
        "$.materials.m.type",
        "\"principled\"",
        materials("{\"m\": {\"type\": «\"disney\"», \"reflectance\": 0.5}}"),
    );
    let rectangle = "{\"type\": «\"rectangle\"», \"origin_m\": [0,0,0], \"u_m\": [1,0,0], \"v_m\": [0,1,0]}";
    hinted(word, "$.objects[0].shape.type", "\"parallelogram\"", objects(&shaped(rectangle, "[]")));
    let mesh = "{\"type\": «\"obj\"», \"vertices_m\": [[0,0,0],[1,0,0],[0,1,0]], \"triangles\": [[0,1,2]]}";
    hinted(word, "$.objects[0].shape.type", "\"mesh\"", objects(&shaped(mesh, "[]")));
    hinted(word, "$.lights[0].type", "\"environment\"", lights("[{\"type\": «\"envmap\"», \"radiance\": 1}]"));
    hinted(word, "$.lights[0].type", "\"emission\"", lights("[{\"type\": «\"area\"», \"radiance\": 1}]"));
    let fov = "{\"type\": \"perspective\", \"position_m\": [0, 0, 5], \"look_at_m\": [0, 0, 0], «\"yfov\"»: 40}";
    hinted(Code::UnknownKey, "$.camera.yfov", "\"vertical_fov_deg\"", camera(fov));
    let medium = "{\"m\": {\"type\": \"dielectric\", \"interior\": «\"BK7\"»}}";
    hinted(Code::UnknownName, "$.materials.m.interior", "\"N-BK7\"", materials(medium));
    let fov = fov.replace(['«', '»'], "").replace("yfov", "fov");
    let found = problems(&camera(&fov).text());
    let unknown = found.iter().find(|problem| problem.code == Code::UnknownKey).expect("a hint");
    assert_eq!(unknown.hint.as_deref(), Some("use \"vertical_fov_deg\" or \"horizontal_fov_deg\""));
}

#[test]
fn a_list_is_no_spectrum() {
    let reflectance = |value: &str| format!("{{\"m\": {{\"type\": \"lambert\", \"reflectance\": {value}}}}}");
    let path = "$.materials.m.reflectance";
    let hint = "a colour is {\"type\": \"rgb\", \"rgb\": [0.8, 0.2, 0]}";
    hinted(Code::WrongType, path, hint, materials(&reflectance("«[0.8, 0.2, 0]»")));
    // sRGB 188 is half of white.
    let hint = "from 0 to 255, write {\"type\": \"rgb\", \"rgb\": [1, 0.5029, 0]}";
    hinted(Code::WrongType, path, hint, materials(&reflectance("«[255, 188, 0]»")));
    hinted(Code::WrongType, path, "\"tabulated\"", materials(&reflectance("«[[400, 0.5], [700, 0.5]]»")));
    let rgb = materials(&reflectance("{\"type\": \"rgb\", \"rgb\": [«255», 188, 0]}")).text();
    let found = problems(&rgb.replace(['«', '»'], ""));
    assert_eq!(found[0].json_path, "$.materials.m.reflectance.rgb[0]");
    assert!(found[0].hint.as_deref().is_some_and(|given| given.contains(hint)), "{found:#?}");
}
