"""Where scenes are from: files, texts and dicts, and the files that these name."""

from __future__ import annotations

import errno
import os
from collections.abc import Mapping
from typing import Any

from . import _etalon
from ._arguments import files_of
from ._decode import Plain
from ._errors import Problem, SceneError, SettingError

THE_SCENE = "the scene"
"""What messages call a scene that is no file."""


class Source:
    """Where a scene is from, so that it can be read with another size: a horizontal angle of view then stays what it is."""

    def __init__(
        self, scene: Any, folder: str | os.PathLike[str] | None, files: Mapping[str, bytes] | None
    ) -> None:
        self.name = THE_SCENE
        # None for the path of a file.
        self._text: str | None = None
        # What JSON cannot say of a dict.
        self._problems: list[Problem] = []
        if isinstance(scene, Mapping):
            plain = Plain(scene if isinstance(scene, dict) else dict(scene))
            self._text, self._problems = plain.text, plain.problems
        elif isinstance(scene, (str, os.PathLike)):
            text = os.fspath(scene)
            if not isinstance(text, str):
                raise SettingError("a path is text, not bytes")
            if isinstance(scene, str) and (text.lstrip().startswith("{") or "\n" in text):
                self._text = text
            else:
                self.name = text
        else:
            raise SettingError(f"a scene is a path, a dict or the text of a scene file, not {type(scene).__name__}")
        self._files = files_of(files)
        if self._text is None and (folder is not None or files is not None):
            raise SettingError("folder and files are for dicts and texts: a scene file finds its files beside itself")
        if folder is not None and files is not None:
            raise SettingError("a scene has its files in a folder or in memory: give folder or files")
        self._folder = os.fspath("." if folder is None else folder)

    def read(self, size: tuple[int, int] | None) -> _etalon.Scene:
        """The scene, with a film of another size if one is given."""
        if self._text is None:
            if not os.path.exists(self.name):
                raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), self.name)
            return _etalon.load(self.name, size)
        if not self._problems:
            return self._parse(self._text, size)
        # What JSON cannot say stands as null in the text: the reader finds all other errors.
        problems = list(self._problems)
        paths = {problem.path for problem in problems}
        try:
            self._parse(self._text, size)
        except SceneError as error:
            problems += [problem for problem in error.problems if problem.path not in paths]
        raise SceneError(self.name, problems)

    def _parse(self, text: str, size: tuple[int, int] | None) -> _etalon.Scene:
        if self._files is None:
            return _etalon.parse(text, self.name, self._folder, size)
        return _etalon.parse_with_files(text, self.name, list(self._files.items()), size)
