"""A path tracer of sixty lines in numpy, held to a dozen truths of the oracle.

    python numpy_path_tracer.py

It knows spheres, disks and parallelograms; Lambert, mirror and black surfaces; lamps and an even sky. It finds light only by chance, as
the first path tracer did (Kajiya 1986). That is enough for the truths below.
"""

import numpy as np

from etalon import oracle

TRUTHS = [
    "sky-alone", "furnace-lambert-sphere", "furnace-mirror-sphere", "room-sphere", "room-cut-at-2", "lamp-in-a-sphere",
    "diffuse-lamp-in-a-sphere", "parallel-plates-lower", "disk-light", "square-light", "sky-on-a-plate", "sky-behind-a-disk",
]
NEAR = 1e-7  # m: a ray starts this far from its surface


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a, b):
    return np.einsum("...i,...i", a, b)


def intersect(shape, o, d):
    """How far along each ray a shape is met, infinity if it is not, and the normal on its front."""
    if shape["type"] == "sphere":
        to_centre = np.array(shape["center_m"]) - o
        along = dot(to_centre, d)
        square = shape["radius_m"] ** 2 - (dot(to_centre, to_centre) - along**2)
        half = np.sqrt(np.maximum(square, 0))
        t = np.where(along - half > NEAR, along - half, along + half)
        return np.where((square > 0) & (t > NEAR), t, np.inf), unit(o + t[:, None] * d - np.array(shape["center_m"]))
    if shape["type"] == "disk":
        middle, normal = np.array(shape["center_m"], float), unit(np.array(shape["normal"], float))
    else:
        u, v, middle = (np.array(shape[key], float) for key in ("u_m", "v_m", "origin_m"))
        normal = unit(np.cross(u, v))
    with np.errstate(divide="ignore", invalid="ignore"):
        t = dot(middle - o, normal) / dot(d, normal)
        p = o + t[:, None] * d - middle
        if shape["type"] == "disk":
            inside = dot(p, p) <= shape["radius_m"] ** 2
        else:
            a, b = (p @ np.linalg.pinv(np.stack([u, v]).T).T).T
            inside = (a >= 0) & (a <= 1) & (b >= 0) & (b <= 1)
    return np.where(inside & (t > NEAR), t, np.inf), np.broadcast_to(normal, o.shape)


def camera_rays(scene, count, rng):
    camera, film = scene["camera"], scene["film"]
    eye = np.array(camera["position_m"], float)
    forward = unit(np.array(camera["look_at_m"]) - eye)
    right = unit(np.cross(forward, camera["up"]))
    xy = (rng.random((count, 2)) - 0.5) * [film["width"] / film["height"], 1]
    across = xy[:, :1] * right + xy[:, 1:] * np.cross(right, forward)
    if camera["type"] == "orthographic":
        return eye + camera["height_m"] * across, np.broadcast_to(forward, across.shape)
    size = 2 * np.tan(np.radians(camera["vertical_fov_deg"]) / 2)
    return np.broadcast_to(eye, across.shape), unit(forward + size * across)


def radiance(scene, count, rng, albedo_factor=1.0):
    """The mean radiance of this many paths. `albedo_factor` is a mistake that can be made on purpose."""
    o, d = camera_rays(scene, count, rng)
    weight, path, total = np.ones(count), np.arange(count), np.zeros(count)
    sky = sum(light["radiance"] for light in scene["lights"])
    for depth in range(1, scene["integrator"].get("max_depth", 10_000) + 1):
        t, which, normal = np.full(len(o), np.inf), np.full(len(o), -1), np.zeros_like(o)
        for index, thing in enumerate(scene["objects"]):
            distance, n = intersect(thing["shape"], o, d)
            nearer = distance < t
            t, which, normal = np.where(nearer, distance, t), np.where(nearer, index, which), np.where(nearer[:, None], n, normal)
        total[path[which < 0]] += weight[which < 0] * sky
        albedo, mirror = np.zeros(len(o)), np.zeros(len(o), bool)
        for index, thing in enumerate(scene["objects"]):
            here, front = which == index, dot(d, normal) < 0
            if "emission" in thing:
                shines = {"front": front, "back": ~front}.get(thing["emission"]["sides"], True) & here
                total[path[shines]] += weight[shines] * thing["emission"]["radiance"]
            albedo[here] = albedo_factor * thing["material"].get("reflectance", 0)
            mirror[here] = thing["material"]["type"] == "mirror"
        on = (which >= 0) & (rng.random(len(o)) < albedo)  # the others are absorbed
        if not on.any():
            break
        path, mirror, normal, d = path[on], mirror[on], normal[on], d[on]
        weight, o = weight[on], o[on] + t[on, None] * d
        facing = np.where(dot(d, normal)[:, None] < 0, normal, -normal)
        # A point of the unit sphere on top of the normal: directions by the cosine.
        diffuse = unit(facing + unit(rng.standard_normal(o.shape)))
        d = np.where(mirror[:, None], d - 2 * dot(d, normal)[:, None] * normal, diffuse)
    return total.mean()


def verdict(name, albedo_factor=1.0, batches=32, batch=20_000, most=64, seed=1):
    """Holds the path tracer to a truth: more paths, until the noise is small enough to see the truth's known mistakes."""
    truth, rng, means = oracle.truth(name), np.random.default_rng(seed), []
    while True:
        means += [radiance(truth.scene, batch, rng, albedo_factor) for _ in range(batches)]
        found = oracle.judge_means(truth, means, tests=len(TRUTHS))
        if "times the samples" not in found.evidence or len(means) >= most * batches:
            return found


if __name__ == "__main__":
    for name in TRUTHS:
        print(verdict(name))
