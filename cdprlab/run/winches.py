"""Two commands of winches with motors: velocity control, and torque control behind their friction."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput, quoted
from ..mechanics.dynamics import mass_and_bias
from ..mechanics.statics import footings
from ..mechanics.trajectory import Reference
from ..mechanics.winch import (
    Friction,
    cable_tensions,
    gear_torque,
    motor_damping,
    motor_speed,
    motor_torque,
)
from ..robot import Robot, turned_to
from ..simulate.spatial import SpatialSimulator
from ..simulate.state import State
from ..tensions import solver_for
from ..tensions.standing import standing_tensions
from .controllers import ComputedTorque
from .log import Columns
from .loop import Command
from .motors import motion


class WinchControl(Command):
    """A controller of the winches; a wish is where the platform should be as the control step begins.

    ``cables`` is the engine's cable model it needs. It logs the tensions it wants and what the
    motors do for them; ``feasible`` says whether the wanted wrench was balanced within the
    limits, or the winches reached their lengths.

    margin : kept from the cables' limits [N]; reserve : kept from tipping [N m]
    standing : whether tipping rows are in the quadratic program
    toward : tension the distribution stays near, 0 for the least norm [N]
    """

    name: ClassVar[str]
    cables: ClassVar[str]
    engine: SpatialSimulator
    feasible: bool

    def __init__(self, margin: float, reserve: float, standing: bool = True,
                 toward: float = 0.0) -> None:
        self.margin, self.reserve = float(margin), float(reserve)
        self.standing, self.toward = standing, float(toward)

    def start(self, engine: Any, substeps: int) -> Columns:   # a Simulator, or what is believed of one
        robot = engine.world.robot
        if robot.winch is None:
            raise InvalidInput("winches are to be controlled, but the world has no `winch:` block")
        self.winch, self.period = robot.winch, engine.dt * substeps
        self.low, self.high = robot.tension_min + self.margin, robot.tension_max - self.margin
        self.footings = footings(robot) if self.standing else []
        return super().start(engine, substeps)

    def columns(self, robot: Robot) -> Columns:
        m = robot.n_cables
        return {"commanded_tensions": ((m,), "N"), "motor_torques": ((m,), "N m"),
                "motor_speeds": ((m,), "rad/s"), "feasible": ((), "")}

    def effort(self, tensions: Array, torques: Array, rates: Array) -> Iterable[float]:
        """What `step` returns; rates : (m,) of the cables, positive paying out [m/s]."""
        speeds = motor_speed(self.winch, rates)
        return *tensions.tolist(), *torques.tolist(), *speeds.tolist(), self.feasible

    def distribute(self, W: Array, wrench: Array) -> Array | None:
        """(m,) tensions that exert a (n,) wrench and keep the bases standing where they are now; None without any."""
        engine = self.engine
        rows, offsets = [np.zeros((0, engine.tensions.size))], [np.zeros(0)]
        for footing in self.footings:
            edges = footing.rows(engine.directions,
                                 turned_to(engine.base_poses[footing.base, 2], 3), engine.shifts)
            rows.append(edges.matrix)
            offsets.append(edges.offset + self.reserve)
        tau, reason = standing_tensions(W, -wrench, self.low, self.high, np.concatenate(rows),
                                        np.concatenate(offsets), toward=self.toward)
        return None if reason else tau


@checked
class TorqueControl(WinchControl):
    """Computed torque, a distribution that keeps the bases standing, and motor torques that make up for friction.

    kp, kd : gains, as those of `ComputedTorque` [1/s², 1/s]
    standing : whether tipping rows are in the quadratic program
    toward : tension the distribution stays near, 0 for the least norm [N]
    margin : kept from the cables' limits, for what friction leaves [N]
    reserve : kept from tipping [N m]
    friction : believed, such as `identify_friction` finds; default: the winches' own
    """

    name, cables = "torque", "tension"

    def __init__(self, kp: float = 900.0, kd: float = 60.0, *, standing: bool = True,
                 toward: float = 0.0, margin: float = 1.5, reserve: float = 5.0,
                 friction: Friction | None = None) -> None:
        super().__init__(margin, reserve, standing, toward)
        self.law, self.friction = ComputedTorque(kp, kd), friction

    def start(self, engine: Any, substeps: int) -> Columns:   # a Simulator, or what is believed of one
        asked = super().start(engine, substeps)
        self.relaxed = solver_for("relaxed", engine.world.robot.n_dof, self.low, self.high)
        self.believed = self.winch if self.friction is None else replace(self.winch, **self.friction._asdict())
        return asked

    def step(self, wish: Reference) -> Iterable[float]:
        engine, W = self.engine, self.engine.wrench_matrix
        state = State(0.0, engine.carrying, engine.position, engine.rotation, engine.twist,
                      engine.tensions)
        wrench = self.law(state.time, state, wish)
        found = self.distribute(W, wrench)
        self.feasible = found is not None
        tau = self.relaxed(W, -wrench)[0] if found is None else found
        rates, loose, yielding, _ = motion(engine)
        speed, paid = motor_speed(self.winch, rates), rates + engine.twist @ W
        # Friction of the speed that is wanted, not of the one measured: its sign must not
        # chatter at rest. What the gear loses is known.
        torques = (motor_torque(self.believed, 0.0, paid - wish.twist @ W, -wish.acceleration @ W)
                   + gear_torque(self.winch, tau, speed))
        # What the cables really carry: the winches' own friction and inertia stand between.
        pulled, torques = cable_tensions(self.winch, torques, rates, loose, yielding, self.period,
                                         motor_damping(self.winch, 0.0, speed))
        engine.step(pulled, self.substeps)
        return self.effort(tau, torques, rates)


@checked
class VelocityControl(WinchControl):
    """Winch speeds l̇ = J t − B_b q̇_b of the wanted motion, and what of the wanted lengths is missing.

    Ropes stretch: they are wound shorter by what the wanted tensions stretch them, or some of
    them would hang slack.

    gain : of the length error [1/s]
    margin : kept from the cables' limits [N]; reserve : kept from tipping [N m]
    Source: Pedemonte et al. 2020, section 2.3; B_b q̇_b, which `base_jacobian` gives, is read
    off the exit points.
    """

    name, cables = "velocity", "elastic"

    def __init__(self, gain: float = 20.0, *, margin: float = 1.5,
                 reserve: float = 5.0) -> None:
        if gain < 0:
            raise InvalidInput(f"gain must not be negative [1/s], got {gain:g}")
        super().__init__(margin, reserve)
        self.gain = float(gain)

    def start(self, engine: Any, substeps: int) -> Columns:   # a Simulator, or what is believed of one
        asked, robot = super().start(engine, substeps), engine.world.robot
        if robot.elasticity is None:
            raise InvalidInput("velocity control winds ropes that stretch, but the world has no `cable:` block")
        self.elasticity = robot.elasticity
        self.lengths, self.wanted = np.array(engine.rope_lengths), engine.tensions
        self.fastest = robot.speed_max
        return asked

    def step(self, wish: Reference) -> Iterable[float]:
        engine = self.engine
        directions, lengths, W = engine.cables_at(wish.pose)
        # J t − B_b q̇_b: −Wᵀ t, and what driving bases pay of the cables.
        rates = -wish.twist @ W + (directions * engine.exit_velocities).sum(axis=1)
        # What holds platform and load where they should be.
        mass, bias = mass_and_bias(engine.carrying, wish.pose.rotation, wish.twist)
        found = self.distribute(W, mass @ wish.acceleration + bias)
        self.wanted = self.wanted if found is None else found
        unstretched = self.elasticity.unstrained(lengths, self.wanted)
        rates = rates + self.gain * (unstretched - self.lengths)
        kept = np.clip(rates, -self.fastest, self.fastest)
        self.lengths = self.lengths + kept * self.period
        reached = engine.wind(self.lengths, self.substeps) and bool((kept == rates).all())
        self.feasible = reached and found is not None
        return self.effort(self.wanted,
                           motor_torque(self.winch, engine.tensions, kept), kept)


def winch_control(control: str | WinchControl) -> WinchControl:
    """The controller of that name, "torque" or "velocity", or the one given."""
    if isinstance(control, WinchControl):
        return control
    known = {"torque": TorqueControl, "velocity": VelocityControl}
    if control not in known:
        raise InvalidInput(f"control must be {' or '.join(map(repr, known))}, or a WinchControl, got {quoted(control)}")
    return known[control]()
