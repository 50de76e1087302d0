#!/bin/sh
# Tests on aarch64, emulated by qemu: that etalon renders the same films, byte for byte, as on this machine (seconds once it is built), and
# the suites of optics, geometry, simd and whitted (that of geometry takes more than twenty minutes). Needs the Rust target, a linker and qemu's user mode:
#   rustup target add aarch64-unknown-linux-gnu
#   apt-get install gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user
# What follows is for `cargo test` of the suites: a filter of tests, for instance.
#   tests/aarch64.sh
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
cd "$here"
target=aarch64-unknown-linux-gnu
emulator="qemu-aarch64 -L /usr/aarch64-linux-gnu"
for tool in aarch64-linux-gnu-gcc qemu-aarch64; do
    command -v "$tool" > /dev/null || { echo "missing: $tool" >&2; exit 1; }
done
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="$emulator"
# A folder of its own: what is built for this machine stays as it is.
folder="$here/target/aarch64"

cargo build --release --locked --target $target --target-dir "$folder" -p etalon-cli
ETALON_OTHER="$emulator $folder/$target/release/etalon" \
    cargo test --release --locked -p etalon-cli --test integration another_program -- --nocapture

cargo test --release --locked --target $target --target-dir "$folder" \
    -p etalon-optics -p etalon-geometry -p etalon-simd -p etalon-whitted "$@"
