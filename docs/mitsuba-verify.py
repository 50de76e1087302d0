#!/usr/bin/env python3
"""Holds Mitsuba 3 to the oracle's truths.

    etalon verify --export truths
    python3 mitsuba-verify.py truths pictures [--variant llvm_ad_mono] [--seconds 20] [NAME ...]
    etalon verify --images pictures

Builds a Mitsuba scene from each exported scene, renders it with independent seeds until the noise is low enough for the truth
(or the seconds are over), and writes NAME.exr with channels Y and Variance.Y. Meters are read by rays that begin on them, and
written as meters.Y. What Mitsuba cannot be told is listed with the reason and left out. Needs `pip install mitsuba==3.9.1`; the llvm variants need LLVM 19 (apt-get install libllvm19) and
DRJIT_LIBLLVM_PATH set to its library.
"""
import argparse
import json
import pathlib
import time

import numpy as np

PASSES = 32  # independent seeds behind each variance
# The significance of each of some hundred truths, and the power .999: (z_α + z_β) standard errors must not exceed what is to be seen.
STANDARD_ERRORS = 9.0


# Luminous efficacy of a constant spectrum, 683.002 lm/W times the integral of the 1931 observer's y: photometric values become such.
LUX = 683.002 * 106.856917
PHOTOMETRIC = {"intensity_cd": "intensity", "illuminance_lx": "irradiance", "luminance_cd_per_m2": "radiance"}

# Claims that a translation of the neutral form to Mitsuba cannot meet. Its facets hide each other independently, by G₁G₁.
UNSUPPORTED = {"motion", "correlated-masking", "whole-format"}


class Unsupported(Exception):
    pass


def radiometric(thing):
    """With values of a constant spectrum in place of photometric ones."""
    if "spectrum" in thing:
        raise Unsupported("photometric units of a spectrum")
    plain = {PHOTOMETRIC.get(key, key): value / LUX if key in PHOTOMETRIC else value for key, value in thing.items()}
    if "flux_lm" in plain:
        plain["intensity"] = plain.pop("flux_lm") / (4 * np.pi * LUX)
    return plain


def unit(v):
    return v / np.linalg.norm(v)


class Translator:
    """A scene of the neutral form as a dictionary for mi.load_dict."""

    def __init__(self, mi, band_nm):
        self.mi, self.T, self.band_nm = mi, mi.ScalarTransform4f, band_nm

    def scene(self, s):
        d = {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": s["integrator"].get("max_depth", -1)},
        }
        # The light that lamps send to a meter is added by itself: no ray meets lights without a surface.
        if "meters" in s:
            d["integrator"]["hide_emitters"] = True
        if "meters" not in s:
            d["sensor"] = self.sensor(s["camera"], s["film"])
        for i, thing in enumerate(s["objects"]):
            for j, shape in enumerate(self.object(thing)):
                d[f"object{i}_{j}"] = shape
        for i, light in enumerate(s["lights"]):
            d[f"light{i}"] = self.light(light)
        for part in ("groups", "instances", "medium"):
            if part in s:
                raise Unsupported(part)
        if not s["objects"] and "meters" not in s:
            # A scene without shapes has no extent, which Mitsuba's sky wants to know: a black speck behind the eye.
            away = np.array(s["camera"]["position_m"]) * 2 - np.array(s["camera"]["look_at_m"])
            d["speck"] = {"type": "sphere", "center": away.tolist(), "radius": 1e-3, "bsdf": self.bsdf({"type": "black"})}
        return d

    def sensor(self, c, film):
        eye, target = np.array(c["position_m"], float), np.array(c["look_at_m"], float)
        far = np.linalg.norm(target - eye)
        to_world = self.T().look_at(eye.tolist(), target.tolist(), c["up"])
        sensor = {
            "near_clip": 1e-5 * far, "far_clip": 1e5 * far,
            "film": {
                "type": "hdrfilm", "width": film["width"], "height": film["height"], "rfilter": {"type": "box"},
                "pixel_format": "luminance", "component_format": "float32",
            },
            "sampler": {"type": "independent"},
        }
        if c["type"] == "orthographic":
            half = 0.5 * c["height_m"] * film["width"] / film["height"]
            return sensor | {"type": "orthographic", "to_world": to_world @ self.T().scale([half, half, 1])}
        sensor |= {"type": "perspective", "to_world": to_world, "fov": c["vertical_fov_deg"], "fov_axis": "y"}
        if "lens" in c:
            lens = c["lens"]
            sensor |= {"type": "thinlens", "aperture_radius": lens["radius_m"], "focus_distance": lens["focus_distance_m"]}
        return sensor

    def number(self, value):
        if not isinstance(value, (int, float)):
            raise Unsupported("a spectrum, in a variant of one wavelength")
        return {"type": "uniform", "value": float(value)}

    def index(self, index):
        if isinstance(index, (int, float)):
            return float(index)
        # Mitsuba's index is one number: that of the one wavelength rendered.
        if not self.band_nm:
            raise Unsupported("dispersion")
        square = (0.5e-3 * sum(self.band_nm)) ** 2
        return float(np.sqrt(1 + sum(b * square / (square - c) for b, c in zip(index["b"], index["c_um2"]))))

    def bsdf(self, m):
        kind = m["type"]
        if "priority" in m:
            raise Unsupported("solids that share a place")
        if "absorption_per_m" in m:
            raise Unsupported("absorption")
        if "alpha" in m:
            # Mitsuba's rough dielectric loses the light that meets several facets.
            raise Unsupported("rough glass without loss")
        if kind == "dielectric":
            return {"type": "dielectric", "int_ior": self.index(m["interior"]), "ext_ior": self.index(m.get("exterior", 1.0))}
        if kind in ("black", "lambert"):
            inner = {"type": "diffuse", "reflectance": self.number(m.get("reflectance", 0.0))}
        elif kind == "mirror":
            inner = {"type": "conductor", "material": "none", "specular_reflectance": self.number(m["reflectance"])}
        elif kind == "conductor":
            inner = {"type": "conductor", "eta": self.number(m["n"][0]), "k": self.number(m["k"][0])}
            if "alpha_u" in m:
                if m.get("multiple_scattering") != "lost":
                    raise Unsupported("rough metal without loss")
                if "tangent_rotation_deg" in m:
                    raise Unsupported("a grain that is not along a texture coordinate")
                inner |= {"type": "roughconductor", "distribution": "ggx", "alpha_u": m["alpha_u"], "alpha_v": m["alpha_v"]}
        else:
            raise Unsupported(kind)
        return {"type": "twosided", "inner": inner}

    def object(self, thing):
        bsdf = self.bsdf(thing["material"])
        emission = radiometric(thing["emission"]) if "emission" in thing else None
        if "opacity" in thing:
            if emission is not None or not isinstance(thing["opacity"], (int, float)):
                raise Unsupported("an opacity of a lamp, or by an image")
            bsdf = {"type": "mask", "opacity": float(thing["opacity"]), "nested": bsdf}
        if emission is None:
            return [shape | {"bsdf": bsdf} for shape in self.shapes(thing["shape"], False)]
        lit = {"bsdf": bsdf, "emitter": {"type": "area", "radiance": self.number(emission["radiance"])}}
        if emission["sides"] != "both":
            return [shape | lit for shape in self.shapes(thing["shape"], emission["sides"] == "back")]
        # Mitsuba's lights shine on one side: two sheets, each moved towards its own side by a hair.
        return [self.shape(self.moved(thing["shape"], sign), sign < 0) | lit for sign in (1.0, -1.0)]

    def moved(self, shape, sign):
        if shape["type"] == "parallelogram":
            return shape | {"origin_m": self.shifted([shape["origin_m"]], shape["u_m"], shape["v_m"], sign)[0]}
        if shape["type"] == "mesh" and len(shape["triangles"]) == 1:
            a, b, c = (np.array(shape["vertices_m"][i]) for i in shape["triangles"][0])
            return shape | {"vertices_m": self.shifted(shape["vertices_m"], b - a, c - a, sign)}
        raise Unsupported("a body that shines on both sides")

    def shifted(self, points, u, v, sign):
        # Far enough for single precision to tell the sheets apart.
        hair = 1e-5 * np.linalg.norm(u) + 1e-6 * np.abs(points).max()
        return (np.array(points) + sign * hair * unit(np.cross(u, v))).tolist()

    def shapes(self, s, flip):
        """A shape, or the parts that Mitsuba makes it of: its cylinder is a tube without ends."""
        if s["type"] != "cylinder":
            return [self.shape(s, flip)]
        start, end = np.array(s["start_m"], float), np.array(s["end_m"], float)
        parts = [{"type": "cylinder", "p0": start.tolist(), "p1": end.tolist(), "radius": s["radius_m"], "flip_normals": flip}]
        if s.get("capped"):
            ends = [(start, start - end), (end, end - start)]
            disks = [{"type": "disk", "center_m": c.tolist(), "normal": n.tolist(), "radius_m": s["radius_m"]} for c, n in ends]
            parts += [self.shape(disk, flip) for disk in disks]
        return parts

    def shape(self, s, flip):
        """Outward side as in the neutral form; `flip` turns it round."""
        kind, T = s["type"], self.T
        if kind == "sphere":
            return {"type": "sphere", "center": s["center_m"], "radius": s["radius_m"], "flip_normals": flip}
        if kind == "disk":
            normal = unit(np.array(s["normal"], float))
            across = unit(np.cross(normal, [1.0, 0, 0] if abs(normal[0]) < 0.7 else [0, 1.0, 0]))
            return self.flat("disk", s["center_m"], s["radius_m"] * across, s["radius_m"] * np.cross(normal, across), flip)
        if kind == "parallelogram":
            u, v = np.array(s["u_m"], float), np.array(s["v_m"], float)
            if abs(u @ v) > 1e-12 * np.linalg.norm(u) * np.linalg.norm(v):
                raise Unsupported("a parallelogram that is no rectangle")
            return self.flat("rectangle", np.array(s["origin_m"]) + 0.5 * (u + v), 0.5 * u, 0.5 * v, flip)
        if kind == "box":
            low, high = np.array(s["min_m"], float), np.array(s["max_m"], float)
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            return {"type": "cube", "to_world": T().translate(middle.tolist()) @ T().scale(half.tolist()), "flip_normals": flip}
        triangles = np.array(s["triangles"], np.uint32)
        return {"type": "mesh", "vertices": np.array(s["vertices_m"], float), "triangles": triangles[:, ::-1] if flip else triangles}

    def flat(self, kind, middle, x, y, flip):
        if flip:
            x = -np.asarray(x)
        m = np.eye(4)
        m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = x, y, unit(np.cross(x, y)), middle
        return {"type": kind, "to_world": self.T(m)}

    def light(self, s):
        s = radiometric(s)
        if s["type"] not in ("environment", "point", "directional") or "sky" in s or "image" in s:
            raise Unsupported("a light of the type " + s["type"])
        if "slide" in s:
            raise Unsupported("a lamp with a slide")
        if s["type"] == "environment":
            return {"type": "constant", "radiance": self.number(s["radiance"])}
        if s["type"] == "point":
            return {"type": "point", "position": s["position_m"], "intensity": self.number(s["intensity"])}
        return {"type": "directional", "direction": s["direction"], "irradiance": self.number(s["irradiance"])}

    def load(self, s):
        d = self.scene(s)
        for key, value in d.items():
            if isinstance(value, dict) and value.get("type") == "mesh":
                d[key] = self.mesh(key, value)
        return self.mi.load_dict(d)

    def mesh(self, name, s):
        mi = self.mi
        properties = mi.Properties()
        for part in ("bsdf", "emitter"):
            if part in s:
                properties[part] = mi.load_dict(s[part])
        mesh = mi.Mesh(name, len(s["vertices"]), len(s["triangles"]), props=properties)
        values = mi.traverse(mesh)
        values["vertex_positions"] = s["vertices"].astype(np.float32).ravel()
        values["faces"] = s["triangles"].ravel()
        values.update()
        return mesh


def measure(mi, scene, truth, seconds):
    """Pixels and the variance of each pixel's mean, from PASSES seeds; more paths until the noise will do."""
    need = truth["must_resolve"]
    need = None if need is None else max(need - truth["tolerance"], 0.5 * need)
    spp, spent, seed, start = 16, 0, 0, time.perf_counter()
    sums, squares, count = 0.0, 0.0, 0
    while True:
        # Passes of one size are averaged; when the size grows, earlier ones are dropped, which favours no outcome.
        for _ in range(PASSES):
            seed += 1
            picture = np.array(mi.render(scene, spp=spp, seed=seed), dtype=np.float64)[..., 0]
            sums, squares, count = sums + picture, squares + picture**2, count + 1
        mean = sums / count
        variance = np.maximum(squares / count - mean**2, 0.0) / (count - 1)
        error = np.sqrt(np.nansum(variance)) / variance.size
        spent = time.perf_counter() - start
        if need is None or STANDARD_ERRORS * error <= need or spent > seconds or not np.isfinite(mean).all():
            return mean, variance, spp * count, spent
        # A hundred thousand paths a pass are a good load; beyond that, more passes.
        if spp < 256:
            spp, sums, squares, count = 4 * spp, 0.0, 0.0, 0


def place(mi, meter, sampler):
    """Places on a meter, its normal, and its area, which is 1 for a point."""
    if meter["type"] == "irradiance":
        normal = unit(np.array(meter["normal"], float))
        return mi.Point3f(*map(float, meter["position_m"])), mi.Normal3f(*normal.tolist()), 1.0
    if meter["type"] != "flux":
        raise Unsupported("a meter of the type " + meter["type"])
    corner, u, v = (np.array(meter[key], float) for key in ("origin_m", "u_m", "v_m"))
    normal, at = np.cross(u, v), sampler.next_2d()
    places = mi.Point3f(*corner.tolist()) + at.x * mi.Vector3f(*u.tolist()) + at.y * mi.Vector3f(*v.tolist())
    return places, mi.Normal3f(*unit(normal).tolist()), np.linalg.norm(normal)


def read_meter(mi, scene, integrator, meter, sampler, count):
    """One reading by so many rays: what lamps send to the meter, and what its surroundings do."""
    import drjit as dr

    places, normal, area = place(mi, meter, sampler)
    # Off a surface that the meter may lie on, by what single precision can tell.
    at = dr.zeros(mi.SurfaceInteraction3f, count)
    at.p, at.n = places + 1e-5 * normal, normal
    lamp, irradiance = scene.sample_emitter_direction(at, sampler.next_2d(), True)
    direct = irradiance[0] * dr.maximum(0.0, dr.dot(lamp.d, normal))
    ways = mi.Frame3f(normal).to_world(mi.warp.square_to_cosine_hemisphere(sampler.next_2d()))
    radiance, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(mi.Ray3f(at.p, ways)))
    return area * float(np.mean(np.array(direct, dtype=np.float64) + np.pi * np.array(radiance[0], dtype=np.float64)))


def measure_meters(mi, scene, meters, truth, seconds):
    """The mean of all readings and its variance, from PASSES seeds; more rays until the noise will do."""
    need = truth["must_resolve"]
    need = None if need is None else max(need - truth["tolerance"], 0.5 * need)
    integrator, count, seed, start = scene.integrator(), 1 << 14, 0, time.perf_counter()
    while True:
        readings = []
        for _ in range(PASSES):
            reading = 0.0
            for meter in meters:
                seed += 1
                sampler = mi.load_dict({"type": "independent"})
                sampler.seed(seed, count)
                reading += read_meter(mi, scene, integrator, meter, sampler, count) / len(meters)
            readings.append(reading)
        mean, variance = np.mean(readings), np.var(readings, ddof=1) / PASSES
        spent = time.perf_counter() - start
        if need is None or STANDARD_ERRORS * np.sqrt(variance) <= need or 5 * spent > seconds or not np.isfinite(mean):
            return np.full((1, 1), mean), np.full((1, 1), variance), PASSES * count, spent
        count *= 4


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("truths", type=pathlib.Path)
    parser.add_argument("pictures", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--variant", default="llvm_ad_mono")
    parser.add_argument("--seconds", type=float, default=20.0, help="most seconds a truth, but for the first passes")
    parser.add_argument("--threads", type=int, default=0)
    args = parser.parse_args()

    import drjit
    import mitsuba as mi

    mi.set_variant(args.variant)
    mi.set_log_level(mi.LogLevel.Error)
    if args.threads:
        drjit.set_thread_count(args.threads)
    args.pictures.mkdir(parents=True, exist_ok=True)
    polarised = "polarized" in args.variant
    for truth in json.loads((args.truths / "truths.json").read_text())["truths"]:
        name, claims = truth["name"], truth["claims"]
        # What is measured needs the whole format; what Mitsuba cannot be told of it is seen when it is translated.
        unsupported = UNSUPPORTED & set(claims) - ({"whole-format"} if truth["quantity"] == "meters" else set())
        for claim in unsupported:
            print(f"{name}: not supported: {claim}", flush=True)
        if unsupported:
            continue
        if args.names and not any(part in name for part in args.names):
            continue
        if ("averages-polarisation" if polarised else "carries-polarisation") in claims:
            continue
        try:
            said = json.loads((args.truths / truth["scene"]).read_text())
            scene = Translator(mi, truth["band_nm"]).load(said)
            if "meters" in said:
                mean, variance, spp, spent = measure_meters(mi, scene, said["meters"], truth, args.seconds)
            else:
                mean, variance, spp, spent = measure(mi, scene, truth, args.seconds)
        except Unsupported as why:
            print(f"{name}: not supported: {why}", flush=True)
            continue
        except RuntimeError as why:
            print(f"{name}: refused: {str(why).splitlines()[0]}", flush=True)
            continue
        # A variant of one wavelength answers 1 to a radiance of 1 in any band: no white picture is needed.
        prefix = "meters." if "meters" in said else ""
        channels = np.stack([mean, variance], axis=-1).astype(np.float32)
        bitmap = mi.Bitmap(channels, mi.Bitmap.PixelFormat.MultiChannel, [prefix + "Y", "Variance." + prefix + "Y"])
        bitmap.write(str(args.pictures / truth["picture"]))
        print(f"{name}: {mean.mean():.8g}, {truth['value']:.8g} is true, {spp} paths a pixel in {spent:.1f} s", flush=True)


if __name__ == "__main__":
    main()
