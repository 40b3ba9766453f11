"""The same directions, W and lengths as `geometry` and `statics`, for one pose at a time and without overhead.

A control loop asks for them a thousand times a second; numpy's fixed cost per call is then what counts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .arrays import Array
from .robot import Robot


class CableStatics(NamedTuple):
    """directions (m, d), wrench_matrix (n, m), lengths (m,) [m]."""

    directions: Array
    wrench_matrix: Array
    lengths: Array


def cable_statics(robot: Robot) -> Callable[[Array, Array], CableStatics]:
    """``(position, rotation) → CableStatics`` for a spatial robot.

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0, 0, 1], rpy=[0.1, 0, 0])
    >>> fast = cable_statics(robot)(pose.position, pose.rotation)
    >>> bool(np.allclose(fast.wrench_matrix, cl.wrench_matrix(robot, pose)))
    True
    """
    # Rows x, y, z, x, y: a cross product is then two products of shifted slices.
    cycle = [0, 1, 2, 0, 1]
    exits = np.ascontiguousarray(robot.exit_points.T[cycle])
    anchors = np.ascontiguousarray(robot.anchor_points.T)
    turn, place = np.empty((5, 3)), np.empty((5, 1))
    m, turns = robot.n_cables, robot.pattern.turns
    basis = robot.pattern.basis if robot.motion_pattern == "2R3T" else None
    add = np.add.reduce

    def evaluate(position: Array, rotation: Array) -> CableStatics:
        turn[:3], turn[3:] = rotation, rotation[:2]
        place[:3, 0], place[3:, 0] = position, position[:2]
        arms = turn @ anchors
        u = exits - arms
        u -= place
        w = np.empty((6, m))
        directions = u[:3]
        lengths = np.sqrt(add(directions * directions))
        u /= lengths
        if not turns:
            return CableStatics(directions.T, directions, lengths)
        w[:3] = directions
        np.subtract(arms[1:4] * u[2:5], arms[2:5] * u[1:4], out=w[3:])
        return CableStatics(directions.T, w if basis is None else basis(rotation).T @ w, lengths)

    return evaluate
