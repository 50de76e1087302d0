"""Cases of glTF's materials that reflect: a square under a lamp, seen from above and at a grazing angle."""

import numpy as np

import formulas as f
from films import films
from views import VIEWS, Case

BARE = {"KHR_materials_specular": {"specularFactor": 0}}


def case(name, by_gltf, own=None, why=None, **keys):
    """One case for each view. `keys` are those of the material."""
    for word, view in VIEWS.items():
        model = view.model()
        model.quad(model.material(**keys))
        yield Case(f"{name}, {word}", model, view.picture(by_gltf), why, None if own is None else view.picture(own))


def cases():
    yield from case("base without coat", lambda o, i: f.lambert(o, i, 0.5), base=0.5, extensions=BARE)
    for rough in [0.3, 0.6, 1.0]:
        a = rough**2
        by_gltf, own = (lambda o, i: f.dielectric(o, i, 0.5, a)), (lambda o, i: f.plastic(o, i, 0.5, a))
        yield from case(f"dielectric, roughness {rough}", by_gltf, own, "coat", base=0.5, roughness=rough)
    for rough in [0.3, 0.6, 1.0]:
        a = rough**2
        by_gltf, own = (lambda o, i: f.metal(o, i, 0.6, a)), (lambda o, i: f.conductor(o, i, 0.6, a))
        yield from case(f"metal, roughness {rough}", by_gltf, own, "metal", base=0.6, metallic=1.0, roughness=rough)
    yield from half_metal()
    yield from ior_and_specular()
    yield from clear_coats()
    yield from sheens()
    yield from anisotropy()
    yield from films(case)


def half_metal():
    def mixed(ground, metal):
        return lambda o, i: 0.75 * ground(o, i, 0.5, 0.25) + 0.25 * metal(o, i, 0.5, 0.25)

    both = mixed(f.dielectric, f.metal), mixed(f.plastic, f.conductor)
    yield from case("metallicFactor 0.25", *both, "coat metal", base=0.5, metallic=0.25, roughness=0.5)


def ior_and_specular():
    for index in [1.33, 2.0]:
        by_gltf, own = (lambda o, i: f.dielectric(o, i, 0.5, 0.25, index)), (lambda o, i: f.plastic(o, i, 0.5, 0.25, index))
        extension = {"KHR_materials_ior": {"ior": index}}
        yield from case(f"ior {index}", by_gltf, own, "coat", base=0.5, roughness=0.5, extensions=extension)
    for specular, colour in [(0.4, 1.0), (1.0, 2.5), (0.7, 0.5)]:
        root = np.sqrt(0.04 * colour)
        index = (1 + root) / (1 - root)

        def own(o, i):
            return specular * f.plastic(o, i, 0.5, 0.25, index) + (1 - specular) * f.lambert(o, i, 0.5)

        extension = {"KHR_materials_specular": {"specularFactor": specular, "specularColorFactor": [colour] * 3}}
        yield from case(
            f"specular {specular}, colour {colour}",
            lambda o, i: f.dielectric(o, i, 0.5, 0.25, 1.5, specular, colour),
            own,
            "coat",
            base=0.5,
            roughness=0.5,
            extensions=extension,
        )


def clear_coats():
    a, rough = 0.09, 0.3
    for factor in [1.0, 0.5]:
        coat = {"clearcoatFactor": factor, "clearcoatRoughnessFactor": rough}
        extension = {"KHR_materials_clearcoat": coat}
        yield from case(
            f"clear coat {factor} on a bare base",
            lambda o, i: f.coated(o, i, f.lambert(o, i, 0.5), factor, a),
            lambda o, i: factor * f.plastic(o, i, 0.5, a) + (1 - factor) * f.lambert(o, i, 0.5),
            "coat",
            base=0.5,
            extensions=extension | BARE,
        )
        yield from case(
            f"clear coat {factor} on a dielectric",
            lambda o, i: f.coated(o, i, f.dielectric(o, i, 0.5, 0.36), factor, a),
            lambda o, i: factor * f.plastic(o, i, 0.5, a) + (1 - factor) * f.plastic(o, i, 0.5, 0.36),
            "coat takes",
            base=0.5,
            roughness=0.6,
            extensions=extension,
        )
        share = 0.04 * factor
        yield from case(
            f"clear coat {factor} on metal",
            lambda o, i: f.coated(o, i, f.metal(o, i, 0.6, 0.36), factor, a),
            lambda o, i: share * f.conductor(o, i, 0.9999, a) + (1 - share) * f.conductor(o, i, 0.6, 0.36),
            "share metal",
            base=0.6,
            metallic=1.0,
            roughness=0.6,
            extensions=extension,
        )


def sheens():
    for rough in [0.5, 1.0]:
        a = rough**2
        steps = np.sqrt((np.arange(48) + 0.5) / 48)
        means = [f.albedo(lobe, steps).mean() for lobe in (lambda o, i: f.fibres(o, i, a), f.flat_lobe)]
        share = 0.5 * means[0] / means[1]
        yield from case(
            f"sheen 0.5, roughness {rough}",
            lambda o, i: f.with_sheen(o, i, f.lambert(o, i, 0.3), 0.5, rough),
            lambda o, i: share * f.flat_lobe(o, i) + (1 - share) * f.lambert(o, i, 0.3),
            "sheen",
            base=0.3,
            extensions=BARE | {"KHR_materials_sheen": {"sheenColorFactor": [0.5] * 3, "sheenRoughnessFactor": rough}},
        )


def anisotropy():
    strength, turn, b = 0.6, 0.5, 0.16
    t = b + (1 - b) * strength**2
    rotation = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    yield from case(
        "anisotropy 0.6, turned by 0.5 rad",
        lambda o, i: f.metal(o @ rotation.T, i @ rotation.T, 0.6, t, b),
        lambda o, i: f.brushed(o @ rotation.T, i @ rotation.T, 0.6, t, b),
        "metal",
        base=0.6,
        metallic=1.0,
        roughness=0.4,
        extensions={"KHR_materials_anisotropy": {"anisotropyStrength": strength, "anisotropyRotation": turn}},
    )
