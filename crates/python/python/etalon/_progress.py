"""A progress bar by the conventions of tqdm."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from types import TracebackType
from typing import Any


class Bar:
    """Shows how many camera paths are traced, in a terminal or in Jupyter. ``show`` None shows it where somebody sees it."""

    tick: Callable[[int, int], None] | None

    def __init__(self, show: bool | None) -> None:
        self._bar: Any = None
        self.tick = self._tick if (seen() if show is None else show) else None

    def _tick(self, done: int, planned: int) -> None:
        if self._bar is None:
            self._bar = _tqdm()(unit="paths", unit_scale=True, desc="pilot", leave=False, dynamic_ncols=True)
        bar = self._bar
        if planned and bar.total != planned:
            bar.reset(total=planned)
            bar.set_description("render", refresh=False)
        bar.n = min(done, planned) if planned else done
        bar.refresh()

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.close()


def in_jupyter() -> bool:
    """Whether this runs in the kernel of a notebook."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return shell is not None and "IPKernelApp" in shell.config


def seen() -> bool:
    """Whether somebody sees a bar."""
    return in_jupyter() or (sys.stderr is not None and sys.stderr.isatty())


def _tqdm() -> Any:
    with warnings.catch_warnings():
        # Without ipywidgets it shows text, which is as good.
        warnings.simplefilter("ignore")
        from tqdm.auto import tqdm
    return tqdm
