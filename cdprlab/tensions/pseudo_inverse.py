"""Least-norm tensions that ignore the limits: τ = −W⁺ w_e."""

from __future__ import annotations

from math import isfinite

import numpy as np

from ..arrays import Array
from .method import NOT_FINITE, Answers, BatchSolver, Method, Solution, Solver, no_reasons


def batch() -> BatchSolver:
    """τ = −W⁺ w_e; the limits only judge it afterwards.

    Source: Okoli 2016, eq. (6.26).
    """

    def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
        return -np.einsum("kij,kj->ki", np.linalg.pinv(W), w_e), no_reasons(W.shape[0])

    return solve


def build(n: int, tension_min: Array, tension_max: Array) -> Solver:
    """One wrench at a time. In a control loop too the limits play no part: its log tells where they were broken."""
    solve_batch = batch()

    def solve(W: Array, w_e: Array) -> Solution:
        tau = solve_batch(W[None], w_e[None], tension_min, tension_max)[0][0]
        return tau, "" if isfinite(sum(tau.tolist())) else NOT_FINITE

    return solve


METHOD = Method(build, False, "τ = −W⁺ w_e: least norm, limits ignored (tensions may be negative)", batch)
