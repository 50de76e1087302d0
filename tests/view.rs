//! `etalon view` where it refuses: a server that runs has no end. The server itself is tested in `crates/view`, the page by
//! `cargo xtask view`.

use crate::support::{etalon_that_ends, scene};

#[test]
fn an_address_that_others_reach_needs_a_token() {
    let ran = etalon_that_ends("view {} --bind 0.0.0.0", [&scene("cornell.json")]).expect(2);
    for words in ["--token random", "nothing is encrypted", "SSH"] {
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
    let ran = etalon_that_ends("view {} --token short", [&scene("cornell.json")]).expect(2);
    assert!(ran.stderr.contains("16 to 128 characters"), "{}", ran.stderr);
}

#[test]
fn what_cannot_be_viewed_is_said_at_once() {
    for (name, words) in [("nowhere.json", "nowhere.json"), ("nowhere.exr", "nowhere.exr"), ("-", "needs a file")] {
        let ran = etalon_that_ends(&format!("view {name}"), []).expect(2);
        assert!(ran.stderr.contains(words), "{name}: {}", ran.stderr);
    }
}

#[test]
fn a_port_that_is_taken_is_named() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let ran = etalon_that_ends(&format!("view {{}} --port {port}"), [&scene("cornell.json")]).expect(1);
    assert!(ran.stderr.contains(&format!("port {port} is taken")), "{}", ran.stderr);
}
