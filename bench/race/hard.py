"""Seven scenes in which glass stands between most of the light and the eye or the floor, as files of Mitsuba 3.

    python3 hard.py DIR       # writes DIR/hard-….xml and what they refer to

A tumbler of water under a sky with a sun, a prism before a strip lamp, a prism in a beam, five brilliants, a room behind a pane, a pool, a lamp in a
bulb. Glass has one index, since Mitsuba cannot part wavelengths. Needs numpy.
"""
import math
import os
import pathlib
import sys

import numpy as np

from draw import MAX_DEPTH, SIZE, picture, ply, sky

NAMES = ["tumbler", "prism", "beam", "brilliants", "room", "pool", "bulb"]
# A prism whose cross-section is an equilateral triangle of side 1, over z from −0.5 to 0.5.
PRISM_CORNERS = [(-0.5, 0, -0.5), (0.5, 0, -0.5), (0, 0.87, -0.5), (-0.5, 0, 0.5), (0.5, 0, 0.5), (0, 0.87, 0.5)]
PRISM_FACES = [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)]


def mesh(path, corners, faces, smooth=None):
    """Writes a mesh; `smooth` are the normals of its corners, else each face has its own."""
    p, faces = np.asarray(corners, float), np.asarray(faces)
    if smooth is None:
        p = p[faces].reshape(-1, 3)
        faces = np.arange(len(p)).reshape(-1, 3)
        n = np.cross(p[1::3] - p[::3], p[2::3] - p[::3])
        smooth = np.repeat(n / np.linalg.norm(n, axis=1, keepdims=True), 3, axis=0)
    ply(path, p, np.asarray(smooth, float), np.zeros((len(p), 2)), faces)


def turned(path, profile, around=64):
    """A surface of revolution about the y axis. Its normals point to the left of the profile (radius, height) as it goes on."""
    profile = np.asarray(profile, float)
    steps = np.diff(profile, axis=0)
    corners, normals, faces = [], [], []
    angles = np.arange(around) * 2 * math.pi / around
    for (r0, y0), (r1, y1), (dr, dy) in zip(profile, profile[1:], steps):
        out = np.array([dy, -dr]) / math.hypot(dr, dy)
        first = len(corners)
        for r, y in ((r0, y0), (r1, y1)):
            for a in angles:
                corners.append((r * math.cos(a), y, r * math.sin(a)))
                normals.append((out[0] * math.cos(a), out[1], out[0] * math.sin(a)))
        for k in range(around):
            a, b = first + k, first + (k + 1) % around
            c, d = a + around, b + around
            faces += [f for f in ((a, c, b), (b, c, d)) if len({tuple(np.round(corners[i], 12)) for i in f}) == 3]
    mesh(path, corners, faces, normals)


def glass(inside, outside=1.0):
    return '<bsdf type="dielectric"><float name="int_ior" value="%g"/><float name="ext_ior" value="%g"/></bsdf>' % (inside, outside)


def shape(file, bsdf, place=""):
    return '<shape type="ply"><string name="filename" value="%s"/><transform name="to_world">%s</transform>%s</shape>' % (file, place, bsdf)


def diffuse(value):
    return '<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="%s"/></bsdf></bsdf>' % value


def rectangle(place, inside):
    return '<shape type="rectangle"><transform name="to_world">%s</transform>%s</shape>' % (place, inside)


def area(value):
    return '<emitter type="area"><rgb name="radiance" value="%s"/></emitter>' % value


class Hard:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.rng = np.random.default_rng(20261128)

    def file(self, name, make):
        make(self.folder / name)
        return name

    def sky(self, name, sun):
        file = self.file("hard-%s.hdr" % name, lambda path: sky(path, self.rng, sun))
        return '<emitter type="envmap"><string name="filename" value="%s"/></emitter>' % file

    def floor(self, name, size=6):
        file = self.file("hard-%s.png" % name, lambda path: picture(path, self.rng))
        texture = '<bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="%s"/></texture></bsdf>' % file
        return rectangle('<rotate x="1" angle="-90"/><scale value="%g"/>' % size, '<bsdf type="twosided">%s</bsdf>' % texture)

    def write(self, name, origin, target, fov, parts):
        text = "\n".join([
            '<scene version="3.0.0">', '<integrator type="path"><integer name="max_depth" value="%d"/></integrator>' % MAX_DEPTH,
            '<sensor type="perspective"><float name="fov" value="%g"/><string name="fov_axis" value="x"/>' % fov,
            '<transform name="to_world"><lookat origin="%s" target="%s" up="0, 1, 0"/></transform>' % (origin, target),
            '<sampler type="multijitter"><integer name="sample_count" value="64"/></sampler>',
            '<film type="hdrfilm"><integer name="width" value="%d"/><integer name="height" value="%d"/><string name="pixel_format" value="rgb"/>'
            '<string name="component_format" value="float32"/><rfilter type="box"/></film></sensor>' % SIZE, *parts, '</scene>', ''])
        (self.folder / ("hard-%s.xml" % name)).write_text(text)

    def tumbler(self):
        """Glass outside, glass to water, glass to air above the water, the water's surface: each surface states both its sides."""
        level, rim, outer, inner, bottom = 0.75, 1.0, 0.36, 0.33, 0.06
        out = self.file("hard-glass.ply", lambda p: turned(p, [(0, 0.001), (outer, 0.001), (outer, rim), (inner, rim)]))
        dry = self.file("hard-dry.ply", lambda p: turned(p, [(inner, rim), (inner, level)]))
        wet = self.file("hard-wet.ply", lambda p: turned(p, [(inner, level), (inner, bottom), (0, bottom)]))
        top = self.file("hard-level.ply", lambda p: turned(p, [(inner, level), (0, level)]))
        self.write("tumbler", "0, 1.6, 3.4", "0, 0.45, 0", 32, [
            self.floor("wood"), shape(out, glass(1.5)), shape(dry, glass(1.5)), shape(wet, glass(1.5, 1.33)), shape(top, glass(1.33)),
            self.sky("tumbler", True)])

    def prism(self):
        body = self.file("hard-prism.ply", lambda p: mesh(p, PRISM_CORNERS, PRISM_FACES))
        self.write("prism", "1.5, 2.2, 4", "0.6, 0.3, 0", 42, [
            self.floor("paper"), rectangle('<scale value="4"/><translate z="-2"/>', diffuse("0.7 0.7 0.7")),
            shape(body, glass(1.6), '<translate y="0.02"/>'),
            rectangle('<scale x="0.02" y="0.4"/><rotate y="1" angle="90"/><translate x="-2" y="0.9"/>', area("120 110 90"))])

    def beam(self):
        """A lamp of 9 cm, 9 m before a slit of 4 cm × 40 cm in a black wall: a beam of 0.6° falls on a prism, and a spot of it on the floor."""
        body = self.file("hard-beam.ply", lambda p: mesh(p, PRISM_CORNERS, PRISM_FACES))
        low, high, side = 1.18, 1.22, 0.2
        def board(y0, y1, z0, z1):
            place = '<scale x="%g" y="%g"/><rotate y="1" angle="90"/><translate x="-1" y="%g" z="%g"/>' % (
                (z1 - z0) / 2, (y1 - y0) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
            return rectangle(place, diffuse("0 0 0"))
        self.write("beam", "3.4, 2.6, 3.6", "0.7, 0.5, 0", 42, [
            self.floor("sheet"), rectangle('<scale value="4"/><translate z="-2"/>', diffuse("0.7 0.7 0.7")),
            board(0, low, -4, 4), board(high, 6, -4, 4), board(low, high, -4, -side), board(low, high, side, 4),
            # Turned by half the deviation of 46.3°: within the prism the beam goes along its base.
            shape(body, glass(1.6), '<translate y="-0.435"/><rotate z="1" angle="-23.13"/><translate y="1.2"/>'),
            rectangle('<scale value="0.045"/><rotate y="1" angle="90"/><translate x="-10" y="1.2"/>', area("40000 38000 34000")),
            '<emitter type="constant"><rgb name="radiance" value="0.05"/></emitter>'])

    def brilliants(self):
        def brilliant(path):
            around = np.arange(8) * math.pi / 4
            ring = lambda r, y, turn: [(r * math.cos(a + turn), y, r * math.sin(a + turn)) for a in around]
            table, girdle = ring(0.55, 0.35, math.pi / 8), ring(1, 0, 0)
            corners = table + girdle + [(0, 0.35, 0), (0, -0.86, 0)]
            faces = []
            for k in range(8):
                n, t, g = (k + 1) % 8, k, 8 + k
                faces += [(16, n, t), (t, 8 + n, g), (t, n, 8 + n), (17, g, 8 + n)]
            mesh(path, corners, faces)
        stone = self.file("hard-brilliant.ply", brilliant)
        places = [(0, 0, 0), (0.9, 0.1, 60), (-0.85, 0.3, 130), (0.35, -0.8, 200), (-0.4, -0.75, 310)]
        self.write("brilliants", "0, 1.5, 3.2", "0, 0.15, 0", 34, [
            self.floor("cloth"), self.sky("brilliants", False),
            *[shape(stone, glass(2.42), '<scale value="0.3"/><rotate z="1" angle="52"/><rotate y="1" angle="%g"/><translate x="%g" y="0.26" z="%g"/>'
                    % (turn, x, z)) for x, z, turn in places]])

    def room(self):
        """A room of 4 × 2.6 × 4 m. Its window, 1.6 × 1.2 m in the left wall, has a pane."""
        wall = diffuse("0.7 0.68 0.62")
        low, high, near, far = 0.7, 1.9, 0.8, -0.8
        corners = [(-2, y, z) for y in (0, low, high, 2.6) for z in (2, near, far, -2)]
        cells = [(r, c) for r in range(3) for c in range(3) if (r, c) != (1, 1)]
        faces = [f for r, c in cells for f in ((4 * r + c, 4 * r + c + 4, 4 * r + c + 1), (4 * r + c + 1, 4 * r + c + 4, 4 * r + c + 5))]
        with_window = self.file("hard-wall.ply", lambda p: mesh(p, corners, faces))
        pane = '<bsdf type="thindielectric"><float name="int_ior" value="1.5"/></bsdf>'
        self.write("room", "1.8, 1.4, 1.8", "-1, 0.9, -1", 62, [
            self.floor("boards", 2), rectangle('<rotate x="1" angle="90"/><scale value="2"/><translate y="2.6"/>', wall),
            rectangle('<scale x="2" y="1.3"/><translate y="1.3" z="-2"/>', diffuse("0.3 0.4 0.6")),
            rectangle('<scale x="2" y="1.3"/><rotate y="1" angle="180"/><translate y="1.3" z="2"/>', wall),
            rectangle('<scale x="2" y="1.3"/><rotate y="1" angle="-90"/><translate x="2" y="1.3"/>', wall),
            shape(with_window, '<bsdf type="twosided">%s</bsdf>' % wall[len('<bsdf type="twosided">'):-len('</bsdf>')]),
            rectangle('<scale x="0.8" y="0.6"/><rotate y="1" angle="90"/><translate x="-2.02" y="1.3"/>', pane),
            '<shape type="sphere"><point name="center" x="-0.6" y="0.4" z="-0.5"/><float name="radius" value="0.4"/>%s</shape>' % diffuse("0.6 0.2 0.1"),
            self.sky("room", True)])

    def pool(self):
        def waves(path, n=160):
            g = np.linspace(-2, 2, n)
            x, z = np.meshgrid(g, g, indexing="ij")
            y = 1 + 0.02 * np.sin(5 * x + 1.3 * z) + 0.015 * np.sin(7.7 * z - 2 * x + 1) + 0.01 * np.sin(11 * x + 9 * z)
            dx, dz = np.gradient(y, g, g)
            n3 = np.stack([-dx, np.ones_like(dx), -dz], -1)
            i, j = (k.ravel() for k in np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"))
            a = i * n + j
            mesh(path, np.stack([x, y, z], -1).reshape(-1, 3), np.concatenate([np.stack([a, a + 1, a + n], -1), np.stack([a + 1, a + n + 1, a + n], -1)]),
                 (n3 / np.linalg.norm(n3, axis=-1, keepdims=True)).reshape(-1, 3))
        surface = self.file("hard-waves.ply", waves)
        side = lambda turn: rectangle('<scale x="2" y="0.6"/><translate z="-2"/><rotate y="1" angle="%d"/><translate y="0.6"/>' % turn, diffuse("0.5 0.65 0.7"))
        self.write("pool", "0, 3.2, 4.2", "0, 0.4, 0", 44, [
            self.floor("tiles", 2), side(0), side(90), side(180), side(270), shape(surface, glass(1.33)), self.sky("pool", True)])

    def bulb(self):
        ball = lambda r, inside: '<shape type="sphere"><point name="center" x="0" y="1.5" z="0"/><float name="radius" value="%g"/>%s</shape>' % (r, inside)
        self.write("bulb", "0, 1.3, 4.2", "0, 0.9, 0", 44, [
            self.floor("rug"), rectangle('<scale value="4"/><translate z="-2"/>', diffuse("0.6 0.6 0.5")),
            '<shape type="sphere"><point name="center" x="0.8" y="0.4" z="0.3"/><float name="radius" value="0.4"/>%s</shape>' % diffuse("0.2 0.4 0.6"),
            ball(0.25, glass(1.5)), ball(0.235, glass(1.0, 1.5)), ball(0.04, area("60 50 40"))])


def write(folder):
    """Writes all scenes; returns their names."""
    os.makedirs(folder, exist_ok=True)
    hard = Hard(folder)
    for name in NAMES:
        getattr(hard, name)()
    return ["hard-" + name for name in NAMES]


if __name__ == "__main__":
    print("\n".join(write(sys.argv[1])))
