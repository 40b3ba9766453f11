"""Lesson 07: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np

import cdprlab as cl


def base_rows(rng, lesson):
    d, k = rng.integers(2, 4), rng.integers(1, 5)
    u = rng.normal(size=(k, d))
    return [("base_rows", (u / np.linalg.norm(u, axis=1, keepdims=True), rng.normal(size=(k, d)),
                           np.append(rng.normal(size=2), np.zeros(d - 2)), rng.uniform(-3, 3)))]


def hold(rng, lesson):
    world = lesson["planar"] if rng.integers(2) else lesson["four"]
    base = world.robot.bases[rng.integers(len(world.robot.bases))]
    place = cl.Pose(world.pose.position + rng.normal(size=world.robot.dimension) / 5)
    return [("hold_still", (world.robot, place, base.name, rng.normal(size=3)))]


def share(rng, lesson):
    m, n, q = [(4, 2, 2), (4, 3, 1), (8, 6, 12), (3, 2, 5)][rng.integers(4)]
    return [("share_twist", (rng.normal(size=(m, n)), rng.normal(size=(m, q)), rng.normal(size=n),
                             rng.uniform(0.2, 5, q + m)))]


def scale(rng, lesson):
    m, n, q = [(4, 2, 2), (4, 3, 1), (8, 6, 0), (3, 2, 2)][rng.integers(4)]
    return [("largest_scale", (rng.normal(size=(m, n)), rng.normal(size=(m, q)), rng.normal(size=n) * 3,
                               rng.uniform(0.1, 1.0, q), rng.uniform(0.5, 2.0, m)))]


DRAWS = {"base-rows": base_rows, "hold": hold, "share": share, "scale": scale}
EQUIVALENT: dict[str, dict[str, str]] = {"scale": {
    "line 11: -B → B": "base speeds are limited alike both ways, so a base may as well count the other way",
    "line 13: 1.0 → 2.0": "twice the cost has the same minimizer",
    "line 15: [rows, -rows] → [-rows, rows]": "both signs have the same limits: the rows are the same set",
}}
OTHERS = {
    "base-rows": [("a loop over the cables", """
def base_rows(u, exit_points, center, heading):
    rows = []
    for direction, point in zip(u, exit_points):
        x, y = (point - center)[:2]
        c, q = np.cos(heading), np.sin(heading)
        rows.append([-(direction[0] * -y + direction[1] * x), -(direction[0] * c + direction[1] * q),
                     -(-direction[0] * q + direction[1] * c)])
    return rows
""")],
    "hold": [("by its own rows", """
def hold_still(robot, pose, name, speeds):
    B = cl.base_jacobian(robot, pose)
    rates = np.zeros(len(robot.bases) * 3)
    for k, base in enumerate(robot.bases):
        if base.name == name:
            rates[3 * k:3 * k + 3] = speeds
    return [-(row @ rates) for row in B]
""")],
    "share": [("the pseudo-inverse of scaled columns", """
def share_twist(J, B, twist, weights):
    root = np.sqrt(weights)
    G = np.hstack([B, np.eye(len(J))]) / root
    return (np.linalg.pinv(G) @ (J @ twist)) / root
""")],
    "scale": [("all speeds as unknowns", """
def largest_scale(J, B, twist, base_limits, cable_limits):
    (m, q), wish = B.shape, J @ twist
    found = linprog(np.r_[np.zeros(q + m), -1], A_eq=np.column_stack([B, np.eye(m), -wish]), b_eq=np.zeros(m),
                    bounds=[(-b, b) for b in np.r_[base_limits, cable_limits]] + [(0, 1)])
    return float(found.x[-1])
""")],
}
