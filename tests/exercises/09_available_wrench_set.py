"""Lesson 09: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np


def limits(rng, m):
    low = rng.uniform(0, 30, m)
    return low, low + rng.uniform(5, 80, m)


def support(rng, lesson):
    n, m = [(1, 2), (2, 4), (3, 5), (6, 8)][rng.integers(4)]
    return [("support", (rng.normal(size=(n, m)), *limits(rng, m), rng.normal(size=n)))]


def planes(rng, lesson):
    m = int(rng.integers(2, 7))
    return [("shifted_lines", (rng.normal(size=(2, m)), *limits(rng, m)))]


def rows(rng, lesson):
    k, m = int(rng.integers(3, 7)), int(rng.integers(1, 5))
    angles = np.sort((np.arange(k) + rng.uniform(-0.3, 0.3, k)) * 2 * np.pi / k)
    feet = rng.normal(size=2) + np.column_stack([0.6 * np.cos(angles), 0.4 * np.sin(angles)])
    u = rng.normal(size=(m, 3))
    return [("moment_rows", (feet[::-1] if rng.integers(2) else feet, np.append(feet.mean(axis=0), 0.5),
                             rng.uniform(200, 900), rng.normal(size=(m, 3)) + [0, 0, 2],
                             u / np.linalg.norm(u, axis=1, keepdims=True)))]


def payload(rng, lesson):
    n, m, k = [(2, 4, 4), (2, 3, 0), (3, 5, 2), (6, 8, 8)][rng.integers(4)]
    W, (low, high) = rng.normal(size=(n, m)), limits(rng, m)
    held, A = rng.uniform(low, high), rng.normal(size=(k, m))
    w_e = -W @ held + (1e4 if rng.integers(5) == 0 else 0.0)
    return [("largest_payload", (W, w_e, rng.normal(size=n) * 5, low, high, A, -A @ held - rng.uniform(1, 30, k)))]


DRAWS = {"support": support, "planes": planes, "rows": rows, "payload": payload}
EQUIVALENT: dict[str, dict[str, str]] = {
    "support": {"line 12: direction @ W @ tensions → tensions @ (direction @ W)": "a dot product of two vectors"},
    "planes": {"line 10: [across, -across] → [-across, across]": "the rows of a polytope have no order"},
    "rows": {"line 12: following - contacts → contacts - following": "its norm is the same",
             "line 15: [0.0, 0.0, -weight] → [0.0, 0.0, -weight]": "both zeros are the same"},
    "payload": {"line 12: 1.0 → 2.0": "twice the cost has the same minimizer"},
}
OTHERS = {
    "support": [("a loop over the cables", """
def support(W, low, high, direction):
    h, tensions = 0.0, []
    for column, least, most in zip(W.T, low, high):
        along = sum(c * w for c, w in zip(direction, column))
        tensions.append(most if along >= 0 else least)
        h += along * tensions[-1]
    return [h, tensions]
"""), ("a linear program", """
def support(W, low, high, direction):
    found = linprog(-(direction @ W), bounds=list(zip(low, high)))
    return -found.fun, found.x
""")],
    "planes": [("a loop, normals in pairs", """
def shifted_lines(W, low, high):
    normals, offsets = [], []
    for x, y in W.T:
        length = np.hypot(x, y)
        for sign in (1, -1):
            n = np.array([sign * y / length, -sign * x / length])
            normals.append(n.tolist())
            offsets.append(sum(max(a * (n @ w), b * (n @ w)) for w, a, b in zip(W.T, low, high)))
    return normals, offsets
""")],
    "rows": [("triple products in loops", """
def moment_rows(footprint, center_of_mass, weight, exits, u):
    k = len(footprint)
    feet = [np.array([x, y, 0.0]) for x, y in footprint]
    area = sum(feet[j][0] * feet[(j + 1) % k][1] - feet[(j + 1) % k][0] * feet[j][1] for j in range(k))
    A, b = [], []
    for j in range(k):
        edge = (feet[(j + 1) % k] - feet[j]) * (1 if area > 0 else -1)
        edge = edge / np.sqrt(edge @ edge)
        b.append(edge @ np.cross(center_of_mass - feet[j], [0, 0, -weight]))
        A.append([-edge @ np.cross(exit_point - feet[j], pull) for exit_point, pull in zip(exits, u)])
    return A, b
""")],
    "payload": [("payload first among the unknowns", """
def largest_payload(W, w_e, per_kg, low, high, A, b):
    found = linprog(np.r_[-1.0, 0 * low], A_eq=np.column_stack([per_kg, W]), b_eq=-w_e,
                    A_ub=np.column_stack([0 * b, A]) if len(b) else None, b_ub=-b if len(b) else None,
                    bounds=[(0, None), *zip(low, high)])
    if not found.success:
        return float("nan"), [float("nan")] * len(low)
    return float(found.x[0]), found.x[1:].tolist()
""")],
}
