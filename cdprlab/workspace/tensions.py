"""Workspaces of tensions: closure, feasibility of wrenches, equilibrium under weight and in motion, standing bases."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen_dataclass
from ..compiled import TOLERANCE
from ..errors import InvalidInput, quoted
from ..mechanics.dynamics import mass_matrix
from ..mechanics.statics import gravity_wrench, tipping_rows, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from .capacity import (
    balanced,
    box_half_widths,
    box_loads,
    capacity_margins,
    feasible,
    one_or_several,
    standing_margin,
)
from .criterion import Criterion, Judgement, unknown
from .margins import PARALLEL, tension_margins


@checked
@dataclass(frozen=True)
class WrenchClosure(Criterion):
    """Every wrench can be exerted by tensions large enough: W has full rank and an all-positive null vector.

    margin : the tension factor: the largest s with W τ = 0, s ≤ τ_i ≤ 1, the smallest over the
        largest tension at best; 0 where there is none, no unit
    Source: Gouttefarde and Gosselin 2006 (wrench-closure workspace, WCW); Pham, Yeo, Yang and
    Chen 2009 (tension factor).
    """

    unit = ""

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W = wrench_matrix(robot, poses)
        n, m = W.shape[-2:]
        s = tension_margins(W, np.zeros((len(W), n)), np.zeros(m), np.ones(m), at_high=False)
        s = np.where(np.linalg.matrix_rank(W) == n, s, 0.0)
        return Judgement(s > PARALLEL, s)


@frozen_dataclass
class WrenchFeasible(Criterion):
    """Tensions within the limits balance the weight and every one of the given external wrenches.

    wrenches : (k, n) or (n,) external wrenches besides the weight, their convex hull included;
        default 0 [N, N m]
    half_widths : (n,) of a box around each of them; default none [N, N m]
    by : "tensions", or "facets" of the available wrench set, which take a box of wrenches at
        the price of one; default the facets for a box
    margin : by tensions the largest s with τ_min + s ≤ τ ≤ τ_max − s, the smallest over the
        wrenches [N]; by facets the capacity margin, the smallest distance of a wrench from a
        facet [N, N and N m added with weight 1]
    Raises InvalidInput for half widths that are negative, or another ``by``.
    Source: Bosscher et al. 2006 (wrench-feasible workspace, WFW); capacity margin: Guay et al.
    2014, Ruiz et al. 2015.
    """

    wrenches: ArrayLike | None = None
    half_widths: ArrayLike | None = None
    by: str | None = None
    unit = "N"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        if self.by not in (None, "tensions", "facets"):
            raise InvalidInput(f"by must be 'tensions' or 'facets', got {quoted(self.by)}")
        loads = one_or_several(self.wrenches, "wrenches", robot.n_dof, "N, N m")
        half = box_half_widths(self.half_widths, robot.n_dof, "N, N m")
        corners = box_loads(loads, half)[:, None]
        if self.by == "tensions" or (self.by is None and self.half_widths is None):
            return _balanced(robot, poses, corners, margin)
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        s = capacity_margins(W, weight, loads, half, robot.tension_min, robot.tension_max)[0]
        return Judgement(balanced(s, W, weight, corners, robot.tension_min, robot.tension_max), s)


@checked
@dataclass(frozen=True)
class StaticEquilibrium(Criterion):
    """Cables that only pull, however hard, balance the weight: no tension is too large for the verdict.

    margin : the smallest tension at best while none exceeds a hundred weights, 0 where one must [N]
    Source: Pusey et al. 2004 (static equilibrium workspace, SEW).
    """

    unit = "N"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        from scipy.optimize import nnls

        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        none, most = np.zeros(robot.n_cables), np.full(robot.n_cables, 100 * robot.mass * max(robot.gravity, 1.0))
        s = tension_margins(W, weight, none, most, at_high=False)
        inside = np.asarray(s >= 0)
        for k in np.flatnonzero(s < 0):   # the cone of all pulls has no largest
            missed = nnls(W[k], -weight[k], maxiter=1000)[1]
            inside[k] = missed <= TOLERANCE * (1 + np.abs(weight[k]).max())
        return Judgement(inside, np.where(inside, np.maximum(s, 0.0), s))


@frozen_dataclass
class DynamicEquilibrium(Criterion):
    """Dynamic feasible: tensions within the limits give the platform, at rest, every acceleration of a box.

    accelerations : (n,) half widths of the box, in the motion pattern's rows [m/s², rad/s²]
    margin : as `WrenchFeasible` by tensions, the smallest over the box's corners [N]
    Source: Gagliardini, Gouttefarde and Caro 2016 (dynamic feasible workspace, DFW). That which
    some motion reaches (Barrette and Gosselin 2005) is larger.
    """

    accelerations: ArrayLike
    unit = "N"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        half = as_array(self.accelerations, "accelerations", (robot.n_dof,), "m/s², rad/s²")
        M = mass_matrix(robot, poses)
        # Wrenches are convex in the acceleration: the corners decide, and directions that are
        # held make none.
        corners = box_loads(0 * half[None], half)
        return _balanced(robot, poses, -np.array([M @ corner for corner in corners]), margin)


@checked
@dataclass(frozen=True)
class TippingSafe(Criterion):
    """Tensions within the limits balance the weight and leave every mobile base standing.

    margin : the largest moment by which every footprint edge can be kept from lifting, negative
        where one must [N m]; −inf where the weight cannot be balanced at all
    Source: Pedemonte et al. 2020, eq. (21)–(24).
    """

    unit = "N m"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        if len(poses.batch_shape) != 1:
            raise InvalidInput(f"TippingSafe judges a row of poses, got {quoted(poses)}")
        rows = tipping_rows(robot, poses)
        if not rows:
            raise InvalidInput("tipping needs bases with a footprint; this robot has none")
        A = np.concatenate([edge.matrix for edge in rows.values()], axis=-2)
        b = -np.concatenate([edge.offset for edge in rows.values()], axis=-1)
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        s, held = np.full(len(W), -np.inf), feasible(W, weight, robot.tension_min, robot.tension_max)
        s[held] = [standing_margin(robot, *pose) for pose in zip(W[held], weight[held], A[held], b[held])]
        return Judgement(s >= 0, s)


def _balanced(robot: Robot, poses: Pose, loads: Array, margin: bool) -> Judgement:
    """Whether tensions within the limits balance the weight and each of the loads (k, N or 1, n)."""
    W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
    low, high = robot.tension_min, robot.tension_max
    if margin:
        s = np.min([tension_margins(W, weight + load, low, high) for load in loads], axis=0)
        return Judgement(balanced(s, W, weight, loads, low, high), s)
    return unknown(np.logical_and.reduce([feasible(W, weight + load, low, high) for load in loads]))
