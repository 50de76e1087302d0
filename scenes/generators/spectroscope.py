"""Writes scenes/spectroscope.json: a spectrum seen through a prism of N-SF11.

The prism is equilateral and stands upright; in plan (x to the right, z toward the viewer) its edge A points along +x and
its base faces −x. A ray of the hydrogen line F that runs parallel to the base inside is deviated least, by
δ = 2·asin(n_F/2) − 60° = 69.18°, half of it at each face; the eye stands on that ray's one end and the slit on its other.

The eye behind the prism spends every path on the prism, and 1 in 15 meets the slit: the colours are pure and the picture
is quick, where a wall behind the prism (prism.json) shows paler colours for many more paths.

Plain standard library.
"""

import csv
import math
import os

import scene_text

SELLMEIER = [(1.73759695, 0.013188707), (0.313747346, 0.0623068142), (1.89878101, 155.23629)]
SIDE, HEIGHT = 0.08, 0.075  # of the prism, m
STANDS_OFF = 1e-4  # of the table, m: surfaces that coincide would have no order
EYE, SLIT = 0.36, 0.24  # horizontal distances from the prism's axis, m
EYE_HEIGHT, AIM_HEIGHT = 0.065, 0.04  # m
SLIT_WIDTH, SLIT_HALF_HEIGHT = 2e-3, 0.022  # m
RADIANCE = 8.0
RANGE_NM = [370, 830]


def index(wavelength_nm):
    um2 = (wavelength_nm * 1e-3) ** 2
    return math.sqrt(1 + sum(b * um2 / (um2 - c) for b, c in SELLMEIER))


def deviation(wavelength_nm):
    return 2 * math.asin(index(wavelength_nm) / 2) - math.pi / 3


def observer():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../crates/optics/data/cie-1931-2deg-1nm.csv")
    with open(path, encoding="utf-8") as rows:
        return [tuple(map(float, row)) for row in csv.reader(line for line in rows if line[0].isdigit())]


def solve(columns, target):
    """Amounts of three colours that mix to a fourth: Cramer's rule."""

    def det(a, b, c):
        return (a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1])
                + c[0] * (a[1] * b[2] - a[2] * b[1]))

    whole = det(*columns)
    return [det(*(target if j == i else c for j, c in enumerate(columns))) / whole for i in range(3)]


def three_bands(scale):
    """Tabulated light of three narrow bands that looks like D65 with the luminance of the constant spectrum `scale`."""
    half_width = 12
    centres = [450, 535, 620]
    rows = observer()
    total = sum(y for _, _, y, _ in rows)
    columns = []
    for centre in centres:
        xyz = [0.0, 0.0, 0.0]
        for wavelength, *cmf in rows:
            value = max(0.0, 1 - abs(wavelength - centre) / half_width)
            xyz = [s + value * c / total for s, c in zip(xyz, cmf)]
        columns.append(xyz)
    white = [0.950456, 1.0, 1.089058]  # D65 for Y = 1
    amounts = solve(columns, [scale * w for w in white])
    wavelengths, values = [], []
    for centre, amount in zip(centres, amounts):
        wavelengths += [centre - half_width, centre, centre + half_width]
        values += [0, round(amount, 4), 0]
    return {"type": "tabulated", "wavelengths_nm": wavelengths, "values": values, "outside": "zero"}


def rounded(v):
    return [round(x, 6) for x in v]


half = deviation(486.1327) / 2
view = (math.sin(half), -math.cos(half))  # of the eye, in plan (x, z)
r = SIDE / math.sqrt(3)
corners = [(r, 0.0), (-r / 2, -SIDE / 2), (-r / 2, SIDE / 2)]  # A, then the base; counter-clockwise seen from above
# The ray of least deviation through the middle of both faces runs at x = r/4.
middle = r / 4
front = (middle, SIDE / 4)
eye = (front[0] - EYE * view[0], front[1] - EYE * view[1])
out = (-view[0], view[1])
slit = (middle + SLIT * out[0], -SIDE / 4 + SLIT * out[1])
# The line of sight goes on falling behind the prism.
slope = (EYE_HEIGHT - AIM_HEIGHT) / EYE
slit_height = AIM_HEIGHT - slope * SLIT
# The slit faces half way between the prism and the eye, so that the eye sees it too.
to_prism = (-out[0], -out[1])
to_eye = (eye[0] - slit[0], eye[1] - slit[1])
length = math.hypot(*to_eye)
facing = (to_prism[0] + 0.5 * to_eye[0] / length, to_prism[1] + 0.5 * to_eye[1] / length)
length = math.hypot(*facing)
facing = (facing[0] / length, facing[1] / length)
across = (facing[1], -facing[0])  # across × up = facing: (x, z) of u for u × v along `facing` with v up
edge = (slit[0] - across[0] * SLIT_WIDTH / 2, slit[1] - across[1] * SLIT_WIDTH / 2)


def strip(low, high):
    return {
        "type": "parallelogram",
        "origin_m": rounded([edge[0], low, edge[1]]),
        "u_m": rounded([across[0] * SLIT_WIDTH, 0, across[1] * SLIT_WIDTH]),
        "v_m": rounded([0, high - low, 0]),
    }


vertices = [rounded([x, y, z]) for y in (STANDS_OFF, HEIGHT + STANDS_OFF) for x, z in corners]
# Corners 0, 1, 2 run counter-clockwise seen from above.
triangles = [[0, 2, 1], [3, 4, 5]]
for i in range(3):
    j = (i + 1) % 3
    triangles += [[i, j, j + 3], [i, j + 3, i + 3]]
spread = math.degrees(deviation(410) - deviation(680))
aim = rounded([front[0] - 0.022, AIM_HEIGHT - 0.002, front[1]])

if __name__ == "__main__":
    for nm in (400, 435.8, 486.1327, 546.1, 587.5618, 656.2725, 700):
        print(f"{nm} nm: n {index(nm):.5f}, least deviation {math.degrees(deviation(nm)):.3f}°")
    scene_text.write("spectroscope", {
        "etalon": 1,
        "comment": [
            "A spectrum: a slit of light seen through a 60° prism of N-SF11 that stands at the angle of least deviation (69.18° for the",
            f"hydrogen line F; violet to red, 410 to 680 nm, spread over {spread:.1f}°). The slit itself stands outside of the picture; the",
            "prism's left face mirrors it, white from top to bottom. Its upper half has the spectrum of daylight; its lower half is a",
            "mixture of three narrow bands (450, 535 and 620 nm) that looks the same to the eye. The prism tells them apart: one continuous",
            "spectrum above, three images below.",
            "Look at: pure colours in their order, red least deviated; the slightly bent lines, since rays that pass a prism obliquely are",
            "deviated more; the mirrored slit, which has no colours.",
            "prism.json throws such a spectrum on a wall instead. Geometry: scenes/generators/spectroscope.py, which wrote this file.",
        ],
        "camera": {
            "type": "perspective", "position_m": rounded([eye[0], EYE_HEIGHT, eye[1]]), "look_at_m": aim,
            "horizontal_fov_deg": 23,
        },
        "film": {"width": 640, "height": 400, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "integrator": {"comment": "From 370 nm: below, nothing is known of N-SF11.", "spp": 256, "wavelength_range_nm": RANGE_NM},
        "spectra": {
            "daylight": {"type": "illuminant", "name": "D65", "scale": RADIANCE},
            "three bands": three_bands(RADIANCE),
        },
        "materials": {
            "glass": {"type": "dielectric", "interior": "N-SF11"},
            "table": {"type": "lambert", "reflectance": 0.3},
            "black": {"type": "black"},
        },
        "objects": [
            {"name": "prism", "shape": {"type": "mesh", "vertices_m": vertices, "triangles": triangles}, "material": "glass"},
            {"name": "slit, upper half", "shape": strip(slit_height, slit_height + SLIT_HALF_HEIGHT), "material": "black",
             "emission": {"radiance": "daylight"}},
            {"name": "slit, lower half", "shape": strip(slit_height - SLIT_HALF_HEIGHT, slit_height), "material": "black",
             "emission": {"radiance": "three bands"}},
            {"name": "wall", "shape": {"type": "parallelogram", "origin_m": [-1.5, 0, -0.6], "u_m": [3, 0, 0], "v_m": [0, 1.5, 0]},
             "material": "table"},
            {"name": "table", "shape": {"type": "parallelogram", "origin_m": [-1.5, 0, 1.5], "u_m": [3, 0, 0], "v_m": [0, 0, -2.1]},
             "material": "table"},
        ],
        "lights": [{"type": "environment", "name": "dim room", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.06}}],
    })
