"""Two commands of winches with motors: velocity control, and torque control behind their friction."""

from abc import abstractmethod
from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput, quoted
from ..mechanics.dynamics import inverse_dynamics
from ..mechanics.statics import footings
from ..mechanics.trajectory import Reference
from ..mechanics.winch import Friction
from ..robot import turned_to
from ..simulate import WOUND
from ..simulate.state import State
from ..tensions import solver_for
from ..tensions.standing import standing_tensions
from ..world import World
from .controllers import ComputedTorque
from .log import Columns
from .loop import Command
from .motors import Motors

_MARGIN = 1.5   # N: kept from the cables' limits for what friction leaves
_RESERVE = 5.0   # N m: kept from tipping


class WinchControl(Command):
    """A controller of the winches; a wish is where the platform should be as the control step begins.

    It logs the tensions it wants; ``feasible`` says whether the wanted wrench was balanced within
    the limits, and the winches reached their lengths. What its commands come to is the motors'
    affair: see `Motors`.

    standing : whether tipping rows are in the quadratic program
    toward : tension the distribution stays near, 0 for the least norm [N]
    friction : that the motors are believed to have; default: the winches' own
    """

    name: ClassVar[str]
    asks: tuple[str, ...] = ("commanded_tensions",)
    feasible: bool
    standing = True
    toward = 0.0
    friction: Friction | None = None

    @abstractmethod
    def cables(self, world: World, asked: str = "tension") -> str:
        """The engine's cable model for it: the one asked for, if it can command that."""

    def start(self, engine: Any, substeps: int) -> Columns:   # a Simulator, or what is believed of one
        robot = engine.world.robot
        self.period = engine.dt * substeps
        margin = _MARGIN if robot.winch else 0.0
        self.low, self.high = robot.tension_min + margin, robot.tension_max - margin
        self.footings = footings(robot) if self.standing else []
        self.motors, self.wanted = engine if isinstance(engine, Motors) else None, np.zeros(robot.n_cables)
        if self.motors is not None and self.friction is not None:
            self.motors.believed = replace(self.motors.believed, **self.friction._asdict())
        return super().start(engine if self.motors is None else engine.engine, substeps)

    def distribute(self, W: Array, wrench: Array) -> Array | None:
        """(m,) tensions that exert a (n,) wrench and keep the bases standing where they are now; None without any."""
        engine = self.engine
        d, m = engine.world.robot.dimension, self.low.size
        edges = [footing.rows(engine.directions, turned_to(engine.base_poses[footing.base, 2], d), engine.shifts)
                 for footing in self.footings]
        rows = np.concatenate([np.zeros((0, m)), *(edge.matrix for edge in edges)])
        offsets = np.concatenate([np.zeros(0), *(edge.offset for edge in edges)]) + _RESERVE
        tau, reason = standing_tensions(W, -wrench, self.low, self.high, rows, offsets, toward=self.toward)
        self.feasible = not reason
        return tau if self.feasible else None

    def paid(self, directions: Array) -> Array:
        """(m,) −B_b q̇_b, what driving bases draw of the cables [m/s]."""
        return (directions * self.engine.exit_velocities).sum(axis=1)

    def cut(self, cables: list[int]) -> None:
        self.low[cables] = self.high[cables] = 0.0


@checked
class TorqueControl(WinchControl):
    """Computed torque, a distribution that keeps the bases standing, and motor torques that make up for friction.

    Friction and inertia are those of the motion that is wanted, not of the one measured: their
    sign must not chatter at rest. What the gear loses is known.

    kp, kd : gains, as those of `ComputedTorque` [1/s², 1/s]
    standing : whether tipping rows are in the quadratic program
    toward : tension the distribution stays near, 0 for the least norm [N]
    friction : believed, such as `identify_friction` finds; default: the winches' own
    """

    name = "torque"

    def __init__(self, kp: float = 900.0, kd: float = 60.0, *, standing: bool = True,
                 toward: Annotated[float, "[N] ≥ 0"] = 0.0, friction: Friction | None = None) -> None:
        self.standing, self.toward = standing, toward
        self.law, self.friction = ComputedTorque(kp, kd), friction

    def cables(self, world: World, asked: str = "tension") -> str:
        if asked in WOUND:
            raise InvalidInput(f"torque control commands tension or force, not the cables' {quoted(asked)}")
        return asked

    def step(self, wish: Reference) -> tuple[Array, bool]:
        engine, W = self.engine, self.engine.wrench_matrix
        state = State(0.0, engine.carrying, engine.position, engine.rotation, engine.twist,
                      engine.tensions)
        wrench = self.law(state.time, state, wish)
        found = self.distribute(W, wrench)
        tau = solver_for("relaxed", len(W), self.low, self.high)(W, -wrench)[0] if found is None else found
        if self.motors is None:
            engine.pull(tau, self.substeps)
        else:
            W = engine.carrying.pattern.basis(engine.rotation) @ W
            wanted = self.paid(engine.directions) - wish.twist @ W, -wish.acceleration @ W
            self.motors.pull(tau, self.substeps, wanted)
        return tau, self.feasible


@checked
class VelocityControl(WinchControl):
    """Winch speeds l̇ = J t − B_b q̇_b of the wanted motion, and what of the wanted lengths is missing.

    Ropes stretch: they are wound shorter by what the wanted tensions stretch them, or some of
    them would hang slack.

    gain : of the length error [1/s]
    Source: Pedemonte et al. 2020, section 2.3; B_b q̇_b, which `base_jacobian` gives, is read
    off the exit points.
    """

    name = "velocity"
    asks = ("commanded_tensions", "commanded_lengths")

    def __init__(self, gain: Annotated[float, "[1/s] ≥ 0"] = 20.0) -> None:
        self.gain = gain

    def cables(self, world: World, asked: str = "tension") -> str:
        return asked if asked in WOUND else "length" if world.robot.elasticity is None else "elastic"

    def wound(self, wish: Reference) -> Array:
        """(m,) rope let out where what holds platform and load as they should be stretches it [m]."""
        engine = self.engine
        self.there = _, lengths, W = engine.cables_at(wish.pose)
        found = self.distribute(W, inverse_dynamics(engine.carrying, wish.pose.rotation, wish.twist,
                                                    wish.acceleration))
        if found is not None:
            self.wanted = found
        elastic = engine.world.robot.elasticity if engine.cables == "elastic" else None
        return lengths if elastic is None else elastic.unstrained(lengths, self.wanted)

    def step(self, wish: Reference) -> tuple[Array, bool]:
        engine: Any = self.engine
        ropes, wanted = engine.rope_lengths, self.wound(wish)
        directions, before, _ = self.there
        # J t as it is on the mean over the step: lengths that no pose has would strain redundant ropes.
        way = wish.twist * self.period + wish.acceleration * self.period**2 / 2
        after = engine.cables_at(wish.pose.displaced(way)).lengths
        rates = (after - before) / self.period + self.paid(directions) + self.gain * (wanted - ropes)
        fastest = engine.world.robot.speed_max
        kept = rates.clip(-fastest, fastest)
        wound = ropes + kept * self.period
        reached = (self.motors or engine).bring(wound, self.substeps) and (kept == rates).all()
        self.feasible = bool(reached) and self.feasible
        return np.concatenate([self.wanted, wound]), self.feasible


def winch_control(control: str | WinchControl) -> WinchControl:
    """The controller of that name, "torque" or "velocity", or the one given."""
    if isinstance(control, WinchControl):
        return control
    known = {"torque": TorqueControl, "velocity": VelocityControl}
    if control not in known:
        raise InvalidInput(f"control must be {' or '.join(map(repr, known))}, or a WinchControl, got {quoted(control)}")
    return known[control]()
