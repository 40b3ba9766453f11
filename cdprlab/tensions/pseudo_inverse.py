"""Least-norm tensions that ignore the limits: τ = −W⁺ w_e."""

import numpy as np

from ..arrays import Array
from .feasible_polygon import closest_tensions
from .method import Answers, vectorized


def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
    """τ = −W⁺ w_e; the limits only judge it afterwards. `infeasible="send"` commands it as it is.

    Source: Okoli 2016, eq. (6.26).
    """
    nothing = np.zeros((1, W.shape[2]))
    return closest_tensions(W, w_e, nothing, nothing + 1, 0.0)[0], np.full(len(W), "", dtype=object)


METHOD = vectorized(solve, complete=False,
                    summary="τ = −W⁺ w_e: least norm, limits ignored (tensions may be negative)")
