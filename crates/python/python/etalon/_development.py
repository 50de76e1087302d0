"""Arguments of developments: each is what it should be, or a :class:`SettingError` says what that is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ._errors import SettingError

Rect = tuple[int, int, int, int]


def rect_of(values: Any, name: str) -> Rect:
    """Column, row, width and height of a rectangle of pixels."""
    try:
        x, y, width, height = (int(value) for value in values)
    except (TypeError, ValueError, OverflowError):
        raise SettingError(f"{name} is column, row, width and height in pixels") from None
    if x < 0 or y < 0 or width < 1 or height < 1 or max(x, y, width, height) >= 2**31:
        raise SettingError(f"{name} is column, row, width and height in pixels, all of them within the picture")
    return x, y, width, height


DEFAULTS: dict[str, Any] = {
    "exposure": 0.0,
    "white_balance": None,
    "curve": "linear",
    "scale": 1.0,
    "crop": None,
    "band_nm": None,
    "false_colour": False,
    "error_map": None,
    "range": None,
    "axis": "log",
}
"""What :meth:`etalon.Picture.develop` takes, in its order."""


def development(given: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of a development, as the native half takes them."""
    for name in given:
        if name not in DEFAULTS:
            raise SettingError(f"there is no argument {name!r}: {', '.join(DEFAULTS)}")
    options = DEFAULTS | dict(given)
    for name in ("exposure", "scale", "band_nm"):
        value = options[name]
        if value is None or (name == "exposure" and value == "auto"):
            continue
        try:
            options[name] = float(value)
        except (TypeError, ValueError, OverflowError):
            also = ' or "auto"' if name == "exposure" else ""
            raise SettingError(f"{name} is a number{also}, not {value!r:.40}") from None
    for name in ("curve", "error_map", "axis"):
        if options[name] is not None and not isinstance(options[name], str):
            raise SettingError(f"{name} is a word, not {type(options[name]).__name__}")
    if options["crop"] is not None:
        options["crop"] = rect_of(options["crop"], "crop")
    if options["white_balance"] is not None and not isinstance(options["white_balance"], str):
        options["white_balance"] = rect_of(options["white_balance"], "white_balance")
    if options["range"] is not None:
        try:
            low, high = (float(value) for value in options["range"])
        except (TypeError, ValueError, OverflowError):
            raise SettingError("range is two numbers: the values at the ends of the colour bar") from None
        options["range"] = (low, high)
    return options
