#!/usr/bin/env python3
"""Runs the commands of the documentation in a copy of the scenes.

    python3 tests/docs-commands.py [path of etalon [PAGE …]]

Of each block marked `sh` it runs the lines that begin with `etalon`, in the order of the page, and expects the exit status 0, or 1 if the
page says so behind the block ("the exit status is 1"). Blocks marked `sh illustrative` are not run. A JSON block behind "Save this as
`FILE`" is saved under that name. Needs nothing but Python.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parent.parent
etalon = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else root / "target/release/etalon").resolve()
PAGES = ["docs/tutorial.md", "docs/how-to/*.md", "docs/*.md", "crates/oracle/README.md"]
# Files that stand for a model and for a scene that the reader has.
FILES = {"model.glb": "crates/import/fuzz/seeds/gltf/all.glb", "scene.json": "reference/assignment/diffuse-only.json"}
SKIP = ["etalon verify --images pictures"]  # of pictures that another renderer makes
EDITS = {"brighter.json": ("glass.json", '"scale": 6 }', '"scale": 6.6 }')}  # a change that the page asks for in words


def blocks(text):
    """Kind, content, and the text before and behind each fenced block."""
    parts = re.split(r"^```", text, flags=re.M)
    for index in range(1, len(parts), 2):
        kind, _, content = parts[index].partition("\n")
        yield kind.strip(), content, parts[index - 1], parts[index + 1] if index + 1 < len(parts) else ""


def prepare(folder):
    shutil.copytree(root / "scenes", folder / "scenes")
    (folder / "docs").mkdir()
    shutil.copytree(root / "docs/tutorial", folder / "docs/tutorial")
    for name, source in FILES.items():
        shutil.copy(root / source, folder / name)
    for scene in (root / "docs/tutorial").iterdir():
        shutil.copy(scene, folder / scene.name)
    for name, (source, before, after) in EDITS.items():
        text = (folder / source).read_text()
        assert text.count(before) == 1, name
        (folder / name).write_text(text.replace(before, after))


def run(page, folder):
    failed = 0
    for kind, content, before, behind in blocks(page.read_text(encoding="utf-8")):
        if kind.startswith("json") and (saved := re.findall(r"Save this as `([^`]+)`[^`]*$", before)):
            (folder / saved[-1]).write_text(content)
        if kind != "sh":
            continue
        lines = [line.split("  #")[0].strip() for line in content.splitlines() if line.startswith("etalon ")]
        for number, line in enumerate(lines):
            if line in SKIP:
                continue
            last = number == len(lines) - 1
            expected = 1 if last and re.match(r"[^`]{0,200}`?[^`]{0,60}`?[^`]{0,80}exit status is 1\b", behind) else 0
            path = os.pathsep.join([str(etalon.parent), os.environ["PATH"]])
            done = subprocess.run(line, shell=True, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True, timeout=600)
            right = done.returncode == expected
            failed += not right
            print(f"{'ok   ' if right else 'WRONG'} {page.name}: {line}")
            if not right:
                print(f"exit status {done.returncode}, expected {expected}\n{done.stdout}{done.stderr}")
    return failed


def main():
    pages = sorted({page for pattern in sys.argv[2:] or PAGES for page in root.glob(pattern)})
    failed = 0
    for page in pages:
        with tempfile.TemporaryDirectory() as folder:
            prepare(pathlib.Path(folder))
            failed += run(page, pathlib.Path(folder))
    print(f"{failed} commands did not do what their page says")
    return bool(failed)


sys.exit(main())
