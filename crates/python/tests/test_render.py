"""Renders: arrays, errors, bands, AOVs, Stokes parameters, passes, interrupts."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest

import etalon
from conftest import ROOT


def test_a_picture_knows_its_truth_within_its_error(ball):
    ball["camera"]["vertical_fov_deg"] = 12
    picture = etalon.load(ball).render(spp=64, bands=(450, 650, 100), seed=3)
    assert picture.size == (32, 24) and picture.crop == (0, 32, 0, 24)
    assert picture.rgb.shape == picture.error.shape == (24, 32, 3)
    assert picture.rgb.dtype == picture.error.dtype == np.float32
    assert picture.wavelengths_nm.tolist() == [450, 550, 650]
    assert picture.bands.shape == picture.bands_error.shape == (24, 32, 3)
    # All of the picture is ball: half of the sky's radiance. The mean of n independent pixels has the error √Σσ²/n, and the sums are
    # rounded to 32 bits, half a unit of 2⁻²⁴ each. Five standard errors are exceeded once in two million times.
    for index in range(3):
        pixels, errors = picture.bands[..., index].astype(float), picture.bands_error[..., index].astype(float)
        error = np.sqrt((errors**2).sum()) / errors.size
        assert abs(pixels.mean() - 0.5) <= 5 * error + 2**-24, (pixels.mean(), error)
    assert picture.report["reached"] == "samples" and picture.report["spp"] == 64
    assert picture.report["paths"] == 64 * 32 * 24


def test_the_pixels_do_not_depend_on_threads_but_on_the_seed(ball):
    scene = etalon.load(ball)
    one, two, other = (scene.render(spp=16, threads=n, seed=s) for n, s in ((1, 1), (2, 1), (2, 2)))
    assert one.rgb.tobytes() == two.rgb.tobytes() and one.error.tobytes() == two.error.tobytes()
    assert one.rgb.tobytes() != other.rgb.tobytes()


def test_a_render_to_an_error_reaches_it(cornell):
    scene = etalon.load(cornell, size=(48, 48))
    picture = scene.render(error=0.1)
    assert picture.report["reached"] == "error"
    # The pilot aims at the error with some room; the estimate of the error is itself uncertain.
    assert picture.relative_error < 0.15
    low, high = picture.relative_error_interval
    assert low < picture.relative_error < high
    # The stated error of the whole is that of the pixels: √(mean Var Y) / mean Y, where errors of R, G and B go together at most.
    weights = np.array([0.2126, 0.7152, 0.0722])
    bound = np.sqrt(((picture.error.astype(float) @ weights) ** 2).mean()) / (picture.rgb.astype(float) @ weights).mean()
    assert picture.relative_error <= bound * 1.001


def test_a_crop_is_a_part_of_the_whole(ball):
    scene = etalon.load(ball)
    whole = scene.render(spp=4)
    part = scene.render(spp=4, crop=(5, 20, 3, 11))
    assert part.crop == (5, 20, 3, 11) and part.size == (15, 8)
    assert part.rgb.tobytes() == whole.rgb[3:11, 5:20].tobytes()


def test_another_size_keeps_the_scene(ball):
    scene = etalon.load(ball)
    picture = scene.render(spp=1, size=(16, 8))
    assert picture.size == (16, 8) and scene.size == (32, 24)
    assert picture.rgb.tobytes() == etalon.load(ball, size=(16, 8)).render(spp=1).rgb.tobytes()


def test_aovs_have_the_geometry_of_the_scene(ball):
    ball["camera"]["vertical_fov_deg"] = 40
    picture = etalon.load(ball).render(spp=64, aov=["depth", "normal", "position", "albedo", "object", "samples"])
    aovs = picture.aovs
    assert set(aovs) == {"depth", "normal", "position", "albedo", "object"}
    assert aovs["normal"].shape == (24, 32, 3) and aovs["depth"].shape == (24, 32)
    # The camera is 4 m from the centre of a ball of radius 1 m. The middle pixels see up to 0.1 m beside its front.
    assert abs(aovs["depth"][12, 16] - 3) < 0.01 and abs(aovs["position"][12, 16, 2] - 1) < 0.01
    assert aovs["normal"][12, 16, 2] > 0.99 and np.allclose(aovs["albedo"][12, 16], 0.5, atol=1e-6)
    assert aovs["object"][12, 16] == 1 and aovs["object"][0, 0] == 0 and picture.objects == ["ball"]
    assert (picture.samples == 64).all()
    assert "depth" not in etalon.load(ball).render(spp=1).aovs


def test_polarised_light_has_stokes_parameters(ball):
    """At Brewster's angle glass reflects only light that swings at right angles to the plane of incidence: along the picture's right."""
    angle = np.arctan(1.5)
    ball["camera"] = {
        "type": "perspective",
        "position_m": [0, 40 * np.cos(angle), 40 * np.sin(angle)],
        "look_at_m": [0, 0, 0],
        "vertical_fov_deg": 0.1,
    }
    ball["film"] = {"width": 8, "height": 8}
    ball["objects"] = [
        {
            "shape": {"type": "parallelogram", "origin_m": [-9, 0, 9], "u_m": [18, 0, 0], "v_m": [0, 0, -18]},
            "material": {"type": "dielectric", "interior": 1.5},
        },
        # Black behind the glass.
        {
            "shape": {"type": "parallelogram", "origin_m": [-99, -1, 99], "u_m": [198, 0, 0], "v_m": [0, 0, -198]},
            "material": {"type": "black"},
        },
    ]
    scene = etalon.load(ball)
    picture = scene.render(spp=64, polarised=True, bands=(500, 600, 50))
    assert picture.stokes.shape == picture.stokes_error.shape == (8, 8, 3, 4)
    assert picture.stokes_bands.shape == (8, 8, 3, 4)
    assert np.array_equal(picture.stokes[..., 0], picture.rgb)
    assert np.array_equal(picture.stokes_bands[..., 0], picture.bands)
    s0, s1, s2, s3 = picture.stokes_bands.astype(float).mean(axis=(0, 1, 2))
    # All reflected light is polarised. The angle is off by 0.05° at most, which lets less than 1e-5 of the other kind through.
    assert s0 > 0 and abs(s1 / s0 - 1) < 1e-4 and abs(s2) < 1e-4 and abs(s3) < 1e-4
    # Half of Fresnel's reflectance across the plane of incidence: ((n² − 1) / (n² + 1))² / 2.
    spectrum = picture.spectrum(0, 0, 8, 8)
    assert (np.abs(spectrum.radiance - (1.25 / 3.25) ** 2 / 2) < 5 * spectrum.error).all()
    assert scene.render(spp=1).stokes is None


def test_passes_end_with_the_render(ball):
    scene = etalon.load(ball)
    pictures = list(scene.passes(spp=64))
    samples = [picture.report["spp"] for picture in pictures]
    assert len(samples) > 1 and samples == sorted(set(samples)) and samples[-1] == 64
    assert pictures[-1].rgb.tobytes() == scene.render(spp=64).rgb.tobytes()
    assert pictures[0].rgb.tobytes() == scene.render(spp=samples[0]).rgb.tobytes()
    assert pictures[0].relative_error > pictures[-1].relative_error > 0


def test_to_leave_the_loop_of_passes_ends_the_render(cornell):
    before = threading.active_count()
    scene = etalon.load(cornell, size=(64, 64))
    for picture in scene.passes(spp=2**20):
        assert picture.report["spp"] < 2**20
        break
    # The next render is not slowed by the one that was left.
    start = time.monotonic()
    scene.render(spp=1)
    assert time.monotonic() - start < 30
    assert threading.active_count() == before


def test_passes_raise_what_a_render_raises(ball):
    ball["lights"] = []
    with pytest.raises(etalon.NoLightError):
        next(etalon.load(ball).passes(error=0.01))
    with pytest.raises(etalon.SettingError):
        etalon.load(ball).passes(spp=0)


def interrupt_after(seconds: float) -> None:
    timer = threading.Timer(seconds, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.daemon = True
    timer.start()


@pytest.mark.skipif(os.name != "posix", reason="a process cannot send itself SIGINT here")
def test_an_interrupt_keeps_what_there_is(ball):
    scene = etalon.load(ball)
    interrupt_after(1.0)
    with pytest.warns(etalon.RenderInterrupted, match="interrupted after"):
        picture = scene.render(spp=2**30)
    assert picture.report["reached"] == "interrupted" and 0 < picture.report["spp"] < 2**30
    assert abs(picture.rgb.mean() - 0.5) < 0.05
    assert "interrupted" in picture.attributes["unfinished"]


@pytest.mark.skipif(os.name != "posix", reason="a process cannot send itself SIGINT here")
def test_an_interrupt_of_a_quote_or_of_passes_raises(cornell):
    interrupt_after(0.5)
    with pytest.raises(KeyboardInterrupt):
        etalon.load(cornell).quote(1e-5, pilot=100)
    interrupt_after(0.5)
    with pytest.raises(KeyboardInterrupt):
        for _ in etalon.load(cornell).passes(spp=2**30):
            pass


def test_the_interpreter_is_free_while_a_render_runs(ball):
    counted, done = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    etalon.load(ball).render(time=0.5, threads=1)
    done.set()
    thread.join()
    # 500 wakes of a millisecond on an idle machine; ten on one that is ten times overbooked, and none if the lock is held.
    assert counted > 10


def test_a_function_is_told_of_progress_and_may_end_the_render(ball):
    seen: list[etalon.Progress] = []
    etalon.load(ball).render(time=0.5, progress=seen.append)
    assert seen and seen[-1].paths > 0 and seen[-1].planned and seen[-1].seconds < 30
    assert [one.seconds for one in seen] == sorted(one.seconds for one in seen)

    class Enough(Exception):
        pass

    def stop(progress: etalon.Progress) -> None:
        raise Enough

    with pytest.raises(Enough):
        etalon.load(ball).render(spp=2**30, progress=stop)


def test_a_bar_is_shown_where_it_is_asked_for(ball, capfd):
    etalon.load(ball).render(time=0.5, progress=True)
    assert "paths" in capfd.readouterr().err
    etalon.load(ball).render(time=0.3)
    assert capfd.readouterr().err == "", "nobody sees a bar in a pipe"


def test_a_quote_holds(ball):
    ball["lights"] = [{"type": "point", "position_m": [3, 4, 2], "intensity": 10}]
    ball["camera"]["vertical_fov_deg"] = 40
    scene = etalon.load(ball)
    quote = scene.quote([0.05, 0.02], pilot=2)
    assert [cost.error for cost in quote.costs] == [0.05, 0.02]
    cost = quote.cost(0.02)
    assert cost.samples_interval[0] <= cost.samples <= cost.samples_interval[1]
    assert "2 %" in str(quote) and "<table>" in quote._repr_html_()
    picture = scene.render(spp=max(4, round(cost.samples)))
    # The error falls with the square root of the samples, or faster with Sobol points.
    assert picture.relative_error < 0.04


def test_an_explanation_names_the_object(cornell):
    explanation = etalon.load(cornell).explain()
    names = {effect.name for effect in explanation.effects}
    assert {"shadow-rays", "dispersion"} <= names
    assert explanation["shadow-rays"].on and not explanation["dispersion"].on
    assert "shadow-rays" in str(explanation) and explanation.objects
    with pytest.raises(KeyError):
        explanation["no effect"]


def test_a_replay_adds_up_to_the_pixel(ball):
    scene = etalon.load(ball)
    replays = [scene.replay(16, 12, sample) for sample in range(8)]
    assert replays[0].wavelengths_nm.shape == replays[0].radiance.shape
    assert replays[0].events[0]["event"] == "vertex" and replays[0].events[0]["object"] == "ball"
    assert "ball" in str(replays[0])
    mean = np.mean([replay.xyz for replay in replays], axis=0)
    picture = scene.render(spp=8)
    # The film adds the same numbers in another order, and is rounded to 32 bits.
    assert np.allclose(etalon.spectra.xyz_to_rgb(mean), picture.rgb[12, 16], rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("name, words", [("fog", "a medium scatters"), ("black-light", "fluorescence, excited at")])
def test_a_replay_is_told_whatever_happens_on_the_path(name, words):
    scene = etalon.load(ROOT / f"scenes/{name}.json", size=(24, 16))
    told = [str(scene.replay(x, y)) for x in range(0, 24, 2) for y in range(0, 16, 2)]
    assert all("end: " in path for path in told) and any(words in path for path in told)


def test_two_seeds_are_within_noise_and_another_scene_differs(ball):
    scene = etalon.load(ball)
    one, two = (scene.render(spp=32, seed=seed) for seed in (1, 2))
    comparison = etalon.compare(one, two)
    assert comparison.verdict == "within-noise" and comparison.rmse > 0 and comparison.flip_map.shape == (24, 32)
    assert [channel.channel for channel in comparison.channels] == ["R", "G", "B"]
    assert etalon.compare(one, one).verdict == "equal"
    ball["objects"][0]["material"]["reflectance"] = 0.52
    assert etalon.compare(etalon.load(ball).render(spp=32, seed=3), one).verdict == "differ"
    untested = etalon.compare(etalon.Picture.from_arrays(one.rgb), two)
    assert untested.verdict == "untested" and "Error.R" in untested.note
    assert "within-noise" in str(comparison)
