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
    turns = robot.pattern.turns
    basis = robot.pattern.basis if robot.motion_pattern == "2R3T" else None

    def evaluate(position: Array, rotation: Array) -> CableStatics:
        arms = rotation[cycle] @ anchors
        u = exits - position[cycle, None] - arms
        lengths = np.sqrt(np.add.reduce(u[:3] * u[:3]))
        u /= lengths
        if not turns:
            return CableStatics(u[:3].T, u[:3], lengths)
        w = np.empty((6, lengths.shape[0]))
        w[:3] = u[:3]
        np.subtract(arms[1:4] * u[2:5], arms[2:5] * u[1:4], out=w[3:])
        if basis is not None:
            return CableStatics(u[:3].T, basis(rotation).T @ w, lengths)
        return CableStatics(u[:3].T, w, lengths)

    return evaluate
