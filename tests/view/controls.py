"""Tests of what people press, choose and compare on the page."""

import json
import re
import time
import urllib.request

from suite import SCENES, pictures_pass, settled, test


@test
def stop_buttons_keep_click_and_focus(context):
    """A slow click on a stop button counts, though pictures come meanwhile; the button keeps the focus."""
    with context.viewer(SCENES / "cornell.json", "--size", "192x192", "--error", "0.7%") as viewer, context.page(viewer) as page:
        settled(page)
        selector = "input[name=target][value='0.01']"
        page.run(f"window.button = document.querySelector({json.dumps(selector)})")
        page.press(selector, while_down=lambda: pictures_pass(page))
        state = "[window.button.isConnected, window.button.checked, document.activeElement === window.button]"
        assert page.run(state) == [True, True, True], page.run(state)
        pictures_pass(page)
        assert page.run(state) == [True, True, True], page.run(state)
        target = context.status(viewer)["target"]
        assert target == 0.01, target
        values = [float(v) for v in page.run("[...document.querySelectorAll('input[name=target]')].map(e => e.value)")]
        # What was said in percent is a share now, rounded once.
        assert [round(v, 12) for v in values] == [0.05, 0.02, 0.01, 0.007, 0.0], values
        return f"stops at {target}; the buttons are {values}"


@test
def keys_reach_the_page_whatever_has_the_focus(context):
    """A focused button, slider or box keeps its own keys; all others reach the page."""
    with context.viewer(SCENES / "cornell.json", "--size", "96x96") as viewer, context.page(viewer) as page:
        settled(page)
        page.focus("input[name=map][value='']")
        page.key("m")
        assert page.run("document.querySelector('input[name=map]:checked').value") == "of-mean"
        page.focus("#exposure")
        page.key("w")
        page.wait("a step", "!document.getElementById('home').hidden")
        page.focus("#exposure-auto")
        page.key(" ")
        page.focus("summary")
        page.key(" ")
        time.sleep(0.5)
        assert page.run("document.getElementById('exposure-auto').checked && document.querySelector('details').open")
        assert page.run("document.getElementById('phase').dataset.phase") != "paused"
        page.focus("#picture")
        page.key(" ")
        page.wait("the pause", "document.getElementById('phase').dataset.phase === 'paused'")
        return "M at a button, W at a slider; Space at a box, a summary and the picture"


@test
def a_picked_white_stays(context):
    """A picked white holds while the camera moves, and another one can be picked."""
    with context.viewer(SCENES / "cornell.json", "--size", "256x256") as viewer, context.page(viewer) as page:
        settled(page)

        def pick(x, y):
            before = page.run("document.getElementById('save-png').href")
            page.select("white", "pick")
            page.click(x, y)
            page.wait("the picked white", f"document.getElementById('save-png').href !== {json.dumps(before)}")
            assert page.run("document.getElementById('white').value") == "spot"
            return re.search(r"white=([^&]*)", page.run("document.getElementById('save-png').href")).group(1)

        first = pick(0.5, 0.4)
        seen = page.run("window.etalonLog.length")

        def a_coarse_picture():
            nonlocal seen
            page.wait("a coarse picture", f"window.etalonLog.slice({seen}).some(e => e.what === 'picture' && e.block > 1)", 20)
            seen = page.run("window.etalonLog.length")

        page.drag((0.5, 0.6), (0.6, 0.6), steps=3, after_step=a_coarse_picture)
        assert page.log("picture-refused") == []
        page.select("white", "pick")
        page.key("Escape")
        assert page.run("document.getElementById('white').value") == "spot"
        settled(page)
        second = pick(0.4, 0.45)
        assert first.startswith("xy") and second.startswith("xy") and first != second, (first, second)
        return f"{first}, then {second}"


@test
def only_other_pictures_are_compared(context):
    """Pictures of one render are not compared, and a coarse picture is not pinned."""
    with context.viewer(SCENES / "cornell.json", "--size", "256x256", "--error", "0.5%") as viewer, context.page(viewer) as page:
        settled(page)
        page.key("p")
        page.wait("the pin", "!document.getElementById('unpin').hidden")
        pictures_pass(page)
        assert "Now change something" in page.text("verdict") and page.log("comparison") == [], page.text("verdict")
        number = context.status(viewer)["pinned"]["number"]

        def a_coarse_picture():
            page.wait("a coarse picture", "document.getElementById('pin').disabled", 20)
            page.key("p")

        page.drag((0.5, 0.6), (0.6, 0.6), steps=3, after_step=a_coarse_picture)
        assert context.status(viewer)["pinned"]["number"] == number
        page.wait("the comparison", "window.etalonLog.some(e => e.what === 'comparison')", 60)
        page.wait("the verdict", "document.getElementById('verdict').innerText.includes('more than their noise')", 60)
        words = page.text("verdict")
        assert "in 1 of 1000 cases" in words and "Largest difference:" in words, words
        return words


@test
def orbits_turn_about_the_up_of_the_scene(context):
    """After a look down and a new page, a drag to the side still turns about what the scene calls up."""
    with context.viewer(SCENES / "cornell.json", "--size", "96x96") as viewer:
        with context.page(viewer) as page:
            settled(page)
            page.drag((0.5, 0.3), (0.5, 0.65))
            page.wait("the camera", "!(document.getElementById('home')?.hidden ?? true)")
        with context.page(viewer) as page:
            page.wait("the page", "!(document.getElementById('home')?.hidden ?? true)")
            before = context.status(viewer)
            page.drag((0.4, 0.5), (0.6, 0.5))
            time.sleep(1)
            after = context.status(viewer)
        forward, up, world = after["camera"]["forward"], after["camera"]["up"], after["world_up"]
        assert forward != before["camera"]["forward"]
        dot = sum(a * b for a, b in zip(up, world))
        right = [forward[(i + 1) % 3] * up[(i + 2) % 3] - forward[(i + 2) % 3] * up[(i + 1) % 3] for i in range(3)]
        tilt = sum(a * b for a, b in zip(right, world))
        assert abs(dot) < 0.7 and abs(tilt) < 1e-6, (dot, tilt)
        return f"up is {dot:.2f} of the world's, the horizon tilts by {tilt:.0e}"


@test
def a_refused_page_asks_again(context):
    """The seventeenth page says why it is refused, and runs as soon as there is room."""
    with context.viewer(SCENES / "cornell.json", "--size", "64x64") as viewer:
        others = [urllib.request.urlopen(viewer.address + "ask/events", timeout=30) for _ in range(16)]
        with context.page(viewer) as page:
            page.wait("the reason", "document.getElementById('phase')?.innerText.includes('pages look on already')")
            words = page.text("phase")
            for other in others:
                other.close()
            page.wait("the status", "window.etalonLog.some(e => e.what === 'status')", 30)
            page.errors.clear()
        return words
