#!/usr/bin/env python3
"""Holds pbrt-v4 to the oracle's truths.

    etalon verify --export truths
    python3 pbrt-verify.py truths pictures [NAME ...] [--pbrt PROGRAM] [--seconds 8] [--threads 2]
    etalon verify --images pictures

Writes a file of pbrt for each exported scene, renders it with independent seeds until the noise is low enough for the truth
(or the seconds are over), and writes NAME.exr with channels Y and Variance.Y. A spectral film of one bucket answers 1 to a radiance
of 1 at its wavelengths. Only the truths of a sensor of CIE Y are rendered in colour. Scenes of the whole format are taken as far as
pbrt has the same things. What pbrt cannot be told is listed with the reason and left out.
Needs the program pbrt, Python 3.11 and `pip install numpy OpenEXR==3.5.3`.
"""
import argparse
import concurrent.futures
import itertools
import json
import os
import pathlib
import subprocess
import tempfile
import time

import numpy as np
import OpenEXR

PASSES = 16  # independent seeds behind each variance
# The significance of each of some hundred truths, and the power 0.999: (z_α + z_β) standard errors must not exceed what is to be seen.
STANDARD_ERRORS = 9.0
ENDLESS = 2_000_000_000  # bounces: pbrt counts them in 32 bits
VISIBLE = (360.0, 830.0)  # nm, all that pbrt renders
NANOMETRES = np.arange(VISIBLE[0], VISIBLE[1] + 1)  # pbrt keeps the spectra of lamps and media at whole nanometres
LUMINANCE = {"R": 0.2126390, "G": 0.7151687, "B": 0.0721923}  # of pbrt's colours: Rec. 709, white D65

# Claims that pbrt cannot meet, whatever the scene.
UNSUPPORTED = {
    "stokes-parameters": "light that carries its polarisation",
    "carries-polarisation": "light that carries its polarisation",
    "thin-films": "thin films",
    "gratings": "gratings",
    "fluorescence": "fluorescence",
    "meters": "meters",
    "bands": "bands of wavelengths",
    "priorities": "solids that share a place",
    "masks": "masks that coincide with other surfaces",
    "specular-connections": "lamps without area, seen by mirrors and through glass",
    "lossless-rough-glass": "rough surfaces without loss",
    "lossless-rough-metal": "rough surfaces without loss",
}


class Unsupported(Exception):
    pass


class Refused(Exception):
    pass


def only(thing, what, *keys):
    """Refuses a thing that says more than pbrt can be told."""
    for key in thing:
        if key not in keys:
            raise Unsupported(f"{what} with {key}")


def word(value):
    return f'"{value}"' if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else repr(value)


def say(directive, *words, **values):
    """A directive of pbrt. The key of a value is the type and the name of a parameter, with __ between."""
    text = [directive] + [word(w) for w in np.ravel(words).tolist()]
    for key, value in values.items():
        text.append(f'"{key.replace("__", " ")}" [{" ".join(map(word, np.ravel(value).tolist()))}]')
    return " ".join(text)


def matrix(columns):
    """A transform by the images of the axes and of the origin."""
    return say("ConcatTransform [", np.hstack([np.array(columns, float), [[0], [0], [0], [1]]])) + " ]"


def unit(v):
    return np.array(v, float) / np.linalg.norm(v)


def frame(z, origin):
    """To a place whose third axis is z."""
    z = unit(z)
    x = unit(np.cross(np.eye(3)[np.argmin(np.abs(z))], z))
    return matrix([x, np.cross(z, x), z, origin])


def steps(transform):
    """The steps of a transform. pbrt applies first what it is told last."""
    said = {
        "translate_m": lambda v: say("Translate", np.array(v, float)),
        "rotate": lambda v: say("Rotate", float(v["angle_deg"]), *map(float, v["axis"])),
        "scale": lambda v: say("Scale", np.broadcast_to(np.array(v, float), 3)),
        "matrix": lambda v: matrix(np.transpose(v)),
    }
    return [said[kind](value) for s in reversed(transform) for kind, value in s.items()]


def undone(transform):
    """The steps that undo a transform of a camera, which neither scales nor mirrors."""
    for s in transform:
        only(s, "a camera that moves", "translate_m", "rotate")
    back = [{"translate_m": np.negative(s["translate_m"])} if "translate_m" in s else
            {"rotate": s["rotate"] | {"angle_deg": -s["rotate"]["angle_deg"]}} for s in transform]
    return steps(back[::-1])


class Translator:
    """A scene of Etalon as the text of a file of pbrt."""

    def __init__(self, s, truth):
        self.s, self.band = s, truth["band_nm"]
        self.colour = "photometric-sensor" in truth["claims"] and not self.band
        self.nm = np.union1d(NANOMETRES, self.band or [])
        self.names, self.media, self.air = itertools.count(), [], ""
        self.bodies = [(thing, inside) for thing in s["objects"] if (inside := self.inside(thing))]
        if "medium" in s:
            self.air = self.medium(s["medium"])
        world = [line for thing in s["objects"] for line in self.object(thing)]
        world += [line for placed in s.get("instances", []) for line in self.instance(placed)]
        world += [line for light in s["lights"] for line in self.light(light)]
        self.text = "\n".join(self.view(s["camera"], s["film"]) + ["WorldBegin"] + world) + "\n"

    def at(self, value, nm):
        """A spectrum at some wavelengths."""
        if isinstance(value, (int, float)):
            return np.full(np.shape(nm), float(value))
        if isinstance(value, str):
            return self.at(self.s["spectra"][value], nm)
        if value["type"] == "blackbody":
            h, c, k, metres = 6.62607015e-34, 299792458.0, 1.380649e-23, 1e-9 * np.array(nm)
            planck = 2e-9 * h * c**2 / metres**5 / np.expm1(h * c / (metres * k * value["temperature_k"]))
            return value.get("scale", 1.0) * planck
        if value["type"] != "tabulated":
            raise Unsupported("a spectrum of the type " + value["type"])
        ends = {"left": 0.0, "right": 0.0} if value.get("outside") == "zero" else {}
        return value.get("scale", 1.0) * np.interp(nm, value["wavelengths_nm"], value["values"], **ends)

    def spectrum(self, value):
        nm = np.array(VISIBLE) if isinstance(value, (int, float)) else self.nm
        return np.stack([nm, self.at(value, nm)], axis=-1)

    def shine(self, name, value):
        """The spectrum of a lamp and its scale. pbrt divides the spectrum by its luminance: what is left is as bright as a constant 1."""
        if isinstance(value, dict) and value["type"] in ("constant", "illuminant"):
            scale = value.get("value", value.get("scale", 1.0))
            if value.get("name", "E") != "E":
                return {f"spectrum__{name}": "stdillum-" + value["name"], "float__scale": float(scale)}
            value = scale
        if not isinstance(value, (int, float)):
            if not self.band:
                raise Unsupported("coloured lamps")
            value = self.at(value, 0.5 * sum(self.band))
        return {f"spectrum__{name}": self.spectrum(1.0), "float__scale": float(value)}

    def index(self, index):
        if isinstance(index, (int, float)):
            return float(index)
        if isinstance(index, str) or index["type"] == "glass":
            raise Unsupported("a glass by its name alone")
        if index["type"] == "constant":
            return float(index["value"])
        square = (1e-3 * (np.clip(self.nm, *index["range_nm"]) if "outside_fit" in index else self.nm)) ** 2
        if index["type"] == "cauchy":
            return index["a"] + index.get("b_um2", 0.0) / square + index.get("c_um4", 0.0) / square**2
        return np.sqrt(1 + sum(b * square / (square - c) for b, c in zip(index["b"], index["c_um2"])))

    def ratio(self, interior, exterior=1.0):
        ratio = self.index(interior) / self.index(exterior)
        return {"float__eta": ratio} if np.ndim(ratio) == 0 else {"spectrum__eta": np.stack([self.nm, ratio], axis=-1)}

    def view(self, c, film):
        """All that comes before the world."""
        eye, size = np.array(c["position_m"], float), {"integer__xresolution": film["width"], "integer__yresolution": film["height"]}
        target = np.array(c["look_at_m"], float) if "look_at_m" in c else eye + c["direction"]
        # pbrt's camera is left-handed, and shows a right-handed world as in a mirror.
        lines = [say("LookAt", *eye, *target, *map(float, c.get("up", [0, 1, 0])))]
        moments, more = c.get("keyframes", []), {}
        if len(moments) not in (0, 2):
            raise Unsupported("motion by more or fewer than two keyframes")
        if moments:
            more = dict(zip(("float__shutteropen", "float__shutterclose"), c.get("shutter_s", [0.0, 0.0])))
            lines.insert(0, say("TransformTimes", *(float(k["time_s"]) for k in moments)))
            for when, k in zip(("StartTime", "EndTime"), moments):
                lines += [f"ActiveTransform {when}", *undone(k.get("transform", []))]
            lines.append("ActiveTransform All")
        only(c, "a camera", "type", "position_m", "look_at_m", "direction", "up", "keyframes", "shutter_s", "height_m", "vertical_fov_deg",
             "horizontal_fov_deg", "focal_length_m", "sensor_height_m", "sensor_width_m", "lens")
        aspect, lens = film["width"] / film["height"], c.get("lens")
        if c["type"] == "orthographic":
            half = 0.5 * c["height_m"]
        elif "vertical_fov_deg" in c:
            half = np.tan(0.5 * np.radians(c["vertical_fov_deg"]))
        elif "horizontal_fov_deg" in c:
            half = np.tan(0.5 * np.radians(c["horizontal_fov_deg"])) / aspect
        else:
            near = 1 / c["focal_length_m"] - (1 / lens["focus_distance_m"] if lens else 0.0)
            half = 0.5 * near * (c["sensor_height_m"] if "sensor_height_m" in c else c["sensor_width_m"] / aspect)
        if c["type"] != "orthographic":
            more["float__fov"] = 90.0  # then the edges of the window are slopes
        if lens:
            radius = lens["radius_m"] if "radius_m" in lens else 0.5 * c["focal_length_m"] / lens["f_number"]
            more |= {"float__lensradius": radius, "float__focaldistance": lens["focus_distance_m"]}
        window = [-half * aspect, half * aspect, -half, half]
        low, high = self.band or VISIBLE
        bucket = {} if self.colour else {"integer__nbuckets": 1, "float__lambdamin": low, "float__lambdamax": high}
        shape = film.get("filter", {"type": "box"})
        if shape["type"] not in ("box", "tent"):
            raise Unsupported("a pixel filter of the type " + shape["type"])
        kind, radius = ("box", 0.5) if shape["type"] == "box" else ("triangle", shape.get("radius_px", 1.0))
        depth = self.s["integrator"].get("max_depth")
        return self.media + lines + [
            say("MediumInterface", "", self.around(eye)),
            say("Camera", c["type"], float__screenwindow=window, **more),
            say("Film", "rgb" if self.colour else "spectral", string__sensor="cie1931", bool__savefp16=False, **size, **bucket),
            say("PixelFilter", kind, float__xradius=radius, float__yradius=radius),
            say("Sampler", "zsobol"),
            # pbrt counts what scatters light, not the ways between.
            say("Integrator", "volpath", integer__maxdepth=ENDLESS if depth is None else depth - 1, bool__regularize=False),
        ]

    def medium(self, m):
        only(m, "a medium", "absorption_per_m", "scattering_per_m", "extinction_per_m", "albedo", "phase", "source_radiance")
        phase = m.get("phase", {"type": "isotropic"})
        if phase["type"] not in ("isotropic", "henyey-greenstein"):
            raise Unsupported("a phase function of the type " + phase["type"])
        taken, given, both, albedo = (
            self.at(m.get(k, 0.0), NANOMETRES) for k in ("absorption_per_m", "scattering_per_m", "extinction_per_m", "albedo"))
        sigma = {"sigma_a": taken + (1 - albedo) * both, "sigma_s": given + albedo * both}
        emission = self.shine("Le", m["source_radiance"]) if "source_radiance" in m else {}
        if emission:
            emission["float__Lescale"] = emission.pop("float__scale")
        values = {f"spectrum__{k}": np.stack([NANOMETRES, v], -1) for k, v in sigma.items()} | emission
        name = f"medium {next(self.names)}"
        self.media.append(say("MakeNamedMedium", name, string__type="homogeneous", float__g=float(phase.get("g", 0.0)), **values))
        return name

    def inside(self, thing):
        """The medium inside of a thing, if it has one."""
        m = self.named(thing["material"])
        medium = m.get("medium", {"absorption_per_m": m["absorption_per_m"]} if "absorption_per_m" in m else None)
        if "transmittance_depth_m" in m:
            sigma = -np.log(self.at(m["transmittance"], NANOMETRES)) / m["transmittance_depth_m"]
            medium = {"absorption_per_m": {"type": "tabulated", "wavelengths_nm": NANOMETRES, "values": sigma}}
        if medium and (thing["shape"]["type"] not in ("sphere", "box") or thing.get("transform")):
            raise Unsupported("a medium in a body that is neither a ball nor a box")
        return medium and self.medium(medium)

    def around(self, place, but=None):
        """The medium of the smallest of the bodies that hold a place. Bodies hold each other, and do not overlap."""
        found, least = self.air, np.inf
        for thing, inside in self.bodies:
            s = thing["shape"]
            if s["type"] == "sphere":
                size, holds = 2 * s["radius_m"], np.linalg.norm(np.subtract(place, s.get("center_m", [0, 0, 0]))) < s["radius_m"]
            else:
                size = np.max(np.subtract(s["max_m"], s["min_m"]))
                holds = np.all((place > np.array(s["min_m"])) & (place < np.array(s["max_m"])))
            if holds and thing is not but and size < least:
                found, least = inside, size
        return found

    def named(self, m):
        return self.s["materials"][m] if isinstance(m, str) else m

    def rough(self, m):
        if not any(k in m for k in ("alpha", "alpha_u", "alpha_v")):
            return {}
        if m.get("multiple_scattering") != "lost":
            raise Unsupported("rough surfaces without loss")
        if m.get("distribution", "ggx") != "ggx" or m.get("masking", "correlated") != "correlated":
            raise Unsupported("facets other than GGX's with correlated masking")
        u, v = (float(m.get(k, m.get("alpha"))) for k in ("alpha_u", "alpha_v"))
        return {"bool__remaproughness": False, "float__uroughness": u, "float__vroughness": v}

    def material(self, m):
        """The type of a material of pbrt, its parameters, and the directives that make what it is mixed of."""
        m = self.named(m)
        kind, n, k = m["type"], *({"type": "tabulated", "wavelengths_nm": m.get("wavelengths_nm"), "values": m.get(x)} for x in "nk")
        if kind not in ("black", "lambert", "translucent", "mirror", "blend", "thin-dielectric", "dielectric", "boundary", "conductor"):
            raise Unsupported("a material of the type " + kind)
        only(m, "a surface", "type", "reflectance", "transmittance", "transmittance_depth_m", "absorption_per_m", "medium", "interior",
             "exterior", "index", "first", "second", "weight", "sides", "wavelengths_nm", "n", "k", "outside_fit", "alpha", "alpha_u",
             "alpha_v", "tangent_rotation_deg", "multiple_scattering", "distribution", "masking")
        if m.get("sides", "both") != "both":
            raise Unsupported("surfaces of which one side is black")
        if kind in ("black", "lambert"):
            return "diffuse", {"spectrum__reflectance": self.spectrum(m.get("reflectance", 0.0))}, []
        if kind == "translucent":
            return "diffusetransmission", {f"spectrum__{k}": self.spectrum(m[k]) for k in ("reflectance", "transmittance")}, []
        if kind == "mirror":
            # A metal of the index 0 + i reflects all light at every angle. A mix with black draws the rays that it reflects.
            perfect = {"type": "conductor", "wavelengths_nm": VISIBLE, "n": [0.0, 0.0], "k": [1.0, 1.0]}
            return self.material({"type": "blend", "first": {"type": "black"}, "second": perfect, "weight": m.get("reflectance", 1.0)})
        if kind == "blend":
            lines, names = [], []
            for part in (m["first"], m["second"]):
                kind, values, before = self.material(part)
                names.append(f"material {next(self.names)}")
                lines += before + [say("MakeNamedMaterial", names[-1], string__type=kind, **values)]
            return "mix", {"string__materials": names, "float__amount": float(m["weight"])}, lines
        if kind == "thin-dielectric":
            return "thindielectric", self.ratio(m.get("index", 1.5)), []
        if kind == "dielectric":
            return "dielectric", self.ratio(m["interior"], m.get("exterior", 1.0)) | self.rough(m), []
        if kind == "boundary":
            return "interface", {}, []
        metal = {"reflectance": m["reflectance"]} if "reflectance" in m else {"eta": n, "k": k}
        return "conductor", {f"spectrum__{k}": self.spectrum(v) for k, v in metal.items()} | self.rough(m), []

    def object(self, thing):
        only(thing, "an object", "name", "shape", "material", "emission", "transform")
        m, s, emission = self.named(thing["material"]), thing["shape"], thing.get("emission")
        kind, values, lines = self.material(m)
        lines += ["AttributeBegin", *steps(thing.get("transform", []))]
        inside = [name for body, name in self.bodies if body is thing]
        if not inside and {"medium", "absorption_per_m", "transmittance_depth_m"} & set(m):
            raise Unsupported("a medium in an instance")
        if m["type"] in ("dielectric", "boundary") and (self.bodies or self.air):
            place = s.get({"sphere": "center_m", "box": "max_m", "parallelogram": "origin_m"}.get(s["type"]))
            if not place:
                raise Unsupported("a medium around a body of the type " + s["type"])
            lines.append(say("MediumInterface", *inside or [""], self.around(np.array(place, float), thing)))
        lines.append(say("Material", kind, **values))
        if emission:
            only(emission, "a lamp", "radiance", "sides")
            sides = emission.get("sides", "front")
            if sides == "back" and m["type"] in ("dielectric", "boundary"):
                raise Unsupported("lamps on the back of glass")
            lines += ["ReverseOrientation"] if sides == "back" else []
            lines.append(say("AreaLightSource", "diffuse", bool__twosided=sides == "both", **self.shine("L", emission["radiance"])))
        return [*lines, *self.shape(s, m), "AttributeEnd"]

    def shape(self, s, m):
        kind, turn, grain = s["type"], np.radians(m.get("tangent_rotation_deg", 0.0)), m.get("alpha_u") != m.get("alpha_v")
        only(s, "a shape", "type", "center_m", "radius_m", "normal", "start_m", "end_m", "capped", "origin_m", "u_m", "v_m", "min_m",
             "max_m", "vertices_m", "triangles", *(["normals", "shading"] if "normals" in s else []))
        if grain and kind != "parallelogram" and (kind != "sphere" or turn):
            raise Unsupported("a grain that is not along a coordinate")
        if kind == "sphere":
            # The longitude of pbrt's balls is about z, and here about y.
            pole = [say("Rotate", -90.0, 1.0, 0.0, 0.0)] if grain else []
            return [say("Translate", *map(float, s.get("center_m", [0, 0, 0])))] + pole + [say("Shape", kind, float__radius=s["radius_m"])]
        if kind == "disk":
            return [frame(s["normal"], s.get("center_m", [0, 0, 0])), say("Shape", kind, float__radius=s["radius_m"])]
        if kind == "cylinder":
            start, end = np.array(s["start_m"], float), np.array(s["end_m"], float)
            caps = [(start - end, start), (end - start, end)] if s.get("capped", True) else []
            tube = say("Shape", kind, float__radius=s["radius_m"], float__zmin=0.0, float__zmax=np.linalg.norm(end - start))
            ends = [["AttributeBegin", frame(n, c), say("Shape", "disk", float__radius=s["radius_m"]), "AttributeEnd"] for n, c in caps]
            return [*itertools.chain(*ends), frame(end - start, start), tube]
        more = {}
        if kind == "parallelogram":
            corner, u, v = (np.array(s[key], float) for key in ("origin_m", "u_m", "v_m"))
            corners, triangles = [corner, corner + u, corner + v, corner + u + v], [0, 1, 3, 0, 3, 2]
            if not grain:
                return [say("Shape", "bilinearmesh", point3__P=corners)]
            # pbrt turns the tangent as its coordinates say on triangles alone.
            normal = unit(np.cross(u, v))
            along = np.cos(turn) * unit(u) + np.sin(turn) * np.cross(normal, unit(u))
            more["point2__uv"] = np.array(corners) @ np.stack([along, np.cross(normal, along)], axis=-1)
        elif kind == "box":
            corners = [np.where([i & 1, i & 2, i & 4], s["max_m"], s["min_m"]).astype(float) for i in range(8)]
            faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
            triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
        else:
            corners, triangles = np.array(s["vertices_m"], float), s["triangles"]
            if "normals" in s and s.get("shading") != "flat":
                more["normal__N"] = [unit(n) for n in s["normals"]]
        return [say("Shape", "trianglemesh", point3__P=corners, integer__indices=triangles, **more)]

    def instance(self, placed):
        if "keyframes" in placed:
            raise Unsupported("lamps that move")
        group, lines = self.s["groups"][placed["group"]], []
        for transform in placed.get("transforms", [placed.get("transform", [])]):
            lines += ["AttributeBegin", *steps(transform)]
            lines += [line for thing in group.get("objects", []) for line in self.object(thing)]
            lines += [line for inner in group.get("instances", []) for line in self.instance(inner)] + ["AttributeEnd"]
        return lines

    def light(self, s):
        kinds = {"environment": ("infinite", "L", "radiance"), "directional": ("distant", "L", "irradiance"),
                 "point": ("point", "I", "intensity"), "spot": ("spot", "I", "intensity")}
        if s["type"] not in kinds:
            raise Unsupported("a light of the type " + s["type"])
        (kind, name, key), more, place = kinds[s["type"]], {}, s.get("position_m")
        only(s, "a light", "name", "type", key, "position_m", "direction", "half_angle_deg", "inner_half_angle_deg")
        if kind == "distant":
            only(s, "a light", "name", "type", key, "direction")
            more = {"point3__from": [0.0, 0.0, 0.0], "point3__to": np.array(s["direction"], float)}
        elif place:
            more = {"point3__from": np.array(place, float)}
        if kind == "spot":
            # Both fall off by the same polynomial of the cosine.
            outer = float(s["half_angle_deg"])
            more |= {"point3__to": np.add(place, s["direction"]), "float__coneangle": outer,
                     "float__conedeltaangle": outer - s.get("inner_half_angle_deg", 0.8 * outer)}
        lines = [say("MediumInterface", "", self.around(np.array(place, float)))] if place else []
        return ["AttributeBegin", *lines, say("LightSource", kind, **self.shine(name, s[key]), **more), "AttributeEnd"]


class Renderer:
    def __init__(self, program, threads, folder):
        self.program, self.folder, self.seeds = program, folder, itertools.count(1)
        self.pool = concurrent.futures.ThreadPoolExecutor(threads)

    def render(self, text, spp, patience):
        """The pictures of PASSES new seeds. Each has a process of one thread."""
        (self.folder / "scene.pbrt").write_text(text)
        return np.array(list(self.pool.map(lambda seed: self.picture(seed, spp, patience), itertools.islice(self.seeds, PASSES))))

    def picture(self, seed, spp, patience):
        path = self.folder / f"{seed}.exr"
        command = [self.program, "--quiet", "--nthreads", "1", "--seed", str(seed), "--spp", str(spp), "--outfile", str(path)]
        try:
            run = subprocess.run(command + [str(self.folder / "scene.pbrt")], capture_output=True, text=True, timeout=patience)
        except subprocess.TimeoutExpired:
            raise Refused(f"no picture of {spp} paths a pixel in {patience:.0f} s") from None
        if run.returncode or not path.exists():
            raise Refused(([""] + (run.stdout + run.stderr).strip().splitlines())[-1])
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: np.array(channel.pixels, np.float64) for name, channel in file.channels().items()}
        path.unlink()
        bucket = [pixels for name, pixels in channels.items() if name.startswith("S0.")]
        return (bucket[0] if bucket else sum(weight * channels[name] for name, weight in LUMINANCE.items()))[:, ::-1]


def measure(renderer, text, truth, seconds):
    """Pixels and the variance of each pixel's mean, from PASSES seeds; more paths until the noise will do."""
    need = truth["must_resolve"]
    need = None if need is None else max(need - truth["tolerance"], 0.5 * need)
    x0, x1, y0, y1 = truth["crop_px"] or (0, truth["width"], 0, truth["height"])
    spp, start = 16, time.perf_counter()
    while True:
        # Pictures of fewer paths are dropped, which favours no outcome.
        begin = time.perf_counter()
        pictures = renderer.render(text, spp, max(60.0, 6 * seconds))
        took, spent = time.perf_counter() - begin, time.perf_counter() - start
        mean, variance = pictures.mean(axis=0), pictures.var(axis=0, ddof=1) / PASSES
        error = np.sqrt(np.nansum(variance[y0:y1, x0:x1])) / variance[y0:y1, x0:x1].size
        if need is None or STANDARD_ERRORS * error <= need or spent + took > seconds or not np.isfinite(mean).all():
            return mean, variance, spp * PASSES, spent
        more = np.clip(1.3 * (STANDARD_ERRORS * error / need) ** 2, 2.0, max(2.0, min((seconds - spent) / took, 64.0)))
        spp *= 2 ** round(np.log2(more))  # what pbrt's sampler asks for


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("truths", type=pathlib.Path)
    parser.add_argument("pictures", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--pbrt", default="pbrt", help="the program")
    parser.add_argument("--seconds", type=float, default=8.0, help="most seconds a truth, but for the first passes")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    args = parser.parse_args()

    args.pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        renderer = Renderer(args.pbrt, args.threads, pathlib.Path(folder))
        for truth in json.loads((args.truths / "truths.json").read_text())["truths"]:
            name = truth["name"]
            if args.names and not any(part in name for part in args.names):
                continue
            try:
                for claim in truth["claims"]:
                    if claim in UNSUPPORTED:
                        raise Unsupported(UNSUPPORTED[claim])
                text = Translator(json.loads((args.truths / truth["scene"]).read_text()), truth).text
                mean, variance, spp, spent = measure(renderer, text, truth, args.seconds)
            except (Unsupported, Refused) as why:
                print(f"{name}: {'refused' if isinstance(why, Refused) else 'not supported'}: {why}", flush=True)
                continue
            channels = {"Y": mean.astype(np.float32), "Variance.Y": variance.astype(np.float32)}
            OpenEXR.File({}, channels).write(str(args.pictures / truth["picture"]))
            print(f"{name}: {mean.mean():.8g}, {truth['value']:.8g} is true, {spp} paths a pixel in {spent:.1f} s", flush=True)


if __name__ == "__main__":
    main()
