"""The middle of all feasible tensions: the area centroid of their polygon."""

import numpy as np

from ..arrays import Array
from ..compiled import CENTROID
from .feasible_polygon import polygon_points
from .method import Answers, vectorized


def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
    """Centroid of {τ : W τ + w_e = 0, τ_min ≤ τ ≤ τ_max}: of its area for r = 2, its length for r = 1.

    The same point in every basis of W's null space, since a centroid is affine.
    Source: Mikelsons et al. 2008; Lamaury and Gouttefarde 2013.
    """
    tensions, reasons, spare = polygon_points(W, w_e, low, high, CENTROID)
    for k in np.flatnonzero((spare > 2) & (reasons == "")):
        reasons[k] = f"the barycenter is computed for at most 2 redundant cables; here there are {spare[k]}"
    return tensions, reasons


METHOD = vectorized(solve, complete=True, summary="centroid of all feasible tensions: far from the limits, continuous; "
                                                  "at most 2 redundant cables")
