#!/bin/sh
# Checks in the JSON language service of Visual Studio Code that the schema marks ten mistakes and offers the right words.
# Needs npm, which installs the service into a temporary folder.
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cargo run --quiet --release --manifest-path "$here/Cargo.toml" -p etalon-cli -- schema > "$work/schema.json"
cd "$work"
npm install --silent --no-package-lock --no-save vscode-json-languageservice@5 vscode-languageserver-textdocument@1
node "$here/tests/editor.mjs" schema.json "$here/crates/scene/tests/common/everything.json"
echo "The editor marks each mistake and offers the right words."
