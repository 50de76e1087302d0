"""Thin films: the approximation of KHR_materials_iridescence, and Airy's formula integrated over wavelengths.

The colours are those of the CIE 1931 observer under D65, in linear sRGB. Both tables are data of the CIE.
"""

import pathlib
from functools import cache

import numpy as np

import formulas as f

DATA = pathlib.Path(__file__).resolve().parents[3] / "crates/optics/data"
TO_RGB = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]])


@cache
def observer():
    """Wavelengths, nm, and what light of D65's spectrum there adds to red, green and blue; the sums are 1."""
    table = np.loadtxt(DATA / "cie-1931-2deg-1nm.csv", delimiter=",", comments="#")
    daylight = np.loadtxt(DATA / "cie-d65-5nm.csv", delimiter=",", comments="#")
    nm = table[:, 0]
    rgb = table[:, 1:4] * np.interp(nm, daylight[:, 0], daylight[:, 1])[:, None] @ TO_RGB.T
    return nm[::2], rgb[::2] / rgb[::2].sum(0)


def airy(cos, nm, thickness_nm, film, base):
    """What a film on a base reflects: the mean over both polarisations, for a complex index of the base."""
    n = [1.0, film, base]
    c = [np.sqrt(1 - (1 - cos**2) / np.asarray(index, complex) ** 2) for index in n]
    delay = np.exp(4j * np.pi * film * thickness_nm * c[1] / nm)
    total = 0
    for weight in [lambda k: n[k] * c[k], lambda k: n[k] / c[k]]:
        first, second = ((weight(k) - weight(k + 1)) / (weight(k) + weight(k + 1)) for k in (0, 1))
        total = total + 0.5 * np.abs((first + second * delay) / (1 + first * second * delay)) ** 2
    return total


def approximated(cos, thickness_nm, film, f0):
    """iridescent_fresnel of the extension, as red, green and blue."""
    base = (1 + np.sqrt(f0 + 1e-4)) / (1 - np.sqrt(f0 + 1e-4))
    inside = np.sqrt(1 - (1 - cos**2) / film**2)
    r12, r23 = f.schlick(cos, f.head_on(film)), f.schlick(inside, ((base - film) / (base + film)) ** 2)
    way = 2 * film * thickness_nm * inside
    shift = np.pi + (np.pi if base < film else 0)
    both = np.clip(r12 * r23, 1e-5, 0.9999)
    rest = (1 - r12) ** 2 * r23 / (1 - both)
    total, amplitude = (r12 + rest)[..., None] * np.ones(3), rest - (1 - r12)
    for order in [1, 2]:
        amplitude = amplitude * np.sqrt(both)
        total = total + 2 * amplitude[..., None] * sensitivity(order * way, order * shift)
    return np.maximum(total, 0)


def sensitivity(way_nm, shift):
    phase = 2e-9 * np.pi * way_nm
    peaks = [(0, 5.4856e-13, 1.6810e6, 4.3278e9), (1, 4.4201e-13, 1.7953e6, 9.3046e9), (2, 5.2481e-13, 2.2084e6, 6.6121e9)]
    xyz = np.zeros((*np.shape(way_nm), 3))
    for channel, value, place, width in [*peaks, (0, 9.7470e-14, 2.2399e6, 4.5282e9)]:
        xyz[..., channel] += value * np.sqrt(2 * np.pi * width) * np.cos(place * phase + shift) * np.exp(-(phase**2) * width)
    return xyz / 1.0685e-7 @ TO_RGB.T


def by_cosine(function):
    """A function of the cosine with three channels, interpolated."""
    grid = np.linspace(0.02, 1, 128)
    values = function(grid)
    return lambda cos: np.stack([np.interp(cos, grid, values[:, c]) for c in range(3)], -1)


def films(case):
    base, alpha = 0.6, 0.16
    for thickness, film in [(100, 1.3), (350, 1.6)]:
        nm, rgb = observer()
        # The real index that glTF derives from what the base reflects head-on.
        index = (1 + np.sqrt(base)) / (1 - np.sqrt(base))
        spectra = airy(np.linspace(0.02, 1, 128)[:, None], nm, thickness, film, index)
        exact = by_cosine(lambda _: spectra @ rgb)
        sample = by_cosine(lambda cos: approximated(cos, thickness, film, base))
        whole = f.facet_albedo(alpha, f.everything)
        grid, mean = np.linspace(0.02, 1, 128), f.mean_over_cosines(whole)
        several = [f.several_facets(lambda cos: np.interp(cos, grid, spectra[:, k]), mean) for k in range(len(nm))] @ rgb

        def own(o, i):
            again = (1 - whole(o[..., 2])) * (1 - whole(i[..., 2]))
            return exact(f.dot(o, f.half(o, i))) * f.facets(o, i, alpha)[..., None] + again[..., None] * several

        yield from case(
            f"iridescence on metal, {thickness} nm of {film}",
            lambda o, i: sample(f.dot(o, f.half(o, i))) * f.facets(o, i, alpha)[..., None],
            own,
            "film metal",
            base=base,
            metallic=1.0,
            roughness=0.4,
            extensions={
                "KHR_materials_iridescence": {
                    "iridescenceFactor": 1,
                    "iridescenceIor": film,
                    "iridescenceThicknessMaximum": thickness,
                }
            },
        )
