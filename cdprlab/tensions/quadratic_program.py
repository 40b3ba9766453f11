"""Least-norm tensions inside the limits: min ‖τ‖² subject to W τ + w_e = 0, τ_min ≤ τ ≤ τ_max."""

from collections.abc import Callable
from functools import cached_property, partial

import numpy as np

from ..arrays import Array
from ..compiled import NEAREST, TOLERANCE
from ..errors import InvalidInput, needed_by, quoted
from ..mechanics.optimization import least_quadratic
from .feasible_polygon import polygon_points
from .law import NOT_FINITE, forgiven
from .method import INFEASIBLE, UNREACHABLE, Answers, Method, Solution, Solver, around_fixed, one_by_one, sharpened

Program = Callable[..., Array | None]
"""What `least_quadratic` is: a program's arguments → its answer, None where nothing keeps the rows."""


class LeastNorm:
    """min ‖τ‖² with W τ + w_e = 0 and τ_min ≤ τ ≤ τ_max: made for its limits, called wrench by wrench."""

    def __init__(self, n: int, low: Array, high: Array, least: Program = least_quadratic):
        from ..compiled.least_norm import no_limit_active

        self.n, self.low, self.high, self.least = n, low, high, least
        self.no_limit_active = no_limit_active

    @cached_property
    def constraints(self) -> tuple[Array, Array]:
        """`kept_rows`, all but W and w_e of them: written once."""
        return kept_rows(np.zeros((self.n, self.low.size)), np.zeros(self.n), self.low, self.high)

    def __call__(self, W: Array, w_e: Array) -> Solution:
        """Tensions and '' or the reason why there are none."""
        tau, kept = self.no_limit_active(W, w_e, self.low, self.high)
        if not kept:
            tau = self.least(*self.program(W, w_e))
        if tau is not None:
            return tau, ""
        if not np.isfinite(w_e).all():
            return np.full(self.low.size, np.nan), NOT_FINITE
        return self.otherwise(W, w_e)

    def program(self, W: Array, w_e: Array) -> tuple[Array, Array, Array, Array, int, bool]:
        """What `least_quadratic` takes."""
        C, b = self.constraints
        C[:, :self.n] = W.T
        b[:self.n] = -w_e
        return np.eye(self.low.size), np.zeros(self.low.size), C, b, self.n, True

    def otherwise(self, W: Array, w_e: Array) -> Solution:
        """What is left when the program fails: dependent rows of W, a single point, or truly no solution."""
        nothing = np.full(W.shape[1], np.nan)
        rows, values, outside = independent_rows(W, -w_e)
        if outside > TOLERANCE * (1 + np.abs(w_e).max()):
            return nothing, (f"the cables cannot exert this wrench at any tension: W has rank {len(rows)} of "
                             f"{len(W)}, and {outside:.3g} N or N m lies outside its range")
        for slack in (0.0, forgiven(w_e, self.low)):   # one last tension on the very border is lost to rounding
            wider = LeastNorm(len(rows), self.low - slack, self.high + slack)
            found = self.least(*wider.program(rows, -values))
            if found is not None:
                return sharpened(W, w_e, self.low, self.high, found), ""
        return nothing, INFEASIBLE


def kept_rows(W: Array, w_e: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """C and b of Cᵀ τ ≥ b: W τ + w_e = 0 first, as equalities, then τ_min ≤ τ ≤ τ_max."""
    eye = np.eye(low.size)
    return np.concatenate([W.T, eye, -eye], axis=1), np.concatenate([-w_e, low, -high])


def independent_rows(W: Array, values: Array) -> tuple[Array, Array, float]:
    """Orthonormal rows with the same row space as W, their values, and how far ``values`` is off W's range.

    W τ = values  ⇔  rows τ = reduced, if the last number is zero.
    """
    u, s, vt = np.linalg.svd(W, full_matrices=False)
    rank = np.linalg.matrix_rank(W)
    inside = u[:, :rank].T @ values
    return vt[:rank], inside / s[:rank], np.abs(values - u[:, :rank] @ inside).max(initial=0.0)


def build(n: int, tension_min: Array, tension_max: Array, *, solver: str = "quadprog") -> Solver:
    """min ‖τ‖² subject to W τ + w_e = 0 and the limits.

    solver : "quadprog", called directly, or any other that qpsolvers has installed
    Source: Okoli 2016, eq. (6.25).
    """
    return around_fixed(partial(LeastNorm, n, least=_program_of(solver)), tension_min, tension_max)


def solve(W: Array, w_e: Array, low: Array, high: Array, *, solver: str = "quadprog") -> Answers:
    """The same for many wrenches: with up to two redundant cables the polygon's point nearest to 0, else one by one."""
    tensions, reasons, spare = polygon_points(W, w_e, low, high, NEAREST)
    left = (spare > 2) | (reasons == UNREACHABLE) | (solver != "quadprog")   # of which the program says more
    one_by_one(left, partial(build, W.shape[1], solver=solver), W, w_e, low, high, tensions, reasons)
    return tensions, reasons


def _program_of(solver: str) -> Program:
    """`least_quadratic`, or the same by another solver."""
    if solver == "quadprog":
        return least_quadratic
    with needed_by(f"the QP solver {solver!r}", "quadprog works without it"):
        import qpsolvers

    if solver not in qpsolvers.available_solvers:
        raise InvalidInput(f"QP solver {quoted(solver)} is not installed; there are "
                           f"{', '.join(qpsolvers.available_solvers)}")

    def least(H: Array, a: Array, C: Array, b: Array, equal: int, factored: bool) -> Array | None:
        # H is the identity, factored or not.
        found: Array | None = qpsolvers.solve_qp(H, -a, -C[:, equal:].T, -b[equal:], C[:, :equal].T, b[:equal],
                                                 solver=solver)
        return found

    return least


METHOD = Method(solve, build, complete=True, summary="min ‖τ‖² inside the limits: smooth, low tensions")
