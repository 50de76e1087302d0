"""Reflection by the formulas of glTF and of its extensions, and by those of physics that Etalon's documentation names; by quadrature.

Directions are arrays (…, 3) of unit vectors in a frame whose z axis is the surface's normal. Every function of `o`, to the eye, and `i`, to
the lamp, returns f(o, i) without the cosine.
"""

import math
from functools import cache

import numpy as np

PI = np.pi


def dot(a, b):
    return (a * b).sum(-1)


def half(o, i):
    h = o + i
    return h / np.linalg.norm(h, axis=-1, keepdims=True)


# --- Facets ---


def stretched(w, u, v):
    """√(α_u² x² + α_v² y² + z²): what the widths of facets make of a direction's length."""
    return np.sqrt((u * w[..., 0]) ** 2 + (v * w[..., 1]) ** 2 + w[..., 2] ** 2)


def facets(o, i, u, v=None):
    """D G/(4 cos cos): GGX facets of one or two widths, masked by Smith's function with correlated heights (glTF, Appendix B.3.2)."""
    v = u if v is None else v
    h = half(o, i)
    density = 1 / (PI * u * v * ((h[..., 0] / u) ** 2 + (h[..., 1] / v) ** 2 + h[..., 2] ** 2) ** 2)
    return density * 0.5 / (o[..., 2] * stretched(i, u, v) + i[..., 2] * stretched(o, u, v))


def gaussian_facets(o, i, alpha):
    """The same of Beckmann's facets (Walter et al. 2007), masked by Smith's function with correlated heights."""
    z = half(o, i)[..., 2]
    density = np.exp(-(1 / z**2 - 1) / alpha**2) / (PI * alpha**2 * z**4)
    return density / (4 * o[..., 2] * i[..., 2] * (1 + beckmann_hidden(o, alpha) + beckmann_hidden(i, alpha)))


def beckmann_hidden(w, alpha):
    """Smith's Λ of Beckmann's facets: (erf a − 1)/2 + exp(−a²)/(2a√π) with a = 1/(α tan θ)."""
    z = w[..., 2]
    a = z / (alpha * np.sqrt(np.maximum(1 - z * z, 1e-24)))
    return 0.5 * (erf(a) - 1) + np.exp(-a * a) / (2 * a * np.sqrt(PI))


erf = np.vectorize(math.erf, otypes=[float])


# --- Fresnel ---


def schlick(cos, f0, f90=1.0):
    return f0 + (f90 - f0) * (1 - np.abs(cos)) ** 5


def head_on(index):
    return ((index - 1) / (index + 1)) ** 2


def fresnel(cos, index):
    """What an interface to a real or complex index reflects, in the mean over both polarisations (Fresnel's equations)."""
    cos = np.asarray(cos, float)
    n2 = np.asarray(index, complex) ** 2
    inside = np.sqrt(n2 - (1 - cos**2))
    s = (cos - inside) / (cos + inside)
    p = (n2 * cos - inside) / (n2 * cos + inside)
    return 0.5 * (np.abs(s) ** 2 + np.abs(p) ** 2)


def metal_index(reflectance):
    """1 + ik of a metal that reflects this head-on: k = 2√(R/(1 − R))."""
    return 1 + 2j * np.sqrt(reflectance / (1 - reflectance))


# --- The material of glTF (Appendix B) ---


def lambert(o, i, base):
    return base / PI + 0 * o[..., 2] * i[..., 2]


def dielectric(o, i, base, alpha, index=1.5, specular=1.0, colour=1.0):
    """fresnel_mix; `specular` and `colour` are those of KHR_materials_specular, of greys."""
    fr = specular * schlick(dot(o, half(o, i)), min(head_on(index) * colour, 1))
    return (1 - fr) * lambert(o, i, base) + fr * facets(o, i, alpha)


def metal(o, i, base, u, v=None):
    return schlick(dot(o, half(o, i)), base) * facets(o, i, u, v)


def coated(o, i, below, factor, alpha):
    """KHR_materials_clearcoat: fresnel_coat, by the cosine to the eye."""
    share = factor * schlick(o[..., 2], 0.04)
    return (1 - share) * below + share * facets(o, i, alpha)


def fibres(o, i, alpha):
    """The lobe of white fibres of KHR_materials_sheen (Conty and Kulla 2017)."""
    sin2 = np.maximum(1 - half(o, i)[..., 2] ** 2, 0)
    density = (2 + 1 / alpha) * sin2 ** (0.5 / alpha) / (2 * PI)
    hidden = 1 + hidden_by_fibres(o[..., 2], alpha) + hidden_by_fibres(i[..., 2], alpha)
    return density / (hidden * 4 * o[..., 2] * i[..., 2])


def hidden_by_fibres(x, alpha):
    share = (1 - alpha) ** 2
    rough, fine = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054], [25.3245, 3.32435, 0.16801, -1.27393, -4.85967]
    a, b, c, d, e = (r + share * (f - r) for r, f in zip(rough, fine))

    def power(x):
        return a / (1 + b * x**c) + d * x + e

    return np.where(x < 0.5, np.exp(power(np.minimum(x, 0.5))), np.exp(2 * power(0.5) - power(1 - np.maximum(x, 0.5))))


def with_sheen(o, i, below, colour, roughness):
    """Albedo scaling: below the fibres is left what they do not reflect, for the direction in which they reflect more."""
    alpha = roughness**2
    taken = np.maximum(fibre_albedo(alpha)(o[..., 2]), fibre_albedo(alpha)(i[..., 2]))
    return colour * fibres(o, i, alpha) + (1 - colour * taken) * below


# --- Integrals over directions ---


def albedo(f, cos, polar=256, azimuths=128):
    """∫ f cos dω for directions to the eye of these cosines, by the midpoint rule in sin²θ and φ; of lobes without narrow peaks."""
    o = tilted(np.atleast_1d(cos))[:, None, None, :]
    z2 = (np.arange(polar) + 0.5) / polar
    i = around(np.sqrt(z2), azimuths)[None]
    return PI * f(o, i).mean((1, 2))


def tilted(cos):
    cos = np.asarray(cos, float)
    return np.stack([np.sqrt(1 - cos**2), 0 * cos, cos], -1)


def around(cos, azimuths):
    phi = 2 * PI * (np.arange(azimuths) + 0.5) / azimuths
    sin = np.sqrt(1 - cos**2)[:, None]
    return np.stack([sin * np.cos(phi), sin * np.sin(phi), cos[:, None] + 0 * phi], -1)


def tabulated(function):
    """A function of the cosine, interpolated between values at equal steps."""
    grid = np.linspace(0.005, 1, 200)
    values = np.array([function(cos) for cos in grid])
    return lambda cos: np.interp(cos, grid, values)


@cache
def fibre_albedo(alpha):
    return tabulated(lambda cos: albedo(lambda o, i: fibres(o, i, alpha), cos)[0])


@cache
def facet_albedo(alpha, reflected, gaussian=False):
    """E of a cosine: what facets reflect, by a function of the cosine to them. Facets are drawn with the density D cos θ_h."""

    def one(cos):
        o = tilted(cos)
        u = (np.arange(256) + 0.5) / 256
        tan2 = -(alpha**2) * np.log(1 - u) if gaussian else alpha**2 * u / (1 - u)
        h = around(1 / np.sqrt(1 + tan2), 128)
        of_facet = dot(h, o)
        i = 2 * of_facet[..., None] * h - o
        seen = (of_facet > 0) & (i[..., 2] > 0)
        i = np.where(seen[..., None], i, [0, 0, 1])
        if gaussian:
            masked = 1 / (1 + beckmann_hidden(o, alpha) + beckmann_hidden(i, alpha))
        else:
            masked = 2 * cos * i[..., 2] / (cos * stretched(i, alpha, alpha) + i[..., 2] * stretched(o, alpha, alpha))
        # E = ∫ F D G (o·h)/cos θ_o dω_h.
        weight = reflected(np.clip(of_facet, 0, 1)) * masked * of_facet / (cos * h[..., 2])
        return np.where(seen, weight, 0).mean()

    return tabulated(one)


def mean_over_cosines(function):
    """2∫ function(µ) µ dµ."""
    z = np.sqrt((np.arange(512) + 0.5) / 512)
    return function(z).mean()


# --- What Etalon's documentation says of the materials that stand for those of glTF ---


@cache
def real(index):
    return lambda cos: fresnel(cos, index)


def everything(cos):
    return np.ones_like(cos)


def plastic(o, i, base, alpha, index=1.5, gaussian=False):
    """`plastic`, uncoloured: f = f_coat + T(o) T(i) ρ/(π T_avg), with T = 1 − R of the coat, and Fresnel's equations."""
    reflected = facet_albedo(alpha, real(index), gaussian)
    lobe = (gaussian_facets if gaussian else facets)(o, i, alpha) * fresnel(dot(o, half(o, i)), index)

    def passed(cos):
        return 1 - reflected(cos)

    return lobe + passed(o[..., 2]) * passed(i[..., 2]) * base / (PI * mean_over_cosines(passed))


def conductor(o, i, base, alpha, gaussian=False):
    """`conductor` of a reflectance: Fresnel's equations for 1 + ik, and Kulla and Conty's lobe of light that meets several facets."""
    index = metal_index(base)
    whole = facet_albedo(alpha, everything, gaussian)
    several = several_facets(lambda cos: fresnel(cos, index), mean_over_cosines(whole))
    single = fresnel(dot(o, half(o, i)), index) * (gaussian_facets if gaussian else facets)(o, i, alpha)
    return single + several * (1 - whole(o[..., 2])) * (1 - whole(i[..., 2]))


def several_facets(reflected, mean):
    """The factor of (1 − E(o))(1 − E(i)) of facets whose mean albedo is E_avg: F_avg² E_avg/(π (1 − E_avg)(1 − F_avg(1 − E_avg)))."""
    of_metal = mean_over_cosines(reflected)
    return of_metal**2 * mean / (PI * (1 - mean) * (1 - of_metal * (1 - mean)))


def brushed(o, i, base, u, v):
    """The same with facets of two widths, whose albedo depends on the azimuth."""
    index = metal_index(base)
    whole, mean = brushed_albedo(u, v)
    several = several_facets(lambda cos: fresnel(cos, index), mean)
    return fresnel(dot(o, half(o, i)), index) * facets(o, i, u, v) + several * (1 - whole(o)) * (1 - whole(i))


@cache
def brushed_albedo(u, v, steps=48):
    """E of a direction, and its mean."""
    cosines, azimuths = (np.arange(steps) + 0.5) / steps, 0.5 * PI * np.arange(steps // 2 + 1) / (steps // 2)
    table = np.empty((len(cosines), len(azimuths)))
    share = (np.arange(128) + 0.5) / 128
    radius, phi = np.sqrt(share / (1 - share))[:, None], 2 * PI * (np.arange(128) + 0.5) / 128
    h = np.stack([u * radius * np.cos(phi), v * radius * np.sin(phi), 1 + 0 * radius * phi], -1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    for row, cos in enumerate(cosines):
        for column, azimuth in enumerate(azimuths):
            sin = np.sqrt(1 - cos**2)
            o = np.array([sin * np.cos(azimuth), sin * np.sin(azimuth), cos])
            of_facet = dot(h, o)
            i = 2 * of_facet[..., None] * h - o
            seen = (of_facet > 0) & (i[..., 2] > 0)
            masked = 2 * cos * i[..., 2] / (cos * stretched(i, u, v) + i[..., 2] * stretched(o, u, v))
            table[row, column] = np.where(seen, masked * of_facet / (cos * h[..., 2]), 0).mean()
    weights = np.full(len(azimuths), 1.0)
    weights[[0, -1]] = 0.5
    mean = (2 * cosines / steps) @ (table @ weights / weights.sum())

    def whole(w):
        x = np.clip(w[..., 2] * steps - 0.5, 0, steps - 1.001)
        y = np.arctan2(np.abs(w[..., 1]), np.abs(w[..., 0])) / (0.5 * PI) * (len(azimuths) - 1)
        y = np.clip(y, 0, len(azimuths) - 1.001)
        (a, b), (s, t) = (x.astype(int), y.astype(int)), (x % 1, y % 1)
        along = [(1 - t) * table[k, b] + t * table[k, b + 1] for k in (a, a + 1)]
        return (1 - s) * along[0] + s * along[1]

    return whole, mean


def flat_lobe(o, i, white=1.0):
    """The `principled` surface of index 1, `alpha` 1 and `flatness` 1."""
    cos = dot(o, half(o, i))
    fade_o, fade_i = (1 - o[..., 2]) ** 5, (1 - i[..., 2]) ** 5
    s = (1 + (cos**2 - 1) * fade_o) * (1 + (cos**2 - 1) * fade_i)
    return 1.25 * white / PI * (s * (1 / (o[..., 2] + i[..., 2]) - 0.5) + 0.5)
