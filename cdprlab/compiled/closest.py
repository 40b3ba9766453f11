"""The compiled closed forms: the tensions nearest to a wish, with cables fixed at the limits that they leave."""

from typing import Any

import numpy as np

from ..arrays import Array
from . import FIXED, FOUND, OUT_OF_RANGE, SPENT, TOLERANCE
from .jit import compiled, compiled_for_batches
from .linear_algebra import FREE, HELD, balance, nearest, wrench_size

BROKEN = TOLERANCE / 100   # less than this of a cable's scale is rounding


@compiled
def worst_cable(tau: Array, low: Array, high: Array, held: Any, size: float) -> int:
    """The cable that is not held and leaves its limits by most, and by more than rounding; −1 if all keep them."""
    worst, excess = -1, 0.0
    for j in range(len(tau)):
        over = max(low[j] - tau[j], tau[j] - high[j])
        if not held[j] and over > max(excess, BROKEN * (size + low[j])):
            worst, excess = j, over
    return worst


@compiled_for_batches
def closest(W: Array, w_e: Array, low: Array, high: Array, share: float, rounds: int) -> tuple[Array, Any]:
    """The tensions nearest to low + share (high − low) among all that balance the wrench; equal limits hold a cable.

    rounds : how often the cable that leaves its limits by most may be fixed there, and the
        others solved anew
    W (k, n, m); w_e (k, n); low, high both (k, m) or both (1, m)
    Returns tensions (k, m); FOUND, OUT_OF_RANGE or, where rounds or redundancy ran out, SPENT
    (k,).
    """
    count, n, m = W.shape
    tensions, found = np.empty((count, m)), np.empty(count, np.int64)
    owner, wish, held = np.empty(m, np.int64), np.empty(m), np.empty(m, np.bool_)
    rows, line, c = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m)
    D = np.empty((m, max(m, 2)))
    for k in range(count):
        row = k if len(low) > 1 else 0
        low_k, high_k, tau = low[row], high[row], tensions[k]
        for j in range(m):
            wish[j] = low_k[j] + share * (high_k[j] - low_k[j])
            held[j] = high_k[j] - low_k[j] <= FIXED * (1.0 + low_k[j])
        left = rounds
        while True:
            for j in range(m):
                owner[j] = HELD if held[j] else FREE
            known, free = balance(W[k], w_e[k], wish, rows, line, owner, c, D)
            reachable = known != OUT_OF_RANGE
            lam = nearest(c, D, free, wish)
            for i in range(m):
                tau[i] = c[i]
                for a in range(free):
                    tau[i] += D[i, a] * lam[a]
            worst = worst_cable(tau, low_k, high_k, held, wrench_size(w_e[k]))
            found[k] = FOUND
            if not reachable:
                found[k] = OUT_OF_RANGE if left == rounds else SPENT
            if worst < 0 or rounds == 0 or not reachable:
                break
            if left == 0 or free == 0:
                found[k] = SPENT
                break
            wish[worst] = low_k[worst] if tau[worst] < low_k[worst] else high_k[worst]
            held[worst] = True
            left -= 1
    return tensions, found
