"""What is found about scenes and pictures: quotes, explanations, replays, comparisons."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Cost:
    """What one error costs on this machine."""

    error: float
    """The relative error of the picture."""
    samples: float
    """Samples a pixel."""
    samples_interval: tuple[float, float]
    """95 % interval of :attr:`samples`."""
    seconds: float
    """Seconds of rendering."""
    seconds_interval: tuple[float, float]
    """95 % interval of :attr:`seconds`."""


@dataclass(frozen=True)
class Quote:
    """What accuracy will cost: see :meth:`etalon.Scene.quote`."""

    costs: list[Cost]
    """One for each error that was asked for, in that order."""
    pilot_seconds: float
    """Seconds that the pilot took."""
    exploration: dict[str, Any] | None
    """What an exploration found of where the error is, if one was wanted: ``predicted_gain``, ``used``, ``seconds``."""
    settling_share: float
    """What a render to an error takes beside the seconds of a cost, as a share of them."""

    def cost(self, error: float) -> Cost:
        """The cost of one of the errors that were asked for."""
        for cost in self.costs:
            if cost.error == error:
                return cost
        raise KeyError(error)

    def __str__(self) -> str:
        lines = [f"{'error':>8} {'samples':>9}  {'(95 % sure)':<20} {'time':>10}  (95 % sure)"]
        for cost in self.costs:
            low, high = cost.samples_interval
            samples = f"{low:.0f} to {high:.0f}"
            first, last = cost.seconds_interval
            seconds = f"{_duration(first)} to {_duration(last)}"
            lines.append(
                f"{_percent(cost.error):>8} {cost.samples:>9.0f}  {samples:<20} {_duration(cost.seconds):>10}  {seconds}"
            )
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{_percent(cost.error)}</td><td>{cost.samples:.0f}</td>"
            f"<td>{cost.samples_interval[0]:.0f} to {cost.samples_interval[1]:.0f}</td>"
            f"<td>{_duration(cost.seconds)}</td>"
            f"<td>{_duration(cost.seconds_interval[0])} to {_duration(cost.seconds_interval[1])}</td></tr>"
            for cost in self.costs
        )
        head = "<tr><th>error</th><th>samples</th><th>95 % sure</th><th>time</th><th>95 % sure</th></tr>"
        return f"<table>{head}{rows}</table>"


@dataclass(frozen=True)
class Effect:
    """An effect of light, and why it is simulated or not."""

    name: str
    on: bool
    because: str
    """The object and the number that call for it, or why nothing does."""

    def __str__(self) -> str:
        return f"{self.name:<18} {'on' if self.on else 'off':<4} {self.because}"


@dataclass(frozen=True)
class Explanation:
    """How a scene is rendered, and why: see :meth:`etalon.Scene.explain`."""

    effects: list[Effect]
    plan: dict[str, Any]
    """The whole plan: kernel, lanes, sampler, depth, wavelengths, light that no path finds."""
    objects: list[str]
    """Names of all objects. The AOV ``object`` counts from 1 for the first."""

    def __getitem__(self, name: str) -> Effect:
        for effect in self.effects:
            if effect.name == name:
                return effect
        raise KeyError(name)

    def __str__(self) -> str:
        return "\n".join(map(str, self.effects))

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(str(self))}</pre>"


@dataclass(frozen=True, eq=False)
class Replay:
    """One path, vertex by vertex: see :meth:`etalon.Scene.replay`."""

    wavelengths_nm: Floats
    """Shape (n,), nm; the first is the hero."""
    radiance: Floats
    """Shape (n,): the estimate at each wavelength, W·m⁻²·sr⁻¹·nm⁻¹."""
    stokes: Floats | None
    """Shape (3, n): S₁, S₂ and S₃ at each wavelength; None where light is not followed with its polarisation."""
    xyz: Floats
    """Shape (3,): what the sample adds to the pixel, CIE XYZ."""
    events: list[dict[str, Any]]
    """What happened, in order. ``event`` is one of these, with the number ``vertex`` of the place in all but the last:

    - ``"vertex"``, a surface is met: ``object``, ``position_m``, and ``beta``, the throughput of the path so far at each wavelength;
    - ``"scattering"``, a medium scatters the path: ``position_m``, ``beta``;
    - ``"fluorescence"``, a surface fluoresces: ``excitation_nm``, the wavelengths that the path carries from here on;
    - ``"light"``, light is added: ``found`` says how, ``radiance`` how much at each wavelength, ``luminance`` its part of the sample's Y;
    - ``"end"``: ``because``.
    """

    def __str__(self) -> str:
        return "\n".join(map(_told, self.events))


def _told(event: dict[str, Any]) -> str:
    """An event of a replay, in a line."""
    kind = event["event"]
    if kind in ("vertex", "scattering"):
        x, y, z = event["position_m"]
        what = repr(event["object"]) if kind == "vertex" else "a medium scatters"
        return f"vertex {event['vertex']}: {what} at ({x:.6g}, {y:.6g}, {z:.6g}) m"
    if kind == "light":
        return f"  light by {event['found']}: {np.mean(event['radiance']):.6g} in the mean"
    if kind == "fluorescence":
        return f"  fluorescence, excited at {', '.join(f'{nm:.4g}' for nm in event['excitation_nm'])} nm"
    return f"end: {event['because']}"


@dataclass(frozen=True)
class ChannelTest:
    """Whether one channel of two pictures differs beyond its noise."""

    channel: str
    tiles: int
    """Smallest tiles that were tested."""
    untested_tiles: int
    """Smallest tiles in which the error of a pixel is not known."""
    worst: dict[str, Any] | None
    """The tile with the smallest p-value: ``crop`` (columns x0 to x1, rows y0 to y1), ``means``, ``t``, ``p``."""
    p_worst: float
    """Probability that the worst tile is that bad if the pictures show the same."""
    p_spread: float
    """Probability that this many tiles are that bad together if the pictures show the same."""
    scales: list[dict[str, Any]]
    """The test of each size of tiles: ``side`` in pixels (None for the whole picture), ``tiles``, ``untested_tiles``, ``skewed_tiles``,
    ``worst``, ``p_worst``, ``p_spread`` and ``seen``, the relative change ``in_one_tile`` or ``in_all_tiles`` that would have been found with
    probability 0.9."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two pictures, compared: see :func:`etalon.compare`."""

    verdict: Literal["equal", "within-noise", "differ", "untested"]
    """``"untested"`` where errors are not known, so that the difference may be noise or not."""
    rmse: float
    rel_mse: float
    """Mean square difference in units of the squares of the reference."""
    flip: float
    """Mean of :attr:`flip_map`: 0 looks alike, 1 does not."""
    significance: float | None
    """Probability of calling two pictures of the same thing different; None without a test."""
    accepted_from: float | None
    """Below this p a channel's question is answered "different"; None without a test."""
    channels: list[ChannelTest]
    """Empty without a test."""
    non_finite: dict[str, Any] | None
    """``pixels`` and the ``first``, where a value is not finite."""
    note: str | None
    """Why there is no test, or why it must not be believed."""
    flip_map: Floats = field(repr=False)
    """Shape (y, x): how different each pixel looks."""

    def __str__(self) -> str:
        lines = [f"{self.verdict}: RMSE {self.rmse:.4g}, relative MSE {self.rel_mse:.4g}, FLIP {self.flip:.4g}"]
        for channel in self.channels:
            lines.append(f"  {channel.channel}: p {channel.p_worst:.2g} for the worst tile, {channel.p_spread:.2g} for all")
        if self.note:
            lines.append(f"  {self.note}")
        return "\n".join(lines)


def _percent(error: float) -> str:
    return f"{100 * error:.3g} %"


def _duration(seconds: float) -> str:
    if not math.isfinite(seconds):
        return "unknown"
    if seconds < 90:
        return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.3g} h"


def known(value: float | None) -> float:
    """A number of JSON, where null stands for one that is unknown: NaN."""
    return math.nan if value is None else value


def pair(values: Sequence[float | None]) -> tuple[float, float]:
    """An interval of JSON, where null stands for an end that is unknown: infinity."""
    low, high = (math.inf if value is None else value for value in values)
    return low, high
