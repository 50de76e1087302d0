"""Writes scenes/movement.glb: the movement of a mechanical watch as a glTF 2.0 model with its camera and lamps.

Lengths are in millimetres; the root node scales them. Plain standard library.
"""

import json
import math
import os
import struct
import tempfile

from meshes import Mesh, circle, extrude, gear, lathe
from vase import write_png

PATH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "movement.glb")


def moved(mesh, x=0.0, y=0.0, z=0.0, turn=0.0):
    """Turned around y by degrees, then moved."""
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    rotate = lambda v: (c * v[0] + s * v[2], v[1], -s * v[0] + c * v[2])

    def place(p):
        a, b, d = rotate(p)
        return (a + x, b + y, d + z)

    out = Mesh()
    out.add(mesh, place, rotate)
    return out


def joined(*meshes):
    out = Mesh()
    for mesh in meshes:
        out.add(mesh)
    return out


def wheel(teeth, module, thick, spokes):
    """A toothed rim, a hub and straight spokes between them."""
    outline = gear(teeth, module, 6)
    pitch = teeth * module / 2
    inner = pitch - 4.2 * module
    count = len(outline)
    rim = extrude(outline, 0, thick, holes=[circle(inner, count, start=math.pi / count)], bevel=0.02)
    hub = extrude(circle(pitch * 0.2, 64), 0, thick * 1.15, bevel=0.02)
    out = joined(rim, hub)
    width = pitch * 0.13
    for k in range(spokes):
        arm = extrude([(0.0, -width / 2), (inner + module, -width / 2), (inner + module, width / 2), (0.0, width / 2)], 0.0, thick * 0.9, bevel=0.02)
        out.add(moved(arm, turn=360 * k / spokes))
    return out


def pinion(teeth, module, low, high):
    return extrude(gear(teeth, module, 6), low, high, bevel=0.03)


def screw(radius):
    """A head with a slot and a bevelled rim."""
    out, slot = Mesh(), 0.16 * radius
    for side in (1, -1):
        arc = [(radius * math.cos(a), radius * math.sin(a)) for a in
               [math.asin(slot / radius) + (math.pi - 2 * math.asin(slot / radius)) * i / 40 for i in range(41)]]
        half = extrude(arc, 0, 0.3, bevel=0.05)
        out.add(moved(half, turn=0 if side == 1 else 180))
    out.add(extrude(circle(radius * 0.97, 48), 0, 0.12))
    return out


def jewel(radius):
    """A ring of ruby with a cup for the oil."""
    hole = radius * 0.22
    return lathe([(hole, 0.0), (radius, 0.0), (radius, 0.3), (radius * 0.93, 0.36), (radius * 0.7, 0.36), (hole, 0.16), (hole, 0.0)], 96)


def chaton(radius):
    """The setting of a jewel."""
    return lathe([(radius * 1.5, 0.0), (radius * 1.5, 0.22), (radius * 1.42, 0.28), (radius * 1.12, 0.28), (radius * 1.02, 0.16), (radius * 1.02, 0.0)], 96)


def spiral(turns, inner, outer, low, high, thick):
    """A ribbon on edge along a spiral of Archimedes."""
    out, steps = Mesh(), int(turns * 40)
    rows = []
    for i in range(steps + 1):
        t = i / steps
        a, r = 2 * math.pi * turns * t, inner + (outer - inner) * t
        c, s = math.cos(a), math.sin(a)
        rows.append([((r + side * thick / 2) * c, (r + side * thick / 2) * s, side * c, side * s) for side in (-1, 1)])
    for a, b in zip(rows, rows[1:]):
        for k, flip in ((0, True), (1, False)):
            (x0, z0, nx0, nz0), (x1, z1, nx1, nz1) = a[k], b[k]
            i = [out.vertex((x0, low, -z0), (nx0, 0, -nz0)), out.vertex((x1, low, -z1), (nx1, 0, -nz1)),
                 out.vertex((x1, high, -z1), (nx1, 0, -nz1)), out.vertex((x0, high, -z0), (nx0, 0, -nz0))]
            triangles = [(i[0], i[1], i[2]), (i[0], i[2], i[3])]
            out.triangles += [t[::-1] for t in triangles] if flip else triangles
        out.face([(a[0][0], high, -a[0][1]), (a[1][0], high, -a[1][1]), (b[1][0], high, -b[1][1]), (b[0][0], high, -b[0][1])])
    return out


def balance(radius):
    rim = lathe([(radius - 0.55, 0.0), (radius, 0.0), (radius, 0.5), (radius - 0.05, 0.55), (radius - 0.5, 0.55), (radius - 0.55, 0.5), (radius - 0.55, 0.0)], 180)
    out = joined(rim)
    for k in range(3):
        arm = extrude([(0, -0.28), (radius - 0.4, -0.22), (radius - 0.4, 0.22), (0, 0.28)], 0.1, 0.42, bevel=0.05)
        out.add(moved(arm, turn=120 * k + 20))
    out.add(extrude(circle(0.75, 64), 0.05, 0.5, bevel=0.06))
    return out


def weights(radius):
    out = Mesh()
    for k in range(12):
        weight = lathe([(0.0, -0.28), (0.21, -0.28), (0.21, 0.25), (0.16, 0.28), (0.0, 0.28)], 32)
        a = math.radians(30 * k + 35)
        lying = Mesh()
        lying.add(weight, lambda p: (p[1], p[0], -p[2]), lambda n: (n[1], n[0], -n[2]))
        lying.triangles = [t for t in lying.triangles]
        out.add(moved(lying, x=(radius + 0.2) * math.cos(a), y=0.28, z=-(radius + 0.2) * math.sin(a), turn=math.degrees(a)))
    return out


def bridge(points, low, high, bevel=0.18, rounding=10):
    """A plate whose outline is a closed Catmull–Rom curve through points."""
    outline, count = [], len(points)
    for i in range(count):
        a, b, c, d = (points[(i + k) % count] for k in (-1, 0, 1, 2))
        for step in range(rounding):
            t = step / rounding
            outline.append(tuple(
                0.5 * (2 * b[k] + (c[k] - a[k]) * t + (2 * a[k] - 5 * b[k] + 4 * c[k] - d[k]) * t * t + (3 * b[k] - a[k] - 3 * c[k] + d[k]) * t**3)
                for k in range(2)))
    plate = extrude(outline, low, high, bevel=bevel)
    # Texture coordinates by place, so that the stripes run one way over the whole plate: one in 1.4 mm.
    plate.vertices = [(*v[:6], (0.8 * v[0] + 0.6 * v[2]) / 1.4, (0.6 * v[0] - 0.8 * v[2]) / 1.4) for v in plate.vertices]
    return plate


def parts():
    """Name, mesh, material."""
    yield "main plate", lathe([(15.5, -1.2), (15.8, -0.9), (15.8, -0.3), (15.5, 0.0), (14.2, 0.0), (14.2, -0.25), (0.0, -0.25)], 240), "rhodium"
    # The train: barrel, centre, third, fourth and escape wheels.
    yield "barrel", joined(moved(extrude(gear(84, 0.135, 6), 0.1, 0.7, bevel=0.03), x=-7.2, z=4.6),
                           moved(lathe([(4.9, 0.7), (4.9, 1.2), (4.8, 1.3), (0.0, 1.3)], 180), x=-7.2, z=4.6)), "gilt"
    yield "centre wheel", moved(wheel(70, 0.135, 0.28, 5), x=0.3, y=1.5, z=1.0, turn=8), "gilt"
    yield "third wheel", moved(wheel(64, 0.115, 0.26, 5), x=4.9, y=0.95, z=4.4, turn=20), "gilt"
    yield "fourth wheel", moved(wheel(60, 0.115, 0.26, 4), x=6.9, y=1.55, z=-1.4, turn=33), "gilt"
    yield "escape wheel", moved(wheel(20, 0.21, 0.24, 4), x=3.6, y=0.9, z=-5.4, turn=5), "steel"
    yield "pinions", joined(*(moved(pinion(n, m, low, high), x=x, z=z) for n, m, x, z, low, high in [
        (12, 0.135, 0.3, 1.0, 0.2, 1.5), (10, 0.135, 4.9, 4.4, 0.3, 1.9), (10, 0.115, 6.9, -1.4, 0.3, 1.55), (8, 0.115, 3.6, -5.4, 0.3, 1.9)])), "steel"
    arbors = [(0.3, 1.0, 2.9), (4.9, 4.4, 2.6), (6.9, -1.4, 2.6), (3.6, -5.4, 2.3)]
    yield "arbors", joined(*(moved(lathe([(0.34, 0.0), (0.34, top - 0.4), (0.16, top - 0.3), (0.16, top), (0.0, top)], 48), x=x, z=z) for x, z, top in arbors)), "steel"
    # The barrel bridge, and a cock over the fourth wheel.
    yield "barrel bridge", bridge([(-13.4, -4.0), (-9.6, -10.6), (-3.6, -12.6), (-2.6, -8.6), (-1.2, -4.6), (-2.8, 0.2), (-7.0, 1.6), (-12.4, 1.8)], 1.6, 2.6), "striped"
    yield "train bridge", bridge([(0.9, -12.2), (6.4, -12.0), (11.4, -8.0), (13.2, -2.4), (11.0, 2.4), (7.6, 2.6), (5.6, -0.2), (3.4, -2.8), (1.0, -6.4)], 2.05, 2.85), "striped"
    yield "balance cock", bridge([(-13.0, 6.2), (-11.2, 3.4), (-8.4, 4.4), (-5.4, 6.2), (-3.2, 6.8), (-3.0, 8.6), (-5.2, 9.2), (-9.0, 9.4), (-12.4, 9.6)], 3.0, 3.7), "striped"
    bx, bz = -4.4, -7.4
    yield "balance", moved(balance(4.3), x=bx, y=1.75, z=bz), "gilt"
    yield "weights", moved(weights(4.3), x=bx, y=1.75, z=bz), "polished gold"
    yield "hairspring", moved(spiral(11, 0.55, 2.9, 0.0, 0.16, 0.035), x=bx, y=2.55, z=bz), "blued"
    yield "balance staff", moved(lathe([(0.3, 0.5), (0.3, 2.9), (0.12, 3.0), (0.0, 3.0)], 48), x=bx, z=bz), "steel"
    stones = [(4.9, 2.85, 4.4, 0.62), (6.9, 2.85, -1.4, 0.62), (8.9, 2.85, 6.6, 0.55), (-4.6, 3.7, -7.6, 0.8), (-6.4, 2.6, 5.2, 0.75)]
    yield "rubies", joined(*(moved(jewel(r), x=x, y=y - 0.05, z=z) for x, y, z, r in stones)), "ruby"
    yield "chatons", joined(*(moved(chaton(r), x=x, y=y - 0.02, z=z) for x, y, z, r in stones)), "polished gold"
    heads = [(-10.6, 2.6, 1.2, 0.75, 20), (-3.4, 2.6, 10.6, 0.75, 75), (2.4, 2.85, 10.4, 0.75, -35), (11.2, 2.85, 0.2, 0.75, 50), (10.2, 2.85, 7.4, 0.6, 5),
             (-11.2, 3.7, -7.4, 0.8, -20), (-12.2, 2.6, 3.0, 0.5, 64)]
    yield "screws", joined(*(moved(screw(r), x=x, y=y, z=z, turn=turn) for x, y, z, r, turn in heads)), "blued"
    yield "cloth", moved(extrude([(-60, -60), (60, -60), (60, 60), (-60, 60)], -1.6, -1.2)), "dark"


MATERIALS = {
    "rhodium": {"base": (0.60, 0.60, 0.61), "metal": 1, "rough": 0.35, "anisotropy": 0.6},
    "striped": {"base": (0.64, 0.63, 0.62), "metal": 1, "rough": 0.34, "anisotropy": 0.5, "turn": 1.5708},
    "gilt": {"base": (0.91, 0.72, 0.38), "metal": 1, "rough": 0.38},
    "polished gold": {"base": (0.95, 0.76, 0.40), "metal": 1, "rough": 0.18},
    "steel": {"base": (0.58, 0.57, 0.55), "metal": 1, "rough": 0.22},
    "blued": {"base": (0.05, 0.10, 0.42), "metal": 1, "rough": 0.22},
    "ruby": {"base": (1, 1, 1), "metal": 0, "rough": 0.0, "ruby": True},
    "dark": {"base": (0.02, 0.02, 0.024), "metal": 0, "rough": 0.7},
}


def stripes(side=64):
    """A normal map of Geneva stripes: each leans one way, more and more toward its edge."""
    tilt = [0.16 * (2 * (x + 0.5) / side - 1) ** 3 + 0.05 * (2 * (x + 0.5) / side - 1) for x in range(side)]
    return [[(round(127.5 + 127.5 * t), 128, round(127.5 + 127.5 * math.sqrt(1 - t * t))) for t in tilt] for _ in range(4)]


class Model:
    """Collects the buffer and the tables of a glTF file."""

    def __init__(self):
        self.data, self.tables = b"", {k: [] for k in ("bufferViews", "accessors", "meshes", "nodes", "materials", "cameras", "images", "textures")}

    def accessor(self, values, form, kind, bounds=False):
        packed = b"".join(struct.pack("<" + form, *v) if isinstance(v, tuple) else struct.pack("<" + form, v) for v in values)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)}
        self.data += packed + b"\0" * (-len(packed) % 4)
        entry = {"bufferView": len(self.tables["bufferViews"]), "componentType": {"H": 5123, "I": 5125}.get(form, 5126), "count": len(values), "type": kind}
        if bounds:
            entry["min"] = [struct.unpack("<f", struct.pack("<f", min(v[k] for v in values)))[0] for k in range(3)]
            entry["max"] = [struct.unpack("<f", struct.pack("<f", max(v[k] for v in values)))[0] for k in range(3)]
        self.tables["bufferViews"].append(view)
        self.tables["accessors"].append(entry)
        return len(self.tables["accessors"]) - 1

    def image(self, pixels):
        with tempfile.NamedTemporaryFile(suffix=".png") as file:
            write_png(file.name, pixels)
            packed = file.read()
        self.tables["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)})
        self.data += packed + b"\0" * (-len(packed) % 4)
        self.tables["images"].append({"bufferView": len(self.tables["bufferViews"]) - 1, "mimeType": "image/png"})
        self.tables["textures"].append({"source": len(self.tables["images"]) - 1})
        return len(self.tables["textures"]) - 1

    def mesh(self, name, mesh, material):
        mesh.weld()
        attributes = {
            "POSITION": self.accessor([v[:3] for v in mesh.vertices], "3f", "VEC3", bounds=True),
            "NORMAL": self.accessor([v[3:6] for v in mesh.vertices], "3f", "VEC3"),
        }
        # Texture coordinates give the direction of brushing; nothing else asks for them.
        if "KHR_materials_anisotropy" in self.tables["materials"][material].get("extensions", {}):
            attributes["TEXCOORD_0"] = self.accessor([v[6:8] for v in mesh.vertices], "2f", "VEC2")
        indices = self.accessor([i for t in mesh.triangles for i in t], "H" if len(mesh.vertices) < 65535 else "I", "SCALAR")
        self.tables["meshes"].append({"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": material}]})
        return self.node(name, mesh=len(self.tables["meshes"]) - 1)

    def node(self, name, **what):
        self.tables["nodes"].append({"name": name, **what})
        return len(self.tables["nodes"]) - 1

    def write(self, path, roots):
        used = ["KHR_materials_anisotropy", "KHR_materials_transmission", "KHR_materials_ior", "KHR_materials_volume", "KHR_materials_emissive_strength"]
        document = {"asset": {"version": "2.0", "generator": "scenes/generators/movement.py"}, "extensionsUsed": used, "scene": 0,
                    "scenes": [{"nodes": roots}], "buffers": [{"byteLength": len(self.data)}], **self.tables}
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(self.data), 0x004E4942) + self.data
        with open(path, "wb") as out:
            out.write(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)


def look(position, target):
    """A glTF matrix (column by column) that moves −z onto the way from position to target."""
    back = [p - t for p, t in zip(position, target)]
    size = math.sqrt(sum(v * v for v in back))
    back = [v / size for v in back]
    right = [back[2], 0.0, -back[0]]
    size = math.hypot(right[0], right[2])
    right = [v / size for v in right]
    up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]]
    return [*right, 0, *up, 0, *back, 0, *position, 1]


if __name__ == "__main__":
    model, number = Model(), {}
    for name, m in MATERIALS.items():
        entry = {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*m["base"], 1], "metallicFactor": m["metal"], "roughnessFactor": m["rough"]}}
        extensions = {}
        if "anisotropy" in m:
            extensions["KHR_materials_anisotropy"] = {"anisotropyStrength": m["anisotropy"], "anisotropyRotation": m.get("turn", 0.0)}
        if "turn" in m:
            entry["normalTexture"] = {"index": model.image(stripes())}
        if m.get("ruby"):
            extensions = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.77},
                          "KHR_materials_volume": {"thicknessFactor": 0.001, "attenuationDistance": 0.0006, "attenuationColor": [0.75, 0.02, 0.06]}}
        if extensions:
            entry["extensions"] = extensions
        number[name] = len(model.tables["materials"])
        model.tables["materials"].append(entry)
    children = [model.mesh(name, mesh, number[material]) for name, mesh, material in parts()]
    root = model.node("movement", children=children, scale=[0.001] * 3)
    roots = [root]
    for name, corner, u, v, strength in [
        ("soft box", (-0.10, 0.12, -0.13), (0.0, 0.02, 0.09), (0.13, 0.0, 0.0), 2.6),
        ("strip", (0.11, 0.03, -0.07), (0.0, 0.0, 0.13), (0.01, 0.09, 0.0), 2.2),
        ("low light", (-0.12, 0.015, -0.10), (0.0, 0.05, 0.0), (0.2, 0.0, -0.02), 1.2),
    ]:
        entry = {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}, "emissiveFactor": [1, 1, 1], "doubleSided": True,
                 "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}}
        model.tables["materials"].append(entry)
        add = lambda *vs: tuple(sum(c) for c in zip(*vs))
        mesh = Mesh()
        mesh.face([corner, add(corner, u), add(corner, u, v), add(corner, v)])
        roots.append(model.mesh(name, mesh, len(model.tables["materials"]) - 1))
    model.tables["cameras"].append({"type": "perspective", "perspective": {"yfov": math.radians(25), "znear": 0.001, "aspectRatio": 1.5}})
    roots.append(model.node("camera", camera=0, matrix=look((-0.013, 0.045, 0.034), (-0.0006, 0.0012, -0.0003))))
    model.write(PATH, roots)
