"""The compiled core: all tensions τ = c + D λ that balance a wrench, the nearest of them, the polygon in the limits.

Gauss–Jordan elimination makes D the identity in the free cables, so that λ are these cables' own tensions and the
polygon of feasible λ starts as a rectangle. Nothing chosen here (the nearest tensions, the centroid, a vertex)
depends on which basis of W's null space that is. This is the one module that imports numba.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np

from ..arrays import Array
from .polygon import CENTROID, LOWEST

Function = TypeVar("Function", bound=Callable[..., Any])

FOUND, EMPTY, OUT_OF_RANGE, TOO_REDUNDANT = 0, 1, 2, 3
"""Why `polygons` has no answer: no tensions inside the limits; none at all; more than a polygon (r > 2)."""

# A row this much smaller than it was depends on those before it: elimination leaves about 1e-15 of it.
_DEPENDENT = 1e-12
# Limits are met when missed by rounding only; and if nothing meets them, by half of what the result's check forgives.
_ROUNDING, _BORDER = 1e-13, 5e-9
_OFF_RANGE = 1e-8


def compiled(function: Function) -> Function:
    """Compiled on first use; kept on disk where a folder can be written, else compiled anew in each process."""
    try:
        return cast(Function, numba.njit(cache=True, error_model="numpy")(function))
    except RuntimeError:   # numba found no folder for its cache
        return cast(Function, numba.njit(error_model="numpy")(function))


@compiled
def _reduce(W: Array, w_e: Array, k: int, held_at: Array, rows: Array, line: Array, owner: Any) -> tuple[int, bool]:
    """Gauss–Jordan on [W | −w_e − W_held τ_held] of pose k: ``owner[j]`` becomes the row that column j solves.

    rows (n, m + 1) and line (m + 1,) are overwritten; owner[j] is −1 for free cables, −2 for held ones
    Returns the rank, and whether the rows that depend on others agree with them.
    """
    n, m = rows.shape[0], rows.shape[1] - 1
    size = 1.0
    for i in range(n):
        rows[i, m] = -w_e[k, i]
        size = max(size, 1.0 + abs(w_e[k, i]))
        for j in range(m):
            rows[i, j] = W[k, i, j]
            if owner[j] == -2:
                rows[i, m] -= W[k, i, j] * held_at[j]
                rows[i, j] = 0.0
    rank, agree = 0, True
    for i in range(n):
        pivot, largest, before = -1, 0.0, 0.0
        for j in range(m):
            before = max(before, abs(W[k, i, j]))
            if owner[j] == -1 and abs(rows[i, j]) > largest:
                pivot, largest = j, abs(rows[i, j])
        if largest <= _DEPENDENT * before:
            agree = agree and abs(rows[i, m]) <= _OFF_RANGE * size
            continue
        owner[pivot] = i
        rank += 1
        scale = 1.0 / rows[i, pivot]
        for j in range(m + 1):   # in an array of its own the loop below runs on vectors
            line[j] = rows[i, j] * scale
        for q in range(n):
            factor = rows[q, pivot]
            for j in range(m + 1):
                rows[q, j] -= factor * line[j]
        for j in range(m + 1):
            rows[i, j] = line[j]
    return rank, agree


@compiled
def _spread(rows: Array, owner: Any, target: Array, c: Array, D: Array) -> None:
    """c and D of τ = c + D λ from the reduced rows, one λ per free cable."""
    m = owner.shape[0]
    free = 0
    for j in range(m):
        if owner[j] == -1:
            for i in range(m):
                D[i, free] = -rows[owner[i], j] if owner[i] >= 0 else 0.0
            D[j, free] = 1.0
            free += 1
    for j in range(m):
        c[j] = rows[owner[j], m] if owner[j] >= 0 else (target[j] if owner[j] == -2 else 0.0)


@compiled
def _nearest(c: Array, D: Array, free: int, target: Array, gram: Array, lam: Array) -> None:
    """λ of min ‖c + D λ − target‖² by Cholesky of Dᵀ D, which is at least the identity."""
    m = c.shape[0]
    for a in range(free):
        total = 0.0
        for i in range(m):
            total += D[i, a] * (target[i] - c[i])
        lam[a] = total
        for b in range(a + 1):
            total = 0.0
            for i in range(m):
                total += D[i, a] * D[i, b]
            for k in range(b):
                total -= gram[a, k] * gram[b, k]
            gram[a, b] = np.sqrt(total) if a == b else total / gram[b, b]
        for b in range(a):
            lam[a] -= gram[a, b] * lam[b]
        lam[a] /= gram[a, a]
    for a in range(free - 1, -1, -1):
        for b in range(a + 1, free):
            lam[a] -= gram[b, a] * lam[b]
        lam[a] /= gram[a, a]


@compiled
def closest(W: Array, w_e: Array, target: Array, held: Any) -> tuple[Array, Any, Any]:
    """The tensions nearest to a target among all that balance the wrench, held cables at their target.

    W (k, n, m); w_e (k, n); target, held (k or 1, m)
    Returns tensions (k, m); free cables beyond W's rank (k,); whether the wrench is in W's range (k,).
    """
    count, n, m = W.shape
    tensions, spare, reachable = np.empty((count, m)), np.empty(count, np.int64), np.empty(count, np.bool_)
    rows, line, owner, wish = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64), np.empty(m)
    c, D, gram, lam = np.empty(m), np.empty((m, m)), np.empty((m, m)), np.empty(m)
    for k in range(count):
        free = 0
        for j in range(m):
            wish[j] = target[min(k, target.shape[0] - 1), j]
            owner[j] = -2 if held[min(k, held.shape[0] - 1), j] else -1
            free += 1 if owner[j] == -1 else 0
        rank, reachable[k] = _reduce(W, w_e, k, wish, rows, line, owner)
        free -= rank
        _spread(rows, owner, wish, c, D)
        _nearest(c, D, free, wish, gram, lam)
        for i in range(m):
            tension = c[i]
            for a in range(free):
                tension += D[i, a] * lam[a]
            tensions[k, i] = tension
        spare[k] = free
    return tensions, spare, reachable


@compiled
def _clip(x: Array, y: Array, t: Array, count: int, limit: float, sign: float, miss: float) -> int:
    """Cuts a convex polygon in place where sign · t > limit + miss, t linear over it (Sutherland and Hodgman 1974)."""
    old = x.shape[0] // 2
    for k in range(count):
        x[old + k], y[old + k], t[old + k] = x[k], y[k], t[k]
    kept, before = 0, old + count - 1
    for now in range(old, old + count):
        over, over_before = sign * t[now] - limit, sign * t[before] - limit
        if (over > miss) != (over_before > miss):
            share = over_before / (over_before - over)
            share = min(max(share, 0.0), 1.0)
            x[kept] = x[before] + share * (x[now] - x[before])
            y[kept] = y[before] + share * (y[now] - y[before])
            t[kept] = t[before] + share * (t[now] - t[before])
            kept += 1
        if over <= miss:
            x[kept], y[kept], t[kept] = x[now], y[now], t[now]
            kept += 1
        before = now
    return kept


@compiled
def _polygon(c: Array, D: Array, owner: Any, low: Array, high: Array, slack: float, miss: float,
             x: Array, y: Array, t: Array) -> int:
    """Corners (x, y) of {λ : low ≤ c + D λ ≤ high}, counter-clockwise; a segment has 2 or more, a point 1 or more."""
    m = c.shape[0]
    x[0], y[0], count = 0.0, 0.0, 1
    for j in range(m):
        if owner[j] == -1 and D[j, 0] == 1.0 and D[j, 1] == 0.0:
            x[0], x[1], y[1], count = low[j] - slack, high[j] + slack, 0.0, 2
        elif owner[j] == -1:
            x[2], x[3] = x[1], x[0]
            y[0], y[1], y[2], y[3] = low[j] - slack, low[j] - slack, high[j] + slack, high[j] + slack
            count = 4
    for j in range(m):
        if owner[j] == -1:
            continue
        least, most = np.inf, -np.inf
        for k in range(count):
            t[k] = c[j] + D[j, 0] * x[k] + D[j, 1] * y[k]
            least, most = min(least, t[k]), max(most, t[k])
        if least < low[j] - slack - miss:
            count = _clip(x, y, t, count, slack - low[j], -1.0, miss)
        if most > high[j] + slack + miss and count:
            count = _clip(x, y, t, count, high[j] + slack, 1.0, miss)
        if count == 0:
            break
    return count


@compiled
def _centroid(x: Array, y: Array, count: int) -> tuple[float, float]:
    """Area centroid by a fan of triangles; the middle of the longest chord where there is no area to speak of."""
    area, sum_x, sum_y = 0.0, 0.0, 0.0
    for k in range(1, count - 1):
        piece = (x[k] - x[0]) * (y[k + 1] - y[0]) - (y[k] - y[0]) * (x[k + 1] - x[0])
        piece = max(piece, 0.0)
        area += piece
        sum_x += piece * (x[k] + x[k + 1] - 2 * x[0])
        sum_y += piece * (y[k] + y[k + 1] - 2 * y[0])
    extent = 0.0
    for k in range(1, count):
        extent = max(extent, (x[k] - x[0]) ** 2 + (y[k] - y[0]) ** 2)
    if area > 1e-12 * extent:
        return x[0] + sum_x / (3 * area), y[0] + sum_y / (3 * area)
    first, second, longest = 0, 0, 0.0
    for a in range(count):
        for b in range(a):
            chord = (x[a] - x[b]) ** 2 + (y[a] - y[b]) ** 2
            if chord > longest:
                first, second, longest = a, b, chord
    return (x[first] + x[second]) / 2, (y[first] + y[second]) / 2


@compiled
def _corner(c: Array, D: Array, x: Array, y: Array, count: int, sign: float,
            close: float) -> tuple[float, float]:
    """The corner of least sign · Σ τ; among equals the one whose first tensions are least, in any basis the same."""
    m, best, least = c.shape[0], 0, np.inf
    for k in range(count):
        total = 0.0
        for i in range(m):
            total += sign * (c[i] + D[i, 0] * x[k] + D[i, 1] * y[k])
        before = total < least - close
        if not before and total <= least + close:
            for i in range(m):
                change = D[i, 0] * (x[k] - x[best]) + D[i, 1] * (y[k] - y[best])
                if abs(change) > close:
                    before = change < 0
                    break
        if before:
            best, least = k, total
    return x[best], y[best]


@compiled
def polygons(W: Array, w_e: Array, low: Array, high: Array, pick: int) -> tuple[Array, Any, Any]:
    """One point of each polygon of feasible tensions: the centroid, or the corner of least or largest sum.

    W (k, n, m); w_e (k, n); low, high (k or 1, m); pick CENTROID, LOWEST or HIGHEST
    Returns tensions (k, m), NaN without an answer; FOUND or why not (k,); redundancy r = m − rank (k,).
    """
    count, n, m = W.shape
    tensions, found, spare = np.full((count, m), np.nan), np.empty(count, np.int64), np.empty(count, np.int64)
    rows, line, owner = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64)
    c, D, lows, highs = np.empty(m), np.zeros((m, max(m, 2))), np.empty(m), np.empty(m)
    x, y, t = np.empty(8 * m + 16), np.empty(8 * m + 16), np.empty(8 * m + 16)
    for k in range(count):
        largest = 0.0
        for j in range(m):
            owner[j], lows[j], highs[j] = -1, low[min(k, low.shape[0] - 1), j], high[min(k, high.shape[0] - 1), j]
            largest = max(largest, highs[j])
        rank, reachable = _reduce(W, w_e, k, lows, rows, line, owner)
        spare[k] = m - rank
        found[k] = OUT_OF_RANGE if not reachable else TOO_REDUNDANT if spare[k] > 2 else FOUND
        if found[k] != FOUND:
            continue
        for j in range(m):
            D[j, 0], D[j, 1] = 0.0, 0.0
        _spread(rows, owner, lows, c, D)
        corners = _polygon(c, D, owner, lows, highs, 0.0, _ROUNDING * largest, x, y, t)
        if corners == 0:   # one last point on the very border is lost to rounding
            corners = _polygon(c, D, owner, lows, highs, _BORDER * largest, 0.0, x, y, t)
        if corners == 0:
            found[k] = EMPTY
            continue
        at_x, at_y = (_centroid(x, y, corners) if pick == CENTROID
                      else _corner(c, D, x, y, corners, 1.0 if pick == LOWEST else -1.0, 1e-9 * largest))
        for i in range(m):
            tensions[k, i] = c[i] + D[i, 0] * at_x + D[i, 1] * at_y
    return tensions, found, spare
