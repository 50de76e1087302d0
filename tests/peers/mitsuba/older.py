"""Loads files of version 0.x in Mitsuba 3, which reads some of what they say and refuses the rest."""

import re
import xml.etree.ElementTree as ET

INCLUDED = re.compile(r"""<include\s+filename=["']([^"']+)["']""")
INTEGRATORS = ("path", "volpath", "volpathmis", "direct", "aov", "stokes", "moment", "depth")
SAMPLERS = ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")
FILMS = ("hdrfilm", "specfilm")
FILTERS = ("nearest", "bilinear")


def load(mi, scene, given, folder):
    """The scene as it is; if Mitsuba refuses it, a copy in a folder without what it does not know and light transport does not need."""
    # What it does not read, it does not always refuse.
    is_old = re.search(r"<scene\s+version=[\"']0\.", scene.read_text(errors="replace"))
    try:
        if not is_old:
            return mi.load_file(str(scene), **given)
        refusal = None
    except Exception as error:  # whatever Mitsuba throws
        refusal = error
    config = mi.parser.ParserConfig(mi.variant())
    config.unused_properties = config.unused_parameters = mi.LogLevel.Debug
    copy = folder / f"{scene.stem}-for-mitsuba.xml"
    resolver = mi.file_resolver()
    # Files beside the scene, and beside no other.
    resolver.prepend(str(scene.parent))
    for file in (copy,) if is_old else (scene, copy):
        try:
            if file is copy:
                copy.write_text(edited(scene.read_text(errors="replace"), holds_media(scene)))
            state = mi.parser.parse_file(config, str(file), **given)
            mi.parser.transform_all(config, state)
            loaded = mi.parser.instantiate(config, state)
            del resolver[0]
            return loaded[0] if isinstance(loaded, (list, tuple)) else loaded
        except Exception as error:
            refusal = error
    del resolver[0]
    raise refusal


def holds_media(file, depth=8):
    """Whether a file or one that it includes has a medium."""
    text = file.read_text(errors="replace") if depth and file.exists() else ""
    return "<medium" in text or any(holds_media(file.parent / name, depth - 1) for name in INCLUDED.findall(text))


def edited(text, with_media):
    """The same picture, in words that Mitsuba 3 knows."""
    root = ET.fromstring(text)
    for parent in list(root.iter()):
        for child in list(parent):
            kind, value = child.get("type"), (child.get("value") or "").strip()
            if child.tag == "lookAt":
                child.tag = "lookat"
            elif child.tag == "integrator" and kind not in INTEGRATORS:
                depth = next((of.get("value") for of in child if of.get("name") in ("maxDepth", "max_depth")), "-1")
                child.clear()
                # "path" goes through media as if they were not there.
                child.set("type", "volpath" if with_media else "path")
                ET.SubElement(child, "integer", name="max_depth", value=depth)
            elif child.tag == "sampler" and kind not in SAMPLERS:
                child.set("type", "independent")
            elif child.tag == "film" and kind not in FILMS:
                child.set("type", "hdrfilm")
            elif child.tag == "spectrum" and ":" not in value and re.search(r"[\s,]", value):
                child.tag = "rgb"
            elif child.tag == "srgb":
                child.tag = "rgb"
                child.set("value", " ".join(str(linear(float(part))) for part in value.replace(",", " ").split()))
            elif child.tag == "medium":
                extinction(child)
            elif child.get("name") in ("filterType", "filter_type") and value not in FILTERS or parent.tag == "film" and "ormat" in (child.get("name") or ""):
                parent.remove(child)
    return ET.tostring(root, encoding="unicode")


def extinction(medium):
    """Absorption and scattering as an extinction and an albedo; a density as an extinction."""
    stated = {of.get("name"): of for of in medium}
    if "density" in stated:
        stated["density"].set("name", "sigma_t")
    if not {"sigmaA", "sigmaS"} & set(stated):
        return
    values = [[float(part) for part in stated[name].get("value").replace(",", " ").split()] if name in stated else [0.0] for name in ("sigmaA", "sigmaS")]
    absorbed, scattered = (value * 3 if len(value) == 1 else value for value in values)
    for name in ("sigmaA", "sigmaS"):
        if name in stated:
            medium.remove(stated[name])
    sums = [a + s for a, s in zip(absorbed, scattered)]
    # A colour of more than 1 is refused there: the scale has the size.
    size = max(*sums, 1e-9)
    if "scale" not in stated:
        stated["scale"] = ET.SubElement(medium, "float", name="scale", value="1")
    stated["scale"].set("value", str(float(stated["scale"].get("value")) * size))
    ET.SubElement(medium, "rgb", name="sigma_t", value=" ".join(str(e / size) for e in sums))
    ET.SubElement(medium, "rgb", name="albedo", value=" ".join(str(s / e if e else 0.0) for s, e in zip(scattered, sums)))


def linear(signal):
    """The curve of sRGB undone."""
    return signal / 12.92 if signal <= 0.04045 else ((signal + 0.055) / 1.055) ** 2.4
