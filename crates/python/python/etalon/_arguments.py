"""Arguments of scenes and renders: each is what it should be, or a :class:`SettingError` says what that is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ._decode import is_unicode
from ._errors import SettingError

Bands = tuple[float, float, float]


def names(aov: str | Sequence[str]) -> list[str]:
    """Names of AOVs."""
    given = aov.split(",") if isinstance(aov, str) else aov
    try:
        return [name.strip() for name in given if name.strip()]
    except (AttributeError, TypeError):
        raise SettingError('aov is a name such as "depth", or a list of names') from None


def size_of(size: Any) -> tuple[int, int] | None:
    """Width and height of a film, pixels."""
    if size is None:
        return None
    width, height = listed(size, "size", 2, lambda side: count(side, "size", 1, 2**31 - 1))
    return width, height


def bands_of(bands: Any) -> Bands | None:
    """Centres of the first and the last band and the step between centres, nm."""
    if bands is None:
        return None
    parts = bands.split(":") if isinstance(bands, str) else bands
    first, last, step = listed(parts, "bands", 3, lambda value: number(value, "bands"))
    return first, last, step


def listed(values: Any, name: str, length: int, each: Callable[[Any], Any]) -> list[Any]:
    """A list of this many values, each made by ``each``."""
    try:
        found = list(values)
    except TypeError:
        found = []
    if len(found) != length:
        raise SettingError(f"{name} has {length} numbers")
    return [each(value) for value in found]


def count(value: Any, name: str, least: int, most: int) -> int | None:
    """A whole number within bounds."""
    if value is None:
        return None
    try:
        whole = int(value)
        same = whole == value and not isinstance(value, (bool, str))
    except (TypeError, ValueError, OverflowError):
        raise SettingError(f"{name} is a whole number, not {type(value).__name__}") from None
    if not same:
        raise SettingError(f"{name} is a whole number, not {value!r:.40}")
    if not least <= whole <= most:
        raise SettingError(f"{name} is from {least} to {most}")
    return whole


def index(value: Any, name: str) -> int:
    """A column, row or sample, from 0."""
    whole = count(value, name, 0, 2**32 - 1)
    if whole is None:
        raise SettingError(f"{name} is a whole number, not None")
    return whole


def number(value: Any, name: str) -> float:
    """A number that is no bool."""
    if isinstance(value, bool):
        raise SettingError(f"{name} is a number, not a bool")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise SettingError(f"{name} is a number, not {value!r:.40}") from None


def relative_error(value: Any) -> float:
    """A relative error. 1 and more is nearly always meant in percent."""
    error = number(value, "error")
    if error >= 1:
        raise SettingError(f"error is {error:g}; it is a share of the mean luminance: {error / 100:g} for {error:g} %")
    return error


def files_of(files: Any) -> dict[str, bytes] | None:
    """Files in memory by their names in the scene."""
    if files is None:
        return None
    if not isinstance(files, Mapping):
        raise SettingError(f"files is a dict of names and bytes, not {type(files).__name__}")
    found = {}
    for name, contents in files.items():
        if not isinstance(name, str) or not is_unicode(name):
            raise SettingError(f"files: a name is text, not {name!r:.60}")
        if not isinstance(contents, (bytes, bytearray, memoryview)):
            raise SettingError(f"files: the contents of {name!r:.60} are bytes, not {type(contents).__name__}")
        found[name] = bytes(contents)
    return found
