"""Etalon adapter: neutral scene -> our format -> a process for each render.

    python3 peer_etalon.py DIR         # writes DIR/<scene>.json in our format, and the meshes beside them
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import scenes


def spectrum(c):
    """A colour of the neutral form as a spectrum of our format."""
    if "const" in c:
        return c["const"]
    if "d65" in c:
        return {"type": "illuminant", "name": "D65", "scale": c["d65"]}
    table = scenes.table(c["spd"])
    outside = "zero" if c["spd"] == "cornell_light" else "clamp"
    nm, values = zip(*table)
    return {"type": "tabulated", "wavelengths_nm": nm, "values": values, "outside": outside}


def material(m):
    if m["type"] == "diffuse":
        return {"type": "lambert", "reflectance": spectrum(m["color"])}
    if m["type"] == "mirror":
        return {"type": "mirror", "reflectance": spectrum(m["color"])}
    index = m["ior"]
    if "cauchy" in m:
        a, b = m["cauchy"]
        index = {"type": "cauchy", "a": a, "b_um2": b, "range_nm": [360, 830]}
    return {"type": "dielectric", "interior": index}


def convert(s):
    """The scene in our format, as plain data."""
    cam = s["camera"]
    camera = {"type": "perspective", "position_m": cam["origin"], "look_at_m": cam["target"], "up": cam["up"],
              "horizontal_fov_deg": cam["fov_x"]}
    if cam["aperture"] > 0:
        camera["lens"] = {"radius_m": cam["aperture"], "focus_distance_m": cam["focus"]}
    materials = {name: material(m) for name, m in s["materials"].items()}
    objects = []
    for sh in s["shapes"]:
        if sh["type"] == "mesh":
            shape = {"type": "mesh", "file": os.path.abspath(scenes.mesh_path(sh["file"]))}
        elif sh["type"] == "sphere":
            shape = {"type": "sphere", "center_m": sh["center"], "radius_m": sh["radius"]}
        else:
            shape = {"type": "parallelogram", "origin_m": sh["corner"], "u_m": sh["e1"], "v_m": sh["e2"]}
        thing = {"shape": shape, "material": sh.get("material", {"type": "black"})}
        if "emission" in sh:
            thing["emission"] = {"radiance": spectrum(sh["emission"])}
        objects.append(thing)
    lights = [{"type": "environment", "radiance": spectrum(s["env"])}] if s["env"] else []
    return {"etalon": 1, "camera": camera, "film": {"width": cam["width"], "height": cam["height"]},
            "materials": materials, "objects": objects, "lights": lights,
            "integrator": {"max_depth": s["max_depth"]}}


def read_exr(path):
    import OpenEXR
    channels = OpenEXR.File(str(path)).channels()
    if "RGB" in channels:
        return np.asarray(channels["RGB"].pixels, np.float32)
    return np.stack([np.asarray(channels[c].pixels, np.float32) for c in "RGB"], -1)


def run(command):
    """Standard output of a program, which must succeed, and its peak memory in MiB."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    peak = 0
    # What wait4 tells includes the memory of this process, from between fork and exec.
    while True:
        try:
            with open("/proc/%d/status" % process.pid) as f:
                peak = max([peak] + [int(line.split()[1]) for line in f if line.startswith("VmHWM")])
            out, err = process.communicate(timeout=0.01)
            break
        except subprocess.TimeoutExpired:
            continue
    if process.returncode != 0:
        raise RuntimeError(err or out)
    return out, peak / 1024.0


class Peer:
    def __init__(self, variant, threads, opts):
        t = time.perf_counter()
        root = pathlib.Path(__file__).resolve().parents[2]
        self.program = os.environ.get("ETALON") or str(root / "target/release/etalon")
        self.version = subprocess.run([self.program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        self.threads, self.opts = threads, opts
        # Error bars come from replicates, and cost something; the peers have none.
        self.replicates = int(opts.get("replicates", 1))
        self.folder = tempfile.TemporaryDirectory(prefix="race-")
        self.import_s = time.perf_counter() - t

    def load(self, s):
        self.scene = s.get("xml")
        if self.scene is None:
            self.scene = os.path.join(self.folder.name, s["name"] + ".json")
            with open(self.scene, "w") as f:
                json.dump(convert(s), f)
        # What a process does before the first sample: reading, building, preparing.
        t = time.perf_counter()
        self.render(1, 0)
        self.load_s = time.perf_counter() - t - self.last["seconds"]
        return self.load_s

    def render(self, spp, seed):
        """Returns image, spp, wall seconds of the process, CPU seconds of sampling."""
        out = os.path.join(self.folder.name, "out.exr")
        command = [self.program, "render", self.scene, "-o", out, "--spp", str(spp), "--seed", str(seed), "--json",
                   "--replicates", str(self.replicates), "--threads", str(self.threads), "--clock", "cpu"]
        for option in ("sampler", "size", "path-reuse"):
            if option in self.opts:
                command += ["--" + option, self.opts[option]]
        t = time.perf_counter()
        out_text, self.peak = run(command)
        wall = time.perf_counter() - t
        self.last = json.loads(out_text)
        if self.last["nonfinite"]:
            raise RuntimeError("samples that are not finite: %s" % self.last["nonfinite_at"])
        return read_exr(out), spp, wall, self.last["seconds"] * self.threads

    def extra(self):
        return {"prepare_s": self.last["prepare_seconds"], "kernel": self.last["plan"].get("kernel"),
                "rays_per_path": (self.last["rays"] + self.last["shadow_rays"]) / self.last["paths"]}

    def peak_mib(self):
        return self.peak

    def close(self):
        self.folder.cleanup()


def main():
    scenes.CACHE = sys.argv[1]
    os.makedirs(scenes.CACHE, exist_ok=True)
    for name, make in scenes.SCENES.items():
        scene = convert(make())
        for thing in scene["objects"]:
            if "file" in thing["shape"]:
                thing["shape"]["file"] = os.path.basename(thing["shape"]["file"])
        with open(os.path.join(scenes.CACHE, name + ".json"), "w") as f:
            json.dump(scene, f, indent=1)


if __name__ == "__main__":
    main()
