"""Writes dielectric.csv and conductor.csv: Fresnel's textbook equations at 60 digits (mpmath 1.3 or later).

Every argument is a double (a single where the row says f32) taken as exact, so the only error in a row is the rounding of
its decimals, 1e-25 of a value.
"""

import math
import pathlib
import struct

from mpmath import mp, mpc, mpf, sqrt

mp.dps = 60
HERE = pathlib.Path(__file__).parent


def single(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def text(x):
    return mp.nstr(x, 25)


def dielectric(c, n):
    c, n = mpf(c), mpf(n)
    w = 1 - (1 - c * c) / (n * n)
    if w <= 0:
        return None
    t = sqrt(w)
    r_s = (c - n * t) / (c + n * t)
    r_p = (n * c - t) / (n * c + t)
    share = (r_s**2 + r_p**2) / 2
    return [r_s, r_p, share, 1 - share, t]


def conductor(c, n, k):
    c, index = mpf(c), mpc(n, k)
    t = sqrt(1 - (1 - c * c) / index**2)
    r_s = (c - index * t) / (c + index * t)
    r_p = (index * c - t) / (index * c + t)
    return [abs(r_s) ** 2, abs(r_p) ** 2]


def dielectric_arguments():
    # Hard case 20: grazing.
    for n in (1.1, 1.33, 1.5, 2.41749, 4.0, 20.0):
        for e in range(0, 8):
            yield "grazing", 10.0**-e, n
        for c in (0.9, 0.7, 0.55, 0.4, 0.25):
            yield "grazing", c, n
    # Hard case 21: nearly equal indices, both ways.
    for e in range(2, 8):
        for sign in (1, -1):
            for c in (1.0, 0.95, 0.8, 0.6, 0.5, 0.3, 0.1, 0.01, 1e-3):
                yield "near-one", c, 1 + sign * 10.0**-e
    # Hard case 22: just inside the critical angle (theta below it by 1e-2 ... 1e-7), and well inside.
    for n in (1 / 1.1, 1 / 1.33, 1 / 1.5, 1 / 2.41749, 0.9999):
        critical = math.asin(n)
        for e in range(1, 8):
            yield "critical", math.cos(critical - 10.0**-e), n
        for e in range(9, 16):
            yield "critical", math.cos(critical) * (1 + 10.0**-e), n
        for c in (1.0, 0.99, 0.97):
            yield "critical", c, n


def conductor_arguments():
    for n, k in ((0.05, 3.9), (0.13, 4.1), (0.3, 3.2), (1.0728, 6.7839), (2.7, 8.4), (1.5, 1e-6), (1.0, 0.5), (3.0, 0.02)):
        for c in (1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 1e-2, 1e-3, 1e-5, 1e-7):
            yield c, n, k


with open(HERE / "dielectric.csv", "w") as out:
    out.write("# written by fresnel.py\n# case,type,cos_i,eta,r_s,r_p,reflectance,transmittance,cos_t\n")
    for kind, rounding in (("f32", single), ("f64", float)):
        for case, c, n in dielectric_arguments():
            c, n = rounding(c), rounding(n)
            row = dielectric(c, n)
            if row:
                out.write(",".join([case, kind, repr(c), repr(n), *map(text, row)]) + "\n")

with open(HERE / "conductor.csv", "w") as out:
    out.write("# written by fresnel.py\n# cos_i,n,k,reflectance_s,reflectance_p (arguments are singles)\n")
    for c, n, k in conductor_arguments():
        c, n, k = single(c), single(n), single(k)
        out.write(",".join([repr(c), repr(n), repr(k), *map(text, conductor(c, n, k))]) + "\n")
