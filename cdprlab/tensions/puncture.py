"""From the improved closed form straight towards low tensions, up to the point where the way leaves the limits."""

import numpy as np

from ..arrays import Array
from . import improved_closed_form
from .feasible_polygon import closest_tensions
from .method import LIMIT_TOLERANCE, Answers, BatchSolver, vectorized


def batch() -> BatchSolver:
    """τ = τ_c + s (τ_l − τ_c), the largest s ≤ 1 inside the limits.

    τ_c is the improved closed form, τ_l = τ_min − W⁺ (w_e + W τ_min).
    Source: Müller, Reichert and Bruckmann 2015.
    """
    start_solver = improved_closed_form.batch()

    def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
        start, reasons = start_solver(W, w_e, low, high)
        goal, _ = closest_tensions(W, w_e, low, high, 0.0)
        way = goal - start
        # Steps below rounding point nowhere; a cable at its limit must not stop the others for
        # them.
        moves = np.abs(way) > LIMIT_TOLERANCE * 1e-3 * high.max(axis=-1, keepdims=True)
        room = np.where(way > 0, high - start, low - start)
        steps = np.where(moves, room / np.where(moves, way, 1.0), 1.0)
        share = np.where(reasons == "", np.clip(steps.min(axis=-1), 0.0, 1.0), 0.0)
        return start + share[:, None] * way, reasons

    return solve


METHOD = vectorized(batch, complete=False,
                    summary="improved closed form, moved towards low tensions as far as the limits allow")
