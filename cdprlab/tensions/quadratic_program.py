"""Least-norm tensions inside the limits: min ‖τ‖² subject to W τ + w_e = 0, τ_min ≤ τ ≤ τ_max."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput
from .method import Method, Solution, Solver

INFEASIBLE = "no tensions within the limits balance the wrench"


def build(n: int, tension_min: Array, tension_max: Array, *, solver: str = "quadprog") -> Solver:
    """min ‖τ‖² subject to W τ + w_e = 0 and the limits.

    solver : "quadprog", called directly, or any other that qpsolvers has installed
    Source: Okoli 2016, eq. (6.25); Goldfarb and Idnani 1983 (quadprog's dual active-set method).
    """
    if solver != "quadprog":
        return _other_solver(tension_min, tension_max, solver)
    import quadprog

    m = tension_min.shape[0]
    # quadprog wants Cᵀ x ≥ b with the equalities first; all but W and w_e is written once.
    identity, zero = np.eye(m), np.zeros(m)
    constraints = np.concatenate([np.zeros((m, n)), identity, -identity], axis=1)
    bounds = np.concatenate([np.zeros(n), tension_min, -tension_max])
    quadprog_solve = quadprog.solve_qp

    def solve(W: Array, w_e: Array) -> Solution:
        constraints[:, :n] = W.T
        np.negative(w_e, out=bounds[:n])
        try:
            return quadprog_solve(identity, zero, constraints, bounds, n, True)[0], ""
        except ValueError:
            return _without_dependent_rows(W, w_e, tension_min, tension_max)

    return solve


def min_norm(rows: Array, values: Array, low: Array, high: Array) -> Array | None:
    """min ‖τ‖² with rows τ = values and low ≤ τ ≤ high, rows independent; None if there is none."""
    import quadprog

    m = low.shape[0]
    identity = np.eye(m)
    constraints = np.concatenate([rows.T, identity, -identity], axis=1)
    bounds = np.concatenate([values, low, -high])
    try:
        return quadprog.solve_qp(identity, np.zeros(m), constraints, bounds, rows.shape[0], True)[0]
    except ValueError:
        return None


def independent_rows(W: Array, values: Array) -> tuple[Array, Array, float]:
    """Orthonormal rows with the same row space as W, their values, and how far ``values`` is off W's range.

    W τ = values  ⇔  rows τ = reduced, if the last number is zero.
    """
    u, s, vt = np.linalg.svd(W, full_matrices=False)
    rank = int((s > s[0] * max(W.shape) * np.finfo(float).eps).sum()) if s.size and s[0] > 0 else 0
    inside = u[:, :rank].T @ values
    outside = float(np.abs(values - u[:, :rank] @ inside).max(initial=0.0))
    return vt[:rank], inside / s[:rank], outside


def _without_dependent_rows(W: Array, w_e: Array, low: Array, high: Array) -> Solution:
    """What is left when the direct call fails: dependent rows of W, or truly no solution."""
    nothing = np.full(W.shape[1], np.nan)
    rows, values, outside = independent_rows(W, -w_e)
    if outside > 1e-8 * (1 + np.abs(w_e).max()):
        return nothing, (f"the cables cannot exert this wrench at any tension: W has rank {rows.shape[0]} of "
                         f"{W.shape[0]}, and {outside:.3g} N or N m lies outside its range")
    found = min_norm(rows, values, low, high)
    return (nothing, INFEASIBLE) if found is None else (found, "")


def _other_solver(low: Array, high: Array, solver: str) -> Solver:
    import qpsolvers

    if solver not in qpsolvers.available_solvers:
        raise InvalidInput(f"QP solver {solver!r} is not installed; there are "
                           f"{', '.join(qpsolvers.available_solvers)}")
    m = low.shape[0]

    def solve(W: Array, w_e: Array) -> Solution:
        rows, values, outside = independent_rows(W, -w_e)
        found = None if outside > 1e-8 * (1 + np.abs(w_e).max()) else qpsolvers.solve_qp(
            np.eye(m), np.zeros(m), A=rows, b=values, lb=np.array(low), ub=np.array(high), solver=solver)
        return (np.full(m, np.nan), INFEASIBLE) if found is None else (found, "")

    return solve


METHOD = Method(build, complete=True, summary="min ‖τ‖² inside the limits: smooth, low tensions")
