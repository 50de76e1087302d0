#!/bin/sh
# Hunts mutants that no test notices: operators of source files exchanged one by one, all in one build, chosen when the tests run, or, with
# --results, what functions return exchanged for constants.
# Names those that tests reach and do not notice, and those that none reaches; exit status 1 if there are any of the first kind.
# What follows `--` are the tests, as `cargo test --workspace` takes them.
#   tests/mutants.sh [--results] [--limit N] [--quick SECONDS] FILE … -- TESTS
# --limit tries only so many mutants, evenly; --quick leaves out tests that take longer. What they would have noticed is asked of them with
# the mutant's number: MUTANT=7 target/mutants/build/release/deps/PROGRAM --exact TEST.
#   tests/mutants.sh crates/transport/src/guiding/hull.rs -- --lib --test integration
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
cargo run --release --quiet --manifest-path "$here/tests/mutants/Cargo.toml" --target-dir "$here/target/mutants/hunter" -- \
    --tree "$here" "$@"
