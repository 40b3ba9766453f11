"""The balanced tensions of least norm, moved towards the improved closed form until they are inside the limits."""

import numpy as np

from ..arrays import Array
from . import improved_closed_form, pseudo_inverse
from .method import Answers, vectorized


def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
    """τ = τ_0 + s (τ_c − τ_0), the smallest s ≥ 0 inside the limits: τ_0 itself where it keeps them.

    τ_0 = −W⁺ w_e, τ_c is the improved closed form.
    Source: Müller, Reichert and Bruckmann 2015.
    """
    inner, reasons = improved_closed_form.solve(W, w_e, low, high)
    start, _ = pseudo_inverse.solve(W, w_e, low, high)
    way = inner - start
    outside = np.clip(start, low, high) - start   # of each cable, which the way makes good as far as τ_c is inside
    steps = outside / np.where(outside * way > 0, way, np.inf)
    share, kept = np.minimum(steps.max(axis=-1), 1.0), ~outside.any(axis=-1)
    share[(reasons != "") & ~kept] = 1.0
    reasons[kept] = ""   # whatever became of τ_c
    return start + share[:, None] * way, reasons


METHOD = vectorized(solve, complete=False,
                    summary="least norm, moved towards the improved closed form just until inside the limits")
