"""Mobile bases and winches together: one platform twist, many ways to share it among base and cable speeds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..errors import InfeasibleTwist, InvalidInput
from ..robot import Robot
from ..robot.pose import Pose
from .kinematics import Pivot, base_jacobian, jacobian
from .optimization import largest_last, least_quadratic

RESOLUTION_METHODS = {
    "quadratic_program": "least weighted norm within the speed limits",
    "weighted": "least weighted norm, limits ignored: by default each speed is weighed against its own limit",
    "least_norm": "least Euclidean norm of all speeds, limits ignored (it adds m/s and rad/s)",
}
"""How `resolve_twist` may choose, and what that means."""

# Limits are kept to this share of themselves: a thousand times what rounding leaves.
_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class TwistResolution:
    """Speeds that give a platform twist together: l̇ = J t − B_b q̇_b.

    base_speeds : (…, 3p) q̇_b = (θ̇, ρ̇₁, ρ̇₂) of each base in file order [rad/s, m/s, m/s]
    cable_speeds : (…, m) l̇ [m/s]
    feasible : (…) all limits are kept; it alone says whether the speeds may be used
    scale : (…) the largest s for which s t can be reached at all, inf where nothing limits it
    reason : '' when feasible, else which limit is broken and the scale; an array in a batch
    """

    base_speeds: Array
    cable_speeds: Array
    feasible: Any
    scale: Any
    method: str
    reason: Any

    def require(self) -> TwistResolution:
        """Itself if all is feasible; raises InfeasibleTwist, carrying it, if not."""
        if np.all(self.feasible):
            return self
        reasons = [reason for reason in np.atleast_1d(self.reason).ravel() if reason]
        share = f"{len(reasons)} of {np.size(self.feasible)} twists: " if np.ndim(self.feasible) else ""
        raise InfeasibleTwist(share + reasons[0], self)


def resolve_twist(robot: Robot, pose: Pose, twist: ArrayLike, method: str = "quadratic_program", *,
                  weights: ArrayLike | None = None, pivot: Pivot = "base") -> TwistResolution:
    """Base and cable speeds for a wanted platform twist: min Σ w x² with l̇ + B_b q̇_b = J t, x = (q̇_b, l̇).

    robot, pose : single or batched; a base direction with speed limit 0 is held
    twist : (…, n) t in world axes at P [m/s, rad/s]
    method : one of ``RESOLUTION_METHODS``
    weights : (3p + m,) w of the base speeds, then of the cable speeds; default 1 / limit², 0 without a limit
    pivot : what θ turns a base about, as in `base_jacobian`
    Returns TwistResolution.
    Raises InvalidInput for an unknown method, weights that are negative or of another shape.
    Source: Rasheed et al. 2018, eq. (14) and (15), the redundancy resolved by least norm.

    >>> import cdprlab as cl
    >>> world = cl.load_world("planar_mcdpr")
    >>> found = resolve_twist(world.robot, world.pose, [1.15, 1.675])
    >>> bool(found.feasible), round(float(found.scale), 4)
    (True, 1.2195)
    """
    if method not in RESOLUTION_METHODS:
        raise InvalidInput(f"unknown method {method!r}; there are {', '.join(RESOLUTION_METHODS)}")
    wanted = as_array(twist, "twist", (robot.n_dof,), "m/s, rad/s", batch=True)
    rates = (jacobian(robot, pose) @ wanted[..., None])[..., 0]
    B = np.broadcast_to(base_jacobian(robot, pose, pivot), (*rates.shape, 3 * len(robot.bases)))
    limits = np.concatenate([*(base.speed_max for base in robot.bases), robot.speed_max])
    solve = _solver(method, _weights(weights, limits, method), limits)
    speeds, scale = np.empty((*rates.shape[:-1], limits.size)), np.empty(rates.shape[:-1])
    for index in np.ndindex(rates.shape[:-1]):
        scale[index] = _largest_scale(B[index], rates[index], limits)
        speeds[index] = solve(B[index], rates[index], float(scale[index]))
    return _judged(robot, speeds, scale, limits, method)


def _weights(given: ArrayLike | None, limits: Array, method: str) -> Array:
    if method == "least_norm":
        if given is not None:
            raise InvalidInput("least_norm weighs all speeds alike; give weights to 'weighted' or 'quadratic_program'")
        return np.ones(limits.size)
    if given is None:
        with np.errstate(divide="ignore"):
            return np.where(limits > 0, 1 / limits**2, 0.0)
    weights = as_array(given, "weights", (limits.size,))
    if (weights < 0).any():
        raise InvalidInput(f"weights must not be negative, got {weights.tolist()}")
    return weights


def _solver(method: str, weights: Array, limits: Array) -> Callable[[Array, Array, float], Array]:
    """``(B_b, J t, scale) → (q̇_b, l̇)``; directions whose limit is 0 are left out."""
    def solve(B: Array, rates: Array, scale: float) -> Array:
        free = limits[:B.shape[1]] > 0
        bound = (limits[:B.shape[1]][free], limits[B.shape[1]:])
        drive = np.zeros(B.shape[1])
        if free.any():
            roots = np.sqrt(weights[:B.shape[1]][free]), np.sqrt(weights[B.shape[1]:])
            drive[free] = _least_squares(B[:, free], rates, roots)
            if method == "quadratic_program" and _exceeds(drive[free], rates - B @ drive, bound):
                # An infeasible twist gets the speeds of its largest feasible share, the rest left to the cables.
                drive[free] = _within_limits(B[:, free], min(scale, 1.0) * rates, roots, bound)
        return np.concatenate([drive, rates - B @ drive])

    return solve


def _least_squares(B: Array, rates: Array, roots: tuple[Array, Array]) -> Array:
    """min ‖D_q q̇‖² + ‖D_l (J t − B q̇)‖²."""
    matrix = np.concatenate([np.diag(roots[0]), roots[1][:, None] * B])
    right = np.concatenate([np.zeros(B.shape[1]), roots[1] * rates])
    return np.linalg.lstsq(matrix, right, rcond=None)[0]


def _exceeds(drive: Array, cables: Array, bound: tuple[Array, Array]) -> bool:
    return bool((np.abs(drive) > bound[0]).any() or (np.abs(cables) > bound[1]).any())


def _within_limits(B: Array, rates: Array, roots: tuple[Array, Array], bound: tuple[Array, Array]) -> Array:
    """The same least squares with |q̇| ≤ q̇_max and |J t − B q̇| ≤ l̇_max, by a quadratic program."""
    matrix = np.concatenate([np.diag(roots[0]), roots[1][:, None] * B])
    hessian = matrix.T @ matrix
    # Where weights leave a choice the program needs a strictly convex cost: the least norm among equals.
    hessian += 1e-10 * max(float(np.trace(hessian)), 1.0) * np.eye(B.shape[1])
    eye = np.eye(B.shape[1])
    finite = np.isfinite(bound[1])
    # Constraints as quadprog takes them, Cᵀ x ≥ b, relaxed by rounding so that a border case stays feasible.
    rows = np.concatenate([eye, -eye, B[finite], -B[finite]])
    slack = _TOLERANCE / 10
    sides = np.concatenate([-bound[0], -bound[0], rates[finite] - bound[1][finite], -rates[finite] - bound[1][finite]])
    sides -= slack * np.concatenate([bound[0], bound[0], bound[1][finite], bound[1][finite]])
    linear = B.T @ (roots[1]**2 * rates)
    usable = np.isfinite(sides)
    found = least_quadratic(hessian, linear, rows[usable].T.copy(), sides[usable])
    assert found is not None, "the largest feasible share of a twist keeps its limits"
    return found


def _largest_scale(B: Array, rates: Array, limits: Array) -> float:
    """max s with |q̇| ≤ q̇_max and |s J t − B q̇| ≤ l̇_max, by a linear program."""
    if not rates.any():
        return float("inf")
    p = B.shape[1]
    rows = np.concatenate([-B, rates[:, None]], axis=1)
    finite = np.isfinite(limits[p:])
    sides = limits[p:][finite]
    bounds = [(-q, q) for q in limits[:p]] + [(0, None)]
    rows, sides = np.concatenate([rows[finite], -rows[finite]]), np.concatenate([sides, sides])
    return largest_last(rows, sides, bounds=bounds)[0]


def _judged(robot: Robot, speeds: Array, scale: Array, limits: Array, method: str) -> TwistResolution:
    p = 3 * len(robot.bases)
    with np.errstate(invalid="ignore"):
        excess = np.abs(speeds) - limits * (1 + _TOLERANCE)
    feasible = np.asarray((excess <= 0).all(axis=-1))
    kept = np.where(feasible[..., None], np.clip(speeds, -limits, limits), speeds)
    reasons = np.empty(feasible.shape, dtype=object)
    for index in np.ndindex(feasible.shape):
        reasons[index] = "" if feasible[index] else _reason(robot, speeds[index], limits, float(scale[index]))
    single = feasible.ndim == 0
    return TwistResolution(frozen(kept[..., :p].copy()), frozen(kept[..., p:].copy()),
                           bool(feasible) if single else feasible, float(scale) if single else frozen(scale), method,
                           reasons[()] if single else reasons)


def _reason(robot: Robot, speeds: Array, limits: Array, scale: float) -> str:
    worst = int(np.argmax(np.abs(speeds) / np.where(limits > 0, limits, np.inf)))  # held directions do not move
    p = 3 * len(robot.bases)
    if worst < p:
        who = f"base {robot.bases[worst // 3].name!r} would drive {('θ', 'ρ₁', 'ρ₂')[worst % 3]} at"
    else:
        who = f"cable {worst - p + 1} would run at"
    unit = "rad/s" if worst < p and worst % 3 == 0 else "m/s"
    able = ("the twist can be reached: use method 'quadratic_program'" if scale >= 1
            else f"the largest feasible twist is {scale:.4g} times the wanted one")
    return f"{who} {abs(speeds[worst]):.4g} {unit}, allowed {limits[worst]:.4g}; {able}"
