#!/bin/sh
# Checks the template that `etalon farm --openjd` writes by openjd-cli, runs it here, and compares the picture with that of one
# render. Needs Python 3 with venv; installs openjd-cli into a folder that ends with it.
#   tests/farm-openjd.sh [path of etalon]
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
etalon=$(realpath "${1:-$here/target/release/etalon}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if command -v openjd >/dev/null; then
    openjd=openjd
else
    python3 -m venv "$work/python"
    "$work/python/bin/pip" install --quiet openjd-cli==0.8.0
    openjd="$work/python/bin/openjd"
fi

options="--size 96x72 --spp 16 --seed 3"
scene="$here/scenes/cornell-glass.json"
"$etalon" render "$scene" $options --quiet -o "$work/whole.exr"
"$etalon" farm "$scene" $options --shards 3 --threads 2 --openjd --picture "$work/merged it.exr" -o "$work/job.json"
"$openjd" check "$work/job.json"
"$openjd" summary "$work/job.json"
"$openjd" run "$work/job.json" --step Render >"$work/render.log" 2>&1 || { cat "$work/render.log"; exit 1; }
"$openjd" run "$work/job.json" --step Merge >"$work/merge.log" 2>&1 || { cat "$work/merge.log"; exit 1; }
grep -q 'openjd_progress: 100' "$work/render.log" || { cat "$work/render.log"; echo "no progress was told" >&2; exit 1; }
# All but the four bytes of the time that it took.
differing=$(cmp -l "$work/whole.exr" "$work/merged it.exr" | wc -l)
[ "$differing" -le 4 ] || { echo "$differing bytes differ" >&2; exit 1; }
echo "the picture of the job is that of one machine"
