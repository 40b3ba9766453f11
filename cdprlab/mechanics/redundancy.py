"""Mobile bases and winches together: one platform twist, many ways to share it among base and cable speeds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen, lasting
from ..errors import InfeasibleTwist, InvalidInput, quoted
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


@lasting
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


@checked
def resolve_twist(robot: Robot, pose: Pose, twist: ArrayLike, method: str = "quadratic_program",
                  *,
                  weights: ArrayLike | None = None, pivot: Pivot = "base") -> TwistResolution:
    """Base and cable speeds for a wanted platform twist: min Σ w x² with l̇ + B_b q̇_b = J t, x = (q̇_b, l̇).

    robot, pose : single or batched; a base direction with speed limit 0 is held
    twist : (…, n) t in world axes at P [m/s, rad/s]
    method : one of ``RESOLUTION_METHODS``
    weights : (3p + m,) w of the base speeds, then of the cable speeds; default 1 / limit², 0
        without a limit
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
        raise InvalidInput(f"unknown method {quoted(method)}; there are {', '.join(RESOLUTION_METHODS)}")
    wanted = as_array(twist, "twist", (robot.n_dof,), "m/s, rad/s", batch=True)
    rates = (jacobian(robot, pose) @ wanted[..., None])[..., 0]
    batch, p = rates.shape[:-1], 3 * len(robot.bases)
    B = np.broadcast_to(base_jacobian(robot, pose, pivot), (*rates.shape, p))
    # All speeds are x = M q̇_b + c: the bases' own, and J t − B_b q̇_b of the cables.
    M = np.concatenate([np.broadcast_to(np.eye(p), (*batch, p, p)), -B], axis=-2)
    c = np.concatenate([np.zeros((*batch, p)), rates], axis=-1)
    limits = np.concatenate([*(base.speed_max for base in robot.bases), robot.speed_max])
    free = limits[:p] > 0
    root = np.sqrt(_weights(weights, limits, method))
    speeds, scale = np.array(c), np.empty(batch)
    for index in np.ndindex(batch):
        ways, still = M[index][:, free], c[index]
        scale[index] = _largest_scale(ways, still, limits)
        if free.any():
            drive = np.linalg.lstsq(root[:, None] * ways, -root * still, rcond=None)[0]
            if method == "quadratic_program" and (np.abs(ways @ drive + still) > limits).any():
                # An infeasible twist gets the speeds of its largest feasible share, the rest
                # left to the cables.
                drive = _within_limits(ways, min(scale[index], 1.0) * still, root, limits)
            speeds[index] += ways @ drive
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
        raise InvalidInput(f"weights must not be negative, got {quoted(weights.tolist())}")
    return weights


def _within_limits(M: Array, c: Array, root: Array, limits: Array) -> Array:
    """min ‖D (M q̇ + c)‖² with |M q̇ + c| ≤ limits, by a quadratic program."""
    weighted, p = root[:, None] * M, M.shape[1]
    hessian = weighted.T @ weighted
    # Where weights leave a choice the program needs a strictly convex cost: the least norm
    # among equals.
    hessian += 1e-10 * max(float(np.trace(hessian)), 1.0) * np.eye(p)
    bound = np.isfinite(limits) & M.any(axis=1)
    # Cᵀ q̇ ≥ b, relaxed by rounding so that a border case stays feasible.
    rows, rest, most = M[bound], c[bound], limits[bound] * (1 + _TOLERANCE / 10)
    found = least_quadratic(hessian, -weighted.T @ (root * c),
                            np.concatenate([rows, -rows]).T.copy(),
                            np.concatenate([-most - rest, rest - most]))
    assert found is not None, "the largest feasible share of a twist keeps its limits"
    return found


def _largest_scale(M: Array, c: Array, limits: Array) -> float:
    """max s with |M q̇ + s c| ≤ limits, by a linear program."""
    if not c.any():
        return float("inf")
    bound = np.isfinite(limits)
    rows, sides = np.column_stack([M, c])[bound], limits[bound]
    return largest_last(np.concatenate([rows, -rows]), np.concatenate([sides, sides]))[0]


def _judged(robot: Robot, speeds: Array, scale: Array, limits: Array, method: str) -> TwistResolution:
    p = 3 * len(robot.bases)
    with np.errstate(invalid="ignore"):
        excess = np.abs(speeds) - limits * (1 + _TOLERANCE)
    feasible = np.asarray((excess <= 0).all(axis=-1))
    kept = np.where(feasible[..., None], np.clip(speeds, -limits, limits), speeds)
    reasons = np.full(feasible.shape, "", dtype=object)
    for index in map(tuple, np.argwhere(~feasible)):
        reasons[index] = _reason(robot, speeds[index], limits, scale[index])
    return TwistResolution(frozen(kept[..., :p].copy()), frozen(kept[..., p:].copy()),
                           feasible[()], frozen(scale)[()],
                           method, reasons[()])


def _reason(robot: Robot, speeds: Array, limits: Array, scale: float) -> str:
    worst = int(np.argmax(np.abs(speeds) / np.where(limits > 0, limits, np.inf)))  # held directions do not move
    p = 3 * len(robot.bases)
    who, unit = f"cable {worst - p + 1} would run at", "m/s"
    if worst < p:
        base, way = divmod(worst, 3)
        who = f"base {robot.bases[base].name!r} would drive {('θ', 'ρ₁', 'ρ₂')[way]} at"
        unit = ("rad/s", "m/s", "m/s")[way]
    able = ("the twist can be reached: use method 'quadratic_program'" if scale >= 1
            else f"the largest feasible twist is {scale:.4g} times the wanted one")
    return f"{who} {abs(speeds[worst]):.4g} {unit}, allowed {limits[worst]:.4g}; {able}"
