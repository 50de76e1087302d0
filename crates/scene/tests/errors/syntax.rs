//! Texts that are not JSON, and places in a text.

use super::*;

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
        ("{\"spp\": «4.»}", "after the decimal point"),
        ("{\"wavelength_range_nm\": [«.4e3», 700]}", "starts with the decimal point"),
        ("{\"wavelength_range_nm\": [«0400», 700]}", "needless 0"),
        ("{\"comment\": \"a«\\x»41\"}", "escape"),
        ("{\"comment\": \"a«\t»b\"}", "control character"),
        ("{\"comment\":«\u{a0}»\"\"}", "space character"),
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
fn some_dozens_of_problems_are_kept_and_the_rest_counted() {
    use etalon_scene::json::MAX_PROBLEMS;
    let many = format!("[{}0]", "1, ".repeat(4999));
    let found = problems(&Parts { objects: &many, ..RIGHT }.text());
    assert_eq!(found.len(), MAX_PROBLEMS + 1);
    let last = found.last().expect("one");
    let message = format!("{} more errors are not shown", 5000 - MAX_PROBLEMS);
    assert_eq!((last.code, last.message.as_str()), (Code::Limit, message.as_str()));
}

#[test]
fn messages_are_short_however_long_the_names_are() {
    let long = "ä".repeat(1_000_000);
    let text = Parts { objects: &format!("[{{\"{long}\": 1, \"material\": \"{long}\"}}]"), ..RIGHT }.text();
    for problem in problems(&text) {
        let words = problem.to_string();
        assert!(words.chars().count() < 2000, "{} characters", words.chars().count());
    }
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
