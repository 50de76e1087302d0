#!/bin/sh
# Instructions that a scene which does not call for an effect spends in the kernel of the ordinary build, and of one from which
# the effect was compiled out. Needs valgrind and takes some minutes; docs/effects.md has what it printed.
set -eu
cd "$(dirname "$0")/.."
size=32x24
samples=16

build() {
    cargo build --quiet --release -p etalon-transport --example pilot ${1:+--features "$1"}
    cp target/release/examples/pilot "$scratch/pilot-${1:-ordinary}"
}
count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null --collect-atstart=no --toggle-collect='*render_tile*' \
        "$scratch/pilot-$1" "scenes/$2" $size $samples 2>&1 | sed -n 's/.*Collected : *//p'
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
build ''
printf '%-20s %-24s %14s %14s %8s\n' effect scene ordinary without ratio
while read -r effect scene; do
    build "without-$effect"
    with=$(count ordinary "$scene")
    without=$(count "without-$effect" "$scene")
    printf '%-20s %-24s %14s %14s %8s\n' "$effect" "$scene" "$with" "$without" \
        "$(awk "BEGIN { printf \"%.4f\", $with / $without }")"
done <<LIST
dispersion metals.json
lens cornell-glass.json
shadow-rays furnace.json
mis integrating-sphere.json
environment cornell.json
specular-chains cornell.json
nested-dielectrics cornell-glass.json
absorption cornell-glass.json
polarisation cornell-glass.json
textures cornell.json
shading-normals cornell.json
masks cornell.json
motion lanterns.json
bands cornell.json
wide-filter furnace.json
LIST
