"""Two commands of winches with motors: velocity control, and torque control behind their friction."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import ClassVar

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput
from ..mechanics.dynamics import mass_and_bias
from ..mechanics.statics import TippingRows, footings
from ..mechanics.trajectory import Reference
from ..mechanics.winch import (
    Friction,
    cable_tensions,
    friction_experiment,
    identify_friction,
    motor_speed,
    motor_torque,
)
from ..robot import Robot, Winch, turned_to
from ..simulate import Simulator
from ..simulate.spatial import SpatialSimulator
from ..simulate.state import State
from ..tensions import solver_for
from ..tensions.standing import standing_tensions
from .controllers import ComputedTorque
from .log import Columns
from .loop import Command


class WinchControl(Command):
    """A controller of the winches; a wish is where the platform should be as the control step begins.

    ``cables`` is the engine's cable model it needs. It logs the tensions it wants and what the motors do for them;
    ``feasible`` says whether the wanted wrench was balanced within the limits, or the winches reached their lengths.
    """

    name: ClassVar[str]
    cables: ClassVar[str]
    engine: SpatialSimulator
    feasible: bool

    def start(self, engine: Simulator, substeps: int) -> Columns:
        self.winch, self.period = _winch_of(engine.world.robot), engine.dt * substeps
        self.footings = footings(engine.world.robot)
        return super().start(engine, substeps)

    def columns(self, robot: Robot) -> Columns:
        m = robot.n_cables
        return {"commanded_tensions": ((m,), "N"), "motor_torques": ((m,), "N m"), "motor_speeds": ((m,), "rad/s"),
                "feasible": ((), "")}

    def effort(self, tensions: Array, torques: Array, rates: Array) -> Iterable[float]:
        """What `step` returns; rates : (m,) of the cables, positive paying out [m/s]."""
        speeds = motor_speed(self.winch, rates)
        return *tensions.tolist(), *torques.tolist(), *speeds.tolist(), self.feasible

    def standing_rows(self) -> TippingRows:
        """G τ + g ≤ 0 of all bases' edges, one below the other, where the bases are now."""
        engine = self.engine
        rows = [TippingRows(np.zeros((0, engine.tensions.size)), np.zeros(0))]
        for footing in self.footings:
            rows.append(footing.rows(engine.directions, turned_to(engine.base_poses[footing.base, 2], 3)))
        return TippingRows(*map(np.concatenate, zip(*rows)))


class TorqueControl(WinchControl):
    """Computed torque, a distribution that keeps the bases standing, and motor torques that make up for friction.

    kp, kd : gains, as those of `ComputedTorque` [1/s², 1/s]
    standing : whether tipping rows are in the quadratic program
    toward : tension the distribution stays near, 0 for the least norm [N]
    margin : kept from the cables' limits, for what friction leaves [N]
    reserve : kept from tipping [N m]
    friction : believed; default: identified by `friction_experiment`
    """

    name, cables = "torque", "tension"

    def __init__(self, kp: float = 900.0, kd: float = 60.0, *, standing: bool = True, toward: float = 0.0,
                 margin: float = 1.0, reserve: float = 5.0, friction: Friction | None = None) -> None:
        self.law, self.standing, self.toward = ComputedTorque(kp, kd), standing, float(toward)
        self.margin, self.reserve, self.friction = float(margin), float(reserve), friction

    def start(self, engine: Simulator, substeps: int) -> Columns:
        asked, robot = super().start(engine, substeps), engine.world.robot
        self.low, self.high = robot.tension_min + self.margin, robot.tension_max - self.margin
        self.relaxed = solver_for("relaxed", robot.n_dof, self.low, self.high)
        self.believed = _identified(self.winch) if self.friction is None else self.friction
        self.real = Friction.of(self.winch)
        return asked

    def step(self, wish: Reference) -> Iterable[float]:
        engine, W = self.engine, self.engine.wrench_matrix
        state = State(0.0, engine.carrying, engine.position, engine.rotation, engine.twist, engine.tensions)
        tau = self._tensions(W, self.law(state.time, state, wish))
        # B_b q̇_b, what driving bases pay of the cables: −u · Ȧ.
        paid = -(engine.directions * engine.exit_velocities).sum(axis=1)
        # Friction of the speed that is wanted, not of the one measured: its sign must not chatter at rest.
        torques = motor_torque(self.winch, self.believed, tau, -wish.twist @ W - paid, -wish.acceleration @ W)
        torques = np.clip(torques, -self.winch.torque, self.winch.torque)
        rates = -engine.twist @ W - paid
        # What the cables really carry: the winches' own friction and inertia stand between.
        mass, bias = mass_and_bias(engine.carrying, engine.rotation, engine.twist)
        lightness = np.linalg.inv(mass)
        pulled = cable_tensions(self.winch, self.real, torques, rates, lightness @ bias @ W, W.T @ lightness @ W,
                                self.period)
        engine.step(pulled, self.substeps)
        return self.effort(tau, torques, rates)

    def _tensions(self, W: Array, wrench: Array) -> Array:
        rows, offset = np.zeros((0, W.shape[1])), np.zeros(0)
        if self.standing:
            rows, offset = self.standing_rows()
            offset = offset + self.reserve
        tau, reason = standing_tensions(W, -wrench, self.low, self.high, rows, offset, toward=self.toward)
        self.feasible = not reason
        return self.relaxed(W, -wrench)[0] if reason else tau


class VelocityControl(WinchControl):
    """Winch speeds l̇ = J t − B_b q̇_b of the wanted motion, and what of the wanted lengths is missing.

    Ropes stretch: they are wound shorter by what the wanted tensions stretch them, or some of them would hang slack.

    gain : of the length error [1/s]
    margin : kept from the cables' limits [N]; reserve : kept from tipping [N m]
    Source: Pedemonte et al. 2020, section 2.3; B_b q̇_b, which `base_jacobian` gives, is read off the exit points.
    """

    name, cables = "velocity", "elastic"

    def __init__(self, gain: float = 20.0, *, margin: float = 1.5, reserve: float = 5.0) -> None:
        if gain < 0:
            raise InvalidInput(f"gain must not be negative [1/s], got {gain:g}")
        self.gain, self.margin, self.reserve = float(gain), float(margin), float(reserve)

    def start(self, engine: Simulator, substeps: int) -> Columns:
        asked, robot = super().start(engine, substeps), engine.world.robot
        self.lengths, self.stiffness = np.array(self.engine.rope_lengths), _elasticity(robot)
        self.fastest = np.minimum(robot.speed_max, self.winch.speed * self.winch.drum_radius / self.winch.gear_ratio)
        self.low, self.high = robot.tension_min + self.margin, robot.tension_max - self.margin
        self.wanted, self.friction = engine.tensions, Friction.of(self.winch)
        return asked

    def step(self, wish: Reference) -> Iterable[float]:
        engine = self.engine
        directions, lengths, W = engine.cables_at(wish.pose)
        # J t − B_b q̇_b: −Wᵀ t, and what driving bases pay of the cables.
        rates = -wish.twist @ W + (directions * engine.exit_velocities).sum(axis=1)
        self.feasible = self._distribute(wish, W)
        unstretched = lengths / (1 + self.wanted / self.stiffness)
        rates = rates + self.gain * (unstretched - self.lengths)
        kept = np.minimum(np.maximum(rates, -self.fastest), self.fastest)
        self.lengths = self.lengths + kept * self.period
        self.feasible &= engine.wind(self.lengths, self.substeps) and bool((kept == rates).all())
        return self.effort(self.wanted, motor_torque(self.winch, self.friction, engine.tensions, kept, 0.0), kept)

    def _distribute(self, wish: Reference, W: Array) -> bool:
        """The tensions that hold platform and load where they should be."""
        mass, bias = mass_and_bias(self.engine.carrying, wish.pose.rotation, wish.twist)
        rows, offset = self.standing_rows()
        tau, reason = standing_tensions(W, -(mass @ wish.acceleration + bias), self.low, self.high, rows,
                                        offset + self.reserve)
        self.wanted = self.wanted if reason else tau
        return not reason


def winch_control(control: str | WinchControl) -> WinchControl:
    """The controller of that name, "torque" or "velocity", or the one given."""
    if isinstance(control, WinchControl):
        return control
    known = {"torque": TorqueControl, "velocity": VelocityControl}
    if control not in known:
        raise InvalidInput(f"control must be {' or '.join(map(repr, known))}, or a WinchControl, got {control!r}")
    return known[control]()


def _winch_of(robot: Robot) -> Winch:
    if robot.winch is None:
        raise InvalidInput("winches are to be controlled, but the world has no `winch:` block")
    return robot.winch


def _elasticity(robot: Robot) -> float:
    if robot.elasticity is None:
        raise InvalidInput("velocity control winds ropes that stretch, but the world has no `cable:` block")
    return robot.elasticity.axial_stiffness


@cache
def _identified(winch: Winch) -> Friction:
    return identify_friction(friction_experiment(winch))[0]
