"""Lesson 02: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np


def matrix(rng, lesson):
    d, m = rng.integers(2, 4), rng.integers(1, 9)
    u = rng.normal(size=(m, d))
    return [("build_wrench_matrix", (u / np.linalg.norm(u, axis=1, keepdims=True), rng.normal(size=(m, d))))]


def two_cables(rng, lesson):
    return [("two_cable_tensions", (rng.normal(size=(2, 2)) * 2 + [0, 3], rng.normal(size=2), rng.uniform(1, 30),
                                    rng.normal(size=2) * 80, rng.uniform(1, 12)))]


def closure(rng, lesson):
    n = int(rng.integers(1, 4))
    W = rng.normal(size=(n, n + int(rng.integers(0, 4))))
    kind = rng.integers(3)
    if kind:
        W[:, -1] = -W[:, :-1] @ rng.uniform(0.2, 1.0, W.shape[1] - 1)
    if kind == 2:
        W = np.vstack([W, W.sum(axis=0)])
    return [("has_wrench_closure", (W,))]


def taut(rng, lesson):
    n = int(rng.integers(1, 6))
    W = rng.normal(size=(n, n + 1))
    W[:, -1] = -W[:, :-1] @ rng.uniform(0.3, 1.5, n)
    return [("taut_tensions", (W[:, rng.permutation(n + 1)], rng.normal(size=n) * 100, rng.uniform(0, 50)))]


DRAWS = {"matrix": matrix, "two-cables": two_cables, "closure": closure, "taut": taut}
EQUIVALENT: dict[str, dict[str, str]] = {
    "closure": {"line 11: 1 → 2": "a positive null vector may be scaled: at least 2 exists where at least 1 does"},
    "taut": {"line 12: h[0] → h[1]": "with closure all entries of the null vector have one sign",
             "line 12: 0 → 1": "the same"},
}
OTHERS = {
    "matrix": [("np.cross on 2-D vectors, which warns", """
def build_wrench_matrix(u, r):
    moments = np.cross(r, u)
    if moments.ndim == 1:
        moments = moments[:, None]
    return np.concatenate([u, moments], axis=1).T
""")],
    "two-cables": [("Cramer's rule", """
def two_cable_tensions(exit_points, position, mass, push, gravity=9.81):
    (ax, ay), (bx, by) = [(e - position) / np.hypot(*(e - position)) for e in exit_points]
    fx, fy = -push[0], mass * gravity - push[1]
    det = ax * by - bx * ay
    return [(fx * by - bx * fy) / det, (ax * fy - fx * ay) / det]
""")],
    "closure": [("cost of one, at least 1e-3", """
def has_wrench_closure(W):
    n, m = W.shape
    found = linprog(np.ones(m), A_eq=W, b_eq=np.zeros(n), bounds=[(1e-3, None)] * m)
    return bool(found.success) and np.linalg.matrix_rank(W) == n
""")],
    "taut": [("a linear program", """
def taut_tensions(W, w_e, tension_min):
    m = W.shape[1]
    return linprog(np.ones(m), A_eq=W, b_eq=-w_e, bounds=[(tension_min, None)] * m).x
""")],
}
