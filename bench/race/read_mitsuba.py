"""Reads the files of Mitsuba 3 that draw.py and hard.py write into the neutral form of scenes.py, for renderers that do not read them.

    python3 read_mitsuba.py FILE.xml       # prints the neutral form

The neutral form is that of scenes.py, and more. A material may be plastic, metal, thin glass, a blend, a normal map or a mask, with
other materials in it. A colour may be {"image": FILE, "scale": s, "raw": bool}. A mesh has a "matrix" to the world; a mesh that is
there many times is the same file with many matrices. A lamp of such a file hides what is behind it ("opaque").

An element that is not known here is an error, so a peer never renders a scene that it has read in part. Needs numpy.
"""
import json
import math
import os
import sys
import xml.etree.ElementTree as tree

import numpy as np


class Unknown(ValueError):
    """The file has something that this reader does not know."""


def numbers(text):
    return [float(v) for v in text.replace(",", " ").split()]


def vector(e, default=0.0):
    if "value" in e.attrib:
        v = numbers(e.get("value"))
        return np.array(v if len(v) == 3 else 3 * v)
    return np.array([float(e.get(k, default)) for k in "xyz"])


def look_at(e):
    """Mitsuba's: +z to the target, +y up, +x to the left."""
    origin, target, up = (np.array(numbers(e.get(k))) for k in ("origin", "target", "up"))
    forward = (target - origin) / np.linalg.norm(target - origin)
    left = np.cross(up, forward)
    left /= np.linalg.norm(left)
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = left, np.cross(forward, left), forward, origin
    return m


def step(e):
    """One step of a transform as a matrix."""
    m = np.eye(4)
    if e.tag == "translate":
        m[:3, 3] = vector(e)
    elif e.tag == "scale":
        m[:3, :3] = np.diag(vector(e, 1.0))
    elif e.tag == "rotate":
        x, y, z = axis = vector(e) / np.linalg.norm(vector(e))
        a = math.radians(float(e.get("angle")))
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        m[:3, :3] = math.cos(a) * np.eye(3) + math.sin(a) * cross + (1 - math.cos(a)) * np.outer(axis, axis)
    elif e.tag == "lookat":
        m = look_at(e)
    else:
        raise Unknown("transform <%s>" % e.tag)
    return m


class Reader:
    def __init__(self, path):
        self.folder = os.path.dirname(os.path.abspath(path))
        self.root = tree.parse(path).getroot()
        self.materials, self.named, self.groups, self.shapes = {}, {}, {}, []

    # ------------------------------------------------------------ values
    def child(self, e, name):
        return next((c for c in e if c.get("name") == name), None)

    def value(self, e, name, default=None):
        c = self.child(e, name)
        if c is None and default is None:
            raise Unknown("%s without %s" % (e.get("type"), name))
        return default if c is None else float(c.get("value"))

    def matrix(self, e, name="to_world"):
        m = np.eye(4)
        c = self.child(e, name)
        for s in c if c is not None else ():
            m = step(s) @ m
        return m

    def file(self, e):
        return os.path.join(self.folder, self.child(e, "filename").get("value"))

    def colour(self, e, name, default=0.5):
        """Three channels, or an image of them."""
        c = self.child(e, name)
        if c is None:
            return {"rgb": 3 * [default]}
        if c.tag in ("rgb", "float", "spectrum"):
            v = numbers(c.get("value"))
            return {"rgb": v if len(v) == 3 else 3 * v}
        if c.tag != "texture" or c.get("type") != "bitmap":
            raise Unknown("texture %s" % c.get("type"))
        scale = np.diag(self.matrix(c, "to_uv"))[:2]
        raw = self.child(c, "raw")
        return {"image": self.file(c), "scale": scale.tolist(), "raw": raw is not None and raw.get("value") == "true"}

    # --------------------------------------------------------- materials
    def inner(self, e):
        return [self.bsdf(c) for c in e if c.tag == "bsdf"]

    def bsdf(self, e):
        kind = e.get("type")
        if kind == "twosided":
            # Cycles and LuxCore make all but glass two-sided.
            return self.inner(e)[0]
        if kind == "diffuse":
            return {"type": "diffuse", "color": self.colour(e, "reflectance")}
        if kind in ("plastic", "roughplastic"):
            nonlinear = self.child(e, "nonlinear")
            return {"type": "plastic", "color": self.colour(e, "diffuse_reflectance"), "ior": self.value(e, "int_ior", 1.49),
                    "alpha": self.value(e, "alpha", 0.1) if kind == "roughplastic" else 0.0,
                    "nonlinear": nonlinear is not None and nonlinear.get("value") == "true"}
        if kind == "roughconductor":
            return {"type": "metal", "alpha": self.value(e, "alpha", 0.1), "eta": self.value(e, "eta"), "k": self.value(e, "k")}
        if kind in ("dielectric", "thindielectric"):
            inside, outside = self.value(e, "int_ior", 1.5046), self.value(e, "ext_ior", 1.000277)
            if kind == "thindielectric":
                return {"type": "thin", "ior": inside / outside}
            return {"type": "dielectric", "ior": inside / outside, "inside": inside, "outside": outside}
        if kind == "blendbsdf":
            return {"type": "blend", "weight": self.colour(e, "weight"), "of": self.inner(e)}
        if kind == "normalmap":
            return {"type": "normal-map", "normal": self.colour(e, "normalmap"), "of": self.inner(e)[0]}
        if kind == "mask":
            return {"type": "mask", "opacity": self.colour(e, "opacity"), "of": self.inner(e)[0]}
        raise Unknown("bsdf %s" % kind)

    def material(self, e):
        """The name of a shape's material."""
        found = e.find("bsdf")
        read = self.bsdf(found) if found is not None else {"type": "diffuse", "color": {"rgb": 3 * [0.5]}}
        key = json.dumps(read, sort_keys=True)
        name = self.named.setdefault(key, "m%d" % len(self.named))
        self.materials[name] = read
        return name

    # ------------------------------------------------------------ shapes
    def shape(self, e, place=np.eye(4)):
        kind = e.get("type")
        if kind == "shapegroup":
            self.groups[e.get("id")] = list(e.findall("shape"))
            return
        if kind == "instance":
            for member in self.groups[e.find("ref").get("id")]:
                self.shape(member, self.matrix(e))
            return
        m = place @ self.matrix(e)
        if kind == "ply":
            read = {"type": "mesh", "file": self.file(e), "matrix": m.tolist()}
        elif kind == "rectangle":
            corner = m @ [-1, -1, 0, 1]
            read = {"type": "quad", "corner": corner[:3].tolist(), "e1": (2 * m[:3, 0]).tolist(), "e2": (2 * m[:3, 1]).tolist()}
        elif kind == "sphere" and np.array_equal(m, np.eye(4)):
            read = {"type": "sphere", "center": vector(self.child(e, "center")).tolist(), "radius": self.value(e, "radius")}
        else:
            raise Unknown("shape %s" % kind)
        light = e.find("emitter")
        if light is not None:
            if light.get("type") != "area" or kind == "ply":
                raise Unknown("emitter %s on a %s" % (light.get("type"), kind))
            read.update(emission=self.colour(light, "radiance"), opaque=True)
        else:
            read["material"] = self.material(e)
        self.shapes.append(read)

    def camera(self, e):
        if e.get("type") not in ("perspective", "thinlens") or self.child(e, "fov_axis").get("value") != "x":
            raise Unknown("sensor %s" % e.get("type"))
        look = self.child(e, "to_world")[0]
        film = e.find("film")
        if film.find("rfilter").get("type") != "box":
            raise Unknown("filter %s" % film.find("rfilter").get("type"))
        lens = e.get("type") == "thinlens"
        return {"width": int(self.value(film, "width")), "height": int(self.value(film, "height")), "fov_x": self.value(e, "fov"),
                **{k: numbers(look.get(k)) for k in ("origin", "target", "up")},
                "aperture": self.value(e, "aperture_radius") if lens else 0.0, "focus": self.value(e, "focus_distance") if lens else 1.0}

    def environment(self, e):
        if e.get("type") == "constant":
            return self.colour(e, "radiance", 1.0)
        if e.get("type") == "envmap" and self.child(e, "to_world") is None:
            return {"image": self.file(e), "gain": self.value(e, "scale", 1.0)}
        raise Unknown("emitter %s" % e.get("type"))

    def read(self):
        scene = {"camera": self.camera(self.root.find("sensor")), "materials": self.materials, "shapes": self.shapes, "env": None}
        for e in self.root:
            if e.tag == "shape":
                self.shape(e)
            elif e.tag == "emitter":
                scene["env"] = self.environment(e)
            elif e.tag == "integrator" and e.get("type") == "path":
                scene["max_depth"] = int(self.value(e, "max_depth"))
            elif e.tag != "sensor":
                raise Unknown("<%s>" % e.tag)
        return scene


def read(path):
    return Reader(path).read()


if __name__ == "__main__":
    print(json.dumps(read(sys.argv[1]), indent=1))
