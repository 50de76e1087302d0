"""The screenshots of docs/how-to/view.md: see page.py --pictures."""

import time


def wait_error(page, error, seconds=300):
    page.wait(f"an error of {error}", "window.etalonLog?.some(e => e.what === 'picture' && e.block === 1 && "
              f"e.relative_rmse !== null && e.relative_rmse <= {error})", seconds)
    time.sleep(0.4)


def cornell(context, page):
    wait_error(page, 0.05)
    page.shot(context.shots, "cornell")


def vase(context, page):
    wait_error(page, 0.03)
    page.choose("input[name=map][value=of-mean]")
    page.wait("the map", "window.etalonLog.some(e => e.what === 'map')")
    time.sleep(0.3)
    page.shot(context.shots, "vase-error")


def spectroscope(context, page):
    wait_error(page, 0.2)
    page.run("document.getElementById('accuracy').hidden = true")
    page.move(*SPECTRUM_AT)
    page.wait("the spectrum", "window.etalonLog.some(e => e.what === 'spectrum' && e.samples >= 65536)", 60)
    page.shot(context.shots, "spectroscope")


def cornell_glass(context, page):
    wait_error(page, 0.08)
    page.run("document.getElementById('accuracy').hidden = true")
    page.move(*PATHS_AT)
    time.sleep(0.5)
    page.click(*PATHS_AT)
    page.wait("the paths", "window.etalonLog.some(e => e.what === 'paths')")
    time.sleep(0.5)
    page.run("document.getElementById('pixel').hidden = true")
    page.shot(context.shots, "cornell-glass-paths")


def metals(context, page):
    wait_error(page, 0.03)
    page.choose("#pin")
    page.wait("the pin", "!document.getElementById('unpin').hidden")
    page.run("[...document.querySelectorAll('#effects-on li')].find(e => e.innerText.startsWith('specular chains')).querySelector('input').click()")
    before = page.run("window.etalonLog.length")
    page.wait("the comparison", f"window.etalonLog.slice({before}).some(e => e.what === 'comparison')", 120)
    page.wait("the end of the render", "document.getElementById('phase')?.dataset.phase === 'done'", 120)
    page.choose("#split-on")
    page.choose("input[name=map][value=difference]")
    page.run("(() => { const e = document.getElementById('map-opacity'); e.value = 0.5; e.dispatchEvent(new Event('input')); })()")
    time.sleep(1.5)
    page.run("for (const name of ['accuracy', 'pixel', 'look']) document.getElementById(name).hidden = true; document.getElementById('compare').scrollIntoView()")
    page.shot(context.shots, "metals-compared")


# Shares of the width and height: light behind the prism, and the glass ball.
SPECTRUM_AT = (0.605, 0.42)
PATHS_AT = (0.68, 0.7)
SHOTS = [("cornell", "1%", cornell), ("vase", "1%", vase), ("spectroscope", "1%", spectroscope),
         ("cornell-glass", "1%", cornell_glass), ("metals", "3%", metals)]


def pictures(context, names):
    from page import SCENES
    for name, error, take in SHOTS:
        if names and name not in names:
            continue
        with context.viewer(SCENES / f"{name}.json", "--error", error) as viewer, context.page(viewer) as page:
            take(context, page)
            print(f"{name}: {page.log('error')[-1]['relative_rmse']}", flush=True)
