#!/usr/bin/env python3
"""Judges what a renderer read of these truths. It needs Python 3.9 or newer, and nothing else.

    python3 judge.py READINGS.json

READINGS.json is an object with a key for each truth that was rendered. Its value is either

- the means of at least two pictures with different seeds: `[0.4996, 0.5003, 0.5001]`, or
- one mean and its standard error: `{"mean": 0.5, "error": 2e-4}`. `degrees_of_freedom` says how many values stand behind the error, less one; without it the
  error counts as known. `nonfinite` is the number of pixels that were not finite.

A mean is over the pixels of `crop_px`, or over all where that is null. README.md says what a picture must show.

The exit status is 0 if all readings pass, 1 if one does not, 2 if READINGS.json is wrong.
"""

import json
import math
import pathlib
import statistics
import sys

# Probability that a right renderer fails any of the truths that are judged together.
SIGNIFICANCE = 1e-6
# Probability with which the stated smallest bias is seen.
POWER = 0.999


def beta_fraction(a, b, x):
    """The continued fraction of the incomplete beta function, by Lentz's method (DLMF 8.17.22)."""
    tiny = 1e-300
    c, d = 1.0, 1.0 / max(1.0 - (a + b) * x / (a + 1.0), tiny)
    total = d
    for m in range(1, 1000):
        for factor in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d, c = 1.0 + factor * d, 1.0 + factor / c
            d, c = 1.0 / (d if d != 0.0 else tiny), (c if c != 0.0 else tiny)
            total *= d * c
        if abs(d * c - 1.0) < 1e-15:
            break
    return total


def incomplete_beta(a, b, x):
    """The regularised incomplete beta function."""
    if x <= 0.0 or x >= 1.0:
        return min(max(x, 0.0), 1.0)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x))
    if x < (a + 1.0) / (a + b + 2.0):
        return front * beta_fraction(a, b, x) / a
    return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b


def tail(z, freedom):
    """Probability of a value farther from 0 than z: Student's distribution, or the normal one where `freedom` is None."""
    if freedom is None:
        return math.erfc(abs(z) / math.sqrt(2.0))
    return incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + z * z))


def quantile(probability, freedom):
    """The z of that probability: the inverse of `tail`."""
    low, high = 0.0, 1.0
    while tail(high, freedom) > probability:
        low, high = high, 2.0 * high
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if tail(middle, freedom) > probability else (low, middle)
    return high


def judge(truth, mean, error, freedom=None, nonfinite=0, tests=1):
    """Whether a reading passes, and why not. The reading must also exclude the known mistakes: one that is too noisy for that fails."""
    if nonfinite:
        return False, f"{nonfinite} pixels were not finite"
    if not (math.isfinite(mean) and error >= 0.0):
        return False, f"a mean of {mean} with a standard error of {error}"
    # Šidák: the same for each of the tests, so that all together have SIGNIFICANCE.
    significance = -math.expm1(math.log1p(-SIGNIFICANCE) / tests)
    value, tolerance = truth["value"], truth["tolerance"]
    excess = max(abs(mean - value) - tolerance, 0.0)
    z = 0.0 if excess == 0.0 else math.inf if error == 0.0 else excess / error
    seen = tolerance + (quantile(significance, freedom) + quantile(2.0 * (1.0 - POWER), freedom)) * error
    said = f"measured {mean:.10g} ± {error:.2g}, truth {value:.10g}, sees a bias of {seen:.2g}"
    if not tail(z, freedom) >= significance:
        near = [mistake["what"] for mistake in truth["mistakes"] if abs(mean - mistake["value"]) <= seen]
        return False, said + (f'; this is what one reads with "{near[0]}"' if near else "")
    needed = truth["must_resolve"]
    if needed is not None and seen > needed:
        times = ((seen - tolerance) / (needed - tolerance)) ** 2 if needed > tolerance else math.inf
        return False, f"too noisy to see a bias of {needed:.2g}: take {times:.1f} times the samples; {said}"
    return True, said


def reading(given):
    """Mean, standard error, degrees of freedom and pixels that were not finite."""
    if isinstance(given, list):
        means = [float(mean) for mean in given]
        if len(means) < 2:
            raise ValueError("one mean without an error: give two at least")
        if not all(math.isfinite(mean) for mean in means):
            return math.nan, 0.0, None, 0
        return statistics.fmean(means), statistics.stdev(means) / math.sqrt(len(means)), len(means) - 1, 0
    freedom = given.get("degrees_of_freedom")
    if freedom is not None and not freedom > 0:
        raise ValueError("degrees_of_freedom must be above 0")
    return float(given["mean"]), float(given["error"]), freedom, int(given.get("nonfinite", 0))


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    listed = json.loads((pathlib.Path(__file__).resolve().parent / "truths.json").read_text(encoding="utf-8"))
    truths = {truth["name"]: truth for truth in listed["truths"]}
    try:
        given = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
        unknown = sorted(set(given) - set(truths))
        if unknown or not given:
            raise ValueError(f"there is no truth named {unknown[0]}" if unknown else "no readings")
        readings = {name: reading(one) for name, one in given.items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as wrong:
        print(f"{sys.argv[1]}: {wrong}", file=sys.stderr)
        return 2
    failed = 0
    for name, (mean, error, freedom, nonfinite) in readings.items():
        passed, said = judge(truths[name], mean, error, freedom, nonfinite, len(readings))
        failed += not passed
        print(f"{'pass' if passed else 'FAIL'}  {name}: {said}")
    print(f"{len(readings) - failed} passed, {failed} failed, {len(truths) - len(readings)} not rendered")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
