"""Mobile bases and winches together: one platform twist, many ways to share it among base and cable speeds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen, lasting
from ..errors import InfeasibleTwist, InvalidInput
from ..robot import Robot
from ..robot.pose import Pose
from .kinematics import Pivot, base_jacobian, jacobian
from .optimization import largest_last, least_quadratic

# Limits are kept to this share of themselves: a thousand times what rounding leaves.
_TOLERANCE = 1e-9


@lasting
@dataclass(frozen=True, eq=False)
class TwistResolution:
    """Speeds that give a platform twist together: l̇ = J t − B_b q̇_b.

    base_speeds : (3p,) q̇_b = (θ̇, ρ̇₁, ρ̇₂) of each base in file order [rad/s, m/s, m/s]
    cable_speeds : (m,) l̇ [m/s]
    feasible : all limits are kept; it alone says whether the speeds may be used
    scale : the largest s for which s t can be reached at all, inf where nothing limits it
    reason : '' when feasible, else which limit is broken and the scale
    """

    base_speeds: Array
    cable_speeds: Array
    feasible: bool
    scale: float
    reason: str

    def require(self) -> TwistResolution:
        """Itself if it is feasible; raises InfeasibleTwist, carrying it, if not."""
        if self.feasible:
            return self
        raise InfeasibleTwist(self.reason, self)


@checked
def resolve_twist(robot: Robot, pose: Pose, twist: ArrayLike, *, pivot: Pivot = "base") -> TwistResolution:
    """Base and cable speeds for a wanted platform twist: min Σ (x / limit)² with l̇ + B_b q̇_b = J t, x = (q̇_b, l̇).

    All speeds keep their limits where that can be; a speed without a limit costs nothing.

    robot : a base direction with speed limit 0 is held
    pose : single
    twist : (n,) t in world axes at P [m/s, rad/s]
    pivot : what θ turns a base about, as in `base_jacobian`
    Returns TwistResolution.
    Source: Rasheed et al. 2018, eq. (14) and (15), the redundancy resolved by least norm.

    >>> import cdprlab as cl
    >>> world = cl.load_world("planar_mcdpr")
    >>> found = resolve_twist(world.robot, world.pose, [1.15, 1.675])
    >>> found.feasible, round(found.scale, 4)
    (True, 1.2195)
    """
    wanted = as_array(twist, "twist", (robot.n_dof,), "m/s, rad/s")
    if pose.batch_shape:
        raise InvalidInput("resolve_twist takes one pose, not a batch")
    p = 3 * len(robot.bases)
    limits = np.append(robot.base_speed_max, robot.speed_max)
    free = limits[:p] > 0
    # All speeds are M q̇_b + c: the bases' own, and J t − B_b q̇_b of the cables.
    M = np.concatenate([np.eye(p), -base_jacobian(robot, pose, pivot)])[:, free]
    c = np.concatenate([np.zeros(p), jacobian(robot, pose) @ wanted])
    # |M q̇_b + s c| ≤ limits, where there are limits.
    bound = np.isfinite(limits)
    rows, sides = np.column_stack([M, c])[bound], limits[bound]
    scale = largest_last(np.concatenate([rows, -rows]), np.tile(sides, 2))[0] if c.any() else np.inf
    speeds = c
    if free.any():
        root = 1 / np.where(limits > 0, limits, np.inf)
        drive = np.linalg.lstsq(root[:, None] * M, -root * c)[0]
        if (np.abs(M @ drive + c) > limits).any():
            # An infeasible twist gets the speeds of its largest feasible share, the rest left to
            # the cables.
            drive = _within_limits(M, min(scale, 1.0) * c, root, limits)
        speeds = M @ drive + c
    feasible = bool((np.abs(speeds) <= limits * (1 + _TOLERANCE)).all())
    if feasible:
        speeds = np.clip(speeds, -limits, limits)
    return TwistResolution(frozen(speeds[:p]), frozen(speeds[p:]), feasible, scale,
                           "" if feasible else _reason(robot, speeds, limits, scale))


def _within_limits(M: Array, c: Array, root: Array, limits: Array) -> Array:
    """min ‖D (M q̇ + c)‖² with |M q̇ + c| ≤ limits, by a quadratic program."""
    weighted = root[:, None] * M
    hessian = weighted.T @ weighted
    # Where weights leave a choice the program needs a strictly convex cost: the least norm
    # among equals.
    hessian += 1e-10 * max(np.trace(hessian), 1.0) * np.eye(len(hessian))
    bound = np.isfinite(limits) & M.any(axis=1)
    # Cᵀ q̇ ≥ b, relaxed by rounding so that a border case stays feasible.
    rows, rest, most = M[bound], c[bound], limits[bound] * (1 + _TOLERANCE / 10)
    found = least_quadratic(hessian, -weighted.T @ (root * c), np.concatenate([rows, -rows]).T,
                            np.concatenate([-most - rest, rest - most]))
    assert found is not None, "the largest feasible share of a twist keeps its limits"
    return found


def _reason(robot: Robot, speeds: Array, limits: Array, scale: float) -> str:
    ways = [(f"base {base.name!r} would drive {way} at", unit) for base in robot.bases
            for way, unit in (("θ", "rad/s"), ("ρ₁", "m/s"), ("ρ₂", "m/s"))]
    ways += [(f"cable {i + 1} would run at", "m/s") for i in range(robot.n_cables)]
    worst = np.argmax(np.abs(speeds) / np.where(limits > 0, limits, np.inf))  # held directions do not move
    who, unit = ways[worst]
    return (f"{who} {abs(speeds[worst]):.4g} {unit}, allowed {limits[worst]:.4g}; "
            f"the largest feasible twist is {scale:.4g} times the wanted one")
