"""The same directions, W and lengths as `geometry` and `statics`, for one pose at a time and without overhead.

A control loop asks for them a thousand times a second; numpy's fixed cost per call is then what counts.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .arrays import Array
from .robot import Robot

CableStatics = tuple[Array, Array, Array]
"""Directions (m, 3), wrench matrix (n, m), lengths (m,) [m]; a bare tuple, which is made in no time."""


# Rows x, y, z, x, y: a cross product is then two products of shifted slices, without copies.
CYCLE = [0, 1, 2, 0, 1]


def cyclic(position: Array, rotation: Array) -> tuple[Array, Array]:
    """Position (5, 1) and rotation (5, 3) with rows x, y, z, x, y, as `cable_statics` takes them."""
    return position[CYCLE, None], rotation[CYCLE]


def cyclic_exits(robot: Robot) -> Array:
    """(5, m) exit points with rows x, y, z, x, y [m]; given to `cable_statics`, they may be moved in place."""
    return np.ascontiguousarray(robot.exit_points.T[CYCLE])


def cable_statics(robot: Robot, exits: Array | None = None) -> Callable[[Array, Array], CableStatics]:
    """``(place, turn) → CableStatics`` for a spatial robot, from `cyclic` position and rotation.

    exits : as `cyclic_exits` gives them, if they are to move later

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0, 0, 1], rpy=[0.1, 0, 0])
    >>> _, W, _ = cable_statics(robot)(*cyclic(pose.position, pose.rotation))
    >>> bool(np.allclose(W, cl.wrench_matrix(robot, pose)))
    True
    """
    exits = cyclic_exits(robot) if exits is None else exits
    anchors = np.ascontiguousarray(robot.anchor_points.T)
    m, ones, turns = robot.n_cables, np.ones(3), robot.pattern.turns
    basis = robot.pattern.basis if robot.motion_pattern == "2R3T" else None

    def evaluate(place: Array, turn: Array) -> CableStatics:
        # `dot` where `@` would do: on small matrices it takes half the time.
        arms = turn.dot(anchors)
        u = exits - arms
        u -= place
        directions = u[:3]
        lengths = np.sqrt(ones.dot(directions * directions))
        u /= lengths
        if not turns:
            return directions.T, directions, lengths
        w = np.empty((6, m))
        w[:3] = directions
        np.subtract(arms[1:4] * u[2:], arms[2:] * u[1:4], out=w[3:])
        return directions.T, w if basis is None else basis(turn[:3]).T.dot(w), lengths

    return evaluate
