"""The compiled margin: how far inside its limits a cable robot can balance a wrench, for many poses.

The facets of `capacity`, asked for another distance: each y with Σ y_i D_i = 0 of least many
cables bounds the margin from above, by duality, and the least of these bounds is the margin
itself.
"""

from typing import Any

import numpy as np

from ..arrays import Array
from . import FOUND
from .facets import cofactors, next_choice
from .jit import compiled
from .linear_algebra import FREE, balance

NOUGHT = 1e-10   # of all that is summed up: less is zero


@compiled
def bound(y: Array, at: Any, used: int, c: Array, low: Array, high: Array, p: float, q: float) -> float:
    """The largest s that Σ y_i τ_i = Σ y_i c_i leaves to low + p s ≤ τ ≤ high − q s, whose sums come closer with s."""
    above = below = up = down = 0.0
    for a in range(used):
        i = at[a]
        plus, minus = max(y[a], 0.0), max(-y[a], 0.0)
        above += plus * high[i] - minus * low[i] - y[a] * c[i]
        below += minus * high[i] - plus * low[i] + y[a] * c[i]
        up += q * plus + p * minus
        down += q * minus + p * plus
    nought = NOUGHT * (up + down)
    if up > nought and down > nought:
        return min(above / up, below / down)
    # One sum does not depend on s: it is kept or not.
    fixed, room, give = above, below, down
    if up > nought:
        fixed, room, give = below, above, up
    return room / give if fixed >= -NOUGHT * (above + below) else -np.inf


@compiled
def margins(W: Array, w_e: Array, low: Array, high: Array, p: float, q: float) -> tuple[Array, Any]:
    """Largest s with W τ + w_e = 0 and low + p s ≤ τ ≤ high − q s.

    W (k, n, m); w_e (k, n); low, high (m,); p, q 0 or 1, not both 0
    Returns s (k,), −inf where no s will do, NaN without an answer; FOUND or why not (k,).
    """
    count, n, m = W.shape
    found, best = np.empty(count, np.int64), np.empty(count)
    rows, line, owner = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64)
    c, D = np.empty(m), np.empty((m, max(m, 2)))
    at, y = np.empty(m, np.int64), np.empty(3)
    most = np.inf   # what each cable's own two limits leave
    for j in range(m):
        most = min(most, (high[j] - low[j]) / (p + q))
    for k in range(count):
        for j in range(m):
            owner[j] = FREE
        found[k], free = balance(W, w_e, k, c, rows, line, owner, c, D)
        best[k] = most if found[k] == FOUND else np.nan
        for a in range(free + 1):
            at[a] = a
        more = found[k] == FOUND and free < m
        while more:
            if cofactors(D, free, at, y):
                best[k] = min(best[k], bound(y, at, free + 1, c, low, high, p, q))
            more = next_choice(at, free + 1, m)
    return best, found
