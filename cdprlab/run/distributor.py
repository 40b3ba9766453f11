"""Tensions asked for at every step of a run: the method, what is whole to carry them, and what if it finds none."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..arrays import Array, as_array
from ..errors import InfeasibleTensions, InvalidInput, quoted
from ..robot import Robot
from ..tensions import TensionDistribution, checked_distribution, solver_for

INFEASIBLE = ("relax", "stop", "hold")
"""Where the method finds no tensions: take the least wrench error, raise, or keep the last tensions."""


class Distributor:
    """A method within the limits of the cables that are whole, and the last tensions it gave.

    method : a name, or a callable (W, w_e, tension_min, tension_max) → tensions or
        TensionDistribution
    infeasible : one of ``INFEASIBLE``
    """

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
        Raises InfeasibleTensions with infeasible="stop"; InvalidInput for a wrench that is not
        finite.
        """
        if self.last is None:
            wanted = as_array(wanted, "the controller's wrench", (self.robot.n_dof,), "N, N m")
        if self.whole is not None:
            W = W * self.whole  # the pseudo-inverse looks at no limits, but gives a zero column nothing
        tensions, reason = self.solve(W, -wanted)
        if self.whole is not None:
            tensions = tensions * self.whole  # what rounding leaves of nothing
        if not reason:
            self.last = tensions
            return tensions
        if not np.isfinite(wanted).all():
            raise InvalidInput(f"the controller asked for the wrench {wanted.tolist()} at t = {now:.4g} s; "
                               "it must be finite")
        if self.infeasible == "stop":
            raise InfeasibleTensions(f"at t = {now:.4g} s: {reason}; infeasible=\"relax\" goes on with the least "
                                     "wrench error inside the limits",
                                     self._judged(W, -wanted, tensions, reason,
                                                  self.low, self.high))
        if self.infeasible == "relax" or self.last is None:
            self.last = tensions if self.solve is self.relax else self.relax(W, -wanted)[0]
        return self.last

    def cut(self, indices: list[int]) -> None:
        """Ask nothing more of these cables."""
        self.whole = np.ones(self.robot.n_cables) if self.whole is None else self.whole.copy()
        self.whole[indices] = 0.0
        self._limit(self.low * self.whole, self.high * self.whole)
        if self.last is not None:
            self.last = self.last * self.whole

    def feasible(self, W: Array, w_e: Array, tensions: Array, cuts: Mapping[int, list[int]]) -> Any:
        """(N,) judged by the law for a whole run at once: equilibrium with the wanted wrench, and the limits.

        W : (N, n, m); w_e : (N, n); tensions : (N, m); cuts : step → cables cut as it begins
        """
        low, high = self.robot.tension_min, self.robot.tension_max
        if cuts:
            whole = np.ones(tensions.shape)
            for step, indices in cuts.items():
                whole[step:, indices] = 0.0
            low, high = low * whole, high * whole
        return self._judged(W, w_e, tensions, "", low, high).feasible

    def _limit(self, low: Array, high: Array) -> None:
        self.low, self.high = low, high
        self.relax = solver_for("relaxed", self.robot.n_dof, low, high)
        if self.method == "quadratic_program" and self.infeasible == "relax":
            self.solve = self.relax   # which begins with that program: nothing is asked twice
        elif isinstance(self.method, str):
            self.solve = solver_for(self.method, self.robot.n_dof, low, high)
        else:
            self.solve = _own_solver(self.method, low, high)

    def _judged(self, W: Array, w_e: Array, tensions: Array, reason: str, low: Array,
                high: Array) -> TensionDistribution:
        low, high = (np.broadcast_to(limit, tensions.shape) for limit in (low, high))
        reasons = np.broadcast_to(np.array(reason, dtype=object), tensions.shape[:-1])
        return checked_distribution(W, w_e, low, high, tensions, reasons,
                                    self.method if isinstance(self.method, str) else "")


def _own_solver(method: Callable[..., Any], low: Array, high: Array) -> Callable[[Array, Array], tuple[Array, str]]:
    """What ``solver_for`` gives of a named method, of somebody's own."""
    def solve(W: Array, w_e: Array) -> tuple[Array, str]:
        answer = method(W, w_e, low, high)
        if isinstance(answer, TensionDistribution):
            return answer.tensions, str(answer.reason)
        tensions = np.array(answer, float)  # a copy: the method may use its array again
        usable = tensions.shape == low.shape and bool(np.isfinite(tensions).all())
        return tensions, "" if usable else f"the method gave no {low.size} finite tensions"

    return solve
