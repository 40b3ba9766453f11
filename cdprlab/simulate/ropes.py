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
from ..mechanics.dynamics import mass_and_bias
from ..robot import Elasticity, Robot

_FEW = 5  # ropes: for more the program is quicker
_YIELD = 1e-6
"""Of A's trace: keeps the tensions of redundant ropes unique and smooth; at 1e-9 they ripple, see the tests."""

RopeLaw = Callable[[Array, Array, Array, Array, Array, Array, Any], Array]
"""W, rotation, twist, lengths L, winch lengths ρ now and ρ' at the step's end, push or None → tensions T (m,)."""


def rope_law(robot: Robot, dt: float, elasticity: Elasticity | None = None) -> RopeLaw:
    """The tensions of ropes wound to given lengths, for one step at a time.

    robot : a spatial Robot; dt : [s]; elasticity : how the ropes stretch, None: not at all
    """
    m = robot.n_cables
    identity, solve = np.eye(m), _complementary(m)
    # The trace of Wᵀ W is m where W's columns are directions alone.
    firm = _YIELD * m / robot.mass * identity if _is_point_mass(robot) else None
    approach = _point_approach(robot, dt) if _is_point_mass(robot) else _approach(robot, dt)

    def tensions(W: Array, rotation: Array, twist: Array, lengths: Array, now: Array, wound: Array,
                 push: Any) -> Array:
        A, b = approach(W, rotation, twist, push)
        b += lengths
        b -= wound
        if elasticity is None:
            A += _YIELD * A.trace() * identity if firm is None else firm
            b /= dt * dt
        else:
            A, b = _yielding(A, b, lengths - now, elasticity.axial_stiffness / wound, elasticity.damping, dt)
        return solve(A, b)

    return tensions


def _complementary(m: int) -> Callable[[Array, Array], Array]:
    """(A, b) → T with T ≥ 0, A T − b ≥ 0 and Tᵀ (A T − b) = 0, for a positive definite A, such as step after step.

    Mostly the ropes that were taut are taut still: then one small system in plain floats, a third of the program's
    cost, gives the answer, which its signs prove. The answer is unique, so none depends on what was tried first.
    """
    import quadprog

    identity, zero, taut = np.eye(m), np.zeros(m), list(range(m))

    def solve(A: Array, b: Array) -> Array:
        if m <= _FEW and (quick := _with_taut(A.tolist(), b.tolist(), taut)) is not None:
            return np.array(quick)
        T = np.maximum(quadprog.solve_qp(A, b, identity, zero)[0], 0.0)  # rounding leaves −1e-14 N
        if m <= _FEW:
            taut[:] = np.flatnonzero(T > 0).tolist()
        return T

    return solve


def _with_taut(A: list[list[float]], b: list[float], taut: list[int]) -> list[float] | None:
    """The answer if just these ropes are taut, by elimination; None if it is not one."""
    rows = [[*(A[i][j] for j in taut), b[i]] for i in taut]
    k = len(rows)
    for p, pivot in enumerate(rows):
        for row in rows[p + 1:]:
            factor = row[p] / pivot[p]
            for j in range(p + 1, k + 1):
                row[j] -= factor * pivot[j]
    T = [0.0] * len(b)
    for p in range(k - 1, -1, -1):
        row = rows[p]
        value = row[k]
        for j in range(p + 1, k):
            value -= row[j] * T[taut[j]]
        value /= row[p]
        if value < 0:
            return None
        T[taut[p]] = value
    for i, row in enumerate(A):
        if i not in taut and sum([row[j] * T[j] for j in taut]) < b[i]:
            return None
    return T


def _yielding(A: Array, overlength: Array, stretch: Array, k: Array, damping: float, dt: float) -> tuple[Array, Array]:
    """A and b of ropes that stretch: T = k (L' − ρ') + d (L̇' − ρ̇) at the step's end.

    overlength : L + dt J v_free − ρ' [m]; stretch : L − ρ at the step's start [m]
    k : [N/m]; damping : fraction of critical
    """
    d = 2 * damping * np.sqrt(k / np.maximum(A.diagonal(), 1e-12))
    stiff = dt * (k * dt + d)
    A.ravel()[::k.size + 1] += 1 / stiff   # its diagonal
    return A, (k * overlength + d * (overlength - stretch) / dt) / stiff


_Approach = Callable[[Array, Array, Array, Any], tuple[Array, Array]]
"""W, rotation, twist, push → A without C, and how much the ropes would lengthen in a step, dt J v_free [m]."""


def _point_approach(robot: Robot, dt: float) -> _Approach:
    lightness = 1 / robot.mass
    falling = np.array([0.0, 0.0, -robot.gravity * dt])

    def approach(W: Array, rotation: Array, twist: Array, push: Any) -> tuple[Array, Array]:
        velocity = twist[:3] + falling
        if push is not None:
            velocity += dt * lightness * push[:3]
        A, longer = W.T.dot(W), velocity.dot(W)
        A *= lightness
        longer *= -dt
        return A, longer

    return approach


def _approach(robot: Robot, dt: float) -> _Approach:
    every_row, basis = robot.n_dof == 6, robot.pattern.basis

    def approach(W: Array, rotation: Array, twist: Array, push: Any) -> tuple[Array, Array]:
        pulls = W if every_row else basis(rotation).dot(W)   # whatever the pattern controls, all of it moves
        mass, bias = mass_and_bias(robot, rotation, twist)
        lightness = np.linalg.inv(mass)
        velocity = twist + dt * lightness.dot(-bias if push is None else push - bias)
        return pulls.T.dot(lightness).dot(pulls), velocity.dot(pulls) * -dt

    return approach


def _is_point_mass(robot: Robot) -> bool:
    return robot.motion_pattern == "3T" and not robot.platform.is_off_center
