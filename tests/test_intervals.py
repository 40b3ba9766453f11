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
a, b, t = np.load(sys.argv[1])
import codac
rows = []
for p, q, r in zip(a, b, t):
    x, y, z = codac.Interval(*p), codac.Interval(*q), codac.Interval(*r)
    found = [x + y, x - y, x * y, x / y, codac.sqr(x), codac.sqrt(y), codac.cos(z), codac.sin(z)]
    rows.append([(each.lb(), each.ub()) for each in found])
np.save(sys.argv[2], np.array(rows))
"""
"""A process of its own: codac leaves the processor rounding upward."""


def boxes(seed, count=200):
    """Any intervals, positive ones, and angles up to several turns wide."""
    rng = np.random.default_rng(seed)
    width = rng.choice([0.0, 1e-9, 0.3, 2.0, 7.0], count)
    start = rng.uniform(-20, 20, count)
    return np.stack([np.sort(rng.uniform(-2, 3, (count, 2))), np.sort(rng.uniform(0.5, 4, (count, 2))),
                     np.stack([start, start + width], axis=1)])


@pytest.mark.skipif(importlib.util.find_spec("codac") is None, reason="codac is not installed")
def test_codac_is_hardly_narrower(tmp_path):
    """Each operation encloses the one that codac rounds outward, by a few units in the last place."""
    given = boxes(14)
    np.save(tmp_path / "given.npy", given)
    subprocess.run([sys.executable, "-c", CODAC, tmp_path / "given.npy", tmp_path / "found.npy"], check=True)
    low, high = np.moveaxis(np.load(tmp_path / "found.npy"), -1, 0)
    x, y, z = (Intervals(*part.T) for part in given)
    for k, ours in enumerate((x + y, x - y, x * y, x / y, x.square(), y.sqrt(), z.cos(), z.sin())):
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
    a, b, t = boxes(5)
    shares = np.random.default_rng(6).random((3, 50, len(a)))
    x, y, z = (Intervals(*part.T) for part in (a, b, t))
    p, q, r = (part[:, 0] + share * (part[:, 1] - part[:, 0]) for part, share in zip((a, b, t), shares))
    for ours, value in ((x + y, p + q), (x - y, p - q), (x * y, p * q), (x / y, p / q), (x.square(), p * p),
                        (y.sqrt(), np.sqrt(q)), (z.cos(), np.cos(r)), (z.sin(), np.sin(r)), (x & x, p)):
        assert (ours.lower <= value).all() and (value <= ours.upper).all()


def test_peaks_and_troughs_at_the_ends_and_inside():
    turns = np.arange(-4, 5) * np.pi / 2
    for low, high in ((turns, turns), (turns - 0.1, turns + 0.1), (turns, turns + np.pi / 2)):
        box = Intervals(low, high)
        for ours, function in ((box.cos(), np.cos), (box.sin(), np.sin)):
            values = function(np.linspace(low, high, 101))
            assert (ours.lower <= values.min(axis=0)).all() and (values.max(axis=0) <= ours.upper).all()
            assert (values.min(axis=0) - ours.lower < 1e-8).all() and (ours.upper - values.max(axis=0) < 1e-8).all()
    whole = Intervals(np.array(0.3), np.array(0.3 + 2 * np.pi))
    assert (whole.cos().lower, whole.cos().upper, whole.sin().lower, whole.sin().upper) == (-1, 1, -1, 1)


def test_a_divisor_that_may_be_zero_bounds_nothing():
    third = Intervals(np.array([1.0, -1.0, 0.0]), np.array([2.0, 2.0, 0.0])) / Intervals(np.zeros(3), np.full(3, 4.0))
    assert (third.lower == -np.inf).all() and (third.upper == np.inf).all()


def test_what_two_intervals_share():
    both = Intervals(np.array([0.0, 0.0]), np.array([2.0, 1.0])) & Intervals(np.array([1.0, 3.0]), np.array([3.0, 4.0]))
    assert (both.lower[0], both.upper[0]) == (1.0, 2.0) and (both.width < 0).tolist() == [False, True]
