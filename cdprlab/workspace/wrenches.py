"""Wrench matrices of whole sweeps, where they would cost more than what is asked of them."""

from __future__ import annotations

from ..arrays import Array
from ..mechanics.statics import wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from ..tensions.feasible_polygon import plain


def wrench_matrices(robot: Robot, poses: Pose) -> Array:
    """`wrench_matrix` of a batch (N,) of poses: (N, n, m).

    >>> import cdprlab as cl
    >>> robot, poses = cl.load_world("caroca").robot, cl.Pose([[0, 0, 1], [1, 0, 2]], rpy=[0.1, 0.2, 0.3])
    >>> bool(abs(wrench_matrices(robot, poses) - cl.wrench_matrix(robot, poses)).max() < 1e-14)
    True
    """
    if robot.motion_pattern == "2R3T" or len(poses.batch_shape) != 1 or poses.dimension != robot.dimension:
        return wrench_matrix(robot, poses)
    from ..compiled.columns import columns

    W, whole = columns(plain(robot.exit_points), plain(robot.anchor_points), plain(poses.position),
                       plain(poses.rotation), robot.n_dof)
    return W if whole else wrench_matrix(robot, poses)   # which says which cable has no length
