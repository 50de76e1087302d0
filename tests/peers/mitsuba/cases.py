"""What is compared: a name, its file in `scenes/`, the parameters of the file, and why the pictures may differ, if they may."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Known:
    """Why the pictures differ, and the largest ratio minus 1 of the means of the object, to either side."""

    why: str
    most: float


@dataclass(frozen=True)
class Case:
    file: str
    # Parameters of the file.
    given: dict = field(default_factory=dict)
    known: Known | None = None
    # Times the usual number of samples.
    samples: float = 1
    # Further options of `etalon render`.
    options: tuple = ()
    # Of Mitsuba; the runner's if left out.
    variant: str | None = None

    @property
    def name(self):
        return " ".join([self.file, *map(str, self.given.values()), *([self.variant] if self.variant else [])])

    @property
    def scene(self):
        return f"{self.file}.xml"


def of(file, known=None, samples=1, options=(), variant=None, **given):
    return Case(file, given, known, samples, options, variant)


def lobes(roughness, anisotropic=0, metallic=0, tint=0, sheen=0, flatness=0, coat=0, glass=0, samples=1, variant=None):
    """A principled surface with these lobes."""
    given = dict(roughness=roughness, anisotropic=anisotropic, metallic=metallic, tint=tint)
    return Case("principled-lobes", given | dict(sheen=sheen, flatness=flatness, coat=coat, glass=glass), None, samples, (), variant)


SUM = Known("what a rough coat returns from below is a sum over 64 cosines in Mitsuba, 1.5 % less than the integral", 0.02)
EQUAL_ENERGY = Known(
    "an image that shines is of equal energy in Mitsuba's spectral variants, of D65 in its RGB variants and here",
    0.14,
)
PANE = Known("Mitsuba takes the mean of both polarisations before it adds the passes to and fro inside a pane", 0.02)

POLARISED = "llvm_ad_spectral_polarized"
TILTED = Known("a retarder delays as much at every angle; Mitsuba takes the cosine as a factor", 0.06)

CASES = [
    of("diffuse", depth=2),
    of("spectra"),
    of("sides", sides="one"),
    of("sides", sides="two"),
    of("sides", sides="apart"),
    of("plastic", kind="plastic", nonlinear="false"),
    of("plastic", kind="plastic", nonlinear="true"),
    *(of("rough-plastic", SUM, alpha=alpha, distribution=distribution, nonlinear=nonlinear)
      for alpha, distribution, nonlinear in ((0.2, "ggx", "true"), (0.1, "beckmann", "false"), (0.5, "beckmann", "true"))),
    of("tinted-plastic"),
    *(of("pplastic", alpha=alpha) for alpha in (0.1, 0.3)),
    *(of("metal", metal=metal) for metal in ("Ag", "Al", "Au", "Cr", "Cu", "W")),
    of("mirror"),
    *(of("principled", metallic=metal, glass=0) for metal in (0, 0.5, 1)),
    of("principled", samples=3, metallic=0, glass=1),
    of("principled", samples=3, metallic=0.25, glass=0.5),
    lobes(roughness=0.8, sheen=1),
    lobes(roughness=0.4, flatness=1),
    lobes(roughness=0.7, coat=1),
    # The luminance of a tint is estimated from four wavelengths in the spectral variants.
    lobes(roughness=0.3, tint=1, sheen=0.5, variant="llvm_ad_rgb"),
    lobes(roughness=0.5, anisotropic=0.8, metallic=1),
    lobes(roughness=0.5, metallic=0.3, tint=0.5, sheen=0.6, flatness=0.5, coat=0.7, variant="llvm_ad_rgb"),
    lobes(roughness=0.5, sheen=0.6, coat=0.7, glass=0.5, samples=3),
    *(of("rough-metal", distribution=d, alpha=a) for d in ("ggx", "beckmann") for a in (0.1, 0.4)),
    *(of("measured", what=what) for what in ("isotropic", "half-a-turn", "two-mirrors")),
    of("brushed", samples=2),
    of("brushed-disk", samples=2),
    of("glass", kind="dielectric"),
    of("glass", kind="thindielectric", samples=3),
    of("named-glass"),
    *(of("rough-glass", distribution=d, alpha=a) for d, a in (("ggx", 0.3), ("beckmann", 0.3), ("ggx", 0.98))),
    of("tinted-glass", samples=3, kind="dielectric"),
    of("tinted-glass", PANE, samples=3, kind="thindielectric"),
    of("tinted-rough-glass"),
    *(of("tinted-metal", metal=metal) for metal in ("Au", "none")),
    of("mask", depth=32),
    of("blend"),
    of("image"),
    of("image-srgb", depth=2),
    of("image-turned"),
    of("image-sheared"),
    of("image-sphere"),
    of("image-disk"),
    of("image-cylinder"),
    of("image-cube"),
    of("image-mask", depth=32),
    of("image-blend"),
    of("image-roughness"),
    of("image-lamp", variant="llvm_ad_rgb"),
    of("image-lamp", EQUAL_ENERGY),
    of("checkerboard"),
    of("checkerboard-turned"),
    of("checkerboard-widths"),
    of("checkerboard-principled"),
    of("image-lobes"),
    of("bump", sky=0.0001),
    *(of("bump", sky=0.3, shadow=shadow) for shadow in ("false", "true")),
    of("normal"),
    of("normal", shadow="true"),
    *(of("mesh", format=f) for f in ("obj", "ply", "serialized")),
    of("flat-mesh"),
    of("polygons"),
    of("bare-mesh"),
    *(of("mesh-colours", attribute=f"{of_what}_color") for of_what in ("vertex", "face")),
    of("instances"),
    *(of("polarisers", variant=POLARISED, theta=theta, integrator="volpath", depth=32) for theta in (30, 65)),
    *(
        of("polarisers-mesh", variant=POLARISED, mesh=mesh, theta=65, integrator="volpath", depth=32)
        for mesh in ("turned", "bare")
    ),
    of("retarder", TILTED, variant=POLARISED, delta=90, integrator="volpath", depth=32),
    of("point"),
    of("point-number"),
    of("spot", beam=16),
    of("spot", beam=8),
    *(of("spot-texture", beam=beam, variant="llvm_ad_rgb") for beam in (8, 25)),
    *(of("projector", axis=axis, variant="llvm_ad_rgb") for axis in ("x", "y", "diagonal")),
    of("directional"),
    of("envmap"),
    of("envmap-mirror"),
    of("coloured-light"),
    of("spectral-light"),
    of("sphere-lamp"),
    of("area-number"),
    of("stretched-lamp", shape="disk", scale="1 0.5 1"),
    of("stretched-lamp", samples=8, shape="cylinder", scale="0.1 0.1 1.5"),
    of("thin-lens"),
    *(of("fov", axis=axis) for axis in ("x", "y", "smaller", "larger", "diagonal")),
    of("focal-length"),
    of("orthographic"),
    of("mirrored"),
    of("film-crop", options=("--crop", "28,12,40,48")),
    *(of("filter", filter=f) for f in ("tent", "gaussian", "mitchell", "catmullrom", "lanczos")),
    of("nested-integrator"),
    *(of("hide-emitters", integrator=i, lamp=l) for i in ("path", "volpath") for l in ("rectangle", "cube")),
    of("fog", integrator="volpath", depth=32),
    of("hollow", integrator="volpath", depth=32),
    # Shadow rays do not reach into glass: under the sky alone there is little noise.
    of("milk", integrator="volpath", depth=32, lamp=0.01, sky=1),
    of("juice", samples=2, integrator="volpath", depth=32, lamp=0.01, sky=1),
    of("cloud", integrator="volpath", depth=32),
    of("filled-principled", samples=2, integrator="volpath", depth=32, lamp=0.01, sky=1),
    of("filled-mask", integrator="volpath", depth=32),
    of("filled-panes", integrator="volpath", depth=32, lamp=0.01, sky=1),
]
