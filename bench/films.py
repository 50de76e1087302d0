#!/usr/bin/env python3
"""Hashes of some sixty films, one for each effect and way to trace paths: held against those of another build of the program.

    python3 bench/films.py > before.txt                   # with target/release/etalon, or the variable ETALON
    python3 bench/films.py --against before.txt           # exit status 1 if a film differs
    python3 bench/films.py --scenes DIR                   # only writes the scenes that are not in scenes/ to DIR

Takes 20 seconds. A hash covers every channel of the EXR file and what its header tells of errors; what tells of the plan, of
time and of the build is left out. Changes of code that are to change no film are held to this; it says nothing of whether a film
is right. Needs numpy.
"""
import argparse
import hashlib
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCENES = ROOT / "scenes"


def png(path, pixels):
    """Writes 8-bit RGB."""
    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def bumpy_ball(path, rows, columns):
    """A ball with waves on it, with normals and texture coordinates: 2·rows·columns triangles."""
    theta = np.linspace(0, math.pi, rows + 1)[:, None]
    phi = np.linspace(0, 2 * math.pi, columns + 1)[None, :]
    radius = 0.3 * (1 + 0.04 * np.sin(9 * theta) ** 2 * np.sin(11 * phi))
    p = np.stack([radius * np.sin(theta) * np.cos(phi), radius * np.cos(theta) + 0 * phi, radius * np.sin(theta) * np.sin(phi)], -1)
    along, across = np.gradient(p, axis=0), np.gradient(p, axis=1)
    n = np.cross(across, along)
    length = np.linalg.norm(n, axis=-1, keepdims=True)
    n = np.where(length > 1e-12, n / np.maximum(length, 1e-12), p / np.linalg.norm(p, axis=-1, keepdims=True))
    n *= np.sign(np.sum(n * p, -1, keepdims=True))
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    corner = (i * (columns + 1) + j).ravel()
    below, right = corner + columns + 1, corner + 1
    faces = np.concatenate([np.stack([corner, right, below], -1), np.stack([right, below + 1, below], -1)])
    with open(path, "w") as out:
        for v in p.reshape(-1, 3):
            out.write("v %.9g %.9g %.9g\n" % tuple(v))
        for u, v in zip(np.broadcast_to(phi, (rows + 1, columns + 1)).ravel(), np.broadcast_to(theta, (rows + 1, columns + 1)).ravel()):
            out.write("vt %.9g %.9g\n" % (u / (2 * math.pi), v / math.pi))
        for v in n.reshape(-1, 3):
            out.write("vn %.9g %.9g %.9g\n" % tuple(v))
        for a, b, c in faces + 1:
            out.write("f %d/%d/%d %d/%d/%d %d/%d/%d\n" % (a, a, a, b, b, b, c, c, c))


def lathe(path, profile, columns=48):
    """A closed body of revolution around y: `profile` goes from the axis to the axis, (radius, height) each."""
    ring = [(math.cos(2 * math.pi * k / columns), math.sin(2 * math.pi * k / columns)) for k in range(columns)]
    vertices, rows = [], []
    for radius, height in profile:
        if radius == 0:
            rows.append([len(vertices)] * columns)
            vertices.append((0.0, height, 0.0))
        else:
            rows.append(list(range(len(vertices), len(vertices) + columns)))
            vertices += [(radius * x, height, radius * z) for x, z in ring]
    with open(path, "w") as out:
        for v in vertices:
            out.write("v %.9g %.9g %.9g\n" % v)
        for a, b in zip(rows, rows[1:]):
            for k in range(columns):
                m = (k + 1) % columns
                for face in ((a[k], b[k], a[m]), (a[m], b[k], b[m])):
                    if len(set(face)) == 3:
                        out.write("f %d %d %d\n" % tuple(v + 1 for v in face))


def glass_of_water(priority, **water):
    """A glass on a table: with priorities the water touches the glass; without, it is a body of its own within."""
    key = lambda n: {"priority": n} if priority else {}
    return {
        "etalon": 1, "film": {"width": 320, "height": 240}, "integrator": {"spp": 64},
        "camera": {"type": "perspective", "position_m": [0.0, 0.2, 0.42], "look_at_m": [0, 0.055, 0], "vertical_fov_deg": 26},
        "materials": {
            "glass": {"type": "dielectric", "interior": "N-BK7", **key(2)},
            "water": {"type": "dielectric", "interior": "water", **key(1), **water},
            "table": {"type": "lambert", "reflectance": {"type": "rgb", "rgb": [0.35, 0.22, 0.12]}},
        },
        "objects": [
            {"name": "glass", "shape": {"type": "mesh", "file": "tumbler.obj"}, "material": "glass"},
            {"name": "water", "shape": {"type": "mesh", "file": "water%s.obj" % ("" if priority else "-alone")}, "material": "water"},
            {"name": "table", "shape": {"type": "parallelogram", "origin_m": [-1, -0.001, 1], "u_m": [2, 0, 0], "v_m": [0, 0, -2]}, "material": "table"},
            {"name": "lamp", "shape": {"type": "parallelogram", "origin_m": [-0.5, 0.6, -0.3], "u_m": [0.4, 0, 0], "v_m": [0, 0, 0.4]},
             "material": {"type": "black"}, "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": 10}, "sides": "both"}},
        ],
        "lights": [{"type": "environment", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.4}}],
    }


def preview(material):
    """A mesh of 60 k triangles on a textured rough floor under an image of the sky."""
    image = {"type": "image", "file": "tiles.png", "uv_scale": [6, 6]}
    return {
        "etalon": 1, "film": {"width": 320, "height": 240}, "integrator": {"spp": 64},
        "camera": {"type": "perspective", "position_m": [0.2, 0.6, 1.3], "look_at_m": [0, 0.2, 0], "vertical_fov_deg": 36},
        "materials": {"ball": material, "floor": {"type": "plastic", "reflectance": image, "alpha": 0.2}},
        "objects": [
            {"name": "ball", "shape": {"type": "mesh", "file": "bumpy.obj"}, "material": "ball", "transform": [{"translate_m": [0, 0.32, 0]}]},
            {"name": "floor", "shape": {"type": "parallelogram", "origin_m": [-2, 0, 2], "u_m": [4, 0, 0], "v_m": [0, 0, -4]}, "material": "floor"},
        ],
        "lights": [{"type": "environment", "image": {"file": os.path.relpath(SCENES / "evening-files/sky.hdr", "/"), "forward": [0, 0, 1]}}],
    }


def masks():
    """Leaves with opacity, some in one plane with the floor, some rough, under a sphere that shines."""
    scene = preview({"type": "lambert", "reflectance": 0.6})
    flat = lambda x, y, z, opacity, material: {
        "shape": {"type": "parallelogram", "origin_m": [x, y, z], "u_m": [0.5, 0, 0], "v_m": [0, 0, -0.4]}, "material": material, "opacity": opacity}
    scene["objects"] += [flat(-0.6, 0, 0.6, 0.5, "ball"), flat(-0.4, 0, 0.5, 0.3, "floor"), flat(0.2, 0.9, 0.3, 0.6, "ball")]
    scene["objects"].append({"shape": {"type": "sphere", "center_m": [0.6, 0.9, 0.4], "radius_m": 0.1}, "material": {"type": "black"}, "emission": {"radiance": 6}})
    return scene


def lamps(moves):
    """A lamp of each shape and kind over a rough floor; what emits from one side only can be seen into through masks."""
    lamp = lambda shape, sides="front", **more: {
        "shape": shape, "material": {"type": "lambert", "reflectance": 0.3}, "emission": {"radiance": 8, "sides": sides}, **more}
    tube = lambda x, capped: {"type": "cylinder", "start_m": [x, 0.5, -0.4], "end_m": [x + 0.2, 0.6, -0.2], "radius_m": 0.06, "capped": capped}
    triangle = {"type": "mesh", "vertices_m": [[-0.1, 0, 0], [0.1, 0, 0.05], [0, 0.15, 0]], "triangles": [[0, 1, 2]]}
    group = [lamp(triangle, "both"), lamp({"type": "sphere", "center_m": [0.3, 0, 0], "radius_m": 0.05})]
    group += [lamp({"type": "cylinder", "start_m": [0.1, 0.2, 0], "end_m": [0.2, 0.25, 0], "radius_m": 0.03})]
    steps = lambda x: [{"scale": [-1, 1, 1]}, {"rotate": {"axis": [0, 1, 0], "angle_deg": 90 * x}}, {"translate_m": [x, 0.4, 0.3]}]
    placed = {"keyframes": [{"time_s": 0, "transform": steps(-0.3)}, {"time_s": 1, "transform": steps(0.4)}]} if moves else {"transform": steps(0.2)}
    return {
        "etalon": 1, "film": {"width": 240, "height": 180}, "integrator": {"spp": 32},
        "camera": {"type": "perspective", "position_m": [0.1, 0.7, 1.8], "look_at_m": [0, 0.25, 0], "vertical_fov_deg": 40, "shutter_s": [0, 1]},
        "objects": [
            {"shape": {"type": "parallelogram", "origin_m": [-2, 0, 2], "u_m": [4, 0, 0], "v_m": [0, 0, -4]},
             "material": {"type": "oren-nayar", "reflectance": 0.6, "roughness": 0.5}},
            lamp(tube(-0.7, True)), lamp(tube(-0.3, False), "both"), lamp(tube(0.3, False), "back", opacity=0.5), lamp(tube(0.6, True), "back", opacity=0.4),
            lamp({"type": "sphere", "center_m": [-0.5, 0.2, 0.4], "radius_m": 0.1}), lamp({"type": "sphere", "center_m": [0.5, 0.2, 0.3], "radius_m": 0.1}, "back", opacity=0.5),
            lamp({"type": "disk", "center_m": [0, 0.9, -0.5], "normal": [0.1, -1, 0.2], "radius_m": 0.15}),
            lamp({"type": "disk", "center_m": [0.2, 0.3, -0.7], "normal": [0, 0.2, 1], "radius_m": 0.1}, "back"),
            lamp({"type": "parallelogram", "origin_m": [-0.9, 0.1, -0.5], "u_m": [0.2, 0, 0.1], "v_m": [0, 0.3, 0]}, "both"),
        ],
        "groups": {"things": {"objects": group}}, "instances": [{"group": "things", **placed}],
        "lights": [
            {"type": "point", "position_m": [0.8, 0.8, 0.5], "intensity": 0.3}, {"type": "directional", "direction": [0.3, -1, -0.2], "irradiance": 0.1},
            {"type": "spot", "position_m": [-0.4, 1, 0.8], "direction": [0.2, -1, -0.5], "half_angle_deg": 25, "intensity": 1},
        ],
    }


def write_scenes(folder):
    folder.mkdir(parents=True, exist_ok=True)
    bumpy_ball(folder / "bumpy.obj", 120, 250)
    lathe(folder / "tumbler.obj", [(0, 0), (0.036, 0), (0.04, 0.12), (0.037, 0.12), (0.0335, 0.008), (0, 0.008)])
    lathe(folder / "water.obj", [(0, 0.006), (0.0345, 0.006), (0.0375, 0.09), (0, 0.09)])
    lathe(folder / "water-alone.obj", [(0, 0.01), (0.032, 0.01), (0.0345, 0.09), (0, 0.09)])
    y, x = np.mgrid[0:64, 0:64]
    dark = ((x // 16 + y // 16) % 2).astype(bool)[..., None]
    png(folder / "tiles.png", np.where(dark, np.uint8([60, 80, 120]), np.uint8([210, 190, 160])) + (x % 16)[..., None].astype(np.uint8))
    sky = folder / "sky.hdr"
    sky.write_bytes((SCENES / "evening-files/sky.hdr").read_bytes())
    made = {
        "water-in-glass": glass_of_water(True), "water-alone": glass_of_water(False),
        "wine": glass_of_water(True, absorption_per_m=
                               {"type": "tabulated", "wavelengths_nm": [360, 500, 560, 620, 830], "values": [40, 38, 21, 4, 1]}),
        "preview-diffuse": preview({"type": "lambert", "reflectance": 0.6}),
        "preview-plastic": preview({"type": "plastic", "reflectance": {"type": "rgb", "rgb": [0.1, 0.3, 0.5]}, "alpha": 0.1}),
        "preview-glass": preview({"type": "dielectric", "interior": 1.5}),
        "preview-rough-glass": preview({"type": "dielectric", "interior": "N-BK7", "alpha": 0.2}),
        "masks": masks(), "lamps": lamps(False), "moving-lamps": lamps(True),
    }
    for name, scene in made.items():
        for light in scene["lights"]:
            if "image" in light:
                light["image"]["file"] = "sky.hdr"
        (folder / (name + ".json")).write_text(json.dumps(scene, indent=1))
    return sorted(made)


def films(folder, made):
    """(name, scene, arguments) of each film."""
    listed = [(path.stem, path, "") for path in sorted(SCENES.glob("*.json"))]
    listed += [(name, folder / (name + ".json"), "") for name in made]
    again = [
        ("cornell", "--loop {scalar}"), ("cornell-glass", "--loop {scalar}"), ("lanterns", "--loop {scalar}"), ("evening", "--loop {scalar}"),
        ("cornell", "--path-reuse 4x2"), ("cornell", "--path-reuse 4x4 --loop {scalar}"), ("lanterns", "--path-reuse 2x2"),
        ("cornell", "--sampler independent --replicates 1"), ("cornell", "--light-sampling light"), ("cornell", "--light-sampling bsdf"),
        ("cornell", "--max-depth 3"), ("veach-mis", "--light-sampling bsdf"), ("prism", "--bands 420:680:20"),
        ("cornell-glass", "--polarised"), ("evening", "--polarised"), ("metals", "--polarised --bands 450:650:50"),
        ("polarisers", "--bands 450:650:50"), ("cornell", "--force wavelengths"), ("cornell", "--force dispersion"),
        ("cornell", "--force nested-dielectrics --force motion"), ("cornell-glass", "--without dispersion"),
        ("cornell", "--carry three-channels"), ("cornell-glass", "--carry one-wavelength"), ("cornell-glass", "--carry four-wavelengths"),
        ("wine", "--loop {scalar}"), ("wine", "--polarised"), ("masks", "--sampler independent"), ("fan", "--bands 420:680:20"),
        ("window", "--path-reuse 2x2"), ("lamps", "--loop {scalar}"), ("lamps", "--light-sampling light"), ("moving-lamps", "--loop {scalar}"),
    ]
    where = {name: path for name, path, _ in listed}
    return listed + [(name, where[name], more) for name, more in again]


# Of the build and the machine, not of the film.
LEFT_OUT = ("Seconds", "software", "plan", "sceneSha256")


def hash_of(path):
    """SHA-256 of the pixels and of most of the header of an EXR file."""
    data = path.read_bytes()
    at, digest = 8, hashlib.sha256()
    while data[at] != 0:
        name, _, rest = data[at:at + 256].partition(b"\0")
        kind, _, _ = rest.partition(b"\0")
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        value = data[at + 4:at + 4 + size]
        at += 4 + size
        if not name.decode().endswith(LEFT_OUT):
            digest.update(name + value)
    (height,) = [struct.unpack("<4i", data[m + 15:m + 31])[3] + 1 for m in [data.index(b"dataWindow\0box2i\0") + 6]]
    # The table of offsets depends on the length of the header.
    count = next(n for n in range(1, height + 1) if struct.unpack_from("<Q", data, at + 1)[0] == at + 1 + 8 * n)
    digest.update(data[at + 1 + 8 * count:])
    return digest.hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", type=pathlib.Path, help="hashes printed before")
    parser.add_argument("--scenes", type=pathlib.Path, help="write the scenes there, and end")
    parser.add_argument("--only", help="films whose name has this in it")
    parser.add_argument("--scalar", default="scalar", help="what this build calls the loop that follows one path at a time")
    args = parser.parse_args()
    if args.scenes:
        print(*write_scenes(args.scenes))
        return 0
    program = os.environ.get("ETALON") or str(ROOT / "target/release/etalon")
    before = dict(line.rsplit(" ", 1) for line in args.against.read_text().splitlines()) if args.against else {}
    differ = 0
    with tempfile.TemporaryDirectory(prefix="films-") as folder:
        folder = pathlib.Path(folder)
        for name, scene, more in films(folder, write_scenes(folder)):
            label = ("%s %s" % (name, more)).strip()
            if args.only and args.only not in label:
                continue
            out = folder / "out.exr"
            out.unlink(missing_ok=True)
            command = [program, "render", str(scene), "-o", str(out), "--spp", "4", "--size", "40x30", "--quiet"]
            ran = subprocess.run(command + more.format(scalar=args.scalar).split(), capture_output=True, text=True)
            found = hash_of(out) if ran.returncode == 0 else "failed"
            print(label, found, flush=True)
            if ran.returncode != 0:
                print(ran.stderr, file=sys.stderr)
            if before and before.get(label) != found:
                differ += 1
                print("^ differs", file=sys.stderr)
    if args.against:
        print("%d films differ" % differ, file=sys.stderr)
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
