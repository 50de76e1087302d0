"""Writes scenes/diamonds.json: cut diamonds on black glass, under many soft lamps in a dark room.

Each stone is the body that its facets' planes bound. Plain standard library.
"""

import math

import scene_text
from brilliant import brilliant, cross, dot, triangles_of

EYE = [0.0, 0.045, 0.073]
GAP = 4e-6  # between a stone and the ground, m: surfaces that coincide would have no order


def solid(planes):
    """(vertices, loops) of the convex body within planes (unit normal, offset): each plane's polygon, cut by all others."""
    size = 10 * max(abs(offset) for _, offset in planes)
    vertices, loops = [], []

    def number(point):
        for i, other in enumerate(vertices):
            if math.dist(point, other) < 1e-9:
                return i
        vertices.append(point)
        return len(vertices) - 1

    for normal, offset in planes:
        helper = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.6 else (0.0, 1.0, 0.0)
        u = cross(normal, helper)
        length = math.sqrt(dot(u, u))
        u = tuple(x / length for x in u)
        v = cross(normal, u)
        polygon = [tuple(offset * n + size * (a * x + b * y) for n, x, y in zip(normal, u, v)) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        for other, limit in planes:
            if other == normal and limit == offset:
                continue
            cut = []
            for p, q in zip(polygon, polygon[1:] + polygon[:1]):
                a, b = dot(other, p) - limit, dot(other, q) - limit
                if a <= 0:
                    cut.append(p)
                if a * b < 0:
                    cut.append(tuple(x + (y - x) * a / (a - b) for x, y in zip(p, q)))
            polygon = cut
        loop = []
        for p in polygon:
            i = number(p)
            if i not in loop:
                loop.append(i)
        if len(loop) > 2:
            loops.append(loop)
    return vertices, loops


def slanted(azimuth, elevation_deg, through):
    """The plane through a point (distance from the axis along the azimuth, height), whose normal has this elevation."""
    e = math.radians(elevation_deg)
    normal = (math.cos(e) * math.cos(azimuth), math.sin(e), -math.cos(e) * math.sin(azimuth))
    return normal, math.cos(e) * through[0] + math.sin(e) * through[1]


def step_cut(length, width, corner=0.17):
    """An emerald cut: an octagon with three steps above the girdle and three below. Lengths in m."""
    planes = [((0.0, 1.0, 0.0), 0.165 * width)]
    girdle = 0.02 * width
    cut = corner * width
    for k in range(8):
        azimuth = k * math.pi / 4
        if k % 2:
            reach = (length / 2 + width / 2 - cut) / math.sqrt(2)
        else:
            reach = (length if k % 4 == 0 else width) / 2
        planes.append(slanted(azimuth, 0.0, (reach, 0.0)))
        r, y = reach, girdle
        for angle, inward in ((45.0, 0.055), (37.0, 0.075), (26.0, 0.09)):
            planes.append(slanted(azimuth, 90 - angle, (r, y)))
            r, y = r - inward * width, y + inward * width * math.tan(math.radians(angle))
        r, y = reach, -girdle
        for angle, inward in ((55.0, 0.10), (46.0, 0.17), (38.0, 0.3)):
            planes.append(slanted(azimuth, angle - 90, (r, y)))
            r, y = r - inward * width, y - inward * width * math.tan(math.radians(angle))
    return solid(planes)


def round_cut(diameter, stretch=1.0):
    """A round brilliant; stretched along x it is an oval one."""
    vertices, facets = brilliant(diameter, table=0.56, lower_half=0.78)
    return [(x * stretch, y, z) for x, y, z in vertices], [loop for _, loop in facets]


def triangles(loops):
    return [list(t) for t in triangles_of([(None, loop) for loop in loops])]


def rotation(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    x, y, z = axis
    return lambda p: tuple(
        c * a + s * b + (1 - c) * dot(axis, p) * n
        for a, b, n in zip(p, cross(axis, p), axis))


def placed(name, cut, at, lean_deg, lean_toward_deg, spin_deg=0.0):
    """A stone whose table leans by an angle toward an azimuth (0 toward the viewer, 90 to the right). It touches the ground."""
    vertices, loops = cut
    spin = rotation((0.0, 1.0, 0.0), spin_deg)
    a = math.radians(lean_toward_deg)
    lean = rotation((math.cos(a), 0.0, -math.sin(a)), lean_deg)
    points = [lean(spin(p)) for p in vertices]
    lowest = min(p[1] for p in points)
    points = [[round(x + at[0], 9), round(y - lowest + GAP, 9), round(z + at[1], 9)] for x, y, z in points]
    return {"name": name, "material": "diamond", "shape": {"type": "mesh", "vertices_m": points, "triangles": triangles(loops)}}


def resting(cut, spin_deg):
    """The lean at which a stone with this spin lies on girdle and culet, toward the viewer."""
    spin = rotation((0.0, 1.0, 0.0), spin_deg)
    points = [spin(p) for p in cut[0]]
    culet = min(points, key=lambda p: p[1])
    return min(math.degrees(math.atan2(p[1] - culet[1], p[2] - culet[2])) for p in points if p[2] > culet[2] + 1e-6)


def lamp(name, azimuth_deg, elevation_deg, half_angle_deg, light):
    """A disk, 0.4 m away, that faces the stones; azimuth 0 is toward the viewer, 90 to the right."""
    a, e, far = math.radians(azimuth_deg), math.radians(elevation_deg), 0.4
    toward = (math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e))
    return {
        "name": name, "material": "black",
        "shape": {"type": "disk", "center_m": [round(far * x, 6) for x in toward], "normal": [round(-x, 6) for x in toward],
                  "radius_m": round(far * math.tan(math.radians(half_angle_deg)), 6)},
        "emission": {"radiance": light},
    }


def mirrored(stone):
    """The direction that the camera sees mirrored in the stone's table."""
    shape = stone["shape"]
    corner = lambda i: shape["vertices_m"][i]
    sides = [[[q - p for p, q in zip(corner(a), corner(b))] for b in (b, c)] for a, b, c in shape["triangles"]]
    normal = max((cross(u, v) for u, v in sides), key=lambda n: dot(n, n))
    length = math.sqrt(dot(normal, normal))
    normal = [x / length for x in normal]
    centre = [sum(p[k] for p in shape["vertices_m"]) / len(shape["vertices_m"]) for k in range(3)]
    view = [e - c for e, c in zip(EYE, centre)]
    length = math.sqrt(dot(view, view))
    view = [x / length for x in view]
    return [2 * dot(view, normal) * n - v for n, v in zip(normal, view)]


def panel(name, azimuth_deg, low_deg, high_deg, width_m, light):
    """A strip, 0.4 m away, that faces the stones from one elevation to another."""
    a, far = math.radians(azimuth_deg), 0.4
    point = lambda e: [far * math.sin(a) * math.cos(e), far * math.sin(e), far * math.cos(a) * math.cos(e)]
    low, high = point(math.radians(low_deg)), point(math.radians(high_deg))
    across = (math.cos(a), 0.0, -math.sin(a))
    return {
        "name": name, "material": "black",
        "shape": {"type": "parallelogram", "origin_m": [round(p + c * width_m / 2, 6) for p, c in zip(low, across)],
                  "u_m": [round(-c * width_m, 6) for c in across], "v_m": [round(q - p, 6) for p, q in zip(low, high)]},
        "emission": {"radiance": light},
    }


def studio(avoid):
    """Strips around the stones: wide ones for brilliance, and rows of narrow ones, whose edges make fire. Round lamps above, none where
    a table would mirror it."""
    lamps = [panel("glow behind", 180, 14, 46, 0.5, {"type": "gradient", "from": [0.8, 1.0, 1.4], "to": [0.0, 0.0, 0.0], "along": "v"})]
    for k in range(10):
        azimuth = 18 + 36 * k
        if abs((azimuth + 180) % 360 - 180) > 150:
            continue
        if k % 2:
            for part in range(3):
                lamps.append(panel(f"strip {k + 1}.{part + 1}", azimuth + 7.5 * (part - 1), 14, 56, 0.02, "bright"))
        else:
            lamps.append(panel(f"strip {k + 1}", azimuth, 16, 52, 0.09, "warm" if k % 4 else "cool"))
    for row, (elevation, count, half, first) in enumerate(((67, 8, 5.0, 0), (86, 1, 5.0, 0))):
        for k in range(count):
            azimuth = first + 360 / count * k
            a, e = math.radians(azimuth), math.radians(elevation)
            toward = (math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e))
            if any(dot(toward, other) > math.cos(math.radians(half + 4)) for other in avoid):
                continue
            lamps.append(lamp(f"lamp {row + 1}.{k + 1}", azimuth, elevation, half, "bright"))
    return lamps


if __name__ == "__main__":
    oval, emerald, big = round_cut(4.9e-3, 1.34), step_cut(7.2e-3, 5.3e-3), round_cut(6.5e-3)
    small, tiny = round_cut(2.5e-3), round_cut(1.5e-3)

    def lying(name, cut, at, toward, spin=0.0, more=0.0):
        return placed(name, cut, at, resting(cut, spin) + more, toward, spin)

    stones = [
        lying("brilliant", big, (-0.0014, 0.0012), 6),
        lying("emerald cut", emerald, (0.0064, -0.0042), -24),
        lying("oval", oval, (-0.0082, -0.0052), 34),
        lying("small 1", small, (0.0047, 0.0040), -30, 10),
        lying("small 2", small, (-0.0076, 0.0032), 40, 5),
        lying("small 3", small, (0.0004, -0.0132), 14),
        lying("tiny 1", tiny, (0.0028, 0.0066), 30),
        lying("tiny 2", tiny, (0.0092, 0.0028), -50, 8),
        lying("tiny 3", tiny, (-0.0045, 0.0066), 20, 3),
        lying("tiny 4", tiny, (-0.0110, 0.0006), 0, 12),
        lying("tiny 5", tiny, (0.0118, -0.0062), -10),
    ]
    scene_text.write("diamonds", {
        "etalon": 1,
        "comment": [
            "Cut diamonds on black glass: a round brilliant, an emerald cut, an oval and small brilliants, under many soft lamps in a dark room.",
            "Look at: fire, the pure colours where the edges of lamps are seen through facets; brilliance, the white light that the",
            "back of a stone returns; the long steps of the emerald cut, which flash as a whole; each stone's image in the ground.",
            "The formula for diamond's index is known to 760 nm, so only 360 to 760 nm are rendered: beyond, the observer is all but blind.",
            "Written by scenes/generators/diamonds.py.",
        ],
        "camera": {
            "type": "perspective", "position_m": EYE, "look_at_m": [0, 0.0008, -0.0008], "horizontal_fov_deg": 16.5,
            "lens": {"radius_m": 0.001, "focus_distance_m": 0.0835},
        },
        "film": {"width": 480, "height": 320, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "integrator": {"spp": 256, "wavelength_range_nm": [360, 760]},
        "spectra": {
            "cool": {"type": "illuminant", "name": "D65", "scale": 3},
            "warm": {"type": "blackbody", "temperature_k": 4300, "scale": 0.00028},
            "bright": {"type": "illuminant", "name": "D65", "scale": 6},
        },
        "materials": {
            "diamond": {"type": "dielectric", "interior": "diamond"},
            "black glass": {"type": "plastic", "reflectance": 0.003},
            "black": {"type": "black"},
        },
        "objects": [
            {"name": "ground", "shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 1}, "material": "black glass"},
            *stones, *studio([mirrored(stone) for stone in stones[:3]]),
        ],
        "lights": [{"type": "environment", "name": "room", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.04}}],
    })
