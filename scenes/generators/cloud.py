"""Writes the densities of scenes/cloud.json: a cumulus of noise between a flat base and a billowing top.

    python3 scenes/generators/cloud.py

Needs nothing but Python. Values are shares of the densest place, in a .vol file whose box is in metres.
"""

import math
import struct
from pathlib import Path

CELLS = (54, 30, 42)
BOX_M = ((-450.0, 0.0, -350.0), (450.0, 500.0, 350.0))
SEED = 7


def lattice(x, y, z):
    """A number in [0, 1) for each point of the integer lattice."""
    h = (x * 374761393 + y * 668265263 + z * 2147483647 + SEED * 974634777) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    h = ((h ^ (h >> 16)) * 2246822519) & 0xFFFFFFFF
    return (h ^ (h >> 15)) / 2**32


def noise(p):
    """Value noise, smooth between the points of the lattice."""
    cell = [math.floor(v) for v in p]
    t = [v - c for v, c in zip(p, cell)]
    t = [v * v * (3 - 2 * v) for v in t]
    total = 0.0
    for corner in range(8):
        bits = [corner >> k & 1 for k in range(3)]
        weight = math.prod(s if bit else 1 - s for s, bit in zip(t, bits))
        total += weight * lattice(*(c + bit for c, bit in zip(cell, bits)))
    return total


def billows(p):
    """Noise of five octaves, in [0, 1]."""
    total, amplitude, reach = 0.0, 1.0, 0.0
    for octave in range(5):
        total += amplitude * noise([v * 2**octave + 17 * octave for v in p])
        reach += amplitude
        amplitude *= 0.55
    return total / reach


# Middles in metres, radii in metres: the body of the cloud is what these balls cover.
BALLS = [
    ((0, 190, 0), 190), ((-170, 150, 40), 150), ((190, 140, -30), 150), ((60, 280, 30), 130), ((-90, 250, -60), 120),
    ((290, 110, 40), 90), ((-290, 110, -20), 100), ((40, 160, 170), 130), ((-40, 150, -160), 130),
]


def density(p):
    depth = max(1 - math.dist(p, middle) / radius for middle, radius in BALLS)
    base = min(1.0, max(0.0, (p[1] - 45) / 25))
    ragged = depth + 1.5 * (billows([v / 110 for v in p]) - 0.5)
    return base * min(1.0, max(0.0, 3.0 * ragged))


def main():
    low, high = BOX_M
    numbers = []
    for z in range(CELLS[2]):
        for y in range(CELLS[1]):
            for x in range(CELLS[0]):
                at = [low[k] + (high[k] - low[k]) * ((x, y, z)[k] + 0.5) / CELLS[k] for k in range(3)]
                numbers.append(density(at))
    target = Path(__file__).parent.parent / "cloud-files" / "cloud.vol"
    header = b"VOL\x03" + struct.pack("<5i", 1, *CELLS, 1) + struct.pack("<6f", *low, *high)
    target.write_bytes(header + struct.pack(f"<{len(numbers)}f", *numbers))


main()
