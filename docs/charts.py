#!/usr/bin/env python3
"""Draws charts from the tables of docs/performance.md (docs/images/race.svg, rays.svg), docs/accuracy.md (coverage.svg) and
docs/hard-cases.md (mitsuba.svg).

Needs nothing but Python.

    docs/charts.py            writes the charts
    docs/charts.py --check    fails if a chart is not what the tables say
"""
import html
import math
import pathlib
import sys

DOCS = pathlib.Path(__file__).resolve().parent
ROW, LEFT, WIDTH, TOP = 22, 300, 420, 40


def table(page, name):
    """Rows of the first table below `<!-- chart: NAME -->`, as lists of cells."""
    lines = iter(page.split(f"<!-- chart: {name} -->", 1)[1].splitlines())
    rows = []
    for line in lines:
        if line.startswith("|"):
            rows.append([cell.strip() for cell in line.strip("|").split("|")])
        elif rows:
            break
    return rows[2:]


def chart(title, bars, low, high, faster):
    """Bars on a logarithmic axis that begin at 1. `bars`: (label, value); `faster`: whether a value above 1 is the better one, or None."""
    def x(value):
        return LEFT + WIDTH * math.log(value / low) / math.log(high / low)

    height = TOP + ROW * len(bars) + 36
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {LEFT + WIDTH + 60} {height}" font-family="sans-serif" font-size="12">',
           f'<title>{html.escape(title)}</title>',
           '<rect width="100%" height="100%" fill="#ffffff"/>',
           f'<text x="10" y="20" font-size="14">{html.escape(title)}</text>']
    for tick in (0.125, 0.25, 0.5, 0.75, 1, 1.5, 2, 3):
        if low <= tick <= high:
            colour = "#222222" if tick == 1 else "#dddddd"
            out.append(f'<line x1="{x(tick):.1f}" x2="{x(tick):.1f}" y1="{TOP - 6}" y2="{height - 28}" stroke="{colour}"/>')
            out.append(f'<text x="{x(tick):.1f}" y="{height - 12}" text-anchor="middle">{tick:g}</text>')
    for index, (label, value) in enumerate(bars):
        y = TOP + ROW * index
        good = faster is not None and (value >= 1 if faster else value <= 1)
        begin, end = sorted((x(1), x(value)))
        out.append(f'<text x="{LEFT - 8}" y="{y + 13}" text-anchor="end">{html.escape(label)}</text>')
        out.append(f'<rect x="{begin:.1f}" y="{y + 2}" width="{end - begin:.1f}" height="14" fill="{"#3b76af" if good else "#c85a3c"}"/>')
        side = (end + 4, "start") if value >= 1 else (begin - 4, "end")
        out.append(f'<text x="{side[0]:.1f}" y="{y + 13}" text-anchor="{side[1]}">{value:g}</text>')
    return "\n".join(out + ["</svg>", ""])


def lines(title, curves):
    """A line for each scene: x, samples per pixel on a logarithmic axis; y, per cent from 0 to 100."""
    left, top, width, height = 60, 40, 420, 250
    colours = ["#888888", "#2b8a3e", "#3b76af", "#8a5fb0", "#d08a1d", "#c85a3c"]

    def at(samples, percent):
        return f"{left + width * math.log2(samples / 4) / 8:.1f},{top + height * (1 - percent / 100):.1f}"

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left + width + 190} {top + height + 50}" '
           'font-family="sans-serif" font-size="12">',
           f'<title>{html.escape(title)}</title>',
           '<rect width="100%" height="100%" fill="#ffffff"/>',
           f'<text x="10" y="20" font-size="14">{html.escape(title)}</text>']
    for percent in (0, 25, 50, 75, 95):
        x, y = at(4, percent).split(",")
        colour = "#222222" if percent == 95 else "#dddddd"
        out.append(f'<line x1="{x}" x2="{left + width}" y1="{y}" y2="{y}" stroke="{colour}"/>')
        out.append(f'<text x="{left - 8}" y="{float(y) + 4:.1f}" text-anchor="end">{percent} %</text>')
    for samples in (4, 16, 64, 256, 1024):
        out.append(f'<text x="{at(samples, 0).split(",")[0]}" y="{top + height + 20}" text-anchor="middle">{samples}</text>')
    out.append(f'<text x="{left + width / 2}" y="{top + height + 40}" text-anchor="middle">samples per pixel</text>')
    for index, (label, points) in enumerate(curves.items()):
        colour = colours[index % len(colours)]
        path = " ".join(at(*point) for point in points)
        out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out.extend(f'<circle cx="{at(*point).split(",")[0]}" cy="{at(*point).split(",")[1]}" r="3" fill="{colour}"/>' for point in points)
        y = top + 14 + 20 * index
        out.append(f'<rect x="{left + width + 14}" y="{y - 10}" width="12" height="12" fill="{colour}"/>')
        out.append(f'<text x="{left + width + 32}" y="{y}">{html.escape(label)}</text>')
    return "\n".join(out + ["</svg>", ""])


def coverage(page):
    curves = {}
    for row in table(page, "coverage"):
        curves.setdefault(row[0], []).append((int(row[1]), float(row[2].removesuffix(" %"))))
    return curves


def truths(page):
    """Mitsuba's reading over the truth, of each row in which it is neither 0 nor off the chart."""
    for name, value, reading, *_ in table(page, "mitsuba"):
        ratio = float(reading.split(" ")[0]) / float(value)
        if 0.2 <= ratio <= 4:
            yield name.strip("`"), float(f"{ratio:.4g}")


def charts():
    page = (DOCS / "performance.md").read_text(encoding="utf-8")
    accuracy = (DOCS / "accuracy.md").read_text(encoding="utf-8")
    hard = (DOCS / "hard-cases.md").read_text(encoding="utf-8")
    race = [(row[0].replace("`", ""), float(row[1])) for row in table(page, "race")]
    rays = [(f"{row[0]}: {row[1]}", float(row[3])) for row in table(page, "rays")]
    return {"race.svg": chart("Time to a given error ÷ Mitsuba spectral (left of 1: Etalon needs less)", race, 0.1, 3, False),
            "rays.svg": chart("Rays per second ÷ Embree, default mode (right of 1: Etalon is faster)", rays, 0.5, 3, True),
            "mitsuba.svg": chart("Mitsuba 3.9.1's reading ÷ the exact answer, where it is wrong", list(truths(hard)), 0.14, 4, None),
            "coverage.svg": lines("Pixels whose 95 % interval holds the truth", coverage(accuracy))}


def main(arguments):
    stale = []
    for name, text in charts().items():
        path = DOCS / "images" / name
        if "--check" not in arguments:
            path.write_text(text, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != text:
            stale.append(name)
    if stale:
        print(f"not what the tables say: {', '.join(stale)}; run cargo xtask charts", file=sys.stderr)
    return bool(stale)


sys.exit(main(sys.argv[1:]))
