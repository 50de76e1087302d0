#!/usr/bin/env python3
"""Renders scenes that pbrt and Mitsuba can both say: those of pbrt by etalon, those of Mitsuba by Mitsuba 3, and compares the pictures.

    python3 tests/peers/mitsuba/pbrt_twins.py [--etalon target/release/etalon] [--folder twins] [--spp 64] [NAME ...]

So what pbrt's files become is held to the pictures of another program. `compare.py` does the same with Mitsuba's own files. `etalon compare`
judges by the errors of both pictures. Where the programs are known to differ, the scene says why. Needs
`pip install mitsuba==3.9.1 OpenEXR numpy`.
"""
import argparse
import json
import pathlib
import subprocess

import numpy as np

from compare import PASSES, channels
from files import write_exr

SIZE = (48, 36)

# A ball over a floor under a lamp and a sky. `ball` and `floor` are materials of both programs, `sky` a light. The ground beneath fills the
# view: where a picture has no noise, it would be held to the last digits of a colour.
XML = """<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="12"/></integrator>
  <sensor type="perspective"><float name="fov" value="30"/><string name="fov_axis" value="y"/>
    <transform name="to_world"><lookat origin="0, 3, 6" target="0, 0.8, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/><rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="{spp}"/></sampler></sensor>
  {sky}
  <shape type="rectangle"><transform name="to_world"><scale value="0.7"/><rotate x="1" angle="90"/><translate y="4"/></transform>
    <bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf><emitter type="area"><rgb name="radiance" value="8"/></emitter></shape>
  <shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/></transform>{floor}</shape>
  <shape type="rectangle"><transform name="to_world"><scale value="60"/><rotate x="1" angle="-90"/><translate y="-0.01"/></transform>
    <bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf></shape>
  <shape type="sphere"><point name="center" x="0" y="1" z="0"/><float name="radius" value="1"/>{ball}</shape>
</scene>
"""
# The same. The axes of pbrt are left-handed unless a transform mirrors; its images begin at v = 1, those of Mitsuba at 0.
# Light is of equal channels: what is grey here is grey there.
PBRT = """Scale -1 1 1
LookAt 0 3 6  0 0.8 0  0 1 0
Film "rgb" "integer xresolution" {width} "integer yresolution" {height}
Camera "perspective" "float fov" 30
Sampler "independent" "integer pixelsamples" {spp}
Integrator "path" "integer maxdepth" 11
PixelFilter "box"
WorldBegin
{sky}
AttributeBegin
  Material "diffuse" "float reflectance" 0
  AreaLightSource "diffuse" "rgb L" [ 8 8 8 ]
  Shape "trianglemesh" "point3 P" [ -0.7 4 -0.7  0.7 4 -0.7  0.7 4 0.7  -0.7 4 0.7 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
AttributeBegin
  {floor}
  Shape "trianglemesh" "point3 P" [ -4 0 4  4 0 4  4 0 -4  -4 0 -4 ] "integer indices" [ 0 1 2 0 2 3 ] "point2 uv" [ 0 1 1 1 1 0 0 0 ]
AttributeEnd
AttributeBegin
  Material "diffuse" "float reflectance" 0.5
  Shape "trianglemesh" "point3 P" [ -60 -0.01 60  60 -0.01 60  60 -0.01 -60  -60 -0.01 -60 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
{ball}
Translate 0 1 0
Shape "sphere" "float radius" 1
"""

GREY = ('<bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf>', 'Material "diffuse" "float reflectance" 0.5')
EVEN = (
    '<emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>',
    'LightSource "infinite" "rgb L" [ 0.3 0.3 0.3 ]',
)


def rough_conductor(alpha):
    return (
        f'<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="{alpha}"/>'
        '<spectrum name="eta" value="0.2"/><spectrum name="k" value="3"/></bsdf>',
        f'Material "conductor" "spectrum eta" [ 300 0.2 900 0.2 ] "spectrum k" [ 300 3 900 3 ] "float roughness" {alpha} '
        '"bool remaproughness" false',
    )


def textured(alpha):
    return (
        '<bsdf type="roughconductor"><string name="distribution" value="ggx"/><spectrum name="eta" value="0.2"/>'
        '<spectrum name="k" value="3"/><texture type="bitmap" name="alpha"><string name="filename" value="alpha.exr"/>'
        '<boolean name="raw" value="true"/></texture></bsdf>',
        'Texture "a" "float" "imagemap" "string filename" "alpha.exr" "string encoding" "linear"\n'
        'Material "conductor" "spectrum eta" [ 300 0.2 900 0.2 ] "spectrum k" [ 300 3 900 3 ] "texture roughness" "a" '
        '"bool remaproughness" false',
    )


def bumpy(scale):
    return (
        f'<bsdf type="bumpmap"><boolean name="use_shadowing_function" value="false"/><float name="scale" value="{scale}"/>'
        '<texture type="bitmap"><string name="filename" value="heights.exr"/><boolean name="raw" value="true"/></texture>'
        f"{GREY[0]}</bsdf>",
        'Texture "h" "float" "imagemap" "string filename" "heights.exr" "string encoding" "linear"\n'
        f'Texture "d" "float" "scale" "texture tex" "h" "float scale" {scale}\n{GREY[1]} "texture displacement" "d"',
    )


BENT = (
    '<bsdf type="normalmap"><boolean name="use_shadowing_function" value="false"/><texture type="bitmap" name="normalmap">'
    f'<string name="filename" value="normals.exr"/><boolean name="raw" value="true"/></texture>{GREY[0]}</bsdf>',
    f'{GREY[1]} "string normalmap" "normals.exr"',
)
# Eight by eight fields; v of the floor is turned over in pbrt.
CHEQUERS = (
    '<bsdf type="diffuse"><texture type="checkerboard" name="reflectance"><float name="color0" value="0.8"/>'
    '<float name="color1" value="0.2"/><transform name="to_uv"><scale value="4"/></transform></texture></bsdf>',
    'Texture "c" "spectrum" "checkerboard" "float uscale" 8 "float vscale" 8 "rgb tex1" [ 0.2 0.2 0.2 ] "rgb tex2" [ 0.8 0.8 0.8 ]\n'
    'Material "diffuse" "texture reflectance" "c"',
)
BLACK = (
    '<bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf>',
    'Material "diffuse" "float reflectance" 0',
)
# Light that a bent normal loses there comes from below its horizon: here none does, from the lamp alone.
DARK = ("", "")

MASKED = "facets of pbrt are masked by their heights, those of Mitsuba by G1·G1"

# Ball, floor, sky, each by Mitsuba and by pbrt, and why the pictures may differ.
SCENES = {
    "diffuse": (GREY, GREY, EVEN, None),
    "rough-metal": (rough_conductor(0.1), GREY, EVEN, MASKED),
    "chequers": (GREY, CHEQUERS, EVEN, None),
    "rough-glass": (
        (
            '<bsdf type="roughdielectric"><string name="distribution" value="ggx"/><float name="alpha" value="0.1"/>'
            '<float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>',
            'Material "dielectric" "float eta" 1.5 "float roughness" 0.1 "bool remaproughness" false',
        ),
        GREY,
        EVEN,
        MASKED,
    ),
    "smooth-plastic": (
        (
            '<bsdf type="plastic"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>'
            '<float name="diffuse_reflectance" value="0.5"/><boolean name="nonlinear" value="true"/></bsdf>',
            'Material "coateddiffuse" "float reflectance" 0.5 "float eta" 1.5 "float roughness" 0',
        ),
        GREY,
        EVEN,
        None,
    ),
    "textured-metal": (GREY, textured(0.3), EVEN, MASKED),
    "bumps": (BLACK, bumpy(0.3), DARK, None),
    "normals": (BLACK, BENT, DARK, None),
}


def images(folder):
    alpha = np.random.default_rng(7).uniform(0.05, 0.5, (8, 8))
    write_exr(folder / "alpha.exr", {c: alpha for c in "RGB"})
    # Hills that no mirror image is like, so fine that their slope hardly changes within a texel, and tilts of up to 8°.
    u, v = np.meshgrid((np.arange(256) + 0.5) / 256, (np.arange(256) + 0.5) / 256)
    turns = 2 * np.pi
    hills = 0.5 + 0.2 * np.sin(2 * turns * u + np.sin(turns * v)) + 0.1 * np.cos(3 * turns * v + 0.5 * np.sin(turns * u))
    write_exr(folder / "heights.exr", {c: hills for c in "RGB"})
    x, y = 0.1 * np.sin(turns * u + 2), 0.1 * np.cos(turns * (v + 0.1 * u)) * u
    vectors = dict(zip("RGB", (x, y, np.sqrt(1 - x * x - y * y))))
    write_exr(folder / "normals.exr", {c: 0.5 + 0.5 * part for c, part in vectors.items()})


def by_mitsuba(mi, scene, path, spp):
    scene = mi.load_file(str(scene))
    pictures = [np.array(mi.render(scene, spp=spp, seed=seed), np.float64)[..., 0] for seed in range(PASSES)]
    mean, error = np.mean(pictures, 0), np.std(pictures, 0, ddof=1) / np.sqrt(PASSES)
    write_exr(path, {c: mean for c in "RGB"} | {f"Error.{c}": error for c in "RGB"})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--etalon", default="target/release/etalon")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("twins"))
    parser.add_argument("--spp", type=int, default=64)
    args = parser.parse_args()

    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    args.folder.mkdir(parents=True, exist_ok=True)
    images(args.folder)
    wrong = []
    for name, (ball, floor, sky, why) in SCENES.items():
        if args.names and name not in args.names:
            continue
        xml, pbrt = args.folder / f"{name}.xml", args.folder / f"{name}.pbrt"
        numbers = {"width": SIZE[0], "height": SIZE[1], "spp": args.spp * PASSES}
        xml.write_text(XML.format(ball=ball[0], floor=floor[0], sky=sky[0], **numbers))
        pbrt.write_text(PBRT.format(ball=ball[1], floor=floor[1], sky=sky[1], **numbers))
        reference, ours = args.folder / f"{name}-mitsuba.exr", args.folder / f"{name}-pbrt.exr"
        by_mitsuba(mi, xml, reference, args.spp)
        subprocess.run([args.etalon, "render", pbrt, "-o", ours, "--quiet"], check=True, capture_output=True)
        told = subprocess.run([args.etalon, "compare", ours, reference, "--json"], capture_output=True, text=True)
        means = [float(channels(picture)[0]["G"].mean()) for picture in (ours, reference)]
        same = told.returncode == 0
        verdict = "the same within noise" if same else f"differ: {why or 'AND NOTHING EXPLAINS IT'}"
        print(f"{name}: mean {means[0] / means[1]:.4f} of Mitsuba's; {verdict}", flush=True)
        if not same and why is None:
            wrong.append(name)
            print(json.dumps(json.loads(told.stdout), indent=1)[:1500] if told.stdout else told.stderr[:1500])
    if wrong:
        raise SystemExit(f"differ without a reason: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
