"""The closed form again and again: the cable that leaves its limits by most is fixed there, the rest solved anew."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .method import Answers, BatchSolver, fixed_cables, vectorized
from .polygon import closest_tensions

OUT_OF_REDUNDANCY = "the improved closed form ran out of redundancy"

# A limit counts as broken beyond rounding, long before the result's check would mind.
_ROUNDING = 1e-12


def batch() -> BatchSolver:
    """Closed form; fix the worst cable at the limit it breaks; closed form of the others; until all keep theirs.

    With no redundancy left the square system is still solved, and judged like every other answer.
    Source: Pott 2014; Okoli 2016, 6.4.5, who fixes the first cable found instead of the worst.
    """

    def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
        low, high = (np.broadcast_to(limit, (W.shape[0], W.shape[2])) for limit in (low, high))
        target, held = (low + high) / 2, fixed_cables(low, high)
        tensions, reasons, spare = closest_tensions(W, w_e, target, held)
        at = np.flatnonzero(reasons == "")
        while at.size:
            excess = np.maximum(low[at] - tensions[at], tensions[at] - high[at])
            excess[held[at]] = 0.0
            worst = excess.argmax(axis=-1)
            broken = excess[np.arange(at.size), worst] > _ROUNDING * high[at].max(axis=-1)
            spent = broken & (spare[at] == 0)
            reasons[at[spent]] = OUT_OF_REDUNDANCY
            at, worst = at[broken & ~spent], worst[broken & ~spent]
            target[at, worst] = np.where(tensions[at, worst] < low[at, worst], low[at, worst], high[at, worst])
            held[at, worst] = True
            tensions[at], again, spare[at] = closest_tensions(W[at], w_e[at], target[at], held[at])
            reasons[at] = np.where(again == "", "", OUT_OF_REDUNDANCY)
            at = at[again == ""]
        return tensions, reasons

    return solve


METHOD = vectorized(batch, complete=False,
                    summary="closed form with the worst cable fixed at its limit, repeated; misses some distributions")
