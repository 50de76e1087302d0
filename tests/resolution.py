#!/usr/bin/env python3
"""How small a bias each truth can show: `etalon verify --sees` of one truth after another, for as many hours as there are.

    tests/resolution.py [--words media] [--sees 0.2%] [--etalon PROGRAM] [--results FILE] [--hours H]

`--words` choose truths as `etalon verify` does. What a truth showed is a line of FILE, written when it is done, so a run that was interrupted goes on with the next truth.
A truth that has not changed is not read again, also by a later program: each line has the digest of the truth, and the version of the program. After `--hours`
no further truth is begun. Truths that took the fewest rays of a coarse reading come first.

It prints what was read, the worst last. The exit status is 1 if a truth fails or shows less than it was asked for.
"""

import argparse
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile
import time

TREE = pathlib.Path(__file__).resolve().parent.parent


def verify(etalon, options):
    """The rows of `etalon verify --json`."""
    done = subprocess.run([etalon, "verify", "--json", *options], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    said = json.loads(done.stdout) if done.stdout.startswith("{") else {}
    if not said.get("complete"):
        sys.exit(f"etalon verify {' '.join(options)} ended with exit status {done.returncode}")
    return said["truths"]


def digests(etalon):
    """Of each truth and its files, by name."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([etalon, "verify", "--export", folder], check=True, stdout=subprocess.DEVNULL)
        root = pathlib.Path(folder)
        listed = json.loads((root / "truths.json").read_text())["truths"]
        of = lambda truth: json.dumps(truth, sort_keys=True).encode() + (root / truth["scene"]).read_bytes()
        return {truth["name"]: hashlib.sha256(of(truth)).hexdigest()[:16] for truth in listed}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--words", nargs="+", default=["media"])
    parser.add_argument("--sees", default="0.2%")
    parser.add_argument("--etalon", default=str(TREE / "target" / "release" / "etalon"))
    parser.add_argument("--results", type=pathlib.Path, default=TREE / "target" / "resolution.jsonl")
    parser.add_argument("--hours", type=float, default=float("inf"))
    args = parser.parse_args()
    start, known = time.monotonic(), digests(args.etalon)
    version = subprocess.run([args.etalon, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    key = lambda name: (name, known[name], args.sees)
    lines = args.results.read_text().splitlines() if args.results.exists() else []
    done = {(row["name"], row["digest"], row["asked"]): row for row in map(json.loads, lines)}
    coarse = verify(args.etalon, [*args.words, "--coarse"])
    names = [row["name"] for row in sorted(coarse, key=lambda row: row["seconds"] * (row["resolvable_bias"] / (abs(row["truth"]) or 1.0)) ** 2)]
    for name in names:
        if key(name) in done or time.monotonic() - start > 3600 * args.hours:
            continue
        # Names that contain this one come with it.
        for row in verify(args.etalon, [name, "--sees", args.sees]):
            if row["name"] in names and key(row["name"]) not in done:
                kept = {"name": row["name"], "digest": known[row["name"]], "asked": args.sees, "by": version}
                kept |= {word: row[word] for word in ["truth", "measured", "standard_error", "z", "resolvable_bias", "pass", "seconds"]}
                done[key(row["name"])] = kept
                with open(args.results, "a") as file:
                    file.write(json.dumps(kept) + "\n")
                print(f"{row['name']}: {row['resolvable_bias'] / (abs(row['truth']) or 1.0):.2%}, {row['seconds']:.0f} s", flush=True)
    read = [done[key(name)] for name in names if key(name) in done]
    shows = lambda row: row["resolvable_bias"] / (abs(row["truth"]) or 1.0)
    read.sort(key=shows)
    asked = float(args.sees.rstrip("%")) / 100
    failed = [row["name"] for row in read if not row["pass"]]
    coarser = [row for row in read if shows(row) > asked]
    hours = sum(row["seconds"] for row in read) / 3600
    print(f"{len(read)} of {len(names)} truths read in {hours:.1f} h: {len(read) - len(coarser)} show {args.sees} or less, {len(failed)} failed; largest |z| {max((abs(row['z']) for row in read), default=0):.1f}")
    for row in coarser:
        print(f"  {row['name']}: {shows(row):.2%} after {row['seconds']:.0f} s")
    for name in failed:
        print(f"  failed: {name}")
    return 1 if failed or coarser or len(read) < len(names) else 0


if __name__ == "__main__":
    sys.exit(main())
