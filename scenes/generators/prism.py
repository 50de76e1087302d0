"""Writes scenes/prism.json: a prism of N-SF11 throws the spectrum of a strip light on a wall.

In plan (x to the right, z up the page) the prism's edge points along +z, and light of 520 nm runs along +x inside, deviated
least. A screen with a gap stands before the prism. Strip and gap are as wide as they can be before red and violet
overlap: the image of the strip in one colour, as wide on the wall as twice the gap and once the strip, is about half as
wide as the spectrum is long.

A point of the wall sees the strip through the prism in about 1 of 1000 directions, and in half of its wavelengths: such a
picture needs thousands of paths a pixel from an integrator that walks from the eye alone.

Plain standard library.
"""

import math

import scene_text

SELLMEIER = [(1.73759695, 0.013188707), (0.313747346, 0.0623068142), (1.89878101, 155.23629)]
SIDE, HALF_HEIGHT = 0.09, 0.7  # of the prism, m
STRIP_WIDTH, STRIP_HALF_HEIGHT, STRIP_DISTANCE = 0.04, 0.6, 1.0  # m
GAP, GAP_DISTANCE, SCREEN_REACH = 0.02, 0.06, 1.2  # m
WALL_DISTANCE, WALL_HALF_WIDTH, WALL_HALF_HEIGHT = 1.0, 1.5, 1.0  # m
RADIANCE = 400.0
RANGE_NM = [370, 830]


def index(wavelength_nm):
    um2 = (wavelength_nm * 1e-3) ** 2
    return math.sqrt(1 + sum(b * um2 / (um2 - c) for b, c in SELLMEIER))


def rounded(v):
    return [round(x, 6) for x in v]


def at(p, y=0.0):
    """A point of the plan at a height."""
    return [p[0], y, p[1]]


def along(p, d, s):
    return (p[0] + s * d[0], p[1] + s * d[1])


half = math.asin(index(520) / 2) - math.pi / 6  # half of the deviation
incoming, outgoing = (math.cos(half), math.sin(half)), (math.cos(half), -math.sin(half))
beside_incoming, beside_outgoing = (-incoming[1], incoming[0]), (-outgoing[1], outgoing[0])

height = SIDE * math.sqrt(3) / 2
base, edge = -0.62 * height, 0.38 * height  # the beam crosses at z = 0, nearer to the edge
corners = [(-SIDE / 2, base), (0.0, edge), (SIDE / 2, base)]  # clockwise in plan: counter-clockwise seen from above
entry = (-edge / (edge - base) * SIDE / 2, 0.0)
exit_ = (-entry[0], 0.0)

vertices = [rounded(at(c, y)) for y in (-HALF_HEIGHT, HALF_HEIGHT) for c in corners]
triangles = [[0, 1, 2], [3, 5, 4]]
for i in range(3):
    j = (i + 1) % 3
    triangles += [[i, i + 3, j], [j, i + 3, j + 3]]


def outward(triangle):
    """The triangle, wound so that its normal points away from the middle of the prism."""
    a, b, c = (vertices[k] for k in triangle)
    u, v = ([q[k] - a[k] for k in range(3)] for q in (b, c))
    normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    middle = [sum(p[k] for p in vertices) / 6 for k in range(3)]
    points_out = sum(n * (sum(p[k] for p in (a, b, c)) / 3 - middle[k]) for k, n in enumerate(normal)) > 0
    return triangle if points_out else [triangle[0], triangle[2], triangle[1]]


def upright(centre, direction, left, right, half_height):
    """An upright rectangle from `left` to `right` of a point along a horizontal direction."""
    return {
        "type": "parallelogram",
        "origin_m": rounded(at(along(centre, direction, left), -half_height)),
        "u_m": rounded([(right - left) * direction[0], 0.0, (right - left) * direction[1]]),
        "v_m": [0.0, 2 * half_height, 0.0],
    }


strip = along(entry, incoming, -STRIP_DISTANCE)
screen = along(entry, incoming, -GAP_DISTANCE)
wall = along(exit_, outgoing, WALL_DISTANCE)
eye = along(along(exit_, outgoing, 0.25), beside_outgoing, 0.42)

if __name__ == "__main__":
    scene_text.write("prism", {
        "etalon": 1,
        "comment": [
            "Newton's experiment: a strip light, a screen with a gap, a 60° prism of N-SF11 and the spectrum that it throws on a wall.",
            "Look at: red least deviated, violet most; colours that are purest at the ends, since strip and gap have a width; the edges,",
            "bent because rays that pass a prism obliquely are deviated more.",
            "The light reaches the wall through glass, where no shadow ray can follow: only about one path in a thousand finds it, so the",
            "picture is grainy for its time. spectroscope.json looks through the prism instead and sees purer colours at once.",
            "Geometry: scenes/generators/prism.py, which wrote this file.",
        ],
        "camera": {
            "type": "perspective", "position_m": rounded(at(eye, 0.25)), "look_at_m": rounded(at(along(wall, beside_outgoing, -0.02))),
            "horizontal_fov_deg": 36,
        },
        "film": {"width": 320, "height": 200, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "integrator": {"comment": "From 370 nm: below, nothing is known of N-SF11.", "spp": 2048, "wavelength_range_nm": RANGE_NM},
        "materials": {
            "flint": {"type": "dielectric", "interior": "N-SF11"},
            "white": {"type": "lambert", "reflectance": 0.8},
            "soot": {"type": "lambert", "reflectance": 0.03},
            "lamp": {"type": "black"},
        },
        "objects": [
            {"name": "prism", "shape": {"type": "mesh", "vertices_m": vertices, "triangles": [outward(t) for t in triangles]},
             "material": "flint"},
            {"name": "strip", "shape": upright(strip, beside_incoming, STRIP_WIDTH / 2, -STRIP_WIDTH / 2, STRIP_HALF_HEIGHT),
             "material": "lamp", "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": RADIANCE}}},
            {"name": "screen, left", "shape": upright(screen, beside_incoming, GAP / 2, SCREEN_REACH, 0.8), "material": "soot"},
            {"name": "screen, right", "shape": upright(screen, beside_incoming, -GAP / 2, -SCREEN_REACH, 0.8), "material": "soot"},
            {"name": "wall", "shape": upright(wall, beside_outgoing, -WALL_HALF_WIDTH, WALL_HALF_WIDTH, WALL_HALF_HEIGHT),
             "material": "white"},
        ],
        "lights": [{"type": "environment", "name": "dim room", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.02}}],
    })
