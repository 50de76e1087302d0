#!/usr/bin/env python3
"""Instructions a path of the scenes of the race, against those recorded in reference/instructions.json.

    python3 bench/instructions.py                       # all scenes; mesh1m takes minutes under valgrind
    python3 bench/instructions.py --scenes cornell,dof
    python3 bench/instructions.py --record              # writes what it counted

Counts what callgrind collects between entering and leaving the kernel, on one thread: sampling alone, nothing of loading. The
same program on the same kind of processor repeats a count exactly, whatever else the machine does; another compiler does not,
so the record names it. Needs valgrind, numpy for the meshes, and target/release/etalon or the variable ETALON.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
RECORD = ROOT / "reference" / "instructions.json"
# Pixels and samples: enough paths that the first of each kind do not count.
SIZES = {"cornell": ("32x32", 16), "glass": ("32x32", 16), "prism": ("32x32", 32), "dof": ("40x30", 16), "mesh1m": ("32x32", 8)}


def out(command):
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)


def count(program, scene, size, spp):
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", "--collect-atstart=no",
               "--toggle-collect=*kernel::render_scalar*", "--toggle-collect=*batch::render_batch*", program, "render", scene, "--size", size, "--spp", str(spp), "--threads", "1",
               "--quiet", "--output", os.path.join(os.path.dirname(scene), "out.exr")]
    collected = re.search(r"Collected : (\d+)", out(command).stderr)
    width, height = map(int, size.split("x"))
    if int(collected.group(1)) == 0:
        sys.exit("nothing was collected: the functions named by --toggle-collect have other names now")
    return int(collected.group(1)) / (width * height * spp)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=lambda text: text.split(","), default=list(SIZES), help="of " + ", ".join(SIZES))
    parser.add_argument("--record", action="store_true", help="write the counts to " + str(RECORD.relative_to(ROOT)))
    args = parser.parse_args()
    unknown = [name for name in args.scenes if name not in SIZES]
    if unknown:
        parser.error("unknown: %s; there are %s" % (", ".join(unknown), ", ".join(SIZES)))
    program = os.environ.get("ETALON") or str(ROOT / "target/release/etalon")
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {"scenes": {}}
    compiler = out(["rustc", "--version"]).stdout.strip()
    processor = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "?")
    if record["scenes"] and (record["compiler"], record["processor"]) != (compiler, processor):
        print("recorded with %s on %s" % (record["compiler"], record["processor"]))
        print("this is       %s on %s" % (compiler, processor))
    print("%-8s %12s %12s %8s" % ("scene", "recorded", "now", "ratio"))
    with tempfile.TemporaryDirectory(prefix="instructions-") as folder:
        subprocess.run([sys.executable, str(ROOT / "bench/race/peer_etalon.py"), folder], check=True)
        for name in args.scenes:
            size, spp = SIZES[name]
            now = count(program, os.path.join(folder, name + ".json"), size, spp)
            before = record["scenes"].get(name)
            print("%-8s %12s %12.0f %8s" % (name, "%.0f" % before if before else "", now, "%.4f" % (now / before) if before else ""), flush=True)
            if args.record:
                record["scenes"][name] = round(now, 1)
    if args.record:
        record.update(compiler=compiler, processor=processor,
                      about="instructions a path, counted by bench/instructions.py")
        RECORD.write_text(json.dumps(record, indent=2, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
