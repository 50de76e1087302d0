"""Spectra, glasses, metals and colours, as functions on numpy arrays.

Wavelengths are in nm, in vacuum, of any shape; results have the same shape, with a last axis added for colours. Named data are those of
the renderer, so a plot shows what a scene uses.

>>> import numpy as np
>>> from etalon import spectra
>>> nm = np.arange(400, 701, 10)
>>> spectra.glass("N-BK7", 587.5618)
array(1.5168...)
>>> spectra.illuminant("D65", nm).shape
(31,)
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _etalon
from ._errors import SettingError

Floats = npt.NDArray[np.float64]

__all__ = [
    "abbe_number",
    "blackbody",
    "colour_matching",
    "emission_of_rgb",
    "glass",
    "glasses",
    "illuminant",
    "illuminants",
    "metal",
    "metals",
    "reflectance_of_rgb",
    "rgb_to_xyz",
    "srgb_decode",
    "srgb_encode",
    "xyz",
    "xyz_to_rgb",
]


def illuminants() -> list[str]:
    """Names of the illuminants."""
    return _etalon.illuminants()


def illuminant(name: str, wavelengths_nm: npt.ArrayLike) -> Floats:
    """Relative power of a CIE illuminant, normalised to the luminance of the constant spectrum 1."""
    nm = _wavelengths(wavelengths_nm)
    return _like(nm, _etalon.illuminant(_name(name), nm.tobytes()))


def blackbody(temperature_k: float, wavelengths_nm: npt.ArrayLike) -> Floats:
    """Spectral radiance of a black body, W·m⁻²·sr⁻¹·nm⁻¹ (Planck)."""
    nm = _wavelengths(wavelengths_nm)
    return _like(nm, _etalon.blackbody(_real(temperature_k, "temperature_k"), nm.tobytes()))


def glasses() -> list[str]:
    """Names of the glasses and liquids."""
    return _etalon.glasses()


def glass(name: str, wavelengths_nm: npt.ArrayLike, *, clamp: bool = False) -> Floats:
    """Index of refraction of a glass or liquid, by its published Sellmeier formula.

    :param clamp: outside of the range of the formula, take the value at its nearer end; otherwise such a wavelength is an error.
    """
    nm = _wavelengths(wavelengths_nm)
    return _like(nm, _etalon.glass(_name(name), nm.tobytes(), bool(clamp)))


def abbe_number(name: str) -> float:
    """Abbe number of a glass or liquid: (n_d − 1) / (n_F − n_C)."""
    return _etalon.abbe_number(_name(name))


def metals() -> list[str]:
    """Chemical symbols of the metals."""
    return _etalon.metals()


def metal(name: str, wavelengths_nm: npt.ArrayLike, *, clamp: bool = False) -> npt.NDArray[np.complex128]:
    """Complex index n + ik of a metal, as measured; ``clamp`` as in :func:`glass`."""
    nm = _wavelengths(wavelengths_nm)
    found = _like(nm, _etalon.metal(_name(name), nm.tobytes(), bool(clamp)), 2)
    return np.asarray(found[..., 0] + 1j * found[..., 1])


def reflectance_of_rgb(rgb: npt.ArrayLike, wavelengths_nm: npt.ArrayLike) -> Floats:
    """A smooth reflectance from 0 to 1 whose colour under D65 is ``rgb``: linear Rec. 709, shape (3,)."""
    nm = _wavelengths(wavelengths_nm)
    return _like(nm, _etalon.reflectance_of_rgb(_three(rgb), nm.tobytes()))


def emission_of_rgb(rgb: npt.ArrayLike, wavelengths_nm: npt.ArrayLike, *, white: str = "D65") -> Floats:
    """An emission whose colour is ``rgb``: linear Rec. 709, shape (3,). The illuminant ``white`` gives the spectrum its structure."""
    nm = _wavelengths(wavelengths_nm)
    return _like(nm, _etalon.emission_of_rgb(_three(rgb), _name(white), nm.tobytes()))


def colour_matching(wavelengths_nm: npt.ArrayLike) -> Floats:
    """x̄, ȳ and z̄ of the CIE 1931 2° observer: shape (…, 3). Zero outside of 360 to 830 nm."""
    nm = _wavelengths(wavelengths_nm)
    return _like(nm, _etalon.colour_matching(nm.tobytes()), 3)


def xyz(spectrum: npt.ArrayLike, wavelengths_nm: npt.ArrayLike) -> Floats:
    """CIE XYZ of spectra, shape (…, 3), so that the constant spectrum 1 has Y = 1.

    The sum is that of CIE 15: over 1 nm from 360 to 830 nm, with values between the given wavelengths by lines, and 0 outside of them.

    :param spectrum: shape (…, n).
    :param wavelengths_nm: shape (n,), increasing.
    """
    nm = _wavelengths(wavelengths_nm)
    values = _array(spectrum, "spectrum")
    if nm.ndim != 1 or values.ndim < 1 or values.shape[-1] != nm.size or nm.size < 2 or not np.all(np.diff(nm) > 0):
        raise SettingError(f"a spectrum of shape {values.shape} needs as many increasing wavelengths, not {nm.shape}")
    steps = np.arange(360.0, 831.0)
    observer = colour_matching(steps)
    rows = [np.interp(steps, nm, row, left=0.0, right=0.0) for row in values.reshape(-1, nm.size)]
    summed = np.asarray(rows).reshape(-1, steps.size) @ observer / observer[:, 1].sum()
    return np.asarray(summed.reshape(*values.shape[:-1], 3))


def xyz_to_rgb(xyz: npt.ArrayLike) -> Floats:
    """Linear Rec. 709 of CIE XYZ, shape (…, 3)."""
    values = _colours(xyz, "xyz")
    return _like(values, _etalon.xyz_to_rgb(values.tobytes()))


def rgb_to_xyz(rgb: npt.ArrayLike) -> Floats:
    """CIE XYZ of linear Rec. 709, shape (…, 3)."""
    values = _colours(rgb, "rgb")
    return _like(values, _etalon.rgb_to_xyz(values.tobytes()))


def srgb_encode(linear: npt.ArrayLike) -> Floats:
    """The sRGB signal of linear light: 0 to 1 becomes 0 to 1."""
    values = _array(linear, "linear")
    return _like(values, _etalon.srgb_encode(values.tobytes()))


def srgb_decode(signal: npt.ArrayLike) -> Floats:
    """Linear light of an sRGB signal: 0 to 1 becomes 0 to 1."""
    values = _array(signal, "signal")
    return _like(values, _etalon.srgb_decode(values.tobytes()))


def _array(values: npt.ArrayLike, name: str) -> Floats:
    try:
        # Not ascontiguousarray, which makes a list of a number.
        return np.array(values, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise SettingError(f"{name} is no array of numbers: {error}") from None


def _wavelengths(values: npt.ArrayLike) -> Floats:
    nm = _array(values, "wavelengths_nm")
    if not np.all((nm > 0) & np.isfinite(nm)):
        raise SettingError("wavelengths are in nm, above 0 and finite")
    return nm


def _colours(values: npt.ArrayLike, name: str) -> Floats:
    colours = _array(values, name)
    if colours.ndim < 1 or colours.shape[-1] != 3:
        raise SettingError(f"{name} has the shape {colours.shape}, not (…, 3)")
    return colours


def _three(values: npt.ArrayLike) -> tuple[float, float, float]:
    colour = _colours(values, "rgb")
    if colour.shape != (3,):
        raise SettingError(f"rgb has the shape {colour.shape}, not (3,)")
    red, green, blue = (float(value) for value in colour)
    return red, green, blue


def _real(value: Any, name: str) -> float:
    number = _array(value, name)
    if number.shape != ():
        raise SettingError(f"{name} is one number, not an array of shape {number.shape}")
    return float(number)


def _name(value: Any) -> str:
    if not isinstance(value, str):
        raise SettingError(f"a name is text, not {type(value).__name__}")
    return value


def _like(shape: Floats, data: bytearray, *last: int) -> Floats:
    return np.frombuffer(data, dtype=np.float64).reshape((*shape.shape, *last))
