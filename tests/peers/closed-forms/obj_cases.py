"""Cases of OBJ with MTL. The format has neither camera nor lamps at points: they are put into the imported scene."""

import numpy as np

import formulas as f
from gltf_models import grid
from views import SIZE, VIEWS, Case, pixels


class Obj:
    """Squares, each of a material. `seen` is a camera of the scene format, `lamps` its lights."""

    def __init__(self, seen, lamps):
        self.seen, self.lamps, self.lines, self.materials, self.count = seen, lamps, ["mtllib model.mtl"], [], 0

    def face(self, corners, material):
        self.lines += ["v {} {} {}".format(*corner) for corner in corners] + [f"usemtl {material}"]
        self.lines.append("f " + " ".join(str(self.count + k + 1) for k in range(len(corners))))
        self.count += len(corners)

    def square(self, material, half=4.0, z=0.0):
        self.face([(-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z)], material)

    def box(self, material, low, high):
        (a, b, c), (d, e, g) = low, high
        self.face([(a, b, g), (d, b, g), (d, e, g), (a, e, g)], material)
        self.face([(a, b, c), (a, e, c), (d, e, c), (d, b, c)], material)
        self.face([(a, b, c), (d, b, c), (d, b, g), (a, b, g)], material)
        self.face([(a, e, c), (a, e, g), (d, e, g), (d, e, c)], material)
        self.face([(a, b, c), (a, b, g), (a, e, g), (a, e, c)], material)
        self.face([(d, b, c), (d, e, c), (d, e, g), (d, b, g)], material)

    def material(self, name, *lines):
        self.materials += [f"newmtl {name}", *lines]

    def write(self, folder):
        (folder / "model.obj").write_text("\n".join(self.lines) + "\n")
        (folder / "model.mtl").write_text("\n".join(self.materials) + "\n")
        return folder / "model.obj"

    def change(self, scene):
        """Exchanges the studio that the import adds for the camera and the lamps."""
        scene["objects"] = [thing for thing in scene["objects"] if thing["material"] not in ("backdrop", "lamp")]
        scene["camera"], scene["lights"] = self.seen, self.lamps


def under(view):
    seen = {"type": "perspective", "position_m": view.eye, "look_at_m": [0, 0, 0], "up": [0, 1, 0]}
    seen["vertical_fov_deg"] = float(np.degrees(view.yfov))
    lamp = {"type": "point", "position_m": view.lamp, "intensity": {"type": "rgb", "rgb": [1, 1, 1], "scale": view.candela}}
    return Obj(seen, [lamp])


def above(half=0.5):
    return Obj({"type": "orthographic", "position_m": [0, 0, 5], "look_at_m": [0, 0, 0], "up": [0, 1, 0], "height_m": 2 * half}, [])


def case(name, lines, by_mtl, own=None, why=None):
    for word, view in VIEWS.items():
        model = under(view)
        model.material("paint", *lines)
        model.square("paint")
        yield Case(f"MTL {name}, {word}", model, view.picture(by_mtl), why, None if own is None else view.picture(own))


def grey(key, value):
    return f"{key} {value} {value} {value}"


def cases():
    yield from case("Kd 0.4", [grey("Kd", 0.4)], lambda o, i: f.lambert(o, i, 0.4))
    for lines, rough, metallic in [(["Pr 0.6"], 0.6, 0), (["Pr 0.4", "Pm 1"], 0.4, 1), (["Pr 0.5", "Pm 0.3"], 0.5, 0.3)]:
        a = rough**2
        yield from case(
            " ".join(lines),
            [grey("Kd", 0.5), *lines],
            lambda o, i: (1 - metallic) * f.dielectric(o, i, 0.5, a) + metallic * f.metal(o, i, 0.5, a),
            lambda o, i: (1 - metallic) * f.plastic(o, i, 0.5, a) + metallic * f.conductor(o, i, 0.5, a),
            {0: "coat", 1: "metal"}.get(metallic, "coat metal"),
        )
    yield from highlights()
    yield from others()


def highlights():
    """`illum` 2 of MTL: (Kd N·L + Ks (N·H)^Ns) times the light, over π as of a diffuse surface. The highlight has no cosine."""
    exponent = 40
    alpha = np.sqrt(2 / (exponent + 2))

    def by_mtl(o, i, diffuse, specular):
        return f.lambert(o, i, diffuse) + specular * f.half(o, i)[..., 2] ** exponent / (np.pi * i[..., 2])

    root = np.sqrt(0.08 * 0.5)
    index = (1 + root) / (1 - root)
    yield from case(
        "Kd 0.3 Ks 0.5 Ns 40",
        [grey("Kd", 0.3), grey("Ks", 0.5), f"Ns {exponent}", "illum 2"],
        lambda o, i: by_mtl(o, i, 0.3, 0.5),
        lambda o, i: f.plastic(o, i, 0.3, alpha, index, gaussian=True),
        "phong",
    )
    yield from case(
        "Kd 0 Ks 0.5 Ns 40",
        [grey("Kd", 0), grey("Ks", 0.5), f"Ns {exponent}", "illum 2"],
        lambda o, i: by_mtl(o, i, 0.0, 0.5),
        lambda o, i: f.conductor(o, i, 0.5, alpha, gaussian=True),
        "phong",
    )


def others():
    model = above()
    model.material("glow", grey("Ke", 3))
    model.square("glow")
    yield Case("MTL Ke 3", model, np.full((SIZE, SIZE), 3.0))
    yield ke_on_kd()
    for d in [0.3, 0.8]:
        model = above()
        model.material("glow", grey("Ke", 2), grey("Kd", 0))
        model.material("veil", grey("Kd", 0), f"d {d}")
        model.square("glow", z=-2.0)
        model.square("veil")
        yield Case(f"MTL d {d}", model, np.full((SIZE, SIZE), 2 * (1 - d)), spp=1024)
    r = f.head_on(1.5)
    through = 2 * (1 - r) ** 2 / (1 - r * r)
    for name, lines, by_mtl in [("Ni 1.5 illum 7", ["Ni 1.5", "illum 7"], through), ("Ni 1.5 d 0.1", ["Ni 1.5", "d 0.1"], 2 * 0.9**2)]:
        model = above()
        model.material("glow", grey("Ke", 2), grey("Kd", 0))
        model.material("glass", grey("Kd", 0), *lines)
        model.square("glow", z=-4.0, half=8)
        model.box("glass", (-4, -4, -1), (4, 4, 0))
        same = by_mtl == through
        shown = np.full((SIZE, SIZE), through)
        yield Case(f"MTL {name}, a slab", model, np.full((SIZE, SIZE), by_mtl), None if same else "glass", None if same else shown, spp=1024)


def ke_on_kd():
    """A square lamp of 2 m at 3 m above a floor: the radiance ρ L times the form factor of a parallel rectangle to each place."""
    model = above(1.0)
    model.material("glow", grey("Ke", 5), grey("Kd", 0))
    model.material("floor", grey("Kd", 0.5))
    model.square("floor")
    # It lies behind the camera and faces down.
    model.face([(-1, -1, 6), (-1, 1, 6), (1, 1, 6), (1, -1, 6)], "glow")
    x, y = grid()

    def corner(a, b):
        """The form factor of a rectangle of sides a, b at distance 1 whose corner lies above the place (negative sides count so)."""
        s, t = a / np.sqrt(1 + a * a), b / np.sqrt(1 + b * b)
        return (s * np.arctan(b / np.sqrt(1 + a * a)) + t * np.arctan(a / np.sqrt(1 + b * b))) / (2 * np.pi)

    d = 6.0
    share = sum(corner((1 + sx * x) / d, (1 + sy * y) / d) for sx in (-1, 1) for sy in (-1, 1))
    return Case("MTL Ke 5 on Kd 0.5", model, pixels(0.5 * 5 * share), spp=1024)
