"""Scenes: read, quoted, explained, rendered."""

from __future__ import annotations

import json
import os
import time as clock
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypedDict

import numpy as np

from . import _etalon
from ._arguments import Bands, bands_of, count, index, listed, names, number, relative_error, size_of
from ._errors import Problem, RenderInterrupted, SettingError, problems_of
from ._picture import Picture
from ._progress import Bar
from ._results import Cost, Effect, Explanation, Quote, Replay, known, pair
from ._source import Source

if TYPE_CHECKING:
    from typing_extensions import Unpack

MOST_THREADS = 4096


@dataclass(frozen=True)
class Progress:
    """How far a render is: what a function given as ``progress`` is called with, about twenty times a second."""

    paths: int
    """Camera paths that are traced."""
    planned: int | None
    """Camera paths of the whole picture; None as long as a pilot finds out how many."""
    seconds: float
    """Seconds since the render began."""


class Settings(TypedDict, total=False):
    """What :meth:`Scene.render` and :meth:`Scene.passes` take by name, beside the error; :meth:`Scene.render` says what each means."""

    spp: int | None
    time: float | None
    bands: Bands | str | None
    aov: str | Sequence[str]
    size: tuple[int, int] | None
    crop: tuple[int, int, int, int] | None
    seed: int | None
    max_depth: int | None
    replicates: int | None
    polarised: bool
    adaptive: Literal["auto", "always", "never"]
    threads: int | None


def load(
    scene: str | os.PathLike[str] | Mapping[str, Any],
    *,
    folder: str | os.PathLike[str] | None = None,
    files: Mapping[str, bytes] | None = None,
    size: tuple[int, int] | None = None,
) -> Scene:
    """Reads a scene.

    ``scene`` is the path of a scene file (``.json``) or of a model or scene of another program (glTF 2.0, OBJ, PLY, Mitsuba 3,
    pbrt-v4), a dict with what a scene file says, or the text of a scene file: a str that begins with ``{``, or has several lines.
    Numbers and lists in a dict may be numpy arrays.

    :param folder: where a dict or text finds the meshes and images that it names; the current folder if not given.
    :param files: the meshes and images that a dict or text names, in memory: contents by name, each at most 4 GiB. No file is read from
        the disk then.
    :param size: another width and height of the film, pixels.

    :raises SceneError: if the scene is not valid; it has every error at once, each with its JSON path.
    :raises SettingError: if an argument makes no sense.
    :raises OSError: if the file cannot be read.

    >>> scene = etalon.load({
    ...     "etalon": 1,
    ...     "camera": {"type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
    ...     "film": {"width": 64, "height": 48},
    ...     "objects": [{"shape": {"type": "sphere", "radius_m": 1}, "material": {"type": "lambert", "reflectance": 0.5}}],
    ...     "lights": [{"type": "environment", "radiance": 1}],
    ... })
    """
    source = Source(scene, folder, files)
    return Scene(source.read(size_of(size)), source)


def schema() -> dict[str, Any]:
    """The JSON Schema of scene files."""
    found: dict[str, Any] = json.loads(_etalon.schema())
    return found


class Scene:
    """A scene without errors: see :func:`load`."""

    def __init__(self, native: _etalon.Scene, source: Source) -> None:
        self._native, self._source = native, source
        self._ready: tuple[Any, _etalon.Renderer] | None = None
        self._notes: dict[str, Any] = json.loads(native.notes())

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the film, pixels."""
        return self._native.size

    @property
    def name(self) -> str:
        """The name in messages: the path, for files."""
        return self._native.name

    @property
    def sha256(self) -> str:
        """SHA-256, in hex, of the text and of all files that it refers to."""
        return self._native.sha256

    @property
    def text(self) -> str:
        """The scene as the text of a scene file."""
        return self._native.text

    @property
    def warnings(self) -> list[Problem]:
        """What is odd in the scene and not an error."""
        return problems_of(json.dumps(self._notes["warnings"]))

    @property
    def added(self) -> list[str]:
        """What a scene has that its model does not say, such as a camera or a light. Empty for scene files."""
        return list(self._notes["added"])

    @property
    def left_out(self) -> list[tuple[str, str]]:
        """What a model says and its scene does not: place and what becomes of it. Empty for scene files."""
        return [(left["place"], left["what"]) for left in self._notes["left_out"]]

    def __repr__(self) -> str:
        width, height = self.size
        return f"<etalon.Scene {self.name!r}, {width} × {height} pixels>"

    def _renderer(
        self,
        size: tuple[int, int] | None = None,
        bands: Bands | str | None = None,
        seed: int | None = None,
        max_depth: int | None = None,
        replicates: int | None = None,
        polarised: bool = False,
    ) -> _etalon.Renderer:
        """The scene, ready with these settings. The last one is kept, for to make a scene ready may take long."""
        wanted = size_of(size)
        kept = bands_of(bands)
        key = (wanted, kept, seed, max_depth, replicates, bool(polarised))
        if self._ready is None or self._ready[0] != key:
            native = self._native if wanted in (None, self.size) else self._source.read(wanted)
            renderer = native.prepare(
                bands=kept,
                seed=count(seed, "seed", 0, 2**64 - 1),
                max_depth=count(max_depth, "max_depth", 1, 2**32 - 1),
                replicates=count(replicates, "replicates", 1, 2**32 - 1),
                polarised=bool(polarised),
            )
            self._ready = (key, renderer)
        return self._ready[1]

    def _begin(self, error: float | None, settings: Settings) -> tuple[_etalon.Renderer, dict[str, Any]]:
        """The scene, ready, and the settings of a render as the native half takes them."""
        for name in settings.keys() - Settings.__annotations__.keys():
            raise TypeError(f"there is no argument {name!r}: error, {', '.join(Settings.__annotations__)}")
        renderer = self._renderer(
            settings.get("size"),
            settings.get("bands"),
            settings.get("seed"),
            settings.get("max_depth"),
            settings.get("replicates"),
            settings.get("polarised", False),
        )
        return renderer, _wanted(error, settings)

    def render(
        self,
        error: float | None = None,
        *,
        progress: bool | Callable[[Progress], object] | None = None,
        **settings: Unpack[Settings],
    ) -> Picture:
        """Renders the scene. The first limit that is reached ends the render: ``error``, ``spp`` or ``time``.

        :param error: the relative error that is enough, such as 0.01: the root mean square over all pixels of the standard error of
            luminance, in units of the picture's mean luminance.
        :param spp: most samples a pixel. Without any limit it is the scene's own number.
        :param time: seconds that are enough.
        :param bands: centres of the first and the last band of wavelengths that are kept and the step between centres, nm, such as
            ``(400, 700, 10)``.
        :param aov: what else the picture holds: ``albedo``, ``normal``, ``position``, ``depth``, ``uv``, ``object`` of the first
            surface, ``samples``, ``variance``.
        :param size: another width and height of the picture, pixels.
        :param crop: only these pixels: columns x0 to x1, rows y0 to y1, both from the top left.
        :param seed: seed of every random number. Pictures of different seeds have independent noise.
        :param max_depth: most path edges from the camera to a light.
        :param replicates: independent replicates, whose scatter is the error; 1 is without.
        :param polarised: follow light with its polarisation; the picture then has :attr:`Picture.stokes`.
        :param adaptive: whether regions with more error take more samples: ``"auto"`` decides by what it would save, ``"always"`` and
            ``"never"`` do as they say.
        :param threads: threads; all cores if not given. The pixels are the same for any number.
        :param progress: True shows a bar, False none, None shows one in a terminal or in Jupyter. A function is called with
            :class:`Progress`; an exception that it raises ends the render.

        The interpreter's lock is released. Ctrl-C ends the render: the picture then has what was rendered so far, its report says
        ``"interrupted"``, and a :class:`RenderInterrupted` warning is given. KeyboardInterrupt is raised if there is no sample yet.

        :raises SettingError: if an argument makes no sense.
        :raises NoLightError: if only the error is to end the render, and no light is found.
        """
        renderer, wanted = self._begin(error, settings)
        start = clock.monotonic()
        if callable(progress):
            tell = progress

            def tick(done: int, planned: int) -> None:
                tell(Progress(done, planned or None, clock.monotonic() - start))

            native, report, interrupted = renderer.render(wanted, tick)
        else:
            with Bar(progress) as bar:
                native, report, interrupted = renderer.render(wanted, bar.tick)
        picture = Picture(native, json.loads(report))
        if interrupted:
            text = f"interrupted after {picture.report['spp']} samples a pixel: the picture has what there is"
            warnings.warn(text, RenderInterrupted, stacklevel=2)
        return picture

    def passes(self, error: float | None = None, **settings: Unpack[Settings]) -> Iterator[Picture]:
        """Renders the scene and gives the picture after each pass; the last is that of :meth:`render`.

        The arguments are those of :meth:`render`, without ``progress``. Each picture is that of all samples so far. Only the last has the AOVs of the first
        surface. The render waits as long as a picture is looked at. To stop, leave the loop.

        >>> for picture in scene.passes(spp=1024):
        ...     if picture.relative_error < 0.02:
        ...         break
        """
        renderer, wanted = self._begin(error, settings)
        return _pictures(renderer.passes(wanted))

    def quote(
        self,
        errors: float | Sequence[float] = (0.1, 0.05, 0.02, 0.01, 0.005, 0.001),
        *,
        pilot: float = 10.0,
        size: tuple[int, int] | None = None,
        bands: Bands | str | None = None,
        seed: int | None = None,
        adaptive: Literal["auto", "always", "never"] = "auto",
        threads: int | None = None,
    ) -> Quote:
        """What accuracy will cost in samples and seconds on this machine, by a pilot of at most ``pilot`` seconds.

        :param errors: relative errors, such as 0.01.

        :raises NoLightError: if the pilot finds no light.
        """
        renderer = self._renderer(size, bands, seed)
        wanted = list(errors) if isinstance(errors, (Sequence, np.ndarray)) and not isinstance(errors, str) else [errors]
        found = json.loads(
            renderer.quote(
                errors=[relative_error(error) for error in wanted],
                pilot_seconds=number(pilot, "pilot"),
                adaptive=adaptive,
                threads=count(threads, "threads", 1, MOST_THREADS),
            )
        )
        costs = [
            Cost(
                cost["error"],
                known(cost["samples"]),
                pair(cost["samples_interval"]),
                known(cost["seconds"]),
                pair(cost["seconds_interval"]),
            )
            for cost in found["estimates"]
        ]
        return Quote(costs, found["pilot_seconds"], found["exploration"], found["settling_share"])

    def explain(self, *, polarised: bool = False) -> Explanation:
        """Which effects of light are simulated, and because of which object and number."""
        renderer = self._renderer(polarised=polarised)
        plan = json.loads(renderer.plan())
        effects = [Effect(effect["name"], effect["on"], effect["because"]) for effect in plan["effects"]]
        return Explanation(effects, plan, renderer.object_names())

    def replay(
        self,
        x: int,
        y: int,
        sample: int = 0,
        *,
        size: tuple[int, int] | None = None,
        seed: int | None = None,
        polarised: bool = False,
    ) -> Replay:
        """One path of the pixel in column ``x`` and row ``y``, vertex by vertex; ``sample`` counts from 0."""
        renderer = self._renderer(size=size, seed=seed, polarised=polarised)
        found = json.loads(renderer.replay(index(x, "x"), index(y, "y"), index(sample, "sample")))
        stokes = found.get("stokes")
        return Replay(
            _array(found["wavelengths_nm"]),
            _array(found["radiance"]),
            None if stokes is None else _array(stokes),
            _array(found["xyz"]),
            found["events"],
        )


def _pictures(passes: _etalon.Passes) -> Iterator[Picture]:
    try:
        for native, report in passes:
            yield Picture(native, json.loads(report))
    finally:
        passes.close()


def _array(values: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.asarray(values, dtype=np.float64)


def _wanted(error: float | None, settings: Settings) -> dict[str, Any]:
    adaptive = settings.get("adaptive", "auto")
    if not isinstance(adaptive, str):
        raise SettingError('adaptive is "auto", "always" or "never"')
    time, crop = settings.get("time"), settings.get("crop")
    return {
        "samples": count(settings.get("spp"), "spp", 1, 2**31 - 1),
        "error": None if error is None else relative_error(error),
        "seconds": None if time is None else number(time, "time"),
        "adaptive": adaptive,
        "threads": count(settings.get("threads"), "threads", 1, MOST_THREADS),
        "crop": None if crop is None else listed(crop, "crop", 4, lambda value: count(value, "crop", 0, 2**32 - 1)),
        "channels": names(settings.get("aov", ())),
        "only": False,
    }
