"""Least-norm tensions that ignore the limits: τ = −W⁺ w_e."""

import numpy as np

from ..arrays import Array
from .method import Answers, BatchSolver, no_reasons, vectorized


def batch() -> BatchSolver:
    """τ = −W⁺ w_e; the limits only judge it afterwards. In a control loop its log tells where they were broken.

    Source: Okoli 2016, eq. (6.26).
    """

    def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
        return -np.einsum("kij,kj->ki", np.linalg.pinv(W), w_e), no_reasons(W.shape[0])

    return solve


METHOD = vectorized(batch, complete=False,
                    summary="τ = −W⁺ w_e: least norm, limits ignored (tensions may be negative)")
