#!/usr/bin/env python3
"""Holds pictures of small models in glTF and OBJ to the formulas of their specifications.

    pip install numpy
    python3 tests/peers/closed-forms/check.py [--etalon target/release/etalon] [--write PAGE.md] [WORD ...]

Each case is a model that is written here, imported and rendered by etalon, and a picture that is computed from the specification, by closed forms
and quadrature. They agree if the mean of each channel, and the root mean square difference of regions of 4 × 4 pixels beyond the noise, differ by
no more than 0.5 % of the mean. Where they differ a case must name a reason, and have the picture that Etalon's documentation promises: to this
one Etalon is held by the same rule. The exit status is 1 if one fails, if it is too noisy to tell, or if a reason explains nothing any more.
WORDs choose cases by parts of their names.
"""

import argparse
import datetime
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import gltf_bodies
import gltf_materials
import gltf_models
import obj_cases
from foreign import exr
from reasons import REASONS
from views import SIZE

HERE = pathlib.Path(__file__).resolve().parent
MODULES = [gltf_models, gltf_materials, gltf_bodies, obj_cases]
# Differences up to this part of the mean are agreement.
SMALL = 0.005
# A mean whose standard error is larger than this part of it says too little.
RESOLUTION = 0.00125
# Pixels of a side of a region.
REGION = 4
MARK = "<!-- written by tests/peers/closed-forms/check.py -->\n"


def told_by(command):
    told = subprocess.run(command, capture_output=True, text=True)
    if told.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))}: {told.stderr}")


def rendered(case, folder, etalon):
    """The picture, and the standard errors of its pixels."""
    scene, picture = case.scene.write(folder), folder / "picture.exr"
    change = getattr(case.scene, "change", None)
    if change or case.imported:
        imported = folder / "imported.json"
        told_by([etalon, "import", scene, "-o", imported, *case.imported])
        value = json.loads(imported.read_text())
        if change:
            change(value)
        imported.write_text(json.dumps(value))
        scene = imported
    told_by([etalon, "render", scene, "-o", picture, "--spp", str(case.spp), "--size", f"{SIZE}x{SIZE}"])
    found = exr(picture)
    return [np.stack([found[f"{kind}{c}"] for c in "RGB"], -1) for kind in ("", "Error.")]


def in_channels(picture):
    picture = np.asarray(picture, float)
    return np.broadcast_to(picture if picture.ndim == 3 else picture[..., None], (SIZE, SIZE, 3))


def regions(values):
    return values.reshape(SIZE // REGION, REGION, SIZE // REGION, REGION, 3).mean((1, 3))


def compared(picture, error, known):
    """By how much the mean of the worst channel is off, and what regions differ by beyond their noise, both as parts of the mean."""
    known = in_channels(known)
    mean = max(known.mean(), 1e-6)
    off = (picture - known).mean((0, 1)) / mean
    square = (regions(picture - known) ** 2 - regions(error**2) / REGION**2).mean((0, 1)).max()
    return off[np.abs(off).argmax()], np.sqrt(max(square, 0)) / mean


def agrees(off, beyond):
    return abs(off) <= SMALL and beyond <= SMALL


def numbers(means):
    """One number if all channels have it, else three."""
    same = np.ptp(means) <= 0.001 * abs(means.mean())
    return f"{means.mean():.4f}" if same else " / ".join(f"{mean:.4f}" for mean in means)


class Row:
    """A line of the table, and whether it is as it should be."""

    def __init__(self, case, picture, error):
        self.case = case
        expected = in_channels(case.expected)
        means, noise = picture.mean((0, 1)), np.sqrt((error**2).sum((0, 1))).max() / SIZE**2
        self.off, beyond = compared(picture, error, expected)
        self.explained = not agrees(self.off, beyond)
        self.right = True
        if noise > RESOLUTION * max(means.mean(), expected.mean(), 1e-6):
            verdict, self.right = "TOO NOISY", False
        elif not self.explained:
            verdict = f"agrees ({percent(self.off)}; regions {100 * beyond:.2f} %)"
        elif case.why is None:
            verdict, self.right = f"DIFFERS: {percent(self.off)}; regions {100 * beyond:.2f} %", False
        else:
            known = in_channels(case.own)
            off, beyond = compared(picture, error, known)
            words = f"{', '.join(case.why.split())}: {percent(self.off)}"
            verdict = f"{words}. Documented: {numbers(known.mean((0, 1)))} ({percent(off)}; regions {100 * beyond:.2f} %)"
            if not agrees(off, beyond):
                verdict, self.right = f"DIFFERS FROM THE DOCUMENTATION: {verdict}", False
        self.text = f"| {case.name} | {numbers(expected.mean((0, 1)))} | {numbers(means)} ± {noise:.6f} | {verdict} |"


def percent(part):
    return f"{100 * part:+.2f} %".replace("-", "−").replace("+0.00", "0.00").replace("−0.00", "0.00")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", help="parts of names of cases; all if left out")
    parser.add_argument("--etalon", type=pathlib.Path, default=HERE.parents[2] / "target/release/etalon")
    parser.add_argument("--write", type=pathlib.Path, help="write the table into this page")
    args = parser.parse_args()
    if args.write and args.words:
        sys.exit("a page has all cases: leave out the words")
    rows = []
    for case in itertools.chain.from_iterable(module.cases() for module in MODULES):
        if not args.words or any(word in case.name for word in args.words):
            with tempfile.TemporaryDirectory() as folder:
                rows.append(Row(case, *rendered(case, pathlib.Path(folder), args.etalon)))
            print(rows[-1].text, flush=True)
    wrong = [row.case.name for row in rows if not row.right]
    if not args.words:
        wrong += [f"the reason {word}, which explains nothing" for word in REASONS if not offs(rows, word)]
    if args.write:
        version = subprocess.run([args.etalon, "--version"], capture_output=True, text=True).stdout.strip()
        write_page(args.write, rows, version)
    if wrong:
        sys.exit(f"not as they should be: {', '.join(wrong)}")


def offs(rows, word):
    """Differences of the cases that name a reason."""
    return [row.off for row in rows if row.explained and word in (row.case.why or "").split()]


def write_page(page, rows, version):
    """Replaces what stands between the mark and the next heading."""
    head, rest = page.read_text().split(MARK)
    after = rest.find("\n## ")
    known = sum(row.explained for row in rows)
    text = f"\n{datetime.date.today().isoformat()}: {version}, {len(rows)} cases, of which {known} differ for a reason that is known.\n\n"
    text += "| reason | differences of means | what and why |\n|---|---|---|\n"
    for word, sentence in REASONS.items():
        found = sorted(offs(rows, word)) or [0.0]
        text += f"| {word} | {percent(found[0])} to {percent(found[-1])} | {sentence} |\n"
    text += "\n| construct | expected | measured | verdict |\n|---|---|---|---|\n" + "\n".join(row.text for row in rows) + "\n"
    page.write_text(head + MARK + text + (rest[after:] if after >= 0 else ""))


if __name__ == "__main__":
    main()
