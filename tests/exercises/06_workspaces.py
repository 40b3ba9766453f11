"""Lesson 06: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np


def margin(rng, lesson):
    n, r = int(rng.integers(1, 5)), int(rng.integers(0, 3))
    W, low = rng.normal(size=(n, n + r)), rng.uniform(0, 40, n + r)
    high = low + rng.uniform(20, 300, n + r)
    w_e = rng.normal(size=n) * 100
    if rng.integers(8) == 0:
        W, w_e = np.vstack([W, 0 * W[0]]), np.append(w_e, 5.0)
    return [("tension_margin", (W, w_e, low, high))]


def area(rng, lesson):
    low, normal = rng.normal(size=2), rng.normal(size=2)
    high = low + rng.uniform(0.5, 3, 2)
    return [("area_bounds", (lambda p: (p - (low + high) / 2) @ normal < 0.1, low, high, int(rng.integers(1, 9))))]


def minimum(rng, lesson):
    ((_, (W, w_e, _, high)),) = margin(rng, lesson)
    return [("largest_minimum", (W, w_e, high))]


DRAWS = {"margin": margin, "area": area, "minimum": minimum}
EQUIVALENT: dict[str, dict[str, str]] = {
    "margin": {"line 12: 1.0 → 2.0": "twice the cost has the same minimizer"},
    "area": {"line 12: 1 → 2": "numpy works out any negative size, -2 as well as -1"},
    "minimum": {"line 12: 1.0 → 2.0": "twice the cost has the same minimizer"},
}
OTHERS = {
    "margin": [("limits as bounds, the rest as slacks", """
def tension_margin(W, w_e, low, high):
    n, m = W.shape
    # unknowns: s and the free distances from both limits, τ = low + s + a = high - s - b
    columns = np.column_stack([W.sum(axis=1), W, np.zeros((n, m))])
    spans = np.column_stack([2 * np.ones(m), np.eye(m), np.eye(m)])
    found = linprog([-1.0] + [0.0] * (2 * m), A_eq=np.vstack([columns, spans]),
                    b_eq=np.append(-w_e - W @ low, high - low), bounds=[(None, None)] + [(0, None)] * (2 * m))
    return -float("inf") if not found.success else float(found.x[0])
""")],
    "area": [("a loop over the cells", """
def area_bounds(inside, lower, upper, n):
    (left, bottom), (right, top) = lower, upper
    w, h = (right - left) / n, (top - bottom) / n
    points = [[left + i * w, bottom + k * h] for i in range(n + 1) for k in range(n + 1)]
    flags = list(inside(np.array(points)))
    least = most = 0.0
    for i in range(n):
        for k in range(n):
            four = [flags[a * (n + 1) + b] for a in (i, i + 1) for b in (k, k + 1)]
            least += w * h * all(four)
            most += w * h * any(four)
    return [least, most]
""")],
    "minimum": [("the excess over t as unknown", """
def largest_minimum(W, w_e, high):
    n, m = W.shape
    found = linprog(np.r_[-1.0, np.zeros(m)], A_eq=np.column_stack([W @ np.ones(m), W]), b_eq=-w_e,
                    A_ub=np.column_stack([np.ones(m), np.eye(m)]), b_ub=high,
                    bounds=[(None, None)] + [(0, None)] * m)
    return found.x[0] if found.success else -np.inf
""")],
}
