"""Writes scenes/room.json, its meshes and its images: a room with a wooden floor, a table and shelves of books, into which the sun
shines. Plain standard library."""

import math
import os
import random

import scene_text
from meshes import Mesh, lathe
from vase import write_png

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "room-files")
WIDE, TALL, DEEP = 4.2, 2.7, 5.0  # x from the window wall at 0, y, z toward the viewer
WINDOW = (1.1, 2.9, 0.75, 2.25)  # z and y of the opening


def boards(side=512, rows=8, seed=3):
    """A floor of boards: each has a colour of its own and grain along x."""
    rng = random.Random(seed)
    ends = [rng.random() for _ in range(rows)]
    tints = [[rng.uniform(0.72, 1.0) for _ in range(2)] for _ in range(rows)]
    waves = [[(rng.uniform(3, 14), rng.uniform(0, 6.28), rng.uniform(0.2, 1)) for _ in range(5)] for _ in range(rows)]
    picture = []
    for y in range(side):
        row, within = divmod(y * rows / side, 1)
        row = int(row)
        line = []
        for x in range(side):
            along = (x / side + ends[row]) % 1
            half = int(along * 2)
            seam = min(within, 1 - within) < 0.018 or min(along * 2 % 1, 1 - along * 2 % 1) < 0.006
            grain = sum(a * math.sin(f * 6.2832 * (within + 0.06 * math.sin(6.2832 * along + p)) + p) for f, p, a in waves[row])
            shade = tints[row][half] * (0.9 + 0.045 * grain) * (0.35 if seam else 1)
            line.append(tuple(max(0, min(255, round(c * shade))) for c in (182, 128, 78)))
        picture.append(line)
    return picture


def rug(side=256):
    """Lozenges in rings of three colours, and a border."""
    wool = [(150, 44, 38), (222, 196, 150), (38, 56, 92), (190, 120, 50)]
    picture = []
    for j in range(side):
        line = []
        for i in range(side):
            u, v = (i + 0.5) / side, (j + 0.5) / side
            edge = min(u, v, 1 - u, 1 - v)
            if edge < 0.035:
                colour = wool[1]
            elif edge < 0.09:
                colour = wool[2] if (int((u + v) * 40) + int((u - v) * 40)) % 2 else wool[3]
            else:
                away = abs((u * 4) % 1 - 0.5) + abs((v * 4) % 1 - 0.5)
                colour = wool[[3, 0, 1, 2, 0][min(4, int(away * 5))]]
            rough = 0.88 + 0.12 * random.Random(j * side + i).random()
            line.append(tuple(round(c * rough) for c in colour))
        picture.append(line)
    return picture


def painting(side=192):
    """Hills under an evening sky."""
    picture = []
    for j in range(side):
        line = []
        for i in range(side):
            x, y = i / side, 1 - j / side
            colour = (int(240 - 90 * y), int(150 + 50 * y), int(110 + 110 * y))
            for k, (base, tint) in enumerate([(0.52, (110, 110, 140)), (0.38, (70, 92, 90)), (0.22, (40, 60, 44))]):
                hill = base + 0.09 * math.sin(5 * x + 2.1 * k) + 0.04 * math.sin(13 * x + 1.3 * k * k)
                if y < hill:
                    colour = tint
            if math.hypot(x - 0.68, y - 0.72) < 0.07:
                colour = (255, 236, 180)
            line.append(colour)
        picture.append(line)
    return picture


def box(mesh, low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    for corners in (
        [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)], [(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)],
        [(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)], [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)],
        [(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)], [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)],
    ):
        wide = math.dist(corners[0], corners[1])
        tall = math.dist(corners[1], corners[2])
        mesh.face(corners, [(0, 0), (wide, 0), (wide, tall), (0, tall)])


def boxes(*pairs):
    mesh = Mesh()
    for low, high in pairs:
        box(mesh, low, high)
    return mesh


def curtain(z0, z1, y0, y1, x, folds, depth):
    mesh, steps = Mesh(), folds * 10
    row = []
    for i in range(steps + 1):
        t = i / steps
        phase = 2 * math.pi * folds * t
        slope = depth * math.cos(phase) * 2 * math.pi * folds / (z1 - z0)
        size = math.hypot(1, slope)
        normal = (1 / size, 0, -slope / size)
        at = (x + depth * math.sin(phase), z0 + t * (z1 - z0))
        row.append((mesh.vertex((at[0], y0, at[1]), normal), mesh.vertex((at[0], y1, at[1]), normal)))
    for (a, b), (c, d) in zip(row, row[1:]):
        mesh.triangles += [(a, b, c), (b, d, c)]
    return mesh


def books(rng, x0, x1, y, z, spectra):
    """A row of books between x0 and x1, their backs to the viewer, by colour."""
    rows, x = {}, x0
    while x < x1 - 0.05:
        thick, tall, depth = rng.uniform(0.018, 0.05), rng.uniform(0.2, 0.29), rng.uniform(0.15, 0.2)
        if rng.random() < 0.06:
            x += rng.uniform(0.03, 0.1)
            continue
        box(rows.setdefault(rng.choice(spectra), Mesh()), (x, y, z), (x + thick, y + tall, z + depth))
        x += thick + 0.002
    return rows


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    for name, picture in [("boards", boards()), ("rug", rug()), ("painting", painting())]:
        write_png(os.path.join(FOLDER, name + ".png"), picture)
    rgb = lambda *v: {"type": "rgb", "rgb": list(v)}
    image = lambda name, *scale, factor=1: {"type": "image", "file": f"room-files/{name}.png", "uv_scale": list(scale), "factor": [factor] * 3}
    objects = []

    def put(name, mesh, material, **more):
        file = name.replace(" ", "-") + ".ply"
        mesh.write(os.path.join(FOLDER, file))
        objects.append({"name": name, "shape": {"type": "mesh", "file": f"room-files/{file}"}, "material": material, **more})

    def sheet(name, origin, u, v, material, **more):
        objects.append({"name": name, "shape": {"type": "parallelogram", "origin_m": origin, "u_m": u, "v_m": v}, "material": material, **more})

    z0, z1, y0, y1 = WINDOW
    sheet("floor", [0, 0, DEEP], [WIDE, 0, 0], [0, 0, -DEEP], "boards")
    sheet("ceiling", [0, TALL, 0], [WIDE, 0, 0], [0, 0, DEEP], "white")
    sheet("far wall", [0, 0, 0], [WIDE, 0, 0], [0, TALL, 0], "plaster")
    sheet("right wall", [WIDE, 0, 0], [0, 0, DEEP], [0, TALL, 0], "plaster")
    sheet("near wall", [WIDE, 0, DEEP], [-WIDE, 0, 0], [0, TALL, 0], "plaster")
    thick = 0.25
    put("window wall", boxes(
        ((-thick, 0, 0), (0, y0, DEEP)), ((-thick, y1, 0), (0, TALL, DEEP)), ((-thick, y0, 0), (0, y1, z0)), ((-thick, y0, z1), (0, y1, DEEP)),
    ), "plaster")
    bar = 0.035
    middle = (z0 + z1) / 2
    put("window frame", boxes(
        ((-0.15, y0, z0), (-0.09, y1, z0 + bar)), ((-0.15, y0, z1 - bar), (-0.09, y1, z1)), ((-0.15, y0, middle - bar / 2), (-0.09, y1, middle + bar / 2)),
        ((-0.15, y0, z0), (-0.09, y0 + bar, z1)), ((-0.15, y1 - bar, z0), (-0.09, y1, z1)), ((-0.15, 1.62, z0), (-0.09, 1.62 + bar, z1)),
        ((-0.02, y0 - 0.03, z0 - 0.05), (0.14, y0, z1 + 0.05)),
    ), "paint")
    put("curtains", curtain(z0 - 0.3, z0 + 0.12, 0.08, y1 + 0.12, 0.13, 4, 0.035), "linen")
    objects[-1]["name"] = "curtain"
    put("other curtain", curtain(z1 - 0.12, z1 + 0.3, 0.08, y1 + 0.12, 0.13, 4, 0.035), "linen")
    objects.append({"name": "curtain rail", "shape": {"type": "cylinder", "start_m": [0.13, y1 + 0.14, z0 - 0.42], "end_m": [0.13, y1 + 0.14, z1 + 0.42], "radius_m": 0.014}, "material": "brass"})
    put("skirting", boxes(((0, 0, 0), (WIDE, 0.09, 0.018)), ((WIDE - 0.018, 0, 0), (WIDE, 0.09, DEEP)), ((0, 0, 0), (0.018, 0.09, DEEP))), "paint")
    sheet("rug", [0.75, 0.006, 3.35], [2.3, 0, 0], [0, 0, -1.75], "rug")
    # The table and what stands on it.
    tx, tz, th = 1.75, 2.15, 0.74
    legs = [((tx + sx * 0.62 - 0.03, 0, tz + sz * 0.34 - 0.03), (tx + sx * 0.62 + 0.03, th - 0.03, tz + sz * 0.34 + 0.03)) for sx in (-1, 1) for sz in (-1, 1)]
    put("table", boxes(((tx - 0.72, th - 0.035, tz - 0.44), (tx + 0.72, th, tz + 0.44)), ((tx - 0.62, th - 0.12, tz - 0.35), (tx + 0.62, th - 0.035, tz - 0.33)), ((tx - 0.62, th - 0.12, tz + 0.33), (tx + 0.62, th - 0.035, tz + 0.35)), *legs), "oak")
    objects.append({"name": "vase", "shape": {"type": "mesh", "file": "vase-files/vase.ply"}, "material": "glaze", "transform": [{"translate_m": [tx - 0.42, th, tz - 0.1]}]})
    bowl = lathe([(0.0, 0.0), (0.06, 0.0), (0.065, 0.012), (0.11, 0.035), (0.145, 0.075), (0.15, 0.082), (0.143, 0.08), (0.106, 0.042), (0.0, 0.02)], 96)
    put("bowl", bowl, "stoneware", transform=[{"translate_m": [tx + 0.18, th, tz + 0.05]}])
    for k, (x, y, z) in enumerate([(-0.05, 0.075, 0.02), (0.045, 0.07, 0.045), (0.02, 0.072, -0.05), (0.0, 0.135, 0.005)]):
        objects.append({"name": f"orange {k + 1}", "shape": {"type": "sphere", "center_m": [tx + 0.18 + x, th + y, tz + 0.05 + z], "radius_m": 0.042}, "material": "orange"})
    put("open book", boxes(((tx + 0.38, th, tz + 0.12), (tx + 0.55, th + 0.018, tz + 0.36)), ((tx + 0.56, th, tz + 0.12), (tx + 0.72, th + 0.014, tz + 0.36))), "paper")
    for name, cx, cz, back in (("chair", tx - 0.15, tz + 0.78, 1), ("other chair", tx + 0.95, tz - 0.1, 0)):
        w, seat = 0.22, 0.45
        posts = [((cx + sx * w - 0.018, 0, cz + sz * w - 0.018), (cx + sx * w + 0.018, 0.9 if (sz == 1 if back else sx == 1) else seat, cz + sz * w + 0.018)) for sx in (-1, 1) for sz in (-1, 1)]
        rails = [((cx - w, h, cz + w - 0.012), (cx + w, h + 0.06, cz + w + 0.012)) if back else ((cx + w - 0.012, h, cz - w), (cx + w + 0.012, h + 0.06, cz + w)) for h in (0.66, 0.82)]
        put(name, boxes(((cx - 0.235, seat - 0.025, cz - 0.235), (cx + 0.235, seat, cz + 0.235)), *posts, *rails), "oak")
    # Shelves of books on the far wall.
    sx0, sx1, rng = 2.15, 3.75, random.Random(11)
    shelf = [((sx0 - 0.03, 0, 0.02), (sx0, 2.1, 0.27)), ((sx1, 0, 0.02), (sx1 + 0.03, 2.1, 0.27))]
    shelf += [((sx0, y, 0.02), (sx1, y + 0.028, 0.27)) for y in (0.06, 0.44, 0.82, 1.20, 1.58, 2.07)]
    put("shelves", boxes(*shelf), "paint")
    covers = {"cloth red": (0.35, 0.05, 0.04), "cloth blue": (0.05, 0.09, 0.25), "cloth green": (0.05, 0.17, 0.09), "cloth cream": (0.62, 0.54, 0.38),
              "cloth ochre": (0.5, 0.28, 0.06), "cloth grey": (0.2, 0.2, 0.22), "cloth black": (0.03, 0.03, 0.035)}
    gathered = {}
    for y in (0.088, 0.468, 0.848, 1.228, 1.608):
        for colour, mesh in books(rng, sx0 + 0.01, sx1, y, 0.05, list(covers)).items():
            gathered.setdefault(colour, Mesh()).add(mesh)
    for colour, mesh in sorted(gathered.items()):
        put("books in " + colour, mesh, colour)
    sheet("painting", [0.7, 1.15, 0.03], [0.95, 0, 0], [0, 0.75, 0], "painting")
    put("frame", boxes(((0.64, 1.09, 0.001), (1.71, 1.15, 0.05)), ((0.64, 1.90, 0.001), (1.71, 1.96, 0.05)), ((0.64, 1.15, 0.001), (0.70, 1.90, 0.05)), ((1.65, 1.15, 0.001), (1.71, 1.90, 0.05))), "brass")
    shade = lathe([(0.2, 0.0), (0.09, 0.22), (0.085, 0.215), (0.195, 0.0)], 96)
    put("lamp shade", shade, "enamel", transform=[{"translate_m": [tx, 1.6, tz]}])
    objects.append({"name": "cord", "shape": {"type": "cylinder", "start_m": [tx, 1.8, tz], "end_m": [tx, TALL, tz], "radius_m": 0.004}, "material": "cloth black"})
    # The sky before the window, as a panel beneath the sun's rays.
    sheet("sky", [-2.2, 3.3, -1.4], [0, -3.8, 0], [0, 0, 6.8], "nothing", emission={"radiance": {"type": "rgb", "rgb": [0.72, 0.88, 1.15], "scale": 3}, "sides": "both"})
    cover = {name: {"type": "lambert", "reflectance": rgb(*value)} for name, value in covers.items()}
    scene_text.write("room", {
        "etalon": 1,
        "comment": [
            "A room into which the sun shines. Everything but the patches of sun is lit by way of the walls. Look at: the warm light that the",
            "floor throws on the shelves and the ceiling; the sun on the boards, the rug and the edge of the table; the soft shadow of the",
            "pendant lamp. Written by scenes/generators/room.py.",
        ],
        "camera": {"type": "perspective", "position_m": [3.75, 1.45, 4.75], "look_at_m": [1.55, 0.98, 1.2], "horizontal_fov_deg": 62},
        "film": {"width": 768, "height": 512, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "materials": {
            "boards": {"type": "plastic", "reflectance": image("boards", 2.6, 3.2, factor=0.9), "alpha": 0.25},
            "plaster": {"type": "lambert", "reflectance": rgb(0.74, 0.70, 0.62)},
            "white": {"type": "lambert", "reflectance": 0.82},
            "paint": {"type": "plastic", "reflectance": 0.72, "alpha": 0.2},
            "linen": {"type": "lambert", "reflectance": rgb(0.70, 0.66, 0.58)},
            "oak": {"type": "plastic", "reflectance": image("boards", 1.0, 0.5, factor=0.75), "alpha": 0.3},
            "rug": {"type": "oren-nayar", "reflectance": image("rug", 1, 1, factor=0.9), "roughness": 0.7},
            "painting": {"type": "lambert", "reflectance": image("painting", 1, 1, factor=0.9)},
            "glaze": {"type": "plastic", "reflectance": {"type": "image", "file": "vase-files/tiles.png", "uv_scale": [8, 6]}, "alpha": 0.06},
            "stoneware": {"type": "plastic", "reflectance": rgb(0.16, 0.22, 0.25), "alpha": 0.15},
            "orange": {"type": "plastic", "reflectance": rgb(0.85, 0.32, 0.03), "alpha": 0.3},
            "paper": {"type": "lambert", "reflectance": 0.78},
            "brass": {"type": "conductor", "reflectance": rgb(0.87, 0.68, 0.36), "alpha": 0.2},
            "enamel": {"type": "plastic", "reflectance": rgb(0.07, 0.16, 0.13), "alpha": 0.1},
            "nothing": {"type": "black"},
            **cover,
        },
        "objects": objects,
        "lights": [{"type": "directional", "direction": [0.66, -0.66, -0.20], "irradiance": {"type": "blackbody", "temperature_k": 5200, "scale": 4.5e-3}}],
        "integrator": {"spp": 256},
    })
