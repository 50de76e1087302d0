#!/usr/bin/env python3
"""How small a bias each truth can show: `etalon verify --sees` of one truth after another.

    tests/resolution.py [--words media] [--sees 0.2%] [--etalon PROGRAM] [--results FILE] [--hours H]

`--words` choose truths as `etalon verify` does. All media take about twelve hours of two cores. What a truth showed is a line of FILE, written when it is done.
So a run that was interrupted goes on with the next truth. A line counts for the program that wrote it alone: keep a copy of it. After `--hours` no further truth is begun.

It prints the truths that are coarser than was asked for. The exit status is 1 if there are any, if a truth fails, or if some have not been read.
"""

import argparse
import hashlib
import json
import pathlib
import subprocess
import sys
import time

TREE = pathlib.Path(__file__).resolve().parent.parent
KEPT = ["name", "truth", "measured", "standard_error", "z", "resolvable_bias", "pass", "seconds"]


def verify(etalon, options):
    """The rows of `etalon verify --json`."""
    command = [etalon, "verify", "--json", *options]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    said = json.loads(done.stdout) if done.stdout.startswith("{") else {}
    if not said.get("complete"):
        sys.exit(f"{' '.join(command)} ended with exit status {done.returncode}")
    return said["truths"]


def shows(row):
    """The relative bias that a reading would have shown; the bias itself where the truth is 0."""
    return row["resolvable_bias"] / (abs(row["truth"]) or 1.0)


def cost(row):
    """Seconds to a given relative bias, by what a coarse reading showed, up to a factor."""
    return row["seconds"] * shows(row) ** 2


def read(path, program):
    """The rows of this program, by the names of the truths."""
    lines = path.read_text().splitlines() if path.exists() else []
    return {row["name"]: row for row in map(json.loads, lines) if row["program"] == program}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--words", nargs="+", default=["media"])
    parser.add_argument("--sees", default="0.2%")
    parser.add_argument("--etalon", default=str(TREE / "target" / "release" / "etalon"))
    parser.add_argument("--results", type=pathlib.Path, default=TREE / "target" / "resolution.jsonl")
    parser.add_argument("--hours", type=float, default=float("inf"))
    args = parser.parse_args()
    end = time.monotonic() + 3600 * args.hours
    program = hashlib.sha256(pathlib.Path(args.etalon).read_bytes() + args.sees.encode()).hexdigest()[:16]
    done = read(args.results, program)
    names = [row["name"] for row in sorted(verify(args.etalon, [*args.words, "--coarse"]), key=cost)]
    for name in names:
        if name in done or time.monotonic() > end:
            continue
        # Truths whose names contain this one come with it.
        for row in verify(args.etalon, [name, "--sees", args.sees]):
            done[row["name"]] = {"program": program, **{key: row[key] for key in KEPT}}
            with open(args.results, "a") as file:
                file.write(json.dumps(done[row["name"]]) + "\n")
            print(f"{row['name']}: {shows(row):.2%}, {row['seconds']:.0f} s", flush=True)
    rows = sorted((done[name] for name in names if name in done), key=shows)
    asked = float(args.sees.rstrip("%")) / 100
    coarser = [row for row in rows if shows(row) > asked]
    failed = [row for row in rows if not row["pass"]]
    hours = sum(row["seconds"] for row in rows) / 3600
    print(f"{len(rows)} of {len(names)} truths read in {hours:.1f} h; {len(coarser)} are coarser than {args.sees}, {len(failed)} failed")
    for row in coarser:
        print(f"  {row['name']}: {shows(row):.2%} after {row['seconds']:.0f} s")
    for row in failed:
        print(f"  failed: {row['name']}, z = {row['z']:.1f}")
    return 1 if failed or coarser or len(rows) < len(names) else 0


if __name__ == "__main__":
    sys.exit(main())
