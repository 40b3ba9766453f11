"""Controllers: ``(t, state, reference) → wrench``, the wrench the cables shall exert on the platform at P."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..arrays import Array, as_array, checked, lasting
from ..errors import InvalidInput
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..simulate.state import State

Controller = Callable[[float, State, Reference], Array]
"""W τ of the cables, weight not subtracted: at rest it is minus the gravity wrench."""


@lasting
@checked
@dataclass(frozen=True, eq=False)
class ComputedTorque:
    """Computed torque: w = M a + C v − f_g with the a that makes ë + K_d ė + K_p e = 0, e = [p_d − p; log(R_d Rᵀ)].

    a = a_d + K_d ė + K_p e along the axes; about them ė = J_l⁻¹(e) (ω_d − R_d Rᵀ ω), and a is
    what makes the law hold about each, however the reference turns and spins.

    kp : K_p, a number or (n,) [1/s²]
    kd : K_d, a number or (n,) [1/s]; K_d times the control period must stay below 2
    Raises InvalidInput for negative gains.
    Source: Okoli 2016, eq. (6.3)–(6.5), with the sign of f_g that (2.24) has, and the
    orientation included.

    >>> ComputedTorque(100, 100).kp
    array(100.)
    """

    kp: float | Array = 100.0
    kd: float | Array = 100.0
    _in_world: dict[str, tuple[Array, Array]] = field(default_factory=dict, init=False,
                                                      repr=False)

    def __post_init__(self) -> None:
        for name in ("kp", "kd"):
            gain = as_array(getattr(self, name), name, (), batch=True)
            if (gain < 0).any():
                raise InvalidInput(f"{name} must not be negative, got {gain.tolist()}")
            object.__setattr__(self, name, gain)

    @cached_property
    def _law(self) -> Callable[..., Array]:   # looked up once: an import in the loop takes 1 % of it
        from ..compiled.control import computed_torque

        return computed_torque

    def __call__(self, t: float, state: State, reference: Reference) -> Array:
        robot, body, wanted = state.robot, state.robot.platform, reference.pose
        wrench = self._law(*self._gains(robot, state.rotation), body.mass,
                           np.atleast_2d(body.inertia),
                           body.center_of_mass, robot.gravity, state.position, state.rotation,
                           state.twist,
                           wanted.position, wanted.rotation, reference.twist,
                           reference.acceleration)
        return wrench if robot.n_dof == 6 else wrench @ robot.pattern.basis(state.rotation)

    def _gains(self, robot: Robot, rotation: Array) -> tuple[Array, Array]:
        """S diag(K) Sᵀ for both: gains of the motion pattern's rows in world axes, with which a platform may turn."""
        if robot.motion_pattern not in self._in_world or robot.motion_pattern == "2R3T":
            if not {np.shape(self.kp), np.shape(self.kd)} <= {(), (robot.n_dof,)}:
                raise InvalidInput(f"kp and kd must be numbers or {robot.n_dof} of them for a {robot.motion_pattern} "
                                   f"robot, got shapes {np.shape(self.kp)} and {np.shape(self.kd)}")
            S = robot.pattern.basis(rotation)
            self._in_world[robot.motion_pattern] = (self.kp * S) @ S.T, (self.kd * S) @ S.T
        return self._in_world[robot.motion_pattern]
