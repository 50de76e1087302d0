"""Wrong uses: each gives the right exception, with path and hint."""

from __future__ import annotations

import math
import pathlib

import numpy as np
import pytest

import etalon
from etalon import PictureError, SceneError, SettingError


def errors(scene, **options) -> list[etalon.Problem]:
    with pytest.raises(SceneError) as caught:
        etalon.load(scene, **options)
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, etalon.EtalonError)
    for problem in caught.value.errors:
        assert problem.path in str(caught.value) and problem.message in str(caught.value)
    return caught.value.errors


def test_every_error_comes_at_once_with_its_path(ball):
    ball["film"]["width"] = 0
    ball["objects"][0]["material"]["reflectance"] = 1.5
    ball["lights"][0]["type"] = "enviroment"
    found = {problem.path: problem for problem in errors(ball)}
    assert set(found) == {"$.film.width", "$.objects[0].material.reflectance", "$.lights[0].type"}
    assert "environment" in found["$.lights[0].type"].hint
    assert found["$.film.width"].code == "out-of-range" and found["$.film.width"].line > 0


def test_words_of_other_renderers_get_the_word_here(ball):
    ball["objects"][0]["material"] = {"type": "diffuse", "reflectance": 0.5}
    (problem,) = errors(ball)
    assert problem.path == "$.objects[0].material.type" and "lambert" in problem.hint


def test_an_unknown_key_gets_a_hint(ball):
    ball["objects"][0]["shape"]["radius"] = 1
    del ball["objects"][0]["shape"]["radius_m"]
    found = {problem.code: problem for problem in errors(ball)}
    assert found["unknown-key"].path == "$.objects[0].shape.radius" and "radius_m" in found["unknown-key"].hint


def test_what_json_cannot_say_is_found_beside_all_else(ball):
    ball["objects"][0]["material"]["reflectance"] = math.nan
    ball["camera"]["position_m"] = [0, np.inf, 4]
    ball["lights"][0]["radiance"] = object()
    ball["film"][3] = 1
    ball["film"]["height"] = 10**400
    ball["objects"][0]["name"] = "\ud800"
    ball["camera"]["no key"] = 1
    found = {problem.path: problem for problem in errors(ball)}
    assert found["$.objects[0].material.reflectance"].code == "not-finite"
    assert found["$.camera.position_m[1]"].code == "not-finite"
    assert found["$.lights[0].radiance"].code == "wrong-type"
    assert found["$.film"].code == "wrong-type"
    assert found["$.film.height"].code == "out-of-range"
    assert found["$.objects[0].name"].code == "not-utf-8"
    assert found['$.camera["no key"]'].code == "unknown-key"
    assert len(found) == 7


def test_dicts_may_hold_numpy_numbers_and_arrays(ball):
    ball["camera"]["position_m"] = np.array([0, 0, 4], dtype=np.float32)
    ball["film"]["width"] = np.int64(16)
    ball["objects"][0]["material"]["reflectance"] = np.longdouble(0.5)
    assert etalon.load(ball).size == (16, 24)


def test_a_dict_that_holds_itself_is_refused(ball):
    ball["objects"][0]["material"]["reflectance"] = ball
    ball["lights"].append(ball["lights"])
    found = {problem.path: problem.code for problem in errors(ball)}
    assert found["$.objects[0].material.reflectance"] == found["$.lights[1]"] == "circular"


def test_a_dict_that_is_far_larger_as_text_is_refused(ball, monkeypatch):
    from etalon import _decode

    monkeypatch.setattr(_decode, "MOST_VALUES", 10_000)
    laughs: list = []
    for _ in range(40):
        laughs = [laughs, laughs]
    ball["comment"] = laughs
    assert any(problem.code == "limit" for problem in errors(ball))
    deep: list = []
    for _ in range(500):
        deep = [deep]
    ball["comment"] = deep
    assert any(problem.code == "limit" and "levels" in problem.message for problem in errors(ball))


def test_a_file_that_is_not_there_is_no_scene(tmp_path):
    for path in ("nowhere.json", tmp_path / "nowhere.json", tmp_path / "nowhere.glb"):
        with pytest.raises(FileNotFoundError) as caught:
            etalon.load(path)
        assert caught.value.filename == str(path)
    with pytest.raises(OSError):
        etalon.load(tmp_path)
    with pytest.raises(FileNotFoundError):
        etalon.read(tmp_path / "nowhere.exr")


def test_a_text_that_is_no_json_has_its_line():
    (problem,) = errors('{\n  "etalon": 1,\n  "camera" {}\n}')
    assert problem.code == "syntax" and problem.line == 3


def test_a_file_that_the_scene_names_is_looked_for_in_the_folder(ball, tmp_path):
    ball["objects"][0]["shape"] = {"type": "mesh", "file": "one.ply"}
    (problem,) = errors(ball, folder=tmp_path)
    assert problem.path == "$.objects[0].shape.file" and problem.code == "file"
    (tmp_path / "one.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n0 1 0\n3 0 1 2\n"
    )
    assert etalon.load(ball, folder=tmp_path).explain().objects == ["ball"]


def test_a_solid_that_is_open_is_refused(ball):
    ball["objects"] = [
        {
            "name": "sheet",
            "shape": {"type": "parallelogram", "origin_m": [0, 0, 0], "u_m": [1, 0, 0], "v_m": [0, 1, 0]},
            "material": {"type": "dielectric", "interior": 1.5, "priority": 1},
        }
    ]
    with pytest.raises(SceneError, match="not a closed solid"):
        etalon.load(ball).render(spp=1)


@pytest.mark.parametrize(
    ("arguments", "hint"),
    [
        ({"error": 2}, "0.02 for 2 %"),
        ({"error": 0}, "above 0"),
        ({"error": math.nan}, "above 0"),
        ({"error": "1%"}, "a number"),
        ({"spp": 0}, "spp is from 1"),
        ({"spp": 1.5}, "whole number"),
        ({"spp": True}, "whole number"),
        ({"time": -1}, "above 0"),
        ({"bands": (400, 700)}, "3 numbers"),
        ({"bands": (400, 705, 10)}, "bands"),
        ({"bands": (100, 200, 10)}, "bands"),
        ({"aov": "depths"}, "normal"),
        ({"aov": [1]}, "list of names"),
        ({"size": (0, 4)}, "size is from 1"),
        ({"crop": (0, 33, 0, 4)}, "32 × 24"),
        ({"crop": (4, 4, 0, 4)}, "no pixels"),
        ({"seed": -1}, "seed is from 0"),
        ({"threads": 10**6}, "threads is from 1"),
        ({"max_depth": 0}, "max_depth is from 1"),
        ({"replicates": 10**6}, "replicates"),
        ({"adaptive": "yes"}, "never"),
    ],
)
def test_settings_that_make_no_sense_say_what_would(ball, arguments, hint):
    with pytest.raises(SettingError) as caught:
        etalon.load(ball).render(**arguments)
    assert hint in str(caught.value)


def test_an_argument_that_is_none_gets_those_that_are(ball):
    scene = etalon.load(ball)
    for call in (scene.render, scene.passes):
        with pytest.raises(TypeError, match="no argument 'samples': error, spp, time"):
            call(samples=16)


def test_a_scene_of_another_type_is_refused():
    for scene in (3, None, ["a"], b"scene.json"):
        with pytest.raises(SettingError):
            etalon.load(scene)


def test_a_dark_scene_has_no_error_to_reach(ball):
    ball["lights"] = []
    scene = etalon.load(ball)
    assert [warning.code for warning in scene.warnings] == ["no-light"]
    with pytest.raises(etalon.NoLightError, match="no light"):
        scene.render(error=0.01)
    with pytest.raises(etalon.NoLightError):
        scene.quote(0.01, pilot=0.5)
    picture = scene.render(spp=4)
    assert math.isnan(picture.relative_error) and not picture.rgb.any() and "unknown" in repr(picture)


def test_quotes_and_replays_refuse_what_makes_no_sense(ball):
    scene = etalon.load(ball)
    for wrong in ([], [0.0], [-1], [math.inf], 3, "1%", None, np.float32(2)):
        with pytest.raises(SettingError):
            scene.quote(wrong)
    with pytest.raises(SettingError):
        scene.quote(0.1, pilot=0)
    for place in ((32, 0), (0, 24), (-1, 0), (0.5, 0), (None, 0)):
        with pytest.raises(SettingError):
            scene.replay(*place)


def test_pictures_refuse_what_they_lack(ball, tmp_path):
    picture = etalon.load(ball).render(spp=1)
    with pytest.raises(PictureError, match="Nothing"):
        picture.channel("Nothing")
    with pytest.raises(PictureError):
        picture.develop(band_nm=550)
    with pytest.raises(PictureError):
        picture.develop(crop=(0, 0, 33, 1))
    with pytest.raises(PictureError):
        picture.spectrum(0, 0)
    for wrong in (
        {"exposure": "bright"},
        {"exposure": math.nan},
        {"curve": "s"},
        {"scale": 0},
        {"white_balance": "tungsten"},
        {"range": 3, "false_colour": True},
        {"axis": 3},
        {"crop": (1, 2)},
    ):
        with pytest.raises(SettingError):
            picture.develop(**wrong)
    with pytest.raises(SettingError, match="no argument"):
        picture.save(tmp_path / "a.png", contrast=1)
    with pytest.raises(SettingError, match="jpg"):
        picture.save(tmp_path / "a.jpg")
    with pytest.raises(SettingError):
        picture.save(tmp_path / "a.exr", exposure=1)
    with pytest.raises(PictureError, match="does not exist"):
        picture.save(tmp_path / "none" / "a.exr")
    other = etalon.load(ball).render(spp=1, size=(8, 8))
    with pytest.raises(PictureError):
        etalon.compare(picture, other)
    with pytest.raises(SettingError):
        etalon.compare(picture, picture, significance=0)
    with pytest.raises(SettingError):
        etalon.compare(picture, picture, tile=-1)
    (tmp_path / "no.exr").write_bytes(b"no picture")
    with pytest.raises(PictureError, match="no.exr"):
        etalon.read(tmp_path / "no.exr")
    for wrong in (np.zeros((3, 3)), np.zeros((3, 3, 4)), "text", np.zeros((0, 3, 3))):
        with pytest.raises(PictureError):
            etalon.Picture.from_arrays(wrong)


def test_exceptions_can_be_pickled(ball):
    import pickle

    ball["film"]["width"] = 0
    with pytest.raises(SceneError) as caught:
        etalon.load(ball)
    again = pickle.loads(pickle.dumps(caught.value))
    assert again.problems == caught.value.problems and str(again) == str(caught.value)


def test_names_with_odd_characters(tmp_path, ball):
    import json

    path = pathlib.Path(tmp_path) / "é scène.json"
    path.write_text(json.dumps(ball), encoding="utf-8")
    scene = etalon.load(path)
    assert scene.name == str(path) and repr(scene)
    scene.render(spp=1).save(tmp_path / "é.exr")
    assert etalon.read(tmp_path / "é.exr").size == (32, 24)
