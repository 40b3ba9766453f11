"""Controllers: ``(t, state, reference) → wrench``, the wrench the cables shall exert on the platform at P."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..mechanics.dynamics import inverse_dynamics
from ..mechanics.fast_control import applies_to, computed_torque
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..robot.pose import rotation_vector
from ..simulate.state import State

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
