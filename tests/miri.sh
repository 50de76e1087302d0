#!/bin/sh
# Runs the tests of the stack and of the pages of trees under Miri, which finds undefined behaviour in unsafe code.
# Under Miri pages are an aligned allocation instead of a mapping. Needs a nightly toolchain with the components miri and rust-src.
#   tests/miri.sh
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
cd "$here"
cargo +nightly miri --version || {
    echo "missing: rustup component add --toolchain nightly miri rust-src" >&2
    exit 1
}
# A folder of its own: what is built for Miri runs nowhere else.
cargo +nightly miri test --locked --target-dir "$here/target/miri" -p etalon-geometry --lib -- pages:: stack::
cargo +nightly miri test --locked --target-dir "$here/target/miri" -p etalon-simd --lib
