"""Twist-feasible poses: the winches, and bases that drive along, are fast enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..mechanics.kinematics import Pivot, base_jacobian, jacobian
from ..mechanics.optimization import largest_last
from ..robot import Robot
from ..robot.pose import Pose
from ..sets.twist import base_speeds, moving_columns
from .criterion import Criterion, Judgement

_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class TwistFeasible(Criterion):
    """Every wanted twist keeps the speed limits: |J t − B_b q̇_b| ≤ l̇_max for some |q̇_b| ≤ q̇_b,max.

    twists : (k, n) or (n,) wanted [m/s, rad/s]
    half_widths : (n,) of a box of wanted twists around 0; give one of the two
    moving : bases that may drive: "all", "none", a name or several
    pivot : what θ turns a base about, as in `available_twist_set`
    margin : the smallest speed the winches have to spare, negative where one is short of it [m/s]
    Source: Gagliardini et al. 2018 (twist-feasible workspace); Lessanibahri et al. 2018.
    """

    twists: ArrayLike | None = None
    half_widths: ArrayLike | None = None
    moving: str | Sequence[str] = "none"
    pivot: Pivot = "base"
    unit = "m/s"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        if (self.twists is None) == (self.half_widths is None):
            raise InvalidInput("TwistFeasible takes twists or half_widths, one of the two")
        columns = moving_columns(robot, self.moving)
        bases = base_speeds(robot)[columns]
        if bases.any():
            spare = self._with_bases(robot, poses, columns, bases)
        else:
            spare = (robot.speed_max - self._fastest(robot, jacobian(robot, poses))).min(axis=-1)
        limited = robot.speed_max[np.isfinite(robot.speed_max)]
        return Judgement(spare >= -_ROUNDING * limited.max(initial=1.0), spare)

    def _fastest(self, robot: Robot, J: Array) -> Array:
        """(N, m) the largest |l̇| over the wanted twists."""
        if self.half_widths is not None:
            return np.asarray(np.abs(J) @ self._box(robot))
        return np.asarray(np.abs(J @ self._wanted(robot).T).max(axis=-1))

    def _with_bases(self, robot: Robot, poses: Pose, columns: list[int], bases: Array) -> Array:
        """The twist set is convex and symmetric: a box is in it where half of its corners are."""
        if self.half_widths is not None:
            signs = np.array([(1, *rest) for rest in product((1, -1), repeat=robot.n_dof - 1)])
            wanted = np.unique(signs * self._box(robot), axis=0)
        else:
            wanted = self._wanted(robot)
        J, B = jacobian(robot, poses), base_jacobian(robot, poses, self.pivot)
        B = np.broadcast_to(B, (*J.shape[:-1], B.shape[-1]))[..., columns]
        return np.array([min(speed_margin(rates, b, robot.speed_max, bases) for rates in wanted @ j.T)
                         for j, b in zip(J, B)])

    def _wanted(self, robot: Robot) -> Array:
        assert self.twists is not None
        return np.atleast_2d(as_array(self.twists, "twists", (robot.n_dof,), "m/s, rad/s", batch=True))

    def _box(self, robot: Robot) -> Array:
        assert self.half_widths is not None
        half = as_array(self.half_widths, "half_widths", (robot.n_dof,), "m/s, rad/s")
        if (half < 0).any():
            raise InvalidInput(f"half_widths must not be negative, got {half.tolist()}")
        return half


def speed_margin(rates: Array, B: Array, cables: Array, bases: Array) -> float:
    """Largest s with |J t − B q̇| ≤ l̇_max − s and |q̇| ≤ q̇_max.

    rates : J t, (m,); B : (m, a); cables : l̇_max, (m,) [m/s]; bases : q̇_max, (a,)
    """
    limited = np.isfinite(cables)
    if not limited.any():
        return np.inf
    B, rates, cables = B[limited], rates[limited], cables[limited]
    held = np.eye(len(bases), len(bases) + 1)
    ones = np.ones((len(cables), 1))
    rows = np.block([[-B, ones], [B, ones], [held], [-held]])
    return largest_last(rows, np.concatenate([cables - rates, cables + rates, bases, bases]))[0]
