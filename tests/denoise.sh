#!/bin/sh
# Builds etalon with Open Image Denoise and tests `etalon denoise`. Needs Python 3 with venv, for the library is taken from its
# Python package (90 MB, x86-64 Linux), unless OIDN_DIR names a folder with its lib/.
#   tests/denoise.sh
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
work="$here/target/denoise"
if [ -z "${OIDN_DIR:-}" ]; then
    [ -x "$work/python/bin/pip" ] || python3 -m venv "$work/python"
    "$work/python/bin/pip" install --quiet pyoidn==2.5.1.0
    OIDN_DIR=$(ls -d "$work"/python/lib/python3*/site-packages/pyoidn/oidn)
fi
export OIDN_DIR
export LD_LIBRARY_PATH="$OIDN_DIR/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
cd "$here"
# A folder of its own: the program without it stays as it is.
CARGO_TARGET_DIR="$work/build" cargo test --release --locked --features etalon-cli/denoise --test integration denoise
