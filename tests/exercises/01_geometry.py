"""Lesson 01: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np

import cdprlab as cl
from cdprlab.course import rotation_from_vector


def cable_vectors(rng, lesson):
    d, m = rng.integers(2, 4), rng.integers(3, 9)
    rotation = rotation_from_vector(rng.normal(size=1 if d == 2 else 3))
    return [("cable_vectors", (rng.normal(size=(m, d)), rng.normal(size=(m, d)), rng.normal(size=d), rotation))]


def lengths(rng, lesson):
    shape = [(3, 2), (8, 3), (5, 8, 3), (2, 4, 6, 3)][rng.integers(4)]
    return [("directions_and_lengths", (rng.normal(size=shape),))]


def jacobian(rng, lesson):
    m, rotation = rng.integers(6, 10), rotation_from_vector(rng.normal(size=3))
    directions = rng.normal(size=(m, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return [("jacobian", (directions, rng.normal(size=(m, 3)), rotation))]


def winches(rng, lesson):
    world = lesson["room"] if rng.integers(2) else lesson["planar"]
    d, m, n = world.robot.exit_points.shape[1], world.robot.n_cables, world.robot.n_dof
    turns = {"angle": rng.uniform(-0.3, 0.3, 5)} if d == 2 else {"rpy": rng.uniform(-0.3, 0.3, (5, 3))}
    poses = cl.Pose(world.pose.position + rng.uniform(-0.2, 0.2, (5, d)), **turns)
    return [("winch_speeds", (world.robot, cl.Reference(poses, rng.normal(size=(5, n)), None))),
            ("shortest_duration", (rng.normal(size=(7, m)), rng.uniform(0.3, 3, m), rng.uniform(1, 8)))]


DRAWS = {"cable-vectors": cable_vectors, "lengths": lengths, "jacobian": jacobian, "winches": winches}
EQUIVALENT: dict[str, dict[str, str]] = {}
OTHERS = {
    "cable-vectors": [("a loop, with columns", """
def cable_vectors(exit_points, anchor_points, position, rotation):
    return [a - position - rotation @ b for a, b in zip(exit_points, anchor_points)]
""")],
    "lengths": [("sums of squares", """
def directions_and_lengths(vectors):
    lengths = np.sqrt((vectors ** 2).sum(axis=-1))
    return [vectors / np.expand_dims(lengths, -1), lengths]
""")],
    "jacobian": [("row by row", """
def jacobian(directions, anchor_points, rotation):
    rows = []
    for u, b in zip(directions, anchor_points):
        rows.append([*(-u), *np.cross(u, rotation @ b)])
    return rows
""")],
    "winches": [("einsum and a loop", """
def winch_speeds(robot, reference):
    return np.einsum("kij,kj->ki", cl.jacobian(robot, reference.pose), reference.twist)


def shortest_duration(speeds, speed_max, duration):
    factor = 0.0
    for row in speeds:
        for speed, limit in zip(row, speed_max):
            factor = max(factor, abs(speed) / limit)
    return factor * duration
""")],
}
