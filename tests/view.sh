#!/bin/sh
# Opens the page of `etalon view` in a headless Chromium and does with it what people do: see tests/view/page.py.
# Needs Chromium and Python. Options: --shots FOLDER keeps screenshots, --measure prints the figures of docs/how-to/view.md.
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
cargo build --quiet --release --manifest-path "$here/Cargo.toml" --workspace --bin etalon
exec python3 "$here/tests/view/page.py" "$here/target/release/etalon" "$@"
