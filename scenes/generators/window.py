"""Writes scenes/window-files/rose.png: the panes of a round window of coloured glass, which scenes/window.json lets shine.

Rings of petals in lead, each pane of one colour with a little of the unevenness of blown glass. Plain standard library.
"""

import math
import pathlib
import random

from vase import write_png

SIDE = 256
LEAD = 0.012  # half the width of the leading, in radii
DEEP_BLUE, RUBY, AMBER, GREEN, PALE = (20, 50, 190), (190, 16, 24), (250, 180, 40), (24, 140, 60), (235, 235, 215)
# Outer radius, number of panes, part of a pane by which the ring is turned, colours in turn.
RINGS = [
    (0.14, 1, 0.0, [AMBER]),
    (0.38, 8, 0.0, [RUBY, DEEP_BLUE]),
    (0.50, 16, 0.5, [PALE, GREEN]),
    (0.84, 16, 0.0, [DEEP_BLUE, RUBY, DEEP_BLUE, AMBER]),
    (0.97, 32, 0.5, [AMBER, DEEP_BLUE, GREEN, DEEP_BLUE]),
]


def pane(x, y):
    """Ring, number and colour of the pane at a point of the unit disk, or None in the leading and beyond the rim."""
    radius, turn = math.hypot(x, y), math.atan2(y, x) / (2 * math.pi) % 1
    inner = 0.0
    for ring, (outer, count, shift, colours) in enumerate(RINGS):
        if radius < outer:
            place = (turn * count + shift) % count
            off_radial = min(place % 1, 1 - place % 1) / count * 2 * math.pi * radius
            if min(radius - inner, outer - radius) < LEAD and inner > 0 or count > 1 and off_radial < LEAD:
                return None
            return ring, int(place), colours[int(place) % len(colours)]
        inner = outer
    return None


def texel(column, row):
    found = pane(2 * (column + 0.5) / SIDE - 1, 1 - 2 * (row + 0.5) / SIDE)
    if found is None:
        return (0, 0, 0)
    ring, number, colour = found
    uneven = random.Random(1000 * ring + number).uniform(0.75, 1.0)
    return tuple(round(c * uneven) for c in colour)


if __name__ == "__main__":
    folder = pathlib.Path(__file__).parent.parent / "window-files"
    folder.mkdir(exist_ok=True)
    write_png(folder / "rose.png", [[texel(c, r) for c in range(SIDE)] for r in range(SIDE)])
