"""Writes scenes/black-light.json: paper and paints that fluoresce, under a lamp of which the eye sees almost nothing.

Each dye has bands of absorption and one of emission, of Gaussian shape: like brighteners, fluorescein and rhodamines, not measured ones. What a
paint does not absorb it reflects.

Plain standard library.
"""

import math

import scene_text

RANGE_NM = [340, 760]
STEP_NM = 10
LAMP_NM, LAMP_WIDTH_NM = 368, 9

# Name, bands of absorption (peak nm, width nm, share), emission (peak nm, width towards blue, towards red), photons for each absorbed.
DYES = [
    ("paper", [(372, 20, 0.75)], (435, 14, 30), 0.8),
    ("blue", [(385, 28, 0.8)], (462, 14, 28), 0.85),
    ("green", [(470, 26, 0.9), (370, 30, 0.7)], (512, 12, 24), 0.9),
    ("orange", [(535, 24, 0.9), (365, 32, 0.7)], (592, 14, 26), 0.85),
    ("red", [(575, 26, 0.9), (365, 32, 0.7)], (632, 15, 28), 0.8),
]


def gaussian(x, width):
    return math.exp(-0.5 * (x / width) ** 2)


def table(value, step=STEP_NM):
    first, last = RANGE_NM
    nm = list(range(first, last + 1, step))
    values = [round(value(x), 4) for x in nm]
    # Without the zeros at both ends, but for one.
    used = [i for i, v in enumerate(values) if v > 0]
    begin, end = max(used[0] - 1, 0), min(used[-1] + 2, len(nm))
    return {"type": "tabulated", "wavelengths_nm": nm[begin:end], "values": values[begin:end], "outside": "zero"}


def paint(bands, emission, quantum_yield):
    peak, bluer, redder = emission

    def absorbed(nm):
        return min(0.95, sum(share * gaussian(nm - at, width) for at, width, share in bands))

    return {
        "type": "fluorescent",
        "reflectance": table(lambda nm: 0.9 * (1 - absorbed(nm))),
        "fluorophores": [{
            "absorption": table(absorbed),
            "emission": table(lambda nm: gaussian(nm - peak, bluer if nm < peak else redder)),
            "quantum_yield": quantum_yield,
        }],
    }


def ball(name, x, z, radius):
    return {"name": name, "shape": {"type": "sphere", "center_m": [x, radius, z], "radius_m": radius}, "material": name}


def scene():
    materials = {name: paint(bands, emission, share) for name, bands, emission, share in DYES}
    materials["desk"] = {"type": "plastic", "reflectance": 0.06, "alpha": 0.2}
    materials["chalk"] = {"type": "lambert", "reflectance": 0.9}
    tube = {"type": "cylinder", "start_m": [-0.35, 0.62, 0.1], "end_m": [0.35, 0.62, 0.1], "radius_m": 0.012}
    return {
        "etalon": 1,
        "comment": [
            "Balls of paint and a sheet of paper under a black light, a tube that shines near 368 nm.",
            "Look at: the paper, which is brighter than the chalk beside it; the colours that the balls cast on the paper, light that they give",
            "back themselves. With --without fluorescence nearly nothing is left. Made by generators/black_light.py.",
        ],
        "camera": {
            "type": "perspective", "position_m": [0, 0.34, 0.95], "look_at_m": [0, 0.085, 0], "horizontal_fov_deg": 33,
        },
        "film": {"width": 480, "height": 320, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "integrator": {"spp": 256, "wavelength_range_nm": RANGE_NM},
        "materials": materials,
        "objects": [
            {
                "name": "desk",
                "shape": {"type": "parallelogram", "origin_m": [-2, 0, 1], "u_m": [4, 0, 0], "v_m": [0, 0, -2]},
                "material": "desk",
            },
            {
                "name": "sheet",
                "shape": {"type": "parallelogram", "origin_m": [-0.3, 0.001, 0.13], "u_m": [0.6, 0, 0], "v_m": [0, 0, -0.3]},
                "material": "paper",
            },
            {
                "name": "wall",
                "shape": {"type": "parallelogram", "origin_m": [-2, 0, -0.6], "u_m": [4, 0, 0], "v_m": [0, 2, 0]},
                "material": "desk",
            },
            ball("blue", -0.2, 0.0, 0.05),
            ball("green", -0.07, -0.02, 0.055),
            ball("orange", 0.07, 0.02, 0.05),
            ball("red", 0.2, -0.01, 0.055),
            ball("chalk", 0.0, 0.09, 0.028),
            {
                "name": "tube",
                "shape": tube,
                "material": {"type": "black"},
                "emission": {"radiance": table(lambda nm: 90 * gaussian(nm - LAMP_NM, LAMP_WIDTH_NM), 2)},
            },
        ],
        "lights": [{"type": "environment", "name": "night", "radiance": {"type": "illuminant", "name": "D65", "scale": 0.01}}],
    }


if __name__ == "__main__":
    scene_text.write("black-light", scene())
