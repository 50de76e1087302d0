"""Scenes with known answers, for any renderer.

A :class:`Truth` is plain data: a scene that any renderer can be taught, and the number that the mean of its picture must show. The quantity
is the mean over all pixels of the radiance (W·m⁻²·sr⁻¹·nm⁻¹) that arrives at the pixel, as a linear sensor reads it whose answer to a
constant spectrum of radiance 1 is 1.

>>> from etalon import oracle
>>> truth = oracle.truth("furnace-lambert-sphere")
>>> verdict = oracle.judge(truth, mean=0.7003, error=0.0004)
>>> verdict.passed
True
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _etalon
from ._errors import SettingError

__all__ = ["Truth", "Verdict", "export", "judge", "judge_means", "judge_pixels", "truth", "truths"]


@dataclass(frozen=True)
class Truth:
    """A scene with a known answer."""

    name: str
    """Words joined by hyphens, unique."""
    scene: dict[str, Any]
    """The scene in the neutral form, which is a part of the scene format: ``etalon.load(truth.scene, files=truth.files)`` reads it."""
    files: dict[str, bytes]
    """Meshes and images that the scene names: contents by name. Most scenes name none."""
    value: float
    """What the mean over the pixels of :attr:`crop_px` must be."""
    quantity: str
    """What is read: ``"S0"``, the radiance; the Stokes parameter ``"S1"``, ``"S2"`` or ``"S3"``; ``"meters"``, the mean of the
    scene's meters; or ``"band"``, the mean radiance over a band of wavelengths."""
    band_channel: str | None
    """The channel of that band in a picture's file, such as ``"S0.450,000000nm"``."""
    crop_px: tuple[int, int, int, int] | None
    """The pixels that are read, columns x0 to x1 and rows y0 to y1; all if None."""
    formula: str
    """The formula, with the numbers of this scene."""
    derivation: str
    """Why it holds."""
    mistakes: list[dict[str, Any]]
    """What plausible mistakes would show: ``what`` and ``value``."""
    tolerance: float
    """Absolute deviation that is no error."""
    tolerance_reason: str
    must_resolve: float | None
    """The absolute bias that a reading must be able to see to count."""
    claims: list[str]
    """What a renderer must be able to do, such as ``"dispersion"``."""
    band_nm: tuple[float, float] | None
    """The wavelengths rendered, if the truth holds for them only. A photometric sensor is read relative to :attr:`white_scene` then."""
    white_scene: dict[str, Any] | None
    """The same camera, film and band under a constant sky of radiance 1, where there is a band."""
    width: int
    height: int


@dataclass(frozen=True)
class Verdict:
    """A reading, held to a truth."""

    truth: str
    value: float
    mean: float
    standard_error: float
    passed: bool
    """Whether the reading agrees, and could have seen the mistakes that matter."""
    statistic: float | None
    p: float | None
    resolvable_bias: float | None
    """The smallest absolute bias that this reading would have shown."""
    evidence: str

    def __str__(self) -> str:
        word = "passed" if self.passed else "FAILED"
        return f"{self.truth}: {word}: {self.mean:.8g} ± {self.standard_error:.2g}, truth {self.value:.8g}: {self.evidence}"


_TRUTHS: dict[str, Truth] = {}


def _all() -> dict[str, Truth]:
    """All truths by name, made when they are asked for first."""
    if _TRUTHS:
        return _TRUTHS
    files = _etalon.truth_files()
    for entry in json.loads(_etalon.truths()):
        band = entry["band_nm"]
        names = Truth.__dataclass_fields__
        plain = {name: entry[name] for name in names if name in entry}
        plain["files"] = files.get(entry["name"], {})
        plain["band_nm"] = None if band is None else (band[0], band[1])
        crop = entry["crop_px"]
        plain["crop_px"] = None if crop is None else tuple(crop)
        _TRUTHS[entry["name"]] = Truth(**plain)
    return _TRUTHS


def truths(*parts: str) -> list[Truth]:
    """All truths, or those whose names contain one of ``parts``."""
    return [truth for truth in _all().values() if not parts or any(part in truth.name for part in parts)]


def truth(name: str) -> Truth:
    """The truth of this name."""
    try:
        return _all()[name]
    except (KeyError, TypeError):
        raise SettingError(f"there is no truth {name!r:.60}: see etalon.oracle.truths()") from None


def judge(
    name: str | Truth,
    mean: float,
    error: float,
    *,
    degrees_of_freedom: float | None = None,
    nonfinite: int = 0,
    tests: int = 1,
) -> Verdict:
    """Holds what a renderer measured to a truth.

    It fails when the reading differs by more than noise and the truth's tolerance explain, when a sample was not finite, and when the
    noise is so large that one of the known mistakes could pass.

    :param mean: mean over the pixels of ``crop_px``, or over all if there is none.
    :param error: standard error of ``mean``; 0 for a reading without noise.
    :param degrees_of_freedom: of ``error``; None where it is known well.
    :param nonfinite: samples that were not finite.
    :param tests: how many truths are judged together.
    """
    given = name.name if isinstance(name, Truth) else truth(name).name
    try:
        text = _etalon.judge(
            given,
            float(mean),
            float(error),
            degrees_of_freedom=None if degrees_of_freedom is None else float(degrees_of_freedom),
            nonfinite=int(nonfinite),
            tests=int(tests),
        )
    except (TypeError, OverflowError) as wrong:
        raise SettingError(str(wrong)) from None
    found = json.loads(text)
    # JSON has no NaN.
    found["mean"], found["standard_error"] = float(mean), float(error)
    return Verdict(**found)


def judge_pixels(name: str | Truth, pixels: npt.ArrayLike, errors: npt.ArrayLike, *, tests: int = 1) -> Verdict:
    """Holds a picture to a truth: pixels, and the standard error of each, with noise that is independent from pixel to pixel."""
    values, noise = np.asarray(pixels, dtype=np.float64), np.asarray(errors, dtype=np.float64)
    if values.shape != noise.shape or values.size == 0:
        raise SettingError(f"pixels have the shape {values.shape}, errors {noise.shape}")
    finite = np.isfinite(values) & np.isfinite(noise)
    count = int(finite.sum())
    mean = float(values[finite].mean()) if count else math.nan
    error = float(np.sqrt((noise[finite] ** 2).sum()) / count) if count else math.inf
    return judge(name, mean, error, nonfinite=values.size - count, tests=tests)


def judge_means(name: str | Truth, means: npt.ArrayLike, *, nonfinite: int = 0, tests: int = 1) -> Verdict:
    """Holds several pictures of the same scene with different seeds to a truth: the mean of each, two at least."""
    values = np.asarray(means, dtype=np.float64).ravel()
    if values.size < 2:
        raise SettingError("noise shows from two means on")
    error = float(values.std(ddof=1) / math.sqrt(values.size))
    return judge(
        name, float(values.mean()), error, degrees_of_freedom=values.size - 1, nonfinite=nonfinite, tests=tests
    )


def export(folder: str | os.PathLike[str], names: Iterable[str] | None = None) -> list[str]:
    """Writes the folder with which a renderer in another language joins: a README, the schema of the scenes, the list of truths, a
    scene for each with the files that it names. Gives the paths that were written.

    :param names: truths whose scenes are written; all if not given.
    """
    wanted = None
    if names is not None:
        chosen = [truth(name) for name in names]
        wanted = {f"scenes/{one.name}{ending}" for one in chosen for ending in (".json", ".white.json")}
        wanted |= {f"scenes/{file}" for one in chosen for file in one.files}
    written = []
    for path, contents in _etalon.exchange_files():
        if wanted is not None and path.startswith("scenes/") and path not in wanted:
            continue
        target = os.path.join(os.fspath(folder), *path.split("/"))
        os.makedirs(os.path.dirname(target), exist_ok=True)
        with open(target, "wb") as file:
            file.write(contents)
        written.append(target)
    return written
