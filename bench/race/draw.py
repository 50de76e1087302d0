"""Draws scenes of kinds that people render, from a seed, as files of Mitsuba 3 that every renderer with a reader for them can show.

    python3 draw.py SEED COUNT DIR       # writes DIR/SEED-1.xml … and what they refer to, and prints a line about each

A scene is one choice from each row of CHOICES and numbers around it. Nothing of a scene is chosen by hand, and a draw is a function
of its seed alone. Meshes, skies and textures are made here by formulas; a folder of published ones (RACE_ASSETS, with *.ply, *.hdr
and *.png or *.jpg) takes the place of every second of each kind. Needs numpy.
"""
import hashlib
import json
import math
import os
import pathlib
import struct
import sys
import zlib

import numpy as np

CHOICES = {
    "geometry": ["mesh-10k", "mesh-60k", "mesh-300k", "mesh-1m", "instances"],
    "light": ["sky", "sun", "lamps", "many-lamps"],
    "material": ["diffuse", "plastic", "rough-metal", "glass", "blend", "normal-mapped", "masked"],
    "texture": [True, False],
    "lens": [True, False],
}
SIZE = (320, 240)
MAX_DEPTH = 12


# ---------------------------------------------------------------- files
def png(path, pixels):
    """Writes 8-bit RGB or grey."""
    height, width = pixels.shape[:2]
    kind = 2 if pixels.ndim == 3 else 0
    rows = b"".join(b"\0" + row.tobytes() for row in np.ascontiguousarray(pixels, np.uint8))
    chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    head = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b""))


def hdr(path, pixels):
    """Writes Radiance RGBE without run lengths."""
    height, width, _ = pixels.shape
    largest = pixels.max(-1)
    mantissa, exponent = np.frexp(np.maximum(largest, 1e-32))
    rgbe = np.zeros((height, width, 4), np.uint8)
    rgbe[..., :3] = np.clip(pixels * (mantissa * 256 / np.maximum(largest, 1e-32))[..., None], 0, 255)
    rgbe[..., 3] = exponent + 128
    # A row that begins with 2, 2 would be read as run lengths.
    rgbe[..., 0][(rgbe[..., 0] == 2) & (rgbe[..., 1] == 2)] = 3
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + rgbe.tobytes())


def ply(path, p, n, uv, faces, names="uv"):
    """Writes a binary mesh with normals and texture coordinates, which have two names."""
    vertex = np.zeros(len(p), [(name, "<f4") for name in ["x", "y", "z", "nx", "ny", "nz", *names]])
    for k, name in enumerate("xyz"):
        vertex[name], vertex["n" + name] = p[:, k], n[:, k]
    vertex[names[0]], vertex[names[1]] = uv[:, 0], uv[:, 1]
    face = np.zeros(len(faces), [("count", "u1"), ("index", "<i4", 3)])
    face["count"], face["index"] = 3, faces
    properties = "".join("property float %s\n" % name for name in vertex.dtype.names)
    path.write_bytes(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n%selement face %d\n"
                      "property list uchar int vertex_indices\nend_header\n" % (len(p), properties, len(faces))).encode()
                     + vertex.tobytes() + face.tobytes())


# ---------------------------------------------------------------- what there is to see
def waves(rng, count, largest):
    """A smooth periodic function of two angles, of values within some ±1."""
    terms = [(rng.integers(1, largest), rng.integers(1, largest), rng.uniform(0, 2 * math.pi, 2), rng.uniform(0.3, 1)) for _ in range(count)]
    return lambda a, b: sum(w * np.sin(i * a + s[0]) * np.sin(j * b + s[1]) for i, j, s, w in terms) / count


def body(path, rng, triangles):
    """A ball or a ring of radius 1 with bumps, closed."""
    columns = int(math.sqrt(triangles))
    rows = max(8, triangles // (2 * columns))
    a = np.linspace(0, 2 * math.pi, columns + 1)[None, :]
    ring = bool(rng.random() < 0.4)
    b = np.linspace(0, 2 * math.pi if ring else math.pi, rows + 1)[:, None]
    bump = 1 + rng.uniform(0.05, 0.15) * waves(rng, 4, 7)(a, 2 * b) * (1 if ring else np.sin(b) ** 2)
    if ring:
        tube = 0.35 * bump
        p = np.stack([(0.65 + tube * np.cos(b)) * np.cos(a), tube * np.sin(b) + 0 * a, (0.65 + tube * np.cos(b)) * np.sin(a)], -1)
    else:
        p = np.stack([bump * np.sin(b) * np.cos(a), bump * np.cos(b) + 0 * a, bump * np.sin(b) * np.sin(a)], -1)
    # Over the edges of the chart the body goes on.
    along = np.gradient(np.concatenate([p[-2:-1], p, p[1:2]]) if ring else p, axis=0)
    along = along[1:-1] if ring else along
    across = np.gradient(np.concatenate([p[:, -2:-1], p, p[:, 1:2]], 1), axis=1)[:, 1:-1]
    n = np.cross(across, along)
    length = np.linalg.norm(n, axis=-1, keepdims=True)
    n = np.where(length > 1e-12, n / np.maximum(length, 1e-12), p / np.linalg.norm(p, axis=-1, keepdims=True))
    outward = p - np.stack([0.65 * np.cos(a) + 0 * b, 0 * a + 0 * b, 0.65 * np.sin(a) + 0 * b], -1) if ring else p
    n *= np.sign((n * outward).sum(-1, keepdims=True))
    uv = np.stack(np.broadcast_arrays(a / (2 * math.pi), b / (2 * math.pi if ring else math.pi)), -1)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    corner = i * (columns + 1) + j
    below, right = corner + columns + 1, corner + 1
    faces = np.concatenate([np.stack([corner, right, below], -1), np.stack([right, below + 1, below], -1)])
    points = p.reshape(-1, 3)
    corners = points[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=-1)
    # Mitsuba and others take the normal of a face from the order of its corners.
    faces, corners = faces[area > 1e-14], corners[area > 1e-14]
    turned = (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * n.reshape(-1, 3)[faces].sum(1)).sum(-1) < 0
    faces[turned] = faces[turned][:, ::-1]
    ply(path, points, n.reshape(-1, 3), uv.reshape(-1, 2), faces)


def sky(path, rng, sun):
    """A sky over a dark ground, with clouds or with a sun of one degree."""
    width, height = (2048, 1024) if sun else (1024, 512)
    theta = (np.arange(height)[:, None] + 0.5) / height * math.pi
    phi = (np.arange(width)[None, :] + 0.5) / width * 2 * math.pi
    up = np.cos(theta)
    zenith, horizon = rng.uniform([0.15, 0.3, 0.6], [0.35, 0.5, 1.0]), rng.uniform([0.6, 0.6, 0.6], [1.0, 0.9, 0.9])
    mix = np.clip(up, 0, 1)[..., None] ** 0.5
    image = np.where(up[..., None] > 0, zenith * mix + horizon * (1 - mix), rng.uniform(0.05, 0.2) * np.ones(3)) * np.ones((1, width, 1))
    cloud = np.clip(sum(waves(rng, 6, 2 ** k * 3)(phi, theta) / k for k in (1, 2, 3)), 0, 1)[..., None] * (up[..., None] > 0)
    image = image + rng.uniform(0.5, 2.0) * cloud
    at = (rng.uniform(0.25, 1.2), rng.uniform(0, 2 * math.pi))
    cosine = np.cos(theta) * math.cos(at[0]) + np.sin(theta) * math.sin(at[0]) * np.cos(phi - at[1])
    if sun:
        image = image + 20000 * rng.uniform(0.5, 2) * np.array([1.0, 0.9, 0.75]) * (cosine > math.cos(math.radians(0.5)))[..., None]
    else:
        # A bright window or a softened sun.
        image = image + rng.uniform(10, 60) * np.exp((cosine - 1) / rng.uniform(0.002, 0.02))[..., None]
    hdr(path, image)


def picture(path, rng, grey=False):
    """A pattern with edges and gradients, 512 × 512."""
    x, y = np.meshgrid(np.linspace(0, 2 * math.pi, 512, endpoint=False), np.linspace(0, 2 * math.pi, 512, endpoint=False))
    field = waves(rng, 5, 9)(x, y)
    stripes = (np.sin(int(rng.integers(2, 9)) * x + 3 * field) > rng.uniform(-0.4, 0.4)).astype(float)
    fine = 0.5 + 0.5 * waves(rng, 5, 40)(x, y)
    if grey:
        png(path, 255 * np.clip(0.75 * stripes + 0.25 * fine, 0, 1))
        return
    first, second = rng.uniform(0.05, 0.85, 3), rng.uniform(0.05, 0.85, 3)
    colour = stripes[..., None] * first + (1 - stripes[..., None]) * second
    png(path, 255 * np.clip(colour * (0.7 + 0.3 * fine[..., None]), 0, 1))


def normals(path, rng):
    """A normal map of waves."""
    x, y = np.meshgrid(np.linspace(0, 2 * math.pi, 512, endpoint=False), np.linspace(0, 2 * math.pi, 512, endpoint=False))
    height = waves(rng, 6, 12)(x, y) * rng.uniform(0.05, 0.2)
    dx, dy = (np.roll(height, -1, k) - np.roll(height, 1, k) for k in (1, 0))
    n = np.stack([-dx * 40, -dy * 40, np.ones_like(dx)], -1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    png(path, np.round(127.5 + 127.5 * n))


# ---------------------------------------------------------------- the scene
class Draw:
    def __init__(self, seed, number, folder):
        digest = hashlib.sha256(b"%s %d" % (seed.encode(), number)).digest()
        self.rng = np.random.default_rng(np.frombuffer(digest, "<u4"))
        self.name, self.folder = "%s-%d" % (seed, number), pathlib.Path(folder)
        self.chosen = {key: values[int(self.rng.integers(len(values)))] for key, values in CHOICES.items()}
        self.found = {}

    def asset(self, kind, ending, make):
        """The name of a file: a published one for every second, if there is a folder of them, else one that `make` writes."""
        published = sorted(pathlib.Path(os.environ.get("RACE_ASSETS", "/nowhere")).glob("*" + ending)) if ending else []
        if published and self.rng.random() < 0.5:
            path = published[int(self.rng.integers(len(published)))]
            self.found[kind] = path.name
            return str(path.resolve())
        path = self.folder / ("%s-%s%s" % (self.name, kind, ending))
        make(path)
        return path.name

    def colour(self, name, texture, lowest=0.1, highest=0.8):
        if texture:
            file = self.asset("colour-%s" % name, ".png", lambda path: picture(path, self.rng))
            scale = float(self.rng.integers(1, 6))
            return ('<texture type="bitmap" name="{n}"><string name="filename" value="{f}"/><transform name="to_uv"><scale x="{s}" y="{s}"/>'
                    '</transform></texture>').format(n=name, f=file, s=scale)
        return '<rgb name="%s" value="%s"/>' % (name, " ".join("%.4f" % v for v in self.rng.uniform(lowest, highest, 3)))

    def diffuse(self, texture):
        return '<bsdf type="twosided"><bsdf type="diffuse">%s</bsdf></bsdf>' % self.colour("reflectance", texture)

    def plastic(self, texture):
        alpha = self.rng.uniform(0.05, 0.3)
        kind = "plastic" if self.rng.random() < 0.4 else "roughplastic"
        rough = "" if kind == "plastic" else '<string name="distribution" value="ggx"/><float name="alpha" value="%.4f"/>' % alpha
        return ('<bsdf type="twosided"><bsdf type="%s"><float name="int_ior" value="1.5"/><boolean name="nonlinear" value="true"/>%s%s</bsdf></bsdf>'
                % (kind, rough, self.colour("diffuse_reflectance", texture)))

    def metal(self):
        # Indices that do not depend on the wavelength: tables of metals differ among programs.
        n, k = self.rng.uniform(0.15, 1.5), self.rng.uniform(2.0, 5.0)
        return ('<bsdf type="twosided"><bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="%.4f"/>'
                '<spectrum name="eta" value="%.4f"/><spectrum name="k" value="%.4f"/></bsdf></bsdf>' % (self.rng.uniform(0.05, 0.4), n, k))

    def material(self):
        kind, texture = self.chosen["material"], self.chosen["texture"]
        if kind == "diffuse":
            return self.diffuse(texture)
        if kind == "plastic":
            return self.plastic(texture)
        if kind == "rough-metal":
            return self.metal()
        if kind == "glass":
            return '<bsdf type="dielectric"><float name="int_ior" value="%.4f"/><float name="ext_ior" value="1"/></bsdf>' % self.rng.uniform(1.3, 1.8)
        if kind == "blend":
            file = self.asset("weight", "-grey.png", lambda path: picture(path, self.rng, grey=True))
            weight = '<texture type="bitmap" name="weight"><string name="filename" value="%s"/><boolean name="raw" value="true"/></texture>' % file
            weight = weight if texture else '<float name="weight" value="%.4f"/>' % self.rng.uniform(0.2, 0.8)
            # One diffuse and one rough metal, two-sided as one.
            strip = lambda text: text.replace('<bsdf type="twosided">', "", 1)[:-len("</bsdf>")]
            return '<bsdf type="twosided"><bsdf type="blendbsdf">%s%s%s</bsdf></bsdf>' % (weight, strip(self.diffuse(texture)), strip(self.metal()))
        if kind == "normal-mapped":
            file = self.asset("normal", "-normal.png", lambda path: normals(path, self.rng))
            inner = self.plastic(texture) if self.rng.random() < 0.5 else self.diffuse(texture)
            inner = inner.replace('<bsdf type="twosided">', "", 1)[:-len("</bsdf>")]
            return ('<bsdf type="twosided"><bsdf type="normalmap"><texture name="normalmap" type="bitmap"><boolean name="raw" value="true"/>'
                    '<string name="filename" value="%s"/></texture>%s</bsdf></bsdf>' % (file, inner))
        file = self.asset("mask", "-grey.png", lambda path: picture(path, self.rng, grey=True))
        return ('<bsdf type="mask"><texture type="bitmap" name="opacity"><string name="filename" value="%s"/><boolean name="raw" value="true"/>'
                '</texture>%s</bsdf>' % (file, self.diffuse(texture)))

    def body(self, triangles):
        return self.asset("body", ".ply", lambda path: body(path, self.rng, triangles))

    def turn(self):
        """A rotation. Mitsuba takes the axis as it is, so it must have length 1."""
        axis = self.rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        return '<rotate x="%.9f" y="%.9f" z="%.9f" angle="%.2f"/>' % (*axis, self.rng.uniform(0, 360))

    def objects(self):
        kind = self.chosen["geometry"]
        if kind == "instances":
            file = self.body(5000)
            count = int(self.rng.integers(40, 200))
            shapes = ['<shape type="shapegroup" id="group"><shape type="ply"><string name="filename" value="%s"/>%s</shape></shape>'
                      % (file, self.material())]
            for _ in range(count):
                radius, angle = 1.8 * math.sqrt(self.rng.random()), self.rng.uniform(0, 2 * math.pi)
                size = self.rng.uniform(0.06, 0.2)
                shapes.append('<shape type="instance"><transform name="to_world"><scale value="%.4f"/>%s'
                              '<translate x="%.4f" y="%.4f" z="%.4f"/></transform><ref id="group"/></shape>' % (
                                  size, self.turn(), radius * math.cos(angle),
                                  size * 1.2 + self.rng.uniform(0, 0.5), radius * math.sin(angle)))
            return shapes
        triangles = {"mesh-10k": 10_000, "mesh-60k": 60_000, "mesh-300k": 300_000, "mesh-1m": 1_000_000}[kind]
        file = self.body(triangles)
        size = self.rng.uniform(0.5, 0.7)
        return ['<shape type="ply"><string name="filename" value="%s"/><transform name="to_world">%s'
                '<scale value="%.4f"/><translate y="%.4f"/></transform>%s</shape>' % (
                    file, self.turn(), size, 1.25 * size, self.material())]

    def lights(self):
        kind = self.chosen["light"]
        if kind in ("sky", "sun"):
            file = self.asset("sky", ".hdr", lambda path: sky(path, self.rng, kind == "sun"))
            return ['<emitter type="envmap"><string name="filename" value="%s"/><float name="scale" value="1"/></emitter>' % file]
        lamps = []
        count = int(self.rng.integers(2, 5)) if kind == "lamps" else int(self.rng.integers(40, 120))
        for _ in range(count):
            angle, far, high = self.rng.uniform(0, 2 * math.pi), self.rng.uniform(1, 3), self.rng.uniform(1.2, 3)
            size = self.rng.uniform(0.2, 0.6) if kind == "lamps" else self.rng.uniform(0.02, 0.06)
            power = self.rng.uniform(4, 12) if kind == "lamps" else 10 ** self.rng.uniform(0.8, 2.2)
            place = (far * math.cos(angle), high, far * math.sin(angle))
            radiance = '<emitter type="area"><rgb name="radiance" value="%s"/></emitter>' % " ".join(
                "%.4f" % v for v in power * self.rng.uniform(0.5, 1, 3))
            if self.rng.random() < 0.5:
                lamps.append('<shape type="sphere"><point name="center" x="%.4f" y="%.4f" z="%.4f"/><float name="radius" value="%.4f"/>%s</shape>'
                             % (*place, size / 2, radiance))
            else:
                lamps.append('<shape type="rectangle"><transform name="to_world"><scale value="%.4f"/><lookat origin="%.4f, %.4f, %.4f" '
                             'target="0, 0.4, 0" up="0, 1, 0.01"/></transform>%s</shape>' % (size / 2, *place, radiance))
        if self.rng.random() < 0.5:
            lamps.append('<emitter type="constant"><rgb name="radiance" value="%.4f"/></emitter>' % self.rng.uniform(0.05, 0.3))
        return lamps

    def write(self):
        angle, high = self.rng.uniform(0, 2 * math.pi), self.rng.uniform(0.7, 2.0)
        origin = (3.6 * math.cos(angle), high, 3.6 * math.sin(angle))
        sensor = "perspective"
        lens = ""
        if self.chosen["lens"]:
            sensor = "thinlens"
            distance = math.dist(origin, (0, 0.55, 0))
            lens = ('<float name="aperture_radius" value="%.4f"/><float name="focus_distance" value="%.4f"/>'
                    % (self.rng.uniform(0.02, 0.08), distance * self.rng.uniform(0.85, 1.1)))
        floor = ('<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="6"/></transform>%s</shape>'
                 % (self.plastic(True) if self.rng.random() < 0.5 else self.diffuse(self.rng.random() < 0.7)))
        text = '\n'.join([
            '<scene version="3.0.0">',
            '<integrator type="path"><integer name="max_depth" value="%d"/></integrator>' % MAX_DEPTH,
            '<sensor type="%s"><float name="fov" value="%.3f"/><string name="fov_axis" value="x"/>%s' % (sensor, self.rng.uniform(30, 42), lens),
            '<transform name="to_world"><lookat origin="%.5f, %.5f, %.5f" target="0, 0.55, 0" up="0, 1, 0"/></transform>' % origin,
            '<sampler type="multijitter"><integer name="sample_count" value="64"/></sampler>',
            '<film type="hdrfilm"><integer name="width" value="%d"/><integer name="height" value="%d"/><string name="pixel_format" value="rgb"/>'
            '<string name="component_format" value="float32"/><rfilter type="box"/></film></sensor>' % SIZE,
            floor, *self.objects(), *self.lights(), '</scene>', ''])
        (self.folder / (self.name + ".xml")).write_text(text)
        return {"name": self.name, **self.chosen, **({"published": self.found} if self.found else {})}


def draw(seed, count, folder):
    """Writes scenes 1 to `count` of a seed; returns what each is."""
    os.makedirs(folder, exist_ok=True)
    return [Draw(seed, number, folder).write() for number in range(1, count + 1)]


if __name__ == "__main__":
    for about in draw(sys.argv[1], int(sys.argv[2]), sys.argv[3]):
        print(json.dumps(about))
