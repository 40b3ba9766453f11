"""Lesson 08: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np

import cdprlab as cl


def rows(rng, lesson):
    m, n = [(4, 2), (3, 2), (8, 6), (5, 3)][rng.integers(4)]
    N, twists = rng.normal(size=(m, n)), rng.normal(size=(7, n)) / 2
    return [("cable_rows", (rng.normal(size=(m, n)), rng.uniform(0.5, 3, m))),
            ("is_inside", (N, rng.uniform(0.2, 1.5, m), twists))]


def support(rng, lesson):
    m, n, a = [(4, 2, 2), (4, 3, 1), (8, 6, 3), (8, 6, 0)][rng.integers(4)]
    return [("support", (rng.normal(size=n), rng.normal(size=(m, n)), rng.normal(size=(m, a)),
                         rng.uniform(0.5, 2, m), rng.uniform(0.1, 1, a)))]


def body(rng):
    n, r = int(rng.integers(2, 4)), int(rng.integers(1, 8))
    N = np.vstack([rng.normal(size=(r, n)), np.eye(n), -np.eye(n)])
    return N, np.concatenate([rng.uniform(0.2, 1.5, r), rng.uniform(1.0, 3.0, 2 * n)])


def axes(rng, lesson):
    N, d = body(rng)
    return [("component_range", (cl.Polytope.from_rows(N, d).vertices,)), ("axis_section", (N, d))]


def scale(rng, lesson):
    N, d = body(rng)
    return [("largest_scale", (N, d, rng.normal(size=(int(rng.integers(1, 5)), N.shape[1]))))]


DRAWS = {"rows": rows, "support": support, "axes": axes, "scale": scale}
EQUIVALENT: dict[str, dict[str, str]] = {
    "rows": {"line 9: [J, -J] → [-J, J]": "the rows of a polytope have no order",
             "line 9: [cable_max, cable_max] → [cable_max, cable_max]": "both are the same"},
    "support": {
        "line 11: -B → B": "base speeds are limited alike both ways, so a base may as well count the other way",
        "line 12: -np.asarray(c, float) → np.asarray(c, float)": "the set is symmetric about zero: h(-c) = h(c)",
        "line 14: [rows, -rows] → [-rows, rows]": "both signs have the same limits: the rows are the same set",
        "line 15: [cable_max, cable_max] → [cable_max, cable_max]": "both are the same"},
}
OTHERS = {
    "rows": [("a loop, the rows in pairs", """
def cable_rows(J, cable_max):
    N, d = [], []
    for row, limit in zip(J, cable_max):
        N += [list(row), [-x for x in row]]
        d += [limit, limit]
    return N, d

def is_inside(N, d, twists):
    return [all(np.dot(n, t) <= x for n, x in zip(N, d)) for t in twists]
""")],
    "support": [("cable speeds as unknowns", """
def support(c, J, B, cable_max, base_max):
    (m, n), a = J.shape, B.shape[1]
    free = [(None, None)] * n
    found = linprog(np.r_[-c, np.zeros(a + m)], A_eq=np.hstack([J, -B, -np.eye(m)]), b_eq=np.zeros(m),
                    bounds=free + [(-x, x) for x in np.r_[base_max, cable_max]])
    return float(c @ found.x[:n])
""")],
    "axes": [("loops", """
def component_range(vertices):
    return [[min(column), max(column)] for column in zip(*vertices)]

def axis_section(N, d):
    ends = []
    for column in np.asarray(N).T:
        up = min(x / n for n, x in zip(column, d) if n > 0)
        down = min(x / -n for n, x in zip(column, d) if n < 0)
        ends.append([-down, up])
    return ends
""")],
    "scale": [("a linear program", """
def largest_scale(N, d, corners):
    found = linprog([-1.0], A_ub=(corners @ N.T).reshape(-1, 1), b_ub=np.tile(d, len(corners)))
    return float(found.x[0])
""")],
}
