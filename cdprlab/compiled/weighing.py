"""The compiled law of tension distributions: the wrench is balanced, and each cable keeps its own limits."""

from typing import Any

import numpy as np

from ..arrays import Array
from . import TOLERANCE
from .jit import compiled_for
from .linear_algebra import wrench_size


@compiled_for(3, 2, 2, 2, 2)
def weigh(W: Array, w_e: Array, low: Array, high: Array, tensions: Array) -> tuple[Array, Array, Array, Any]:
    """|W τ + w_e|∞ ≤ 1e-8 (1 + |w_e|∞), and each limit is kept to 1e-8 (1 + |w_e|∞ + τ_min).

    W (k, n, m); w_e (k, n); low, high, tensions (k, m)
    Returns tensions (k, m), clipped where limits are missed by rounding only: what is returned is what was weighed;
    residual (k, n) W τ + w_e; margin (k,) to the nearest limit, negative outside, NaN of tensions that are; whether the
    law holds (k,).
    """
    count, n, m = W.shape
    kept, residual = tensions.copy(), np.empty((count, n))
    margin, feasible = np.empty(count), np.empty(count, np.bool_)
    for k in range(count):
        size, inside, room = wrench_size(w_e[k]), True, np.inf
        for j in range(m):
            own = min(tensions[k, j] - low[k, j], high[k, j] - tensions[k, j])
            inside = inside and own >= -TOLERANCE * (size + low[k, j])
            room = own if not own >= room else room
        if inside and room < 0.0:
            room = 0.0
            for j in range(m):
                kept[k, j] = min(max(tensions[k, j], low[k, j]), high[k, j])
        missed = 0.0
        for i in range(n):
            residual[k, i] = w_e[k, i]
            for j in range(m):
                residual[k, i] += W[k, i, j] * kept[k, j]
            missed = max(missed, abs(residual[k, i]))
        margin[k] = room
        feasible[k] = inside and missed <= TOLERANCE * size
    return kept, residual, margin, feasible
