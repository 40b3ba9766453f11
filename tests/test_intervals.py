"""Interval arithmetic: enclosures against exact fractions, random numbers and codac, where that is installed."""

import importlib.util
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

from cdprlab.mechanics.intervals import Intervals, exact

CODAC = """
import sys
import numpy as np
a, b = np.load(sys.argv[1])
import codac
rows = []
for p, q in zip(a, b):
    x, y = codac.Interval(*p), codac.Interval(*q)
    found = [x + y, x - y, x * y, x / y, codac.sqr(x), codac.sqrt(y)]
    rows.append([(each.lb(), each.ub()) for each in found])
np.save(sys.argv[2], np.array(rows))
"""
"""A process of its own: codac leaves the processor rounding upward."""


def boxes(seed, count=200):
    """Any intervals, and positive ones."""
    rng = np.random.default_rng(seed)
    return np.stack([np.sort(rng.uniform(-2, 3, (count, 2))), np.sort(rng.uniform(0.5, 4, (count, 2)))])


@pytest.mark.skipif(importlib.util.find_spec("codac") is None, reason="codac is not installed")
def test_codac_is_hardly_narrower(tmp_path):
    """Each operation encloses the one that codac rounds outward, by a few units in the last place."""
    given = boxes(14)
    np.save(tmp_path / "given.npy", given)
    subprocess.run([sys.executable, "-c", CODAC, tmp_path / "given.npy", tmp_path / "found.npy"], check=True)
    low, high = np.moveaxis(np.load(tmp_path / "found.npy"), -1, 0)
    x, y = (Intervals(*part.T) for part in given)
    for k, ours in enumerate((x + y, x - y, x * y, x / y, x.square(), y.sqrt())):
        assert (ours.lower <= low[:, k]).all() and (high[:, k] <= ours.upper).all()
        assert (low[:, k] - ours.lower <= 1e-14).all() and (ours.upper - high[:, k] <= 1e-14).all()


def test_exact_results_lie_between_the_ends():
    """Numbers of very different size, in fractions, which do not round."""
    rng = np.random.default_rng(3)
    numbers = (rng.normal(size=(2, 500)) * 10.0 ** rng.integers(-9, 9, (2, 500))).tolist()
    for p, q in zip(*numbers):
        x, y, a, b = exact(p), exact(q), Fraction(p), Fraction(q)
        for ours, true in ((x + q, a + b), (x - y, a - b), (p - y, a - b), (x * y, a * b), (x.square(), a * a),
                           (x / exact(abs(q)), a / abs(b))):
            assert Fraction(float(ours.lower)) < true < Fraction(float(ours.upper))
        root = y.square().sqrt()
        assert float(root.lower) <= abs(q) <= float(root.upper)


def test_everything_inside_is_mapped_inside():
    a, b = boxes(5)
    shares = np.random.default_rng(6).random((2, 50, len(a)))
    x, y = (Intervals(*part.T) for part in (a, b))
    p, q = (part[:, 0] + share * (part[:, 1] - part[:, 0]) for part, share in zip((a, b), shares))
    for ours, value in ((x + y, p + q), (x - y, p - q), (x * y, p * q), (x / y, p / q), (x.square(), p * p),
                        (y.sqrt(), np.sqrt(q)), (x & x, p)):
        assert (ours.lower <= value).all() and (value <= ours.upper).all()


def test_a_divisor_that_may_be_zero_bounds_nothing():
    third = Intervals(np.array([1.0, -1.0, 0.0]), np.array([2.0, 2.0, 0.0])) / Intervals(np.zeros(3), np.full(3, 4.0))
    assert (third.lower == -np.inf).all() and (third.upper == np.inf).all()


def test_what_two_intervals_share():
    both = Intervals(np.array([0.0, 0.0]), np.array([2.0, 1.0])) & Intervals(np.array([1.0, 3.0]), np.array([3.0, 4.0]))
    assert (both.lower[0], both.upper[0]) == (1.0, 2.0) and (both.width < 0).tolist() == [False, True]
