"""Writes scenes/watch.json and the meshes in scenes/watch-files: a wrist watch under three soft lamps, its dial brushed from the middle
outward, its case brushed around. Lengths of the meshes are in millimetres; the scene places them. Plain standard library."""

import math
import os

import scene_text
from meshes import Mesh, circle, extrude, lathe

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "watch-files")
HOUR, MINUTE, SECOND = 10, 9, 37


def sunburst(radius, inner, segments=180):
    """A ring whose u runs outward, so that it is brushed from the middle outward."""
    mesh = Mesh()
    rings = [inner + (radius - inner) * k / 4 for k in range(5)]
    for low, high in zip(rings, rings[1:]):
        band = []
        for j in range(segments + 1):
            angle = 2 * math.pi * j / segments
            c, s = math.cos(angle), -math.sin(angle)
            band.append(tuple(mesh.vertex((r * c, 0, r * s), (0, 1, 0), (r / radius, 20 * j / segments)) for r in (low, high)))
        for (a, b), (c, d) in zip(band, band[1:]):
            mesh.triangles += [(a, b, d), (a, d, c)]
    return mesh


def turned(mesh, degrees, out=0.0, up=0.0):
    """Moved outward along −z (twelve o'clock), turned clockwise around y."""
    a = math.radians(-degrees)
    c, s = math.cos(a), math.sin(a)
    rotate = lambda v: (c * v[0] + s * v[2], v[1], -s * v[0] + c * v[2])
    placed = Mesh()
    placed.add(mesh, lambda p: rotate((p[0], p[1] + up, p[2] - out)), rotate)
    return placed


def bar(width, length, height, bevel):
    half, end = width / 2, length / 2
    return extrude([(-half, -end), (half, -end), (half, end), (-half, end)], 0, height, bevel=bevel)


def hand(length, tail, width, low):
    """A hand of two slanting facets that meet in a ridge, pointing to −z."""
    mesh = Mesh()
    tip, back, left, right = (0, low, -length), (0, low, tail), (-width / 2, low, 0), (width / 2, low, 0)
    ridge_out = (0, low + 0.28, -length * 0.1)
    ridge_tip, ridge_back = (0, low + 0.1, -length), (0, low + 0.1, tail)
    for corners in ([left, ridge_out, ridge_tip, tip][::-1], [right, ridge_out, ridge_tip, tip]):
        mesh.face(corners)
    for corners in ([left, ridge_out, ridge_back, back], [right, ridge_out, ridge_back, back][::-1]):
        mesh.face(corners)
    return mesh


def strap(side):
    """Leather that bends down from the lugs, in bands across; u across, v along."""
    mesh = Mesh()
    path = [(18.5, -1.6), (20.5, -0.4), (24, 0.0), (29, -0.6), (35, -1.8), (43, -3.1), (52, -3.7), (64, -3.8), (90, -3.8), (120, -3.8)]
    count = len(path)
    for layer, flip in ((0.0, False), (-2.2, True)):
        rows = []
        for k, (out, up) in enumerate(path):
            before, after = path[max(0, k - 1)], path[min(count - 1, k + 1)]
            dx, dy = after[0] - before[0], after[1] - before[1]
            length = math.hypot(dx, dy)
            normal = (0.0, dx / length, -side * dy / length)
            row = []
            for x in (-9.8, -9.0, -8.2, 8.2, 9.0, 9.8):
                drop = 0.5 if abs(x) > 9.5 else 0.12 if abs(x) > 8.8 else 0.0
                tilt = math.copysign(0.5, x) if abs(x) > 8.8 else 0.0
                n = (tilt, normal[1], normal[2])
                size = math.sqrt(sum(v * v for v in n))
                n = tuple(v / size * (-1 if flip else 1) for v in n)
                row.append(mesh.vertex((x, up + layer - (0 if flip else drop), side * out), n, (x / 20 + 0.5, out / 20)))
            rows.append(row)
        for low, high in zip(rows, rows[1:]):
            for i in range(len(low) - 1):
                a, b, c, d = low[i], low[i + 1], high[i + 1], high[i]
                order = [(a, c, b), (a, d, c)]
                if (side < 0) != flip:
                    order = [t[::-1] for t in order]
                mesh.triangles += order
    return mesh


def parts():
    yield "dial", sunburst(16.0, 0.35)
    marks = Mesh()
    for hour in range(12):
        if hour == 0:
            for x in (-0.95, 0.95):
                one = Mesh()
                one.add(bar(1.1, 3.6, 0.55, 0.16), lambda p, x=x: (p[0] + x, p[1], p[2]))
                marks.add(turned(one, 0, out=12.6))
        elif hour != 3:
            marks.add(turned(bar(1.1, 3.6 if hour % 3 == 0 else 3.0, 0.55, 0.16), 30 * hour, out=12.6))
    yield "marks", marks
    minutes = Mesh()
    for minute in range(60):
        minutes.add(turned(bar(0.16 if minute % 5 else 0.34, 0.75, 0.03, 0), 6 * minute, out=15.3, up=0.005))
    yield "minutes", minutes
    hands = Mesh()
    hands.add(turned(hand(9.2, 2.4, 1.7, 0.75), 30 * (HOUR + MINUTE / 60)))
    hands.add(turned(hand(13.6, 2.8, 1.35, 1.15), 6 * MINUTE + 0.1 * SECOND))
    yield "hands", hands
    second = Mesh()
    second.add(turned(bar(0.2, 19.0, 0.12, 0.04), 6 * SECOND, out=5.2, up=1.6))
    second.add(turned(extrude(circle(1.0, 40), 0, 0.12, bevel=0.03), 6 * SECOND, out=-3.2, up=1.6))
    second.add(lathe([(0.55, 1.5), (0.55, 1.85), (0.45, 1.95), (0, 1.95)], 48))
    yield "second hand", second
    yield "pin", lathe([(0.75, 0), (0.75, 1.4), (0.65, 1.5), (0, 1.5)], 48)
    # The bezel, polished: inner wall, slope, outer edge.
    yield "bezel", lathe([(19.6, 2.2), (19.5, 2.6), (18.9, 3.1), (17.6, 3.45), (16.9, 3.3), (16.5, 2.4), (16.05, 0.9), (16.0, 0.0)], 240)
    yield "ring", lathe([(20.6, 1.9), (20.35, 2.2), (19.6, 2.2)], 240)
    yield "flank", lathe([(19.4, -5.0), (20.2, -4.6), (20.6, -4.0), (20.6, 1.9)], 240)
    lugs = Mesh()
    for x in (-1, 1):
        for z in (-1, 1):
            outline = [(10.2, 14), (13.6, 14), (13.6, 20.5), (12.9, 23.2), (11.2, 23.6), (10.2, 22.4)]
            outline = [(x * px, z * pz) for px, pz in outline]
            if x * z < 0:
                outline.reverse()
            body = extrude([(p[0], -p[1]) for p in outline][::-1], -4.0, 1.2, bevel=0.5)
            lugs.add(body)
    yield "lugs", lugs
    crown = Mesh()
    fluted = [((2.9 + 0.22 * math.cos(36 * 2 * math.pi * i / 288)) * math.cos(2 * math.pi * i / 288),
               (2.9 + 0.22 * math.cos(36 * 2 * math.pi * i / 288)) * math.sin(2 * math.pi * i / 288)) for i in range(288)]
    crown.add(extrude(fluted, 0, 3.4, bevel=0.25), lambda p: (20.6 + p[1], p[0] - 1.2, p[2]), lambda n: (n[1], n[0], n[2]))
    crown.triangles = [t[::-1] for t in crown.triangles]
    yield "crown", crown
    leather = Mesh()
    leather.add(strap(1))
    leather.add(strap(-1))
    yield "strap", leather


def lamp(name, corner, u, v, scale):
    return {
        "name": name, "shape": {"type": "parallelogram", "origin_m": corner, "u_m": u, "v_m": v}, "material": "nothing",
        "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": scale}, "sides": "both"},
    }


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    material = {
        "dial": "blue dial", "marks": "polished", "minutes": "print", "hands": "polished", "second hand": "red", "pin": "polished",
        "bezel": "polished", "ring": "turned", "flank": "turned", "lugs": "polished", "crown": "polished", "strap": "leather",
    }
    objects = []
    for name, mesh in parts():
        file = name.replace(" ", "-") + ".ply"
        mesh.write(os.path.join(FOLDER, file))
        objects.append({"name": name, "shape": {"type": "mesh", "file": f"watch-files/{file}"}, "material": material[name]})
    rgb = lambda *v: {"type": "rgb", "rgb": list(v)}
    steel = {"type": "conductor", "reflectance": rgb(0.58, 0.565, 0.54)}
    scene_text.write("watch", {
        "etalon": 1,
        "comment": [
            "A wrist watch. Its dial is brushed from the middle outward, its case around (alpha_u, alpha_v). Look at: the two bright",
            "fans on the dial, which stand across the lamps; the long streaks on the flank; the bevels of the hour marks.",
            "Written by scenes/generators/watch.py, with the meshes. They are in millimetres; the group is scaled.",
        ],
        "camera": {
            "type": "perspective", "position_m": [-0.062, 0.150, 0.115], "look_at_m": [0.003, 0.0, 0.001], "focal_length_m": 0.082,
            "sensor_width_m": 0.036, "lens": {"f_number": 6, "focus_distance_m": 0.199},
        },
        "film": {"width": 720, "height": 540, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "materials": {
            "polished": {**steel, "alpha": 0.04},
            "turned": {**steel, "alpha_u": 0.05, "alpha_v": 0.3},
            "blue dial": {"type": "conductor", "reflectance": rgb(0.03, 0.09, 0.33), "alpha_u": 0.09, "alpha_v": 0.42},
            "print": {"type": "lambert", "reflectance": 0.8},
            "red": {"type": "plastic", "reflectance": rgb(0.7, 0.06, 0.03)},
            "leather": {"type": "plastic", "reflectance": rgb(0.12, 0.05, 0.022), "alpha": 0.35},
            "table": {"type": "plastic", "reflectance": rgb(0.045, 0.045, 0.05), "alpha": 0.25},
            "nothing": {"type": "black"},
        },
        "groups": {"watch": {"objects": objects}},
        "objects": [
            {"name": "table", "shape": {"type": "parallelogram", "origin_m": [-1, -0.0062, 1], "u_m": [2, 0, 0], "v_m": [0, 0, -2]},
             "material": "table"},
            lamp("soft box", [-0.32, 0.36, -0.30], [0.34, 0, 0], [0, 0.06, 0.26], 14),
            lamp("strip at the right", [0.26, 0.04, -0.16], [0, 0.26, 0], [0.02, 0, 0.28], 7),
            lamp("window behind", [-0.20, 0.05, -0.42], [0.5, 0, 0], [0, 0.20, 0.02], 3),
        ],
        "instances": [{"group": "watch", "name": "watch", "transform": [
            {"scale": 0.001}, {"rotate": {"axis": [0, 1, 0], "angle_deg": 14}},
        ]}],
        "lights": [{"type": "environment", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.12}}],
        "integrator": {"spp": 256},
    })
