"""Meshes and images of a scene's files as arrays, for renderers that do not read the files as Mitsuba does.

Images are written again as linear EXR, so no renderer's colour management decides what an image means. Needs numpy and pillow. It does not
take the module OpenEXR, which ends the process when it is loaded beside LuxCore.
"""
import hashlib
import json
import os
import pathlib
import struct

import numpy as np

import draw

TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
         "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}


# -------------------------------------------------------------- meshes
class Mesh:
    """Triangles with a normal and texture coordinates at each corner point; uv may be None."""

    def __init__(self, p, n, uv, faces):
        self.p, self.n, self.uv, self.faces = p, n, uv, faces

    def moved(self, matrix):
        m = np.asarray(matrix, float)
        n = self.n @ np.linalg.inv(m[:3, :3])
        return Mesh(self.p @ m[:3, :3].T + m[:3, 3], n / np.linalg.norm(n, axis=1, keepdims=True), self.uv, self.faces)

    def left_handed(self):
        """Whether u, v and the normal are a left-handed frame on most triangles. Mitsuba's bitangent is n × u there, too."""
        if self.uv is None:
            return False
        a, b, c = (self.uv[self.faces[:, k]] for k in range(3))
        p, q, r = (self.p[self.faces[:, k]] for k in range(3))
        turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        outward = (np.cross(q - p, r - p) * self.n[self.faces].sum(1)).sum(1)
        return bool((np.sign(turn) * np.sign(outward)).sum() < 0)

    def ply(self, path):
        """Writes it with the names of texture coordinates that LuxCore reads."""
        draw.ply(pathlib.Path(path), self.p, self.n, self.uv if self.uv is not None else np.zeros((len(self.p), 2)), self.faces, "st")


def smooth_normals(p, faces):
    a, b, c = (p[faces[:, k]] for k in range(3))
    n = np.zeros_like(p)
    for k in range(3):
        np.add.at(n, faces[:, k], np.cross(b - a, c - a))
    return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-30)


def read_ply(path):
    """A binary little-endian file whose faces are all triangles or all quadrilaterals."""
    raw = pathlib.Path(path).read_bytes()
    end = raw.index(b"end_header\n") + 11
    lines = [line.split() for line in raw[:end].decode().splitlines()]
    if ["format", "binary_little_endian", "1.0"] not in lines:
        raise ValueError("%s is not binary little-endian" % path)
    at, element, fields, count = end, None, {}, {}
    for words in lines:
        if words[0] == "element":
            element, count[words[1]], fields[words[1]] = words[1], int(words[2]), []
        elif words[0] == "property":
            fields[element].append(words[1:])
    if list(count)[:2] != ["vertex", "face"] or len(fields["face"]) != 1:
        raise ValueError("%s has other elements than points and faces" % path)
    vertex = np.frombuffer(raw, [(name, "<" + TYPES[kind]) for kind, name in fields["vertex"]], count["vertex"], at)
    at += vertex.nbytes
    _, size, index, _ = fields["face"][0]
    corners = int(np.frombuffer(raw, "<" + TYPES[size], 1, at)[0])
    face = np.frombuffer(raw, [("count", "<" + TYPES[size]), ("index", "<" + TYPES[index], corners)], count["face"], at)
    if corners not in (3, 4) or (face["count"] != corners).any():
        raise ValueError("%s has faces of several kinds" % path)
    faces = face["index"].astype(np.int32)
    faces = faces if corners == 3 else np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]])
    columns = lambda *names: np.stack([vertex[k] for k in names], 1).astype(float) if names[0] in vertex.dtype.names else None
    p = columns("x", "y", "z")
    n = columns("nx", "ny", "nz")
    uv = columns("u", "v") if "u" in vertex.dtype.names else columns("s", "t")
    return Mesh(p, n if n is not None else smooth_normals(p, faces), uv, faces)


def quad(shape):
    """A parallelogram with u along e1 and v along e2."""
    c, e1, e2 = (np.array(shape[k], float) for k in ("corner", "e1", "e2"))
    n = np.cross(e1, e2)
    return Mesh(np.stack([c, c + e1, c + e1 + e2, c + e2]), np.tile(n / np.linalg.norm(n), (4, 1)),
                np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]]))


# -------------------------------------------------------------- colours
def fresnel(mu, index):
    """Reflectance at cosine mu, where the near side has `index` times the index of the far side."""
    inside = 1 - index ** 2 * (1 - mu ** 2)
    cos = np.sqrt(np.maximum(inside, 0))
    s = ((index * mu - cos) / (index * mu + cos)) ** 2
    p = ((mu - index * cos) / (mu + index * cos)) ** 2
    return np.where(inside > 0, (s + p) / 2, 1)


def diffuse_reflectance(index, alpha, steps=64):
    """Share of diffuse light that a surface of GGX sends back: the mean over directions of F G, with visible normals as the quadrature."""
    mid = (np.arange(steps) + 0.5) / steps
    mu, u, v = np.meshgrid(np.sqrt(mid), mid, mid, indexing="ij")
    alpha = max(alpha, 1e-4)
    # The direction seen on the sphere that the ellipsoid of GGX is, and a point of its disk that faces it.
    x, z = alpha * np.sqrt(1 - mu ** 2), mu
    x, z = x / np.hypot(x, z), z / np.hypot(x, z)
    a, b = np.sqrt(u) * np.cos(2 * np.pi * v), np.sqrt(u) * np.sin(2 * np.pi * v)
    b = (1 - z) / 2 * np.sqrt(1 - a ** 2) + (1 + z) / 2 * b
    c = np.sqrt(np.maximum(1 - a ** 2 - b ** 2, 0))
    h = np.stack([alpha * (c * x - b * z), alpha * a, np.maximum(c * z + b * x, 0)])
    h /= np.linalg.norm(h, axis=0)
    cosine = np.sqrt(1 - mu ** 2) * h[0] + mu * h[2]
    out = 2 * cosine * h[2] - mu
    tan2 = (1 - out ** 2) / np.maximum(out, 1e-9) ** 2
    return float((fresnel(cosine, index) * np.where(out > 0, 2 / (1 + np.sqrt(1 + alpha ** 2 * tan2)), 0)).mean())


def under_coat(material):
    """What becomes of a plastic's diffuse reflectance r that is told without its coat: r t/(1 - f r).

    f is the share that the coat sends back inside, t the share 1 - f that leaves (where the coat is rough Mitsuba's two do not add up to 1).
    The peers' coats weaken what lies under them by what they reflect, but send nothing back inside."""
    f = diffuse_reflectance(material["ior"], material["alpha"])
    t = (1 - diffuse_reflectance(1 / material["ior"], material["alpha"])) / material["ior"] ** 2
    return lambda r: r * t / (1 - f * (r if material["nonlinear"] else 1))


def linear(srgb):
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def write_exr(path, pixels):
    """Writes three channels of 32 bits, row by row, uncompressed."""
    height, width, _ = pixels.shape
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    attributes = [(b"channels", b"chlist", channels), (b"compression", b"compression", b"\0"), (b"dataWindow", b"box2i", box),
                  (b"displayWindow", b"box2i", box), (b"lineOrder", b"lineOrder", b"\0"), (b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
                  (b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)), (b"screenWindowWidth", b"float", struct.pack("<f", 1))]
    head = struct.pack("<2i", 20000630, 2) + b"".join(
        name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data for name, kind, data in attributes) + b"\0"
    row = 12 * width
    places = len(head) + 8 * height + (8 + row) * np.arange(height)
    rows = np.zeros(height, [("y", "<i4"), ("size", "<i4"), ("bgr", "<f4", (3, width))])
    rows["y"], rows["size"], rows["bgr"] = np.arange(height), row, pixels[..., ::-1].transpose(0, 2, 1)
    pathlib.Path(path).write_bytes(head + places.astype("<u8").tobytes() + rows.tobytes())


def image(colour, folder, change=None, upside_down=False):
    """Writes the image of a colour as linear EXR and returns its path. `change` maps its values."""
    from PIL import Image
    pixels = np.asarray(Image.open(colour["image"]).convert("RGB"), np.float64) / 255
    pixels = pixels if colour["raw"] else linear(pixels)
    pixels = np.ascontiguousarray((change(pixels) if change else pixels)[::-1 if upside_down else 1], np.float32)
    key = hashlib.sha256(json.dumps([colour, upside_down], sort_keys=True).encode() + pixels.tobytes()).hexdigest()[:16]
    path = os.path.join(folder, key + ".exr")
    if not os.path.exists(path):
        write_exr(path, pixels)
    return path


def turn_green(pixels):
    """A normal map for a left-handed frame."""
    return np.stack([pixels[..., 0], 1 - pixels[..., 1], pixels[..., 2]], -1)
