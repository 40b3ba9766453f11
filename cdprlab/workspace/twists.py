"""Twist-feasible poses: the winches, and bases that drive along, are fast enough."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, frozen_dataclass
from ..errors import InvalidInput
from ..mechanics.kinematics import base_jacobian, jacobian
from ..mechanics.optimization import largest_last
from ..robot import Robot
from ..robot.pose import Pose
from ..sets.twist import moving_columns
from .capacity import box_half_widths, box_loads, one_or_several
from .criterion import Criterion, Judgement

_ROUNDING = 1e-9
"""Of the speeds asked for; no speed limit is a tolerance."""


@frozen_dataclass
class TwistFeasible(Criterion):
    """Every wanted twist keeps the speed limits: |J t − B_b q̇_b| ≤ l̇_max for some |q̇_b| ≤ q̇_b,max.

    twists : (k, n) or (n,) wanted [m/s, rad/s]
    half_widths : (n,) of a box of wanted twists around 0; give one of the two
    moving : bases that may drive: "all", "none", a name or several, each turning about its own center
    margin : the smallest speed the winches have to spare, negative where one is short of it
        [m/s]
    Source: Gagliardini et al. 2018 (twist-feasible workspace, TFW); Lessanibahri et al. 2018.
    """

    twists: ArrayLike | None = None
    half_widths: ArrayLike | None = None
    moving: str | Sequence[str] = "none"
    unit = "m/s"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        if (self.twists is None) == (self.half_widths is None):
            raise InvalidInput("TwistFeasible takes twists or half_widths, one of the two")
        columns, n = moving_columns(robot, self.moving), robot.n_dof
        J, bases = jacobian(robot, poses), robot.base_speed_max[columns]
        wanted = one_or_several(self.twists, "twists", n, "m/s, rad/s")
        half = box_half_widths(self.half_widths, n, "m/s, rad/s")
        rates = np.abs(J @ wanted.T).max(axis=-1) + np.abs(J) @ half
        spare = (robot.speed_max - rates).min(axis=-1)
        if bases.any():
            B = base_jacobian(robot, poses)[..., columns]
            if half.any():  # the twist set is convex and symmetric: a box is in it where half of its corners are
                wanted = np.array_split(box_loads(wanted, half), 2)[0]
            spare = np.array([min(speed_margin(each, b, robot.speed_max, bases) for each in wanted @ j.T)
                              for j, b in zip(J, B)])
        return Judgement(spare >= -_ROUNDING * (1 + rates.max(axis=-1)), spare)


def speed_margin(rates: Array, B: Array, cables: Array, bases: Array) -> float:
    """Largest s with |J t − B q̇| ≤ l̇_max − s and |q̇| ≤ q̇_max.

    rates : J t, (m,); B : (m, a); cables : l̇_max, (m,) [m/s]; bases : q̇_max, (a,)
    """
    limited = np.isfinite(cables)
    if not limited.any():
        return np.inf
    B, rates, cables = B[limited], rates[limited], cables[limited]
    rows = np.column_stack([np.concatenate([-B, B]), np.ones(2 * len(B))])
    return largest_last(rows, np.append(cables - rates, cables + rates),
                        bounds=[*zip(-bases, bases), (None, None)])[0]
