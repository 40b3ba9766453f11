"""Winches: motor torque and friction behind a cable's tension, and friction found from a short experiment.

A motor that turns at q̇ (positive: winding in) behind a gear G of efficiency η and a drum of
radius r carries a cable of tension t as I q̈ + f(q̇) + r t / (G η) = τ, with q̇ = −G l̇ / r.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, as_number, as_seed
from ..errors import InvalidInput
from ..robot import Winch

STRIBECK = 4.0
"""[rad/s] motor speed over which static friction gives way to Coulomb's; chosen."""

BREAKAWAY = 1.0
"""[rad/s] motor speed (a cable's 8 mm/s behind FASTKIT's gear) within which a motor counts as sticking; chosen."""


class Friction(NamedTuple):
    """Friction at the motor: static and Coulomb [N m], viscous [N m s/rad]."""

    static: float
    coulomb: float
    viscous: float

    @classmethod
    def of(cls, winch: Winch) -> Friction:
        """A winch's own; static friction is never below Coulomb's."""
        return cls(max(winch.static, winch.coulomb), winch.coulomb, winch.viscous)


def friction_torque(friction: Friction, speed: ArrayLike) -> Array:
    """f(q̇) = [f_c + (f_s − f_c) e^(−(q̇/q̇_s)²)] tanh(q̇/q̇₀) + f_v q̇.

    speed : (…) of the motor [rad/s]
    Returns (…) torque lost [N m].
    Source: Armstrong-Hélouvry, Dupont and Canudas de Wit 1994 (Stribeck curve), the sign
    smoothed.

    >>> float(friction_torque(Friction(0.03, 0.02, 0.0), 100.0).round(6))
    0.02
    """
    features = _features(np.asarray(speed, dtype=float))
    return np.asarray(sum(share * feature for share, feature in zip(friction, features)))


def friction_slope(friction: Friction, speed: ArrayLike) -> Array:
    """∂f/∂q̇, by central differences [N m s/rad]."""
    q, step = np.asarray(speed, dtype=float), 1e-4 * BREAKAWAY
    return (friction_torque(friction, q + step) - friction_torque(friction, q - step)) / (2 * step)


def motor_speed(winch: Winch, rates: ArrayLike) -> Array:
    """q̇ = −G l̇ / r, positive while winding in.

    rates : (…) of cable length [m/s]
    """
    return np.asarray(rates, dtype=float) * (-winch.gear_ratio / winch.drum_radius)


def motor_torque(winch: Winch, friction: Friction, tensions: ArrayLike, rates: ArrayLike,
                 accelerations: ArrayLike) -> Array:
    """τ = I q̈ + f(q̇) + r t / (G η): what the motor must give.

    friction : as it is believed to be
    tensions : (…) [N]; rates, accelerations : (…) of cable length [m/s, m/s²]
    Source: Okoli 2016, eq. (2.20)–(2.23), with FASTKIT's gear and efficiency.

    >>> import cdprlab as cl
    >>> winch = cl.load_world("fastkit_suspended").robot.winch
    >>> float(motor_torque(winch, Friction(0, 0, 0), 45.0, 0.0, 0.0).round(3))
    0.514
    """
    speed, change = motor_speed(winch, rates), motor_speed(winch, accelerations)
    return np.asarray(winch.inertia * change + friction_torque(friction, speed)
                      + np.asarray(tensions, dtype=float) / _pull(winch))


def cable_tensions(winch: Winch, friction: Friction, torques: Array, rates: Array, loose: Array,
                   yielding: Array,
                   period: float) -> Array:
    """What the cables pull with, t = (G η / r) (τ − f − I q̈), motors and platform accelerating together.

    The cables' l̈ follows from the tensions themselves, l̈ = l̈₀ − A t, so that t solves a
    linear system; friction is taken at the step's end, f(q̇) + h f′(q̇) q̈, or it would shake
    what it should hold.

    torques : (m,) of the motors [N m]; rates : (m,) l̇ [m/s]
    loose : (m,) l̈₀ without tensions [m/s²]; yielding : (m, m) A = Wᵀ M⁻¹ W [1/kg]; period : h
        [s]
    """
    speed = motor_speed(winch, rates)
    inertia = winch.inertia + period * friction_slope(friction, speed)
    reflected = _pull(winch) * inertia * winch.gear_ratio / winch.drum_radius   # [kg]: −(G η / r) q̈ is this times l̈
    driven = _pull(winch) * (torques - friction_torque(friction, speed))
    tau = np.linalg.solve(np.eye(speed.size) + reflected[:, None] * yielding,
                          driven + reflected * loose)
    return np.maximum(tau, 0.0)   # a cable does not push


class Experiment(NamedTuple):
    """A motor winding a known load up and down: time [s], speed [rad/s], torque and the load's torque [N m]."""

    time: Array
    speed: Array
    torque: Array
    load: float


def friction_experiment(winch: Winch, load: float = 10.0, duration: float = 8.0,
                        noise: float = 2e-3,
                        seed: int = 0) -> Experiment:
    """Let a speed-controlled motor wind a weight up and down, slowly and quickly, and write down its torque.

    load : tension of the cable [N]; duration : [s]
    noise : standard deviation of the torque read [N m]; seed : of that noise
    """
    if as_number(duration, "duration", "s") < 1 or winch.inertia <= 0:
        raise InvalidInput("the experiment takes at least 1 s and a winch with `inertia` above zero "
                           f"[kg m²], got {duration} s and {winch.inertia}")
    friction, carried, dt = Friction.of(winch), load / _pull(winch), 5e-4
    time: Array = np.arange(round(duration / dt), dtype=np.float64) * dt
    # Slow first, for breakaway, then as fast as the job asks for.
    wanted = np.where(time < duration / 2, 8.0, 80.0) * np.sin(2 * np.pi * time / (duration / 4))
    speeds, torques, speed, total = np.empty(time.size), np.empty(time.size), 0.0, 0.0
    for k, goal in enumerate(wanted.tolist()):
        total += (goal - speed) * dt
        torque = 0.02 * (goal - speed) + 0.2 * total + carried
        speeds[k], torques[k] = speed, torque
        slope = float(friction_slope(friction, speed))
        speed += dt * (torque - carried - float(friction_torque(friction, speed))) / (winch.inertia + dt * slope)
    read = slice(None, None, 4)
    heard = torques[read] + np.random.default_rng(as_seed(seed)).normal(0, noise, torques[read].size)
    return Experiment(time[read], speeds[read], heard, carried)


def identify_friction(experiment: Experiment) -> tuple[Friction, float]:
    """Friction and inertia that explain an experiment: least squares of τ − r t / (G η) = I q̈ + f(q̇).

    Returns Friction and the inertia [kg m²].
    """
    speed = as_array(experiment.speed, "speed", ("k",), "rad/s")
    change = np.gradient(speed, experiment.time)
    matrix = np.column_stack([*_features(speed), change])
    found = np.linalg.lstsq(matrix, experiment.torque - experiment.load, rcond=None)[0]
    static, coulomb, viscous, inertia = found.tolist()
    return Friction(static, coulomb, viscous), inertia


def _features(speed: Array) -> tuple[Array, Array, Array]:
    """What static, Coulomb and viscous friction are multiplied with: f is linear in them."""
    sign, slow = np.tanh(speed / BREAKAWAY), np.exp(-(speed / STRIBECK)**2)
    return sign * slow, sign * (1 - slow), speed


def _pull(winch: Winch) -> float:
    """Tension per motor torque, G η / r [1/m]."""
    return winch.gear_ratio * winch.efficiency / winch.drum_radius
