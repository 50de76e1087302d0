#!/usr/bin/env python3
"""False alarms: runs `etalon verify` with many seeds and counts the truths that fail, though the renderer is the same.

    tests/false-alarms.py [--seeds 100] [--first 2] [--only WORDS] [--coarse] [--etalon PROGRAM] [--results FILE]

A seed of all truths takes as long as `etalon verify`. With `--coarse` it takes the first samples of each truth alone, an eighth of that time or less. Each is a line of FILE, written when it is done: what was interrupted goes on with the next seed.
A line counts for the program that wrote it alone.

Each run of one seed raises a false alarm with the probability that `etalon verify` states. From this follows how many alarms are too many. All
seeds together also read each truth more finely than one: the mean of their readings is held to the truth, with a probability of 1 % for a false alarm among
all truths. The exit status is 1 if a truth fails in either way.
"""

import argparse
import hashlib
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

TREE = pathlib.Path(__file__).resolve().parent.parent
# Of a false alarm among all truths, for the means over all seeds.
LEVEL = 0.01


def read(path, program):
    """The lines of this program."""
    if not path.exists():
        return []
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    return [line for line in lines if line["program"] == program]


def run(etalon, seed, words):
    """The readings of one seed: for each truth its name, mean, standard error, and whether it passed. `words` choose truths, or are options."""
    command = [etalon, "verify", "--json", "--seed", str(seed), *words]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    said = json.loads(done.stdout) if done.stdout.startswith("{") else {}
    if not said.get("complete"):
        sys.exit(f"{' '.join(command)} ended with exit status {done.returncode}")
    rows = [[row["name"], row["measured"], row["standard_error"], row["pass"]] for row in said["truths"]]
    return {"seed": seed, "seconds": said["seconds"], "significance": said["significance"], "rows": rows}


def truths(etalon):
    """The expected value of each truth, and how far rounding may take a reading from it."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([etalon, "verify", "--export", folder], check=True, stdout=subprocess.DEVNULL)
        listed = json.loads((pathlib.Path(folder) / "truths.json").read_text())
    return {truth["name"]: (truth["value"], truth["tolerance"]) for truth in listed["truths"]}


def pooled(lines, expected):
    """For each truth the mean over seeds, its standard error, and by how many of these it is beyond what rounding allows."""
    readings = {}
    for line in lines:
        for name, measured, error, _ in line["rows"]:
            readings.setdefault(name, []).append((measured, error))
    for name, read in readings.items():
        value, tolerance = expected[name]
        mean = statistics.fmean(measured for measured, _ in read)
        error = math.sqrt(sum(error * error for _, error in read)) / len(read)
        beyond = max(abs(mean - value) - tolerance, 0.0)
        yield name, value, mean, error, beyond / error if error > 0 else (math.inf if beyond > 0 else 0.0)


def report(lines, expected):
    """Says what failed. Whether nothing did."""
    alarms = [(line["seed"], name) for line in lines for name, _, _, passed in line["rows"] if not passed]
    significance, seeds = lines[0]["significance"], len(lines)
    print(f"{seeds} seeds of {len(lines[0]['rows'])} truths: {len(alarms)} failed. A correct renderer fails one with probability {seeds * significance:.0e}")
    for seed, name in alarms:
        print(f"  seed {seed}: {name}")
    rows = sorted(pooled(lines, expected), key=lambda row: -row[4])
    # Each error is of 64 replicates: over a few seeds, Student's t is the normal distribution to a percent of the bound.
    bound = statistics.NormalDist().inv_cdf(1 - 0.5 * LEVEL / len(rows))
    failed = [row for row in rows if row[4] > bound]
    finest = sorted(2 * bound * error / abs(value) for _, value, _, error, _ in rows if value and error > 0)
    print(f"the means of all seeds are within {bound:.2f} standard errors for {len(rows) - len(failed)} of {len(rows)} truths; half of those with noise see {100 * finest[len(finest) // 2]:.3f} %")
    for name, value, mean, error, z in rows[:5]:
        print(f"  {name}: {mean:.8g} ± {error:.1e}, truth {value:.8g}, {z:.2f} standard errors{'  FAILED' if z > bound else ''}")
    return not alarms and not failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--first", type=int, default=2)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--coarse", action="store_true")
    parser.add_argument("--etalon", default=str(TREE / "target" / "release" / "etalon"))
    parser.add_argument("--results", type=pathlib.Path, default=TREE / "target" / "false-alarms.jsonl")
    args = parser.parse_args()
    words = args.only + ["--coarse"] * args.coarse
    program = hashlib.sha256(pathlib.Path(args.etalon).read_bytes() + " ".join(words).encode()).hexdigest()[:16]
    done = {line["seed"] for line in read(args.results, program)}
    for seed in range(args.first, args.first + args.seeds):
        if seed not in done:
            line = {"program": program, **run(args.etalon, seed, words)}
            with open(args.results, "a") as file:
                file.write(json.dumps(line) + "\n")
            print(f"seed {seed}: {sum(not row[3] for row in line['rows'])} failed, {line['seconds']:.0f} s", flush=True)
    return 0 if report(read(args.results, program), truths(args.etalon)) else 1


if __name__ == "__main__":
    sys.exit(main())
