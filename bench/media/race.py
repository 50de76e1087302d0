#!/usr/bin/env python3
"""Media: Etalon against Mitsuba 3 on scenes that both read from one file, in time for the same error and in the picture.

    python3 bench/media/race.py                       # all scenes
    python3 bench/media/race.py --scenes fog,smoke --spp 128

Needs numpy, OpenEXR and mitsuba (the interpreter that runs this), and target/release/etalon (or the variable ETALON). Each runs on one
thread. Two pictures whose seeds differ give the error: half of their mean squared difference, of luminance. The product of that and of the
processor's seconds of a picture does not depend on the number of samples. The ratio of means is that of all pixels; what noise alone
explains of it stands beside it.
"""
import argparse
import os
import pathlib
import resource
import struct
import subprocess
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

HEAD = """<scene version="3.0.0">
  <integrator type="INTEGRATOR"><integer name="max_depth" value="-1"/><integer name="rr_depth" value="50"/></integrator>
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 1, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="64"/><rfilter type="box"/></film>
    <sampler type="multijitter"><integer name="sample_count" value="64"/></sampler></sensor>
  <shape type="rectangle">
    <transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/><translate y="-1.2"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0.4"/></bsdf></shape>
  <emitter type="directional"><vector name="direction" x="-1" y="-1.2" z="-0.4"/><spectrum name="irradiance" value="2"/></emitter>
  <emitter type="constant"><spectrum name="radiance" value="0.3"/></emitter>
"""
FOG = '<phase type="hg"><float name="g" value="0.6"/></phase></medium>'
SCENES = {
    "fog": '<shape type="sphere"><bsdf type="null"/><medium name="interior" type="homogeneous"><float name="albedo" value="0.9"/>'
           f'<float name="sigma_t" value="3"/>{FOG}</shape>',
    "milk": '<shape type="sphere"><bsdf type="dielectric"><float name="int_ior" value="1.33"/><float name="ext_ior" value="1"/></bsdf>'
            '<medium name="interior" type="homogeneous"><float name="albedo" value="0.9"/>'
            f'<float name="sigma_t" value="8"/>{FOG}</shape>',
    "smoke": '<shape type="sphere"><bsdf type="null"/><medium name="interior" type="heterogeneous"><float name="albedo" value="0.9"/>'
             '<float name="scale" value="6"/><volume name="sigma_t" type="gridvolume"><string name="filename" value="smoke.vol"/>'
             '<transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/><scale value="2"/></transform></volume>'
             '<phase type="tabphase"><string name="values" value="0.5, 0.3, 0.4, 1.5"/></phase></medium></shape>',
    "colour": '<shape type="sphere"><bsdf type="null"/><medium name="interior" type="homogeneous">'
              '<spectrum name="albedo" value="350:0.97, 850:0.75"/><spectrum name="sigma_t" value="350:6.5, 850:1.5"/>'
              f'{FOG}</shape>',
}


def write_smoke(folder):
    """A grid of 24 × 20 × 16 cells without a pattern."""
    cells = (24, 20, 16)
    numbers = [(i * i * 31 + i * 7919) % 101 / 101 for i in range(cells[0] * cells[1] * cells[2])]
    header = b"VOL\x03" + struct.pack("<5i", 1, *cells, 1) + struct.pack("<6f", 0, 0, 0, 1, 1, 1)
    (folder / "smoke.vol").write_bytes(header + struct.pack(f"<{len(numbers)}f", *numbers))


def of_etalon(path, spp, seed):
    import OpenEXR

    out = path.with_suffix(".exr")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    program = os.environ.get("ETALON", str(ROOT / "target/release/etalon"))
    arguments = ["render", str(path), "--spp", str(spp), "--seed", str(seed), "--threads", "1", "-o", str(out)]
    subprocess.run([program, *arguments], check=True, capture_output=True)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    with OpenEXR.File(str(out)) as file:
        return file.channels()["RGB"].pixels[..., :3].astype(float) @ LUMINANCE, seconds


def of_mitsuba(path, spp, seed, integrator):
    import time

    import drjit
    import mitsuba

    mitsuba.set_variant("llvm_ad_spectral")
    drjit.set_thread_count(1)
    text = path.read_text().replace("INTEGRATOR", integrator)
    own = path.with_name(f"{path.stem}-{integrator}.xml")
    own.write_text(text)
    scene = mitsuba.load_file(str(own))
    mitsuba.render(scene, spp=16, seed=99).numpy()
    before = time.process_time()
    picture = mitsuba.render(scene, spp=spp, seed=seed).numpy()[..., :3].astype(float) @ LUMINANCE
    return picture, time.process_time() - before


def measure(render):
    (first, one), (second, other) = render(1), render(2)
    error = ((first - second) ** 2).mean() / 2
    seconds = (one + other) / 2
    mean = (first.mean() + second.mean()) / 2
    return {"seconds": seconds, "mse": error, "cost": seconds * error, "mean": mean, "mean_error": (error / first.size / 2) ** 0.5}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--spp", type=int, default=256)
    arguments = parser.parse_args()
    print("| scene | Etalon, s × MSE | volpath | volpathmis | Etalon ÷ the better | mean, Etalon ÷ volpathmis |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_smoke(folder)
        for scene in arguments.scenes.split(","):
            path = folder / f"{scene}.xml"
            path.write_text(HEAD + SCENES[scene] + "\n</scene>\n")
            ours_path = folder / f"{scene}-etalon.xml"
            ours_path.write_text(path.read_text().replace("INTEGRATOR", "volpath"))
            ours = measure(lambda seed: of_etalon(ours_path, arguments.spp, seed))
            peers = {
                integrator: measure(lambda seed: of_mitsuba(path, arguments.spp, seed, integrator))
                for integrator in ("volpath", "volpathmis")
            }
            right = [peer["cost"] for peer in peers.values() if np.isfinite(peer["cost"])]
            mis = peers["volpathmis"]
            ratio = ours["mean"] / mis["mean"]
            noise = ratio * ((ours["mean_error"] / ours["mean"]) ** 2 + (mis["mean_error"] / mis["mean"]) ** 2) ** 0.5
            costs = [f"{one['cost']:.2e}" for one in (ours, peers["volpath"], mis)]
            print(f"| {scene} | {' | '.join(costs)} | {ours['cost'] / min(right):.2f} | {ratio:.4f} ± {noise:.4f} |", flush=True)


main()
