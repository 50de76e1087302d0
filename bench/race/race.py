#!/usr/bin/env python3
"""Time to a stated error: Etalon and every installed peer on five scenes, in turns.

    python3 bench/race/race.py                                   # all scenes, all that is installed
    python3 bench/race/race.py --scenes cornell,dof --entries etalon,mitsuba-spectral --spp 16,64 --rounds 4
    python3 bench/race/race.py --draw 12                         # twelve scenes drawn from the commit, see draw.py

A drawn scene is a file of Mitsuba 3. Etalon and Mitsuba read it themselves, read_mitsuba.py reads it for LuxCore and Cycles. A drawn
race adds its scenes and figures to docs/log/drawn-races.jsonl, whatever they are: one line for each draw.

Writes OUT/race.json and OUT/race.md (--out, default out/race). Needs numpy and OpenEXR, and target/release/etalon (or the
variable ETALON); see README.md beside this file for the peers.

**Error.** relMSE = mean over pixels and channels of (x − ref)²/(ref² + 0.01), linear Rec. 709, ref the renderer's own mean over
all that it rendered here. With K renders xₖ of one level that differ in their seed alone, E (x − ref)² is estimated by
Σ(xₖ − x̄)²/(K − 1), which holds no error of the reference.

**Time.** The processor's seconds of all threads while samples are taken; loading, building and compiling are apart. Other
programs on the machine change it little, and each entry meets the same of it, since the entries take turns in each round.
"""
import argparse
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

import numpy as np

import draw
import hard

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
EPS = 0.01

# name: (peer, variant, options, scenes it is left out of)
ENTRIES = {
    "etalon": ("etalon", "cpu", {}, ()),
    "etalon-error-bars": ("etalon", "cpu", {"replicates": 4}, ()),
    "etalon-path-reuse": ("etalon", "cpu", {"path-reuse": "4x4"}, ("prism", "prism-plain")),
    "mitsuba-spectral": ("mitsuba", "llvm_ad_spectral", {"sampler": "multijitter", "chunk": 1024}, ("prism",)),
    "mitsuba-rgb": ("mitsuba", "llvm_ad_rgb", {"sampler": "multijitter", "chunk": 1024}, ("prism",)),
    "mitsuba-mono": ("mitsuba", "llvm_ad_mono", {"sampler": "multijitter", "chunk": 1024}, ("cornell", "glass", "prism-plain", "dof", "mesh1m")),
    "luxcore": ("luxcore", "pathcpu", {}, ("prism-plain",)),
    "luxcore-bidirectional": ("luxcore", "bidircpu", {}, ("prism-plain",)),
    "luxcore-light-paths": ("luxcore", "pathcpu", {"light_paths": True}, ("prism-plain",)),
    "cycles": ("cycles", "cpu", {}, ("prism",)),
    "cycles-shadow-caustics": ("cycles", "cpu", {"shadow_caustics": True}, ("prism",)),
}
SPP = {"cornell": [16, 64], "glass": [16, 64], "prism": [64, 256], "prism-plain": [64, 256], "dof": [16, 64], "mesh1m": [16, 64]}


DRAWN_ENTRIES = ["etalon", "mitsuba-spectral", "mitsuba-rgb", "luxcore", "cycles"]
# Ways to find caustics, which ordinary scenes do not ask for.
CAUSTIC_ENTRIES = ["luxcore-bidirectional", "luxcore-light-paths", "cycles-shadow-caustics"]
LOG = ROOT / "docs/log/drawn-races.jsonl"


class Worker:
    """A renderer with a scene, in a process of its own."""

    def __init__(self, name, scene, threads, folder):
        peer, variant, opts, _ = ENTRIES[name]
        self.name, self.out = name, os.path.join(folder, "%s.npy" % name)
        command = [sys.executable, str(HERE / "worker.py"), peer, variant, scene, str(threads), json.dumps(opts)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        self.about = self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        return json.loads(line) if line else {"missing": "ended with status %s" % self.process.wait()}

    def render(self, spp, seed):
        self.process.stdin.write(json.dumps({"spp": spp, "seed": seed, "out": self.out}) + "\n")
        self.process.stdin.flush()
        done = self.answer()
        if "missing" in done:
            raise RuntimeError("%s: %s" % (self.name, done["missing"]))
        return np.load(self.out).astype(np.float64), done

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Level:
    """The renders of one entry at one number of samples."""

    def __init__(self):
        self.n, self.sum, self.squares, self.runs = 0, 0.0, 0.0, []

    def add(self, image, done):
        # About the first render, lest the squares of bright pixels eat the digits.
        self.first = image if self.n == 0 else self.first
        d = image - self.first
        self.n, self.sum, self.squares = self.n + 1, self.sum + d, self.squares + d * d
        self.runs.append(done)

    def mean(self):
        return self.first + self.sum / self.n

    def variance(self):
        return (self.squares - self.sum ** 2 / self.n) / (self.n - 1)


def time_to(levels, target):
    """CPU seconds to a relMSE, on the line through the two last levels in log–log."""
    points = [(l["cpu_s"], l["relmse"]) for l in levels if l["relmse"] and l["relmse"] > 0]
    if not points:
        return None
    if len(points) == 1 or points[-2][1] <= points[-1][1]:
        return points[-1][0] * points[-1][1] / target
    (t0, e0), (t1, e1) = np.log(points[-2:])
    return float(np.exp(t1 + (np.log(target) - e1) * (t1 - t0) / (e1 - e0)))


def run_scene(scene, names, args, folder):
    workers, missing = [], {}
    for name in names:
        if scene in ENTRIES[name][3]:
            continue
        worker = Worker(name, scene, args.threads, folder)
        if "missing" in worker.about:
            missing[name] = worker.about["missing"]
            print("  %s is left out: %s" % (name, worker.about["missing"]), flush=True)
            continue
        workers.append(worker)
    spps = args.spp or SPP.get(scene, [16, 64])
    kept = {w.name: {spp: Level() for spp in spps} for w in workers}
    for spp in spps:
        for w in workers:
            if ENTRIES[w.name][0] == "mitsuba":
                w.render(spp, 98)  # compiles: the sample count is part of the program
    for turn in range(args.rounds):
        for spp in spps:
            # Each in turn, and in the other direction every second time.
            for w in workers if turn % 2 == 0 else workers[::-1]:
                kept[w.name][spp].add(*w.render(spp, 1000 * spp + turn))
    entries = {}
    for w in workers:
        levels = kept[w.name]
        weight = {spp: level.n * level.runs[0]["spp"] for spp, level in levels.items()}
        ref = sum(weight[spp] * level.mean() for spp, level in levels.items()) / sum(weight.values())
        rows = []
        for spp, level in levels.items():
            of = lambda key: float(np.median([run[key] for run in level.runs]))
            pixels = ref.shape[0] * ref.shape[1]
            error = float((level.variance() / (ref ** 2 + EPS)).mean()) if level.n > 1 else None
            rows.append({"spp": of("spp"), "cpu_s": of("cpu_s"), "wall_s": of("wall_s"), "relmse": error,
                         "paths_per_cpu_s": of("spp") * pixels / of("cpu_s"),
                         "efficiency": error and error * of("cpu_s"),
                         "nonfinite": max(run["nonfinite"] for run in level.runs)})
        last = levels[spps[-1]].runs[-1]
        # The variance of the picture's mean over the renders, which are independent.
        mean, noise = ref.mean((0, 1)), 0.0
        for spp, level in levels.items():
            if level.n > 1:
                noise = noise + (weight[spp] / sum(weight.values())) ** 2 * level.variance().mean((0, 1)) / pixels / level.n
        entries[w.name] = {"about": w.about, "levels": rows, "peak_mib": last["peak_mib"], "extra": last["extra"],
                           "mean_rgb": mean.tolist(), "mean_rgb_error": np.sqrt(noise).tolist()}
        np.save(os.path.join(args.out, "%s-%s.npy" % (os.path.basename(scene), w.name)), ref.astype(np.float32))
        entries[w.name]["ref"] = ref
        entries[w.name]["ref_variance"] = sum((weight[spp] / sum(weight.values())) ** 2 * level.variance() / level.n
                                              for spp, level in levels.items()) if args.rounds > 1 else None
        w.close()
    compare(entries)
    for entry in entries.values():
        del entry["ref"], entry["ref_variance"]
    return {"entries": entries, "missing": missing}


def blocks(image, size=16):
    h, w = image.shape[0] // size * size, image.shape[1] // size * size
    return image[:h, :w].reshape(h // size, size, w // size, size, -1).mean((1, 3))


def compare(entries, size=16):
    """Each entry's picture against the first one's: ratio of the means, and z over blocks of pixels.

    Where the pictures are the same, the squares of z over the blocks have mean 1, but for heavy tails."""
    names = list(entries)
    for name in names[1:]:
        a, b = entries[names[0]], entries[name]
        mean_a, mean_b = np.array(a["mean_rgb"]), np.array(b["mean_rgb"])
        b["same"] = {"as": names[0], "ratio_of_means": (mean_b / mean_a).tolist(),
                     "z_of_means": ((mean_b - mean_a) / np.hypot(a["mean_rgb_error"], b["mean_rgb_error"])).tolist()}
        if a["ref_variance"] is not None:
            variance = (blocks(a["ref_variance"], size) + blocks(b["ref_variance"], size)) / size ** 2
            difference = blocks(b["ref"], size) - blocks(a["ref"], size)
            lit = variance > 0
            z = difference[lit] / np.sqrt(variance[lit])
            b["same"].update(blocks=int(z.size), rms_z=float(np.sqrt((z ** 2).mean())), largest_z=float(np.abs(z).max()))


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "?")
    commit = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"], capture_output=True, text=True)
    return {"cpu": model, "cores": os.cpu_count(), "system": platform.platform(), "commit": commit.stdout.strip() or None,
            "date": datetime.date.today().isoformat()}


def report(result):
    m = result["machine"]
    lines = ["# The race", "", "%s, %d cores, %s; commit %s, %s; %d threads, %d rounds." % (
        m["cpu"], m["cores"], m["system"], m["commit"], m["date"], result["threads"], result["rounds"]), "",
        "efficiency = relMSE × CPU seconds at the largest number of samples, lower is better; × first: that over the first entry's.",
        "", "| scene | entry | M paths/CPU s | relMSE at spp | t(target) CPU s | efficiency | × first | start s | load s | peak MiB |",
        "|---|---|---|---|---|---|---|---|---|---|"]
    for path, done in result["scenes"].items():
        scene, first = os.path.basename(path), None
        for name, e in done["entries"].items():
            last = e["levels"][-1]
            first = first or last
            target = 2 * first["relmse"] if first["relmse"] else None
            errors = ", ".join("%g: %.3g" % (l["spp"], l["relmse"] or float("nan")) for l in e["levels"])
            to = time_to(e["levels"], target) if target else None
            lines.append("| %s | %s | %.2f | %s | %s | %s | %s | %.2f | %.2f | %.0f |" % (
                scene, name, last["paths_per_cpu_s"] / 1e6, errors, "%.2f (%.2g)" % (to, target) if to else "",
                "%.3g" % last["efficiency"] if last["efficiency"] else "",
                "%.2f" % (last["efficiency"] / first["efficiency"]) if last["efficiency"] else "",
                e["about"]["ready_s"], e["about"]["load_s"], e["peak_mib"]))
    lines += ["", "## Are the pictures the same?", "",
              "Against the first entry of each scene: ratio of the mean R, G, B, and over blocks of 16 × 16 pixels the root mean square of z,",
              "1 where only noise differs.", "", "| scene | entry | ratio of means | z of means | rms z | largest z |", "|---|---|---|---|---|---|"]
    for path, done in result["scenes"].items():
        scene = os.path.basename(path)
        for name, e in done["entries"].items():
            if "same" in e:
                s = e["same"]
                lines.append("| %s | %s | %s | %s | %.2f | %.1f |" % (
                    scene, name, " ".join("%.4f" % r for r in s["ratio_of_means"]), " ".join("%+.1f" % z for z in s["z_of_means"]),
                    s.get("rms_z", float("nan")), s.get("largest_z", float("nan"))))
        for name, why in done["missing"].items():
            lines.append("| %s | %s | left out: %s | | | |" % (scene, name, why.replace("|", "/")[:80]))
    return "\n".join(lines) + "\n"


def ratios(result):
    """Each entry's efficiency in multiples of the first's: what Etalon needs of an entry's time for the same error, scene by scene."""
    of = {}
    for scene, done in result["scenes"].items():
        efficiency = {name: e["levels"][-1]["efficiency"] for name, e in done["entries"].items()}
        first = next(iter(efficiency.values()), None)
        for name, value in list(efficiency.items())[1:]:
            of.setdefault(name, {})[scene] = first / value
    return of


def times(result, targets=(0.05, 0.01)):
    """CPU seconds to some relative errors: the root of relMSE, on the line through the two last levels."""
    lines = ["| scene | entry | %s |" % " | ".join("s to %g %%" % (100 * t) for t in targets), "|---|---|" + "---:|" * len(targets)]
    for path, done in result["scenes"].items():
        for name, e in done["entries"].items():
            seconds = [time_to(e["levels"], t * t) for t in targets]
            lines.append("| %s | %s | %s |" % (os.path.basename(path), name, " | ".join("%.3g" % s if s else "" for s in seconds)))
    return "\n".join(lines) + "\n"


def log_draw(result, seed, drawn):
    """Adds a draw to the log, and says its median and its worst."""
    against = ratios(result)
    line = {"seed": seed, "machine": result["machine"], "rounds": result["rounds"], "scenes": [
        {**about, "ratio": {name: round(of[about["path"]], 3) for name, of in against.items() if about["path"] in of},
         "means": {name: [round(v, 4) for v in e["same"]["ratio_of_means"]]
                   for name, e in result["scenes"][about["path"]]["entries"].items() if "same" in e}}
        for about in drawn if about["path"] in result["scenes"]]}
    for scene in line["scenes"]:
        del scene["path"]
    with open(LOG, "a") as f:
        f.write(json.dumps(line) + "\n")
    text = ["", "Time for the same error over that of each entry, lower is better:", ""]
    for name, of in against.items():
        values = sorted(of.values())
        text.append("| %s | median %.2f | worst %.2f | best %.2f | of %d |" % (
            name, float(np.median(values)), values[-1], values[0], len(values)))
    return "\n".join(text) + "\n"


def commit_seed():
    """The first eight hex digits of the commit that is measured."""
    done = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "HEAD"], capture_output=True, text=True, check=True)
    return done.stdout[:8]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    split = lambda text: text.split(",")
    parser.add_argument("--scenes", type=split, default=list(SPP), help="of " + ", ".join(SPP))
    parser.add_argument("--entries", type=split, help="of " + ", ".join(ENTRIES))
    parser.add_argument("--draw", type=int, metavar="N", help="draw N scenes instead, and log them")
    parser.add_argument("--hard", action="store_true", help="render the seven scenes of hard.py instead")
    parser.add_argument("--seed", help="seed of the draw; default: the first eight digits of the commit")
    parser.add_argument("--spp", type=lambda text: [int(n) for n in text.split(",")], help="samples a pixel, the same for each scene")
    parser.add_argument("--rounds", type=int, default=5, help="independent renders at each number of samples, at least 2")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--out", default=str(ROOT / "out/race"))
    args = parser.parse_args()
    usual = DRAWN_ENTRIES if args.draw else DRAWN_ENTRIES + CAUSTIC_ENTRIES if args.hard else [name for name in ENTRIES if name not in CAUSTIC_ENTRIES]
    args.entries = args.entries or usual
    for given, known in ((args.scenes, SPP), (args.entries, ENTRIES)):
        unknown = [name for name in given if name not in known]
        if unknown:
            parser.error("unknown: %s; there are %s" % (", ".join(unknown), ", ".join(known)))
    if args.rounds < 2:
        parser.error("the error of a level is known from at least two rounds")
    os.makedirs(args.out, exist_ok=True)
    result = {"machine": machine(), "threads": args.threads, "rounds": args.rounds, "scenes": {}}
    drawn, seed = [], args.seed or (commit_seed() if args.draw else None)
    if args.draw:
        folder = os.path.join(args.out, "drawn")
        drawn = draw.draw(seed, args.draw, folder)
        for about in drawn:
            about["path"] = os.path.join(folder, about["name"] + ".xml")
        args.scenes = [about["path"] for about in drawn]
    if args.hard:
        folder = os.path.join(args.out, "hard")
        args.scenes = [os.path.join(folder, name + ".xml") for name in hard.write(folder)]
    with tempfile.TemporaryDirectory(prefix="race-") as folder:
        for scene in args.scenes:
            print(scene, flush=True)
            result["scenes"][scene] = run_scene(scene, args.entries, args, folder)
            # After each scene, so that an interrupted race leaves what it has.
            for name, text in (("race.json", json.dumps(result, indent=1)), ("race.md", report(result))):
                path = os.path.join(args.out, name)
                with open(path + ".tmp", "w") as f:
                    f.write(text)
                os.replace(path + ".tmp", path)
    print(report(result))
    if args.hard:
        print(times(result))
    if args.draw:
        print(log_draw(result, seed, drawn))


if __name__ == "__main__":
    main()
