#!/usr/bin/env python3
"""Renders all scenes of a folder in Mitsuba's format by Mitsuba 3 and by etalon, and compares the pictures.

    pip install mitsuba==3.9.1 OpenEXR numpy
    python3 tests/peers/mitsuba/published.py FOLDER [--etalon target/release/etalon] [--out OUT] [WORD ...]

Each file .xml that no other includes is a scene; with words, only those whose path has one of them. Files that Mitsuba cannot render are left out, with its words; of those of
version 0.x it gets a copy without what it does not know (`older.py`). Pictures that are black in both programs are counted apart.
Pictures are small (`--width`). Mitsuba renders each scene in its spectral and in its RGB variant, or, where
something polarises, in its polarised one. Two pictures agree if for one of the variants

- the mean of each channel differs by at most 4 standard errors or by at most 0.5 %, and
- the mean of z² is below 1.6 over blocks of 4 × 4 pixels and below 2.2 over blocks of 8 × 8, or the difference beyond noise is at most 0.5 % of
  the mean, and
- the standard errors of the means are at most 2 %: of noisier pictures nothing can be said.

Mitsuba's spectral variants interpolate the brightness and the colour of a sky's texels apart. Where two pictures differ under the image of a sky, Mitsuba
renders once more with a sky that it need not interpolate: an image of 5 × 5 texels for each texel (3 × 3 of large ones), which are interpolated beforehand. Pictures
that agree then are counted apart.

OUT has the pictures and results.json. A scene that stands there is not rendered again.
"""

import argparse
import json
import pathlib
import re
import subprocess

import numpy as np

from compare import MOST_ERRORS, SMALL, channels
from older import load

HERE = pathlib.Path(__file__).resolve().parent
VARIANTS = ("llvm_ad_spectral", "llvm_ad_rgb")
POLARISED = "llvm_ad_spectral_polarized"
# Plugins that are nothing without polarisation.
POLARISE = re.compile(r"""type=["'](polarizer|retarder|circular|stokes|measured_polarized)["']""")
PASSES = 16
FINE_SKY = "with a fine sky"
# Skies of more columns get 3 × 3 texels for each, not 5 × 5: memory.
LARGE_SKY = 1024
INCLUDED = re.compile(r"""<include\s+filename=["'](?:[^"']*[/\\])?([^"'/\\]+)["']""")
OPEN = re.compile(r"\$(\w+)")
DEFAULTS = re.compile(r"""<default\s+name=["'](\w+)""")
# Mean z² over blocks of so many pixels, at most.
MOST_SQUARES = {4: 1.6, 8: 2.2}
# Standard errors of means, relative, above which no picture agrees.
NOISY = 0.02


def keys_of_skies(params):
    """Names of the parameters that are images of skies."""
    return [key for key in params.keys() if key.endswith("data") and f"{key[:-4]}to_world" in params and f"{key[:-4]}scale" in params]


def skies(mi, scene, given, out):
    """The texels of the skies of a scene: rows × columns × RGB."""
    mi.set_variant("llvm_ad_rgb")
    params = mi.traverse(load(mi, scene, given, out))
    # A column of the other edge stands at each side.
    return [np.array(params[key])[:, 1:-1, :3] for key in keys_of_skies(params)]


def finer(texels):
    """As Mitsuba's RGB variants interpolate: columns have their texels in the middle and close to a ring, rows begin and end with texels."""
    rows, columns = texels.shape[:2]
    # Odd, so that the texels of the file are among them.
    times = 5 if columns <= LARGE_SKY else 3

    def between(places, first, last):
        share = (places - np.floor(places))[:, None, None]
        return lambda values: (1 - share) * values[first] + share * values[last]

    places = (np.arange(columns * times) + 0.5) / times - 0.5
    left = np.floor(places).astype(int)
    wide = between(places, left % columns, (left + 1) % columns)(texels.swapaxes(0, 1)).swapaxes(0, 1)
    places = np.arange((rows - 1) * times + 1) / times
    upper = np.floor(places).astype(int)
    return between(places, upper, np.minimum(upper + 1, rows - 1))(wide)


def by_mitsuba(mi, scene, given, args, texels_of_skies=()):
    """Renders about as wide as this, with these texels for its skies: passes × rows × columns × channels."""
    loaded, width = load(mi, scene, given, args.out), args.width
    params = mi.traverse(loaded)
    # Names differ between variants where the file has none.
    for key, texels in zip(keys_of_skies(params), texels_of_skies):
        sky = mi.load_dict({"type": "envmap", "bitmap": mi.Bitmap(finer(texels).astype(np.float32))})
        params[key] = mi.traverse(sky)["data"]
    key = next(key for key in params.keys() if key.endswith("film.size"))
    full = [int(side) for side in np.array(params[key])]
    # Of the widths around, that which keeps the shape of a picture best.
    widths = range(width * 4 // 5, width * 6 // 5)
    size = min(([w, max(1, round(w * full[1] / full[0]))] for w in widths), key=lambda s: (abs(s[1] * full[0] - s[0] * full[1]) / s[0], abs(s[0] - width)))
    params[key] = size
    if (crop := key.replace("film.size", "film.crop_size")) in params:
        params[crop] = size
    params.update()
    passes = [np.array(mi.render(loaded, spp=max(args.spp // PASSES, 1), seed=seed), np.float64) for seed in range(PASSES)]
    return np.array([np.repeat(image[..., :1], 3, 2) if image.shape[2] < 3 else image[..., :3] for image in passes])


def blocks(values, side):
    """Means over blocks of side × side pixels, of the last two axes."""
    *rest, height, width = values.shape
    rows, columns = height // side, width // side
    return values[..., : rows * side, : columns * side].reshape(*rest, rows, side, columns, side).mean((-3, -1))


def differences(ours, passes, side):
    """Of blocks, how far our mean is from Mitsuba's, and the variance of that, for each channel. Mitsuba's filter makes the errors of neighbours
    alike, so its variance is that of blocks among passes; our pixels are independent.
    """
    for i, name in enumerate("RGB"):
        theirs = blocks(passes[..., i], side)
        variance = theirs.var(0, ddof=1) / PASSES + blocks(ours[f"Error.{name}"] ** 2, side) / side**2
        yield blocks(ours[name], side) - theirs.mean(0), variance


def judge(ours, passes):
    """What differs by how much, and whether the pictures agree."""
    means = []
    for i, name in enumerate("RGB"):
        of_passes = passes[..., i].mean((1, 2))
        error = np.hypot(of_passes.std(ddof=1) / np.sqrt(PASSES), np.sqrt((ours[f"Error.{name}"] ** 2).sum()) / ours[name].size)
        means.append((float(ours[name].mean() - of_passes.mean()), float(error), float(of_passes.mean())))
    close = all(abs(off) <= max(MOST_ERRORS * error, SMALL * abs(mean)) for off, error, mean in means)
    z2 = {}
    for side in MOST_SQUARES:
        found = [(off[known] ** 2 / variance[known]).mean() for off, variance in differences(ours, passes, side) if (known := variance > 0).any()]
        z2[side] = round(float(max(found, default=0)), 2)
    square = [(off**2 - variance).mean() for off, variance in differences(ours, passes, 4)]
    beyond = max(np.sqrt(max(square, 0)) / mean if mean else 0 for square, (_, _, mean) in zip(square, means))
    sharp = all(error <= NOISY * abs(mean) for _, error, mean in means)
    agree = close and sharp and (all(z2[side] < most for side, most in MOST_SQUARES.items()) or beyond <= SMALL)
    ratios = [round(1 + off / mean, 4) if mean else None for off, _, mean in means]
    errors = [round(error / abs(mean), 4) if mean else None for _, error, mean in means]
    black = not any(mean or off for off, _, mean in means)
    return {"agree": bool(agree and not black), "black": black, "means": ratios, "errors": errors, "beyond": round(float(beyond), 4), "z2": z2}


def compared(mi, scene, stem, args):
    """What came of one scene; without "etalon" if Mitsuba cannot render it."""
    result = {}
    ours = args.out / f"{stem}.exr"
    text = scene.read_text(errors="replace")
    is_polarised = POLARISE.search(text)
    # Numbers that a scene leaves open are numbers of samples.
    given = {name: "64" for name in set(OPEN.findall(text)) - set(DEFAULTS.findall(text))}
    for variant in (POLARISED,) if is_polarised else VARIANTS:
        mi.set_variant(variant)
        try:
            passes = by_mitsuba(mi, scene, given, args)
        except Exception as error:  # whatever Mitsuba throws
            result[variant] = (str(error).strip().splitlines() or [type(error).__name__])[-1][:200]
            continue
        np.save(args.out / f"{stem}-{variant}.npy", passes.astype(np.float32))
        if "etalon" not in result:
            size = f"{passes.shape[2]}x{passes.shape[1]}"
            command = [args.etalon, "render", scene, "-o", ours, "--spp", str(args.spp), "--size", size, "--aov", "color,error"]
            command += ["--polarised"] if is_polarised else []
            command += [part for name, value in given.items() for part in ("-D", f"{name}={value}")]
            told = subprocess.run(command, capture_output=True, text=True, timeout=1800)
            lines = [line.strip() for line in told.stderr.splitlines()]
            result["etalon"] = [line for line in lines if "⚠" in line]
            if told.returncode != 0:
                result["refused"] = lines[-12:]
                break
        result[variant] = judge(channels(ours)[0], passes)
    judged = "etalon" in result and "refused" not in result
    variant = POLARISED if is_polarised else VARIANTS[0]
    # The texels are taken from the RGB variant.
    rendered = not any(isinstance(result.get(name), str) for name in (variant, VARIANTS[1]))
    if judged and rendered and not agrees(result) and (texels := skies(mi, scene, given, args.out)):
        mi.set_variant(variant)
        result[FINE_SKY] = judge(channels(ours)[0], by_mitsuba(mi, scene, given, args, texels))
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("words", nargs="*")
    parser.add_argument("--etalon", type=pathlib.Path, default=HERE.parents[2] / "target/release/etalon")
    parser.add_argument("--out", type=pathlib.Path, default=HERE.parents[2] / "out/published")
    parser.add_argument("--width", type=int, default=96)
    parser.add_argument("--spp", type=int, default=256)
    args = parser.parse_args()

    import mitsuba as mi

    args.out.mkdir(parents=True, exist_ok=True)
    kept = args.out / "results.json"
    results = json.loads(kept.read_text()) if kept.exists() else {}
    files = sorted(args.folder.rglob("*.xml"))
    included = {name for file in files for name in INCLUDED.findall(file.read_text(errors="replace"))}
    for scene in files:
        name = str(scene.relative_to(args.folder))
        if scene.name in included or (args.words and not any(word in name for word in args.words)):
            continue
        if name not in results:
            results[name] = compared(mi, scene, name.replace("/", "-").removesuffix(".xml"), args)
            kept.write_text(json.dumps(results, indent=1))
        result = results[name]
        if "etalon" not in result:
            print(f"{name}: not rendered by Mitsuba: {' '.join(set(result.values()))}", flush=True)
        elif "refused" in result:
            print(f"{name}: REFUSED {' '.join(result['refused'])[:300]}", flush=True)
        else:
            found = {variant: of for variant, of in result.items() if variant != "etalon"}
            print(f"{name}: {told(result)} {found} {result['etalon']}", flush=True)
    rendered = [result for result in results.values() if "etalon" in result]
    loaded = [result for result in rendered if not is_black(result)]
    agree, fine = sum(map(agrees, loaded)), sum(FINE_SKY in result and result[FINE_SKY]["agree"] for result in loaded)
    share = 100 / max(len(loaded), 1)
    print(f"{len(rendered) - len(loaded)} are black in both; {len(loaded)} scenes, {sum('refused' not in r for r in loaded)} load, {agree} agree ({share * agree:.0f} %); with a fine sky {agree + fine} ({share * (agree + fine):.0f} %)")


def told(result):
    if is_black(result):
        return "black in both"
    if agrees(result):
        return "agree"
    return f"agree {FINE_SKY}" if FINE_SKY in result and result[FINE_SKY]["agree"] else "DIFFER"


def is_black(result):
    return any(isinstance(of, dict) and of["black"] for of in result.values())


def agrees(result):
    """As the scene is."""
    return any(isinstance(of, dict) and of["agree"] for name, of in result.items() if name != FINE_SKY)


if __name__ == "__main__":
    main()
