"""Scenes as dicts: what JSON cannot say is found here, everything else by the reader of scene files."""

from __future__ import annotations

import json
import math
import os
from typing import Any

import numpy as np

from ._errors import Problem

MOST_LEVELS = 64
"""Deepest nesting, as in scene files."""
MOST_VALUES = 10_000_000
"""Most values: a dict with lists that share parts may be far larger as text than it is in memory."""


class Plain:
    """A value as JSON text, with the problems of what JSON cannot say."""

    problems: list[Problem]
    text: str

    def __init__(self, value: Any) -> None:
        self.problems = []
        self._count = 0
        # The containers from the root to here, by identity.
        self._open: set[int] = set()
        self.text = json.dumps(self._plain(value, "$", 0), indent=2, allow_nan=False)

    def _refuse(self, path: str, code: str, message: str) -> None:
        self.problems.append(Problem("error", code, path, message, None, None, None))

    def _plain(self, value: Any, path: str, level: int) -> Any:
        if level > MOST_LEVELS:
            self._refuse(path, "limit", f"nested deeper than {MOST_LEVELS} levels")
            return None
        self._count += 1
        if self._count > MOST_VALUES:
            if self._count == MOST_VALUES + 1:
                self._refuse(path, "limit", f"the scene has more than {MOST_VALUES} values")
            return None
        if value is None or isinstance(value, bool):
            return value
        if isinstance(value, str):
            return self._string(str(value), path)
        if isinstance(value, np.longdouble):
            # It has no shorter Python number, and `item` gives it back.
            return self._plain(float(value), path, level)
        if isinstance(value, np.ndarray) and value.dtype == np.longdouble:
            return self._plain(value.astype(np.float64).tolist(), path, level)
        if isinstance(value, np.ndarray):
            return self._plain(value.tolist(), path, level)
        if isinstance(value, np.generic) and not isinstance(value, np.clongdouble):
            return self._plain(value.item(), path, level)
        if isinstance(value, int):
            return self._integer(int(value), path)
        if isinstance(value, float):
            if math.isfinite(value):
                return float(value)
            self._refuse(path, "not-finite", f"{value} is not a finite number")
            return None
        if isinstance(value, os.PathLike):
            return self._string(os.fsdecode(value), path)
        if isinstance(value, (dict, list, tuple)):
            if id(value) in self._open:
                self._refuse(path, "circular", "the value holds itself")
                return None
            self._open.add(id(value))
            plain = self._object(value, path, level) if isinstance(value, dict) else self._list(value, path, level)
            self._open.discard(id(value))
            return plain
        self._refuse(path, "wrong-type", f"a value of type {type(value).__name__} is no JSON value")
        return None

    def _string(self, value: str, path: str) -> Any:
        if is_unicode(value):
            return value
        self._refuse(path, "not-utf-8", "the text has half of a surrogate pair")
        return None

    def _integer(self, value: int, path: str) -> Any:
        # Far beyond every number of a scene; Python itself refuses to print integers of more than 4300 digits.
        if value.bit_length() <= 1024:
            return value
        self._refuse(path, "out-of-range", "the integer has more than 1024 bits")
        return None

    def _list(self, value: list[Any] | tuple[Any, ...], path: str, level: int) -> list[Any]:
        return [self._plain(item, f"{path}[{index}]", level + 1) for index, item in enumerate(value)]

    def _object(self, value: dict[Any, Any], path: str, level: int) -> dict[str, Any]:
        plain = {}
        for key, item in value.items():
            if not isinstance(key, str) or not is_unicode(key):
                self._refuse(path, "wrong-type", f"a key of type {type(key).__name__} is no text")
                continue
            plain[str(key)] = self._plain(item, path + _step(key), level + 1)
        return plain


def is_unicode(text: str) -> bool:
    """Whether text can be written as UTF-8: it has no half of a surrogate pair."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _step(key: str) -> str:
    """A key in a JSON path, as the reader of scene files writes it."""
    return f".{key}" if key.isidentifier() and key.isascii() else f"[{json.dumps(key, ensure_ascii=False)}]"
