"""The compiled capacity margin: how far a box of wrenches is from the nearest facet of the available wrench set.

Hyperplane shifting, one facet's normal n being orthogonal to n − 1 columns of W, seen from the other side: y = Wᵀ n is
zero on these columns, so it has r + 1 others, and it is orthogonal to the null space D of W. These y are cofactors of
r + 1 rows of D, a few products for up to two redundant cables.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from .jit import compiled
from .polygon import _reduce, _spread

FOUND, UNREACHABLE, TOO_REDUNDANT = 0, 1, 2   # TOO_REDUNDANT where W loses rank too

_PARALLEL = 1e-9   # cofactors below this share of the products they are made of are zero


@compiled
def _cofactors(D: Array, free: int, at: Any, y: Array) -> bool:
    """y on the cables ``at`` with Σ y_i D_i = 0; False where it is zero up to rounding."""
    if free == 0:
        y[0] = 1.0
        return True
    if free == 1:
        y[0], y[1] = D[at[1], 0], -D[at[0], 0]
        size = max(abs(y[0]), abs(y[1]))
        return size > _PARALLEL
    largest, size = 0.0, 0.0
    for a in range(3):
        i, j = at[(a + 1) % 3], at[(a + 2) % 3]
        first, second = D[i, 0] * D[j, 1], D[i, 1] * D[j, 0]
        y[a] = first - second
        size = max(size, abs(first), abs(second))
        largest = max(largest, abs(y[a]))
    return largest > _PARALLEL * size


@compiled
def _next_choice(at: Any, size: int, m: int) -> bool:
    """The next choice of ``size`` among m cables, in order; False after the last."""
    a = size - 1
    while a >= 0 and at[a] == m - size + a:
        a -= 1
    if a < 0:
        return False
    at[a] += 1
    for b in range(a + 1, size):
        at[b] = at[b - 1] + 1
    return True


@compiled
def capacity(W: Array, w_e: Array, loads: Array, half: Array, low: Array, high: Array,
             any_sign: bool) -> tuple[Array, Array, Any]:
    """Smallest distance from −(w_e + load + box) to a facet of {W τ : low ≤ τ ≤ high}, negative outside.

    W (k, n, m + n), the last n columns the identity; w_e (k, n); loads (v, n); half (n,); low, high (m,)
    any_sign : go on past a margin that is negative; without, one negative facet is answer enough
    Returns (k,), NaN without an answer; outward unit normal of that facet (k, n); FOUND or why not (k,).
    """
    count, n = w_e.shape
    m = low.shape[0]
    found, best, normals = np.zeros(count, np.int64), np.empty(count), np.empty((count, n))
    rows, line, owner = np.empty((n, m + n + 1)), np.empty(m + n + 1), np.empty(m + n, np.int64)
    c, D = np.empty(m + n), np.zeros((m + n, m + n))
    at, y, normal = np.empty(m, np.int64), np.empty(3), np.empty(n)
    for k in range(count):
        best[k] = np.nan
        for j in range(m + n):
            owner[j] = -1 if j < m else -3   # columns of the identity are carried along only
        rank, reachable = _reduce(W, w_e, k, c, rows, line, owner)
        if not reachable or rank < n or m - rank > 2:
            found[k] = TOO_REDUNDANT if reachable else UNREACHABLE
            continue
        _spread(rows, owner, c, c, D)
        free = m - rank
        for a in range(free + 1):
            at[a] = a
        best[k] = np.inf
        more = True
        while more and (any_sign or best[k] >= 0.0):
            if _cofactors(D, free, at, y):
                size, middle, most, least, width = 0.0, 0.0, 0.0, 0.0, 0.0
                for e in range(n):
                    normal[e] = 0.0
                for a in range(free + 1):
                    i = at[a]
                    if y[a] != 0.0:
                        middle += y[a] * c[i]
                        most += y[a] * (high[i] if y[a] > 0.0 else low[i])
                        least += y[a] * (low[i] if y[a] > 0.0 else high[i])
                        if owner[i] >= 0:
                            for e in range(n):
                                normal[e] += y[a] * rows[owner[i], m + e]
                for e in range(n):
                    size += normal[e] * normal[e]
                    width += abs(normal[e]) * half[e]
                size = np.sqrt(size)
                top, bottom = -np.inf, np.inf
                for v in range(loads.shape[0]):
                    value = middle
                    for e in range(n):
                        value -= normal[e] * loads[v, e]
                    top, bottom = max(top, value), min(bottom, value)
                above, below = most - top - width, bottom - width - least
                if min(above, below) < best[k] * size:
                    best[k] = min(above, below) / size
                    sign = 1.0 if above <= below else -1.0
                    for e in range(n):
                        normals[k, e] = sign * normal[e] / size
            more = _next_choice(at, free + 1, m)
    return best, normals, found
