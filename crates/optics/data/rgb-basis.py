#!/usr/bin/env python3
"""Makes rgb-basis-5nm.csv; needs numpy and cvxopt.

Three spectra, linear between rows of 5 nm, that minimise the sum of squared differences between rows, under these
constraints: none is negative; they add up to 1 in each row; under D65, relative to the perfect reflector, they show the
three primaries of Rec. 709 to the CIE 1931 observer (sums over 1 nm). A quadratic program; its solution is polished by
solving the equations of its active constraints.
"""
import pathlib

import numpy as np
from cvxopt import matrix, solvers

HERE = pathlib.Path(__file__).parent


def table(name):
    rows = (line for line in (HERE / name).read_text().splitlines() if line[0] not in "#")
    return np.array([[float(v) for v in row.split(",")] for row in rows])


observer, d65 = table("cie-1931-2deg-1nm.csv"), table("cie-d65-5nm.csv")
light = observer[:, 1:] * np.interp(observer[:, 0], d65[:, 0], d65[:, 1])[:, None]
white = light.sum(0) / light[:, 1].sum()
chromaticities = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])
primaries = np.array([[x / y, 1, (1 - x - y) / y] for x, y in chromaticities]).T
to_xyz = primaries * np.linalg.solve(primaries, white)
to_rgb = np.linalg.inv(to_xyz) @ light.T / light[:, 1].sum()

rows = np.arange(360, 831, 5.0)
n = len(rows)
linear = np.array([np.interp(observer[:, 0], rows, unit) for unit in np.eye(n)]).T
seen = to_rgb @ linear
difference = np.diff(np.eye(n), axis=0)
goal = np.kron(np.eye(3), difference.T @ difference + 1e-9 * np.eye(n))
left = np.vstack([np.kron(np.eye(3), seen), np.kron(np.ones((1, 3)), np.eye(n))])
right = np.concatenate([np.eye(3).ravel(), np.ones(n)])
# The rows' sums show white: what blue shows follows from red and green.
keep = [0, 1, 2, 3, 4, 5, *range(9, 9 + n)]
solvers.options.update(abstol=1e-13, reltol=1e-12, feastol=1e-12, show_progress=False)
zero = matrix(np.zeros(3 * n))
solution = solvers.qp(matrix(goal), zero, matrix(-np.eye(3 * n)), zero, matrix(left[keep]), matrix(right[keep]))
free = np.array(solution["x"])[:, 0] > 1e-6
equations = np.block([[goal[np.ix_(free, free)], left[:, free].T], [left[:, free], np.zeros((len(left),) * 2)]])
polished = np.zeros(3 * n)
polished[free] = np.linalg.lstsq(equations, np.concatenate([np.zeros(free.sum()), right]), rcond=1e-14)[0][: free.sum()]
polished = np.minimum(polished, 1.0)
assert abs(left @ polished - right).max() < 1e-13 and polished.min() >= 0
print("# Reflectances of the primaries of linear Rec. 709 under D65, 5 nm, 360-830 nm, linear between rows.")
print("# Computed by rgb-basis.py beside this file from the other tables here.")
print("# wavelength_nm,red,green,blue")
for nm, values in zip(rows, polished.reshape(3, n).T):
    print(f"{nm:.0f}," + ",".join(repr(float(v)) for v in values))
