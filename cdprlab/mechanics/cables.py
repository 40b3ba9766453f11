"""Cables at a pose: vectors, directions, lengths (inverse kinematics of positions) and the columns they give W.

A cable is straight from its anchor point B to its exit point A or, where it leaves over a pulley,
to the tangent point T on the wheel.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Flags, checked
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose


class Cables(NamedTuple):
    """What there is to know of a robot's cables at a pose.

    directions : (…, m, d) u, unit vectors from anchor point to exit or tangent point, in world axes
    lengths : (…, m) l [m]
    wrench_matrix : (…, n, m) W, columns [u; (R b) × u] in the motion pattern's rows
    """

    directions: Array
    lengths: Array
    wrench_matrix: Array


def cables_at(robot: Robot, pose: Pose) -> Cables:
    """Directions, lengths and wrench matrix together: the one place where they are asked for.

    robot, pose : single or batched
    Raises InvalidInput when robot and pose have different dimensions, or where a cable has no
    direction.

    >>> import cdprlab as cl
    >>> directions, lengths, W = cables_at(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))
    >>> directions.shape, lengths.shape, W.shape
    ((8, 3), (8,), (6, 8))
    """
    lengths, W = _asked(robot, pose)
    if not lengths.all():
        raise InvalidInput(why_no_direction(robot, pose))
    directions = W[..., :robot.dimension, :].swapaxes(-1, -2)
    return Cables(directions, lengths, robot.pattern.project(W, pose.rotation))


def anchor_offsets(robot: Robot, pose: Pose) -> Array:
    """r_i = R b_i, from the reference point P to each anchor point, in world axes.

    robot, pose : single or batched
    Returns (…, m, d) [m].
    Raises InvalidInput when robot and pose have different dimensions.

    >>> import cdprlab as cl
    >>> anchor_offsets(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).shape
    (8, 3)
    """
    check_dimension(robot, pose)
    return robot.anchor_points @ np.swapaxes(pose.rotation, -1, -2)


def exits_from_anchors(robot: Robot, pose: Pose) -> Array:
    """A − B in world axes, (…, m, d) [m]; robot, pose : single or batched."""
    return robot.exit_points - (pose.position[..., None, :] + anchor_offsets(robot, pose))


@checked
def cable_vectors(robot: Robot, pose: Pose) -> Array:
    """From anchor point to exit point: A_i − (p + R b_i), on a pulley to the tangent point: T_i − (p + R b_i).

    robot, pose : single or batched
    Returns (…, m, d) in world axes [m].
    Raises InvalidInput where a cable cannot lie on its pulley.
    Source: Okoli 2016, eq. (2.4) with the cable running from B_i to A_i.

    >>> import cdprlab as cl
    >>> cable_vectors(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))[0]
    array([-4.1, -1.7,  2.7])
    """
    vectors = exits_from_anchors(robot, pose)
    if robot.pulleys.size:
        return cable_directions(robot, pose) * straight_lengths(-vectors, robot.pulleys)[..., None]
    return vectors


def tangent_points(robot: Robot, pose: Pose) -> Array:
    """Where the cables' straight parts begin: T_i on a pulley, else the exit point A_i.

    robot, pose : single or batched
    Returns (…, m, d), without any pulleys (m, d), in the world [m].
    Raises InvalidInput where a cable cannot lie on its pulley.

    >>> import cdprlab as cl
    >>> tangent_points(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))[0]
    array([-3.5, -2. ,  3.5])
    """
    if robot.pulleys.size:
        return pose.position[..., None, :] + anchor_offsets(robot, pose) + cable_vectors(robot, pose)
    return robot.exit_points


def straight_lengths(away: Array, pulleys: Array) -> Array:
    """s = ‖T − B‖ = √(‖B − A‖² − 2 r x), x from B to the axis that the cable comes along: the tangent to the wheel.

    away : (…, m, d) B − A [m]; pulleys : (m, 1 + d) as `Robot.pulleys` has them
    Returns (…, m) [m].

    >>> straight_lengths(np.array([[2.0, 3.0]]), np.array([[0.5, 0.0, 1.0]]))
    array([3.31662479])
    """
    radii, axes = pulleys[:, 0], pulleys[:, 1:]
    out = away - (away * axes).sum(axis=-1, keepdims=True) * axes
    return np.asarray(np.sqrt((away * away).sum(axis=-1) - 2 * radii * np.linalg.norm(out, axis=-1)))


@checked
def cable_lengths(robot: Robot, pose: Pose) -> Array:
    """l_i = ‖A_i − (p + R b_i)‖, inverse kinematics; on a pulley r φ_i + ‖T_i − (p + R b_i)‖, φ_i the wrap angle.

    robot, pose : single or batched
    Returns (…, m) [m].
    Raises InvalidInput where a cable cannot lie on its pulley.
    Source: Pott 2018, Cable-Driven Parallel Robots, (pulley kinematics).

    >>> import cdprlab as cl
    >>> cable_lengths(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).round(3)[:2]
    array([5.195, 4.358])
    """
    lengths, _ = _asked(robot, pose)
    if robot.pulleys.size and not lengths.all():
        raise InvalidInput(why_no_direction(robot, pose))
    return lengths


@checked
def cable_directions(robot: Robot, pose: Pose) -> Array:
    """u_i, unit vectors from anchor point to exit point: the way each cable pulls the platform.

    robot, pose : single or batched
    Returns (…, m, d) in world axes.
    Raises InvalidInput where a cable has no length, hence no direction.

    >>> import cdprlab as cl
    >>> u = cable_directions(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))
    >>> np.allclose((u * u).sum(axis=-1), 1)
    True
    """
    return cables_at(robot, pose).directions


def have_directions(robot: Robot, pose: Pose) -> Flags:
    """(…) whether every cable has a direction.

    robot, pose : single or batched

    >>> import cdprlab as cl
    >>> have_directions(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))
    array(True)
    """
    return np.asarray(_asked(robot, pose)[0].all(axis=-1))


def why_no_direction(robot: Robot, pose: Pose) -> str:
    """The first cable that has no direction, at which pose of a batch, and why; '' where all have one.

    robot, pose : single or batched
    """
    from ..compiled.columns import ON_AXIS

    lost = np.argwhere(_asked(robot, pose)[0] == 0)
    if not lost.size:
        return ""
    *index, cable = lost[0].tolist()
    where = f"pose {index[0] if len(index) == 1 else index} of the batch" if index else "this pose"
    named = f"cable {cable + 1} has no {{}} at {where}: its anchor point is "
    if not robot.pulleys.size or not robot.pulleys[cable, 0]:
        return named.format("length") + "on its exit point, so it has no direction"
    radius, axis = robot.pulleys[cable, 0], robot.pulleys[cable, 1:]
    away = -exits_from_anchors(robot, pose)[*index, cable]
    along = away @ axis
    across = np.linalg.norm(away - along * axis)
    if across <= ON_AXIS:
        reason = "on the line that it comes along, so its pulley does not know which way to swivel"
    elif along**2 + across * (across - 2 * radius) <= 0:
        reason = f"inside the wheel of its pulley, whose radius is {radius:g} m"
    else:
        reason = "where it would wrap more than half a turn around its pulley"
    return named.format("direction") + reason


def _asked(robot: Robot, pose: Pose) -> tuple[Array, Array]:
    """l (…, m), 0 where a cable has no direction, and the whole W (…, 3 planar or 6 spatial, m)."""
    from ..compiled.columns import cables

    check_dimension(robot, pose)
    d, batch = robot.dimension, pose.batch_shape
    lengths, W = cables(robot.exit_points, robot.anchor_points, pose.position.reshape(-1, d),
                        pose.rotation.reshape(-1, d, d), robot.pulleys)
    return lengths.reshape(batch + lengths.shape[1:]), W.reshape(batch + W.shape[1:])


def check_dimension(robot: Robot, pose: Pose) -> None:
    """Raises InvalidInput unless the pose lives in the robot's dimensions."""
    if pose.dimension != robot.dimension:
        raise InvalidInput(f"a {robot.motion_pattern} robot lives in {robot.dimension} dimensions, "
                           f"the pose has {pose.dimension}")
