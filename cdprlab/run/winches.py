"""Two controllers of one interface: velocity control of the winches, and torque control behind their friction.

Both are started with the engine, and each control step get what the robot shall do and advance the engine by it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cache
from typing import ClassVar, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput
from ..mechanics.fast_control import mass_and_bias, turn_between
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
from ..simulate.mobile import MobileSimulator
from ..tensions.distribution import solver_for
from ..tensions.standing import standing_tensions


class Order(NamedTuple):
    """What to do in the coming control step.

    reference : where the platform should be at its begin
    robot : with what it is known to carry; its bases as the world has them
    base_speeds : (3p,) driven during the step [rad/s, m/s]
    period : [s]
    """

    reference: Reference
    robot: Robot
    base_speeds: Array
    period: float


class Effort(NamedTuple):
    """What it took.

    tensions : (m,) wanted [N]
    torques : (m,) of the motors [N m]; speeds : (m,) of the motors, positive winding in [rad/s]
    feasible : the wanted wrench was balanced within the limits, or the winches reached their lengths
    """

    tensions: Array
    torques: Array
    speeds: Array
    feasible: bool


class WinchControl(ABC):
    """A controller of the winches; ``cables`` is the engine's cable model it needs."""

    name: ClassVar[str]
    cables: ClassVar[str]

    def start(self, engine: MobileSimulator) -> None:
        """Get ready for an engine that has just been reset."""
        self.winch, self.footings = _winch_of(engine.world.robot), footings(engine.world.robot)

    @abstractmethod
    def step(self, engine: MobileSimulator, order: Order) -> Effort:
        """Advance the engine by one control step."""

    def standing_rows(self, engine: MobileSimulator) -> TippingRows:
        """G τ + g ≤ 0 of all bases' edges, one below the other, where the bases are now."""
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
        if min(kp, kd) < 0:
            raise InvalidInput(f"kp and kd must not be negative, got {kp:g} and {kd:g}")
        self.kp, self.kd, self.standing, self.toward = float(kp), float(kd), standing, float(toward)
        self.margin, self.reserve, self.friction = float(margin), float(reserve), friction

    def start(self, engine: MobileSimulator) -> None:
        super().start(engine)
        robot = engine.world.robot
        self.low, self.high = robot.tension_min + self.margin, robot.tension_max - self.margin
        self.relaxed = solver_for("relaxed", robot.n_dof, self.low, self.high)
        self.believed = _identified(self.winch) if self.friction is None else self.friction
        self.real = Friction.of(self.winch)

    def step(self, engine: MobileSimulator, order: Order) -> Effort:
        W, wish = engine.wrench_matrix, order.reference
        mass, bias = mass_and_bias(order.robot, engine.rotation, engine.twist)
        tau, feasible = self._tensions(engine, W, mass @ self._acceleration(engine, wish) + bias)
        # B_b q̇_b, what driving bases pay of the cables: −u · Ȧ.
        paid = -(engine.directions * engine.exit_velocities).sum(axis=1)
        # Friction of the speed that is wanted, not of the one measured: its sign must not chatter at rest.
        torques = motor_torque(self.winch, self.believed, tau, -wish.twist @ W - paid, -wish.acceleration @ W)
        torques = np.clip(torques, -self.winch.torque, self.winch.torque)
        rates = -engine.twist @ W - paid
        # What the cables really carry: the winches' own friction and inertia stand between.
        lightness = np.linalg.inv(mass)
        pulled = cable_tensions(self.winch, self.real, torques, rates, lightness @ bias @ W, W.T @ lightness @ W,
                                order.period)
        engine.step(pulled, round(order.period / engine.dt))
        return Effort(tau, torques, motor_speed(self.winch, rates), feasible)

    def _acceleration(self, engine: MobileSimulator, wish: Reference) -> Array:
        """a_d + K_d ė + K_p e, as `ComputedTorque` asks for it."""
        off = np.array([*(wish.pose.position - engine.position), *turn_between(engine.rotation, wish.pose.rotation)])
        return wish.acceleration + self.kd * (wish.twist - engine.twist) + self.kp * off

    def _tensions(self, engine: MobileSimulator, W: Array, wrench: Array) -> tuple[Array, bool]:
        rows, offset = np.zeros((0, W.shape[1])), np.zeros(0)
        if self.standing:
            rows, offset = self.standing_rows(engine)
            offset = offset + self.reserve
        tau, reason = standing_tensions(W, -wrench, self.low, self.high, rows, offset, toward=self.toward)
        return (self.relaxed(W, -wrench)[0], False) if reason else (tau, True)


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

    def start(self, engine: MobileSimulator) -> None:
        super().start(engine)
        robot = engine.world.robot
        self.lengths, self.stiffness = np.array(engine.rope_lengths), _elasticity(robot)
        self.fastest = np.minimum(robot.speed_max, self.winch.speed * self.winch.drum_radius / self.winch.gear_ratio)
        self.low, self.high = robot.tension_min + self.margin, robot.tension_max - self.margin
        self.wanted, self.friction = engine.tensions, Friction.of(self.winch)

    def step(self, engine: MobileSimulator, order: Order) -> Effort:
        wish = order.reference
        directions, lengths, W = engine.cables_at(wish.pose)
        # J t − B_b q̇_b: −Wᵀ t, and what driving bases pay of the cables.
        rates = -wish.twist @ W + (directions * engine.exit_velocities).sum(axis=1)
        feasible = self._distribute(engine, order, W)
        unstretched = lengths / (1 + self.wanted / self.stiffness)
        rates = rates + self.gain * (unstretched - self.lengths)
        kept = np.minimum(np.maximum(rates, -self.fastest), self.fastest)
        self.lengths = self.lengths + kept * order.period
        feasible &= engine.wind(self.lengths, round(order.period / engine.dt)) and bool((kept == rates).all())
        torques = motor_torque(self.winch, self.friction, engine.tensions, kept, 0.0)
        return Effort(self.wanted, torques, motor_speed(self.winch, kept), feasible)

    def _distribute(self, engine: MobileSimulator, order: Order, W: Array) -> bool:
        """The tensions that hold platform and load where they should be."""
        wish = order.reference
        mass, bias = mass_and_bias(order.robot, wish.pose.rotation, wish.twist)
        rows, offset = self.standing_rows(engine)
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
