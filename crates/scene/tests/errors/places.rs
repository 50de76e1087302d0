//! Where things stand, in space and in time: shapes, transforms, groups and keyframes.

use super::*;

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
    one(Severity::Error, Code::NotSimilarity, "$.instances[0]", &grouped(&lamp, stretched));

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
