"""Writes scenes/water.json, its meshes and its sky: a glass of water with a straw on a wooden table, in the open. Plain standard library.

The sky is computed, not photographed: a hazy morning with a low sun behind haze, and a line of trees around the horizon.
"""

import math
import os
import random

import scene_text
from evening import rgbe
from meshes import lathe

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "water-files")
WIDTH, HEIGHT = 512, 256
SUN_ELEVATION_DEG, SUN_AZIMUTH_DEG = 30.0, -38.0

# The glass, m: radius at the foot and at the rim, height, thickness of the wall and of the foot.
FOOT, RIM, TALL, WALL, BASE = 0.030, 0.0385, 0.118, 0.0022, 0.011
LEVEL = 0.078  # of the water
CAPILLARY = 0.0027  # length, m: the water rises by this order at the wall


def direction(elevation_deg, azimuth_deg):
    e, a = math.radians(elevation_deg), math.radians(azimuth_deg)
    return (math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a))


SUN = direction(SUN_ELEVATION_DEG, SUN_AZIMUTH_DEG)


def trees(seed=5):
    """The elevation of the tops of the trees at each azimuth, degrees."""
    rng = random.Random(seed)
    waves = [(n, rng.uniform(0, 2 * math.pi), rng.uniform(0.3, 1) / (1 + 0.09 * n)) for n in range(2, 160)]
    rise = lambda a: sum(w * math.sin(n * a + p) for n, p, w in waves)
    return [max(1.0, 6.0 + 1.6 * rise(2 * math.pi * column / WIDTH)) for column in range(WIDTH)]


def radiance(elevation_deg, azimuth_deg, top_deg, shade):
    """Linear Rec. 709."""
    d = direction(elevation_deg, azimuth_deg)
    off = math.degrees(math.acos(max(-1.0, min(1.0, sum(a * b for a, b in zip(d, SUN))))))
    zenith, horizon, glow, sun = (0.22, 0.42, 0.85), (1.25, 1.15, 1.0), (5.0, 3.6, 2.1), (150.0, 112.0, 70.0)
    pale = math.exp(-max(0.0, elevation_deg) / 16)
    warm, disk = math.exp(-off / 13), math.exp(-((off / 3.5) ** 2))
    sky = [z + pale * (h - z) + warm * g + disk * s for z, h, g, s in zip(zenith, horizon, glow, sun)]
    if elevation_deg < -0.7:
        # A meadow, which mist makes pale far away.
        mist = math.exp(elevation_deg / 5)
        return [(0.6 + 0.4 * shade) * v + mist * w for v, w in zip((0.10, 0.15, 0.04), (0.25, 0.26, 0.2))]
    # Leaves let some of the sky through near their tops.
    within = max(0.0, min(1.0, (top_deg - elevation_deg) / 1.2))
    leaves = [shade * v for v in (0.07, 0.11, 0.03)]
    return [s + within * (l - s) for s, l in zip(sky, leaves)]


def sky():
    """Radiance HDR, not compressed: rows from the top, the middle of the picture at azimuth 0."""
    tops, rng = trees(), random.Random(11)
    texels = b""
    for row in range(HEIGHT):
        for column in range(WIDTH):
            elevation, azimuth = 90 - (row + 0.5) / HEIGHT * 180, (column + 0.5) / WIDTH * 360 - 180
            texels += rgbe(radiance(elevation, azimuth, tops[column], rng.uniform(0.2, 1.8)))
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n".encode() + texels


def rounded(corner, before, after, radius, steps=6):
    """Points around a corner of an outline, from the edge that comes from `before` to that which goes on to `after`."""
    toward = lambda p: tuple((a - b) / math.dist(p, corner) for a, b in zip(p, corner))
    a, b = toward(before), toward(after)
    begin, end = [tuple(c + radius * v for c, v in zip(corner, d)) for d in (a, b)]
    point = lambda t: tuple((1 - t) ** 2 * p + 2 * t * (1 - t) * c + t * t * q for p, c, q in zip(begin, corner, end))
    return [point(k / steps) for k in range(steps + 1)]


def wall(height):
    """The outer radius of the glass at a height."""
    return FOOT + (RIM - FOOT) * (height / TALL) ** 1.3


def tumbler():
    heights = [TALL * k / 24 for k in range(1, 24)]
    outside = [(wall(y), y) for y in heights if y > 0.004 and y < TALL - 0.002]
    inside = [(wall(y) - WALL, y) for y in reversed(heights) if y > BASE + 0.008 and y < TALL - 0.002]
    foot = rounded((FOOT, 0.0), (0.0, 0.0), outside[0], 0.003)
    rim_outer, rim_inner = (wall(TALL), TALL), (wall(TALL) - WALL, TALL)
    rim = rounded(rim_outer, outside[-1], rim_inner, WALL * 0.48) + rounded(rim_inner, rim_outer, inside[0], WALL * 0.48)
    bottom = rounded((wall(BASE) - WALL, BASE), inside[-1], (0.0, BASE), 0.006)
    # The bottom of a pressed glass is hollow.
    hollow = [(0.0, 0.0016), (0.5 * FOOT, 0.0012), (0.75 * FOOT, 0.0004)]
    return lathe(hollow + foot + outside + rim + inside + bottom + [(0.0, BASE)], segments=128, smooth_deg=40)


def water():
    """It reaches into the wall, which fills the place there."""
    into = 0.5 * WALL
    side = [(wall(y) - WALL + into, y) for y in [BASE + (LEVEL + 0.003 - BASE) * k / 12 for k in range(13)]]
    edge = wall(LEVEL) - WALL
    rise = lambda r: LEVEL + 0.0022 * math.exp((r - edge) / CAPILLARY)
    surface = [(r, rise(r)) for r in [side[-1][0], edge + 0.0004] + [edge - 0.012 * k / 14 for k in range(15)] + [0.012, 0.0]]
    # Below the surface of the glass's bottom, too.
    return lathe([(0.0, BASE - into), (side[0][0] - 0.004, BASE - into)] + side + surface, segments=128, smooth_deg=40)


def straw():
    """A paper straw with stripes, which stands in the water."""
    begins, ends, stripe = (-0.017, BASE + 0.0035, 0.006), (0.048, 0.176, -0.020), 0.0085
    length = math.dist(begins, ends)
    along = lambda t: [round(a + (b - a) * t / length, 6) for a, b in zip(begins, ends)]
    count = int(length / stripe)
    return [
        {
            "name": f"stripe {k + 1} of the straw", "material": "red paper" if k % 2 else "white paper",
            "shape": {"type": "cylinder", "start_m": along(k * stripe), "end_m": along((k + 1) * stripe), "radius_m": 0.003},
        }
        for k in range(count)
    ]


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    with open(os.path.join(FOLDER, "sky.hdr"), "wb") as file:
        file.write(sky())
    tumbler().write(os.path.join(FOLDER, "tumbler.ply"))
    water().write(os.path.join(FOLDER, "water.ply"))
    mesh = lambda name: {"type": "mesh", "file": f"water-files/{name}.ply"}
    scene_text.write("water", {
        "etalon": 1,
        "comment": [
            "A glass of water with a straw on a wooden table, on a hazy morning.",
            "Look at: the trees behind it, upside down in the water and upright in the empty part of the glass; the straw, which breaks at the",
            "surface; the light that glass and water gather on the table; the water's rim, which rises at the wall.",
            "Glass and water fill their places by priority: where they touch there is one interface. Written by scenes/generators/water.py.",
        ],
        "camera": {
            "type": "perspective", "position_m": [-0.06, 0.098, 0.44], "look_at_m": [0.008, 0.066, 0], "horizontal_fov_deg": 30,
            "lens": {"radius_m": 0.006, "focus_distance_m": 0.44},
        },
        "film": {"width": 480, "height": 360},
        "integrator": {"spp": 256},
        "materials": {
            "glass": {"type": "dielectric", "interior": 1.517, "priority": 2},
            "water": {"type": "dielectric", "interior": 1.333, "priority": 1},
            "wood": {
                "type": "plastic", "alpha": 0.3,
                "reflectance": {"type": "image", "file": "room-files/boards.png", "uv_scale": [1.5, 1.5]},
            },
            "white paper": {"type": "lambert", "reflectance": 0.75},
            "red paper": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.62, 0.05, 0.04]}},
        },
        "objects": [
            {
                "name": "table", "material": "wood",
                "shape": {"type": "parallelogram", "origin_m": [-0.7, 0, 0.5], "u_m": [1.4, 0, 0], "v_m": [0, 0, -0.9]},
            },
            {"name": "glass", "shape": mesh("tumbler"), "material": "glass", "transform": [{"translate_m": [0, 0.0002, 0]}]},
            {"name": "water", "shape": mesh("water"), "material": "water", "transform": [{"translate_m": [0, 0.0002, 0]}]},
            *straw(),
        ],
        "lights": [{
            "type": "environment", "name": "sky", "image": {"file": "water-files/sky.hdr", "forward": [0, 0, -1], "rotation_deg": 0},
        }],
    })
