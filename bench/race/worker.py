"""One renderer with one scene, kept alive: a request is a line of JSON on standard input, an answer one on standard output.

    python3 worker.py PEER VARIANT SCENE THREADS '{"option": value}'

The first line that comes is about loading; then {"spp": n, "seed": k, "out": FILE.npy} renders and answers with the
samples taken, the seconds on the wall and the processor's seconds of sampling. Started and spoken to by race.py.
"""
import json
import os
import resource
import sys
import time

import numpy as np

import read_mitsuba
import scenes

PEERS = {"etalon": "peer_etalon", "mitsuba": "peer_mitsuba", "cycles": "peer_cycles", "luxcore": "peer_luxcore"}
READ_XML = ("etalon", "mitsuba")


def process_age():
    with open("/proc/self/stat") as f:
        start = int(f.read().rsplit(")", 1)[1].split()[19]) / os.sysconf("SC_CLK_TCK")
    with open("/proc/uptime") as f:
        return float(f.read().split()[0]) - start


def describe(peer_name, scene_name):
    """The scene in the neutral form, or the file of a drawn one for a peer that reads it."""
    if not scene_name.endswith(".xml"):
        return scenes.SCENES[scene_name]()
    return {"xml": scene_name} if peer_name in READ_XML else read_mitsuba.read(scene_name)


def main():
    peer_name, variant, scene_name, threads, opts = sys.argv[1:]
    # The peers print to the C standard output and error; keep ours for the answers.
    answers = os.fdopen(os.dup(1), "w")
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)

    def answer(**fields):
        answers.write(json.dumps(fields) + "\n")
        answers.flush()

    try:
        peer = __import__(PEERS[peer_name]).Peer(variant, int(threads), json.loads(opts))
    except (ImportError, OSError) as error:
        answer(missing="%s: %s" % (type(error).__name__, error))
        return
    ready_s = process_age()
    try:
        load_s = peer.load(describe(peer_name, scene_name))
    except (ImportError, ValueError) as error:
        answer(missing="%s: %s" % (type(error).__name__, error))
        return
    t = time.perf_counter()
    image, *_ = peer.render(1, 99)
    first_s = time.perf_counter() - t
    answer(version=peer.version, ready_s=ready_s, load_s=load_s, first_s=first_s, shape=image.shape)
    for line in sys.stdin:
        request = json.loads(line)
        image, spp, wall_s, cpu_s = peer.render(request["spp"], request["seed"])
        np.save(request["out"], image)
        own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        answer(spp=float(spp), wall_s=wall_s, cpu_s=cpu_s, nonfinite=int((~np.isfinite(image)).sum()),
               peak_mib=peer.peak_mib() if hasattr(peer, "peak_mib") else own,
               extra=peer.extra() if hasattr(peer, "extra") else {})
    peer.close()
    answers.flush()
    os._exit(0)  # some peers crash while they are taken down


if __name__ == "__main__":
    main()
