"""Cases of glTF's lamps, attributes, textures, morph targets and skins. Surfaces are bare, so that the light is base × lx/π, or they shine."""

import numpy as np

import formulas as f
from foreign import Gltf, unit
from gltf_materials import BARE
from views import POINTS, SIZE, STEEP, Case, at_angle, pixels


def flat(model, half=1.0):
    """An orthographic camera above that sees a square of this half side."""
    model.camera((0, 0, 5), ymag=half)
    return model


def grid(half=1.0):
    """The places of a flat view, point by point."""
    steps = half * (2 * (np.arange(SIZE * POINTS) + 0.5) / (SIZE * POINTS) - 1)
    return np.meshgrid(steps, -steps)


def rectangle(value, x0, x1, y0, y1):
    """Pixels of a flat view that see a rectangle of this radiance; its sides lie between pixels, or the mean of a pixel counts."""
    x, y = grid()
    return pixels(np.where((x > x0) & (x < x1) & (y > y0) & (y < y1), value, 0.0))


def cases():
    yield from lamps()
    yield from attributes()
    yield from textures()
    yield from coverage()
    yield from bent()


def lamps():
    model = flat(Gltf())
    toward = np.array(at_angle(40, -1.0, 0.3))
    model.lamp("directional", 3.0, toward=toward, color=[0.5] * 3)
    model.quad(model.material(0.6, extensions=BARE))
    lux = 1.5 * -unit(toward)[2]
    yield Case("directional lamp, lx", model, np.full((SIZE, SIZE), 0.6 * lux / np.pi))
    model = STEEP.model()
    model.json["extensions"]["KHR_lights_punctual"]["lights"][0]["color"] = [0.9, 0.5, 0.2]
    model.quad(model.material(0.5, extensions=BARE))
    yield Case("point lamp, cd, coloured", model, STEEP.picture(lambda o, i: f.lambert(o, i, 0.5))[..., None] * [0.9, 0.5, 0.2])
    model = flat(Gltf())
    model.lamp("spot", 20.0, (0, 0, 3), toward=np.array([0.1, 0, -1.0]), spot={"innerConeAngle": 0.1, "outerConeAngle": 0.35})
    model.quad(model.material(0.5, extensions=BARE))
    x, y = grid()
    away = np.stack([x, y, np.full_like(x, -3.0)], -1)
    cos = unit(away) @ unit([0.1, 0, -1])
    lux = 20 * 3 / (away**2).sum(-1) ** 1.5
    share = np.clip((cos - np.cos(0.35)) / (np.cos(0.1) - np.cos(0.35)), 0, 1)
    by_gltf, own = (pixels(0.5 / np.pi * lux * curve) for curve in (share**2, share**2 * (3 - 2 * share)))
    yield Case("spot lamp, cd", model, by_gltf, "spot", own)
    model = STEEP.model()
    model.json["extensions"]["KHR_lights_punctual"]["lights"][0]["range"] = 6.0
    model.quad(model.material(0.5, extensions=BARE))
    places, o, i, lux = STEEP.directions()
    faded = lux * (1 - (np.linalg.norm(places - STEEP.lamp, axis=-1) / 6) ** 4)
    by_gltf = pixels(0.5 / np.pi * faded)
    yield Case("range of a lamp", model, by_gltf, "range", STEEP.picture(lambda o, i: f.lambert(o, i, 0.5)))


def lit(model):
    """A lamp far away at 30° from the normal; what a bare surface of reflectance 1 then shows."""
    model.lamp("directional", 4.0, toward=np.array(at_angle(-30, -1.0)))
    return 4 * np.cos(np.radians(30)) / np.pi


def attributes():
    x, _ = grid()
    for name, kind, scale in [("floats", np.float32, 1), ("bytes", np.uint8, 255), ("shorts", np.uint16, 65535)]:
        model = flat(Gltf())
        white = lit(model)
        material = model.material(0.8, extensions=BARE)
        corners = [[-1.5, -1.5, 0], [1.5, -1.5, 0], [1.5, 1.5, 0], [-1.5, 1.5, 0]]
        shades = np.array([0.2, 0.8, 0.8, 0.2]) if scale == 1 else np.round(np.array([0.2, 0.8, 0.8, 0.2]) * scale)
        colours = np.column_stack([shades] * 3 + [np.full(4, scale)])
        attributes = {"POSITION": model.accessor(corners), "COLOR_0": model.accessor(colours, kind, scale != 1)}
        model.node(mesh=model.mesh(attributes, [0, 1, 2, 0, 2, 3], material))
        ramp = shades[0] / scale + (shades[1] - shades[0]) / scale * (x + 1.5) / 3
        yield Case(f"COLOR_0, {name}", model, pixels(0.8 * white * ramp))
    model = flat(Gltf())
    white = lit(model)
    model.quad(model.material([0.6, 0.3, 0.1], extensions=BARE))
    yield Case("coloured base", model, np.full((SIZE, SIZE, 1), white) * [0.6, 0.3, 0.1])
    model = flat(Gltf())
    white = lit(model)
    other = model.material(0.7, extensions=BARE)
    mappings = {"KHR_materials_variants": {"mappings": [{"material": other, "variants": [1]}]}}
    model.quad(model.material(0.2, extensions=BARE), extensions=mappings)
    model.use("KHR_materials_variants")
    model.json.setdefault("extensions", {})["KHR_materials_variants"] = {"variants": [{"name": "day"}, {"name": "night"}]}
    yield Case("KHR_materials_variants, the second", model, np.full((SIZE, SIZE), 0.7 * white), imported=["--variant", "night"])
    yield from quantised()


def quantised():
    # Whole numbers times the scale of the node; and normalised ones, whose 32767 is 1.
    for name, kind, numbers, normalised, scale, shift in [
        ("POSITION in bytes", np.uint8, [0, 6, 1, 4], False, 0.25, -0.75),
        ("POSITION in normalised shorts", np.int16, [-16384, 16384, -8192, 24576], True, 1.0, 0.0),
    ]:
        model = flat(Gltf())
        model.use("KHR_mesh_quantization", required=True)
        a, b, c, d = numbers
        corners = model.accessor([[a, c, 0], [b, c, 0], [b, d, 0], [a, d, 0]], kind, normalised)
        mesh = model.mesh({"POSITION": corners}, [0, 1, 2, 0, 2, 3], model.glow(2.0))
        model.node(mesh=mesh, scale=[scale] * 3, translation=[shift, shift, 0])
        sides = [scale * n / (32767 if normalised else 1) + shift for n in numbers]
        yield Case(f"KHR_mesh_quantization, {name}", model, rectangle(2.0, *sides), spp=1024)
    model = flat(Gltf())
    model.use("KHR_mesh_quantization", required=True)
    toward = np.array(at_angle(-30, -1.0))
    model.lamp("directional", 4.0, toward=toward)
    corners = model.accessor([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.int8)
    normal = [60, 20, 110]
    mesh = model.mesh(
        {"POSITION": corners, "NORMAL": model.accessor([normal] * 4, np.int8, True)},
        [0, 1, 2, 0, 2, 3],
        model.material(0.5, extensions=BARE),
    )
    model.node(mesh=mesh, scale=[2, 2, 2])
    cos = unit(normal) @ -unit(toward)
    yield Case("KHR_mesh_quantization, NORMAL in bytes", model, np.full((SIZE, SIZE), 0.5 * 4 * cos / np.pi))


def textures():
    shades = np.array([[40, 90, 200, 250], [180, 60, 120, 30], [220, 140, 70, 110], [100, 240, 160, 80]])
    linear = np.where(shades <= 0.04045 * 255, shades / 255 / 12.92, ((shades / 255 + 0.055) / 1.055) ** 2.4)
    offset, turn, scale = (0.2, 0.7), 0.6, (1.5, 0.8)
    x, y = grid()
    # Texture coordinates run from the top left; texels have their centres at halves.
    u, v = 0.5 * (x + 1), 0.5 * (1 - y)
    s, t = u * scale[0], v * scale[1]
    at = np.cos(turn) * s + np.sin(turn) * t + offset[0], -np.sin(turn) * s + np.cos(turn) * t + offset[1]
    for name, (s, t), extension in [
        ("base colour texture", (u, v), None),
        ("KHR_texture_transform", at, {"offset": list(offset), "rotation": turn, "scale": list(scale)}),
    ]:
        model = flat(Gltf())
        white = lit(model)
        extra = {"extensions": {"KHR_texture_transform": extension}} if extension else {}
        if extension:
            model.use("KHR_texture_transform")
        texture = model.image(np.stack([shades] * 3, -1), {"magFilter": 9729, "minFilter": 9729}, **extra)
        base = {"baseColorTexture": texture, "baseColorFactor": [0.9, 0.9, 0.9, 1]}
        model.quad(model.material(base, extensions=BARE), half=1.0)
        yield Case(name, model, pixels(0.9 * white * interpolated(linear, s, t)))
    model = flat(Gltf())
    toward = np.array(at_angle(-30, -1.0))
    model.lamp("directional", 4.0, toward=toward)
    texel = np.array([180, 150, 220])
    texture = model.image(np.tile(texel, (2, 2, 1)), {"magFilter": 9729, "minFilter": 9729}, scale=0.5)
    model.quad(model.material(0.5, extensions=BARE, normalTexture=texture))
    bent = unit((texel / 255 * 2 - 1) * [0.5, 0.5, 1])
    yield Case("normalTexture, scale 0.5", model, np.full((SIZE, SIZE), 0.5 * 4 * (bent @ -unit(toward)) / np.pi))
    model = flat(Gltf())
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 6.0}}
    texture = model.image(np.stack([shades] * 3, -1), {"magFilter": 9729, "minFilter": 9729})
    model.quad(model.material(0.0, extensions=strength | BARE, emissiveFactor=[0.5] * 3, emissiveTexture=texture), half=1.0)
    yield Case("KHR_materials_emissive_strength", model, pixels(3 * interpolated(linear, u, v)))


def interpolated(texels, u, v):
    """Bilinear, with the texture repeated."""
    height, width = texels.shape
    x, y = u * width - 0.5, v * height - 0.5
    a, b = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = x - a, y - b

    def texel(i, j):
        return texels[j % height, i % width]

    return (1 - t) * ((1 - s) * texel(a, b) + s * texel(a + 1, b)) + t * ((1 - s) * texel(a, b + 1) + s * texel(a + 1, b + 1))


def coverage():
    for name, alpha, keys in [("BLEND", 0.3, {}), ("MASK", 0.3, {"alphaCutoff": 0.5}), ("MASK", 0.7, {"alphaCutoff": 0.5})]:
        model = flat(Gltf())
        white = lit(model)
        base = {"baseColorFactor": [0.5, 0.5, 0.5, alpha]}
        model.quad(model.material(base, extensions=BARE, alphaMode=name, **keys))
        model.quad(model.glow(0.9), z=-1.0)
        share = alpha if name == "BLEND" else float(alpha >= 0.5)
        yield Case(f"alphaMode {name}, alpha {alpha}", model, np.full((SIZE, SIZE), share * 0.5 * white + (1 - share) * 0.9), spp=1024)
    model = flat(Gltf())
    extension = {"diffuseTransmissionFactor": 0.4, "diffuseTransmissionColorFactor": [0.7] * 3}
    model.lamp("directional", 4.0, toward=np.array([0, 0, 1.0]))
    lit(model)
    model.quad(model.material(0.5, extensions=BARE | {"KHR_materials_diffuse_transmission": extension}))
    light = (0.6 * 0.5 * 4 * np.cos(np.radians(30)) + 0.4 * 0.7 * 4) / np.pi
    yield Case("KHR_materials_diffuse_transmission", model, np.full((SIZE, SIZE), light))


def bent():
    corners = np.array([[-0.75, -0.5, 0], [0, -0.5, 0], [0, 0.5, 0], [-0.75, 0.5, 0]])
    model = flat(Gltf())
    move, turn = np.tile([1.0, 0, 0], (4, 1)), np.tile([0, 0.8, -0.4], (4, 1))
    attributes = {"POSITION": model.accessor(corners), "NORMAL": model.accessor([[0, 0, 1]] * 4)}
    toward = np.array(at_angle(-30, -1.0, 0.2))
    model.lamp("directional", 4.0, toward=toward)
    targets = [{"POSITION": model.accessor(move), "NORMAL": model.accessor(turn)}]
    mesh = model.mesh(attributes, [0, 1, 2, 0, 2, 3], model.material(0.5, extensions=BARE), targets=targets)
    model.json["meshes"][mesh]["weights"] = [0.1]
    model.node(mesh=mesh, weights=[0.5])
    light = 0.5 * 4 * (unit([0, 0.4, 0.8]) @ -unit(toward)) / np.pi
    yield Case("morph target, weight 0.5", model, rectangle(light, -0.25, 0.5, -0.5, 0.5), spp=1024)
    # The square stands upright in its own place and faces +x. One joint turns it to face +z; another, of half the weight, moves it up by 1.
    model = flat(Gltf())
    model.lamp("directional", 4.0, toward=toward)
    upright = [[0, -0.5, 0.75], [0, -0.5, 0], [0, 0.5, 0], [0, 0.5, 0.75]]
    attributes = {"POSITION": model.accessor(upright), "NORMAL": model.accessor([[1, 0, 0]] * 4)}
    attributes["JOINTS_0"] = model.accessor([[0, 1, 0, 0]] * 4, np.uint8)
    attributes["WEIGHTS_0"] = model.accessor([[0.5, 0.5, 0, 0]] * 4)
    # A quaternion: a turn by −90° about y.
    turned = {"rotation": [0, -np.sqrt(0.5), 0, np.sqrt(0.5)]}
    joints = [model.node(**turned), model.node(**turned, translation=[0, 0.5, 0])]
    skin = model.add("skins", {"joints": joints})
    mesh = model.mesh(attributes, [0, 1, 2, 0, 2, 3], model.material(0.5, extensions=BARE))
    model.node(mesh=mesh, skin=skin, translation=[7, 0, 0])
    light = 0.5 * 4 * -unit(toward)[2] / np.pi
    yield Case("skin of two joints", model, rectangle(light, -0.75, 0, -0.25, 0.75), spp=1024)
