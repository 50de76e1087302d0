#!/usr/bin/env python3
"""Draws the charts of docs/performance.md from its own tables: docs/images/race.svg and rays.svg. Needs nothing but Python.

    docs/charts.py            writes the charts
    docs/charts.py --check    fails if a chart is not what the tables say
"""
import html
import math
import pathlib
import sys

DOCS = pathlib.Path(__file__).resolve().parent
ROW, LEFT, WIDTH, TOP = 22, 270, 420, 40


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
    """Bars on a logarithmic axis that begin at 1. `bars`: (label, value); `faster`: whether a value above 1 is the better one."""
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
        good = value >= 1 if faster else value <= 1
        begin, end = sorted((x(1), x(value)))
        out.append(f'<text x="{LEFT - 8}" y="{y + 13}" text-anchor="end">{html.escape(label)}</text>')
        out.append(f'<rect x="{begin:.1f}" y="{y + 2}" width="{end - begin:.1f}" height="14" fill="{"#3b76af" if good else "#c85a3c"}"/>')
        side = (end + 4, "start") if value >= 1 else (begin - 4, "end")
        out.append(f'<text x="{side[0]:.1f}" y="{y + 13}" text-anchor="{side[1]}">{value:g}</text>')
    return "\n".join(out + ["</svg>", ""])


def charts():
    page = (DOCS / "performance.md").read_text(encoding="utf-8")
    race = [(row[0].replace("`", ""), float(row[1])) for row in table(page, "race")]
    rays = [(f"{row[0]}: {row[1]}", float(row[3])) for row in table(page, "rays")]
    return {"race.svg": chart("Time to a given error ÷ Mitsuba spectral (left of 1: Etalon needs less)", race, 0.1, 3, False),
            "rays.svg": chart("Rays per second ÷ Embree, default mode (right of 1: Etalon is faster)", rays, 0.5, 3, True)}


def main(arguments):
    stale = []
    for name, text in charts().items():
        path = DOCS / "images" / name
        if "--check" not in arguments:
            path.write_text(text, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != text:
            stale.append(name)
    if stale:
        print(f"not what docs/performance.md says: {', '.join(stale)}; run cargo xtask charts", file=sys.stderr)
    return bool(stale)


sys.exit(main(sys.argv[1:]))
