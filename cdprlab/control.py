"""Controllers: ``(t, state, reference) → wrench``, the wrench the cables shall exert on the platform at P."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .arrays import Array, as_array
from .errors import InvalidInput
from .fast_control import applies_to, computed_torque
from .pose import cross_matrix, rotation_vector
from .robot import Robot
from .state import State
from .trajectory import Reference

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
    _six_gains: tuple[list[float], list[float]] | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("kp", "kd"):
            gain = as_array(getattr(self, name), name, (), batch=True)
            if (gain < 0).any():
                raise InvalidInput(f"{name} must not be negative, got {gain.tolist()}")
            object.__setattr__(self, name, gain)
        six = all(np.shape(gain) in ((), (6,)) for gain in (self.kp, self.kd))
        gains = (np.broadcast_to(self.kp, 6).tolist(), np.broadcast_to(self.kd, 6).tolist()) if six else None
        object.__setattr__(self, "_six_gains", gains)

    def __call__(self, t: float, state: State, reference: Reference) -> Array:
        robot = state.robot
        if self._six_gains is not None and applies_to(robot):
            wrench = computed_torque(*self._six_gains, state, reference)
            if wrench is not None:
                return wrench
        return self._wrench(robot, state, reference)

    def _wrench(self, robot: Robot, state: State, reference: Reference) -> Array:
        basis = robot.pattern.basis(state.rotation)
        rate, error = (reference.twist - state.twist) @ basis, pose_error(state, reference) @ basis
        try:
            correction = basis @ (self.kd * rate + self.kp * error)
        except ValueError:
            raise InvalidInput(f"kp and kd must be numbers or {robot.n_dof} of them for a {robot.motion_pattern} "
                               f"robot, got shapes {np.shape(self.kp)} and {np.shape(self.kd)}") from None
        return inverse_dynamics(robot, state.rotation, state.twist, reference.acceleration + correction)


def pose_error(state: State, reference: Reference) -> Array:
    """[p_d − p; log(R_d Rᵀ)] in world axes.

    Returns (3 planar or 6 spatial,) [m, rad].
    """
    turn = rotation_vector(reference.pose.rotation @ state.rotation.T)
    return np.concatenate([reference.pose.position - state.position, turn])


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
