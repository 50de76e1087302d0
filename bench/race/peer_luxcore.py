"""LuxCore adapter (pyluxcore, PATHCPU)."""
import math
import os
import time

import numpy as np

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

    def load(self, s):
        lux = self.lux
        t = time.perf_counter()
        self.s = s
        cam = s["camera"]
        p = lux.Properties()
        P = lambda k, v: p.Set(lux.Property(k, v))
        P("scene.camera.type", "perspective")
        P("scene.camera.lookat.orig", list(map(float, cam["origin"])))
        P("scene.camera.lookat.target", list(map(float, cam["target"])))
        P("scene.camera.up", list(map(float, cam["up"])))
        assert cam["width"] >= cam["height"]
        P("scene.camera.fieldofview", cam["fov_x"])  # along the longer image side
        P("scene.camera.cliphither", 1e-3)
        P("scene.camera.clipyon", 1e4)
        P("scene.camera.autofocus.enable", False)
        P("scene.camera.lensradius", float(cam["aperture"]))
        P("scene.camera.focaldistance", float(cam["focus"]))
        for name, m in s["materials"].items():
            k = "scene.materials." + name
            if m["type"] == "diffuse":
                P(k + ".type", "matte")
                P(k + ".kd", m["color"]["rgb"])
            elif m["type"] == "mirror":
                P(k + ".type", "mirror")
                P(k + ".kr", m["color"]["rgb"])
            else:
                P(k + ".type", "glass")
                P(k + ".kr", [1.0, 1.0, 1.0])
                P(k + ".kt", [1.0, 1.0, 1.0])
                P(k + ".exteriorior", 1.0)
                if "cauchy" in m and not self.opts.get("no_dispersion"):
                    P(k + ".interiorior", m["cauchy"][0])  # LuxCore: ior is Cauchy's A
                    P(k + ".cauchyb", m["cauchy"][1])
                else:
                    P(k + ".interiorior", m["ior"])
        scene = lux.Scene()
        for i, sh in enumerate(s["shapes"]):
            if "emission" in sh and sh["type"] == "sphere" and self.opts.get("native_sphere_light"):
                # cheap to sample but not hit by rays: missing from mirrors and from the camera
                k, rad = "scene.lights.l%d" % i, sh["radius"]
                P(k + ".type", "sphere")
                P(k + ".position", sh["center"])
                P(k + ".radius", rad)
                P(k + ".color", [float(x) for x in sh["emission"]["rgb"]])
                g = math.pi * rad * rad  # radiance -> radiant intensity
                P(k + ".gain", [g, g, g])
                continue
            if "emission" in sh:
                k = "scene.materials.light%d" % i
                P(k + ".type", "matte")
                P(k + ".kd", [0.0, 0.0, 0.0])
                P(k + ".emission", [float(x) for x in sh["emission"]["rgb"]])
                P(k + ".emission.gain", [1.0, 1.0, 1.0])
                P(k + ".emission.power", 0.0)
                P(k + ".emission.efficency", 0.0)
            o = "scene.objects.o%d" % i
            if sh["type"] == "quad":
                c, e1, e2 = (np.array(sh[q], float) for q in ("corner", "e1", "e2"))
                v = [c, c + e1, c + e1 + e2, c + e2]
                P("scene.shapes.s%d.type" % i, "inlinedmesh")
                P("scene.shapes.s%d.vertices" % i, [float(x) for q in v for x in q])
                P("scene.shapes.s%d.faces" % i, [0, 1, 2, 0, 2, 3])
            else:
                if sh["type"] == "mesh":
                    f = scenes.mesh_path(sh["file"])
                elif "emission" in sh:
                    # few triangles: each is a light of its own, and 960 per sphere starve the sky
                    # of samples (relMSE x 20 at equal spp)
                    nu = int(self.opts.get("light_mesh", 16))
                    f = scenes.sphere_ply(sh["center"], sh["radius"], nu, nu // 2, match_area=True)
                else:
                    f = scenes.sphere_ply(sh["center"], sh["radius"])
                P("scene.shapes.s%d.type" % i, "mesh")
                P("scene.shapes.s%d.ply" % i, f)
            P(o + ".shape", "s%d" % i)
            P(o + ".material", sh.get("material", "light%d" % i))
        if s["env"]:
            P("scene.lights.env.type", "constantinfinite")
            P("scene.lights.env.color", [float(x) for x in s["env"]["rgb"]])
            P("scene.lights.env.gain", [1.0, 1.0, 1.0])
        scene.Parse(p)
        self.scene = scene
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
        pass
