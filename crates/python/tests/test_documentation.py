"""The examples of the documentation and the notebooks run."""

from __future__ import annotations

import doctest
import importlib
import os
import pathlib
import re

import pytest

import etalon
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "crates" / "python" / "notebooks").glob("*.ipynb"))


def blocks(path: pathlib.Path) -> list[str]:
    """Python code of a Markdown page."""
    return re.findall(r"^```python\n(.*?)^```", path.read_text(encoding="utf-8"), flags=re.M | re.S)


def in_a_copy(tmp_path, monkeypatch) -> None:
    """A folder where the scenes are, to write into."""
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)


def test_the_five_lines_of_the_readme_show_a_picture_with_its_error(tmp_path, monkeypatch):
    in_a_copy(tmp_path, monkeypatch)
    found = [block for block in blocks(ROOT / "README.md") if "import etalon" in block]
    assert len(found) == 1 and len(found[0].strip().splitlines()) <= 6
    names: dict[str, object] = {}
    exec(found[0], names)
    picture = names["picture"]
    assert isinstance(picture, etalon.Picture) and picture.relative_error < 0.1
    assert list(tmp_path.glob("*.exr"))


def test_the_how_to_page_runs(tmp_path, monkeypatch):
    in_a_copy(tmp_path, monkeypatch)
    names: dict[str, object] = {}
    found = blocks(ROOT / "docs" / "how-to" / "python.md")
    assert found
    for block in found:
        if "xarray" in block:
            pytest.importorskip("xarray")
        exec(block, names)


@pytest.mark.parametrize("name", ["etalon", "etalon.spectra", "etalon.oracle"])
def test_examples_of_modules_run(name, tmp_path, monkeypatch):
    in_a_copy(tmp_path, monkeypatch)
    result = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
    assert result.attempted > 0 and result.failed == 0


def test_every_public_name_is_documented():
    for module in (etalon, etalon.spectra, etalon.oracle):
        for name in module.__all__:
            value = getattr(module, name)
            if name.startswith("__") or not callable(value):
                continue
            assert value.__doc__, name
            if isinstance(value, type):
                methods = [method for key, method in vars(value).items() if not key.startswith("_") and callable(method)]
                assert all(method.__doc__ for method in methods), name


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(path):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    for package in ("ipykernel", "matplotlib"):
        pytest.importorskip(package)
    notebook = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "notebooks are kept without outputs"
    os.environ.setdefault("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(path.parent)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in shown)


def test_there_are_three_notebooks():
    assert len(NOTEBOOKS) >= 3
