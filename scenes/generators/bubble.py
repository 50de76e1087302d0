"""Writes scenes/bubble-files/thickness.png: how thick the film of a soap bubble is, from its top to its bottom.

Water runs down: the film grows thicker toward the bottom, and the last of it hangs in uneven folds. Plain standard library.
"""

import math
import pathlib

from vase import write_png

WIDTH, HEIGHT = 128, 256


def share(column, row):
    """The thickness as a share of the largest, at a longitude and a height; rows run from the top."""
    turn, height = 2 * math.pi * (column + 0.5) / WIDTH, 1 - (row + 0.5) / HEIGHT
    # Along the sphere equal steps of the row are equal steps of latitude.
    down = 0.5 - 0.5 * math.sin(math.pi * (height - 0.5))
    folds = math.sin(3 * turn + 9 * down) + 0.6 * math.sin(7 * turn - 17 * down) + 0.4 * math.sin(2 * turn + 31 * down)
    return min(1.0, 0.08 + 0.8 * down + 0.05 * folds * math.sin(math.pi * down))


if __name__ == "__main__":
    folder = pathlib.Path(__file__).parent.parent / "bubble-files"
    folder.mkdir(exist_ok=True)
    grey = [[round(255 * share(c, r)) for c in range(WIDTH)] for r in range(HEIGHT)]
    write_png(folder / "thickness.png", [[(g, g, g) for g in row] for row in grey])
