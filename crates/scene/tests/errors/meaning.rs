//! Names, vectors, spectra; and warnings.

use super::*;

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
    // The same corners begun at another one, or at other vertices of the same place, are the same triangle; turned the other
    // way they are its other side.
    let again = "[[0,1,2],[1,2,0],[0,2,1],[0,1,3],[0,4,2]]";
    let problem = one(
        Severity::Warning,
        Code::RepeatedTriangles,
        "$.objects[0].shape",
        &objects(
            &mesh("[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[1,-0.0,0]]", again)
                .replace("{\"type\": \"mesh\"", "«{»\"type\": \"mesh\""),
        )
        .text(),
    );
    assert_eq!(problem.message, "2 of the 5 triangles of objects[0] repeat others and were dropped at load");
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
fn sheets_that_give_back_more_than_they_receive() {
    let image = |factor: f64| format!("{{\"type\": \"image\", \"file\": \"chequers.png\", \"factor\": {factor}}}");
    let found = |reflectance: &str, transmittance: &str| {
        let keys =
            format!("\"type\": \"translucent\", \"reflectance\": {reflectance}, \"transmittance\": {transmittance}");
        let errors = problems(&materials(&format!("{{\"m\": {{{keys}}}}}")).text());
        errors.into_iter().map(|p| (p.code, p.json_path, p.message)).collect::<Vec<_>>()
    };
    assert_eq!(found("0.5", "0.5"), []);
    let step = |low: f64, high: f64| {
        format!(
            "{{\"type\": \"tabulated\", \"wavelengths_nm\": [360, 500, 501, 830], \"values\": [{low}, {low}, {high}, {high}]}}"
        )
    };
    assert_eq!(found(&step(0.25, 0.75), &step(0.75, 0.25)), []);
    for (reflectance, transmittance, sum) in
        [("0.5".to_owned(), "0.625".to_owned(), "1.1250"), (step(0.25, 0.75), step(0.25, 0.5), "1.2500")]
    {
        let found = found(&reflectance, &transmittance);
        let [(Code::OutOfRange, path, message)] = &found[..] else { panic!("one error: {found:?}") };
        assert!(path == "$.materials.m" && message.contains(sum), "{path}: {message}");
    }
    // The image is not there, and nothing is said of its texels.
    assert!(found(&image(1.0), "0.5").iter().all(|(code, ..)| *code != Code::OutOfRange));
}

#[test]
fn surfaces_that_fluoresce() {
    let material = |keys: &str| materials(&format!("{{\"m\": {{\"type\": \"fluorescent\", {keys}}}}}")).text();
    let dye = |keys: &str| material(&format!("\"fluorophores\": [{{{keys}}}]"));
    let found =
        |text: String| problems(&text).into_iter().map(|p| (p.code, p.json_path, p.message)).collect::<Vec<_>>();
    // A perfect dye and a white surface: what is reflected and what comes back are more than came in.
    let bright = "\"reflectance\": 0.6, \"fluorophores\": [{\"absorption\": 0.9, \"emission\": 1}]";
    let [(code, path, message)] = &found(material(bright))[..] else { panic!("one error") };
    assert!(*code == Code::OutOfRange && path == "$.materials.m", "{path}");
    assert!(message.contains("830 nm") && message.contains("0.6000 reflected"), "{message}");
    let of = |text: String, code: Code, path: &str| {
        let found = found(text);
        assert!(found.iter().any(|(c, p, _)| *c == code && p == path), "{found:?}");
    };
    of(dye("\"absorption\": 0.5, \"emission\": 0"), Code::OutOfRange, "$.materials.m.fluorophores[0]");
    of(dye("\"absorption\": 1.5, \"emission\": 1"), Code::Reflectance, "$.materials.m.fluorophores[0].absorption");
    of(
        dye("\"absorption\": 0.5, \"emission\": 1, \"quantum_yield\": 2"),
        Code::OutOfRange,
        "$.materials.m.fluorophores[0].quantum_yield",
    );
    of(material("\"fluorophores\": []"), Code::WrongLength, "$.materials.m.fluorophores");
    of(material("\"reflectance\": 0.5"), Code::MissingKey, "$.materials.m");
    let matrix = |rows: &str| {
        material(&format!(
            "\"reradiation\": {{\"excitation_nm\": [400, 500], \"emission_nm\": [500, 600], \"per_nm\": {rows}}}"
        ))
    };
    assert_eq!(found(matrix("[[0.001, 0], [0, 0.001]]")), []);
    of(matrix("[[0.001, 0], [0]]"), Code::OutOfRange, "$.materials.m.reradiation");
    of(matrix("[[0.001, 0], [0, -1]]"), Code::OutOfRange, "$.materials.m.reradiation.per_nm[1][1]");
    of(matrix("[[0.1, 0.1], [0.1, 0.1]]"), Code::OutOfRange, "$.materials.m");
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
    assert_eq!(problem.message, "diamond covers only 226 to 760 nm, but the scene renders 360 to 830 nm");
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
fn a_schema_that_is_not_beside_the_scene_is_mentioned_once() {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests"));
    let warnings = |schema: &str, folder| {
        let text = RIGHT.text().replacen('{', &format!("{{\"$schema\": \"{schema}\", "), 1);
        etalon_scene::parse_in(&text, "test.json", folder, None).unwrap().warnings
    };
    let found = warnings("missing.schema.json", Some(folder));
    let [problem] = found.as_slice() else { panic!("one warning: {found:?}") };
    assert_eq!((problem.code, problem.json_path.as_str()), (Code::NoSchema, "$[\"$schema\"]"));
    assert!(problem.hint.as_ref().is_some_and(|hint| hint.contains("etalon schema > missing.schema.json")));
    // A file that is there, the address of a page, and a scene without a folder.
    assert_eq!(warnings("common/everything.json", Some(folder)), []);
    assert_eq!(warnings("schemas://etalon/1", Some(folder)), []);
    assert_eq!(warnings("missing.schema.json", None), []);
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
