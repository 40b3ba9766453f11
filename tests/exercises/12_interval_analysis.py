"""Lesson 12: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import copyreg

import notebooks
import numpy as np
from codac import Interval

notebooks.round_to_nearest()   # which the import changed

# Mutants answer to copies of what they are given, and codac's intervals cannot be copied by themselves.
copyreg.pickle(Interval, lambda interval: (Interval, (interval.lb(), interval.ub())))


def arithmetic(rng, lesson):
    A, B = (tuple(float(end) for end in np.sort(rng.normal(size=2) * 3)) for _ in range(2))
    return [("add", (A, B)), ("subtract", (A, B)), ("multiply", (A, B))]


def forms(rng, lesson):
    boxes = [[Interval(float(x) - width, float(x) + width) for x in rng.uniform(-3, 3, 2)]
             for width in (0.04, 0.04, 0.1)]
    return [("side_natural", tuple(boxes)), ("side_translated", tuple(boxes))]


def corners(rng, lesson):
    return [("side_exact", (*rng.uniform(-3, 3, (3, 2)), *rng.uniform(0, 0.3, 2)))]


def classify(rng, lesson):
    angle = np.sort(rng.uniform(0, 2 * np.pi, 3))
    ends = 10 ** rng.uniform(-0.5, 0.5) * np.column_stack([np.cos(angle), np.sin(angle), np.full(3, 3.0)])
    near = rng.dirichlet(np.ones(3)) @ ends
    place = np.append(near[:2] + rng.normal(size=2) * 0.2, 0.5)
    return [("classify", (ends[rng.permutation(3)], place, *rng.uniform(0, 0.15, 2)))]


def crossing(rng, lesson):
    turns = rng.uniform(0, 2 * np.pi) + np.arange(4) * np.pi / 2 + rng.uniform(-0.2, 0.2, 4)
    ends = np.column_stack([2.5 * np.cos(turns), 2.5 * np.sin(turns), np.full(4, 3.0)])
    way = np.array([np.cos(turns.mean()), np.sin(turns.mean()), 0.0])
    start, goal = -way + [0, 0, rng.uniform(0.5, 1.5)], way + [0, 0, rng.uniform(0.5, 1.5)]
    return [("detour", (ends, start, goal, *rng.uniform(0.02, 0.07, 2), rng.uniform(1.9, 2.6))),
            ("fifth_exit", (ends, start, goal, *rng.uniform(0.02, 0.07, 2)))]


DRAWS = {"arithmetic": arithmetic, "forms": forms, "corners": corners, "classify": classify, "crossing": crossing}
CHOICE = "another point that achieves what is asked"
SAME, SHARP = "the same 64 corners, from the other end", "with nothing uncertain both ends are one"
LENGTH = "a distance has no direction"
EQUIVALENT: dict[str, dict[str, str]] = {
    "corners": {("line 11: centers + widths * np.array(list(product((-1, 1), repeat=... → "
                 "centers - widths * np.array(list(product((-1, 1), repeat=..."): SAME},
    "classify": {("line 10: side_exact(corners[0], corners[1], corners[2], 0.0, 0.0)[0] → "
                  "side_exact(corners[0], corners[1], corners[2], 0.0, 0.0)[1]"): SHARP,
                 "line 10: 0 → 1": SHARP},
    "crossing": {"line 12: 21 → 22": CHOICE, "line 38: 7 → 8": CHOICE,
                 "detour: the last number off by a percent": CHOICE,
                 "line 13: [start[2], goal[2]] → [goal[2], start[2]]": "a mean has no order",
                 "line 17: V - start → start - V": LENGTH, "line 17: goal - V → V - goal": LENGTH,
                 "line 41: [exit_points, A] → [A, exit_points]": "triplets of the same exit points",
                 "line 40: exit_points[0] → exit_points[1]": "all hang at one height",
                 "line 40: 0 → 1": "all hang at one height"},
}
OTHERS = {
    "arithmetic": [("sorted ends, as lists", """
def add(A, B):
    return np.add(A, B)

def subtract(A, B):
    return [np.float32(A[0] - B[1]), np.float32(A[1] - B[0])]

def multiply(A, B):
    return sorted(np.outer(A, B).ravel())[::3]
""")],
    "forms": [("differences first", """
def cross(p, q):
    value = p[0] * q[1] - p[1] * q[0]
    return [value.lb(), value.ub()]

def side_natural(a, b, m):
    return cross([y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, m)])

def side_translated(a, b, m):
    return cross([x - y for x, y in zip(a, m)], [x - y for x, y in zip(b, m)])
""")],
    "corners": [("nested loops", """
def side_exact(start, end, position, exit_uncertainty, position_uncertainty):
    low, high = np.inf, -np.inf
    e, w = exit_uncertainty, position_uncertainty
    for ax, ay, bx, by in product(*[(x - e, x + e) for x in (*start, *end)]):
        for mx, my in product(*[(x - w, x + w) for x in position]):
            side = (bx - ax) * (my - ay) - (by - ay) * (mx - ax)
            low, high = min(low, side), max(high, side)
    return [low, high]
""")],
    "classify": [("the library's ranges", """
def classify(exit_points, position, position_uncertainty, exit_uncertainty):
    (ax, ay), (bx, by), (cx, cy) = (A[:2] for A in exit_points)
    order = [0, 1, 2] if (bx - ax) * (cy - ay) > (by - ay) * (cx - ax) else [0, 2, 1]
    lows, highs = [], []
    for i, j in zip(order, order[1:] + order[:1]):
        low, high = side_range(exit_points[i][:2], exit_points[j][:2], position[:2], exit_uncertainty,
                               position_uncertainty, "corners")
        lows.append(low)
        highs.append(high)
    return "outside" if min(highs) < 0 else ("inside" if min(lows) > 0 else "uncertain")
""")],
    "crossing": [("to the side of the middle; at random", """
def detour(exit_points, start, goal, position_uncertainty, exit_uncertainty, longest):
    regions = regions_of(exit_points, position_uncertainty, exit_uncertainty)
    way = np.asarray(goal) - start
    for share in (0.5, 0.4, 0.6):
        for step in np.arange(0, 1.0, 0.05):
            for side in (step, -step):
                V = start + share * way + side * np.array([-way[1], way[0], 0]) / np.hypot(*way[:2])
                if (np.linalg.norm(V - start) + np.linalg.norm(goal - V) <= longest
                        and min(sure_until(regions, start, V), sure_until(regions, V, goal)) >= 1):
                    return V.tolist()
    raise ValueError("none found")

def fifth_exit(exit_points, start, goal, position_uncertainty, exit_uncertainty):
    rng = np.random.default_rng(0)
    for _ in range(60):
        A = rng.uniform(np.min(exit_points, axis=0), np.max(exit_points, axis=0))
        five = [*exit_points, A]
        if sure_until(regions_of(np.array(five), position_uncertainty, exit_uncertainty), start, goal) == 1.0:
            return list(A)
    raise ValueError("none found")
""")],
}
