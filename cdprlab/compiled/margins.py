"""The compiled margin: how far inside its limits a cable robot can balance a wrench, for many poses.

With τ = c + D λ (two λ, some of which may move nothing) the largest s with τ_min + p s ≤ c + D λ ≤ τ_max − q s is a
linear program in (λ, s), solved by walking along active rows: uphill in s while nothing blocks, dropping rows that
pull the wrong way.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from . import FOUND, OUT_OF_RANGE, TOO_REDUNDANT, UNSETTLED
from .jit import compiled
from .linear_algebra import FREE, eliminate, solutions

_STEPS = 100   # a vertex of 16 rows in three unknowns is found in about ten
_FLAT = 1e-10  # directions and multipliers below this, of rows of size about 1, are zero


@compiled
def _onto_free(active: Array, count: int, basis: Array, direction: Array) -> float:
    """Remove from e_s what the active rows span (Gram–Schmidt into ``basis``); returns the squared size left."""
    direction[0] = direction[1] = 0.0
    direction[2] = 1.0
    kept = 0
    for k in range(count):
        size = 0.0
        for a in range(3):
            basis[kept, a] = active[k, a]
            size += active[k, a] * active[k, a]
        for j in range(kept):
            along = 0.0
            for a in range(3):
                along += basis[kept, a] * basis[j, a]
            for a in range(3):
                basis[kept, a] -= along * basis[j, a]
        left = 0.0
        for a in range(3):
            left += basis[kept, a] * basis[kept, a]
        if left > _FLAT * size:
            for a in range(3):
                basis[kept, a] /= np.sqrt(left)
            along = 0.0
            for a in range(3):
                along += direction[a] * basis[kept, a]
            for a in range(3):
                direction[a] -= along * basis[kept, a]
            kept += 1
    total = 0.0
    for a in range(3):
        total += direction[a] * direction[a]
    return total


@compiled
def _worst_multiplier(active: Array, count: int, gram: Array, mu: Array) -> int:
    """The active row whose multiplier in e_s = Σ μ a is most negative, or −1: least squares by Cholesky-free Gauss."""
    for i in range(count):
        mu[i] = active[i, 2]
        for j in range(count):
            total = 0.0
            for a in range(3):
                total += active[i, a] * active[j, a]
            gram[i, j] = total
    for i in range(count):
        pivot = gram[i, i]
        if pivot <= _FLAT:
            return i   # depends on the rows before it
        for j in range(i + 1, count):
            factor = gram[j, i] / pivot
            for k in range(i, count):
                gram[j, k] -= factor * gram[i, k]
            mu[j] -= factor * mu[i]
    worst, lowest = -1, -_FLAT
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            mu[i] -= gram[i, k] * mu[k]
        mu[i] /= gram[i, i]
    for i in range(count):
        if mu[i] < lowest:
            worst, lowest = i, mu[i]
    return worst


@compiled
def _climb(rows: Array, limits: Array, used: int, x: Array, active: Array, held: Any, basis: Array, gram: Array,
           mu: Array, direction: Array) -> bool:
    """Move x, which meets ``rows @ x ≤ limits``, to the largest last coordinate; False if it does not settle."""
    count: Any = np.int64(0)   # for a bare literal what is called below would be compiled a second time
    for _ in range(_STEPS):
        if _onto_free(active, count, basis, direction) <= _FLAT:
            drop = _worst_multiplier(active, count, gram, mu)
            if drop < 0:
                return True
            for k in range(drop, count - 1):
                held[k] = held[k + 1]
                for a in range(3):
                    active[k, a] = active[k + 1, a]
            count -= 1
            continue
        step, block = np.inf, -1
        for i in range(used):
            slope, gap = 0.0, limits[i]
            for a in range(3):
                slope += rows[i, a] * direction[a]
                gap -= rows[i, a] * x[a]
            busy = False
            for k in range(count):
                busy |= held[k] == i
            if slope > _FLAT and not busy and max(gap, 0.0) < step * slope:
                step, block = max(gap, 0.0) / slope, i
        if block < 0:
            x[2] = np.inf
            return True
        for a in range(3):
            x[a] += step * direction[a]
        if count == 3:
            return False
        held[count] = block
        for a in range(3):
            active[count, a] = rows[block, a]
        count += 1
    return False


@compiled
def _rows_of(c: Array, D: Array, low: Array, high: Array, p: float, q: float, rows: Array,
             limits: Array) -> int:
    """Rows over (λ, s) of the limits of τ = c + D λ; returns how many there are."""
    used = 0
    for i in range(c.shape[0]):
        for side in range(2):
            sign = 1.0 if side else -1.0
            limit = high[i] - c[i] if side else c[i] - low[i]
            if limit < np.inf:
                rows[used, 0], rows[used, 1] = sign * D[i, 0], sign * D[i, 1]
                rows[used, 2] = q if side else p
                limits[used] = limit
                used += 1
    return used


@compiled
def _lift(rows: Array, limits: Array, used: int, x: Array) -> None:
    """The largest last coordinate that the others allow."""
    x[2] = np.inf
    for i in range(used):
        if rows[i, 2] > 0:
            x[2] = min(x[2], (limits[i] - rows[i, 0] * x[0] - rows[i, 1] * x[1]) / rows[i, 2])


@compiled
def _best(rows: Array, limits: Array, used: int, x: Array, active: Array, held: Any, basis: Array, gram: Array,
          mu: Array, direction: Array) -> bool:
    """The point with the largest last coordinate; −inf there where no point meets the rows that have none of it."""
    broken, size = False, 0.0
    for i in range(used):
        size = max(size, abs(limits[i]))
        broken |= rows[i, 2] == 0.0 and limits[i] < 0.0
    if broken:
        # Rows without s are broken at λ = 0. Softened themselves, and s kept from going above 0, a first climb mends
        # that; the other rows can wait, as a low enough s meets them anywhere.
        soft, ends = rows.copy(), limits.copy()
        for i in range(used):
            if rows[i, 2] != 0.0:
                soft[i, 0] = soft[i, 1] = ends[i] = 0.0
            soft[i, 2] = 1.0
        _lift(soft, ends, used, x)
        if not _climb(soft, ends, used, x, active, held, basis, gram, mu, direction):
            return False
        if x[2] < -_FLAT * size:
            x[2] = -np.inf
            return True
    _lift(rows, limits, used, x)
    return _climb(rows, limits, used, x, active, held, basis, gram, mu, direction)


@compiled
def margins(W: Array, w_e: Array, low: Array, high: Array, p: float, q: float) -> tuple[Array, Array, Any]:
    """Largest s with W τ + w_e = 0 and low + p s ≤ τ ≤ high − q s.

    W (k, n, m); w_e (k, n); low, high (m,), high may be inf; p, q 0 or 1, not both 0
    Returns s (k,) and such tensions (k, m), NaN without an answer; FOUND or why not (k,).
    """
    count, n, m = W.shape
    found, best, tensions = np.full(count, FOUND), np.empty(count), np.empty((count, m))
    reduced, line, owner = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64)
    c, D, limits, rows = np.empty(m), np.zeros((m, max(m, 2))), np.empty(2 * m), np.empty((2 * m, 3))
    x, mu, direction, held = np.empty(3), np.empty(3), np.empty(3), np.empty(3, np.int64)
    active, basis, gram = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(count):
        best[k] = np.nan
        for j in range(m):
            owner[j], tensions[k, j] = FREE, np.nan
            D[j, 0] = D[j, 1] = 0.0   # a λ that is not there moves nothing, and stays where it is
        rank, reachable = eliminate(W, w_e, k, c, reduced, line, owner)
        if not reachable or m - rank > 2:
            found[k] = TOO_REDUNDANT if reachable else OUT_OF_RANGE
            continue
        solutions(reduced, owner, c, c, D)
        used = _rows_of(c, D, low, high, p, q, rows, limits)
        x[0] = x[1] = 0.0
        if not _best(rows, limits, used, x, active, held, basis, gram, mu, direction):
            found[k] = UNSETTLED
            continue
        best[k] = x[2]
        for j in range(m):
            tensions[k, j] = c[j] + D[j, 0] * x[0] + D[j, 1] * x[1]
    return best, tensions, found
