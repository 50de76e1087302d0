"""Pictures: arrays with errors, files, development, comparison."""

from __future__ import annotations

import base64
import errno
import html
import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from . import _development, _etalon
from ._development import DEFAULTS, Rect, rect_of
from ._errors import PictureError, SettingError
from ._results import ChannelTest, Comparison

if TYPE_CHECKING:
    import xarray

Pixels = npt.NDArray[np.float32]
Exposure = float | Literal["auto"]

_COLOURS = ("R", "G", "B")
_AOVS: dict[str, tuple[str, ...]] = {
    "albedo": ("Albedo.R", "Albedo.G", "Albedo.B"),
    "normal": ("N.X", "N.Y", "N.Z"),
    "position": ("P.X", "P.Y", "P.Z"),
    "depth": ("Z",),
    "uv": ("u", "v"),
    "object": ("ObjectId",),
    "variance": ("Variance.R", "Variance.G", "Variance.B"),
}
_BAND = re.compile(r"S0\.([0-9]+(?:,[0-9]+)?)nm")


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The bands of a pixel, or their means over a rectangle."""

    wavelengths_nm: npt.NDArray[np.float64]
    """Shape (band,): centres of the bands, nm."""
    radiance: npt.NDArray[np.float64]
    """Shape (band,): means over each band, W·m⁻²·sr⁻¹·nm⁻¹."""
    error: npt.NDArray[np.float64] | None
    """Shape (band,): standard errors of :attr:`radiance`; infinite where unknown, None without any."""


class Picture:
    """A picture: what a render gives, or what an EXR file holds.

    Arrays have rows from the top first and columns from the left second. They are copies, in 32-bit floats as in the file. Where
    a thing is not there, such as bands that were not asked for, it is None.
    """

    def __init__(self, native: _etalon.Picture, report: Mapping[str, Any] | None = None) -> None:
        self._native = native
        self._report = dict(report or {})
        self._names = native.names
        self._cache: dict[str, Pixels] = {}

    @staticmethod
    def from_arrays(
        rgb: npt.ArrayLike, error: npt.ArrayLike | None = None, *, channels: Mapping[str, npt.ArrayLike] | None = None
    ) -> Picture:
        """A picture of arrays, for instance of another renderer.

        :param rgb: shape (y, x, 3): linear Rec. 709.
        :param error: shape (y, x, 3): standard error of each component.
        :param channels: more channels of shape (y, x) by their names in an EXR file.
        """
        pixels = _as_pixels(rgb, "rgb", (3,))
        named = [(name, pixels[..., index]) for index, name in enumerate(_COLOURS)]
        if error is not None:
            errors = _as_pixels(error, "error", (3,))
            named += [(f"Error.{name}", errors[..., index]) for index, name in enumerate(_COLOURS)]
        for name, values in (channels or {}).items():
            named.append((name, _as_pixels(values, name, ())))
        height, width = pixels.shape[:2]
        for name, values in named:
            if values.shape != (height, width):
                raise PictureError(f"{name} has the shape {values.shape}, rgb is {height} × {width} pixels")
        return Picture(_etalon.Picture(width, height, [(name, values.tobytes()) for name, values in named]))

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return self._native.size

    @property
    def crop(self) -> Rect:
        """Where the pixels are in the whole frame: columns x0 to x1, rows y0 to y1."""
        (x, y), _ = self._native.window
        width, height = self.size
        return x, x + width, y, y + height

    @property
    def names(self) -> list[str]:
        """Names of all channels, as in an EXR file."""
        return list(self._names)

    def channel(self, name: str) -> Pixels:
        """One channel by its name in an EXR file, shape (y, x).

        :raises PictureError: if there is none.
        """
        if name not in self._cache:
            width, height = self.size
            samples = np.frombuffer(self._native.channel(name), dtype=np.float32)
            self._cache[name] = samples.reshape(height, width)
        return self._cache[name].copy()

    def _stack(self, names: Sequence[str]) -> Pixels | None:
        if not all(name in self._names for name in names):
            return None
        return np.stack([self.channel(name) for name in names], axis=-1)

    @property
    def rgb(self) -> Pixels:
        """Shape (y, x, 3): linear Rec. 709. A constant spectrum of radiance 1 W·m⁻²·sr⁻¹·nm⁻¹ has luminance 1.

        :raises PictureError: if the picture has no colour.
        """
        pixels = self._stack(_COLOURS)
        if pixels is None:
            raise PictureError("the picture has no channels R, G and B")
        return pixels

    @property
    def error(self) -> Pixels | None:
        """Shape (y, x, 3): standard error of each component of :attr:`rgb`; infinite where unknown."""
        return self._stack([f"Error.{name}" for name in _COLOURS])

    @property
    def variance(self) -> Pixels | None:
        """Shape (y, x, 3): the square of :attr:`error`."""
        error = self.error
        return None if error is None else error * error

    @property
    def samples(self) -> Pixels | None:
        """Shape (y, x): finite samples of each pixel, where they differ or were asked for."""
        return self.channel("samples") if "samples" in self._names else None

    def _centres(self) -> list[tuple[float, str]]:
        """Centres of the bands, nm, and how channels spell them."""
        found = [(float(match[1].replace(",", ".")), match[1]) for match in map(_BAND.fullmatch, self._names) if match]
        return sorted(found)

    @property
    def wavelengths_nm(self) -> npt.NDArray[np.float64] | None:
        """Shape (band,): centres of the bands, nm."""
        centres = self._centres()
        return np.array([nm for nm, _ in centres]) if centres else None

    @property
    def bands(self) -> Pixels | None:
        """Shape (y, x, band): mean radiance over each band, W·m⁻²·sr⁻¹·nm⁻¹."""
        return self._bands("")

    @property
    def bands_error(self) -> Pixels | None:
        """Shape (y, x, band): standard error of :attr:`bands`; infinite where unknown."""
        return self._bands("Error.")

    def _bands(self, prefix: str) -> Pixels | None:
        centres = self._centres()
        return self._stack([f"{prefix}S0.{text}nm" for _, text in centres]) if centres else None

    @property
    def stokes(self) -> Pixels | None:
        """Shape (y, x, 3, 4): S₀, S₁, S₂ and S₃ of R, G and B, for polarised renders. S₁ is light along the picture's right less that
        along its up; S₂ along the diagonal up to the right less the other; S₃ > 0 is right-handed."""
        return self._stokes("", _COLOURS, "")

    @property
    def stokes_error(self) -> Pixels | None:
        """Shape (y, x, 3, 4): standard error of :attr:`stokes`."""
        return self._stokes("Error.", _COLOURS, "")

    @property
    def stokes_bands(self) -> Pixels | None:
        """Shape (y, x, band, 4): S₀, S₁, S₂ and S₃ of each band, W·m⁻²·sr⁻¹·nm⁻¹."""
        return self._stokes("", [text for _, text in self._centres()], "nm")

    def _stokes(self, prefix: str, parts: Sequence[str], unit: str) -> Pixels | None:
        layers = []
        for parameter in range(4):
            own = "" if parameter == 0 and not unit else f"S{parameter}."
            layers.append(self._stack([f"{prefix}{own}{part}{unit}" for part in parts]) if parts else None)
        found = [layer for layer in layers if layer is not None]
        return np.stack(found, axis=-1) if len(found) == len(layers) else None

    @property
    def aovs(self) -> dict[str, Pixels]:
        """What was asked for by ``aov=``, by name: ``albedo``, ``normal`` and ``position`` of shape (y, x, 3), ``uv`` (y, x, 2),
        ``depth`` in m and ``object`` (y, x). ``object`` counts from 1 in :attr:`objects`, 0 is none."""
        found: dict[str, Pixels] = {}
        for name, channels in _AOVS.items():
            pixels = self._stack(channels)
            if pixels is not None:
                found[name] = pixels[..., 0] if len(channels) == 1 else pixels
        return found

    @property
    def objects(self) -> list[str] | None:
        """Names of the objects, where the AOV ``object`` was asked for."""
        names = self.attributes.get("objectNames")
        return list(json.loads(names)) if isinstance(names, str) else None

    @property
    def attributes(self) -> dict[str, Any]:
        """What the EXR file says beside its channels."""
        return self._native.attributes()

    @property
    def report(self) -> dict[str, Any]:
        """What is known of the render: samples (``spp``), ``seconds``, what ended it (``reached``), ``error``, what was ``predicted``, the
        ``plan``, counts of paths and rays. Empty for files. Numbers that are unknown are None."""
        return self._report

    @property
    def relative_error(self) -> float:
        """The error of the whole picture: the root mean square over all pixels of the standard error of luminance, in units of the mean
        luminance. NaN if it is unknown."""
        stated = self._native.relative_error()
        return stated[0] if stated is not None and np.isfinite(stated[0]) else float("nan")

    @property
    def relative_error_interval(self) -> tuple[float, float]:
        """95 % interval of :attr:`relative_error`; 0 to infinity if it is unknown."""
        stated = self._native.relative_error()
        return (0.0, float("inf")) if stated is None else (stated[1][0], stated[1][1])

    def spectrum(self, x: int, y: int, width: int = 1, height: int = 1) -> Spectrum:
        """The bands of a pixel, or their means over ``width`` × ``height`` pixels from column ``x`` and row ``y``.

        :raises PictureError: if the picture has no bands, or the pixels are not in it.
        """
        rows = self._native.spectrum(rect_of((x, y, width, height), "the rectangle"))
        errors = [error for _, _, error, _ in rows if error is not None]
        return Spectrum(
            np.array([nm for nm, _, _, _ in rows]),
            np.array([mean for _, mean, _, _ in rows]),
            np.array(errors) if len(errors) == len(rows) else None,
        )

    def develop(
        self,
        *,
        exposure: Exposure = 0.0,
        white_balance: str | Rect | None = None,
        curve: Literal["linear", "filmic", "agx"] = "linear",
        scale: float = 1.0,
        crop: Rect | None = None,
        band_nm: float | None = None,
        false_colour: bool = False,
        error_map: Literal["relative", "absolute"] | None = None,
        range: tuple[float, float] | None = None,
        axis: Literal["log", "linear"] = "log",
    ) -> npt.NDArray[np.uint8]:
        """What a screen shows: shape (y, x, 3), 8-bit sRGB.

        :param exposure: stops, each of which doubles the light; ``"auto"`` makes the log-average luminance 18 % grey.
        :param white_balance: the light that looks white: ``"A"``, ``"D50"``, ``"D65"``, ``"E"``, a black body such as ``"3200K"``, or a
            patch of the picture (column, row, width, height).
        :param curve: how bright parts are brought into the range of the screen.
        :param scale: factor on the size, in linear light.
        :param crop: only these pixels: column, row, width, height.
        :param band_nm: the band at this wavelength instead of the colour.
        :param false_colour: the luminance in false colour, with a colour bar.
        :param error_map: the standard error of each pixel in false colour.
        :param range: the values at the two ends of the colour bar.
        :param axis: how values are spread over the colour bar.
        """
        values = (exposure, white_balance, curve, scale, crop, band_nm, false_colour, error_map, range, axis)
        given = _development.development(dict(zip(DEFAULTS, values)))
        width, height, pixels, _ = self._native.develop(given)
        return np.frombuffer(pixels, dtype=np.uint8).reshape(height, width, 3)

    def save(self, path: str | os.PathLike[str], **development: Any) -> None:
        """Writes a file. ``.exr`` keeps all channels and attributes; ``.png`` is what :meth:`develop` gives, with the same arguments. The
        file appears under its name whole or not at all."""
        name = os.fspath(path)
        ending = os.path.splitext(name)[1].lower()
        if ending == ".exr":
            if development:
                raise SettingError("an EXR file keeps the linear picture: development is for .png")
            self._native.write_exr(name)
        elif ending == ".png":
            self._native.write_png(name, _development.development(development))
        else:
            raise SettingError(f"a picture is saved as .exr or .png, not as {os.path.basename(name)!r}")

    def to_xarray(self) -> xarray.Dataset:
        """The picture as an :class:`xarray.Dataset` (needs the package ``xarray``).

        Variables are ``rgb`` (y, x, channel), ``bands`` (y, x, wavelength), ``stokes`` (y, x, channel, parameter) and AOVs, each error beside it
        as ``rgb_error`` and so on. ``x`` and ``y`` are columns and rows of the whole frame.
        """
        import xarray

        x0, x1, y0, y1 = self.crop
        coordinates: dict[str, Any] = {"y": np.arange(y0, y1), "x": np.arange(x0, x1)}
        variables: dict[str, Any] = {}

        def add(name: str, pixels: Pixels | None, dims: tuple[str, ...], unit: str) -> None:
            if pixels is not None:
                variables[name] = (("y", "x", *dims), pixels, {"units": unit})

        radiance = "W m-2 sr-1 nm-1"
        if all(name in self._names for name in _COLOURS):
            add("rgb", self.rgb, ("channel",), radiance)
        add("rgb_error", self.error, ("channel",), radiance)
        add("bands", self.bands, ("wavelength",), radiance)
        add("bands_error", self.bands_error, ("wavelength",), radiance)
        add("stokes", self.stokes, ("channel", "parameter"), radiance)
        add("stokes_error", self.stokes_error, ("channel", "parameter"), radiance)
        add("stokes_bands", self.stokes_bands, ("wavelength", "parameter"), radiance)
        add("samples", self.samples, (), "1")
        dims = {"albedo": ("channel",), "variance": ("channel",), "normal": ("axis",), "position": ("axis",), "uv": ("texture",)}
        units = {"position": "m", "depth": "m", "variance": f"({radiance})^2"}
        for name, pixels in self.aovs.items():
            add(name, pixels, dims.get(name, ()), units.get(name, "1"))
        used = {dim for variable in variables.values() for dim in variable[0]}
        labels = {"channel": list(_COLOURS), "parameter": ["S0", "S1", "S2", "S3"], "axis": list("xyz"), "texture": list("uv")}
        coordinates |= {dim: label for dim, label in labels.items() if dim in used}
        if "wavelength" in used:
            coordinates["wavelength"] = ("wavelength", self.wavelengths_nm, {"units": "nm"})
        attributes = {name: value for name, value in self.attributes.items() if isinstance(value, (str, int, float))}
        return xarray.Dataset(variables, coordinates, attributes)

    def __repr__(self) -> str:
        width, height = self.size
        return f"<etalon.Picture {width} × {height} pixels, {self._describe()}>"

    def _describe(self) -> str:
        parts = []
        if "spp" in self._report:
            parts.append(f"{self._report['spp']} samples in {self._report['seconds']:.3g} s")
        if np.isfinite(self.relative_error):
            low, high = self.relative_error_interval
            interval = f" (95 % sure: {100 * low:.2g} to {100 * high:.2g} %)" if np.isfinite(high) else ""
            parts.append(f"error {100 * self.relative_error:.2g} %{interval}")
        else:
            parts.append("error unknown")
        centres = self._centres()
        if centres:
            parts.append(f"{len(centres)} bands")
        return ", ".join(parts)

    def _repr_png_(self) -> bytes | None:
        try:
            return self._native.png(_development.development({}))
        except PictureError:
            return None

    def _repr_html_(self) -> str:
        images = []
        for title, given in (("", {}), ("relative standard error", {"error_map": "relative"})):
            try:
                data = base64.b64encode(self._native.png(_development.development(given))).decode()
            except PictureError:
                # A picture without colour, or without errors.
                continue
            images.append(f'<img alt="{title or "the picture"}" title="{title}" src="data:image/png;base64,{data}">')
        return f"<figure>{' '.join(images)}<figcaption>{html.escape(self._describe())}</figcaption></figure>"


def read(path: str | os.PathLike[str]) -> Picture:
    """Reads an EXR file, of Etalon or of another program, or the linear colours of a PNG file.

    :raises OSError: if the file cannot be read.
    :raises PictureError: if it is no picture.
    """
    name = os.fspath(path)
    if not os.path.exists(name):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), name)
    return Picture(_etalon.read(name))


def compare(
    image: Picture | str | os.PathLike[str],
    reference: Picture | str | os.PathLike[str],
    *,
    significance: float = 1e-3,
    tile: int = 4,
    exposure: float = 0.0,
) -> Comparison:
    """How far apart two pictures are, and whether that is more than their noise, by Welch's t-test on tiles.

    :param image: a picture or a file.
    :param reference: the picture that it is held against: relative measures are in units of this one.
    :param significance: probability of calling two pictures of the same thing different.
    :param tile: side of the smallest tiles, pixels. Tiles of two, four and eight times that are tested too, and the whole picture.
    :param exposure: exposure for FLIP, stops.

    :raises PictureError: if the sizes differ, or there is no colour.
    """
    pictures = [value if isinstance(value, Picture) else read(value) for value in (image, reference)]
    width, height = pictures[0].size
    try:
        text, flip_map = _etalon.compare(
            pictures[0]._native, pictures[1]._native, significance=significance, tile=tile, exposure=exposure
        )
    except (TypeError, OverflowError) as error:
        raise SettingError(str(error)) from None
    found = json.loads(text)
    test = found["test"] or {}
    return Comparison(
        verdict=found["verdict"],
        rmse=found["rmse"],
        rel_mse=found["rel_mse"],
        flip=found["flip"],
        significance=test.get("significance"),
        accepted_from=test.get("accepted_from"),
        channels=[ChannelTest(**channel) for channel in test.get("channels", [])],
        non_finite=found["non_finite"],
        note=found["note"],
        flip_map=np.frombuffer(flip_map, dtype=np.float64).reshape(height, width),
    )


def _as_pixels(values: npt.ArrayLike, name: str, last: tuple[int, ...]) -> Pixels:
    try:
        pixels = np.ascontiguousarray(values, dtype=np.float32)
    except (TypeError, ValueError) as error:
        raise PictureError(f"{name} is no array of numbers: {error}") from None
    if pixels.ndim != 2 + len(last) or pixels.shape[2:] != last:
        wanted = "(y, x, 3)" if last else "(y, x)"
        raise PictureError(f"{name} has the shape {pixels.shape}, not {wanted}")
    return pixels
