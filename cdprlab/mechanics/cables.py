"""Cables at a pose: vectors, directions, lengths (inverse kinematics of positions) and the columns they give W."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose


class Cables(NamedTuple):
    """What there is to know of a robot's cables at a pose.

    directions : (…, m, d) u, unit vectors from anchor point to exit point, in world axes
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
    length.

    >>> import cdprlab as cl
    >>> directions, lengths, W = cables_at(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))
    >>> directions.shape, lengths.shape, W.shape
    ((8, 3), (8,), (6, 8))
    """
    lengths, W = _lengths_and_wrenches(robot, pose)
    if not lengths.all():
        cable = int(np.argwhere(lengths == 0)[0][-1]) + 1
        raise InvalidInput(f"cable {cable} has no length at this pose: its anchor point is on its exit point, "
                           "so it has no direction")
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


@checked
def cable_vectors(robot: Robot, pose: Pose) -> Array:
    """From anchor point to exit point: A_i − (p + R b_i).

    robot, pose : single or batched
    Returns (…, m, d) in world axes [m].
    Source: Okoli 2016, eq. (2.4) with the cable running from B_i to A_i.

    >>> import cdprlab as cl
    >>> cable_vectors(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))[0]
    array([-4.1, -1.7,  2.7])
    """
    return robot.exit_points - (pose.position[..., None, :] + anchor_offsets(robot, pose))


@checked
def cable_lengths(robot: Robot, pose: Pose) -> Array:
    """l_i = ‖A_i − (p + R b_i)‖, inverse kinematics.

    robot, pose : single or batched
    Returns (…, m) [m].

    >>> import cdprlab as cl
    >>> cable_lengths(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).round(3)[:2]
    array([5.195, 4.358])
    """
    return _lengths_and_wrenches(robot, pose)[0]


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


def _lengths_and_wrenches(robot: Robot, pose: Pose) -> tuple[Array, Array]:
    """l (…, m) and the whole W (…, 3 planar or 6 spatial, m)."""
    from ..compiled.columns import cables

    check_dimension(robot, pose)
    d, batch = robot.dimension, pose.batch_shape
    lengths, W = cables(robot.exit_points, robot.anchor_points, pose.position.reshape(-1, d),
                        pose.rotation.reshape(-1, d, d))
    return lengths.reshape(batch + lengths.shape[1:]), W.reshape(batch + W.shape[1:])


def check_dimension(robot: Robot, pose: Pose) -> None:
    """Raises InvalidInput unless the pose lives in the robot's dimensions."""
    if pose.dimension != robot.dimension:
        raise InvalidInput(f"a {robot.motion_pattern} robot lives in {robot.dimension} dimensions, "
                           f"the pose has {pose.dimension}")
