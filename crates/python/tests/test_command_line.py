"""The command line of the package, and that its pixels are those of the functions."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import time

import numpy as np
import pytest

import etalon
from conftest import command

OpenEXR = pytest.importorskip("OpenEXR")


def channels(path) -> dict[str, np.ndarray]:
    """All channels of an EXR file, by a reader that is not ours."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def binaries() -> list[list[str]]:
    """The command of this package, and a program that was built alone, if there is one."""
    alone = os.environ.get("ETALON_PROGRAM")
    return [[sys.executable, "-m", "etalon"], *([[alone]] if alone else [])]


@pytest.mark.parametrize("program", binaries(), ids=["module", "program"][: len(binaries())])
def test_pixels_equal_the_command_line_bit_for_bit(cornell, tmp_path, program):
    options = ["--size", "40x30", "--spp", "12", "--seed", "5", "--bands", "450:650:50", "--aov", "depth,normal,object"]
    path = tmp_path / "cornell.exr"
    subprocess.run([*program, "render", cornell, *options, "-o", str(path), "--quiet"], check=True)
    scene = etalon.load(cornell)
    picture = scene.render(spp=12, seed=5, size=(40, 30), bands=(450, 650, 50), aov=["depth", "normal", "object"])
    theirs = channels(path)
    assert sorted(theirs) == sorted(picture.names)
    for name, pixels in theirs.items():
        assert pixels.dtype == np.float32 and pixels.tobytes() == picture.channel(name).tobytes(), name
    assert picture.rgb.tobytes() == np.stack([theirs[name] for name in "RGB"], axis=-1).tobytes()
    # The attributes too, but for the time that it took.
    read, own = etalon.read(path).attributes, picture.attributes
    differing = {name for name in read.keys() | own.keys() if read.get(name) != own.get(name)}
    assert differing <= {"renderTimeSeconds"}
    picture.save(tmp_path / "own.exr")
    assert all(pixels.tobytes() == theirs[name].tobytes() for name, pixels in channels(tmp_path / "own.exr").items())


def test_an_adaptive_render_equals_the_command_line(cornell, tmp_path):
    path = tmp_path / "cornell.exr"
    options = ["--size", "48x32", "--spp", "32", "--adaptive", "always"]
    assert command("render", cornell, *options, "-o", str(path)).returncode == 0
    picture = etalon.load(cornell).render(spp=32, size=(48, 32), adaptive="always")
    theirs = channels(path)
    assert picture.samples is not None and len(np.unique(picture.samples)) > 1
    assert all(pixels.tobytes() == picture.channel(name).tobytes() for name, pixels in theirs.items())


def test_developed_pixels_equal_the_command_line(cornell, tmp_path):
    picture = etalon.load(cornell).render(spp=4, size=(40, 30))
    picture.save(tmp_path / "own.exr")
    for name, words, options in [
        ("plain", [], {}),
        ("agx", ["--exposure", "auto", "--curve", "agx", "--white-balance", "A"],
         {"exposure": "auto", "curve": "agx", "white_balance": "A"}),
        ("map", ["--error-map"], {"error_map": "relative"}),
        ("part", ["--crop", "3,4,20,10", "--scale", "2"], {"crop": (3, 4, 20, 10), "scale": 2}),
    ]:
        theirs = tmp_path / f"{name}.png"
        assert command("develop", str(tmp_path / "own.exr"), *words, "-o", str(theirs)).returncode == 0
        picture.save(tmp_path / f"{name}-own.png", **options)
        imageio = pytest.importorskip("imageio.v3")
        pixels = imageio.imread(theirs)
        assert np.array_equal(pixels, picture.develop(**options)), name
        assert np.array_equal(pixels, imageio.imread(tmp_path / f"{name}-own.png")), name


def test_exit_statuses_are_those_of_the_program(tmp_path):
    done = command("--version")
    assert done.returncode == 0 and done.stdout.strip() == f"etalon {etalon.__version__}"
    bad = tmp_path / "bad.json"
    bad.write_text('{"etalon": 1}')
    done = command("render", str(bad), "-o", str(tmp_path / "bad.exr"))
    assert done.returncode == 2 and "camera" in done.stderr
    assert command("no-such-command").returncode == 2


@pytest.mark.skipif(os.name != "posix", reason="there is no SIGINT to send")
def test_an_interrupted_command_ends_as_the_program_does(cornell, tmp_path):
    words = [sys.executable, "-m", "etalon", "render", cornell, "--size", "32x32", "--spp", "1e9"]
    process = subprocess.Popen([*words, "-o", str(tmp_path / "out.exr")], stderr=subprocess.PIPE, text=True)
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in said and (tmp_path / "out.exr").exists()


def test_a_job_for_a_farm_calls_the_installed_command(cornell):
    done = command("farm", cornell, "--slurm", "--shards", "2")
    assert done.returncode == 0, done.stderr
    installed = shutil.which("etalon", path=sysconfig.get_path("scripts"))
    assert installed and installed in done.stdout
