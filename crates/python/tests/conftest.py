"""Scenes that several tests use."""

from __future__ import annotations

import copy
import pathlib
import subprocess
import sys
from typing import Any

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]

BALL: dict[str, Any] = {
    "etalon": 1,
    "camera": {"type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 20},
    "film": {"width": 32, "height": 24},
    "objects": [
        {"name": "ball", "shape": {"type": "sphere", "radius_m": 1}, "material": {"type": "lambert", "reflectance": 0.5}}
    ],
    "lights": [{"type": "environment", "radiance": 1}],
}


@pytest.fixture
def ball() -> dict[str, Any]:
    """A grey ball under an even sky of radiance 1, as a dict of its own. It shows half of the radiance of the sky."""
    return copy.deepcopy(BALL)


@pytest.fixture
def cornell() -> str:
    """The Cornell box."""
    return str(ROOT / "scenes" / "cornell.json")


def command(*words: str, **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs the command line of the package."""
    return subprocess.run(
        [sys.executable, "-m", "etalon", *words], capture_output=True, text=True, check=False, timeout=300, **options
    )
