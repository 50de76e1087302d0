//! Puts a hash of all that decides a film into the library: see `sources.rs`.

// Cargo listens to the standard output.
#![allow(clippy::print_stdout)]

mod sources;

use std::path::Path;

fn main() {
    let variable = |name: &str| std::env::var(name).unwrap_or_else(|_| panic!("cargo sets {name}"));
    let (own, out) = (variable("CARGO_MANIFEST_DIR"), variable("OUT_DIR"));
    let mut features: Vec<String> =
        std::env::vars().map(|(name, _)| name).filter(|name| name.starts_with("CARGO_FEATURE_")).collect();
    features.sort();
    let hashed = sources::hash(Path::new(&own), Path::new(&out), &features)
        .unwrap_or_else(|why| panic!("the sources that decide a film cannot be hashed: {why}"));
    for path in &hashed.read {
        println!("cargo:rerun-if-changed={}", path.display());
    }
    if hashed.lock_is_missing {
        println!(
            "cargo:warning=there is no Cargo.lock: the hash of the sources leaves out the versions of dependencies"
        );
    }
    println!("cargo:rustc-env=ETALON_SOURCES_SHA256={}", hashed.sha256);
}
