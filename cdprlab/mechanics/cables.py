"""Cable vectors, directions and lengths: inverse kinematics of positions."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose


def anchor_offsets(robot: Robot, pose: Pose) -> Array:
    """r_i = R b_i, from the reference point P to each anchor point, in world axes.

    robot, pose : single or batched
    Returns (…, m, d) [m].
    Raises InvalidInput when robot and pose have different dimensions.

    >>> import cdprlab as cl
    >>> anchor_offsets(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).shape
    (8, 3)
    """
    if pose.dimension != robot.dimension:
        raise InvalidInput(f"a {robot.motion_pattern} robot lives in {robot.dimension} dimensions, "
                           f"the pose has {pose.dimension}")
    return robot.anchor_points @ np.swapaxes(pose.rotation, -1, -2)


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


def cable_lengths(robot: Robot, pose: Pose) -> Array:
    """l_i = ‖A_i − (p + R b_i)‖, inverse kinematics.

    robot, pose : single or batched
    Returns (…, m) [m].

    >>> import cdprlab as cl
    >>> cable_lengths(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).round(3)[:2]
    array([5.195, 4.358])
    """
    return np.linalg.norm(cable_vectors(robot, pose), axis=-1)


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
    vectors = cable_vectors(robot, pose)
    return vectors / _checked_lengths(vectors)[..., None]


def _checked_lengths(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=-1)
    if not lengths.all():
        cable = int(np.argwhere(lengths == 0)[0][-1]) + 1
        raise InvalidInput(f"cable {cable} has no length at this pose: its anchor point is on its exit point, "
                           "so it has no direction")
    return lengths
