"""Tensions asked for at every step of a run: the method, what is whole to carry them, and what if it finds none."""

from typing import Any

import numpy as np

from ..arrays import Array, as_answer, frozen
from ..errors import InfeasibleTensions, InvalidInput, quoted
from ..robot import Robot
from ..tensions import TensionDistribution, checked_distribution, solver_for
from ..tensions.method import Solution, Solver

INFEASIBLE = ("relax", "stop", "hold", "send")
"""Where the method's tensions are not feasible: take the least wrench error, raise, keep the last ones, send them."""


class Distributor:
    """A method within the limits of the cables that are whole, and the last tensions it gave.

    method : a name, or a callable (W, w_e, tension_min, tension_max) → tensions or
        TensionDistribution, whose answers are judged like all others
    infeasible : one of ``INFEASIBLE``
    found : whether what `tensions` last gave balances the wrench inside the limits
    """

    found: bool

    def __init__(self, robot: Robot, method: Any, infeasible: str) -> None:
        if infeasible not in INFEASIBLE:
            raise InvalidInput(f"infeasible must be one of {', '.join(INFEASIBLE)}, got {quoted(infeasible)}")
        self.robot, self.method, self.infeasible = robot, method, infeasible
        self.whole: Array | None = None
        self.last: Array | None = None
        self._limit(robot.tension_min, robot.tension_max)

    def tensions(self, W: Array, wanted: Array, now: float) -> Array:
        """(m,) that exert the wanted wrench, or what is held in their place.

        now : for what is raised [s]
        Raises InfeasibleTensions with infeasible="stop", and with "send" where the method has no
        answer; InvalidInput for answers of a caller's own method that are no tensions.
        """
        if self.whole is not None:
            W = W * self.whole  # the pseudo-inverse looks at no limits, but gives a zero column nothing
        tensions, reason = (self._own_answer(W, -wanted, now) if self.solve is None else
                            self.solve(W, -wanted))
        if self.whole is not None:
            tensions = tensions * self.whole  # what rounding leaves of nothing
        self.found = not reason
        if self.found or (self.infeasible == "send" and np.isfinite(tensions).all()):
            self.last = tensions
            return tensions
        if self.infeasible in ("stop", "send"):
            raise InfeasibleTensions(f"at t = {now:.4g} s: {reason}; infeasible=\"relax\" goes on with the least "
                                     "wrench error inside the limits", self._judged(W, -wanted, tensions, reason))
        if self.infeasible == "relax" or self.last is None:
            if self.solve is not self.relax:
                tensions, reason = self.relax(W, -wanted)
            self.last, self.found = tensions, not reason
        return self.last

    def cut(self, indices: list[int]) -> None:
        """Ask nothing more of these cables."""
        self.whole = np.ones(self.robot.n_cables) if self.whole is None else self.whole.copy()
        self.whole[indices] = 0.0
        self._limit(self.low * self.whole, self.high * self.whole)
        if self.last is not None:
            self.last = self.last * self.whole

    def _limit(self, low: Array, high: Array) -> None:
        self.low, self.high = frozen(low), frozen(high)
        self.relax = solver_for("relaxed", self.robot.n_dof, low, high)
        self.solve: Solver | None = None   # a caller's own method is asked with more care
        if self.method == "quadratic_program" and self.infeasible == "relax":
            self.solve = self.relax   # which begins with that program: nothing is asked twice
        elif isinstance(self.method, str):
            self.solve = solver_for(self.method, self.robot.n_dof, low, high)

    def _own_answer(self, W: Array, w_e: Array, now: float) -> Solution:
        """What solvers of named methods give, of the caller's own method; its arrays are its own to write into."""
        said, answer = "", self.method(frozen(W), frozen(w_e), self.low, self.high)
        if isinstance(answer, TensionDistribution):
            said, answer = str(answer.reason), answer.tensions
            if said and answer.shape == self.low.shape and np.isnan(answer).any():
                return answer, said   # it has none, and says why
        tensions = as_answer(answer, "the method's tensions", self.low.size, "N", now)
        # A copy: the method may use its array again.
        judged = self._judged(W, w_e, tensions.copy(), said)
        return judged.tensions, said or str(judged.reason)

    def _judged(self, W: Array, w_e: Array, tensions: Array, reason: str) -> TensionDistribution:
        return checked_distribution(W, w_e, self.low, self.high, tensions, reason,
                                    self.method if isinstance(self.method, str) else "")
