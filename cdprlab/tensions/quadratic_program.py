"""Least-norm tensions inside the limits: min ‖τ‖² subject to W τ + w_e = 0, τ_min ≤ τ ≤ τ_max."""

from functools import cached_property, partial

import numpy as np

from ..arrays import Array
from ..compiled import TOLERANCE
from ..errors import InvalidInput, needed_by, quoted
from ..mechanics.optimization import least_quadratic
from .feasible_polygon import least_norm_points
from .law import NOT_FINITE, forgiven
from .method import (
    INFEASIBLE,
    UNREACHABLE,
    Answers,
    Method,
    Solution,
    Solver,
    around_fixed,
    no_reasons,
    one_by_one,
    sharpened,
)


class LeastNorm:
    """min ‖τ‖² with W τ + w_e = 0 and τ_min ≤ τ ≤ τ_max: made for its limits, called wrench by wrench."""

    def __init__(self, n: int, low: Array, high: Array):
        from ..compiled.least_norm import no_limit_active

        self.n, self.low, self.high = n, low, high
        self.no_limit_active = no_limit_active

    def __call__(self, W: Array, w_e: Array) -> Solution:
        """Tensions and '' or the reason why there are none."""
        tau, kept = self.no_limit_active(W, w_e, self.low, self.high)
        if not kept:
            tau = least_quadratic(*self.program(W, w_e))
        return self.by_independent_rows(W, w_e) if tau is None else (tau, "")

    def program(self, W: Array, w_e: Array) -> tuple[Array, Array, Array, Array, int, bool]:
        """What `least_quadratic` takes."""
        C, b = self.constraints
        C[:, :self.n] = W.T
        np.negative(w_e, out=b[:self.n])
        return self.identity, np.zeros(self.low.size), C, b, self.n, True

    @cached_property
    def identity(self) -> Array:
        """‖τ‖²."""
        return np.eye(self.low.size)

    @cached_property
    def constraints(self) -> tuple[Array, Array]:
        """C and b of Cᵀ τ ≥ b, equalities first: all but W and w_e is written once."""
        one, nothing = self.identity, np.zeros((self.low.size, self.n))
        return np.concatenate([nothing, one, -one], axis=1), np.concatenate([nothing[0], self.low, -self.high])

    def by_independent_rows(self, W: Array, w_e: Array) -> Solution:
        """What is left when the program fails: dependent rows of W, a single point, or truly no solution."""
        nothing = np.full(W.shape[1], np.nan)
        if not np.isfinite(w_e).all():
            return nothing, NOT_FINITE
        rows, values, outside = independent_rows(W, -w_e)
        if outside > TOLERANCE * (1 + np.abs(w_e).max()):
            return nothing, (f"the cables cannot exert this wrench at any tension: W has rank {len(rows)} of "
                             f"{len(W)}, and {outside:.3g} N or N m lies outside its range")
        found = least_quadratic(*LeastNorm(len(rows), self.low, self.high).program(rows, -values))
        if found is None:   # one last tension on the very border is lost to rounding
            slack = forgiven(w_e, self.low)
            wider = LeastNorm(len(rows), self.low - slack, self.high + slack)
            found = least_quadratic(*wider.program(rows, -values))
            if found is None:
                return nothing, INFEASIBLE
            found = sharpened(W, w_e, self.low, self.high, found)
        return found, ""


def independent_rows(W: Array, values: Array) -> tuple[Array, Array, float]:
    """Orthonormal rows with the same row space as W, their values, and how far ``values`` is off W's range.

    W τ = values  ⇔  rows τ = reduced, if the last number is zero.
    """
    u, s, vt = np.linalg.svd(W, full_matrices=False)
    rank = int((s > s[0] * max(W.shape) * np.finfo(float).eps).sum()) if s.size and s[0] > 0 else 0
    inside = u[:, :rank].T @ values
    outside = float(np.abs(values - u[:, :rank] @ inside).max(initial=0.0))
    return vt[:rank], inside / s[:rank], outside


def build(n: int, tension_min: Array, tension_max: Array, *, solver: str = "quadprog") -> Solver:
    """min ‖τ‖² subject to W τ + w_e = 0 and the limits.

    solver : "quadprog", called directly, or any other that qpsolvers has installed
    Source: Okoli 2016, eq. (6.25).
    """
    one = partial(LeastNorm, n) if solver == "quadprog" else partial(_other_solver, solver)
    return around_fixed(one, tension_min, tension_max)


def solve(W: Array, w_e: Array, low: Array, high: Array, *, solver: str = "quadprog") -> Answers:
    """The same for many wrenches: with up to two redundant cables the polygon's point nearest to 0, else one by one."""
    if solver == "quadprog":
        tensions, reasons, spare = least_norm_points(W, w_e, low, high)
        left = (spare > 2) | (reasons == UNREACHABLE)   # of which the program says more
    else:
        tensions, reasons, left = np.empty((len(W), W.shape[2])), no_reasons(len(W)), np.full(len(W), True)
    one_by_one(left, partial(build, W.shape[1], solver=solver), W, w_e, low, high, tensions, reasons)
    return tensions, reasons


def _other_solver(solver: str, low: Array, high: Array) -> Solver:
    with needed_by(f"the QP solver {solver!r}", "quadprog works without it"):
        import qpsolvers

    if solver not in qpsolvers.available_solvers:
        raise InvalidInput(f"QP solver {quoted(solver)} is not installed; there are "
                           f"{', '.join(qpsolvers.available_solvers)}")
    m = low.shape[0]

    def solve(W: Array, w_e: Array) -> Solution:
        rows, values, outside = independent_rows(W, -w_e)
        reachable = outside <= TOLERANCE * (1 + np.abs(w_e).max())
        found = qpsolvers.solve_qp(np.eye(m), np.zeros(m), A=rows, b=values, lb=np.array(low),
                                   ub=np.array(high),
                                   solver=solver) if reachable else None
        return (np.full(m, np.nan), INFEASIBLE) if found is None else (found, "")

    return solve


METHOD = Method(solve, build, complete=True, summary="min ‖τ‖² inside the limits: smooth, low tensions")
