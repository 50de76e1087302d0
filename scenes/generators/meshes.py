"""Meshes for the scenes: bodies of revolution, extruded outlines and plates, written as binary PLY files. Plain standard library."""

import math
import struct


class Mesh:
    """Vertices (position, normal, texture coordinates) and triangles, counter-clockwise seen from outside."""

    def __init__(self):
        self.vertices, self.triangles = [], []

    def vertex(self, position, normal, uv=(0.0, 0.0)):
        self.vertices.append((*position, *normal, *uv))
        return len(self.vertices) - 1

    def face(self, corners, uvs=None):
        """A flat polygon, convex, with a normal of its own."""
        a, b, c = corners[0], corners[1], corners[2]
        normal = unit(cross(sub(b, a), sub(c, a)))
        first = [self.vertex(p, normal, uv) for p, uv in zip(corners, uvs or [(0.0, 0.0)] * len(corners))]
        self.triangles += [(first[0], first[i], first[i + 1]) for i in range(1, len(first) - 1)]

    def add(self, other, place=lambda p: p, turn=lambda n: n):
        """Another mesh: its points go through `place`, its normals through `turn`."""
        start = len(self.vertices)
        self.vertices += [(*place(v[:3]), *turn(v[3:6]), *v[6:]) for v in other.vertices]
        self.triangles += [tuple(start + i for i in triangle) for triangle in other.triangles]

    def weld(self):
        """Makes one of vertices that are the same."""
        kept = {}
        place = [kept.setdefault(tuple(round(x, 9) for x in vertex), len(kept)) for vertex in self.vertices]
        self.vertices = list(kept)
        self.triangles = [tuple(place[i] for i in triangle) for triangle in self.triangles]

    def write(self, path):
        self.weld()
        small = len(self.vertices) < 65536
        names = ("x", "y", "z", "nx", "ny", "nz", "u", "v")
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(self.vertices)}"]
        header += [f"property float {name}" for name in names]
        header += [f"element face {len(self.triangles)}", f"property list uchar {'ushort' if small else 'uint'} vertex_indices", "end_header", ""]
        with open(path, "wb") as out:
            out.write("\n".join(header).encode())
            out.write(b"".join(struct.pack("<8f", *v) for v in self.vertices))
            out.write(b"".join(struct.pack("<B3H" if small else "<B3I", 3, *t) for t in self.triangles))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def lathe(profile, segments=96, smooth_deg=0.0):
    """A body of revolution around y of an outline of (radius, height), from the bottom up outside and down inside. Edges of the outline
    that meet at no more than `smooth_deg` look round; others keep their edge. u runs around, v along the outline, so that a tangent
    follows the turning."""
    mesh = Mesh()

    def normal_of(edge):
        (r0, y0), (r1, y1) = edge
        length = math.hypot(r1 - r0, y1 - y0)
        return ((y1 - y0) / length, -(r1 - r0) / length)

    edges = [edge for edge in zip(profile, profile[1:]) if edge[0] != edge[1] and (edge[0][0] > 0 or edge[1][0] > 0)]
    normals = [normal_of(edge) for edge in edges]

    def at_corner(own, other):
        """The normal where an edge meets the next or the one before."""
        if own[0] * other[0] + own[1] * other[1] < math.cos(math.radians(smooth_deg)) - 1e-9:
            return own
        return unit((own[0] + other[0], own[1] + other[1]))

    for k, ((r0, y0), (r1, y1)) in enumerate(edges):
        begins = at_corner(normals[k], normals[k - 1]) if k > 0 and edges[k - 1][1] == edges[k][0] else normals[k]
        ends = at_corner(normals[k], normals[k + 1]) if k + 1 < len(edges) and edges[k + 1][0] == edges[k][1] else normals[k]
        ring = []
        for j in range(segments + 1):
            angle = 2 * math.pi * j / segments
            c, s = math.cos(angle), -math.sin(angle)
            low = mesh.vertex((r0 * c, y0, r0 * s), (begins[0] * c, begins[1], begins[0] * s), (j / segments, k / len(edges)))
            high = mesh.vertex((r1 * c, y1, r1 * s), (ends[0] * c, ends[1], ends[0] * s), (j / segments, (k + 1) / len(edges)))
            ring.append((low, high))
        for (a, b), (c, d) in zip(ring, ring[1:]):
            mesh.triangles += ([(a, c, d)] if r0 > 0 else []) + ([(a, d, b)] if r1 > 0 else [])
            if r0 == 0:
                mesh.triangles.append((a, d, b))
            if r1 == 0:
                mesh.triangles.append((a, c, d))
    mesh.triangles = list(dict.fromkeys(mesh.triangles))
    return mesh


def extrude(outline, low, high, holes=(), bevel=0.0):
    """A plate of an outline of (x, z), counter-clockwise seen from above, from height `low` to `high`, with round-cornered edges if
    there is a bevel. A hole is an outline around the same centre with as many points as the outline."""
    mesh = Mesh()
    count = len(outline)
    hole = holes[0] if holes else None
    inset = shrink(outline, bevel) if bevel else outline

    def wall(a, b, ya, yb, flip=False):
        for i in range(count):
            k = (i + 1) % count
            corners = [(a[i][0], ya, -a[i][1]), (a[k][0], ya, -a[k][1]), (b[k][0], yb, -b[k][1]), (b[i][0], yb, -b[i][1])]
            mesh.face(corners[::-1] if flip else corners)

    top = high - bevel
    wall(outline, outline, low, top)
    if bevel:
        wall(outline, inset, top, high)
    if hole:
        wall(hole, hole, low, high, flip=True)
        wall(inset, hole, high, high)
        wall(hole, outline, low, low)
    else:
        centre = tuple(sum(p[k] for p in outline) / count for k in range(2))
        for i in range(count):
            k = (i + 1) % count
            mesh.face([(centre[0], high, -centre[1]), (inset[i][0], high, -inset[i][1]), (inset[k][0], high, -inset[k][1])])
            mesh.face([(centre[0], low, -centre[1]), (outline[k][0], low, -outline[k][1]), (outline[i][0], low, -outline[i][1])])
    return mesh


def shrink(outline, by):
    """The outline moved inward along the mean of the normals at each corner."""
    count, moved = len(outline), []
    for i, (x, z) in enumerate(outline):
        (ax, az), (bx, bz) = outline[i - 1], outline[(i + 1) % count]
        first, second = unit((z - az, ax - x)), unit((bz - z, x - bx))
        half = unit((first[0] + second[0], first[1] + second[1]))
        scale = by / max(0.3, half[0] * first[0] + half[1] * first[1])
        moved.append((x - half[0] * scale, z - half[1] * scale))
    return moved


def circle(radius, count, centre=(0.0, 0.0), start=0.0):
    turn = [start + 2 * math.pi * i / count for i in range(count)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in turn]


def gear(teeth, module, per_tooth=8):
    """The outline of a gear with rounded teeth of this module (pitch diameter over the number of teeth)."""
    pitch, points = teeth * module / 2, []
    for i in range(teeth * per_tooth):
        phase = 2 * math.pi * (i + 0.5) / per_tooth
        wave = math.cos(phase)
        reach = math.copysign(min(1.0, abs(wave) * 1.6), wave)
        radius = pitch + module * (0.95 * reach if reach > 0 else 1.1 * reach)
        angle = 2 * math.pi * (i + 0.5) / (teeth * per_tooth)
        points.append((radius * math.cos(angle), radius * math.sin(angle)))
    return points
