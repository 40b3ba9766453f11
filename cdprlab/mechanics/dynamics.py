"""Newton and Euler for the platform: the wrench that a motion takes, the motion that a wrench gives."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..robot import Robot
from ..robot.pose import cross_matrix


def inverse_dynamics(robot: Robot, rotation: Array, twist: Array, acceleration: Array, *,
                     every_row: bool = False) -> Array:
    """W τ = M a + C v − f_g: Newton and Euler about the center of mass, moments taken at P.

    rotation : (d, d); twist, acceleration : (3 planar or 6 spatial,) of P in world axes
    every_row : all rows of the motion, not only those the motion pattern controls
    Returns (n,) wrench the cables must exert [N, N m].
    Source: Okoli 2016, eq. (2.17)–(2.19), extended to a center of mass off P.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> inverse_dynamics(robot, np.eye(3), np.zeros(6), np.zeros(6))[2]
    np.float64(1471.5)
    """
    if robot.dimension == 2:
        return _planar_dynamics(robot, rotation, twist, acceleration)
    platform, mass = robot.platform, robot.platform.mass
    # Turning in platform axes, where the inertia is constant.
    spin, spin_rate = twist[3:] @ rotation, acceleration[3:] @ rotation
    moment = platform.inertia @ spin_rate + np.cross(spin, platform.inertia @ spin)
    center = platform.center_of_mass
    swing = np.cross(spin_rate, center) + np.cross(spin, np.cross(spin, center))
    force = mass * (acceleration[:3] + [0, 0, robot.gravity] + rotation @ swing)
    wrench = np.concatenate([force, rotation @ moment + np.cross(rotation @ center, force)])
    return wrench if every_row or robot.n_dof == 6 else wrench @ robot.pattern.basis(rotation)


def mobility(robot: Robot, rotation: Array, *, every_row: bool = False) -> Array:
    """M⁻¹ in the motion pattern's rows: dv/dt = M⁻¹ w for a wrench w at P of a spatial platform at rest.

    rotation : (3, 3)
    every_row : all six rows
    Returns (n, n) [1/kg, 1/(kg m), 1/(kg m²)].

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> bool(np.isclose(mobility(robot, np.eye(3))[2, 2], 1 / 150))
    True
    """
    body = robot.platform
    arm = cross_matrix(rotation @ body.center_of_mass)
    turning = rotation @ np.linalg.inv(body.inertia) @ rotation.T
    # A force at P is the same force at the center of mass and a moment −(R c) × f about it.
    full = np.block([[np.eye(3) / body.mass - arm @ turning @ arm, arm @ turning], [-turning @ arm, turning]])
    if every_row or robot.n_dof == 6:
        return full
    basis = robot.pattern.basis(rotation)
    return basis.T @ full @ basis


def _planar_dynamics(robot: Robot, rotation: Array, twist: Array, acceleration: Array) -> Array:
    platform = robot.platform
    x, y = rotation @ platform.center_of_mass
    force = acceleration[:2] + acceleration[2] * np.array([-y, x]) - twist[2]**2 * np.array([x, y])
    force[1] += robot.gravity
    force *= platform.mass
    wrench = np.array([*force, platform.inertia * acceleration[2] + x * force[1] - y * force[0]])
    return wrench[:robot.n_dof]
