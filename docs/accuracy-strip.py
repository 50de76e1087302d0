#!/usr/bin/env python3
"""Renders one scene to 20, 10, 5, 2 and 1 % error and makes docs/images/accuracy.svg: the same part of each, with its time below.

    python3 docs/accuracy-strip.py [path of etalon] [--scene SCENE] [--size WxH] [--crop X,Y,W,H]

Needs nothing but Python. The renders are kept in target/accuracy; those that are finished are not rendered again.
"""
import argparse
import base64
import json
import pathlib
import subprocess

root = pathlib.Path(__file__).resolve().parent.parent
ERRORS = [20, 10, 5, 2, 1]
GAP, BELOW = 8, 46


def told(seconds):
    """A time with two digits."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.1f} min"


def render(etalon, scene, size, percent, folder):
    """The picture's file and the report of its render."""
    picture, report = folder / f"{percent}.exr", folder / f"{percent}.json"
    if not report.exists():
        command = [etalon, "render", scene, "--size", size, "--error", f"{percent}%", "--clock", "cpu", "--json", "-o", picture]
        made = subprocess.run(command, cwd=root, check=True, stdout=subprocess.PIPE, text=True)
        report.write_text(made.stdout)
    return picture, json.loads(report.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etalon", nargs="?", default=root / "target/release/etalon", type=pathlib.Path)
    parser.add_argument("--scene", default="scenes/cornell.json")
    parser.add_argument("--size", default="400x400")
    parser.add_argument("--crop", default="170,150,176,240")
    parser.add_argument("--develop", default="", help="more options of etalon develop")
    args = parser.parse_args()
    etalon = args.etalon.resolve()
    folder = root / "target/accuracy" / pathlib.Path(args.scene).stem
    folder.mkdir(parents=True, exist_ok=True)
    width, height = map(int, args.crop.split(",")[2:])
    parts = []
    for place, percent in enumerate(ERRORS):
        picture, report = render(etalon, args.scene, args.size, percent, folder)
        png = folder / f"{percent}.png"
        subprocess.run([etalon, "develop", picture, "--crop", args.crop, *args.develop.split(), "--quiet", "-o", png], check=True)
        reached = 100 * report["error"]["relative_rmse"]
        x = place * (width + GAP)
        data = base64.b64encode(png.read_bytes()).decode()
        parts.append(
            f'<image x="{x}" y="0" width="{width}" height="{height}" href="data:image/png;base64,{data}"/>'
            f'<text x="{x + width / 2}" y="{height + 20}" class="error">{percent} %</text>'
            f'<text x="{x + width / 2}" y="{height + 38}" class="time">{told(report["seconds"])}</text>'
        )
        print(f"{percent} %: {reached:.2f} % after {report['seconds']:.2f} s, {report['spp']} samples a pixel, {report['threads']} threads")
    whole = len(ERRORS) * (width + GAP) - GAP
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{whole}" height="{height + BELOW}" viewBox="0 0 {whole} {height + BELOW}">'
        "<style>text{font-family:system-ui,sans-serif;text-anchor:middle;fill:#333}.error{font-size:17px;font-weight:600}"
        ".time{font-size:14px}@media(prefers-color-scheme:dark){text{fill:#ddd}}</style>" + "".join(parts) + "</svg>\n"
    )
    path = root / "docs/images/accuracy.svg"
    path.write_text(svg)
    print(f"{path.relative_to(root)}: {len(svg) / 1000:.0f} kB")


main()
