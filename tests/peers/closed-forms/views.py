"""What a camera sees of the plane z = 0 under a lamp, point by point; and the cases that are made of it."""

from dataclasses import dataclass, field

import numpy as np

from foreign import Gltf, looking, unit

# Pixels of a side, and points of a side of a pixel at which formulas are taken: their mean is the pixel, for a filter of one pixel.
SIZE, POINTS = 24, 6


@dataclass
class Case:
    """A scene, what its format says of the picture, and what Etalon's documentation says of it where that differs."""

    name: str
    scene: object
    # A number, or an array of pixels, perhaps with three channels.
    expected: object
    # Words of `reasons.py` for a difference from `expected`, and what Etalon shows by its documentation.
    why: str | None = None
    own: object = None
    spp: int = 64
    # Options of `etalon import`, where the scene is imported first.
    imported: list = field(default_factory=list)


@dataclass
class View:
    """A perspective or orthographic camera, and a lamp at a point."""

    eye: tuple
    lamp: tuple
    yfov: float
    candela: float = 20.0

    def directions(self):
        """Of every point that is seen: its place, the directions to eye and lamp, and the illuminance there, lx."""
        places, o = self.places()
        toward = np.asarray(self.lamp) - places
        squared = (toward**2).sum(-1)
        i = unit(toward)
        return places, o, i, self.candela * np.maximum(i[..., 2], 0) / squared

    def places(self):
        tan = np.tan(0.5 * self.yfov)
        rows = (np.arange(SIZE * POINTS) + 0.5) / (SIZE * POINTS)
        x, y = np.meshgrid(tan * (2 * rows - 1), tan * (1 - 2 * rows))
        matrix = looking(self.eye, (0, 0, 0))
        ray = unit(np.stack([x, y, -np.ones_like(x)], -1)) @ matrix[:3, :3].T
        places = np.asarray(self.eye) - ray * (self.eye[2] / ray[..., 2])[..., None]
        return places, -ray

    def picture(self, f):
        """Radiances of pixels of a surface that reflects f(o, i)."""
        _, o, i, lux = self.directions()
        found = f(o, i)
        return pixels(found * (lux if found.ndim == 2 else lux[..., None]))

    def model(self):
        """A glTF model with this camera and this lamp."""
        model = Gltf()
        model.camera(self.eye, yfov=self.yfov)
        model.lamp("point", self.candela, self.lamp)
        return model


def pixels(points):
    """Means of the points of every pixel."""
    rest = points.shape[2:]
    return points.reshape(SIZE, POINTS, SIZE, POINTS, *rest).mean((1, 3))


def at_angle(degrees, distance, y=0.0):
    return (distance * np.sin(np.radians(degrees)), y, distance * np.cos(np.radians(degrees)))


# From above, with the highlight beside the middle; and along the surface, toward the lamp, with the highlight in the middle.
STEEP = View(eye=(0.4, 0.1, 5.0), lamp=(0.8, 0.5, 3.0), yfov=0.4)
OBLIQUE = View(eye=at_angle(65, 5), lamp=at_angle(-55, 3, 0.2), yfov=0.2)
VIEWS = {"from above": STEEP, "at 65°": OBLIQUE}
