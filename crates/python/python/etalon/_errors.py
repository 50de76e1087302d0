"""Exceptions and warnings."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass


class EtalonError(Exception):
    """The base of all exceptions of this package. Files that cannot be opened raise :class:`OSError` instead."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong, or odd, at one place of a scene."""

    severity: str
    """``"error"`` or ``"warning"``."""
    code: str
    """Its kind: a stable name such as ``"unknown-key"``."""
    path: str
    """Where, as a JSON path: ``$.objects[3].shape.radius_m``."""
    message: str
    """What is wrong."""
    hint: str | None
    """What to do about it."""
    line: int | None
    """Line of the text, from 1."""
    column: int | None
    """Column of the text, from 1."""

    def __str__(self) -> str:
        hint = f" ({self.hint})" if self.hint else ""
        return f"{self.path}: {self.message}{hint} [{self.code}]"


class SceneError(EtalonError, ValueError):
    """A scene with errors: all of them at once, in :attr:`problems`."""

    problems: list[Problem]
    """Errors and warnings, in the order of the scene. At least one is an error."""
    name: str
    """The file, or what stands for it."""

    def __init__(self, name: str, problems: Iterable[Problem]) -> None:
        self.name, self.problems = name, list(problems)
        super().__init__(name, self.problems)

    @property
    def errors(self) -> list[Problem]:
        """The problems that are errors."""
        return [problem for problem in self.problems if problem.severity == "error"]

    @property
    def paths(self) -> list[str]:
        """JSON paths of the errors."""
        return [problem.path for problem in self.errors]

    def __str__(self) -> str:
        count = len(self.errors)
        lines = [f"{self.name}: {count} error{'' if count == 1 else 's'}"]
        for problem in self.problems:
            word = "" if problem.severity == "error" else "warning: "
            lines.append(f"  {word}{problem}")
        return "\n".join(lines)


class SettingError(EtalonError, ValueError):
    """An argument that makes no sense."""


class NoLightError(EtalonError):
    """A pilot found no light, so the error of the picture is unknown."""


class PictureError(EtalonError, ValueError):
    """A picture that lacks what is asked for, or a file that is no picture."""


class RenderInterrupted(UserWarning):
    """A render was interrupted, and the picture has what was rendered so far."""


def problems_of(text: str) -> list[Problem]:
    """Problems from the JSON of the native half."""
    return [Problem(**problem) for problem in json.loads(text)]


def scene_error(name: str, text: str) -> SceneError:
    """The exception for the problems of a scene; the native half calls this."""
    return SceneError(name, problems_of(text))
