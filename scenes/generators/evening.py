"""Writes scenes/evening.json and what it names: an image of an evening sky, and things that are lit by nothing else.

The image is computed, not photographed: a sky that pales and reddens toward the horizon and around the sun, a sun of two texels,
and dark ground below. Plain standard library.
"""

import math
import os

import scene_text

WIDTH, HEIGHT = 256, 128
SUN_ELEVATION_DEG, SUN_AZIMUTH_DEG = 14.0, 38.0  # above the horizon, to the right of the middle
FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "evening-files")


def direction(elevation_deg, azimuth_deg):
    e, a = math.radians(elevation_deg), math.radians(azimuth_deg)
    return (math.cos(e) * math.sin(a), math.sin(e), math.cos(e) * math.cos(a))


SUN = direction(SUN_ELEVATION_DEG, SUN_AZIMUTH_DEG)


def radiance(elevation_deg, azimuth_deg):
    """Linear Rec. 709."""
    d = direction(elevation_deg, azimuth_deg)
    off = math.degrees(math.acos(max(-1.0, min(1.0, sum(a * b for a, b in zip(d, SUN))))))
    if elevation_deg < 0:
        return (0.035, 0.03, 0.026)
    zenith, horizon, glow = (0.10, 0.20, 0.48), (0.75, 0.55, 0.42), (2.4, 1.1, 0.35)
    pale = math.exp(-elevation_deg / 12)
    warm = math.exp(-off / 14)
    rgb = [z + pale * (h - z) + warm * g for z, h, g in zip(zenith, horizon, glow)]
    if off < 1.0:
        rgb = [r + s for r, s in zip(rgb, (2600.0, 1700.0, 800.0))]
    return rgb


def rgbe(rgb):
    largest = max(rgb)
    mantissa, exponent = math.frexp(largest)
    factor = mantissa * 256 / largest
    return bytes([int(v * factor) for v in rgb] + [exponent + 128])


def image():
    """Radiance HDR, not compressed: rows from the top, the middle of the picture at azimuth 0."""
    texels = b"".join(
        rgbe(radiance(90 - (row + 0.5) / HEIGHT * 180, (column + 0.5) / WIDTH * 360 - 180))
        for row in range(HEIGHT) for column in range(WIDTH)
    )
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n".encode() + texels


def ball(name, x, z, radius, material):
    return {"name": name, "shape": {"type": "sphere", "center_m": [x, radius, z], "radius_m": radius}, "material": material}


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    with open(os.path.join(FOLDER, "sky.hdr"), "wb") as file:
        file.write(image())
    paint = {"type": "rgb", "rgb": [0.42, 0.10, 0.07]}
    scene_text.write("evening", {
        "etalon": 1,
        "comment": [
            "An evening without lamps: all light comes from one image of the sky, with a sun of two texels low on the left behind the",
            "viewer. Look at: long shadows with soft rims, blue where only the sky reaches; the whole image in the mirror ball, upright",
            "and without a seam; the caustic behind the glass. Written by scenes/generators/evening.py.",
        ],
        "camera": {
            "type": "perspective", "position_m": [0.1, 0.42, 1.5], "look_at_m": [0, 0.12, 0], "horizontal_fov_deg": 42,
        },
        "film": {"width": 768, "height": 432, "filter": {"type": "gaussian", "sigma_px": 0.5}},
        "integrator": {"spp": 256},
        "materials": {
            "ground": {"type": "lambert", "reflectance": 0.4},
            "mirror": {"type": "conductor", "metal": "Ag"},
            "brass": {"type": "conductor", "metal": "Au", "alpha": 0.2},
            "glass": {"type": "dielectric", "interior": "N-BK7"},
            "paint": {"type": "plastic", "reflectance": paint},
            "plaster": {"type": "lambert", "reflectance": 0.75},
        },
        "objects": [
            {
                "name": "ground",
                "shape": {"type": "disk", "normal": [0, 1, 0], "radius_m": 100}, "material": "ground",
            },
            ball("mirror", -0.22, -0.1, 0.17, "mirror"),
            ball("gold", 0.14, -0.22, 0.14, "brass"),
            ball("glass", 0.08, 0.2, 0.09, "glass"),
            ball("painted", 0.4, 0.02, 0.11, "paint"),
            ball("plaster", -0.12, 0.28, 0.06, "plaster"),
        ],
        "lights": [{
            "type": "environment", "name": "sky",
            "image": {"file": "evening-files/sky.hdr", "forward": [0, 0, 1], "rotation_deg": 0},
        }],
    })
