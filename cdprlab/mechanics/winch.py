"""Winches: the motor's torque behind a cable's tension, and the tension behind a torque.

A motor that turns at q̇ = −G l̇ / r (positive: winding in) behind a gear G of efficiency η and a drum of
radius r carries a cable of tension t as τ = I q̈ + f(q̇) + r t / (G η) while it winds in, and with η in the
place of 1 / η while the cable drives it back: what is lost is lost both ways.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..robot import Winch

STRIBECK = 4.0
"""[rad/s] motor speed over which static friction gives way to Coulomb's; chosen."""

BREAKAWAY = 1.0
"""[rad/s] motor speed (a cable's 8 mm/s behind FASTKIT's gear) within which a motor counts as sticking; chosen."""


class Friction(NamedTuple):
    """Friction at the motor: static and Coulomb [N m], viscous [N m s/rad]; a `Winch` has the same three."""

    static: float
    coulomb: float
    viscous: float


def friction_torque(friction: Friction | Winch, speed: ArrayLike) -> Array:
    """f(q̇) = [f_c + (f_s − f_c) e^(−(q̇/q̇_s)²)] tanh(q̇/q̇₀) + f_v q̇.

    friction : static friction below Coulomb's counts as Coulomb's
    speed : (…) of the motor [rad/s]
    Returns (…) torque lost [N m].
    Source: Armstrong-Hélouvry, Dupont and Canudas de Wit 1994 (Stribeck curve), the sign
    smoothed.

    >>> float(friction_torque(Friction(0.03, 0.02, 0.0), 100.0).round(6))
    0.02
    """
    slow, sliding, turning = friction_features(speed)
    static = max(friction.static, friction.coulomb)
    return static * slow + friction.coulomb * sliding + friction.viscous * turning


def friction_features(speed: ArrayLike) -> tuple[Array, Array, Array]:
    """What static, Coulomb and viscous friction are multiplied with: f is linear in them."""
    q = np.asarray(speed)
    sign = np.tanh(q / BREAKAWAY)
    slow = np.exp(-(q / STRIBECK)**2)
    return sign * slow, sign * (1 - slow), q


def gear_torque(winch: Winch, tensions: ArrayLike, speed: ArrayLike) -> Array:
    """r t / (G η^tanh(q̇/q̇₀)): what a cable's tension comes to at the motor [N m].

    tensions : (…) [N]; speed : (…) of the motor [rad/s]
    """
    lost = winch.efficiency**-np.tanh(np.asarray(speed) / BREAKAWAY)
    return np.asarray(tensions) * lost / winch.transmission


def motor_speed(winch: Winch, rates: ArrayLike) -> Array:
    """q̇ = −G l̇ / r, positive while winding in.

    rates : (…) of cable length [m/s]
    """
    return np.asarray(rates) * -winch.transmission


def motor_torque(winch: Winch, tensions: ArrayLike, rates: ArrayLike, accelerations: ArrayLike = 0.0) -> Array:
    """τ = I q̈ + f(q̇) + r t / (G η) winding in, I q̈ + f(q̇) + η r t / G driven back: what the motor must give.

    tensions : (…) [N]; rates, accelerations : (…) of cable length [m/s, m/s²]
    Source: Okoli 2016, eq. (2.20)–(2.23), with FASTKIT's gear and efficiency.

    >>> winch = Winch(drum_radius=0.04, gear_ratio=5, efficiency=0.7)
    >>> motor_torque(winch, 45.0, [-1.0, 1.0]).round(3)    # wound in, paid out at 1 m/s
    array([0.514, 0.252])
    """
    speed = motor_speed(winch, rates)
    return (winch.inertia * motor_speed(winch, accelerations) + friction_torque(winch, speed)
            + gear_torque(winch, tensions, speed))


def motor_damping(winch: Winch, tensions: ArrayLike, speed: ArrayLike) -> Array:
    """∂/∂q̇ of friction and gear losses, by central differences [N m s/rad]."""
    step = 1e-4
    speeds = np.add.outer([-step, step], speed)
    before, after = friction_torque(winch, speeds) + gear_torque(winch, tensions, speeds)
    return (after - before) / (2 * step)


def cable_tensions(winch: Winch, torques: Array, rates: Array, loose: Array, yielding: Array,
                   period: float, damping: ArrayLike) -> tuple[Array, Array]:
    """The tensions t behind motor torques τ = (I + h d) q̈ + f(q̇) + gear_torque(t, q̇), and those torques as given.

    Motors and platform accelerate together: l̈ follows from the tensions, l̈ = l̈₀ − A t, so that
    t solves a linear system. No motor gives more than its largest torque; within it, none turns
    faster at the step's end than its largest speed. A cable does not push, nor does it carry more
    than the largest torque holds without losses: beyond that it slips.

    torques : (m,) wanted of the motors [N m]; rates : (m,) l̇ [m/s]
    loose : (m,) l̈₀ without tensions [m/s²]; yielding : (m, m) A = Wᵀ M⁻¹ W [1/kg]
    period : h [s]; damping : d, the slope of those losses that nobody makes up for, taken at the
        step's end, or friction would shake what it should hold [N m s/rad]
    """
    speed, ratio = motor_speed(winch, rates), winch.transmission
    inertia = ratio * (winch.inertia + period * np.full(speed.shape, damping))
    inverse = np.linalg.inv(np.diag(gear_torque(winch, 1.0, speed)) + inertia[:, None] * yielding)
    known = inertia * loose - friction_torque(winch, speed)
    given = torques.clip(-winch.torque, winch.torque)
    turning = period * ratio * yielding @ inverse     # ∂q̇/∂τ at the step's end
    ahead = speed - period * ratio * loose + turning @ (given + known)
    fast = np.abs(ahead) > winch.speed
    if fast.any():
        excess = ahead[fast] - np.sign(ahead[fast]) * winch.speed
        given[fast] -= np.linalg.lstsq(turning[np.ix_(fast, fast)], excess)[0]
        given = given.clip(-winch.torque, winch.torque)
    return (inverse @ (given + known)).clip(0.0, ratio * winch.torque), given
