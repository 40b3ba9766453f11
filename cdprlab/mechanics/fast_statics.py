"""The same directions, W and lengths as `geometry` and `statics`, for one pose at a time and without overhead.

A control loop asks for them a thousand times a second; numpy's fixed cost per call is then what counts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..robot import Robot

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

    def evaluate_point(place: Array, turn: Array) -> CableStatics:
        u = exits[:3] - place[:3]
        lengths = np.sqrt(ones.dot(u * u))
        u /= lengths
        return u.T, u, lengths

    def evaluate(place: Array, turn: Array) -> CableStatics:
        # `dot` where `@` would do: on small matrices it takes half the time.
        arms = turn.dot(anchors)
        u = exits - arms
        u -= place
        directions = u[:3]
        lengths = np.sqrt(ones.dot(directions * directions))
        u /= lengths
        w = np.empty((6, m))
        w[:3] = directions
        np.subtract(arms[1:4] * u[2:], arms[2:] * u[1:4], out=w[3:])
        return directions.T, w if basis is None else basis(turn[:3]).T.dot(w), lengths

    # Without turning, in 3T, all cables meet at P.
    return evaluate if turns else evaluate_point


def standing_rows(robot: Robot) -> Callable[[Array, Array], tuple[Array, Array]]:
    """``(directions, headings) → G, g`` of G τ + g ≤ 0 for every base's edges: `tipping_rows`, without overhead.

    directions : (m, 3) of the cables; headings : (p,) of the bases now [rad]; wherever they stand, G is the same
    Returns from each call (k, m) [m] and (k,) [N m], base after base in file order.

    >>> import cdprlab as cl
    >>> world = cl.load_world("fastkit_suspended")
    >>> G, g = standing_rows(world.robot)(cl.cable_directions(world.robot, world.pose), np.zeros(2))
    >>> rows = cl.tipping_rows(world.robot, world.pose)
    >>> bool(np.allclose(G, np.concatenate([rows[name].matrix for name in rows])))
    True
    """
    level = [replace(base, position=np.zeros(2), heading=0.0) for base in robot.bases]
    levers, offsets = [], []
    for k, base in enumerate(level):
        if not base.footprint.shape[0]:
            continue
        contacts = np.pad(base.footprint, ((0, 0), (0, 1)))
        edges = np.roll(contacts, -1, axis=0) - contacts
        axes = edges / np.linalg.norm(edges, axis=1)[:, None]
        # −u's moment about an edge: axis · (arm × −u) = (arm × axis) · u.
        lever = np.zeros((len(contacts), robot.n_cables, 3))
        for i, cable in enumerate(robot.cables):
            if robot.base_indices[i] == k:
                lever[:, i] = np.cross(cable.exit_point - contacts, axes)
        weight = np.array([0.0, 0.0, -base.mass * robot.gravity])
        offsets.append((np.cross(base.center_of_mass - contacts, weight) * axes).sum(axis=1))
        levers.append((k, lever))
    offset = np.concatenate(offsets) if offsets else np.zeros(0)

    def evaluate(directions: Array, headings: Array) -> tuple[Array, Array]:
        rows = []
        for k, lever in levers:
            c, s = np.cos(headings[k]), np.sin(headings[k])
            u = directions @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])  # seen from the base
            rows.append((lever * u).sum(axis=2))
        return (np.concatenate(rows) if rows else np.zeros((0, robot.n_cables))), offset

    return evaluate
