"""LuxCore adapter (pyluxcore): path tracing, with light paths if asked, or bidirectional path tracing."""
import collections
import math
import os
import tempfile
import time

import numpy as np

import parts
import scenes


class Peer:
    def __init__(self, variant, threads, opts):
        t = time.perf_counter()
        import pyluxcore
        pyluxcore.Init()
        self.import_s = time.perf_counter() - t
        pyluxcore.SetLogHandler(lambda m: print(m) if os.environ.get("RACE_VERBOSE") else None)
        self.lux, self.threads, self.opts, self.variant = pyluxcore, threads, opts, variant
        self.version = pyluxcore.Version()
        self.start_s = []
        self.folder = tempfile.TemporaryDirectory(prefix="race-")

    # ------------------------------------------------------- materials
    def _image(self, c, change=None):
        """The name of a texture."""
        path = parts.image(c, self.folder.name, change)
        name = "t%d" % len(self.textures)
        if (path, *c["scale"]) not in self.textures:
            self.textures[(path, *c["scale"])] = name
            k = "scene.textures." + name
            self.P(k + ".type", "imagemap")
            self.P(k + ".file", path)
            self.P(k + ".gamma", 1.0)
            self.P(k + ".mapping.type", "uvmapping2d")
            self.P(k + ".mapping.uvscale", c["scale"])
        return self.textures[(path, *c["scale"])]

    def _colour(self, c, change=None):
        if "image" in c:
            return self._image(c, change)
        value = np.array(c["rgb"], float)
        return (change(value) if change else value).tolist()

    def _share(self, c):
        return self._image(c) if "image" in c else float(np.mean(c["rgb"]))

    def _fields(self, name, m):
        """The nearest that LuxCore has."""
        if m["type"] == "diffuse":
            return {"type": "matte", "kd": self._colour(m["color"])}
        if m["type"] == "mirror":
            return {"type": "mirror", "kr": m["color"]["rgb"]}
        if m["type"] == "plastic":
            # It has no smooth coat but a sharp one.
            alpha = max(m["alpha"], 0.002)
            return {"type": "glossy2", "kd": self._colour(m["color"], parts.under_coat(m)), "ks": [1.0, 1.0, 1.0], "index": m["ior"],
                    "uroughness": alpha, "vroughness": alpha, "multibounce": False, "doublesided": True}
        if m["type"] == "metal":
            self.P("scene.textures.%s.type" % name, "fresnelconst")
            self.P("scene.textures.%s.n" % name, 3 * [m["eta"]])
            self.P("scene.textures.%s.k" % name, 3 * [m["k"]])
            return {"type": "metal2", "fresnel": name, "uroughness": m["alpha"], "vroughness": m["alpha"]}
        if m["type"] == "blend":
            return {"type": "mix", "material1": self._part(name + "-0", m["of"][0]),
                    "material2": self._part(name + "-1", m["of"][1]), "amount": self._share(m["weight"])}
        if m["type"] == "mask":
            # LuxCore calls the opacity transparency.
            return {**self._fields(name, m["of"]), "transparency": self._share(m["opacity"])}
        if m["type"] == "normal-map":
            image = self._image(m["normal"])  # before what refers to it
            self.P("scene.textures.%s-n.type" % name, "normalmap")
            self.P("scene.textures.%s-n.texture" % name, image)
            return {**self._fields(name, m["of"]), "bumptex": name + "-n"}
        glass = {"kr": [1.0, 1.0, 1.0], "kt": [1.0, 1.0, 1.0], "exteriorior": m.get("outside", 1.0)}
        if m["type"] == "thin":
            return {"type": "archglass", **glass, "interiorior": m["ior"]}
        if "cauchy" in m and not self.opts.get("no_dispersion"):
            return {"type": "glass", **glass, "interiorior": m["cauchy"][0], "cauchyb": m["cauchy"][1]}  # LuxCore: ior is Cauchy's A
        return {"type": "glass", **glass, "interiorior": m.get("inside", m["ior"])}

    def _part(self, name, m):
        for key, value in self._fields(name, m).items():
            self.P("scene.materials.%s.%s" % (name, key), value)
        return name

    def _material(self, name):
        if name not in self.made:
            self.made.add(self._part(name, self.s["materials"][name]))
        return name

    # ----------------------------------------------------------- scene
    def _camera(self, cam):
        P = self.P
        P("scene.camera.type", "perspective")
        P("scene.camera.lookat.orig", list(map(float, cam["origin"])))
        P("scene.camera.lookat.target", list(map(float, cam["target"])))
        P("scene.camera.up", list(map(float, cam["up"])))
        assert cam["width"] >= cam["height"]
        P("scene.camera.fieldofview", cam["fov_x"])  # along the longer image side
        # Its film lies one row too low. So the window is moved by one row.
        row, half = 2 / cam["width"], cam["height"] / cam["width"]
        P("scene.camera.screenwindow", [-1.0, 1.0, -half - row, half - row])
        P("scene.camera.cliphither", 1e-3)
        P("scene.camera.clipyon", 1e4)
        P("scene.camera.autofocus.enable", False)
        P("scene.camera.lensradius", float(cam["aperture"]))
        P("scene.camera.focaldistance", float(cam["focus"]))

    def _mesh(self, name, file):
        self.P("scene.shapes.%s.type" % name, "mesh")
        self.P("scene.shapes.%s.ply" % name, file)
        return name

    def _placed(self, i, sh):
        """A mesh with a place: moved where it is used once, an instance where it is used more often."""
        key = sh["file"], sh["material"]
        once = self.uses[key] == 1
        if key not in self.meshes:
            mesh = parts.read_ply(sh["file"])
            file = os.path.join(self.folder.name, "s%d.ply" % i)
            (mesh.moved(sh["matrix"]) if once else mesh).ply(file)
            self.meshes[key] = self._mesh("s%d" % i, file), self._material(sh["material"])
        if not once:
            # Column by column.
            self.P("scene.objects.o%d.transformation" % i, [float(v) for v in np.array(sh["matrix"]).T.ravel()])
        return self.meshes[key]

    def _quad(self, i, sh):
        mesh = parts.quad(sh)
        self.P("scene.shapes.s%d.type" % i, "inlinedmesh")
        self.P("scene.shapes.s%d.vertices" % i, [float(x) for x in mesh.p.ravel()])
        self.P("scene.shapes.s%d.uvs" % i, [float(x) for x in mesh.uv.ravel()])
        self.P("scene.shapes.s%d.faces" % i, [int(k) for k in mesh.faces.ravel()])
        return "s%d" % i

    def _lamp(self, i, sh):
        """An emitter's material."""
        P, k = self.P, "scene.materials.light%d" % i
        P(k + ".type", "matte")
        P(k + ".kd", [0.0, 0.0, 0.0])
        P(k + ".emission", [float(x) for x in sh["emission"]["rgb"]])
        P(k + ".emission.gain", [1.0, 1.0, 1.0])
        P(k + ".emission.power", 0.0)
        P(k + ".emission.efficency", 0.0)
        return "light%d" % i

    def _sphere_light(self, i, sh):
        # cheap to sample but not hit by rays: missing from mirrors and from the camera
        P, k, rad = self.P, "scene.lights.l%d" % i, sh["radius"]
        P(k + ".type", "sphere")
        P(k + ".position", sh["center"])
        P(k + ".radius", rad)
        P(k + ".color", [float(x) for x in sh["emission"]["rgb"]])
        g = math.pi * rad * rad  # radiance -> radiant intensity
        P(k + ".gain", [g, g, g])

    def _object(self, i, sh):
        if "matrix" in sh:
            shape, material = self._placed(i, sh)
        else:
            material = self._lamp(i, sh) if "emission" in sh else self._material(sh["material"])
            if sh["type"] == "quad":
                shape = self._quad(i, sh)
            elif sh["type"] == "mesh":
                shape = self._mesh("s%d" % i, scenes.mesh_path(sh["file"]))
            elif "emission" in sh:
                # few triangles: each is a light of its own, and 960 per sphere starve the sky
                # of samples (relMSE x 20 at equal spp)
                nu = int(self.opts.get("light_mesh", 16))
                shape = self._mesh("s%d" % i, scenes.sphere_ply(sh["center"], sh["radius"], nu, nu // 2, match_area=True))
            else:
                shape = self._mesh("s%d" % i, scenes.sphere_ply(sh["center"], sh["radius"]))
        self.P("scene.objects.o%d.shape" % i, shape)
        self.P("scene.objects.o%d.material" % i, material)

    def _environment(self, env):
        P = self.P
        if "image" in env:
            P("scene.lights.env.type", "infinite")
            P("scene.lights.env.file", env["image"])
            P("scene.lights.env.gamma", 1.0)
            P("scene.lights.env.gain", 3 * [env["gain"]])
            # Its axes are Mitsuba's (-z, x, y), column by column.
            P("scene.lights.env.transformation", [0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        else:
            P("scene.lights.env.type", "constantinfinite")
            P("scene.lights.env.color", [float(x) for x in env["rgb"]])
            P("scene.lights.env.gain", [1.0, 1.0, 1.0])

    def load(self, s):
        lux = self.lux
        t = time.perf_counter()
        self.s, self.textures, self.made, self.meshes = s, {}, set(), {}
        self.uses = collections.Counter((sh["file"], sh["material"]) for sh in s["shapes"] if "matrix" in sh)
        p = lux.Properties()
        self.P = lambda k, v: p.Set(lux.Property(k, v))
        self._camera(s["camera"])
        for i, sh in enumerate(s["shapes"]):
            if "emission" in sh and sh["type"] == "sphere" and self.opts.get("native_sphere_light"):
                self._sphere_light(i, sh)
            else:
                self._object(i, sh)
        if s["env"]:
            self._environment(s["env"])
        self.scene = lux.Scene()
        self.scene.Parse(p)
        self.load_s = time.perf_counter() - t
        return self.load_s

    def _config(self, spp, seed):
        lux, s = self.lux, self.s
        p = lux.Properties()
        P = lambda k, v: p.Set(lux.Property(k, v))
        tile = self.variant == "tilepathcpu"
        P("renderengine.type", self.variant.upper())
        P("renderengine.seed", int(seed))
        P("native.threads.count", int(self.threads))
        P("film.width", s["camera"]["width"])
        P("film.height", s["camera"]["height"])
        P("film.filter.type", "NONE")
        P("film.imagepipelines.0.0.type", "NOP")
        P("film.outputs.0.type", "RGB")
        P("film.outputs.0.filename", "unused.exr")
        d = s["max_depth"]  # checked at depths 2-4 against Mitsuba: same convention
        for k in ("total", "diffuse", "glossy", "specular"):
            P("path.pathdepth." + k, d)
        # Of the bidirectional engine.
        P("path.maxdepth", d)
        P("light.maxdepth", d)
        # Light paths bring what mirrors and glass throw on surfaces: four camera paths for each of them, its default.
        P("path.hybridbackforward.enable", bool(self.opts.get("light_paths")))
        P("path.clamping.variance.maxvalue", 0.0)
        if "light_strategy" in self.opts:
            P("lightstrategy.type", self.opts["light_strategy"].upper())
        if tile:
            a = max(1, int(round(math.sqrt(spp))))
            P("sampler.type", "TILEPATHSAMPLER")
            P("tilepath.sampling.aa.size", a)
            P("tile.multipass.enable", False)
        else:
            P("sampler.type", self.opts.get("sampler", "SOBOL").upper())
            P("sampler.sobol.adaptive.strength", 0.0)
            P("sampler.random.adaptive.strength", 0.0)
            P("batch.haltspp", int(spp))
        return lux.RenderConfig(p, self.scene)

    def render(self, spp, seed):
        """PATHCPU is progressive: the halt test is polled, so the sample count is read back."""
        lux = self.lux
        cfg = self._config(spp, seed)
        ses = lux.RenderSession(cfg)
        t0 = time.perf_counter()
        ses.Start()  # includes BVH build and light preprocessing
        t1 = time.perf_counter()
        c1 = time.process_time()
        self.start_s.append(t1 - t0)
        st = ses.GetStats()
        while not ses.HasDone():
            time.sleep(0.02)
            ses.UpdateStats()
        sec, cpu = time.perf_counter() - t1, time.process_time() - c1
        ses.Stop()
        st = ses.GetStats()
        px = self.s["camera"]["width"] * self.s["camera"]["height"]
        n = st.Get("stats.renderengine.total.samplecount").GetFloat() / px
        film = ses.GetFilm()
        buf = np.zeros((self.s["camera"]["height"], self.s["camera"]["width"], 3), np.float32)
        film.GetOutputFloat(lux.FilmOutputType.RGB, buf, 0)
        img = buf[::-1].copy()  # film rows run bottom-up
        del ses, cfg
        return img, n, sec, cpu

    def extra(self):
        return {"session_start_s": self.start_s[-1]}

    def close(self):
        self.folder.cleanup()
