//! The hash of the sources that decide a film: what changes it and what does not.

// The build script's own code; a test has no use for all of it.
#[allow(dead_code)]
#[path = "../build/sources.rs"]
mod sources;

use std::fs;
use std::path::{Path, PathBuf};

use sources::hash;

const LOCK: &str = r#"
[[package]]
name = "etalon-base"
version = "1.0.0"
dependencies = [
 "shared",
 "tester",
]

[[package]]
name = "etalon-top"
version = "1.0.0"
dependencies = [
 "etalon-base",
 "many 2.0.0",
 "tester",
]

[[package]]
name = "many"
version = "1.0.0"
checksum = "m1"

[[package]]
name = "many"
version = "2.0.0"
checksum = "m2"
dependencies = ["deep"]

[[package]]
name = "deep"
version = "0.3.1"
checksum = "d1"

[[package]]
name = "shared"
version = "0.1.0"
checksum = "s1"

[[package]]
name = "tester"
version = "0.1.0"
checksum = "t1"
"#;

/// Writes a workspace of two crates into `root`, in folders of these names, and gives the folder of the upper crate.
fn workspace(root: &Path, [base, top]: [&str; 2]) -> PathBuf {
    let write = |name: String, text: &str| {
        let path = root.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("Cargo.lock".to_owned(), LOCK);
    write("crates/unrelated/Cargo.toml".to_owned(), "[package]\nname = \"etalon-unrelated\"\n");
    write("crates/unrelated/src/lib.rs".to_owned(), "");
    let manifest = "[package]\nname = \"etalon-base\"\n\n[dependencies]\n# A word.\nshared.workspace = true\n\n[dev-dependencies]\ntester = \"1\"\n";
    write(format!("crates/{base}/Cargo.toml"), manifest);
    write(format!("crates/{base}/src/lib.rs"), "//! A crate.\nfn one() {}\n");
    write(format!("crates/{base}/data/table.csv"), "1,2\n3,4\n");
    let manifest = "[package]\nname = \"etalon-top\"\n\n[dependencies.etalon-base]\npath = \"../x\"\n\n[target.'cfg(unix)'.dependencies]\nmany = \"2\"\n";
    write(format!("crates/{top}/Cargo.toml"), manifest);
    write(format!("crates/{top}/src/lib.rs"), "mod deep;\n");
    write(format!("crates/{top}/src/deep/mod.rs"), "\n");
    write(format!("crates/{top}/tests/all.rs"), "\n");
    root.join("crates").join(top)
}

fn of(top: &Path) -> String {
    let hashed = hash(top, Path::new("/nowhere"), &[]).unwrap();
    assert!(!hashed.lock_is_missing);
    hashed.sha256
}

#[test]
fn the_hash_of_this_build_is_that_of_the_sources_here() {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let hashed = hash(own, Path::new(env!("CARGO_TARGET_TMPDIR")), &[]).unwrap();
    assert_eq!(hashed.sha256, etalon_control::SOURCES_SHA256);
    for name in ["optics", "geometry", "scene", "transport", "control", "picture"] {
        let folder = own.join("..").join(name).canonicalize().unwrap().join("src");
        let read = hashed.read.iter().any(|path| path.canonicalize().is_ok_and(|path| path == folder));
        assert!(read, "{name} is not in {:?}", hashed.read);
    }
    for name in ["oracle", "whitted", "import", "etalon", "cli"] {
        assert!(hashed.read.iter().all(|path| !path.ends_with(format!("{name}/src"))), "{name}");
    }
}

#[test]
fn folders_line_ends_and_what_only_tests_use_do_not_change_it() {
    let folder = tempfile::tempdir().unwrap();
    let plain = workspace(&folder.path().join("a"), ["base", "top"]);
    let expected = of(&plain);
    assert_eq!(expected.len(), 64);
    assert_eq!(of(&workspace(&folder.path().join("b/c"), ["etalon-base-1.0.0", "zzz"])), expected);
    let root = folder.path().join("a");
    let change = |name: &str, text: &str| fs::write(root.join(name), text).unwrap();
    change("crates/base/src/lib.rs", "//! A crate.\r\nfn one() {}\r\n");
    change("crates/base/data/table.csv", "1,2\r\n3,4\r\n");
    change("crates/top/tests/all.rs", "#[test]\nfn one() {}\n");
    change("crates/unrelated/src/lib.rs", "fn two() {}\n");
    change("Cargo.lock", &LOCK.replace("\"t1\"", "\"t2\"").replace("\"m1\"", "\"m3\"").replace('\n', "\r\n"));
    // The lock's other version of `many` counts: a manifest does not say which of the two it means.
    assert_ne!(of(&plain), expected);
    change("Cargo.lock", &LOCK.replace("\"t1\"", "\"t2\"").replace('\n', "\r\n"));
    assert_eq!(of(&plain), expected);
}

#[test]
fn every_source_and_every_locked_package_changes_it() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let top = workspace(root, ["base", "top"]);
    let mut seen = vec![of(&top)];
    let mut changed = |what: &str| {
        let now = of(&top);
        assert!(!seen.contains(&now), "{what} changes nothing");
        seen.push(now);
    };
    fs::write(root.join("crates/base/src/lib.rs"), "fn two() {}\n").unwrap();
    changed("a source of a crate below");
    fs::write(root.join("crates/base/data/table.csv"), "1,2\n3,5\n").unwrap();
    changed("a table");
    fs::write(root.join("crates/top/src/deep/mod.rs"), "fn deep() {}\n").unwrap();
    changed("a source in a folder");
    fs::rename(root.join("crates/top/src/deep/mod.rs"), root.join("crates/top/src/deep.rs")).unwrap();
    changed("a name");
    for (from, to) in [("\"s1\"", "\"s2\""), ("\"d1\"", "\"d2\""), ("0.3.1", "0.3.2")] {
        fs::write(root.join("Cargo.lock"), LOCK.replace(from, to)).unwrap();
        changed(from);
    }
    let feature = hash(&top, root, &["CARGO_FEATURE_ANY".to_owned()]).unwrap().sha256;
    assert!(!seen.contains(&feature));
}

#[test]
fn without_a_lock_that_knows_the_crate_that_is_said_and_one_above_what_is_built_counts() {
    let folder = tempfile::tempdir().unwrap();
    let top = workspace(&folder.path().join("a"), ["base", "top"]);
    let expected = of(&top);
    fs::write(folder.path().join("a/Cargo.lock"), "[[package]]\nname = \"another\"\n").unwrap();
    let hashed = hash(&top, Path::new("/nowhere"), &[]).unwrap();
    assert!(hashed.lock_is_missing && hashed.sha256 != expected);
    fs::create_dir_all(folder.path().join("b/target")).unwrap();
    fs::write(folder.path().join("b/Cargo.lock"), LOCK).unwrap();
    let hashed = hash(&top, &folder.path().join("b/target"), &[]).unwrap();
    assert_eq!((hashed.lock_is_missing, hashed.sha256), (false, expected));
}
