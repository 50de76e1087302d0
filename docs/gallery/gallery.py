#!/usr/bin/env python3
"""Renders the pictures of docs/gallery and writes docs/gallery/README.md: each picture with its command, time and error.

    python3 docs/gallery/gallery.py [path of etalon] [--error PERCENT] [--only NAME,NAME] [--threads N]

Renders are kept in target/gallery with their checkpoints. What is finished is not rendered again, and an interrupted render continues.
Needs nothing but Python.
"""
import argparse
import json
import pathlib
import subprocess

here = pathlib.Path(__file__).resolve().parent
root = here.parent.parent
SIZE = "540x360"
# Name, scene, options of the render, options of etalon develop, what to look at.
PICTURES = [
    ("movement", "scenes/movement.glb", [], ["--exposure", "0.7", "--curve", "agx"],
     "The movement of a watch, from a glTF model. Look at the stripes of the bridges, which brushing makes change from bright to dark as they turn "
     "away from the lamp; at the rubies, whose red is the path of the light through them; at the spring, a ribbon of 35 µm."),
    ("watch", "scenes/watch.json", [], ["--exposure", "0.3", "--curve", "agx"],
     "A wrist watch. The dial is brushed from the middle outward, the case around. The two bright fans of the dial stand across the lamps, as they do "
     "on real dials."),
    ("rosette", "scenes/rosette.json", [], ["--exposure", "0.6"],
     "A window without coloured glass: stacks of clear film between crossed polarisers. Only the delay of each stack, 115 nm a sheet, decides its "
     "colour. The outer ring is Michel-Lévy's chart from 1 to 24 sheets and back. The varnished floor polarises what it mirrors."),
    ("room", "scenes/room.json", [], ["--exposure", "1.0", "--curve", "agx"],
     "A room into which the sun shines. All but the patches of sun is lit by way of the walls: the floor throws warm light on the shelves."),
    ("chess", "scenes/chess.json", [], ["--exposure", "1.5", "--curve", "agx"],
     "Chess men close up, by a lens of 75 mm at f/4. The disks behind are images of the lens, one for each lamp of the string."),
]


def told(seconds):
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    return f"{int(seconds // 60)} min {round(seconds % 60)} s"


def render(etalon, name, scene, options, develop, threads, error):
    folder = root / "target/gallery"
    folder.mkdir(parents=True, exist_ok=True)
    picture, report = folder / f"{name}.exr", folder / f"{name}-{error.rstrip('%')}.json"
    words = ["render", scene, "--size", SIZE, "--error", error, *options]
    if not report.exists():
        more = ["--threads", str(threads)] if threads else []
        command = [etalon, *words, *more, "--clock", "cpu", "--checkpoint", "60s", "--resume", "--json", "-o", picture]
        made = subprocess.run(command, cwd=root, check=True, stdout=subprocess.PIPE, text=True)
        report.write_text(made.stdout)
    subprocess.run([etalon, "develop", picture, *develop, "--quiet", "-o", here / f"{name}.png"], check=True)
    return "etalon " + " ".join(words) + f" -o {name}.exr", json.loads(report.read_text())


def receipt(report):
    error = report["error"]
    lines = [f"{100 * error['relative_rmse']:.1f} % error", f"{report['spp']} samples a pixel", f"{told(report['seconds'])} of processor time"
             + (f" on each of {report['threads']} threads" if report["threads"] > 1 else "")]
    if error["heavy_tailed"]:
        lines.append("rare bright paths make up much of the error, which is probably larger")
    return "; ".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etalon", nargs="?", default=root / "target/release/etalon", type=pathlib.Path)
    parser.add_argument("--only", type=lambda text: text.split(","), help="these pictures; the page is not written")
    parser.add_argument("--error", default="2%", help="default: 2%%")
    parser.add_argument("--threads", type=int, help="default: all cores; does not change the pictures")
    args = parser.parse_args()
    etalon = args.etalon.resolve()
    sections = []
    for name, scene, options, develop, words in PICTURES:
        if args.only and name not in args.only:
            continue
        command, report = render(etalon, name, scene, options, develop, args.threads, args.error)
        print(f"{name}: {receipt(report)}")
        sections.append(f"## {name.capitalize()}\n\n![{words.split('.')[0]}]({name}.png)\n\n{words}\n\n```sh illustrative\n{command}\n"
                        f"etalon develop {name}.exr {' '.join(develop)} -o {name}.png\n```\n\n{receipt(report).capitalize()}.\n")
    if not args.only:
        head = ("# Gallery\n\nEach picture states its error and what it cost. `python3 docs/gallery/gallery.py` renders them all and writes this page. The models and images\n"
                "are made by the scripts in [scenes/generators](../../scenes/generators). No picture was denoised or retouched.\n\n")
        (here / "README.md").write_text(head + "\n".join(sections))


main()
