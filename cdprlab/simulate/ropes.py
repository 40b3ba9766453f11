"""Ropes of commanded length that can only pull: which of them are taut in a step, and how hard they then pull.

At the end of a step every rope is at most as long as its winch has let it out, L' ≤ ρ'; a rope that is shorter carries
nothing. With L' ≈ L + dt J v' and v' = v_free − dt M⁻¹ Jᵀ T this is the linear complementarity problem

    T ≥ 0,   A T − b ≥ 0,   Tᵀ (A T − b) = 0,   A = J M⁻¹ Jᵀ + C,   b = (J v_free − (ρ' − L) / dt) / dt,

whose solution minimizes ½ Tᵀ A T − bᵀ T over T ≥ 0. C is what ropes yield: next to nothing, or what their stiffness
k = EA / ρ and damping d give over one implicit step, 1 / (dt (k dt + d)).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import Array
from ..control import inverse_dynamics, mobility
from ..robot import Elasticity, Robot

_YIELD = 1e-6
"""Of A's trace: keeps the tensions of redundant ropes unique and smooth; at 1e-9 they ripple, see the tests."""

RopeLaw = Callable[[Array, Array, Array, Array, Array, Array, Any], Array]
"""W, rotation, twist, lengths L, winch lengths ρ now and ρ' at the step's end, push or None → tensions T (m,)."""


def rope_law(robot: Robot, dt: float, elasticity: Elasticity | None = None) -> RopeLaw:
    """The tensions of ropes wound to given lengths, for one step at a time.

    robot : a spatial Robot; dt : [s]; elasticity : how the ropes stretch, None: not at all
    """
    import quadprog

    solve_qp, m = quadprog.solve_qp, robot.n_cables
    identity, zero = np.eye(m), np.zeros(m)
    approach = _point_approach(robot, dt) if _is_point_mass(robot) else _approach(robot, dt)

    def tensions(W: Array, rotation: Array, twist: Array, lengths: Array, now: Array, wound: Array,
                 push: Any) -> Array:
        A, b = approach(W, rotation, twist, push)
        b += lengths
        b -= wound
        if elasticity is None:
            A += _YIELD * A.trace() * identity
            b /= dt * dt
        else:
            A, b = _yielding(A, b, lengths - now, elasticity.axial_stiffness / wound, elasticity.damping, dt)
        return np.maximum(solve_qp(A, b, identity, zero)[0], 0.0)  # rounding leaves −1e-14 N

    return tensions


def _yielding(A: Array, overlength: Array, stretch: Array, k: Array, damping: float, dt: float) -> tuple[Array, Array]:
    """A and b of ropes that stretch: T = k (L' − ρ') + d (L̇' − ρ̇) at the step's end.

    overlength : L + dt J v_free − ρ' [m]; stretch : L − ρ at the step's start [m]
    k : [N/m]; damping : fraction of critical
    """
    d = 2 * damping * np.sqrt(k / np.maximum(A.diagonal(), 1e-12))
    stiff = dt * (k * dt + d)
    return A + np.diag(1 / stiff), (k * overlength + d * (overlength - stretch) / dt) / stiff


_Approach = Callable[[Array, Array, Array, Any], tuple[Array, Array]]
"""W, rotation, twist, push → A without C, and how much the ropes would lengthen in a step, dt J v_free [m]."""


def _point_approach(robot: Robot, dt: float) -> _Approach:
    weight, lightness = np.array([0.0, 0.0, -robot.gravity]), 1 / robot.mass

    def approach(W: Array, rotation: Array, twist: Array, push: Any) -> tuple[Array, Array]:
        fall = weight if push is None else weight + push[:3] * lightness
        A = W.T.dot(W)
        A *= lightness
        return A, (twist[:3] + dt * fall).dot(W) * -dt

    return approach


def _approach(robot: Robot, dt: float) -> _Approach:
    rest = np.zeros(6)

    def approach(W: Array, rotation: Array, twist: Array, push: Any) -> tuple[Array, Array]:
        wrench = -inverse_dynamics(robot, rotation, twist, rest, every_row=True)
        fall = mobility(robot, rotation, every_row=True).dot(wrench if push is None else wrench + push)
        velocity = (twist + dt * fall) @ robot.pattern.basis(rotation)
        return W.T @ mobility(robot, rotation) @ W, velocity.dot(W) * -dt

    return approach


def _is_point_mass(robot: Robot) -> bool:
    return robot.motion_pattern == "3T" and not robot.platform.is_off_center
