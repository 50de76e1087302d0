"""Writes scenes/bench.json and the tile of its breadboard: a prism on an optical bench, and the spectrum on a card.

Light of a point in the lamp house leaves through a slit along +x, crosses the prism's table at a grazing angle, and is
turned by the prism toward −z, onto the card. The prism stands a little off least deviation, so that the light leaves it at
a larger angle than it came in: this spreads the colours more, and the beam becomes narrower.

All is made of triangles, cylinders, disks and parallelograms. Plain standard library.
"""

import math
import os

import scene_text
from prism import index
from vase import write_png

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "bench-files")
BEAM = 0.105  # height of the beam above the board, m
LAMP, SLIT = -0.30, -0.205  # x of the point of light and of the slit, m
SLIT_WIDTH, SLIT_LOW, SLIT_HIGH = 0.0013, 0.0068, 0.0074  # m; below and above the beam's axis
TABLE_RADIUS, TABLE_THICK, TABLE_DROP = 0.095, 0.006, 0.016  # of the prism's table; its top lies this much below the axis, m
SIDE, TALL, PLINTH = 0.044, 0.044, 0.0013  # of the prism, m
INCIDENCE_DEG = 58.8  # on the first face
ENTERS = 0.56  # where the axis meets the first face: share of the way from the base to the refracting edge
CARD_DISTANCE, CARD_WIDTH, CARD_TALL = 0.43, 0.25, 0.16  # m
CARD_TURN_DEG = 34.0  # of the card, from square to the green light
PITCH = 0.025  # of the holes of the board, m


def rounded(v):
    return [round(x, 6) for x in v]


def turned(v, degrees):
    """A vector of the plan (x, z), turned counter-clockwise seen from above."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return (v[0] * c + v[1] * s, v[1] * c - v[0] * s)


def exit_angle(wavelength_nm):
    """Of the light that leaves the second face, degrees."""
    n = index(wavelength_nm)
    within = math.asin(math.sin(math.radians(INCIDENCE_DEG)) / n)
    return math.degrees(math.asin(n * math.sin(math.radians(60) - within)))


def deviation(wavelength_nm):
    return INCIDENCE_DEG + exit_angle(wavelength_nm) - 60


def thing(name, material, shape, **more):
    return {"name": name, "shape": shape, "material": material, **more}


def box(low, high):
    return {"type": "box", "min_m": rounded(low), "max_m": rounded(high)}


def rod(start, end, radius, capped=True):
    shape = {"type": "cylinder", "start_m": rounded(start), "end_m": rounded(end), "radius_m": radius}
    return shape if capped else {**shape, "capped": False}


def upright(middle, along, width, low, high):
    """An upright rectangle about a point of the plan; its normal is to the left of `along`, seen from above."""
    return {
        "type": "parallelogram", "origin_m": rounded([middle[0] - along[0] * width / 2, low, middle[1] - along[1] * width / 2]),
        "u_m": rounded([along[0] * width, 0, along[1] * width]), "v_m": rounded([0, high - low, 0]),
    }


def mesh(vertices, loops):
    """A closed body of flat faces: each face is a loop of vertices, counter-clockwise seen from outside."""
    return {
        "type": "mesh", "vertices_m": [rounded(v) for v in vertices],
        "triangles": [[loop[0], loop[i], loop[i + 1]] for loop in loops for i in range(1, len(loop) - 1)],
    }


def column(plan, low, high):
    """An upright body over an outline of the plan (x, z), counter-clockwise seen from above."""
    count = len(plan)
    vertices = [(x, y, z) for y in (low, high) for x, z in plan]
    sides = [[i, (i + 1) % count, (i + 1) % count + count, i + count] for i in range(count)]
    return mesh(vertices, [list(range(count))[::-1], [i + count for i in range(count)]] + sides)


def ring(x, inner, outer, thick, count=48):
    """A flat ring across the x axis at the height of the beam, as a closed body."""
    vertices, loops = [], []
    for i in range(count):
        c, s = math.cos(2 * math.pi * i / count), math.sin(2 * math.pi * i / count)
        for r, at in ((inner, x), (outer, x), (outer, x + thick), (inner, x + thick)):
            vertices.append((at, BEAM + r * s, r * c))
    for i in range(count):
        a, b = 4 * i, 4 * ((i + 1) % count)
        for k in range(4):
            j = (k + 1) % 4
            loops.append([a + k, a + j, b + j, b + k])
    return mesh(vertices, loops)


# The prism in plan. The axis meets the first face at the origin. Its outward normal is turned from −x toward the viewer.
normal = turned((-1.0, 0.0), INCIDENCE_DEG)
toward_edge = (normal[1], -normal[0])
edge = (toward_edge[0] * SIDE * (1 - ENTERS), toward_edge[1] * SIDE * (1 - ENTERS))
near = (-toward_edge[0] * SIDE * ENTERS, -toward_edge[1] * SIDE * ENTERS)
second_face = turned((near[0] - edge[0], near[1] - edge[1]), -60)
far = (edge[0] + second_face[0], edge[1] + second_face[1])
corners = [edge, far, near]
TOP = BEAM - TABLE_DROP
middle = tuple(sum(c[k] for c in corners) / 3 for k in range(2))

# The card, square to green light but for its turn.
green = turned((1.0, 0.0), deviation(535))
card = (middle[0] + green[0] * CARD_DISTANCE, middle[1] + green[1] * CARD_DISTANCE)
along_card = turned((-green[1], green[0]), CARD_TURN_DEG)
facing = (-along_card[1], along_card[0])
if facing[0] * green[0] + facing[1] * green[1] > 0:
    facing, along_card = (-facing[0], -facing[1]), (-along_card[0], -along_card[1])


def post(name, x, z, top, holder=0.055):
    """A steel post in a black holder on a base."""
    return [
        thing(f"base of the {name}", "black metal", box((x - 0.024, 0.0001, z - 0.016), (x + 0.024, 0.009, z + 0.016))),
        thing(f"holder of the {name}", "black metal", rod((x, 0.009, z), (x, holder, z), 0.0125)),
        thing(f"screw of the {name}", "brass", rod((x, holder - 0.012, z + 0.012), (x, holder - 0.012, z + 0.022), 0.005)),
        thing(f"post of the {name}", "steel", rod((x, holder, z), (x, top, z), 0.0064)),
    ]


def lamp_house():
    left, right, half, low, high = LAMP - 0.075, LAMP + 0.035, 0.042, BEAM - 0.052, BEAM + 0.055
    wall = 0.003
    parts = [
        thing("lamp house, left", "lacquer", box((left, low, -half), (left + wall, high, half))),
        thing("lamp house, front", "lacquer", box((left, low, half - wall), (right, high, half))),
        thing("lamp house, back", "lacquer", box((left, low, -half), (right, high, -half + wall))),
        thing("lamp house, floor", "lacquer", box((left, low, -half), (right, low + wall, half))),
        thing("lamp house, top", "lacquer", box((left, high - wall, -half), (right, high, half))),
        thing("lamp house, flange", "brass", ring(right - 0.002, 0.0192, 0.034, 0.006)),
        thing("lamp house, right", "lacquer", ring(right - wall, 0.0192, 0.062, 0.002)),
        thing("snout", "brass", rod((right, BEAM, 0), (SLIT - 0.001, BEAM, 0), 0.019, capped=False)),
        thing("lining of the snout", "soot", rod((LAMP - 0.01, BEAM, 0), (SLIT - 0.001, BEAM, 0), 0.0186, capped=False)),
        thing("rim of the snout", "brass", ring(SLIT - 0.008, 0.019, 0.0225, 0.008)),
    ]
    for k in range(9):
        x = left + 0.008 + 0.0115 * k
        parts.append(thing(f"fin {k + 1}", "lacquer", box((x, high, -half + 0.004), (x + 0.0025, high + 0.016, half - 0.004))))
    jaws = [(-0.019, -SLIT_WIDTH / 2, -0.019, 0.019), (SLIT_WIDTH / 2, 0.019, -0.019, 0.019),
            (-SLIT_WIDTH / 2, SLIT_WIDTH / 2, -0.019, -SLIT_LOW), (-SLIT_WIDTH / 2, SLIT_WIDTH / 2, SLIT_HIGH, 0.019)]
    for k, (z0, z1, y0, y1) in enumerate(jaws):
        parts.append(thing(f"jaw {k + 1} of the slit", "soot", {
            "type": "parallelogram", "origin_m": rounded([SLIT - 0.003, BEAM + y0, z1]), "u_m": rounded([0, 0, z0 - z1]),
            "v_m": rounded([0, y1 - y0, 0]),
        }))
    return parts + post("lamp house", LAMP - 0.02, 0, low, holder=0.04)


def prism_table():
    parts = [
        thing("prism table", "white", rod((middle[0], TOP - TABLE_THICK, middle[1]), (middle[0], TOP, middle[1]), TABLE_RADIUS)),
        thing("ring under the table", "brass",
              rod((middle[0], TOP - 0.016, middle[1]), (middle[0], TOP - TABLE_THICK - 0.0001, middle[1]), 0.05)),
        thing("stem of the table", "steel", rod((middle[0], 0.03, middle[1]), (middle[0], TOP - 0.016, middle[1]), 0.012)),
        thing("foot of the table", "black metal", rod((middle[0], 0.0001, middle[1]), (middle[0], 0.03, middle[1]), 0.032)),
    ]
    for k in range(72):
        long = 0.009 if k % 6 == 0 else 0.0045
        d = turned((1.0, 0.0), 5 * k)
        across = (-d[1], d[0])
        outer, wide = TABLE_RADIUS - 0.0025, 0.0007
        begin = (middle[0] + d[0] * outer - across[0] * wide / 2, middle[1] + d[1] * outer - across[1] * wide / 2)
        parts.append(thing(f"mark {k + 1}", "ink", {
            "type": "parallelogram", "origin_m": rounded([begin[0], TOP + 0.00005, begin[1]]),
            "u_m": rounded([-d[0] * long, 0, -d[1] * long]), "v_m": rounded([across[0] * wide, 0, across[1] * wide]),
        }))
    return parts


def screen():
    low, high, deep = BEAM - 0.066, BEAM + CARD_TALL - 0.066, 0.006
    ends = [(card[0] + s * along_card[0] * CARD_WIDTH / 2, card[1] + s * along_card[1] * CARD_WIDTH / 2) for s in (-1, 1)]
    behind = (card[0] - facing[0] * deep, card[1] - facing[1] * deep)
    parts = [
        thing("card", "white", upright(card, along_card, CARD_WIDTH, low, high)),
        thing("back of the card", "black metal", upright((card[0] - facing[0] * 0.001, card[1] - facing[1] * 0.001), along_card, CARD_WIDTH, low, high)),
    ]

    def bar(name, a, b, y0, y1, half):
        """A bar of the frame between two points of the plan."""
        out = (facing[0] * half, facing[1] * half)
        plan = [(a[0] + out[0], a[1] + out[1]), (b[0] + out[0], b[1] + out[1]), (b[0] - out[0], b[1] - out[1]), (a[0] - out[0], a[1] - out[1])]
        area = sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(plan, plan[1:] + plan[:1]))
        return thing(name, "steel", column(plan if area < 0 else plan[::-1], y0, y1))

    wide = 0.005
    step = (along_card[0] * wide, along_card[1] * wide)
    parts += [
        bar("frame, below", ends[0], ends[1], low - wide, low, 0.004), bar("frame, above", ends[0], ends[1], high, high + wide, 0.004),
        bar("frame, one side", (ends[0][0] - step[0], ends[0][1] - step[1]), ends[0], low - wide, high + wide, 0.004),
        bar("frame, other side", ends[1], (ends[1][0] + step[0], ends[1][1] + step[1]), low - wide, high + wide, 0.004),
    ]
    for k, s in enumerate((-0.3, 0.3)):
        x, z = behind[0] + along_card[0] * CARD_WIDTH * s, behind[1] + along_card[1] * CARD_WIDTH * s
        parts += post(f"screen, {k + 1}", x, z, low + 0.02, holder=0.03)
    return parts


def spare_mount():
    """A mount with a white disk in it that stands beside the beam, turned toward the prism."""
    x, z, turn = -0.235, -0.30, 128.0
    c = turned((1.0, 0.0), turn)
    shape = ring(-0.006, 0.030, 0.040, 0.012)
    place = [{"translate_m": [0, round(0.115 - BEAM, 6), 0]}, {"rotate": {"axis": [0, 1, 0], "angle_deg": turn}}, {"translate_m": [x, 0, z]}]
    disk = {"type": "disk", "center_m": rounded([x, 0.115, z]), "normal": rounded([c[0], 0, c[1]]), "radius_m": 0.0301}
    return [
        thing("spare mount", "black metal", shape, transform=place), thing("disk in it", "white", disk),
        *post("spare mount", x, z, 0.0765, holder=0.05),
    ]


def hole():
    """A tile of the breadboard: a hole with a bright chamfer."""
    side, rows = 64, []
    for row in range(side):
        line = []
        for column_ in range(side):
            r = math.hypot(column_ + 0.5 - side / 2, row + 0.5 - side / 2) / side * PITCH * 1e3  # mm
            edge_ = lambda at: max(0.0, min(1.0, (r - at) / 0.35 + 0.5))
            value = 2 + (150 - 2) * edge_(3.0) + (84 - 150) * edge_(3.9)
            line.append((round(value),) * 3)
        rows.append(line)
    return rows


if __name__ == "__main__":
    for nm in (400, 450, 535, 589, 650, 700):
        print(f"{nm} nm: leaves at {exit_angle(nm):.2f}°, deviated {deviation(nm):.2f}°")
    os.makedirs(FOLDER, exist_ok=True)
    write_png(os.path.join(FOLDER, "hole.png"), hole())
    board = {"x": (-0.525, 0.45), "z": (-0.575, 0.4)}
    wide, deep = board["x"][1] - board["x"][0], board["z"][1] - board["z"][0]
    scene_text.write("bench", {
        "etalon": 1,
        "comment": [
            "A spectroscope on an optical bench: a lamp house with a slit, a 60° prism of N-SF11 on its table, and a card.",
            "Look at: the streak of white light on the table before the prism, and the fan of colours behind it; the spectrum on the card,",
            "where each wavelength makes an image of the slit; the white light that the prism's first face mirrors to the side.",
            "Written by scenes/generators/bench.py.",
        ],
        "camera": {
            "type": "perspective", "position_m": [0.02, 0.235, 0.44], "look_at_m": [-0.060, 0.094, -0.12], "horizontal_fov_deg": 52,
        },
        "film": {"width": 540, "height": 320, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "integrator": {"comment": "From 370 nm: below, nothing is known of N-SF11.", "spp": 256, "wavelength_range_nm": [370, 830]},
        "spectra": {
            "arc": {"type": "illuminant", "name": "D65", "scale": 4.0},
        },
        "materials": {
            "flint": {"type": "dielectric", "interior": "N-SF11"},
            "white": {"type": "lambert", "reflectance": 0.85},
            "wall": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.09, 0.12, 0.17]}},
            "soot": {"type": "lambert", "reflectance": 0.003},
            "ink": {"type": "lambert", "reflectance": 0.03},
            "black": {"type": "black"},
            "steel": {"type": "conductor", "reflectance": 0.6, "alpha": 0.25},
            "brass": {"type": "conductor", "metal": "Au", "alpha": 0.3, "reflected_tint": 0.75},
            "black metal": {"type": "plastic", "reflectance": 0.035, "alpha": 0.3},
            "lacquer": {"type": "plastic", "reflectance": {"type": "rgb", "rgb": [0.07, 0.13, 0.115]}, "alpha": 0.25},
            "board": {
                "type": "lambert",
                "reflectance": {"type": "image", "file": "bench-files/hole.png", "uv_scale": [round(wide / PITCH), round(deep / PITCH)]},
            },
        },
        "objects": [
            thing("breadboard", "board", {
                "type": "parallelogram", "origin_m": [board["x"][0], 0, board["z"][1]], "u_m": [round(wide, 6), 0, 0], "v_m": [0, 0, round(-deep, 6)],
            }),
            thing("prism", "flint", column(corners, TOP + PLINTH + 0.0001, TOP + PLINTH + 0.0001 + TALL)),
            thing("plinth", "ink", column([tuple(m + 1.12 * (c - m) for c, m in zip(corner, middle)) for corner in corners], TOP, TOP + PLINTH)),
            *lamp_house(), *prism_table(), *screen(), *spare_mount(),
            thing("wall", "wall", {"type": "parallelogram", "origin_m": [-3, -0.8, -1.3], "u_m": [6, 0, 0], "v_m": [0, 3, 0]}),
            thing("lamp on the wall", "black", {"type": "disk", "center_m": [0.19, 0.1, -0.95], "normal": [0, 0.15, -1], "radius_m": 0.06},
                  emission={"radiance": {"type": "illuminant", "name": "D65", "scale": 4}}),
            thing("softbox above", "black", {"type": "parallelogram", "origin_m": [-0.7, 0.62, -0.9], "u_m": [0.9, 0, 0], "v_m": [0, 0.25, 0.35]},
                  emission={"radiance": {"type": "illuminant", "name": "D65", "scale": 3.2}}),
            thing("softbox at the left", "black", {"type": "parallelogram", "origin_m": [-0.55, 0.25, 0.75], "u_m": [-0.45, 0, -0.35], "v_m": [0, 0.45, 0]},
                  emission={"radiance": {"type": "blackbody", "temperature_k": 3600, "scale": 3.4e-4}}),
        ],
        "lights": [
            {"type": "spot", "name": "arc", "position_m": [LAMP, BEAM, 0], "direction": [1, 0, 0], "half_angle_deg": 45,
             "inner_half_angle_deg": 42, "intensity": "arc"},
            {"type": "environment", "name": "dim room", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.01}},
        ],
    })
