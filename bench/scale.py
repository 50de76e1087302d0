#!/usr/bin/env python3
"""How cost grows with the work: triangles, depth of paths, pixels, lights, bands; tables with slopes.

    python3 bench/scale.py                               # all of them
    python3 bench/scale.py --sweeps triangles --most 1000000
    python3 bench/scale.py --out out/scale

Writes OUT/scale.json and OUT/scale.md. The slope of a row is that of the logarithms against the row before: 1 is in proportion.
Seconds are the processor's of the whole process (loading and building on all cores) or of sampling; memory is the peak of the
process, and "bytes each" what it takes more than the smallest of the sweep, over what there is more of. "to 1 %" are the processor's seconds
that the picture's own error of luminance, squared, says it would take to fall to one hundredth, if the variance falls as 1/n. Needs
numpy, and target/release/etalon or the variable ETALON.
"""
import argparse
import json
import math
import os
import pathlib
import random
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "bench/race"))
import peer_etalon  # noqa: E402
import scenes  # noqa: E402

PROGRAM = os.environ.get("ETALON") or str(ROOT / "target/release/etalon")


def render(folder, scene, size, spp, *options):
    """Of a scene of the race, or of one in our own format."""
    path = os.path.join(folder, "scene.json")
    with open(path, "w") as f:
        json.dump(scene if "etalon" in scene else peer_etalon.convert(scene), f)
    command = [PROGRAM, "render", path, "-o", os.path.join(folder, "out.exr"), "--size", "%dx%d" % size, "--spp", str(spp),
               "--clock", "cpu", "--json", *(options or ["--replicates", "1"])]
    before, start = os.times(), time.perf_counter()
    text, peak_mib = peer_etalon.run(command)
    wall, after = time.perf_counter() - start, os.times()
    report = json.loads(text)
    whole = after.children_user + after.children_system - before.children_user - before.children_system
    sampling = report["seconds"] * report["threads"]
    rays = report["rays"] + report["shadow_rays"]
    return {"wall_s": wall, "other_cpu_s": whole - sampling,
            "prepare_s": report["prepare_seconds"], "sampling_cpu_s": sampling, "ns_per_path": 1e9 * sampling / report["paths"],
            "ns_per_ray": 1e9 * sampling / rays, "rays_per_path": rays / report["paths"], "peak_mib": peak_mib,
            "to_1_percent_s": sampling * (report["error"]["relative_rmse"] / 0.01) ** 2 if report.get("error") else math.nan}


def triangles(folder, most):
    scenes.CACHE = folder
    for exponent in range(3, 8):
        count = 10 ** exponent
        if count > most:
            break
        nz = round(math.sqrt(count / 4))
        nx = count // (2 * nz)
        name = "terrain%d" % count
        scene = scenes.mesh1m()
        scene["shapes"][0]["file"] = scenes._mesh(name, lambda: scenes.terrain(nx, nz))
        yield 2 * nx * nz, render(folder, scene, (256, 256), 4)
        os.remove(scenes.mesh_path(name + ".ply"))


def depth(folder, _):
    scenes.CACHE = folder
    for most in (2, 4, 8, 16, 32, 64):
        yield most, render(folder, dict(scenes.cornell(), max_depth=most), (128, 128), 64)


def pixels(folder, _):
    scenes.CACHE = folder
    for side in (256, 512, 1024, 2048, 4096):
        yield side * side, render(folder, scenes.cornell(), (side, side), 1)


def lamps(count, selection):
    """A hall with square lamps of all sizes strewn over it, at most heights; all together always give as much light."""
    rng = random.Random(count)
    side = 20.0
    objects = [{"name": "floor", "material": "grey",
                "shape": {"type": "parallelogram", "origin_m": [-side, 0, -side], "u_m": [0, 0, 2 * side], "v_m": [2 * side, 0, 0]}}]
    for i in range(30):
        x, z, r = rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(0.3, 0.9)
        objects.append({"name": "ball %d" % i, "material": "grey",
                        "shape": {"type": "sphere", "center_m": [x, r, z], "radius_m": r}})
    sizes = [rng.uniform(0.2, 1.0) for _ in range(count)]
    factor = 1.0 / math.sqrt(sum(size * size for size in sizes))
    for i, size in enumerate(sizes):
        x, z, y, a = rng.uniform(-side, side), rng.uniform(-side, side), rng.uniform(2, 4), size * factor
        objects.append({"name": "lamp %d" % i, "material": {"type": "black"},
                        "shape": {"type": "parallelogram", "origin_m": [x, y, z], "u_m": [a, 0, 0], "v_m": [0, 0, a]},
                        "emission": {"radiance": 200.0}})
    return {"etalon": 1, "camera": {"type": "perspective", "position_m": [0, 6, 16], "look_at_m": [0, 0, 2], "vertical_fov_deg": 40},
            "film": {"width": 96, "height": 96}, "integrator": {"max_depth": 3, "light_selection": selection},
            "materials": {"grey": {"type": "lambert", "reflectance": 0.5}}, "objects": objects}


def lights(folder, most, selection="auto"):
    for count in (1, 2, 4, 8, 16, 32, 100, 1000, 10000, 100000):
        yield count, render(folder, lamps(count, selection), (96, 96), 64, "--replicates", "4", "--adaptive", "never")


def lights_by_power(folder, most):
    yield from lights(folder, most, "power")


def lights_by_tree(folder, most):
    yield from lights(folder, most, "tree")


def bands(folder, _):
    scenes.CACHE = folder
    for count in (1, 2, 4, 8, 16, 32, 64):
        step = 320 / count
        yield count, render(folder, scenes.cornell(), (128, 128), 64, "--replicates", "1", "--bands",
                            "%g:%g:%g" % (400 + step / 2, 720 - step / 2, step))


SWEEPS = {"triangles": triangles, "depth": depth, "pixels": pixels, "lights": lights, "lights-by-power": lights_by_power,
          "lights-by-tree": lights_by_tree, "bands": bands}
COLUMNS = {"prepare_s": "%.3f", "other_cpu_s": "%.2f", "sampling_cpu_s": "%.2f", "ns_per_path": "%.0f", "ns_per_ray": "%.0f",
           "rays_per_path": "%.2f", "peak_mib": "%.0f", "to_1_percent_s": "%.2f"}


def table(name, rows):
    lines = ["## " + name.capitalize(), "", "| %s | %s | slope of ns a path | slope of CPU s | bytes each |" % (name, " | ".join(COLUMNS)),
             "|---:|" + "---:|" * (len(COLUMNS) + 3)]
    for i, (work, row) in enumerate(rows):
        cells = [form % row[key] for key, form in COLUMNS.items()]
        slope = lambda of: "%.2f" % (math.log(of(row) / of(rows[i - 1][1])) / math.log(work / rows[i - 1][0])) if i else ""
        whole = lambda row: row["other_cpu_s"] + row["sampling_cpu_s"]
        more = (row["peak_mib"] - rows[0][1]["peak_mib"]) * 2 ** 20 / (work - rows[0][0]) if i else None
        lines.append("| %d | %s | %s | %s | %s |" % (work, " | ".join(cells), slope(lambda r: r["ns_per_path"]), slope(whole),
                                                   "" if more is None else "%.0f" % more))
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sweeps", type=lambda text: text.split(","), default=list(SWEEPS), help="of " + ", ".join(SWEEPS))
    parser.add_argument("--most", type=int, default=10 ** 7, help="triangles")
    parser.add_argument("--out", default=str(ROOT / "out/scale"))
    args = parser.parse_args()
    unknown = [name for name in args.sweeps if name not in SWEEPS]
    if unknown:
        parser.error("unknown: %s; there are %s" % (", ".join(unknown), ", ".join(SWEEPS)))
    os.makedirs(args.out, exist_ok=True)
    result = {}
    with tempfile.TemporaryDirectory(prefix="scale-") as folder:
        for name in args.sweeps:
            rows = []
            for work, row in SWEEPS[name](folder, args.most):
                rows.append((work, row))
                print(name, work, row, flush=True)
            result[name] = rows
    pathlib.Path(args.out, "scale.json").write_text(json.dumps(result, indent=1))
    text = "\n".join(table(name, rows) for name, rows in result.items())
    pathlib.Path(args.out, "scale.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
