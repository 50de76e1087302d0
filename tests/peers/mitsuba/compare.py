#!/usr/bin/env python3
"""Renders small scenes in Mitsuba's format by Mitsuba 3 and by etalon, and compares the pictures.

    pip install mitsuba==3.9.1 OpenEXR numpy
    python3 tests/peers/mitsuba/compare.py [--etalon target/release/etalon] [--write PAGE.md] [NAME ...]

`cases.py` lists the scenes. Both programs read the same file. The table has, for each colour channel, the mean over the object in our
picture divided by the mean in Mitsuba's, with its standard error. `etalon compare` judges all pixels. Pictures agree if they differ by
no more than their noise, or by no more than 0.5 % of the object's mean. The exit status is 1 if they differ and `cases.py` has no reason for
it, if they differ by more than the reason allows, or if a reason is out of date.
"""

import argparse
import datetime
import json
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

import numpy as np

from cases import CASES
from files import write_all, write_exr

HERE = pathlib.Path(__file__).resolve().parent
# Independent renders behind each standard error of Mitsuba's pictures.
PASSES = 16
# Standard errors that a ratio may be from 1: 250 ratios are further in one run of 50.
MOST_ERRORS = 4
# A ratio whose standard error is larger than this says too little.
RESOLUTION = 0.0025
# Differences up to this part of the object's mean count as agreement.
SMALL = 0.005


def channels(path):
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.astype(np.float64) for name, channel in file.channels().items()}, dict(file.header())


def by_mitsuba(mi, scene, given, picture, spp):
    """Renders, and returns the renders of all passes."""
    loaded = mi.load_file(str(scene), **{name: str(value) for name, value in given.items()})
    passes = np.array([np.array(mi.render(loaded, spp=spp, seed=seed), np.float64)[..., :3] for seed in range(PASSES)])
    mean, error = passes.mean(0), passes.std(0, ddof=1) / np.sqrt(PASSES)
    named = {c: mean[..., i] for i, c in enumerate("RGB")} | {f"Error.{c}": error[..., i] for i, c in enumerate("RGB")}
    write_exr(picture, named)
    return passes


def by_etalon(etalon, scene, case, picture, spp):
    """Renders, and returns what was not taken over exactly."""
    defined = [part for name, value in case.given.items() for part in ("-D", f"{name}={value}")]
    command = [etalon, "render", scene, "-o", picture, "--spp", str(spp), "--aov", "color,error,object", *defined, *case.options]
    told = subprocess.run(command, capture_output=True, text=True)
    if told.returncode != 0:
        raise SystemExit(f"{scene.name}: {told.stderr}")
    return [line.strip() for line in told.stderr.splitlines() if "approximated" in line or "left out" in line]


def object_pixels(found, header):
    """Pixels of the shapes whose id begins with `object`, or else the middle of the picture."""
    names = json.loads(header["objectNames"])
    numbers = [i + 1 for i, name in enumerate(names) if name.startswith("object")]
    mask = np.isin(found["ObjectId"], numbers)
    if not mask.any():
        h, w = mask.shape
        mask[h // 4 : h - h // 4, w // 4 : w - w // 4] = True
    return mask


def ratios(passes, ours, mask):
    """Our mean over the object divided by Mitsuba's, and the standard error of the ratio, for each channel."""
    result = []
    for i, name in enumerate("RGB"):
        of_passes = passes[..., i][:, mask].mean(1)
        mean, error = of_passes.mean(), of_passes.std(ddof=1) / np.sqrt(PASSES)
        mine, my_error = ours[name][mask].mean(), np.sqrt((ours[f"Error.{name}"][mask] ** 2).sum()) / mask.sum()
        result.append((mine / mean, mine / mean * np.hypot(my_error / mine, error / mean)))
    return result


def beyond_noise(ours, theirs, mask):
    """The root mean square difference of regions of 4 × 4 pixels that noise does not explain, in units of the mean over the object."""
    worst = 0
    for name in "RGB":
        difference, variance = ours[name] - theirs[name], ours[f"Error.{name}"] ** 2 + theirs[f"Error.{name}"] ** 2

        def regions(values):
            height, width = (side - side % 4 for side in values.shape)
            return values[:height, :width].reshape(height // 4, 4, width // 4, 4).mean((1, 3))

        square = (regions(difference) ** 2 - regions(variance) / 16).mean()
        worst = max(worst, np.sqrt(max(square, 0)) / theirs[name][mask].mean())
    return float(worst)


def judge(case, found, verdict, beyond):
    """In words, and whether it is as it should be."""
    off = max(found, key=lambda pair: abs(pair[0] - 1))
    sure = max(error for _, error in found)
    within_noise = verdict != "differ" and all(abs(ratio - 1) <= MOST_ERRORS * error for ratio, error in found)
    small = beyond <= SMALL and all(abs(ratio - 1) <= SMALL for ratio, _ in found)
    if sure > RESOLUTION:
        return f"TOO NOISY: {100 * sure:.2f} %", False
    if within_noise or (small and case.known is None):
        words = "within noise" if within_noise else f"within 0.5 %: {100 * beyond:.2f} % beyond noise"
        return (words, True) if case.known is None else ("THE REASON IS OUT OF DATE", False)
    if case.known is None:
        return f"DIFFER: {100 * beyond:.2f} % beyond noise", False
    if abs(off[0] - 1) > case.known.most + MOST_ERRORS * off[1]:
        return f"DIFFER BY MORE THAN {100 * case.known.most:.1f} %", False
    return f"differ: {case.known.why}", True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="names, or their first words; all if left out")
    parser.add_argument("--etalon", type=pathlib.Path, default=HERE.parents[2] / "target/release/etalon")
    parser.add_argument("--folder", type=pathlib.Path, help="where pictures and results are kept: named scenes replace theirs, and the table has all")
    parser.add_argument("--spp", type=int, default=1024, help="samples of each pixel, in all passes together")
    parser.add_argument("--variant", default="llvm_ad_spectral")
    parser.add_argument("--write", type=pathlib.Path, help="write the table into this page")
    args = parser.parse_args()

    import mitsuba as mi

    mi.set_variant(args.variant)
    mi.set_log_level(mi.LogLevel.Error)
    folder = args.folder or pathlib.Path(tempfile.mkdtemp())
    shutil.copytree(HERE / "scenes", folder, dirs_exist_ok=True)
    write_all(folder)
    kept = folder / "results.json"
    results = json.loads(kept.read_text()) if kept.exists() else {}
    for case in CASES:
        if args.names and not any(f"{case.name} ".startswith(f"{name} ") for name in args.names):
            continue
        mi.set_variant(case.variant or args.variant)
        results[case.name], losses = measured(mi, case, folder, args)
        kept.write_text(json.dumps(results))
        print(row(case, *results[case.name])[0], *(f"    {loss}" for loss in losses), sep="\n", flush=True)
    done = [case for case in CASES if case.name in results]
    rows = [row(case, *results[case.name]) for case in done]
    off = [max(abs(ratio - 1) for ratio, _ in results[case.name][0]) for case in done if case.known is None]
    known = sum(case.known is not None for case in done)
    summary = f"{len(done)} scenes, of which {known} differ for a reason that is known. The others: worst ratio {100 * max(off, default=0):.2f} %, "
    summary += f"median {100 * statistics.median(off or [0]):.2f} % from 1 (the largest of three channels)"
    print(f"{summary}; pictures in {folder}")
    if args.write:
        version = subprocess.run([args.etalon, "--version"], capture_output=True, text=True).stdout.strip()
        write_page(args.write, [text for text, _ in rows], summary, mi.__version__, version, args)
    if wrong := [case.name for case, (_, right) in zip(done, rows) if not right]:
        sys.exit(f"not as they should be: {', '.join(wrong)}")


def measured(mi, case, folder, args):
    """The ratios and the verdict of `etalon compare`; and what was not taken over exactly."""
    stem = case.name.replace(" ", "-")
    reference, ours = folder / f"{stem}-mitsuba.exr", folder / f"{stem}-etalon.exr"
    spp = int(case.samples * args.spp)
    losses = by_etalon(args.etalon, folder / case.scene, case, ours, spp)
    passes = by_mitsuba(mi, folder / case.scene, case.given, reference, max(spp // PASSES, 1))
    found, header = channels(ours)
    told = subprocess.run([args.etalon, "compare", ours, reference, "--json"], capture_output=True, text=True)
    if not told.stdout:
        raise SystemExit(f"{case.name}: {told.stderr}")
    mask = object_pixels(found, header)
    beyond = beyond_noise(found, channels(reference)[0], mask)
    return (ratios(passes, found, mask), json.loads(told.stdout)["verdict"], beyond), losses


def row(case, found, verdict, beyond):
    """A line of the table, and whether it is as it should be."""
    words, right = judge(case, found, verdict, beyond)
    cells = [f"{ratio:.4f} ± {error:.4f}" for ratio, error in found]
    return f"| {case.name} | {' | '.join(cells)} | {words} |", right


def write_page(page, rows, summary, mitsuba, etalon, args):
    """Replaces what stands after the line of the mark."""
    mark = "<!-- written by tests/peers/mitsuba/compare.py -->\n"
    head = page.read_text().split(mark)[0]
    date = datetime.date.today().isoformat()
    text = f"\n{date}: Mitsuba {mitsuba} (`{args.variant}`), {etalon}, {args.spp} samples per pixel. {summary}.\n\n"
    text += "| scene | red | green | blue | pictures |\n|---|---|---|---|---|\n" + "\n".join(rows) + "\n"
    page.write_text(head + mark + text)


if __name__ == "__main__":
    main()
