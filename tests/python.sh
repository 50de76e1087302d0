#!/usr/bin/env bash
# Builds the wheel of the Python package, installs it in a virtual environment of its own, and checks it: clippy, mypy, stubtest, pytest
# with the notebooks and the examples. With `--fuzz [COUNT [SEED]]` it gives the package arbitrary dicts instead, 100,000 if not told.
# Needs Python 3.10 or later with venv, a Rust toolchain, and a package index that pip can reach. ETALON_PROGRAM names a program whose
# pixels must be those of the package.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

fail() {
    echo "tests/python.sh: $1" >&2
    exit 1
}

python=${PYTHON:-python3}
command -v "$python" >/dev/null || fail "there is no $python: install Python 3.10 or later"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || fail "$("$python" --version) is too old: it takes Python 3.10"
command -v cargo >/dev/null || fail "there is no cargo: install a Rust toolchain (https://rustup.rs)"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$python" -m venv "$work/python" || fail "$python cannot make a virtual environment: install its package venv"
python=$work/python/bin/python
[ -x "$python" ] || python=$work/python/Scripts/python.exe
install() {
    "$python" -m pip install --quiet --disable-pip-version-check "$@" || fail "pip cannot install $*: see its message above"
}

export CARGO_INCREMENTAL=0
echo "== wheel"
"$python" -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir "$work/wheels" . ||
    fail "pip cannot build the wheel: see its message above"
ls -l "$work/wheels"
install "$work"/wheels/etalon-*.whl

# Not from the root of the checkout, so that what is tested is what was installed.
if [ "${1:-}" = --fuzz ]; then
    shift
    cd "$work"
    "$python" "$root/crates/python/tests/fuzz.py" "$@"
    exit
fi

install --requirement crates/python/tests/requirements.txt
echo "== clippy"
PYO3_BUILD_EXTENSION_MODULE=1 cargo clippy --locked --release --package etalon-python --features bindings -- -D warnings
echo "== mypy"
(cd "$work" && "$python" -m mypy --config-file "$root/pyproject.toml" --package etalon)
echo "== stubtest"
(cd "$work" && "$python" -m mypy.stubtest --mypy-config-file "$root/pyproject.toml" etalon)
echo "== pytest"
(cd "$work" && "$python" -m pytest --config-file "$root/pyproject.toml" --rootdir "$root" -p no:cacheprovider --durations 10 "$root/crates/python/tests")
