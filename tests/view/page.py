#!/usr/bin/env python3
"""Does with the page of `etalon view` what people do, in a headless Chromium.

    tests/view/page.py ETALON [--shots FOLDER] [--measure | --pictures] [TEST …]

Each test says what it saw. With --shots, screenshots are kept in FOLDER. With --measure, the program prints the figures of
docs/how-to/view.md instead; with --pictures, it makes the screenshots of that page. CHROMIUM names the browser where it is not found.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import controls  # noqa: E402, F401 (its tests add themselves)
from browser import Browser, Viewer  # noqa: E402
from suite import SCENES, TESTS, ended, settled, test  # noqa: E402


@test
def page_loads_and_picture_sharpens(context):
    """The picture appears, grows finer, and its error falls."""
    with context.viewer(SCENES / "cornell.json", "--size", "160x160", "--error", "3%") as viewer, context.page(viewer) as page:
        page.wait("a picture", "window.etalonLog?.some(e => e.what === 'picture')", 20)
        settled(page)
        ended(page)
        time.sleep(0.3)
        errors = [e for e in page.log("error") if e["relative_rmse"]]
        own = [e["relative_rmse"] for e in errors if e["block"] == 1]
        assert len(own) >= 2 and own[-1] < own[0] and own[-1] < 0.035, own
        assert "Typical error of a pixel" in page.text("error-words"), page.text("error-words")
        interval = page.text("error-interval")
        assert re.match(r"95 % sure: \S+ % to \S+ %$", interval) or context.status(viewer)["error"]["heavy_tailed"], interval
        largest = page.text("error-largest")
        assert re.match(r"Largest error of a tile: \S+ % of the mean brightness, in columns \d+ to \d+, rows \d+ to \d+\.$", largest), largest
        assert "since the start" in page.text("counts"), page.text("counts")
        marks = page.text("marks")
        assert "reached after" in marks and re.search(r"1\.0 %", marks), marks
        assert page.run("document.querySelectorAll('#curve polyline').length") >= 2
        assert page.run("document.getElementById('picture').width") == 160
        lit = page.run("(() => { const c = document.getElementById('picture'); const d = c.getContext('2d').getImageData(0, 0, 160, 160).data;"
                       " let sum = 0; for (let i = 0; i < d.length; i += 4) sum += d[i]; return sum / (d.length / 4); })()")
        assert 20 < lit < 235, lit
        page.shot(context.shots, "loaded")
        return f"{len(own)} pictures of all pixels, error {own[0]:.3f} to {own[-1]:.3f}"


@test
def map_lies_over_the_picture(context):
    """The error map of the mean has the error of the picture as its root mean square."""
    with context.viewer(SCENES / "cornell.json", "--size", "160x160", "--error", "3%") as viewer, context.page(viewer) as page:
        settled(page)
        ended(page)
        page.choose("input[name=map][value=of-mean]")
        page.wait("the map", "window.etalonLog.some(e => e.what === 'map' && e.kind === 'of-mean')")
        time.sleep(0.3)
        rms = page.log("map")[-1]["rms"]
        error = page.log("error")[-1]["relative_rmse"]
        assert abs(rms / error - 1) < 1e-3, (rms, error)
        words = page.text("legend-title")
        assert "Yellow: large error. Dark: small error." in words and "Box:" in words, words
        boxes = "[...document.querySelectorAll('#tile-box rect')].map(e => ['x', 'width', 'y', 'height'].map(a => Number(e.getAttribute(a))))"
        x0, x1, y0, y1 = context.status(viewer)["error"]["noisiest"]["crop"]
        assert page.run(boxes) == [[x0, x1 - x0, y0, y1 - y0]] * 2, page.run(boxes)
        page.shot(context.shots, "map")
        page.run("(() => { const e = document.getElementById('map-opacity'); e.value = 0.5; e.dispatchEvent(new Event('input')); })()")
        assert page.text("map-opacity-value") == "50 %" and page.run("!document.getElementById('map-mixed').hidden")
        page.choose("input[name=map][value=relative]")
        page.wait("the other map", "window.etalonLog.some(e => e.what === 'map' && e.kind === 'relative')")
        page.choose("input[name=map][value='']")
        assert page.run("document.getElementById('map-opacity').disabled && document.getElementById('map-mixed').hidden")
        assert page.run(boxes) == [], page.run(boxes)
        return f"root mean square {rms:.4f}, error {error:.4f}"


@test
def cursor_tells_pixel_and_spectrum(context):
    """Under the cursor: object, material, value with error, spectrum with errors."""
    with context.viewer(SCENES / "cornell.json", "--size", "160x160") as viewer, context.page(viewer) as page:
        settled(page)
        page.move(0.3, 0.94)
        page.wait("the spectrum", "window.etalonLog.some(e => e.what === 'spectrum')")
        pixel, spectrum = page.log("pixel")[-1], page.log("spectrum")[-1]
        assert pixel["object"] and pixel["material"] and pixel["luminance_error"] > 0, pixel
        assert spectrum["bands"] >= 30 and spectrum["with_errors"] == spectrum["bands"], spectrum
        page.wait("a better one", "window.etalonLog.some(e => e.what === 'spectrum' && e.samples >= 4096)")
        assert page.run("document.querySelectorAll('#spectrum rect').length") > 40
        assert "They are not part of the picture." in page.text("spectrum-words"), page.text("spectrum-words")
        assert "red, linear Rec. 709" in page.text("pixel-values"), page.text("pixel-values")
        assert page.text("pixel-what") == f"object {pixel['object']}, material {pixel['material']}", page.text("pixel-what")
        assert page.run("document.querySelectorAll('#effects-on li.is-here').length") >= 1
        assert "(needed here)" in page.text("effects-on"), page.text("effects-on")
        page.shot(context.shots, "pixel")
        return f"{pixel['object']} of {pixel['material']}, {spectrum['bands']} bands"


@test
def click_draws_paths(context):
    """A click draws the paths of a pixel over the picture; Escape takes them away."""
    with context.viewer(SCENES / "cornell.json", "--size", "160x160") as viewer, context.page(viewer) as page:
        settled(page)
        page.move(0.4, 0.6)
        page.click(0.4, 0.6)
        page.wait("the paths", "window.etalonLog.some(e => e.what === 'paths')")
        paths = page.log("paths")[-1]
        assert paths["paths"] == 24 and paths["vertices"] >= 24, paths
        lines = page.run("document.querySelectorAll('#overlay line').length")
        told = page.text("paths-list")
        assert lines > 20 and "hits;" in told and "weight" in told and "path 1\n" in told, (lines, told)
        assert "found light" in page.text("paths-legend")
        page.shot(context.shots, "paths")
        page.key("Escape")
        assert page.run("document.querySelectorAll('#overlay line').length") == 0
        return f"{paths['paths']} paths, {paths['vertices']} vertices, {paths['found']} found light"


@test
def mouse_orbits(context):
    """A drag orbits: coarse pictures follow the mouse, the picture begins again, R goes back."""
    with context.viewer(SCENES / "cornell.json", "--size", "256x256") as viewer, context.page(viewer) as page:
        settled(page)
        before = page.run("window.etalonLog.length")

        seen = before

        def a_coarse_picture():
            nonlocal seen
            page.wait("a coarse picture", f"window.etalonLog.slice({seen}).some(e => e.what === 'picture' && e.block > 1)", 20)
            seen = page.run("window.etalonLog.length")

        page.drag((0.5, 0.6), (0.62, 0.55), steps=4, after_step=a_coarse_picture)
        page.wait("a picture from there", f"window.etalonLog.slice({before}).some(e => e.what === 'error' && e.block === 1)", 60)
        after = page.run(f"window.etalonLog.slice({before})")
        stages = {e["stage"] for e in after if e["what"] == "error"}
        coarse = [e for e in after if e["what"] == "picture" and e["block"] > 1]
        assert len(stages) >= 3 and len(coarse) >= 3, (stages, len(coarse))
        assert page.run("!document.getElementById('home').hidden")
        page.shot(context.shots, "orbit")
        page.key("r")
        page.wait("the scene's camera", "document.getElementById('home').hidden")
        return f"{len(stages)} views, {len(coarse)} coarse pictures on the way"


@test
def edits_are_taken_over(context):
    """An edit of the file reloads the scene and keeps the camera; an error is shown, and the picture stays."""
    folder = Path(context.folder.name) / "edit"
    folder.mkdir(exist_ok=True)
    path = folder / "cornell.json"
    text = (SCENES / "cornell.json").read_text()
    path.write_text(text)
    with context.viewer(path, "--size", "128x128", "--error", "5%") as viewer, context.page(viewer) as page:
        settled(page)
        page.drag((0.5, 0.6), (0.6, 0.6))
        page.wait("the camera at rest", "!document.getElementById('home').hidden")
        time.sleep(1.5)
        camera = context.status(viewer)["camera"]
        before = page.run("window.etalonLog.length")
        path.write_text(text.replace('"lambert"', '"lambertt"', 1))
        page.wait("the error", "!document.getElementById('banner').hidden", 20)
        words = page.text("banner")
        assert "lambertt" in words and "line" in words, words
        page.shot(context.shots, "edit-error")
        assert page.run("document.getElementById('picture').width") == 128
        names = re.findall(r'"reflectance":\s*"?[^,}]*', text)
        changed = re.sub(r'"seed":\s*\d+', '"seed": 77', text) if '"seed"' in text else text.replace('"spp": 192', '"spp": 192, "seed": 77')
        assert changed != text, names
        path.write_text(changed)
        page.wait("the picture of the edited scene", f"document.getElementById('banner').hidden && window.etalonLog.slice({before}).some(e => e.what === 'error' && e.block === 1)", 60)
        now = context.status(viewer)["camera"]
        assert now == camera, (camera, now)
        return "an error with its line, then the edited scene from the same camera"


@test
def two_pages_see_the_same(context):
    """Two pages look at one render; each has its own look."""
    with context.viewer(SCENES / "cornell.json", "--size", "128x128") as viewer:
        with context.page(viewer) as one, context.page(viewer) as other:
            settled(one)
            settled(other)
            one.wait("both", "document.getElementById('counts').innerText.includes('2 pages')")
            one.run("(() => { const e = document.getElementById('exposure'); e.value = 3; e.dispatchEvent(new Event('input')); })()")
            one.wait("the look", "document.getElementById('exposure-value').innerText.startsWith('3')")
            mean = ("(() => { const c = document.getElementById('picture'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                    " let s = 0; for (let i = 0; i < d.length; i += 4) s += d[i]; return s / (d.length / 4); })()")
            bright, plain = one.run(mean), other.run(mean)
            assert bright > plain + 30, (bright, plain)
            other.key(" ")
            one.wait("the pause", "document.getElementById('phase')?.innerText === 'paused'")
            return f"mean levels {bright:.0f} and {plain:.0f}; a pause of one is seen by the other"


@test
def effects_are_switched_and_compared(context):
    """An effect is switched off: the plan says so, and the picture differs from the pinned one by more than noise."""
    with context.viewer(SCENES / "metals.json", "--size", "192x96", "--error", "5%") as viewer, context.page(viewer) as page:
        ended(page)
        page.choose("#pin")
        page.wait("the pin", "!document.getElementById('unpin').hidden")
        before = page.run("window.etalonLog.length")
        boxes = page.run("[...document.querySelectorAll('#effects-on li')].map(e => e.innerText)")
        index = next(i for i, words in enumerate(boxes) if words.startswith("specular chains"))
        page.choose(f"#effects-on li:nth-child({index + 1}) input")
        page.wait("the comparison", f"window.etalonLog.slice({before}).some(e => e.what === 'comparison')", 120)
        page.wait("the notes", "document.getElementById('notes').innerText.includes('specular-chains')")
        verdict = page.log("comparison")[-1]["verdict"]
        assert verdict == "differ", verdict
        assert "you switched it off" in page.text("effects-on"), page.text("effects-on")
        assert "difference in standard errors" in page.text("map-kind"), page.text("map-kind")
        page.choose("input[name=map][value=difference]")
        page.wait("the map", "window.etalonLog.some(e => e.what === 'map' && e.kind === 'difference')")
        page.wait("the sentence", "document.getElementById('verdict').innerText.includes('Largest difference: this picture is')")
        assert page.run("document.querySelectorAll('#tile-box rect').length") == 2 or "whole picture" in page.text("verdict")
        assert "Colours stop at ±5." in page.text("legend-title"), page.text("legend-title")
        page.choose("#split-on")
        time.sleep(0.5)
        page.shot(context.shots, "compare")
        page.choose(f"#effects-on li:nth-child({index + 1}) input")
        page.choose("#costs")
        page.wait("costs", "[...document.querySelectorAll('#effects-on .cost')].length >= 3", 90)
        page.shot(context.shots, "costs")
        costs = page.run("[...document.querySelectorAll('#effects-on .cost')].map(e => e.innerText)")[:2]
        page.key("ArrowLeft")
        page.wait("another picture without costs", "document.querySelectorAll('#effects-on .cost').length === 0")
        return f"verdict: {verdict}; costs: " + " | ".join(costs)


@test
def pictures_from_files_are_shown(context):
    """An EXR without a scene: picture, errors, spectrum of its bands, names of objects."""
    path = Path(context.folder.name) / "bands.exr"
    subprocess.run([context.etalon, "render", SCENES / "prism.json", "--size", "96x60", "--spp", "64", "--bands", "400:700:10",
                    "--aov", "object", "-o", path, "--quiet"], check=True)
    with context.viewer(path) as viewer, context.page(viewer) as page:
        page.wait("the picture", "window.etalonLog?.some(e => e.what === 'picture')")
        page.move(0.5, 0.5)
        page.wait("the spectrum", "window.etalonLog.some(e => e.what === 'spectrum')")
        spectrum = page.log("spectrum")[-1]
        assert spectrum["bands"] == 31 and spectrum["samples"] is None, spectrum
        page.choose("input[name=map][value=relative]")
        page.wait("the map", "window.etalonLog.some(e => e.what === 'map')")
        page.shot(context.shots, "exr")
        status, _ = viewer.get("do/camera", {"content-type": "application/json"}, b'{"camera": null}')
        assert status == 409, status
        return f"{spectrum['bands']} bands of the file"


@test
def strangers_are_refused(context):
    """Without the token, from another origin, under another name: nothing."""
    with context.viewer(SCENES / "cornell.json", "--size", "64x64") as viewer:
        root = re.match(r"http://[^/]+/", viewer.address).group(0)
        token = viewer.address[len(root):].strip("/")
        seen = [
            viewer.get(address=root)[0],
            viewer.get("ask/events", address=root)[0],
            viewer.get(address=root + token[:-1] + ("0" if token[-1] != "0" else "1") + "/")[0],
            viewer.get(headers={"host": "example.org"})[0],
            viewer.get("do/control", {"content-type": "application/json", "origin": "http://example.org"}, b"{}")[0],
            viewer.get("do/control", {"content-type": "text/plain"}, b"{}")[0],
            viewer.get("..%2f..%2fCargo.toml")[0],
            viewer.get("do/effects", {"content-type": "application/json"}, b" " * 100000)[0],
        ]
        assert seen == [403, 403, 403, 421, 403, 415, 404, 413], seen
        with context.page(viewer, address=root) as page:
            time.sleep(0.5)
            text = page.run("document.body.innerText")
            assert "token" in text and not page.run("Boolean(window.etalonLog)"), text
            page.errors.clear()
        return " ".join(map(str, seen))


class Context:
    """What the tests share."""

    def __init__(self, etalon, shots):
        self.etalon, self.shots = etalon, shots
        self.browser = Browser()
        self.folder = tempfile.TemporaryDirectory()

    class _Open:
        def __init__(self, thing, errors):
            self.thing, self.errors = thing, errors

        def __enter__(self):
            return self.thing

        def __exit__(self, kind, *_):
            self.thing.close()
            if self.errors and kind is None and self.thing.errors:
                raise AssertionError("the page reports: " + "; ".join(self.thing.errors[:3]))

    def viewer(self, *words):
        return self._Open(Viewer(self.etalon, *words), False)

    def page(self, viewer, address=None):
        return self._Open(self.browser.page(address or viewer.address), True)

    def status(self, viewer):
        """The status that the server sends first."""
        import urllib.request
        with urllib.request.urlopen(viewer.address + "ask/events", timeout=10) as events:
            for line in events:
                if line.startswith(b"data:"):
                    return json.loads(line[5:])

    def close(self):
        self.browser.close()
        self.folder.cleanup()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("etalon")
    parser.add_argument("--shots", type=Path)
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--pictures", action="store_true")
    parser.add_argument("tests", nargs="*")
    options = parser.parse_intermixed_args()
    context = Context(options.etalon, options.shots)
    failed = []
    try:
        if options.measure:
            from measure import measure
            measure(context)
            return
        if options.pictures:
            from pictures import pictures
            pictures(context, options.tests)
            return
        chosen = [t for t in TESTS if not options.tests or t.__name__ in options.tests]
        for function in chosen:
            start = time.monotonic()
            try:
                seen = function(context)
                print(f"ok      {function.__name__} ({time.monotonic() - start:.1f} s): {seen}", flush=True)
            except Exception as error:
                failed.append(function.__name__)
                print(f"FAILED  {function.__name__}: {type(error).__name__}: {error}", flush=True)
    finally:
        context.close()
    if failed:
        sys.exit(f"{len(failed)} of {len(chosen)} failed: {', '.join(failed)}")
    print(f"all {len(chosen)} passed")


if __name__ == "__main__":
    main()
