"""What the tests of the page share: the list of tests, and how to wait for pictures."""

from browser import ROOT

SCENES = ROOT / "scenes"
TESTS = []


def test(function):
    TESTS.append(function)
    return function


def settled(page, samples=1, seconds=60):
    """Waits for a picture of all pixels."""
    page.wait("a picture of all pixels", f"window.etalonLog?.some(e => e.what === 'error' && e.block === 1 && e.samples >= {samples})", seconds)


def ended(page):
    """Waits until the samples that the pilot planned for the stated error are taken."""
    page.wait("the end of the render", "document.getElementById('phase')?.dataset.phase === 'done'", 120)


def pictures_pass(page, count=3):
    """Waits until so many more pictures of all pixels are shown."""
    before = page.run("window.etalonLog.length")
    page.wait("more pictures", f"window.etalonLog.slice({before}).filter(e => e.what === 'error' && e.block === 1).length >= {count}", 60)
