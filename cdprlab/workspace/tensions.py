"""Workspaces of tensions: closure, feasibility of wrenches, equilibrium under weight and in motion, standing bases."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked
from ..errors import InvalidInput, quoted
from ..mechanics.dynamics import mass_matrix
from ..mechanics.statics import gravity_wrench, tipping_rows, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from .capacity import (
    ROUNDING,
    box_half_widths,
    box_loads,
    capacity_margins,
    external_wrenches,
    feasible,
    not_negative,
    standing_margin,
)
from .criterion import Criterion, Judgement, unknown
from .margins import tension_margins


@dataclass(frozen=True)
class WrenchClosure(Criterion):
    """Every wrench can be exerted by tensions large enough: W has full rank and an all-positive null vector.

    margin : the tension factor: the largest s with W τ = 0, s ≤ τ_i ≤ 1, the smallest over the
        largest tension at best; 0 where there is none, no unit
    Source: Gouttefarde and Gosselin 2006 (wrench-closure workspace, WCW); Pham, Yeo, Yang and
    Chen 2009 (tension factor).
    """

    unit = ""

    @checked
    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W = wrench_matrix(robot, poses)
        n, m = W.shape[-2:]
        s = tension_margins(W, np.zeros((len(W), n)), np.zeros(m), np.ones(m), at_high=False)
        s = np.where(np.linalg.matrix_rank(W) == n, s, 0.0)
        return Judgement(s > ROUNDING, s)


@checked
@dataclass(frozen=True, eq=False)
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

    @checked
    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        low, high = robot.tension_min, robot.tension_max
        loads = external_wrenches(self.wrenches, robot.n_dof)
        half = box_half_widths(self.half_widths, robot.n_dof, "N, N m")
        if self._by_facets():
            s = capacity_margins(W, weight, loads, half, low, high, exact=margin)[0]
            found = Judgement(not_negative(s, weight, low), s)
            return found if margin else unknown(found.inside)
        return _balanced(robot, W, [weight + load for load in box_loads(loads, half)], margin)

    def _by_facets(self) -> bool:
        if self.by not in (None, "tensions", "facets"):
            raise InvalidInput(f"by must be 'tensions' or 'facets', got {quoted(self.by)}")
        return self.by == "facets" or (self.by is None and self.half_widths is not None)


BOUNDLESS = 1e9
"""Weights: a cable that needs more is flat to double precision."""


@dataclass(frozen=True)
class StaticEquilibrium(Criterion):
    """Cables that only pull, however hard, balance the weight: no tension is too large for the verdict.

    margin : the smallest tension at best while none exceeds a hundred weights, 0 where one must [N]
    Source: Pusey et al. 2004 (static equilibrium workspace, SEW).
    """

    unit = "N"

    @checked
    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        none, heavy = np.zeros(robot.n_cables), np.full(robot.n_cables, robot.mass * max(robot.gravity, 1.0))
        free = tension_margins(W, weight, none, BOUNDLESS * heavy, at_high=False)
        inside = not_negative(free, weight, none)
        bounded = tension_margins(W, weight, none, 100 * heavy, at_high=False)
        return Judgement(inside, np.where(inside, np.maximum(bounded, 0.0), free))


@checked
@dataclass(frozen=True, eq=False)
class DynamicEquilibrium(Criterion):
    """Dynamic feasible: tensions within the limits give the platform, at rest, every acceleration of a box.

    accelerations : (n,) half widths of the box, in the motion pattern's rows [m/s², rad/s²]
    margin : as `WrenchFeasible` by tensions, the smallest over the box's corners [N]
    Source: Gagliardini, Gouttefarde and Caro 2016 (dynamic feasible workspace, DFW). That which
    some motion reaches (Barrette and Gosselin 2005) is larger.
    """

    accelerations: ArrayLike
    unit = "N"

    @checked
    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        half = as_array(self.accelerations, "accelerations", (robot.n_dof,), "m/s², rad/s²")
        W, weight, M = wrench_matrix(robot, poses), gravity_wrench(robot, poses), mass_matrix(robot, poses)
        # Wrenches are convex in the acceleration: the corners decide, and directions that are
        # held make none.
        corners = box_loads(np.zeros((1, half.size)), half)
        return _balanced(robot, W, [weight - M @ corner for corner in corners], margin)


@dataclass(frozen=True)
class TippingSafe(Criterion):
    """Tensions within the limits balance the weight and leave every mobile base standing.

    margin : the largest moment by which every footprint edge can be kept from lifting, negative
        where one must [N m]; −inf where the weight cannot be balanced at all
    Source: Pedemonte et al. 2020, eq. (21)–(24).
    """

    unit = "N m"

    @checked
    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        rows = tipping_rows(robot, poses)
        if not rows:
            raise InvalidInput("tipping needs bases with a footprint; this robot has none")
        A = np.concatenate([edge.matrix for edge in rows.values()], axis=-2)
        b = -np.concatenate([edge.offset for edge in rows.values()], axis=-1)
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        s = np.array([standing_margin(robot, *pose) for pose in zip(W, weight, A, b)])
        return Judgement(s >= 0, s)


def _balanced(robot: Robot, W: Array, wanted: list[Array], margin: bool) -> Judgement:
    """Whether tensions within the limits balance all wrenches that are wanted."""
    low, high = robot.tension_min, robot.tension_max
    if margin:
        s = np.array([tension_margins(W, w_e, low, high) for w_e in wanted])
        return Judgement(np.asarray(not_negative(s, np.array(wanted), low).all(axis=0)), s.min(axis=0))
    return unknown(np.logical_and.reduce([feasible(W, w_e, low, high) for w_e in wanted]))
