"""Writes scenes/chess.json, its meshes and its board: chess men close up, with a string of lamps far out of focus behind them.

Plain standard library.
"""

import math
import os
import random

import scene_text
from meshes import Mesh, lathe
from vase import write_png

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "chess-files")
SQUARE = 0.05


def round_over(radius, height, size, tall, steps=7):
    """A bead around the axis: half an ellipse of this size and height, from below."""
    return [(radius + size * math.sin(math.pi * i / steps), height + tall * (1 - math.cos(math.pi * i / steps)) / 2) for i in range(steps + 1)]


def curve(start, pull, end, steps=10):
    """A quadratic Bézier curve of (radius, height)."""
    return [tuple((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in zip(start, pull, end)) for t in (i / steps for i in range(steps + 1))]


def ball(radius, middle, from_radius, steps=16):
    """A sphere on the axis, from where its lower half has this radius to the pole."""
    first = -math.pi / 2 + math.asin(from_radius / radius)
    return [(radius * math.cos(a) if i < steps else 0.0, middle + radius * math.sin(a)) for i in range(steps + 1) for a in [first + (math.pi / 2 - first) * i / steps]]


def foot(radius):
    k = radius / 0.019
    return [(0, 0), (radius, 0), *round_over(radius - 0.0012 * k, 0.0005, 0.0012 * k, 0.005 * k), (radius * 0.86, 0.0062 * k),
            *curve((radius * 0.84, 0.0062 * k), (radius * 0.80, 0.0105 * k), (radius * 0.62, 0.0115 * k), 8)]


def pawn():
    return [*foot(0.0155), *curve((0.0095, 0.0095), (0.0048, 0.014), (0.0046, 0.027)), *round_over(0.0046, 0.0272, 0.0052, 0.0028), *ball(0.0078, 0.0363, 0.0045)]


def bishop():
    head = [(0.0042 + 0.0046 * math.sin(math.pi * (i / 24) ** 0.8) ** 0.9 if i < 24 else 0.0012, 0.0455 + 0.0185 * i / 24) for i in range(25)]
    return [*foot(0.0172), *curve((0.0106, 0.0105), (0.0048, 0.018), (0.0047, 0.038)), *round_over(0.0047, 0.0382, 0.0056, 0.0028), (0.0046, 0.0418),
            *round_over(0.0046, 0.042, 0.003, 0.002), *head, *ball(0.0022, 0.0655, 0.001)]


def king():
    return [*foot(0.0195), *curve((0.012, 0.012), (0.0055, 0.022), (0.0055, 0.052)), *round_over(0.0055, 0.0522, 0.0068, 0.0032), (0.0056, 0.0562),
            *round_over(0.0056, 0.0564, 0.0040, 0.0024), *curve((0.0058, 0.059), (0.0072, 0.068), (0.0106, 0.075)), *round_over(0.0100, 0.0752, 0.0014, 0.002),
            *curve((0.0098, 0.0774), (0.0080, 0.0815), (0.0022, 0.0825), 8), (0.0, 0.0827)]


def queen():
    return [*foot(0.0188), *curve((0.0116, 0.0115), (0.0053, 0.02), (0.0052, 0.047)), *round_over(0.0052, 0.0472, 0.0064, 0.003), (0.0054, 0.051),
            *round_over(0.0054, 0.0512, 0.0036, 0.0022), *curve((0.0056, 0.0535), (0.0064, 0.061), (0.0112, 0.0685)), (0.0098, 0.0682), *curve((0.0096, 0.0682), (0.007, 0.0716), (0.0026, 0.072), 8),
            *ball(0.0030, 0.0745, 0.0018)]


def rook():
    return [*foot(0.0172), *curve((0.0112, 0.0105), (0.0068, 0.016), (0.0072, 0.034)), *round_over(0.0072, 0.0342, 0.003, 0.0022), (0.0098, 0.038), (0.0101, 0.0465), (0.0072, 0.0465), (0.0070, 0.0425), (0.0, 0.0425)]


def cross():
    mesh = Mesh()
    for (w, low, high) in ((0.0011, 0.0822, 0.0925), (0.0036, 0.0868, 0.0890)):
        d = 0.0011
        for corners in (
            [(-w, low, d), (w, low, d), (w, high, d), (-w, high, d)], [(w, low, -d), (-w, low, -d), (-w, high, -d), (w, high, -d)],
            [(w, low, d), (w, low, -d), (w, high, -d), (w, high, d)], [(-w, low, -d), (-w, low, d), (-w, high, d), (-w, high, -d)],
            [(-w, high, d), (w, high, d), (w, high, -d), (-w, high, -d)], [(-w, low, -d), (w, low, -d), (w, low, d), (-w, low, d)],
        ):
            mesh.face(corners)
    return mesh


def board(side=512):
    """Two squares by two, with grain along the rows."""
    rng = random.Random(5)
    waves = [[(rng.uniform(8, 40), rng.uniform(0, 6.28), rng.uniform(0.3, 1)) for _ in range(6)] for _ in range(4)]
    picture = []
    for j in range(side):
        line = []
        for i in range(side):
            x, y = 2 * i / side, 2 * j / side
            which = int(x) % 2 + 2 * (int(y) % 2)
            u, v = x % 1, y % 1
            grain = sum(a * math.sin(f * v + 2.5 * math.sin(3 * u + p) + p) for f, p, a in waves[which])
            seam = 0.55 if min(u, v, 1 - u, 1 - v) < 0.006 else 1.0
            base = (196, 150, 96) if which in (0, 3) else (92, 54, 32)
            line.append(tuple(max(0, min(255, round(c * seam * (0.93 + 0.035 * grain)))) for c in base))
        picture.append(line)
    return picture


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    write_png(os.path.join(FOLDER, "board.png"), board())
    rgb = lambda *v: {"type": "rgb", "rgb": list(v)}
    groups, men = {}, {"pawn": pawn, "bishop": bishop, "king": king, "queen": queen, "rook": rook}
    for name, profile in men.items():
        lathe(profile(), 72, smooth_deg=40).write(os.path.join(FOLDER, name + ".ply"))
    cross().write(os.path.join(FOLDER, "cross.ply"))
    for colour in ("boxwood", "ebony"):
        for name in men:
            files = [name] + (["cross"] if name == "king" else [])
            groups[f"{colour} {name}"] = {"objects": [
                {"name": file, "shape": {"type": "mesh", "file": f"chess-files/{file}.ply"}, "material": colour} for file in files]}
    places = [
        ("ebony", "king", 4, 0), ("ebony", "queen", 2, 2), ("ebony", "rook", 6, 3), ("ebony", "pawn", 5, -1), ("ebony", "pawn", 3, -1), ("ebony", "bishop", 7, 1), ("ebony", "pawn", 6, 0),
        ("boxwood", "king", 3, -3), ("boxwood", "bishop", 5, -3), ("boxwood", "queen", 1, -2), ("boxwood", "pawn", 4, -2), ("boxwood", "pawn", 2, -3), ("boxwood", "rook", 0, 1),
    ]
    instances = []
    for number, (colour, man, file, rank) in enumerate(places):
        instances.append({"group": f"{colour} {man}", "name": f"{colour} {man} {number + 1}",
                          "transform": [{"rotate": {"axis": [0, 1, 0], "angle_deg": 24 if "king" in man else 0}}, {"translate_m": [(file - 3.5) * SQUARE, 0, -(rank + 0.5) * SQUARE]}]})
    rng, lamps = random.Random(8), []
    hues = [(1.0, 0.62, 0.30), (1.0, 0.72, 0.42), (1.0, 0.55, 0.25), (0.55, 0.75, 1.0), (1.0, 0.35, 0.22), (0.9, 0.85, 0.7)]
    for strand in range(3):
        for k in range(15):
            t = k / 14
            x = -0.75 + 2.1 * t + rng.uniform(-0.03, 0.03)
            y = 0.30 - 0.16 * strand - 0.14 * math.sin(math.pi * ((t * 2 + 0.3 * strand) % 1)) + rng.uniform(-0.02, 0.02)
            lamps.append({"name": f"lamp {len(lamps) + 1}", "shape": {"type": "sphere", "center_m": [x, y, -1.75 - 0.12 * strand], "radius_m": 0.014},
                          "material": "nothing", "emission": {"radiance": {"type": "rgb", "rgb": list(rng.choice(hues)), "scale": round(rng.uniform(14, 26), 1)}}})
    scene_text.write("chess", {
        "etalon": 1,
        "comment": [
            "Chess men, close up: a lens of 75 mm at f/4, focused on the white king. Look at: the disks of the lamps behind, which are images",
            "of the lens and all of one size; how fast the board loses its focus toward the viewer. Written by scenes/generators/chess.py.",
        ],
        "camera": {"type": "perspective", "position_m": [-0.16, 0.115, 0.60], "look_at_m": [-0.012, 0.058, 0.10], "focal_length_m": 0.075, "sensor_width_m": 0.036,
                   "lens": {"f_number": 4, "focus_distance_m": 0.475}},
        "film": {"width": 768, "height": 512, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "materials": {
            "boxwood": {"type": "plastic", "reflectance": rgb(0.62, 0.41, 0.20), "alpha": 0.12},
            "ebony": {"type": "plastic", "reflectance": rgb(0.035, 0.026, 0.022), "alpha": 0.12},
            "board": {"type": "plastic", "reflectance": {"type": "image", "file": "chess-files/board.png", "uv_scale": [4, 4]}, "alpha": 0.1},
            "table": {"type": "plastic", "reflectance": rgb(0.05, 0.03, 0.02), "alpha": 0.2},
            "wall": {"type": "lambert", "reflectance": rgb(0.05, 0.06, 0.08)},
            "nothing": {"type": "black"},
        },
        "groups": groups,
        "objects": [
            {"name": "board", "shape": {"type": "parallelogram", "origin_m": [-0.2, 0, 0.2], "u_m": [0.4, 0, 0], "v_m": [0, 0, -0.4]}, "material": "board"},
            {"name": "table", "shape": {"type": "parallelogram", "origin_m": [-2, -0.008, 1], "u_m": [4, 0, 0], "v_m": [0, 0, -2.4]}, "material": "table"},
            {"name": "wall", "shape": {"type": "parallelogram", "origin_m": [-4, -1, -2.4], "u_m": [8, 0, 0], "v_m": [0, 4, 0]}, "material": "wall"},
            {"name": "window at the left", "shape": {"type": "parallelogram", "origin_m": [-0.9, 0.1, -0.3], "u_m": [0, 0.8, 0], "v_m": [0.1, 0, 0.8]}, "material": "nothing",
             "emission": {"radiance": rgb(0.8, 0.95, 1.2), "sides": "both"}},
            {"name": "lamp at the right", "shape": {"type": "parallelogram", "origin_m": [0.55, 0.35, -0.35], "u_m": [0, 0.3, 0.05], "v_m": [-0.25, 0.05, -0.2]}, "material": "nothing",
             "emission": {"radiance": {"type": "rgb", "rgb": [1.3, 0.85, 0.5], "scale": 4}, "sides": "both"}},
            *lamps,
        ],
        "instances": instances,
        "lights": [{"type": "environment", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.03}}],
        "integrator": {"spp": 256},
    })
