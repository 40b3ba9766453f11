"""The balanced tensions of least norm, moved towards the improved closed form until they are inside the limits."""

import numpy as np

from ..arrays import Array
from . import improved_closed_form, pseudo_inverse
from .method import Answers, BatchSolver, vectorized


def batch() -> BatchSolver:
    """τ = τ_0 + s (τ_c − τ_0), the smallest s ≥ 0 inside the limits: τ_0 itself where it keeps them.

    τ_0 = −W⁺ w_e, τ_c is the improved closed form.
    Source: Müller, Reichert and Bruckmann 2015.
    """
    inner_solver, least_norm = improved_closed_form.batch(), pseudo_inverse.batch()

    def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
        inner, reasons = inner_solver(W, w_e, low, high)
        start, _ = least_norm(W, w_e, low, high)
        way = inner - start
        outside = np.clip(start, low, high) - start   # of each cable, which the way makes good as far as τ_c is inside
        steps = outside / np.where(outside * way > 0, way, np.inf)
        share, kept = np.minimum(steps.max(axis=-1), 1.0), ~outside.any(axis=-1)
        share[(reasons != "") & ~kept] = 1.0
        reasons[kept] = ""   # whatever became of τ_c
        return start + share[:, None] * way, reasons

    return solve


METHOD = vectorized(batch, complete=False,
                    summary="least norm, moved towards the improved closed form just until inside the limits")
