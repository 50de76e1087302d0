"""Arbitrary arguments: each gives an answer or an exception that is documented. `tests/python.sh --fuzz` tries many more."""

from __future__ import annotations

import random

import numpy as np
import pytest

import etalon
import fuzz
from etalon import oracle, spectra


def test_arbitrary_dicts_give_a_scene_or_its_errors():
    became = fuzz.run(2000, seed=7)
    assert became["refused"] > 1000 and became["rendered"] > 60, became


def test_arbitrary_texts_give_a_scene_or_its_errors():
    rng = random.Random(3)
    text = etalon.load(fuzz.seeds()[0]).text
    for _ in range(500):
        at = rng.randrange(len(text))
        changed = "{" + text[1:at] + rng.choice(["", "{", "}", '"', "\\", "\x00", "é", ",", "1e999", "//"]) + text[at + rng.randrange(3) :]
        try:
            etalon.load(changed)
        except etalon.SceneError as error:
            assert error.errors


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_arbitrary_arguments_give_an_answer_or_an_exception_of_ours():
    rng = random.Random(5)
    scene = etalon.load(fuzz.seeds()[1], size=(4, 3))
    picture = scene.render(spp=1, bands=(500, 600, 50))
    odd = [value for value in fuzz.ODD if not isinstance(value, str) or "\x00" not in value]
    small = [value for value in odd if not isinstance(value, (int, float, np.generic)) or isinstance(value, bool) or not abs(value) > 64]
    truth = oracle.truths()[0]
    calls = [
        lambda: scene.render(spp=1, **{rng.choice(["bands", "aov", "size", "crop", "seed", "threads", "replicates"]): rng.choice(small)}),
        lambda: scene.render(spp=rng.choice(small), threads=1),
        lambda: scene.render(spp=1, max_depth=rng.choice(odd)),
        lambda: scene.replay(rng.choice(odd), rng.choice(odd), rng.choice(odd)),
        lambda: picture.develop(**{rng.choice(["exposure", "white_balance", "curve", "scale", "crop", "band_nm", "error_map",
                                               "range", "axis", "false_colour"]): rng.choice(odd)}),
        lambda: picture.spectrum(rng.choice(odd), rng.choice(odd)),
        lambda: picture.channel(rng.choice([value for value in odd if isinstance(value, str)])),
        lambda: etalon.Picture.from_arrays(rng.choice(odd), rng.choice(odd)),
        lambda: etalon.compare(picture, picture, significance=rng.choice(odd), exposure=rng.choice(odd)),
        lambda: spectra.glass(rng.choice(odd), rng.choice(odd)),
        lambda: spectra.blackbody(rng.choice(odd), rng.choice(odd)),
        lambda: spectra.reflectance_of_rgb(rng.choice(odd), [500, 600]),
        lambda: spectra.xyz(rng.choice(odd), rng.choice(odd)),
        lambda: spectra.xyz_to_rgb(rng.choice(odd)),
        lambda: oracle.judge(truth, rng.choice(odd), rng.choice(odd), tests=rng.choice(odd)),
        lambda: oracle.truth(rng.choice(odd)),
    ]
    answered = 0
    for _ in range(3000):
        try:
            rng.choice(calls)()
            answered += 1
        except (etalon.EtalonError, TypeError, ValueError, OverflowError):
            # Whatever it is, it is no panic, which derives from BaseException alone.
            pass
    assert answered > 100
