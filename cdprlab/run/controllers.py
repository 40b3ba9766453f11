"""Controllers: ``(t, state, reference) → wrench``, the wrench the cables shall exert on the platform at P."""

from collections.abc import Callable
from dataclasses import field
from typing import Annotated, Any

import numpy as np

from ..arrays import Array, frozen_dataclass
from ..errors import InvalidInput
from ..mechanics.cables import cables_at
from ..mechanics.dynamics import inverse_dynamics, pose_error
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..robot.pose import Pose
from ..simulate.state import State

Controller = Callable[[float, State, Reference], Array]
"""W τ of the cables, weight not subtracted: at rest it is minus the gravity wrench."""

Gain = Annotated[float | Array, "(…) ≥ 0"]


@frozen_dataclass
class ComputedTorque:
    """Computed torque: w = M a + C v − f_g with the a that makes ë + K_d ė + K_p e + K_i ∫e dt = 0.

    e = [p_d − p; log(R_d Rᵀ)]. Along the axes a = a_d + K_d ė + K_p e + K_i ∫e dt; about them
    ė = J_l⁻¹(e) (ω_d − R_d Rᵀ ω), and a is what makes the law hold about each, however the
    reference turns and spins.

    kp : K_p, a number or (n,) [1/s²]
    kd : K_d, a number or (n,) [1/s]; K_d times the control period must stay below 2
    ki : K_i, a number or (n,), below K_p K_d; the integral begins anew where time does [1/s³]
    Raises InvalidInput for negative gains.
    Source: Okoli 2016, eq. (6.3)–(6.5), with the sign of f_g that (2.24) has, and the
    orientation included.

    >>> ComputedTorque(100, 100).kp
    array(100.)
    """

    kp: Gain = 100.0
    kd: Gain = 100.0
    ki: Gain = 0.0
    _known: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    def __call__(self, t: float, state: State, reference: Reference) -> Array:
        robot, wanted = state.robot, reference.pose
        made, body = self._known.get(robot.motion_pattern, (None, None))
        if body is not robot.platform or robot.motion_pattern == "2R3T":
            made, body = self._known[robot.motion_pattern] = self._law(robot, state.rotation), robot.platform
        law, K_p, K_d, K_i, integrates, inertia = made
        z = K_i @ self._integrated(t, state, wanted) if integrates else K_i[0]
        wrench = law(K_p, K_d, z, body.mass, inertia, body.center_of_mass, robot.gravity,
                     state.position, state.rotation, state.twist, wanted.position, wanted.rotation,
                     reference.twist, reference.acceleration)
        return wrench if robot.n_dof == 6 else wrench @ robot.pattern.basis(state.rotation)

    def _integrated(self, t: float, state: State, wanted: Pose) -> Array:
        """∫e dt until now; a time before the last one begins a new one."""
        error = pose_error(state.pose, wanted)
        before, total = self._known.get("integral", (np.inf, 0.0))
        total = total + (t - before) * error if t >= before else np.zeros_like(error)
        self._known["integral"] = t, total
        return total

    def _law(self, robot: Robot, rotation: Array) -> tuple[Any, ...]:
        """The law; S K Sᵀ, gains in world axes, with which a platform may turn; whether K_i is any; and the inertia."""
        from ..compiled.control import computed_torque  # not in every step: it takes 1 % of it

        gains = self.kp, self.kd, self.ki
        if not set(map(np.shape, gains)) <= {(), (robot.n_dof,)}:
            raise InvalidInput(f"kp, kd and ki must be numbers or {robot.n_dof} of them for a "
                               f"{robot.motion_pattern} robot, got shapes {[*map(np.shape, gains)]}")
        S = robot.pattern.basis(rotation)
        turning = ((gain * S) @ S.T for gain in gains)
        return computed_torque, *turning, np.any(self.ki), np.atleast_2d(robot.platform.inertia)


@frozen_dataclass
class LengthControl:
    """Joint space: w = M (a_d + J⁺ (k_d (l̇_d − l̇) + k_p (l_d − l))) + h with M, J and h at the reference's pose.

    l are the measured lengths, l̇ = J t the rates of the observed twist: no pose is asked for.

    kp, kd : k_p [1/s²] and k_d [1/s], numbers or (m,)
    Raises InvalidInput for negative gains.
    Source: Okoli 2016, sec. 6.1.

    >>> LengthControl(100, 20).kd
    array(20.)
    """

    kp: Gain = 100.0
    kd: Gain = 20.0

    def __call__(self, t: float, state: State, reference: Reference) -> Array:
        robot, pose = state.robot, reference.pose
        _, wanted, W = cables_at(robot, pose)
        if not {np.shape(self.kp), np.shape(self.kd)} <= {(), (robot.n_cables,)}:
            raise InvalidInput(f"kp and kd must be numbers or {robot.n_cables} of them, a cable one, "
                               f"got shapes {np.shape(self.kp)} and {np.shape(self.kd)}")
        S = robot.pattern.basis(pose.rotation)
        rates = -(reference.twist - state.twist) @ S @ W
        missing = self.kd * rates + self.kp * (wanted - state.lengths)
        acceleration = reference.acceleration + S @ np.linalg.lstsq(-W.T, missing)[0]
        return inverse_dynamics(robot, pose.rotation, reference.twist, acceleration)


def described(controller: Any) -> str:
    """A controller in words: its name, and its gains if it has such.

    >>> described(LengthControl(100, 20))
    'LengthControl(kp=100.0, kd=20.0)'
    """
    name = getattr(controller, "__name__", type(controller).__name__)
    if isinstance(controller, ComputedTorque | LengthControl):
        gains = [key for key in ("kp", "kd", "ki") if hasattr(controller, key)]
        name += f"({', '.join(f'{key}={getattr(controller, key).tolist()}' for key in gains)})"
    return str(name)
