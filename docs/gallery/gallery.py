#!/usr/bin/env python3
"""Renders the pictures of docs/gallery and writes docs/gallery/README.md: each picture with its command, time and error.

    python3 docs/gallery/gallery.py [path of etalon] [--error PERCENT] [--time SECONDS] [--only NAME,NAME] [--threads N]

Renders are kept in target/gallery with their checkpoints. What is finished is not rendered again, and an interrupted render continues.
docs/gallery/receipts.json has what each picture cost. The page shows the pictures that it names.
Needs nothing but Python.
"""
import argparse
import json
import pathlib
import subprocess
from typing import NamedTuple

here = pathlib.Path(__file__).resolve().parent
root = here.parent.parent


class Picture(NamedTuple):
    name: str
    scene: str
    develop: list  # options of etalon develop
    words: str  # what it is, and what to look at
    error: str = "5%"
    size: str = "540x360"


PICTURES = [
    Picture("bubble", "scenes/bubble.json", ["--exposure", "0"],
            "A soap bubble between two windows. No pigment: both faces of a film of water reflect, and the two waves interfere. The film is thin at the "
            "top, where the bubble is black, and thick at the bottom, where the colours grow pale.", size="360x360"),
    Picture("titanium", "scenes/titanium.json", ["--exposure", "1"],
            "Eight rods of titanium. Each has a thicker layer of clear oxide than its left neighbour, from none to 140 nm, and no dye. Each changes its "
            "colour toward its edges, where light crosses the layer at an angle.", size="480x270"),
    Picture("coatings", "scenes/coatings.json", ["--exposure", "0.7"],
            "Four plates of glass mirror a window: bare glass, an anti-reflection coating of one layer, one of three layers, and a mirror of thirteen. "
            "What a plate does not reflect it passes: see the paper behind the fourth.", size="480x270"),
    Picture("disc", "scenes/disc.json", ["--exposure", "0.7"],
            "A compact disc under two lamps. Its tracks are a grating. The spectra point to the middle, blue nearest to the mirror image of their lamp.",
            error="10%", size="480x320"),
    Picture("black-light", "scenes/black-light.json", ["--exposure", "1", "--curve", "agx"],
            "Balls of paint on a sheet of paper under a black light, a tube that shines near 368 nm. They and the paper give back what they absorb at longer waves. Look at the "
            "light of the balls on the paper.", error="10%", size="480x320"),
    Picture("double-gauss", "scenes/double-gauss.json", ["--exposure", "2", "--curve", "agx"],
            "Marbles on a table, through a double Gauss lens of 50 mm at f/2: every ray is traced through its eleven faces. Look at the lanterns far behind: the lens "
            "shows each as the image of its own pupil, round in the middle and cut off toward the corners.", error="10%", size="480x320"),
    Picture("bench", "scenes/bench.json", ["--exposure", "0.7", "--curve", "agx"],
            "A spectroscope on an optical bench. A lamp house, a slit, and a 60° prism of N-SF11, whose white table the light just touches. Look at the fan of "
            "colours behind the prism, at the white light that its first face mirrors, and at the spectrum on the card. Paths from the lamp bring all three.",
            size="540x320"),
    Picture("prism-in-smoke", "scenes/prism-in-smoke.json", ["--exposure", "5"],
            "A beam of white light goes through a prism in a smoky room. The spectrum stands in the air: smoke scatters each colour where the glass has "
            "sent it. The beam has no area; paths find it through the glass.", error="10%", size="480x270"),
    Picture("fog", "scenes/fog.json", ["--exposure", "0"],
            "A spot behind a row of bars in a misty hall. Look at the shafts of light between the bars, at their shadows in the mist, and at how far "
            "lamps and walls fade away.", size="480x300"),
    Picture("wax", "scenes/wax.json", ["--exposure", "1", "--curve", "agx"],
            "Candles of wax and a block of soap with a warm lamp behind it. Look at the thin parts: light that goes through them comes out warm, since "
            "long waves are absorbed less. All of it is scattering inside a rough interface.", size="480x360"),
    Picture("cloud", "scenes/cloud.json", ["--exposure", "0", "--curve", "agx"],
            "A cloud of drops in the afternoon sun. Light is scattered a hundred times in it: look at the rim toward the sun, at the dark base, and at "
            "the blue of the sky in the shadows.", size="480x300"),
    Picture("milk", "scenes/milk.json", ["--exposure", "-0.3", "--curve", "agx"],
            "A glass of milk and one of watered milk. Short waves are scattered more: the watered milk is bluish where light comes from the side, and "
            "reddish where light comes through.", error="10%", size="320x240"),
    Picture("movement", "scenes/movement.glb", ["--exposure", "0.7", "--curve", "agx"],
            "The movement of a watch, from a glTF model. Look at the stripes of the bridges, which brushing makes change from bright to dark as they turn "
            "away from the lamp; at the rubies, whose red is the path of the light through them; at the spring, a ribbon of 35 µm."),
    Picture("watch", "scenes/watch.json", ["--exposure", "0.3", "--curve", "agx"],
            "A wrist watch. The dial is brushed from the middle outward, the case around. The two bright fans of the dial stand across the lamps, as they "
            "do on real dials."),
    Picture("diamonds", "scenes/diamonds.json", ["--exposure", "-0.5", "--curve", "agx"],
            "Cut diamonds on black glass: a round brilliant, an emerald cut, an oval, and small brilliants. Wide lamps make brilliance, the white light that a "
            "stone returns. Rows of narrow lamps make fire, the pure colours at their edges. Nothing but the index of diamond colours the light.", size="432x288"),
    Picture("rosette", "scenes/rosette.json", ["--exposure", "0.6"],
            "A window without coloured glass: stacks of clear film between crossed polarisers. Only the delay of each stack, 115 nm a sheet, decides its "
            "colour. The outer ring is Michel-Lévy's chart from 1 to 24 sheets and back. The varnished floor polarises what it mirrors."),
    Picture("room", "scenes/room.json", ["--exposure", "1.0", "--curve", "agx"],
            "A room into which the sun shines. All but the patches of sun is lit by way of the walls: the floor throws warm light on the shelves.", error="10%"),
    Picture("water", "scenes/water.json", ["--exposure", "0.3"],
            "A glass of water on a wooden table, on a hazy morning. Look at the straw, which breaks at the surface; at the trees upside down in the water; and "
            "at the light that glass and water gather on the table. The sky is an image, and nothing else shines.", size="480x360"),
    Picture("chess", "scenes/chess.json", ["--exposure", "1.5", "--curve", "agx"],
            "Chess men close up, by a lens of 75 mm at f/4. The disks behind are images of the lens, one for each lamp of the string.", error="10%"),
]


BESIDE_OTHERS = """
## Beside other galleries

On 29 November 2026 these pictures were laid beside the 33 scenes and seven banners of Mitsuba 3's gallery, and beside the pictures in pbrt-v4's repository.

- The watch, the movement, the chess men and the glass of water hold their own. Brushed metal, the blur of the lens and the light that gathers behind glass look as
  good as in any picture there.
- Their interiors are richer: kitchens, bathrooms and staircases by artists, where ours is one room of boxes and books. Their gallery has hair, fur and cars. Etalon
  does not render hair.
- Theirs has no soap film, no grating, no crossed polarisers, no fluorescent paint and no spectrum. These pictures are what Etalon is for.
- The coatings, the titanium rods and the black light look like plates of a textbook. The bubble, the black light, the prism in smoke, the cloud, the wax and the milk are still noisy.
- No picture there states its error or its time.
"""


def told(seconds):
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    return f"{int(seconds // 60)} min {round(seconds % 60)} s"


def render(etalon, picture, error, time, threads):
    """Renders and develops a picture; gives the report of the render."""
    folder = root / "target/gallery"
    folder.mkdir(parents=True, exist_ok=True)
    limit = error.rstrip("%") + (f"-{time}" if time else "")
    file, report = folder / f"{picture.name}-{limit}.exr", folder / f"{picture.name}-{limit}.json"
    if not report.exists():
        more = ["--threads", str(threads)] if threads else []
        if file.with_name(file.name + ".checkpoint").exists():
            more.append("--resume")
        command = [etalon, *words(picture, error, time), *more, "--clock", "cpu", "--checkpoint", "60s", "--json", "-o", file]
        made = subprocess.run(command, cwd=root, check=True, stdout=subprocess.PIPE, text=True)
        report.write_text(made.stdout)
    subprocess.run([etalon, "develop", file, *picture.develop, "--quiet", "-o", here / f"{picture.name}.png"], check=True)
    return json.loads(report.read_text())


def words(picture, error, time):
    return ["render", picture.scene, "--size", picture.size, "--error", error, *(["--time", time] if time else [])]


def receipt(report):
    error = report["error"]
    lines = [f"{100 * error['relative_rmse']:.1f} % error", f"{report['spp']} samples a pixel", f"{told(report['seconds'])} of processor time"
             + (f" on each of {report['threads']} threads" if report["threads"] > 1 else "")]
    if error["heavy_tailed"]:
        lines.append("rare bright paths make up much of the error, which is probably larger")
    return "; ".join(lines)


def section(picture, receipt):
    name = picture.name
    command = "etalon " + " ".join(words(picture, receipt["error"], receipt["time"])) + f" -o {name}.exr"
    return (f"## {name.capitalize()}\n\n![{picture.words.split('.')[0]}]({name}.png)\n\n{picture.words}\n\n```sh illustrative\n{command}\n"
            f"etalon develop {name}.exr {' '.join(picture.develop)} -o {name}.png\n```\n\n{receipt['cost'].capitalize()}.\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("etalon", nargs="?", default=root / "target/release/etalon", type=pathlib.Path)
    parser.add_argument("--only", type=lambda text: text.split(","), help="these pictures")
    parser.add_argument("--error", help="of all pictures; default: 5%% or 10%%, as the list says")
    parser.add_argument("--time", help="end each render after this time, such as 90s, with the error that it has then")
    parser.add_argument("--threads", type=int, help="default: all cores; does not change the pictures")
    args = parser.parse_args()
    etalon = args.etalon.resolve()
    kept = here / "receipts.json"
    receipts = json.loads(kept.read_text()) if kept.exists() else {}
    for picture in PICTURES:
        if args.only and picture.name not in args.only:
            continue
        error = args.error or picture.error
        cost = receipt(render(etalon, picture, error, args.time, args.threads))
        print(f"{picture.name}: {cost}", flush=True)
        receipts[picture.name] = {"error": error, "time": args.time, "cost": cost}
        kept.write_text(json.dumps(receipts, indent=2, ensure_ascii=False, sort_keys=True) + "\n")
    write_page(receipts)


def write_page(receipts):
    head = ("# Gallery\n\nEach picture states its error and what it cost. `python3 docs/gallery/gallery.py` renders them all and writes this page. The models and images\n"
            "are made by the scripts in [scenes/generators](../../scenes/generators). No picture was denoised or retouched.\n\n")
    shown = [section(picture, receipts[picture.name]) for picture in PICTURES if picture.name in receipts]
    (here / "README.md").write_text(head + "\n".join(shown) + BESIDE_OTHERS)


main()
