"""Newton and Euler for the platform: the wrench that a motion takes, and how far a pose is from the one wanted."""

import numpy as np

from ..arrays import Array
from ..robot import Robot
from ..robot.pose import Pose
from .cables import check_dimension


def mass_and_bias(robot: Robot, rotation: Array, twist: Array) -> tuple[Array, Array]:
    """M and h of W τ = M a + h, whatever the motion pattern controls: C v and the weight are in h.

    rotation : (d, d); twist : (3 planar or 6 spatial,) of P in world axes
    Returns (n, n) and (n,), n = 3 planar or 6 spatial [kg, kg m, kg m²; N, N m].
    Source: Okoli 2016, eq. (2.17)–(2.19), extended to a center of mass off P.

    >>> import cdprlab as cl
    >>> M, h = mass_and_bias(cl.load_world("caroca").robot, np.eye(3), np.zeros(6))
    >>> M[0, 0], h[2]
    (np.float64(150.0), np.float64(1471.5))
    """
    from ..compiled import control

    body = robot.platform
    return control.mass_and_bias(body.mass, np.atleast_2d(body.inertia), body.center_of_mass,
                                 robot.gravity, rotation,
                                 twist)


def mass_matrix(robot: Robot, pose: Pose) -> Array:
    """M in the motion pattern's rows: with a twist t the platform's kinetic energy is ½ t · M t.

    robot, pose : single or batched
    Returns (…, n, n) [kg, kg m, kg m²].

    >>> import cdprlab as cl
    >>> mass_matrix(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).diagonal()
    array([150. , 150. , 150. ,   6.5,  20. ,  22.5])
    """
    check_dimension(robot, pose)
    d = robot.dimension
    rest = np.zeros(3 * (d - 1))
    rotations = pose.rotation.reshape(-1, d, d)
    M = np.array([mass_and_bias(robot, R, rest)[0] for R in rotations]).reshape(*pose.batch_shape, rest.size, rest.size)
    S = robot.pattern.basis(pose.rotation)
    return np.swapaxes(S, -1, -2) @ M @ S


def inverse_dynamics(robot: Robot, rotation: Array, twist: Array, acceleration: Array) -> Array:
    """W τ = M a + h, in the motion pattern's rows.

    rotation : (d, d); twist, acceleration : (3 planar or 6 spatial,) of P in world axes
    Returns (n,) wrench the cables must exert [N, N m].

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> inverse_dynamics(robot, np.eye(3), np.zeros(6), np.zeros(6))[2]
    np.float64(1471.5)
    """
    M, h = mass_and_bias(robot, rotation, twist)
    return (M @ acceleration + h) @ robot.pattern.basis(rotation)


def pose_error(pose: Pose, wanted: Pose) -> Array:
    """e = [p_d − p; log(R_d Rᵀ)] in world axes.

    pose, wanted : single, or batches of one shape
    Returns (…, 3 planar or 6 spatial) [m, rad].

    >>> pose_error(Pose([0, 0], angle=0.1), Pose([1, 0], angle=0.3)).round(6)
    array([1. , 0. , 0.2])
    """
    from ..compiled.control import pose_errors

    d = pose.dimension
    errors = pose_errors(pose.position.reshape(-1, d), pose.rotation.reshape(-1, d, d),
                         wanted.position.reshape(-1, d), wanted.rotation.reshape(-1, d, d))
    return errors.reshape(pose.batch_shape + errors.shape[1:])
