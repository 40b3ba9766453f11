"""Least-norm tensions that ignore the limits: τ = −W⁺ w_e."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .method import Method, Solution, Solver


def build(n: int, tension_min: Array, tension_max: Array) -> Solver:
    """τ = −W⁺ w_e; the limits only judge it afterwards.

    Source: Okoli 2016, eq. (6.26).
    """

    def solve(W: Array, w_e: Array) -> Solution:
        return -np.linalg.pinv(W) @ w_e, ""

    return solve


METHOD = Method(build, complete=False, summary="τ = −W⁺ w_e: least norm, limits ignored (tensions may be negative)")
