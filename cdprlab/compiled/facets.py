"""The compiled capacity margin: how far a box of wrenches is from the nearest facet of the available wrench set.

Hyperplane shifting, one facet's normal n being orthogonal to n − 1 columns of W, seen from the
other side: y = Wᵀ n is zero on these columns, so it has r + 1 others, and it is orthogonal to
the null space D of W. These y are cofactors of r + 1 rows of D, a few products for up to two
redundant cables.
"""

from typing import Any

import numpy as np

from ..arrays import Array
from . import FOUND, TOO_REDUNDANT
from .jit import compiled, compiled_for_batches
from .linear_algebra import CARRIED, FREE, balance

PARALLEL = 1e-9   # cofactors below this share of the products they are made of are zero


@compiled
def cofactors(D: Array, free: int, at: Any, y: Array) -> bool:
    """y on the cables ``at`` with Σ y_i D_i = 0; False where it is zero up to rounding."""
    if free == 0:
        y[0] = 1.0
        return True
    if free == 1:
        y[0], y[1] = D[at[1], 0], -D[at[0], 0]
        size = max(abs(y[0]), abs(y[1]))
        return size > PARALLEL
    largest, size = 0.0, 0.0
    for a in range(3):
        i, j = at[(a + 1) % 3], at[(a + 2) % 3]
        first, second = D[i, 0] * D[j, 1], D[i, 1] * D[j, 0]
        y[a] = first - second
        size = max(size, abs(first), abs(second))
        largest = max(largest, abs(y[a]))
    return largest > PARALLEL * size


@compiled
def next_choice(at: Any, size: int, m: int) -> bool:
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
def distance(y: Array, at: Any, free: int, identity: Array, c: Array, loads: Array, half: Array,
             low: Array,
             high: Array, normal: Array) -> float:
    """How far all loads and their box are inside the nearer of the two facets whose y = Wᵀ n; ``normal`` becomes its n.

    Both facets are at Σ y_i τ_i with each τ_i at the limit that makes it largest or least, and
    the wrench that the cables must exert at Σ y_i c_i less n · load; n is in terms of the
    columns that the identity became.
    """
    n = normal.shape[0]
    middle, most, least = 0.0, 0.0, 0.0
    for e in range(n):
        normal[e] = 0.0
    for a in range(free + 1):
        i = at[a]
        middle += y[a] * c[i]
        most += max(y[a] * high[i], y[a] * low[i])
        least += min(y[a] * high[i], y[a] * low[i])
        for e in range(n):
            normal[e] += y[a] * identity[i, e]
    square, width = 0.0, 0.0
    for e in range(n):
        square += normal[e] * normal[e]
        width += abs(normal[e]) * half[e]
    top, bottom = -np.inf, np.inf
    for v in range(loads.shape[0]):
        value = middle
        for e in range(n):
            value -= normal[e] * loads[v, e]
        top, bottom = max(top, value), min(bottom, value)
    above, below = most - top - width, bottom - width - least
    size = np.sqrt(square)
    for e in range(n):
        normal[e] /= size if above <= below else -size
    return min(above, below) / size


@compiled_for_batches
def capacity(W: Array, w_e: Array, loads: Array, half: Array, low: Array, high: Array,
             any_sign: bool) -> tuple[Array, Array, Any]:
    """Smallest distance from −(w_e + load + box) to a facet of {W τ : low ≤ τ ≤ high}, negative outside.

    W (k, n, m + n), the last n columns the identity; w_e (k, n); loads (v, n); half (n,); low,
    high (m,)
    any_sign : go on past a margin that is negative; without, one negative facet is answer
        enough
    Returns (k,), NaN without an answer; outward unit normal of that facet (k, n); FOUND or why
    not (k,), TOO_REDUNDANT where W loses rank too.
    """
    count, n = w_e.shape
    m = low.shape[0]
    found, best, normals = np.empty(count, np.int64), np.empty(count), np.empty((count, n))
    rows, line, owner = np.empty((n, m + n + 1)), np.empty(m + n + 1), np.empty(m + n, np.int64)
    c, D = np.empty(m + n), np.empty((m + n, m + n))
    identity, at, y, normal = np.empty((m, n)), np.empty(m, np.int64), np.empty(3), np.empty(n)
    for k in range(count):
        best[k] = np.nan
        for j in range(m + n):
            owner[j] = FREE if j < m else CARRIED
        found[k], free = balance(W, w_e, k, c, rows, line, owner, c, D)
        if found[k] == FOUND and free > m - n:
            found[k] = TOO_REDUNDANT
        if found[k] != FOUND:
            continue
        for i in range(m):
            for e in range(n):
                identity[i, e] = rows[owner[i], m + e] if owner[i] >= 0 else 0.0
        for a in range(free + 1):
            at[a] = a
        best[k] = np.inf
        more = True
        while more and (any_sign or best[k] >= 0.0):
            if cofactors(D, free, at, y):
                left = distance(y, at, free, identity, c, loads, half, low, high, normal)
                if left < best[k]:
                    best[k] = left
                    for e in range(n):
                        normals[k, e] = normal[e]
            more = next_choice(at, free + 1, m)
    return best, normals, found
