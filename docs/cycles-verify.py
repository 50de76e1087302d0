#!/usr/bin/env python3
"""Holds Blender's Cycles to the oracle's truths.

    etalon verify --export truths
    python3 cycles-verify.py truths pictures [NAME ...] [--seconds 5] [--threads 2]
    etalon verify --images pictures

Builds a scene of Cycles from each exported scene, renders it with independent seeds until the noise is low enough for the truth
(or the seconds are over), and writes NAME.exr with channels Y and Variance.Y. Cycles renders red, green and blue. All scenes taken are
grey, and Y is the mean of the three. What Cycles cannot be told is listed with the reason and left out.
Needs Python 3.11 and `pip install bpy==5.0.1 OpenEXR==3.5.3`.
"""
import argparse
import json
import os
import pathlib
import sys
import tempfile
import time

import numpy as np

PASSES = 16  # independent seeds behind each variance
# The significance of each of some hundred truths, and the power .999: (z_α + z_β) standard errors must not exceed what is to be seen.
STANDARD_ERRORS = 9.0
MOST = 1024  # bounces: the most that Cycles can be told
ROUND = 4096  # corners of a disk and of the ends of a cylinder: 4e-7 of the area is missing
SPHERE = 6  # times that the faces of an icosahedron are cut in four: 81,920 triangles of the sphere's area

# Claims that a translation of the neutral form to Cycles cannot meet.
UNSUPPORTED = {
    "whole-format": "a scene of the whole format, not of the neutral form",
    "carries-polarisation": "light that carries its polarisation",
    "motion": "motion between keyframes in seconds",
    "priorities": "solids that share a place",
    "masks": "surfaces of which a share lets light pass and which coincide with others",
    "specular-connections": "lamps without area, seen by mirrors and through glass",
}


class Unsupported(Exception):
    pass


def unit(v):
    return v / np.linalg.norm(v)


def frame(z, up=None):
    """A rotation whose third axis is z and whose second is as near as can be to `up`."""
    z = unit(np.array(z, float))
    x = unit(np.cross(up if up is not None else np.eye(3)[np.argmin(np.abs(z))], z))
    return np.stack([x, np.cross(z, x), z], axis=-1)


def number(value):
    if not isinstance(value, (int, float)):
        raise Unsupported("a spectrum that is not grey")
    return float(value)


def sphere_mesh():
    """A sphere of triangles about the origin, whose area is that of a sphere of radius 1."""
    g = (1 + np.sqrt(5)) / 2
    corners = [(a, b, 0) for a in (-1, 1) for b in (-g, g)]
    corners = np.array([np.roll(c, k) for k in range(3) for c in corners], float)
    near = np.linalg.norm(corners[:, None] - corners[None], axis=-1) < 2.1
    n = len(corners)
    faces = [(i, j, k) for i in range(n) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]]
    faces = [f if np.linalg.det(corners[list(f)]) > 0 else f[::-1] for f in faces]
    triangles = corners[np.array(faces)]
    for _ in range(SPHERE):
        a, b, c = np.swapaxes(triangles, 0, 1)
        ab, bc, ca = a + b, b + c, c + a
        triangles = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
        triangles /= np.linalg.norm(triangles, axis=-1, keepdims=True)
    vertices, indices = np.unique(triangles.reshape(-1, 3).round(12), axis=0, return_inverse=True)
    area = 0.5 * np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=-1).sum()
    return vertices * np.sqrt(4 * np.pi / area), indices.reshape(-1, 3)


class Translator:
    """Puts a scene of the neutral form into an empty scene of Blender."""

    def __init__(self, bpy, threads, folder):
        self.bpy, self.folder, self.ball, self.frames = bpy, folder, sphere_mesh(), 0
        self.threads = threads

    def load(self, s, band_nm):
        for part in ("groups", "instances", "medium", "meters"):
            if part in s:
                raise Unsupported(part)
        self.bpy.ops.wm.read_factory_settings(use_empty=True)
        self.stage, self.band_nm, self.eye = self.bpy.context.scene, band_nm, np.array(s["camera"]["position_m"], float)
        self.settings(s["integrator"].get("max_depth"))
        self.camera(s["camera"], s["film"])
        for thing in s["objects"]:
            self.object(thing)
        world = self.stage.world = self.bpy.data.worlds.new("sky")
        radiance = sum(number(light["radiance"]) for light in s["lights"] if light["type"] == "environment")
        self.tree(world, "ShaderNodeOutputWorld", lambda n: {"Surface": n("ShaderNodeBackground", Color=grey(1.0), Strength=radiance)})
        for light in s["lights"]:
            self.light(light)

    def settings(self, depth):
        """All that makes Cycles' pictures other than the mean of its paths is off."""
        if depth == 1:
            raise Unsupported("no light but what is seen at once")
        render, cycles = self.stage.render, self.stage.cycles
        render.engine, render.threads_mode, render.threads = "CYCLES", "FIXED", self.threads
        # Frames of an animation have seeds of their own, and the scene stays in memory between them.
        render.use_persistent_data = cycles.use_animated_seed = cycles.use_sample_subset = True
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        render.image_settings.color_mode, render.image_settings.exr_codec = "RGB", "NONE"
        cycles.device, cycles.sampling_pattern = "CPU", "TABULATED_SOBOL"
        cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_guiding = cycles.volume_biased = False
        cycles.caustics_reflective = cycles.caustics_refractive = True
        cycles.blur_glossy = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0.0
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
        # Cycles counts what scatters light; the lamp that it comes from and the first surface are not counted.
        bounces = MOST if depth is None else depth - 2
        cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
        cycles.volume_bounces, cycles.transparent_max_bounces = bounces, MOST

    def camera(self, c, film):
        # Blender's pictures are at least 4 pixels wide: those of smaller films are made of finer pixels.
        self.fine = -(-4 // min(4, film["width"], film["height"]))
        self.stage.render.resolution_x, self.stage.render.resolution_y = self.fine * film["width"], self.fine * film["height"]
        data = self.bpy.data.cameras.new("camera")
        data.sensor_fit, data.clip_start = "VERTICAL", 1e-6
        # Cycles renders a frame anew only if something has changed: the far end of the view grows, where nothing is.
        for data.clip_end, moment in ((1e9, 0), (2e9, 1_000_000)):
            data.keyframe_insert("clip_end", frame=moment)
        if c["type"] == "orthographic":
            data.type, data.ortho_scale = "ORTHO", c["height_m"]
        else:
            slope, lens = np.tan(0.5 * np.radians(c["vertical_fov_deg"])), c.get("lens", {"radius_m": 0.0})
            # Millimetres. Neither the sensor nor the focal length may be below 1, nor the f-number below 0.1.
            data.lens = max(1.0, 1 / slope, 2e3 * lens["radius_m"])
            data.sensor_height = 2 * slope * data.lens
            if lens["radius_m"] > 0.0:
                data.dof.use_dof, data.dof.focus_distance = True, lens["focus_distance_m"]
                data.dof.aperture_blades, data.dof.aperture_fstop = 0, data.lens / (2e3 * lens["radius_m"])
        self.stage.camera = self.put(data, self.eye, frame(self.eye - np.array(c["look_at_m"], float), c["up"]))

    def put(self, data, place=(0, 0, 0), turn=np.eye(3)):
        import mathutils

        thing = self.bpy.data.objects.new(data.name if data else "points", data)
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = turn, place
        thing.matrix_world = mathutils.Matrix(matrix.tolist())
        self.stage.collection.objects.link(thing)
        return thing

    def tree(self, owner, output, build):
        """The nodes of a material or a sky. `build` is given a function that makes a node and answers its first output."""
        owner.use_nodes = True
        nodes, links = owner.node_tree.nodes, owner.node_tree.links
        nodes.clear()

        def put(sockets, inputs):
            for key, value in inputs.items():
                if isinstance(value, self.bpy.types.NodeSocket):
                    links.new(value, sockets[key])
                else:
                    sockets[key].default_value = value

        def node(kind, settings=None, first=0, **inputs):
            made = nodes.new(kind)
            for key, value in (settings or {}).items():
                setattr(made, key, value)
            put(made.inputs, {int(k[1:]) if k[0] == "_" else k.replace("_", " "): v for k, v in inputs.items()})
            return made.outputs[first]

        put(nodes.new(output).inputs, build(node))

    def material(self, m, emission):
        material = self.bpy.data.materials.new("material")
        sides = emission["sides"] if emission else "both"
        material.cycles.emission_sampling = {"front": "FRONT", "back": "BACK", "both": "FRONT_BACK"}[sides]

        def build(node):
            made = {"Surface": self.bsdf(m, node)}
            if "absorption_per_m" in m:
                made["Volume"] = node("ShaderNodeVolumeAbsorption", Color=grey(0.0), Density=m["absorption_per_m"])
            if emission:
                strength = number(emission["radiance"])
                if sides != "both":
                    back = node("ShaderNodeNewGeometry", first=6)
                    front = back if sides == "back" else node("ShaderNodeMath", {"operation": "SUBTRACT"}, _0=1.0, _1=back)
                    strength = node("ShaderNodeMath", {"operation": "MULTIPLY"}, _0=strength, _1=front)
                made["Surface"] = node("ShaderNodeAddShader", _0=made["Surface"], _1=node("ShaderNodeEmission", Strength=strength))
            return made

        self.tree(material, "ShaderNodeOutputMaterial", build)
        return material

    def index(self, index):
        if isinstance(index, (int, float)):
            return float(index)
        # Cycles' index is one number: that of the one wavelength rendered.
        if not self.band_nm:
            raise Unsupported("dispersion")
        square = (0.5e-3 * sum(self.band_nm)) ** 2
        return float(np.sqrt(1 + sum(b * square / (square - c) for b, c in zip(index["b"], index["c_um2"]))))

    def bsdf(self, m, node):
        kind = m["type"]
        if kind in ("black", "lambert"):
            return node("ShaderNodeBsdfDiffuse", Color=grey(number(m.get("reflectance", 0.0))), Roughness=0.0)
        if kind == "mirror":
            return node("ShaderNodeBsdfAnisotropic", {"distribution": "GGX"}, Color=grey(number(m["reflectance"])), Roughness=0.0)
        if kind == "dielectric":
            ratio = self.index(m["interior"]) / self.index(m.get("exterior", 1.0))
            return node("ShaderNodeBsdfGlass", {"distribution": "MULTI_GGX" if "alpha" in m else "GGX"}, Color=grey(1.0),
                        Roughness=np.sqrt(m.get("alpha", 0.0)), IOR=ratio)
        if kind != "conductor":
            raise Unsupported(kind)
        if len(set(m["n"])) > 1 or len(set(m["k"])) > 1:
            raise Unsupported("a spectrum that is not grey")
        wide, narrow, turn = m.get("alpha_u", 0.0), m.get("alpha_v", 0.0), m.get("tangent_rotation_deg", 0.0) / 360
        if narrow > wide:
            wide, narrow, turn = narrow, wide, turn + 0.25
        # Cycles' widths are r²/a and r²a, with a = √(1 − 0.9 × anisotropy).
        anisotropy = (1 - narrow / wide) / 0.9 if wide else 0.0
        if anisotropy > 1.0:
            raise Unsupported("facets more than ten times as wide one way as the other")
        lost = not wide or m.get("multiple_scattering") == "lost"
        along = {"Tangent": node("ShaderNodeTangent", {"direction_type": "UV_MAP"})} if anisotropy else {}
        return node("ShaderNodeBsdfMetallic", {"distribution": "GGX" if lost else "MULTI_GGX", "fresnel_type": "PHYSICAL_CONDUCTOR"},
                    IOR=[m["n"][0]] * 3, Extinction=[m["k"][0]] * 3, Roughness=(wide * narrow) ** 0.25, Anisotropy=anisotropy,
                    Rotation=turn % 1.0, **along)

    def object(self, thing):
        s, m, emission = thing["shape"], thing["material"], thing.get("emission")
        outside = s["type"] == "sphere" and np.linalg.norm(self.eye - s["center_m"]) > s["radius_m"]
        lamp = emission and m["type"] == "black" and emission["sides"] == "front"
        if lamp and (outside or s["type"] == "disk"):
            # A lamp of Cycles, which lets light through, before a black body that is smaller or farther back by a hair.
            s = self.lamp(s, number(emission["radiance"]))
            emission = None
        material = self.material(m, emission)
        if outside and not emission and m["type"] != "dielectric" and "alpha_u" not in m:
            # Spheres that are seen from outside alone can be exact ones: points of a cloud.
            return self.point(s, material)
        if s["type"] in ("sphere", "cylinder") and m["type"] == "conductor" and m.get("alpha_u") != m.get("alpha_v"):
            raise Unsupported("a grain on a round body")
        if s["type"] == "cylinder" and m["type"] not in ("black", "lambert"):
            raise Unsupported("a cylinder that mirrors or refracts")
        vertices, faces = self.shape(s)
        mesh = self.bpy.data.meshes.new("mesh")
        mesh.from_pydata(np.asarray(vertices, float).tolist(), [], np.asarray(faces).tolist())
        if s["type"] == "parallelogram":
            for corner, at in zip(mesh.uv_layers.new().data, ((0, 0), (1, 0), (1, 1), (0, 1))):
                corner.uv = at
        if s["type"] == "sphere" and m["type"] not in ("black", "lambert"):
            mesh.shade_smooth()
        mesh.materials.append(material)
        self.put(mesh)

    def lamp(self, s, radiance):
        """Adds the lamp, and answers the shape of the black body behind it."""
        centre = np.array(s["center_m"], float)
        # As far as single precision can tell from the eye.
        hair = min(1e-5 * s["radius_m"] + 1e-6 * (np.abs(centre).max() + np.linalg.norm(self.eye - centre)), 0.5 * s["radius_m"])
        area = np.pi * s["radius_m"] ** 2
        if s["type"] == "sphere":
            self.shine("POINT", 4 * np.pi * area * radiance, centre, shadow_soft_size=s["radius_m"], use_soft_falloff=False)
            return s | {"radius_m": s["radius_m"] - hair}
        normal = unit(np.array(s["normal"], float))
        self.shine("AREA", np.pi * area * radiance, centre, frame(-normal), shape="DISK", size=2 * s["radius_m"])
        return s | {"center_m": (centre - hair * normal).tolist()}

    def shine(self, kind, energy, place=(0, 0, 0), turn=np.eye(3), **settings):
        data = self.bpy.data.lights.new("lamp", kind)
        for key, value in ({"energy": energy} | settings).items():
            setattr(data, key, value)
        data.cycles.max_bounces = MOST
        self.put(data, place, turn).visible_camera = True

    def light(self, s):
        if s["type"] == "point":
            self.shine("POINT", 4 * np.pi * number(s["intensity"]), s["position_m"], shadow_soft_size=0.0)
        elif s["type"] == "directional":
            self.shine("SUN", number(s["irradiance"]), turn=frame(-np.array(s["direction"], float)), angle=0.0)
        elif s["type"] != "environment":
            raise Unsupported("a light of the type " + s["type"])

    def point(self, s, material):
        group = self.bpy.data.node_groups.new("point", "GeometryNodeTree")
        group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
        points, dress, output = (group.nodes.new(k) for k in ("GeometryNodePoints", "GeometryNodeSetMaterial", "NodeGroupOutput"))
        points.inputs["Position"].default_value, points.inputs["Radius"].default_value = s["center_m"], s["radius_m"]
        dress.inputs["Material"].default_value = material
        group.links.new(points.outputs[0], dress.inputs[0])
        group.links.new(dress.outputs[0], output.inputs[0])
        self.put(self.bpy.data.meshes.new("empty")).modifiers.new("point", "NODES").node_group = group

    def shape(self, s):
        """Corners and faces, outward side as in the neutral form."""
        kind = s["type"]
        if kind == "sphere":
            return np.array(s["center_m"]) + s["radius_m"] * self.ball[0], self.ball[1]
        if kind == "parallelogram":
            corner, u, v = (np.array(s[key], float) for key in ("origin_m", "u_m", "v_m"))
            return [corner, corner + u, corner + u + v, corner + v], [[0, 1, 2, 3]]
        if kind == "box":
            low, high = np.array(s["min_m"], float), np.array(s["max_m"], float)
            corners = [np.where([i & 1, i & 2, i & 4], high, low) for i in range(8)]
            return corners, [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        if kind == "mesh":
            return s["vertices_m"], s["triangles"]
        start, end = (np.array(s[key], float) for key in (("start_m", "end_m") if kind == "cylinder" else ("center_m", "center_m")))
        angle, i = 2 * np.pi * np.arange(ROUND) / ROUND, np.arange(ROUND)
        ring = s["radius_m"] * np.stack([np.cos(angle), np.sin(angle)], -1)
        j, n = np.roll(i, -1), ROUND
        if kind == "disk":
            return np.vstack([start + ring @ frame(s["normal"])[:, :2].T, start]), np.stack([i, j, 0 * i + n], -1)
        ring = ring @ frame(end - start)[:, :2].T
        faces = [np.stack([i, j, j + n], -1), np.stack([i, j + n, i + n], -1)]
        if s.get("capped"):
            faces += [np.stack([j, i, 0 * i + 2 * n], -1), np.stack([i + n, j + n, 0 * i + 2 * n + 1], -1)]
        return np.vstack([start + ring, end + ring, start, end]), np.concatenate(faces)

    def render(self, spp):
        """The pictures of PASSES new frames."""
        import OpenEXR

        # The first path of a pixel goes through its middle always, and is left out.
        self.stage.cycles.samples, self.stage.cycles.sample_offset, self.stage.cycles.sample_subset_length = spp + 1, 1, spp
        self.stage.frame_start, self.stage.frame_end = self.frames + 1, self.frames + PASSES
        self.frames += PASSES
        self.stage.render.filepath = os.path.join(self.folder, "######")
        self.bpy.ops.render.render(animation=True)
        pictures = []
        for frame_number in range(self.stage.frame_start, self.stage.frame_end + 1):
            path = os.path.join(self.folder, f"{frame_number:06}.exr")
            with OpenEXR.File(path) as file:
                pictures.append(np.array(file.channels()["RGB"].pixels, np.float64).mean(axis=-1))
            os.remove(path)
        count, height, width = np.shape(pictures)
        return np.reshape(pictures, (count, height // self.fine, self.fine, width // self.fine, self.fine)).mean(axis=(2, 4))


def grey(value):
    return (value, value, value, 1.0)


def measure(translator, truth, seconds):
    """Pixels and the variance of each pixel's mean, from PASSES seeds; more paths until the noise will do."""
    need = truth["must_resolve"]
    need = None if need is None else max(need - truth["tolerance"], 0.5 * need)
    x0, x1, y0, y1 = truth["crop_px"] or (0, truth["width"], 0, truth["height"])
    spp, start = 64, time.perf_counter()
    while True:
        # Pictures of fewer paths are dropped, which favours no outcome.
        begin = time.perf_counter()
        pictures = translator.render(spp)
        took, spent = time.perf_counter() - begin, time.perf_counter() - start
        mean, variance = pictures.mean(axis=0), pictures.var(axis=0, ddof=1) / PASSES
        error = np.sqrt(np.nansum(variance[y0:y1, x0:x1])) / variance[y0:y1, x0:x1].size
        if need is None or STANDARD_ERRORS * error <= need or spent + took > seconds or not np.isfinite(mean).all():
            return mean, variance, spp * PASSES, spent
        spp = int(spp * np.clip(1.3 * (STANDARD_ERRORS * error / need) ** 2, 2.0, min((seconds - spent) / took, 64.0)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("truths", type=pathlib.Path)
    parser.add_argument("pictures", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--seconds", type=float, default=20.0, help="most seconds a truth, but for the first passes")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    args = parser.parse_args()

    import bpy
    import OpenEXR

    # Blender tells of each picture on standard output.
    sys.stdout = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    args.pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        translator = Translator(bpy, args.threads, folder)
        for truth in json.loads((args.truths / "truths.json").read_text())["truths"]:
            name = truth["name"]
            if args.names and not any(part in name for part in args.names):
                continue
            try:
                for claim in truth["claims"]:
                    if claim in UNSUPPORTED:
                        raise Unsupported(UNSUPPORTED[claim])
                translator.load(json.loads((args.truths / truth["scene"]).read_text()), truth["band_nm"])
                mean, variance, spp, spent = measure(translator, truth, args.seconds)
            except Unsupported as why:
                print(f"{name}: not supported: {why}")
                continue
            # All is grey, so 1 is the answer to a radiance of 1 in any band: no white picture is needed.
            channels = {"Y": mean.astype(np.float32), "Variance.Y": variance.astype(np.float32)}
            OpenEXR.File({}, channels).write(str(args.pictures / truth["picture"]))
            print(f"{name}: {mean.mean():.8g}, {truth['value']:.8g} is true, {spp} paths a pixel in {spent:.1f} s")


if __name__ == "__main__":
    main()
