"""The five scenes of the race, described for every renderer alike, and their meshes.

As files in the format of etalon: python3 peer_etalon.py DIR

Conventions
-----------
* right-handed world, y up, arbitrary units; every peer gets the same coordinates
* `fov_x` is the full horizontal field of view in degrees; pixel filter is a 1-pixel box
* `max_depth` counts path edges as Mitsuba does: 1 = directly visible emission only,
  2 = + single scattering.  Runners convert to the peer's own convention.
* colours: {"spd": "<curve name>", "rgb": [r,g,b]}.  The RGB triple is the curve integrated
  under D65 (reflectances) or as is (emission) with CIE 1931 and the sRGB primaries.
  An emission or environment given as {"d65": L} has linear sRGB = (L, L, L) and a D65
  spectral shape.
* curves are defined by formula in CURVES below (my own smooth curves, "spectral-ish",
  not measurements); the Cornell light is the published 400/500/600/700 nm table.
"""
import math
import os

import numpy as np

CACHE = os.environ.get("RACE_CACHE", os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../out/race/meshes"))


# ---------------------------------------------------------------- colour data
def _sig(x):
    return 1.0 / (1.0 + math.exp(-x))


CURVES = {
    "white": lambda l: 0.75 - 0.42 * _sig((415 - l) / 9),
    "red": lambda l: 0.045 + 0.60 * _sig((l - 605) / 11),
    "green": lambda l: 0.10 + 0.36 * math.exp(-(((l - 535) / 60) ** 2)),
    "blue": lambda l: 0.06 + 0.55 * math.exp(-(((l - 455) / 45) ** 2)),
    "orange": lambda l: 0.06 + 0.62 * _sig((l - 570) / 22),
    "grey": lambda l: 0.5,
    "mirror": lambda l: 0.9,
    "cornell_light": lambda l: float(np.interp(l, [400, 500, 600, 700], [0, 8, 15.6, 18.4], left=0, right=0)),
}
RGB = {
    "white": [0.74552, 0.75420, 0.71751],
    "red": [0.49116, 0.03758, 0.03694],
    "green": [0.10787, 0.43246, 0.15077],
    "blue": [0.02278, 0.08729, 0.57046],
    "orange": [0.73347, 0.21206, 0.03480],
    "grey": [0.5, 0.5, 0.5],
    "mirror": [0.9, 0.9, 0.9],
    "cornell_light": [20.73482, 10.86518, 2.77389],
}


def color(name):
    return {"spd": name, "rgb": list(RGB[name])}


def d65(level):
    return {"d65": level, "rgb": [level] * 3}


def table(name, step=10):
    """Tabulated curve over 360-830 nm as (wavelength, value) pairs."""
    if name == "cornell_light":
        return [(400, 0.0), (500, 8.0), (600, 15.6), (700, 18.4)]
    return [(l, CURVES[name](l)) for l in range(360, 831, step)]


# N-SF11: Cauchy fit n = A + B / lambda_um^2 through n_F - n_C and n_d of the Sellmeier formula
SF11 = {"A": 1.7383682, "B": 0.0160019, "nd": 1.7847202}


# ------------------------------------------------------------------- meshes
def write_ply(path, v, f, n=None):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    v = np.asarray(v, "<f4")
    f = np.asarray(f, "<i4")
    props = "property float x\nproperty float y\nproperty float z\n"
    data = v
    if n is not None:
        props += "property float nx\nproperty float ny\nproperty float nz\n"
        data = np.hstack([v, np.asarray(n, "<f4")])
    rec = np.empty(len(f), dtype=[("c", "u1"), ("i", "<i4", 3)])
    rec["c"] = 3
    rec["i"] = f
    with open(path + ".tmp", "wb") as o:
        o.write((
            "ply\nformat binary_little_endian 1.0\nelement vertex %d\n%selement face %d\n"
            "property list uchar int vertex_indices\nend_header\n" % (len(v), props, len(f))
        ).encode())
        o.write(np.ascontiguousarray(data, "<f4").tobytes())
        o.write(rec.tobytes())
    os.replace(path + ".tmp", path)


def read_ply(path):
    """Reads back only what write_ply wrote."""
    with open(path, "rb") as s:
        raw = s.read()
    end = raw.index(b"end_header\n") + 11
    head = raw[:end].decode().split("\n")
    nv = int([h for h in head if h.startswith("element vertex")][0].split()[-1])
    nf = int([h for h in head if h.startswith("element face")][0].split()[-1])
    k = 6 if "property float nx" in head else 3
    v = np.frombuffer(raw, "<f4", nv * k, end).reshape(nv, k)
    f = np.frombuffer(raw, np.dtype([("c", "u1"), ("i", "<i4", 3)]), nf, end + nv * k * 4)["i"]
    return v[:, :3], f, (v[:, 3:] if k == 6 else None)


def quads_to_mesh(quads):
    v, f = [], []
    for q in quads:
        b = len(v)
        v += [tuple(p) for p in q]
        f += [(b, b + 1, b + 2), (b, b + 2, b + 3)]
    return np.array(v, float), np.array(f)


def uv_sphere(center, radius, nu=256, nv=128):
    """Closed UV sphere, outward winding, smooth normals."""
    th = np.linspace(0, np.pi, nv + 1)[1:-1]
    ph = np.arange(nu) * (2 * np.pi / nu)
    st, ct = np.sin(th)[:, None], np.cos(th)[:, None]
    ring = np.stack([st * np.cos(ph), ct * np.ones_like(ph), st * np.sin(ph)], -1).reshape(-1, 3)
    n = np.vstack([ring, [[0, 1, 0]], [[0, -1, 0]]])
    top, bot = len(ring), len(ring) + 1
    i = np.arange(nu)
    j = (i + 1) % nu
    f = [np.stack([np.full(nu, top), j, i], 1)]
    for r in range(nv - 2):
        a, b = r * nu + i, r * nu + j
        c, d = a + nu, b + nu
        f += [np.stack([a, b, c], 1), np.stack([b, d, c], 1)]
    a, b = (nv - 2) * nu + i, (nv - 2) * nu + j
    f.append(np.stack([a, b, np.full(nu, bot)], 1))
    return np.asarray(center) + radius * n, np.vstack(f), n


def _value_noise(x, y, seed):
    rng = np.random.RandomState(seed)
    lat = rng.rand(512, 512)
    xi, yi = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = x - xi, y - yi
    fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
    g = lambda a, b: lat[a % 512, b % 512]
    return ((g(xi, yi) * (1 - fx) + g(xi + 1, yi) * fx) * (1 - fy)
            + (g(xi, yi + 1) * (1 - fx) + g(xi + 1, yi + 1) * fx) * fy)


def terrain(nx=1000, nz=500, sx=12.0, sz=12.0):
    """Fractal terrain with exactly 2*nx*nz triangles (1,000,000 by default)."""
    x = np.linspace(-sx / 2, sx / 2, nx + 1)
    z = np.linspace(-sz / 2, sz / 2, nz + 1)
    X, Z = np.meshgrid(x, z)
    h = np.zeros_like(X)
    amp, frq = 1.0, 0.45
    for o in range(8):
        n = _value_noise(X * frq + 31.7 * o + 50, Z * frq + 17.3 * o + 50, 7 + o)
        h += amp * (1 - 2 * np.abs(n - 0.5))
        amp *= 0.5
        frq *= 2.03
    h = 1.5 * (h - 1.0)
    v = np.stack([X, h, Z], -1).reshape(-1, 3)
    a = (np.arange(nz)[:, None] * (nx + 1) + np.arange(nx)[None]).ravel()
    b, c, d = a + 1, a + nx + 1, a + nx + 2
    f = np.vstack([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])
    return v, f


# ------------------------------------------------------------- scene parts
def _mesh(name, maker):
    """A mesh shape; the PLY is generated on first use."""
    path = os.path.join(CACHE, name + ".ply")
    if not os.path.exists(path):
        r = maker()
        write_ply(path, *r)
    return name + ".ply"


def mesh_path(fname):
    return os.path.join(CACHE, fname)


def sphere_ply(center, radius, nu=256, nv=128, match_area=False):
    """Triangle mesh stand-in for peers without an analytic sphere.

    match_area scales the polyhedron so that its area (an emitter's flux) is the sphere's."""
    key = "sphere%s_%dx%d_" % ("_area" if match_area else "", nu, nv) + "_".join("%g" % c for c in list(center) + [radius])

    def make():
        v, f, n = uv_sphere(center, radius, nu, nv)
        if match_area:
            a, b, c = (v[f[:, i]] for i in range(3))
            area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
            v = np.asarray(center) + (v - np.asarray(center)) * math.sqrt(4 * math.pi * radius ** 2 / area)
        return v, f, n

    return mesh_path(_mesh(key.replace("-", "m"), make))


S = 0.01  # Cornell millimetres -> scene units


def _cornell_room():
    q = lambda *p: [tuple(S * c for c in v) for v in p]
    white = [
        q((552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)),
        q((556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)),
        q((549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)),
    ]
    green = [q((0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2))]
    red = [q((552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0))]
    return white, green, red, q


def _cornell_blocks(q):
    short = [
        q((130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)),
        q((290, 0, 114), (290, 165, 114), (240, 165, 272), (240, 0, 272)),
        q((130, 0, 65), (130, 165, 65), (290, 165, 114), (290, 0, 114)),
        q((82, 0, 225), (82, 165, 225), (130, 165, 65), (130, 0, 65)),
        q((240, 0, 272), (240, 165, 272), (82, 165, 225), (82, 0, 225)),
    ]
    tall = [
        q((423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)),
        q((423, 0, 247), (423, 330, 247), (472, 330, 406), (472, 0, 406)),
        q((472, 0, 406), (472, 330, 406), (314, 330, 456), (314, 0, 456)),
        q((314, 0, 456), (314, 330, 456), (265, 330, 296), (265, 0, 296)),
        q((265, 0, 296), (265, 330, 296), (423, 330, 247), (423, 0, 247)),
    ]
    return short + tall


def _cornell_common(name, extra_white):
    white, green, red, q = _cornell_room()
    return {
        "name": name,
        "camera": {"origin": [2.78, 2.73, -8.0], "target": [2.78, 2.73, 0.0], "up": [0, 1, 0],
                   "fov_x": 2 * math.degrees(math.atan(0.0125 / 0.035)), "width": 256, "height": 256,
                   "aperture": 0.0, "focus": 8.0},
        "max_depth": 16,
        "materials": {k: {"type": "diffuse", "color": color(k)} for k in ("white", "green", "red")},
        "shapes": [
            {"type": "mesh", "file": _mesh(name + "_white", lambda: quads_to_mesh(white + extra_white)), "material": "white"},
            {"type": "mesh", "file": _mesh(name + "_green", lambda: quads_to_mesh(green)), "material": "green"},
            {"type": "mesh", "file": _mesh(name + "_red", lambda: quads_to_mesh(red)), "material": "red"},
            # 1 mm below the ceiling, facing down
            {"type": "quad", "corner": [2.13, 5.478, 2.27], "e1": [1.30, 0, 0], "e2": [0, 0, 1.05],
             "emission": color("cornell_light")},
        ],
        "env": None,
    }


def cornell():
    _, _, _, q = _cornell_room()
    return _cornell_common("cornell", _cornell_blocks(q))


def glass():
    s = _cornell_common("glass", [])
    s["materials"]["glass"] = {"type": "dielectric", "ior": 1.5}
    s["materials"]["mirror"] = {"type": "mirror", "color": {"rgb": [1.0, 1.0, 1.0], "const": 1.0}}
    s["shapes"] += [
        {"type": "sphere", "center": [3.85, 1.0, 1.85], "radius": 1.0, "material": "glass"},
        {"type": "sphere", "center": [1.75, 1.0, 3.70], "radius": 1.0, "material": "mirror"},
    ]
    return s


def prism():
    """SF11 60-degree prism near minimum deviation, strip light, baffle, white floor."""
    side, length, cy, dist = 1.0, 3.0, 1.65, 2.0
    r = side / math.sqrt(3)
    tri = [(r * math.cos(a), cy + r * math.sin(a)) for a in (math.radians(90), math.radians(210), math.radians(330))]
    fr = [(x, y, length / 2) for x, y in tri]
    bk = [(x, y, -length / 2) for x, y in tri]

    def make():
        v = fr + bk
        f = [(0, 1, 2), (3, 5, 4)]
        for i in range(3):
            j = (i + 1) % 3
            f += [(i, i + 3, j), (j, i + 3, j + 3)]
        return np.array(v), np.array(f)

    dirn = np.array([math.cos(math.radians(33)), math.sin(math.radians(33)), 0.0])
    c = np.array([0, cy, 0]) - dist * dirn
    t = np.array([-dirn[1], dirn[0], 0.0])
    w, l = 0.60, 2.6
    e1, e2 = t * w, np.array([0, 0, l])  # e1 x e2 must point along dirn
    if np.dot(np.cross(e1, e2), dirn) < 0:
        e1, e2 = e2, e1
    corner = c - e1 / 2 - e2 / 2
    # black baffle under the beam: keeps direct light off the floor
    p0, p1 = c - t * (w / 2 + 0.02) - 0.05 * dirn, np.array([tri[1][0], tri[1][1], 0]) - 0.02 * t
    z = np.array([0, 0, 4.0])
    baffle = [tuple(p0 + z), tuple(p1 + z), tuple(p1 - z), tuple(p0 - z)]
    return {
        "name": "prism",
        "camera": {"origin": [2.0, 3.4, 6.5], "target": [1.6, 0.65, 0.0], "up": [0, 1, 0], "fov_x": 46.0,
                   "width": 256, "height": 256, "aperture": 0.0, "focus": 9.0},
        "max_depth": 16,
        "materials": {"white": {"type": "diffuse", "color": color("white")},
                      "black": {"type": "diffuse", "color": {"rgb": [0.02] * 3, "const": 0.02}},
                      "sf11": {"type": "dielectric", "ior": SF11["nd"], "cauchy": [SF11["A"], SF11["B"]]}},
        "shapes": [
            {"type": "mesh", "file": _mesh("prism_floor", lambda: quads_to_mesh([[(-8, 0, 8), (12, 0, 8), (12, 0, -8), (-8, 0, -8)]])), "material": "white"},
            {"type": "mesh", "file": _mesh("prism_baffle", lambda: quads_to_mesh([baffle])), "material": "black"},
            {"type": "mesh", "file": _mesh("prism_glass", make), "material": "sf11"},
            {"type": "quad", "corner": corner.tolist(), "e1": e1.tolist(), "e2": e2.tolist(), "emission": d65(40.0)},
        ],
        "env": d65(0.05),
    }


def dof():
    """Seven spheres seen through a thin lens (aperture radius 0.08, focus 5)."""
    fov_y = 1.2
    cen = [(10, 0, 1), (7, 0.05, -1), (4, 0.1, 1), (1, 0.2, -1), (-2, 0.4, 1), (-5, 0.8, -1), (-8, 1.6, 1)]
    mats = ["orange", "mirror", "blue", "mirror", "orange", "mirror", "green"]
    s = {
        "name": "dof",
        "camera": {"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0],
                   "fov_x": 2 * math.degrees(math.atan(math.tan(fov_y / 2) * 640 / 480)),
                   "width": 640, "height": 480, "aperture": 0.08, "focus": 5.0},
        "max_depth": 8,
        "materials": {k: {"type": "diffuse", "color": color(k)} for k in ("grey", "orange", "blue", "green")},
        "shapes": [{"type": "mesh", "file": _mesh("dof_ground", lambda: quads_to_mesh([[(-60, -1, 60), (60, -1, 60), (60, -1, -60), (-60, -1, -60)]])), "material": "grey"}],
        "env": d65(0.5),
    }
    s["materials"]["mirror"] = {"type": "mirror", "color": {"rgb": [0.9, 0.9, 0.9], "const": 0.9}}
    for c, m in zip(cen, mats):
        s["shapes"].append({"type": "sphere", "center": list(map(float, c)), "radius": 1.0, "material": m})
    for x in (8, 4, 0, -4):
        s["shapes"].append({"type": "sphere", "center": [float(x), 8.0, 0.0], "radius": 0.5, "emission": d65(20.0)})
    return s


def mesh1m():
    return {
        "name": "mesh1m",
        "camera": {"origin": [0, 4.6, 8.4], "target": [0, 0.0, 0.4], "up": [0, 1, 0], "fov_x": 52.0,
                   "width": 512, "height": 512, "aperture": 0.0, "focus": 8.0},
        "max_depth": 8,
        "materials": {"grey": {"type": "diffuse", "color": {"rgb": [0.7, 0.7, 0.7], "const": 0.7}}},
        "shapes": [
            {"type": "mesh", "file": _mesh("terrain1m", terrain), "material": "grey"},
            {"type": "quad", "corner": [-4.5, 6.0, -1.5], "e1": [3.0, 0, 0], "e2": [0, 0, 3.0], "emission": d65(12.0)},
        ],
        "env": d65(0.5),
    }


def prism_plain():
    """The prism with one index for every wavelength, which every renderer can show."""
    s = prism()
    s["name"] = "prism-plain"
    del s["materials"]["sf11"]["cauchy"]
    return s


SCENES = {"cornell": cornell, "glass": glass, "prism": prism, "prism-plain": prism_plain, "dof": dof, "mesh1m": mesh1m}
