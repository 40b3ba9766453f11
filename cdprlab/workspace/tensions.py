"""Workspaces of tensions: closure, feasibility of wrenches, equilibrium under weight and in motion, standing bases."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, plain
from ..errors import InvalidInput
from ..mechanics.statics import gravity_wrench, tipping_rows, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from .capacity import capacity_margins
from .criterion import Criterion, Flags, Judgement, unknown, verdict
from .programs import margin_by_program, standing_by_program

ROUNDING = 1e-9
"""Of the largest limit: margins this far below zero are rounding."""


@dataclass(frozen=True)
class WrenchClosure(Criterion):
    """Every wrench can be exerted by tensions large enough: W has full rank and an all-positive null vector.

    margin : the largest s with W τ = 0, s ≤ τ_i ≤ 1, the smallest over the largest entry at best; 0 where there is none
    Source: Pham et al. 2006; Gouttefarde and Gosselin 2006.
    """

    unit = ""

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W = wrench_matrix(robot, poses)
        n, m = W.shape[-2:]
        s = tension_margins(W, np.zeros((len(W), n)), np.zeros(m), np.ones(m), at_high=False)
        s = np.where(np.linalg.matrix_rank(W) == n, s, 0.0)
        return Judgement(s > ROUNDING, s)


@dataclass(frozen=True, eq=False)
class WrenchFeasible(Criterion):
    """Tensions within the limits balance the weight and every one of the given external wrenches.

    wrenches : (k, n) or (n,) external wrenches besides the weight, their convex hull included; default 0 [N, N m]
    half_widths : (n,) of a box around each of them; default none [N, N m]
    by : "tensions", or "facets" of the available wrench set, which take a box of wrenches at the price of one;
        default the facets for a box
    margin : by tensions the largest s with τ_min + s ≤ τ ≤ τ_max − s, the smallest over the wrenches; by facets the
        smallest distance of a wrench from a facet, 1 N m counting as 1 N [N]
    Raises InvalidInput for half widths that are negative, or another ``by``.
    Source: Bosscher et al. 2006; tension margin: Ruiz et al. 2015 with all cables alike; capacity margin: Guay et al.
        2014.
    """

    wrenches: ArrayLike | None = None
    half_widths: ArrayLike | None = None
    by: str | None = None
    unit = "N"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W, weight = wrench_matrix(robot, poses), _weights(robot, poses)
        low, high = robot.tension_min, robot.tension_max
        loads, half = external_wrenches(self.wrenches, robot.n_dof), self._half(robot.n_dof)
        if self._by_facets():
            s = capacity_margins(W, weight, loads, half, low, high, exact=margin)[0]
            inside = s >= -ROUNDING * high.max()
            return Judgement(inside, s) if margin else unknown(inside)
        wanted = [weight + load if load.any() else weight for load in box_loads(loads, half)]
        if not margin:
            return unknown(np.logical_and.reduce([feasible(W, w_e, low, high) for w_e in wanted]))
        s = np.min([tension_margins(W, w_e, low, high) for w_e in wanted], axis=0)
        return Judgement(s >= -ROUNDING * high.max(), s)

    def _half(self, n: int) -> Array:
        half = np.zeros(n) if self.half_widths is None else as_array(self.half_widths, "half_widths", (n,), "N, N m")
        if (half < 0).any():
            raise InvalidInput(f"half_widths must not be negative, got {half.tolist()}")
        return half

    def _by_facets(self) -> bool:
        if self.by not in (None, "tensions", "facets"):
            raise InvalidInput(f"by must be 'tensions' or 'facets', got {self.by!r}")
        return self.by == "facets" or (self.by is None and self.half_widths is not None)


@dataclass(frozen=True)
class StaticEquilibrium(Criterion):
    """Cables that only pull, however hard, balance the weight.

    margin : the smallest tension at best, at most that at which the others reach a hundred weights [N]
    Source: Pusey et al. 2004 (static equilibrium workspace).
    """

    unit = "N"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W, weight = wrench_matrix(robot, poses), _weights(robot, poses)
        most = np.full(robot.n_cables, 100 * robot.mass * max(robot.gravity, 1.0))
        s = tension_margins(W, weight, np.zeros(robot.n_cables), most, at_high=False)
        return Judgement(s >= -ROUNDING * most.max(), s)


@dataclass(frozen=True, eq=False)
class DynamicEquilibrium(Criterion):
    """Tensions within the limits give the platform, at rest, every acceleration of a box.

    accelerations : (n,) half widths of the box, in the motion pattern's rows [m/s², rad/s²]
    margin : as `WrenchFeasible`, the smallest over the box's corners [N]
    Source: Barrette and Gosselin 2005 (dynamic workspace).
    """

    accelerations: ArrayLike
    unit = "N"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        half = as_array(self.accelerations, "accelerations", (robot.n_dof,), "m/s², rad/s²")
        W, weight, M = wrench_matrix(robot, poses), _weights(robot, poses), mass_matrix(robot, poses)
        low, high = robot.tension_min, robot.tension_max
        # Wrenches are convex in the acceleration: the corners decide, and directions that are held make none.
        wanted = [weight - M @ corner for corner in box_loads(np.zeros((1, half.size)), half)]
        if not margin:
            return unknown(np.logical_and.reduce([feasible(W, w_e, low, high) for w_e in wanted]))
        s = np.min([tension_margins(W, w_e, low, high) for w_e in wanted], axis=0)
        return Judgement(s >= -ROUNDING * high.max(), s)


@dataclass(frozen=True)
class TippingSafe(Criterion):
    """Tensions within the limits balance the weight and leave every mobile base standing.

    margin : the largest moment by which every footprint edge can be kept from lifting, negative where one must [N m];
        −inf where the weight cannot be balanced at all
    Source: Pedemonte et al. 2020, eq. (21)–(24).
    """

    unit = "N m"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        rows = tipping_rows(robot, poses)
        if not rows:
            raise InvalidInput("tipping needs bases with a footprint; this robot has none")
        A = np.concatenate([edge.matrix for edge in rows.values()], axis=-2)
        b = -np.concatenate([edge.offset for edge in rows.values()], axis=-1)
        W, weight = wrench_matrix(robot, poses), _weights(robot, poses)
        return verdict(np.array([standing_by_program(*pose, robot) for pose in zip(W, weight, A, b)]))


def tension_margins(W: Array, w_e: Array, low: Array, high: Array, *, at_high: bool = True) -> Array:
    """Largest s with W τ + w_e = 0 and τ_min + s ≤ τ ≤ τ_max − s, for each pose; −inf where nothing balances w_e.

    W : (N, n, m); w_e : (N, n) [N, N m]; low, high : (m,) [N]
    at_high : whether s is kept from the upper limits too
    Returns (N,) [N], negative where the limits must be broken by −s.

    >>> W = np.array([[[1.0, -1.0]]])
    >>> tension_margins(W, np.zeros((1, 1)), np.array([1.0, 1.0]), np.array([5.0, 9.0]))
    array([2.])
    """
    return best_tensions(W, w_e, low, high, at_high=at_high)[0]


def best_tensions(W: Array, w_e: Array, low: Array, high: Array, *, at_high: bool = True) -> tuple[Array, Array]:
    """`tension_margins` and tensions (N, m) that have them, NaN where nothing balances w_e."""
    from ..compiled import margins as kernel

    s, tau, found = kernel.margins(plain(W), plain(w_e), plain(low), plain(high), 1.0, 1.0 if at_high else 0.0)
    s[found == kernel.UNREACHABLE] = -np.inf
    for k in np.flatnonzero((found == kernel.TOO_REDUNDANT) | (found == kernel.UNSETTLED)):
        s[k], tau[k] = margin_by_program(W[k], w_e[k], low, high, at_high)
    return s, tau


def mass_matrix(robot: Robot, poses: Pose) -> Array:
    """(N, n, n) inertia of the platform at rest in the motion pattern's rows, moments at P [kg, kg m, kg m²]."""
    body, R = robot.platform, poses.rotation
    arm = (R @ body.center_of_mass)
    d = robot.dimension
    if d == 2:
        full = np.zeros((*R.shape[:-2], 3, 3))
        full[..., 0, 0] = full[..., 1, 1] = body.mass
        full[..., 2, 0] = full[..., 0, 2] = -body.mass * arm[..., 1]
        full[..., 2, 1] = full[..., 1, 2] = body.mass * arm[..., 0]
        full[..., 2, 2] = body.inertia + body.mass * (arm**2).sum(axis=-1)
        return full[..., :robot.n_dof, :robot.n_dof]
    from ..robot.pose import cross_matrix

    cross, full = cross_matrix(arm), np.zeros((*R.shape[:-2], 6, 6))
    full[..., :3, :3] = body.mass * np.eye(3)
    full[..., :3, 3:], full[..., 3:, :3] = -body.mass * cross, body.mass * cross
    full[..., 3:, 3:] = R @ body.inertia @ np.swapaxes(R, -1, -2) - body.mass * cross @ cross
    basis = robot.pattern.basis(R)
    return np.swapaxes(basis, -1, -2) @ full @ basis


def external_wrenches(wrenches: ArrayLike | None, n: int) -> Array:
    """(k, n) from None, one or several."""
    if wrenches is None:
        return np.zeros((1, n))
    return np.atleast_2d(as_array(wrenches, "wrenches", (n,), "N, N m", batch=True))


def box_loads(loads: Array, half: Array) -> Array:
    """(k 2ʰ, n) corners of a box around each load; directions without width make none."""
    signs = np.array(list(product(*[(1.0, -1.0) if h else (0.0,) for h in half])))
    return np.asarray((loads[:, None] + signs * half).reshape(-1, half.size))


def _weights(robot: Robot, poses: Pose) -> Array:
    """(N, n); with the center of mass at P the weight makes no moment, and is the same at all poses."""
    if not robot.platform.is_off_center and poses.batch_shape and len(poses):
        poses, shape = poses[:1], poses.batch_shape
        return np.broadcast_to(gravity_wrench(robot, poses), (*shape, robot.n_dof))
    return np.broadcast_to(gravity_wrench(robot, poses), (*poses.batch_shape, robot.n_dof))


def feasible(W: Array, w_e: Array, low: Array, high: Array) -> Flags:
    """Whether tensions within the limits balance each wrench: the sign of `tension_margins`, found quicker."""
    from ..compiled import verdicts as kernel

    found = kernel.verdicts(plain(W), plain(w_e), plain(low[None]), plain(high[None]))
    inside = np.asarray(found == kernel.INSIDE)
    many = found == kernel.TOO_REDUNDANT
    if many.any():
        inside[many] = tension_margins(W[many], w_e[many], low, high) >= -ROUNDING * high.max()
    return inside
