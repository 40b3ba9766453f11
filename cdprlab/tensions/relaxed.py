"""When no tensions balance the wrench: the least wrench error inside the limits, then the least tensions."""

from functools import partial

import numpy as np

from ..arrays import Array, Flags
from ..compiled import TOLERANCE
from ..mechanics.optimization import least_quadratic
from . import quadratic_program
from .law import tension_scale
from .method import INFEASIBLE, Answers, Method, Solution, Solver, around_fixed, one_by_one
from .quadratic_program import LeastNorm

# The first program's weight on ‖τ‖², relative to W's: small enough to find the right active
# limits, large enough for a Cholesky factor in double precision. The second stage removes its
# bias.
_RIDGE = 1e-9


class Relaxed(LeastNorm):
    """Least norm where tensions balance the wrench, else the least wrench error."""

    def otherwise(self, W: Array, w_e: Array) -> Solution:
        """First the least error, then of all tensions that give this wrench the least."""
        tau, movable = self.least_error(W, w_e)
        if movable.any():
            columns = W[:, movable]
            least, lost = LeastNorm(self.n, self.low[movable], self.high[movable])(columns, -(columns @ tau[movable]))
            if not lost:   # to rounding
                tau[movable] = least
        left = np.abs(W @ tau + w_e).max()
        return tau, "" if left <= TOLERANCE * (1 + np.abs(w_e).max()) else f"{INFEASIBLE}; {left:.3g} N or N m is left"

    def least_error(self, W: Array, w_e: Array) -> tuple[Array, Flags]:
        """min ‖W τ + w_e‖ inside the limits, and which cables the error leaves a choice; none if it is the only point.

        The program finds the cables at a limit, the free ones are then solved anew without its
        ridge.
        """
        low, high, goal = self.low, self.high, -w_e
        reach = (np.abs(W) @ high).max()
        away = np.abs(w_e).max()
        if away > reach:   # no tolerance grows beyond what cables can do; far away only the direction counts
            w_e = w_e * (reach / away)
            goal = goal * min(1.0, 1e5 * reach / away)
        gram = W.T @ W
        gram += _RIDGE * (np.trace(gram) or 1.0) * np.eye(low.size)
        C, b = self.constraints
        found = least_quadratic(gram, W.T @ goal, C[:, self.n:], b[self.n:])
        assert found is not None, "limits are in order"
        at_limit = 1e-6 * tension_scale(w_e, low)   # a thousand times the ridge
        at_low, at_high = found <= low + at_limit, found >= high - at_limit
        free = ~(at_low | at_high)
        tau = np.where(at_low, low, np.where(at_high, high, found))
        tau[free], _, rank, _ = np.linalg.lstsq(W[:, free], goal - W[:, ~free] @ tau[~free])
        sharp = (np.minimum(tau - low, high - tau) >= -TOLERANCE * tension_scale(w_e, low)).all()
        tau = np.clip(tau if sharp else found, low, high)
        # A cable that the error pulls against its limit stays there, whatever the others do.
        pull = np.abs(W.T @ (W @ tau - goal))
        movable = free | (pull <= 1e-9 * np.abs(W).max() * np.abs(goal).max())
        return tau, movable & (not sharp or rank < movable.sum())


def build(n: int, tension_min: Array, tension_max: Array) -> Solver:
    """First min ‖W τ + w_e‖ inside the limits, then min ‖τ‖ among the tensions that reach it.

    Source: the lexicographic limit of Okoli 2016's slack program (6.3.3).
    """
    return around_fixed(partial(Relaxed, n), tension_min, tension_max)


def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
    """The quadratic program where it has an answer; the others one by one."""
    tensions, reasons = quadratic_program.solve(W, w_e, low, high)
    one_by_one(reasons != "", partial(build, W.shape[1]), W, w_e, low, high, tensions, reasons)
    return tensions, reasons


METHOD = Method(solve, build, complete=True, summary="least wrench error inside the limits, then least norm")
