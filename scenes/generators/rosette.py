"""Writes scenes/rosette.json and its meshes: a round window of clear film between two crossed polarisers, before a lamp.

No pane has a colour. Each is a stack of clear sheets, and the delay of the stack decides which wavelengths pass the second polariser: the
interference colours of Michel-Lévy's chart. Plain standard library.
"""

import math
import os

import scene_text
from meshes import Mesh, lathe

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rosette-files")
SHEET_NM = 115  # delay of one sheet
RADIUS = 0.5
# Inner and outer radius, number of panes, part of a pane by which the ring is turned, sheets of each pane in turn.
RINGS = [
    (0.00, 0.09, 12, 0.5, [5, 8]),
    (0.10, 0.20, 12, 0.0, [9, 10, 11]),
    (0.21, 0.30, 24, 0.5, [4, 5, 6, 7, 6, 5]),
    (0.31, 0.39, 24, 0.0, [12, 8, 10, 8]),
    (0.40, 0.455, 48, 0.5, [*range(1, 25), *range(24, 0, -1)]),
]
GAP = 0.0035  # half the width of the lead between panes


def pane(inner, outer, first, last, lift):
    """A sector of a ring in the plane z = 0, its arms pointed like a petal: it bulges outward by `lift`."""
    steps = 10
    rim = lambda radius, bulge: [
        (radius + bulge * math.sin(math.pi * i / steps), first + (last - first) * i / steps) for i in range(steps + 1)]
    outside = rim(outer - GAP, lift)
    inside = rim(inner + GAP, lift if inner > 0 else 0)
    # The gap to the neighbours has the same width at every radius.
    middle = (first + last) / 2
    squeeze = lambda r, a: middle + (a - middle) * max(0.0, 1 - GAP / (r * (last - first) / 2))
    point = lambda r, a: (r * math.sin(squeeze(r, a)), r * math.cos(squeeze(r, a)), 0.0)
    return [(point(*o), point(*i)) for o, i in zip(outside, inside)]


def window():
    """For each number of sheets a mesh of all panes that have it."""
    meshes = {}
    for inner, outer, count, shift, sheets in RINGS:
        for k in range(count):
            first, last = ((k + shift) / count * 2 * math.pi, (k + 1 + shift) / count * 2 * math.pi)
            mesh = meshes.setdefault(sheets[k % len(sheets)], Mesh())
            rows = pane(inner, outer, first, last, 0.0)
            index = [(mesh.vertex(o, (0, 0, 1)), mesh.vertex(i, (0, 0, 1))) for o, i in rows]
            for (a, b), (c, d) in zip(index, index[1:]):
                # The innermost panes end in a point.
                mesh.triangles += [(a, b, d), (a, d, c)] if inner > 0 else [(a, b, c)]
    return meshes


def lead():
    """The bars between the panes, and the rim, as a plate with holes: what no pane covers."""
    mesh = Mesh()
    for inner, outer, count, shift, _ in RINGS:
        for k in range(count):
            first, last = ((k + shift) / count * 2 * math.pi, (k + 1 + shift) / count * 2 * math.pi)
            rows = pane(inner, outer, first, last, 0.0)
            loop = [o for o, _ in rows] + [i for _, i in reversed(rows)]
            edge = [(r * math.sin(a), r * math.cos(a), 0.0) for r, a in
                    [(outer, first + (last - first) * i / 10) for i in range(11)]
                    + [(inner, last - (last - first) * i / 10) for i in range(11)]]
            for (a, b), (c, d) in zip(zip(loop, edge), zip(loop[1:] + loop[:1], edge[1:] + edge[:1])):
                if sum((p - q) ** 2 for p, q in zip(b, d)) + sum((p - q) ** 2 for p, q in zip(a, c)) < 1e-14:
                    continue
                corners = [mesh.vertex(p, (0, 0, 1)) for p in (a, b, d, c)]
                mesh.triangles += [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
    return mesh


def between(inner, outer, segments=96):
    """A flat ring in the plane z = 0."""
    mesh = Mesh()
    ring = []
    for j in range(segments + 1):
        a = 2 * math.pi * j / segments
        ring.append(tuple(mesh.vertex((r * math.sin(a), r * math.cos(a), 0), (0, 0, 1)) for r in (inner, outer)))
    for (a, b), (c, d) in zip(ring, ring[1:]):
        mesh.triangles += [(a, b, d), (a, d, c)]
    return mesh


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    objects, materials = [], {}

    def put(name, mesh, material, height=0.0):
        file = name.replace(" ", "-") + ".ply"
        mesh.write(os.path.join(FOLDER, file))
        entry = {"name": name, "shape": {"type": "mesh", "file": f"rosette-files/{file}"}, "material": material}
        entry["transform"] = [{"translate_m": [0, 0.62, height]}]
        objects.append(entry)

    for sheets, mesh in sorted(window().items()):
        name = f"{sheets} sheets"
        materials[name] = {"type": "retarder", "axis": [1, 1, 0], "retardance_deg": round(360 * sheets * SHEET_NM / 550, 3), "at_nm": 550}
        put(name, mesh, name)
    bars = lead()
    for inner, outer in [(0.09, 0.10), (0.20, 0.21), (0.30, 0.31), (0.39, 0.40), (0.455, RADIUS + 0.02)]:
        bars.add(between(inner, outer))
    put("lead", bars, "lead", 0.012)
    frame = lathe([(0.47, -0.03), (0.47, 0.03), (0.485, 0.045), (0.52, 0.045), (0.535, 0.03), (0.535, -0.03)], 180)
    standing = Mesh()
    standing.add(frame, lambda p: (p[0], p[2], -p[1]), lambda n: (n[0], n[2], -n[1]))
    put("frame", standing, "brass")
    disk = lambda name, z, material, **more: {
        "name": name, "shape": {"type": "disk", "center_m": [0, 0.62, z], "normal": [0, 0, 1], "radius_m": 0.48},
        "material": material, **more}
    objects += [
        disk("lamp", -0.02, "black", emission={"radiance": {"type": "illuminant", "name": "D65", "scale": 1.3}}),
        disk("polariser", -0.01, "upright"),
        disk("analyser", 0.008, "level"),
        {"name": "floor", "shape": {"type": "parallelogram", "origin_m": [-3, 0, 3], "u_m": [6, 0, 0], "v_m": [0, 0, -3.6]}, "material": "floor"},
        {"name": "wall", "shape": {"type": "parallelogram", "origin_m": [-3, 0, -0.35], "u_m": [6, 0, 0], "v_m": [0, 3, 0]}, "material": "wall"},
    ]
    for x in (-0.36, 0.36):
        objects.append({"name": "foot", "shape": {"type": "cylinder", "start_m": [x, 0, 0], "end_m": [x, 0.28, 0], "radius_m": 0.02}, "material": "brass"})
    scene_text.write("rosette", {
        "etalon": 1,
        "comment": [
            "A window without coloured glass: stacks of clear film between crossed polarisers. Only the delay of each stack, 115 nm a sheet,",
            "decides its colour. Look at: the colours of the first orders, which no paint of the scene has; the outer ring, Michel-Lévy's",
            "chart from 1 to 24 sheets and back; their reflections in the varnished floor, which polarises. Written by scenes/generators/rosette.py.",
        ],
        "camera": {"type": "perspective", "position_m": [0.85, 0.95, 2.75], "look_at_m": [0.0, 0.40, 0.05], "vertical_fov_deg": 30},
        "film": {"width": 720, "height": 720, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "materials": {
            "black": {"type": "black"},
            "upright": {"type": "polariser", "axis": [0, 1, 0]},
            "level": {"type": "polariser", "axis": [1, 0, 0]},
            **materials,
            "lead": {"type": "lambert", "reflectance": 0.03},
            "brass": {"type": "conductor", "reflectance": {"type": "rgb", "rgb": [0.89, 0.70, 0.36]}, "alpha": 0.18},
            "floor": {"type": "plastic", "reflectance": {"type": "rgb", "rgb": [0.10, 0.055, 0.03]}},
            "wall": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.30, 0.29, 0.27]}},
        },
        "objects": objects,
        "lights": [{"type": "environment", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.16}}],
        "integrator": {"spp": 256},
    })
