"""Arbitrary dicts for `etalon.load`, and small renders of those that it takes: each gives a scene or a SceneError, and nothing else.

    python fuzz.py [COUNT] [SEED]
"""

from __future__ import annotations

import copy
import json
import math
import pathlib
import random
import sys
import time
import warnings
from typing import Any

import numpy as np

import etalon

SCENES = pathlib.Path(__file__).resolve().parents[3] / "scenes"

ODD: list[Any] = [
    None, True, False, 0, 1, -1, 2, 0.5, -0.0, 1e-320, 1e308, -1e308, math.nan, math.inf, -math.inf, 10**30, 10**400, "", "a",
    "lambert", "sphere", "environment", "é\u0000", "\ud800", "D65", "N-BK7", "Ag", "../../etc", [], {}, [0, 0, 0], [1, 2], [[1]],
    {"type": "rgb", "rgb": [1, 0, 0]}, {"type": "blackbody", "temperature_k": 3000}, {"type": "constant"}, (1, 2, 3), b"x", object(),
    np.float32(1), np.int8(-1), np.zeros(3), np.array([[1, 2]]), np.nan, {1: 2}, {"type": "mesh", "file": "none.ply"}, 1j, range(3),
]


def places(value: Any, seen: set[int] | None = None) -> list[tuple[Any, Any]]:
    """Every container, once, with every key or index of it."""
    found: list[tuple[Any, Any]] = []
    seen = set() if seen is None else seen
    if id(value) in seen:
        return found
    seen.add(id(value))
    keys = list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        found.append((value, key))
        found += places(value[key], seen)
    return found


def seeds() -> list[dict[str, Any]]:
    """Scenes that say much in few words and name no file beside them."""
    truths = [truth.scene for truth in etalon.oracle.truths() if not truth.files]
    files = [SCENES / f"{name}.json" for name in ("furnace", "metals", "rough", "thin-lens", "polarisers", "prism", "veach-mis")]
    texts = [path.read_text(encoding="utf-8") for path in files if path.exists()]
    return [scene for scene in truths if len(json.dumps(scene)) < 4000] + [
        scene for scene in map(json.loads, texts) if len(json.dumps(scene)) < 8000
    ]


def mutate(scene: dict[str, Any], words: list[str], rng: random.Random) -> Any:
    scene = copy.deepcopy(scene)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        options = places(scene)
        if not options:
            break
        container, key = rng.choice(options)
        match rng.randrange(8):
            case 0:
                del container[key]
            case 1:
                # Sometimes without a copy, which may make a dict that holds itself.
                other, name = rng.choice(options)
                container[key] = other[name] if rng.random() < 0.01 else copy.deepcopy(other[name])
            case 2 if isinstance(container, dict):
                container[rng.choice(words)] = container.pop(key)
            case 3 if isinstance(container, dict):
                container[rng.choice(words)] = copy.deepcopy(rng.choice(ODD))
            case 4 if isinstance(container[key], (int, float)) and abs(container[key]) < 10**300:
                container[key] = container[key] * rng.choice((-1, 0, 1e-9, 1e9, 1e-200, 1e200, 1 + 1e-15))
            case 5 if isinstance(container[key], list) and len(container[key]) < 1000:
                container[key] = container[key] * rng.choice((0, 2, 3))
            case 6:
                container[key] = rng.choice(words)
            case _:
                container[key] = copy.deepcopy(rng.choice(ODD))
    return scene


def check(scene: Any) -> str:
    """What became of it, in a word. Anything that no caller expects is raised."""
    try:
        loaded = etalon.load(scene)
    except etalon.SceneError as error:
        assert error.errors and all(problem.path.startswith("$") and problem.message for problem in error.problems)
        assert str(error)
        return "refused"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            picture = loaded.render(spp=1, size=(4, 3), threads=1)
        assert picture.rgb.shape == (3, 4, 3)
    except (etalon.SceneError, etalon.SettingError):
        return "not rendered"
    return "rendered"


def run(count: int, seed: int = 1, *, tell: bool = False) -> dict[str, int]:
    rng, start = random.Random(seed), time.monotonic()
    scenes = seeds()
    words = sorted({key for scene in scenes for _, key in places(scene) if isinstance(key, str)})
    words += sorted({container[key] for scene in scenes for container, key in places(scene) if isinstance(container[key], str)})
    became: dict[str, int] = {}
    for number in range(count):
        scene = mutate(rng.choice(scenes), words, rng)
        try:
            word = check(scene)
        except BaseException:
            print(f"number {number} of seed {seed}: {scene!r}", file=sys.stderr)
            raise
        became[word] = became.get(word, 0) + 1
        if tell and (number + 1) % 10_000 == 0:
            print(f"{number + 1} dicts after {time.monotonic() - start:.0f} s: {became}", flush=True)
    return became


if __name__ == "__main__":
    given = [int(word) for word in sys.argv[1:]]
    print(run(*(given or [100_000]), tell=True))
