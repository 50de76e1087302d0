//! Names, vectors, shapes, spectra; and warnings.

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
fn degenerate_shapes_and_transforms() {
    error(
        Code::DegenerateShape,
        "$.objects[0].shape",
        objects(&shaped(
            "«{»\"type\": \"cylinder\", \"start_m\": [1, 2, 3], \"end_m\": [1, 2, 3], \"radius_m\": 1}",
            "[]",
        )),
    );
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

/// The right scene with groups and instances.
fn grouped(groups: &str, instances: &str) -> String {
    let placed = format!("{{\n\"groups\": {groups},\n\"instances\": {instances},");
    RIGHT.text().replacen('{', &placed, 1)
}

#[test]
fn groups_and_instances() {
    let ball = "{\"objects\": [{\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": \"white\"}]}";
    let lamp = "{\"objects\": [{\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": \"white\", \
                \"emission\": {\"radiance\": 1}}]}";
    let refused =
        |groups: &str, instances: &str, code, path: &str| one(Severity::Error, code, path, &grouped(groups, instances));
    let balls = format!("{{\"ball\": {ball}}}");
    refused(&balls, "[{\"group\": «\"bal\"»}]", Code::UnknownName, "$.instances[0].group");
    refused(&balls, "[«{»}]", Code::MissingKey, "$.instances[0]");
    refused(&balls, "[{\"group\": \"ball\", \"transforms\": «[»]}]", Code::WrongLength, "$.instances[0].transforms");
    refused(
        &balls,
        "[{\"group\": \"ball\", \"transform\": [], \"transforms\": «[»[]]}]",
        Code::KeyConflict,
        "$.instances[0].transforms",
    );
    refused(
        &balls,
        "[{\"group\": \"ball\", \"transform\": [{\"scale\": «[1, 0, 1]»}]}]",
        Code::SingularTransform,
        "$.instances[0].transform[0].scale",
    );
    refused(
        &balls,
        "[{\"group\": \"ball\", \"transforms\": [[], [{\"matrix\": «[[1,0,0,0],[2,0,0,0],[0,0,1,0]]»}]]}]",
        Code::SingularTransform,
        "$.instances[0].transforms[1][0].matrix",
    );
    // A stretched ball is an ellipsoid; a stretched lamp is refused, also where a group within stretches it.
    assert_eq!(problems(&grouped(&balls, "[{\"group\": \"ball\", \"transform\": [{\"scale\": [1, 2, 3]}]}]")), []);
    let lamps = format!("{{\"lamp\": {lamp}, \"pair\": {{\"instances\": [{{\"group\": \"lamp\"}}]}}}}");
    for group in ["lamp", "pair"] {
        let stretched = format!("[«{{»\"group\": \"{group}\", \"transform\": [{{\"scale\": [1, 2, 3]}}]}}]");
        refused(&lamps, &stretched, Code::NotSimilarity, "$.instances[0]");
    }
    // In a circle, or too many.
    refused(
        "{\"a\": {\"instances\": [{\"group\": \"b\"}]}, \"b\": {\"instances\": [{\"group\": «\"a\"»}]}}",
        "[]",
        Code::Circular,
        "$.groups.b.instances[0].group",
    );
    let nest = |count: usize, width: usize| {
        let placed = |i: usize| vec![format!("{{\"group\": \"g{}\"}}", i - 1); width].join(", ");
        let groups = (1..count).map(|i| format!("\"g{i}\": {{\"instances\": [{}]}}", placed(i)));
        let all: Vec<String> = std::iter::once(format!("\"g0\": {ball}")).chain(groups).collect();
        format!("{{{}}}", all.join(", "))
    };
    assert_eq!(problems(&grouped(&nest(16, 1), "[{\"group\": \"g15\"}]")), []);
    refused(&nest(17, 1), "[«{»\"group\": \"g16\"}]", Code::Limit, "$.instances[0]");
    refused(&nest(16, 8), "[«{»\"group\": \"g15\"}]", Code::Limit, "$.instances[0]");
    // What is wrong within a group is told like anything else.
    let text = grouped(&balls.replace("\"radius_m\": 1", "\"radius_m\": «-1»"), "[]");
    one(Severity::Error, Code::OutOfRange, "$.groups.ball.objects[0].shape.radius_m", &text);
}

#[test]
fn keyframes_and_shutters() {
    let ball =
        "{\"ball\": {\"objects\": [{\"shape\": {\"type\": \"sphere\", \"radius_m\": 1}, \"material\": \"white\"}]}}";
    let placed = |rest: &str| format!("[{{\"group\": \"ball\", {rest}}}]");
    let refused = |rest: &str, code, path: &str| {
        one(Severity::Error, code, &format!("$.instances[0].{path}"), &grouped(ball, &placed(rest)))
    };
    refused("\"keyframes\": «[»]", Code::WrongLength, "keyframes");
    refused("\"keyframes\": [«{»\"transform\": []}]", Code::MissingKey, "keyframes[0]");
    refused("\"transform\": [], \"keyframes\": «[»{\"time_s\": 0}]", Code::KeyConflict, "keyframes");
    refused("\"transforms\": [[]], \"keyframes\": «[»{\"time_s\": 0}]", Code::KeyConflict, "keyframes");
    let second = |key: &str| format!("\"keyframes\": [{{\"time_s\": 0}}, «{{»{key}}}]");
    refused(&second("\"time_s\": 0"), Code::OutOfRange, "keyframes[1]");
    refused(&second("\"time_s\": 1e-320"), Code::OutOfRange, "keyframes[1]");
    refused(&second("\"time_s\": 1, \"transform\": [{\"scale\": -2}]"), Code::Motion, "keyframes[1]");
    let half_turn = "\"time_s\": 1, \"transform\": [{\"rotate\": {\"axis\": [1, 2, 3], \"angle_deg\": -180}}]";
    let problem = refused(&second(half_turn), Code::Motion, "keyframes[1]");
    assert!(problem.hint.is_some_and(|hint| hint.contains("between")));
    let nearly = half_turn.replace("-180", "179.99");
    assert_eq!(problems(&grouped(ball, &placed(&second(&nearly).replace(['«', '»'], "")))), []);
    refused(
        "\"keyframes\": [{\"time_s\": 0, \"transform\": [{\"scale\": «0»}]}]",
        Code::SingularTransform,
        "keyframes[0].transform[0].scale",
    );
    // A lamp that is stretched on the way.
    let lamp = ball.replace("\"material\"", "\"emission\": {\"radiance\": 1}, \"material\"");
    let stretched = "[«{»\"group\": \"ball\", \"keyframes\": [{\"time_s\": 0}, {\"time_s\": 1, \"transform\": [{\"scale\": [1, 2, 1]}]}]}]";
    // Only where the shutter sees it.
    assert_eq!(problems(&grouped(&lamp, &stretched.replace(['«', '»'], ""))), []);
    let open = |text: String| text.replacen("\"look_at_m\"", "\"shutter_s\": [0, 1], \"look_at_m\"", 1);
    one(Severity::Error, Code::NotSimilarity, "$.instances[0]", &open(grouped(&lamp, stretched)));

    let eye = |rest: &str| {
        format!(
            "{{\"type\": \"perspective\", \"position_m\": [0, 0, 5], \"look_at_m\": [0, 0, 0], \"vertical_fov_deg\": 40, {rest}}}"
        )
    };
    error(Code::OutOfRange, "$.camera.shutter_s", camera(&eye("\"shutter_s\": «[1, 0]»")));
    error(Code::WrongLength, "$.camera.shutter_s", camera(&eye("\"shutter_s\": «[»1]")));
    let steps = |step: &str| format!("\"keyframes\": [{{\"time_s\": 0, \"transform\": «[»{step}]}}]");
    for step in ["{\"scale\": 2}", "{\"scale\": [1, 1, 1.1]}", "{\"scale\": -1}"] {
        error(Code::NotSimilarity, "$.camera.keyframes[0].transform", camera(&eye(&steps(step))));
    }
}
