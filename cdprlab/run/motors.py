"""Motors between what is commanded and what the cables do: torque, speed, friction and inertia of the winches."""

from typing import Any

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput, WinchOverrun
from ..mechanics.dynamics import mass_and_bias
from ..mechanics.winch import (
    Friction,
    cable_tensions,
    friction_features,
    friction_torque,
    gear_torque,
    motor_damping,
    motor_speed,
    motor_torque,
)
from ..robot import Winch
from ..robot.pose import Pose
from ..simulate import Simulator
from ..simulate.state import State
from .log import Columns
from .record import Run

_OVER = 1.05
"""Of its largest speed: a motor that the load turns faster is lost."""


class Motors:
    """An engine behind the motors of its winches; all else that is asked of it, the engine answers.

    engine : as those who command it see it; body : the Simulator itself
    believed : the winch whose friction and gear the loop makes up for, None: no losses are known
    period : control step [s]
    """

    def __init__(self, engine: Any, body: Simulator, believed: Winch | None, period: float) -> None:
        winch = body.world.robot.winch
        assert winch is not None
        self.engine, self.body, self.winch, self.period = engine, body, winch, period
        self.believed = believed or Winch(winch.drum_radius, winch.gear_ratio)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.engine, name)

    def reset(self, pose: Pose | None = None) -> State:
        """As the engine does."""
        m = self.body.world.robot.n_cables
        self._given, self._rates = np.zeros(3 * m + 1), np.zeros(m)
        self._matrix: Array | None = None
        self._asked: Array | None = None
        return self.engine.reset(pose)

    def pull(self, tensions: Array, substeps: int, wanted: tuple[Array, Array] | None = None) -> None:
        """What the motors make of these (m,) tensions [N].

        wanted : (m,) l̇ and l̈ at which friction and inertia are made up for [m/s, m/s²]; default:
            friction at the present speed
        """
        body, winch, believed = self.body, self.winch, self.believed
        rates, W = cable_rates(body)
        mass, bias = mass_and_bias(body.carrying, body.rotation, body.twist)
        lightness = np.linalg.inv(mass)
        # l̈ = l̈₀ − A τ, and how the cables turn: −Ẇᵀ t
        loose = lightness @ (bias - (0.0 if body.pushed is None else body.pushed)) @ W
        if self._matrix is not None:
            loose = loose - body.twist @ (W - self._matrix) / self.period
        self._matrix = W
        speed, known = motor_speed(winch, rates), motor_speed(believed, rates)
        self._watch(speed)
        damping: Any = 0.0   # of what nobody makes up for
        if wanted is not None:
            lost, damping = motor_torque(believed, 0.0, *wanted), motor_damping(winch, 0.0, speed)
        else:
            lost = friction_torque(believed, known)
            if believed != winch:
                damping = np.maximum(motor_damping(winch, tensions, speed)
                                     - motor_damping(believed, tensions, known), 0.0)
        asked = gear_torque(believed, tensions, known) + lost
        pulled, torques = cable_tensions(winch, asked, rates, loose, W.T @ lightness @ W, self.period, damping)
        self._keep(pulled, torques, speed, asked - torques)
        self.engine.pull(pulled, substeps)

    def bring(self, lengths: Array, substeps: int) -> bool:
        """Rope lengths as far as the motors can bring them: a rope that pulls harder slips."""
        winch, body, turned = self.winch, self.body, self._rates
        self._watch(motor_speed(winch, cable_rates(body)[0]))
        if self._asked is not None:   # it begins at rest
            self._rates = (lengths - self._asked) / self.period
        self._asked = lengths
        turning, speed = (self._rates - turned) / self.period, motor_speed(winch, turned)
        idle = motor_torque(winch, 0.0, turned, turning)
        lever = gear_torque(winch, 1.0, speed)
        body.strongest = ((winch.torque - idle) / lever).clip(0.0, winch.torque * winch.transmission)
        reached: bool = self.engine.bring(lengths, substeps)
        self._keep(body.tensions, idle + lever * body.tensions, speed, body.slipping)
        return reached

    def columns(self) -> Columns:
        """Those of the engine, and what the motors gave over the last step; `short` is the first cable for which it
        was less than wanted, from 1, or 0."""
        m = self.body.world.robot.n_cables
        return {**self.engine.columns(), "driven_tensions": ((m,), "N"), "driven_torques": ((m,), "N m"),
                "driven_speeds": ((m,), "rad/s"), "short": ((), "")}

    def sample(self) -> Array:
        """The engine's, and what the motors gave."""
        return np.concatenate([self.engine.sample(), self._given])

    def _keep(self, tensions: Array, torques: Array, speed: Array, missing: Any) -> None:
        short = np.abs(missing) > 1e-9 * (1 + np.abs(torques))
        self._given = np.concatenate([tensions, torques, speed, [1 + short.argmax() if short.any() else 0]])

    def _watch(self, speed: Array) -> None:
        """Raises WinchOverrun where a load turns a motor faster than it can turn."""
        over = (np.abs(speed) > _OVER * self.winch.speed) & (self.body.tensions > 0)
        if over.any():
            cable, now = int(over.argmax()) + 1, self.body.time
            raise WinchOverrun(f"at t = {now:.4g} s the load turns the motor of cable {cable} at "
                               f"{abs(speed[cable - 1]):.4g} rad/s, its most are {self.winch.speed:g} rad/s, and "
                               f"{self.winch.torque:g} N m do not hold it", now, cable)


@checked
def identify_friction(run: Run) -> tuple[Friction, float]:
    """Friction and inertia that explain what motors gave: least squares of τ − gear_torque(t, q̇) = I q̈ + f(q̇).

    run : of a robot with a winch, moving slowly and quickly; all its winches are alike
    Returns Friction, and the inertia [kg m²].
    Raises InvalidInput for a run without motors.

    >>> import cdprlab as cl
    >>> run = cl.run(cl.load_world("fastkit_suspended"), duration=2.0)
    >>> friction, inertia = cl.identify_friction(run)
    >>> round(friction.coulomb, 3), round(friction.viscous, 5)
    (0.02, 0.0002)
    """
    winch = (run.real or run.world).robot.winch
    if run.motor_torques is None or run.motor_speeds is None or winch is None:
        raise InvalidInput("nothing is known of motors: fly a world with a `winch:` block, and winch=\"real\"")
    speed = run.motor_speeds[:-1]
    inert = np.diff(run.motor_speeds, axis=0) / run.control_period
    lost = run.motor_torques[:-1] - gear_torque(winch, run.measured_tensions[:-1], speed)
    matrix = np.stack([*friction_features(speed), inert], axis=-1).reshape(-1, 4)
    static, coulomb, viscous, inertia = np.linalg.lstsq(matrix, lost.ravel())[0].tolist()
    return Friction(static, coulomb, viscous), inertia


def cable_rates(engine: Simulator) -> tuple[Array, Array]:
    """l̇ (m,) now [m/s], and W in all rows that the motion pattern controls."""
    W = engine.carrying.pattern.basis(engine.rotation) @ engine.wrench_matrix
    return engine.drawn - engine.twist @ W, W
