"""Cases of glTF's materials that light passes: panes, slabs that absorb and media that scatter."""

import numpy as np

import formulas as f
from films import airy, approximated, observer
from foreign import Gltf
from gltf_models import flat
from views import SIZE, Case

BACK = 2.0
PANE = {"KHR_materials_transmission": {"transmissionFactor": 1.0}}


def even(value):
    return np.full((SIZE, SIZE), value) if np.ndim(value) == 0 else np.full((SIZE, SIZE, 1), 1.0) * value


def before_a_lamp():
    model = flat(Gltf(), 0.5)
    model.quad(model.glow(BACK), z=-6.0)
    return model


def cases():
    yield from panes()
    yield from slabs()
    yield from scattering()


def panes():
    """A single square is a thin wall without refraction: glTF passes 1 − F of the light, tinted once."""
    r = f.head_on(1.5)
    twice = 2 * r / (1 + r)
    for name, base, factor, metallic in [
        ("thin wall", 1.0, 1.0, 0.0),
        ("thin wall, base colour 0.6", 0.6, 1.0, 0.0),
        ("thin wall, transmissionFactor 0.25", 0.6, 0.25, 0.0),
        ("metal with a transmissionFactor", 0.6, 1.0, 1.0),
    ]:
        model = before_a_lamp()
        extension = {"KHR_materials_transmission": {"transmissionFactor": factor}}
        model.quad(model.material(base, metallic, 0.0, extensions=extension))
        share = factor * (1 - metallic)
        own = None if metallic else even(share * base * (1 - twice) * BACK)
        yield Case(name, model, even(share * base * (1 - r) * BACK), None if metallic else "faces", own, spp=1024)
    # A closed box of thin walls has two on the way.
    model = before_a_lamp()
    model.box(model.material(0.8, 0.0, 0.0, extensions=PANE), [-1, -1, -1], [1, 1, 0])
    ways = (1 - twice) ** 2 * 0.8**2 / (1 - twice**2)
    yield Case("closed box of thin walls", model, even((1 - r) ** 2 * 0.8**2 * BACK), "faces", even(ways * BACK), spp=1024)


def slab(extensions, low=-1.5, base=1.0, **keys):
    model = before_a_lamp()
    model.box(model.material(base, 0.0, 0.0, extensions=PANE | extensions, **keys), [-4, -4, low], [4, 4, 0])
    return model


def slabs():
    """A slab 1.5 m thick: what comes through two faces, to and fro, with what is left of the light on the way."""
    for name, index, colour, base in [
        ("volume, no absorption", 1.5, None, 1.0),
        ("volume, attenuationColor 0.5 at 1 m", 1.5, 0.5, 1.0),
        ("volume, ior 2", 2.0, 0.8, 1.0),
        ("volume, base colour 0.7", 1.5, 0.5, 0.7),
        ("volume, ior 1", 1.0, 0.3, 1.0),
    ]:
        volume = {"thicknessFactor": 1.5} | ({} if colour is None else {"attenuationDistance": 1.0, "attenuationColor": [colour] * 3})
        extensions = {"KHR_materials_ior": {"ior": index}, "KHR_materials_volume": volume}
        r, left = f.head_on(index), (colour or 1.0) ** 1.5
        through = (1 - r) ** 2 * base**2 * left / (1 - (r * left) ** 2)
        yield Case(name, slab(extensions, base=base), even(through * BACK), spp=1024)
    film, thickness = 1.38, 120
    nm, rgb = observer()
    r = airy(np.array(1.0), nm, thickness, film, 1.5)
    extension = {"iridescenceFactor": 1, "iridescenceIor": film, "iridescenceThicknessMaximum": thickness}
    extensions = {"KHR_materials_iridescence": extension, "KHR_materials_volume": {"thicknessFactor": 1.5}}
    sample = (1 - approximated(np.array(1.0), thickness, film, f.head_on(1.5)).max()) ** 2
    own = even(((1 - r) ** 2 / (1 - r**2)) @ rgb * BACK)
    yield Case("volume, iridescence", slab(extensions), even(sample * BACK), "film", own, spp=1024)


def scattering():
    """A body 40 mean free paths deep under even light from everywhere, seen from straight above: 1 − H(1)√(1 − ϱ) (Chandrasekhar)."""
    for colour in [0.3, 0.8]:
        lost = 4.09712 + 4.20863 * colour - np.sqrt(9.59217 + 41.6808 * colour + 17.7126 * colour**2)
        share = 1 - lost**2
        mu, weights = np.polynomial.legendre.leggauss(64)
        mu, weights = 0.5 * (mu + 1), 0.5 * weights
        h = np.ones_like(mu)
        for _ in range(2000):
            h = 1 / (np.sqrt(1 - share) + 0.5 * share * (weights * mu * h / (mu[:, None] + mu)).sum(1))
        at_one = 1 / (np.sqrt(1 - share) + 0.5 * share * (weights * mu * h / (1 + mu)).sum())
        model = flat(Gltf(), 0.5)
        glow = model.glow(1.0)
        model.box(glow, [-30, -30, -30], [30, 30, 30])
        extensions = {
            "KHR_materials_ior": {"ior": 1.0},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0.25, "attenuationColor": [np.exp(-1)] * 3},
            "KHR_materials_volume_scatter": {"multiscatterColor": [colour] * 3},
        }
        model.box(model.material(1.0, 0.0, 0.0, extensions=PANE | extensions), [-10, -10, -10], [10, 10, 0])
        yield Case(f"volume scatter {colour}", model, even(1 - at_one * np.sqrt(1 - share)), spp=1024)
