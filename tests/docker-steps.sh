#!/bin/bash
# Runs the steps of the Dockerfile without Docker: each RUN of the build in a copy of what Docker would send, then the program, alone in an
# empty folder, with the libraries of the system. It is the build that is tested, not the two base images.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# What `COPY . .` copies: the files of the repository but those of .dockerignore.
mkdir "$folder/source" "$folder/opt" "$folder/work"
git -C "$root" ls-files -z | tar -C "$root" --exclude=rust-toolchain.toml --null -cf - -T - | tar -C "$folder/source" -xf -

sed -n 's/^RUN //p' "$root/Dockerfile" | while read -r step; do
    step=${step//\/opt\/etalon/$folder\/opt\/etalon}
    echo "+ $step"
    # The packages are compiled once, for every run of this script.
    (cd "$folder/source" && CARGO_TARGET_DIR="$root/target/docker" bash -c "$step")
done

etalon=$folder/opt/etalon/bin/etalon
echo "needs $(ldd "$etalon" | sed -n 's/^\t\([^ ]*\) .*/\1/p' | sort | tr '\n' ' ')"
cp "$root/scenes/cornell.json" "$folder/work"
cd "$folder/work"
env -i "$etalon" render cornell.json --size 16x16 --spp 4 -o cornell.png
env -i "$etalon" --help > help.txt
test -s cornell.png && test -s help.txt
echo "the steps of the Dockerfile build a program that runs"
