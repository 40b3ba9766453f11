"""Controllers: ``(t, state, reference) → wrench``, the wrench the cables shall exert on the platform at P."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .arrays import Array, as_array
from .errors import InvalidInput
from .pose import Pose, rotation_vector
from .robot import Robot
from .trajectory import Reference


class State(NamedTuple):
    """What a controller may know at one instant.

    time : [s]
    robot : the robot, for its masses and points
    position : (d,) of P in the world [m]
    rotation : (d, d)
    twist : (3 planar or 6 spatial,) [v; ω] of P in world axes [m/s, rad/s]
    tensions : (m,) measured over the last step, zero before the first [N]
    """

    time: float
    robot: Robot
    position: Array
    rotation: Array
    twist: Array
    tensions: Array

    @property
    def pose(self) -> Pose:
        """The platform's pose."""
        return Pose.of(self.position, self.rotation)


Controller = Callable[[float, State, Reference], Array]
"""W τ of the cables, weight not subtracted: at rest it is minus the gravity wrench."""


@dataclass(frozen=True, eq=False)
class ComputedTorque:
    """Computed torque: w = M (a_d + K_d ė + K_p e) + C v − f_g, e = [p_d − p; log(R_d Rᵀ)].

    kp : K_p, a number or (n,) [1/s²]
    kd : K_d, a number or (n,) [1/s]; K_d times the control period must stay below 2
    Raises InvalidInput for negative gains.
    Source: Okoli 2016, eq. (6.3)–(6.5), with the sign of f_g that (2.24) has, and the orientation included.

    >>> ComputedTorque(100, 100).kp
    array(100.)
    """

    kp: float | Array = 100.0
    kd: float | Array = 100.0

    def __post_init__(self) -> None:
        for name in ("kp", "kd"):
            gain = as_array(getattr(self, name), name, (), batch=True)
            if (gain < 0).any():
                raise InvalidInput(f"{name} must not be negative, got {gain.tolist()}")
            object.__setattr__(self, name, gain)

    def __call__(self, t: float, state: State, reference: Reference) -> Array:
        robot = state.robot
        rate, error = reference.twist - state.twist, pose_error(state, reference)
        try:
            if robot.n_dof < rate.shape[0]:
                basis = robot.pattern.basis(state.rotation)
                correction = basis @ (self.kd * (rate @ basis) + self.kp * (error @ basis))
            else:
                rate *= self.kd   # in place: this runs a thousand times a second
                error *= self.kp
                correction = rate + error
        except ValueError:
            raise InvalidInput(f"kp and kd must be numbers or {robot.n_dof} of them for a {robot.motion_pattern} "
                               f"robot, got shapes {np.shape(self.kp)} and {np.shape(self.kd)}") from None
        correction += reference.acceleration
        return inverse_dynamics(robot, state.rotation, state.twist, correction)


def pose_error(state: State, reference: Reference) -> Array:
    """[p_d − p; log(R_d Rᵀ)] in world axes.

    Returns (3 planar or 6 spatial,) [m, rad].
    """
    shift = reference.pose.position - state.position
    return np.array([*shift.tolist(), *_turn_between(reference.pose.rotation.dot(state.rotation.T))])


def inverse_dynamics(robot: Robot, rotation: Array, twist: Array, acceleration: Array) -> Array:
    """W τ = M a + C v − f_g: Newton and Euler about the center of mass, moments taken at P.

    rotation : (d, d); twist, acceleration : (3 planar or 6 spatial,) of P in world axes
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
    # Rotation in platform axes, where the inertia is constant; small vectors as plain floats, which are
    # several times quicker than arrays of three.
    spin, spin_rate = twist[3:].dot(rotation), acceleration[3:].dot(rotation)
    wx, wy, wz = spin.tolist()
    hx, hy, hz = platform.inertia.dot(spin).tolist()
    kx, ky, kz = platform.inertia.dot(spin_rate).tolist()
    moment = rotation.dot([kx + wy * hz - wz * hy, ky + wz * hx - wx * hz, kz + wx * hy - wy * hx])
    ax, ay, az = acceleration[:3].tolist()
    wrench = np.array([mass * ax, mass * ay, mass * (az + robot.gravity), *moment.tolist()])
    if platform.is_off_center:
        center = platform.center_of_mass
        swing = np.cross(spin_rate, center) + np.cross(spin, np.cross(spin, center))
        wrench[:3] += mass * (rotation @ swing)
        wrench[3:] += np.cross(rotation @ center, wrench[:3])
    return wrench if robot.n_dof == 6 else wrench @ robot.pattern.basis(rotation)


def _planar_dynamics(robot: Robot, rotation: Array, twist: Array, acceleration: Array) -> Array:
    platform = robot.platform
    x, y = rotation @ platform.center_of_mass
    force = acceleration[:2] + acceleration[2] * np.array([-y, x]) - twist[2]**2 * np.array([x, y])
    force[1] += robot.gravity
    force *= platform.mass
    wrench = np.array([*force, platform.inertia * acceleration[2] + x * force[1] - y * force[0]])
    return wrench[:robot.n_dof]


def _turn_between(turn: Array) -> list[float] | tuple[float, float, float]:
    """Rotation vector of one matrix: sin θ from its skew part, cos θ from its trace."""
    if turn.shape[0] == 2:
        return rotation_vector(turn).tolist()
    (a, b, c), (d, e, f), (g, h, i) = turn.tolist()
    x, y, z = (h - f) / 2, (c - g) / 2, (d - b) / 2
    sine, cosine = math.sqrt(x * x + y * y + z * z), (a + e + i - 1) / 2
    if cosine < -0.99:
        return rotation_vector(turn).tolist()  # near half a turn the skew part vanishes
    factor = math.atan2(sine, cosine) / sine if sine > 1e-9 else 1.0
    return x * factor, y * factor, z * factor
