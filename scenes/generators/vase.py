"""Writes scenes/vase.json and what it names: a turned vase as a mesh file with smooth normals, under glazed tiles.

The profile is a cubic Bézier curve; normals are those of the surface of revolution, so the mesh of 96 by 48 looks round.
Plain standard library.
"""

import math
import os
import struct
import zlib

import scene_text

ROUND, TALL = 96, 48
PROFILE_M = [(0.055, 0.0), (0.17, 0.10), (0.02, 0.20), (0.075, 0.30)]  # radius, height
FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "vase-files")


def profile(t):
    """Radius, height and their derivatives."""
    s = 1 - t
    weights = (s**3, 3 * s * s * t, 3 * s * t * t, t**3)
    slopes = (-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t)
    mix = lambda w, k: sum(a * p[k] for a, p in zip(w, PROFILE_M))
    return mix(weights, 0), mix(weights, 1), mix(slopes, 0), mix(slopes, 1)


def mesh():
    vertices, triangles = [], []
    for i in range(TALL + 1):
        radius, height, d_radius, d_height = profile(i / TALL)
        length = math.hypot(d_radius, d_height)
        for j in range(ROUND + 1):
            angle = 2 * math.pi * j / ROUND
            c, s = math.cos(angle), math.sin(angle)
            normal = (d_height / length * c, -d_radius / length, d_height / length * s)
            vertices.append((radius * c, height, radius * s, *normal, j / ROUND, i / TALL))
    for i in range(TALL):
        for j in range(ROUND):
            a = i * (ROUND + 1) + j
            b = a + ROUND + 1
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    return vertices, triangles


def write_ply(path, vertices, triangles):
    names = ("x", "y", "z", "nx", "ny", "nz", "u", "v")
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {len(triangles)}", "property list uchar ushort vertex_indices", "end_header", ""]
    with open(path, "wb") as out:
        out.write("\n".join(header).encode())
        for vertex in vertices:
            out.write(struct.pack("<8f", *vertex))
        for triangle in triangles:
            out.write(struct.pack("<B3H", 3, *triangle))


def write_png(path, pixels):
    """Rows of (red, green, blue) as 8-bit PNG."""
    raw = b"".join(b"\0" + bytes(v for pixel in row for v in pixel) for row in pixels)
    chunk = lambda kind, data: (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    )
    head = struct.pack(">IIBBBBB", len(pixels[0]), len(pixels), 8, 2, 0, 0, 0)
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def tiles(size=128):
    """A blue and white pattern that repeats: an eight-pointed star in a ring, on cream."""
    cream, blue, red = (238, 231, 214), (34, 66, 140), (168, 62, 40)

    def colour(column, row):
        x, y = (2 * (column + 0.5) / size - 1, 2 * (row + 0.5) / size - 1)
        star = min(max(abs(x), abs(y)), (abs(x) + abs(y)) / math.sqrt(2))
        radius = math.hypot(x, y)
        if star < 0.38:
            return red if radius < 0.16 else blue
        return blue if 0.72 < radius < 0.84 or max(abs(x), abs(y)) > 0.95 else cream

    return [[colour(column, row) for column in range(size)] for row in range(size)]


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    write_ply(os.path.join(FOLDER, "vase.ply"), *mesh())
    write_png(os.path.join(FOLDER, "tiles.png"), tiles())
    scene_text.write("vase", {
        "etalon": 1,
        "comment": [
            "A vase from a mesh file: its normals make it round, an image covers it, and it stands on the same tiles.",
            "Made by generators/vase.py.",
        ],
        "camera": {
            "type": "perspective", "position_m": [0.35, 0.42, 0.9], "look_at_m": [0, 0.14, 0], "vertical_fov_deg": 26,
        },
        "film": {"width": 640, "height": 640},
        "spectra": {
            "glaze": {"type": "image", "file": "vase-files/tiles.png", "uv_scale": [8, 6]},
            "floor tiles": {"type": "image", "file": "vase-files/tiles.png", "uv_scale": [10, 10], "factor": [0.8, 0.8, 0.8]},
        },
        "materials": {
            "glazed": {"type": "lambert", "reflectance": "glaze"},
            "floor": {"type": "lambert", "reflectance": "floor tiles"},
            "black": {"type": "black"},
        },
        "objects": [
            {"name": "vase", "shape": {"type": "mesh", "file": "vase-files/vase.ply"}, "material": "glazed"},
            {
                "name": "floor",
                "shape": {"type": "parallelogram", "origin_m": [-1, 0, 1], "u_m": [2, 0, 0], "v_m": [0, 0, -2]},
                "material": "floor",
            },
            {
                "name": "window",
                "shape": {"type": "parallelogram", "origin_m": [-0.9, 0.3, -0.3], "u_m": [0, 0.8, 0], "v_m": [0.3, 0, 0.9]},
                "material": "black",
                "emission": {"radiance": {"type": "illuminant", "name": "D65", "scale": 12}, "sides": "both"},
            },
        ],
        "lights": [{"type": "environment", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.3}}],
        "integrator": {"spp": 128},
    })
