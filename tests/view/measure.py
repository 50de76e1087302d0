"""The figures of docs/how-to/view.md: see page.py --measure."""

import json
import re
import subprocess
import time

SCENES = ["cornell", "vase", "thin-lens", "diamond", "evening"]


def first_pictures(context, scenes):
    """When the page of each shipped scene first shows a picture, and one of at most 50 % relative error, by its own log."""
    print("| scene | page runs | first picture | its error | at most 50 % | first of all pixels |")
    print("|---|---|---|---|---|---|")
    for path in scenes:
        with context.viewer(path) as viewer, context.page(viewer) as page:
            page.wait("a picture of all pixels", "window.etalonLog?.some(e => e.what === 'picture' && e.block === 1)", 120)
            loaded = page.run("performance.getEntriesByType('navigation')[0].loadEventEnd")
            begun = page.log("begin")[0]["at_ms"]
            pictures = [p for p in page.log("picture") if p["relative_rmse"] is not None]
            good = next((p for p in pictures if p["relative_rmse"] <= 0.5), None)
            whole = next(p for p in pictures if p["block"] == 1)
            first = pictures[0]
            print(f"| {path.stem} | {max(begun, loaded):.0f} ms | {first['at_ms']:.0f} ms | {100 * first['relative_rmse']:.0f} % |"
                  f" {good['at_ms'] if good else float('nan'):.0f} ms | {whole['at_ms'] / 1000:.1f} s |", flush=True)


def against_command_line(context, path, error, rounds=3):
    """Seconds from the start of the program to the stated error, with a page that looks on and by `etalon render`, in turns; and the
    processor time of threads that do not render."""
    ours, theirs, shares = [], [], []
    for _ in range(rounds):
        start = time.monotonic()
        with context.viewer(path, "--error", error) as viewer, context.page(viewer) as page:
            page.wait("the end of the render", "document.getElementById('phase')?.dataset.phase === 'done'", 600)
            ours.append(time.monotonic() - start)
            threads = viewer.cpu_seconds()
            server = sum(v for name, v in threads.items() if re.match(r"view-(answer|picture|files)|etalon$", name))
            shares.append(server / threads["all"])
            reached = context.status(viewer)
        start = time.monotonic()
        out = subprocess.run([context.etalon, "render", path, "--error", error, "-o", f"{context.folder.name}/x.exr", "--json"],
                             check=True, capture_output=True, text=True).stdout
        theirs.append(time.monotonic() - start)
        report = json.loads(out)
        print(f"{path.stem} to {error}: view {ours[-1]:.1f} s ({reached['samples']} samples, error {reached['error']['relative_rmse']:.4f}), "
              f"render {theirs[-1]:.1f} s ({report['spp']} samples, error {report['error']['relative_rmse']:.4f}); "
              f"server's share of processor time {100 * shares[-1]:.1f} %", flush=True)
    print(f"ratio of sums: {sum(ours) / sum(theirs):.3f}; largest share {100 * max(shares):.1f} %")


def measure(context):
    from page import SCENES as FOLDER
    first_pictures(context, [FOLDER / f"{name}.json" for name in SCENES])
    against_command_line(context, FOLDER / "cornell.json", "5%")
