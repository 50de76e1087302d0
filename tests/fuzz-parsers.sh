#!/bin/sh
# Feeds arbitrary bytes to the parsers, each for some seconds. Needs `cargo install cargo-fuzz`. What was learnt stays in
# target/fuzz and is gone on with; inputs that fail are written there too.
#   tests/fuzz-parsers.sh SECONDS [scene|ply|obj|gltf|mitsuba|pbrt|image|measured|picture …]
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
seconds=${1:?"how many seconds for each parser?"}
shift
[ $# -gt 0 ] || set -- scene ply obj gltf mitsuba pbrt image measured picture
work="$here/target/fuzz"
# The coverage that guides a fuzzer is an option that rustc holds for unstable.
export RUSTC_BOOTSTRAP=1 CARGO_TARGET_DIR="$work/build"
for parser in "$@"; do
    case $parser in
    scene | image | measured | picture) cd "$here/crates/scene/fuzz" ;;
    *) cd "$here/crates/import/fuzz" ;;
    esac
    seeds=seeds/$parser
    [ "$parser" = scene ] && seeds="$here/scenes"
    mkdir -p "$work/corpus/$parser" "$work/failing/$parser"
    cargo fuzz run -s none "$parser" "$work/corpus/$parser" "$seeds" -- -max_total_time="$seconds" -max_len=32768 \
        -timeout=10 -rss_limit_mb=2048 -artifact_prefix="$work/failing/$parser/" -print_final_stats=1
done
