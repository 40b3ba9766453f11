"""The compiled core: all tensions τ = c + D λ that balance a wrench, the nearest of them, the polygon in the limits.

Gauss–Jordan elimination makes D the identity in the free cables, so that λ are these cables' own tensions and the
polygon of feasible λ starts as a rectangle. Nothing chosen here (the nearest tensions, the centroid, a vertex)
depends on which basis of W's null space that is.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..tensions.feasible_polygon import CENTROID, LOWEST
from .jit import compiled

FOUND, EMPTY, OUT_OF_RANGE, TOO_REDUNDANT, SPENT = 0, 1, 2, 3, 4
"""Why there is no answer: no tensions inside the limits, none at all, more than a polygon (r > 2), no cable left."""

# A row this much smaller than it was depends on those before it: elimination leaves about 1e-15 of it.
_DEPENDENT = 1e-12
# Limits are met when missed by rounding only; and if nothing meets them, by half of what the result's check forgives.
_ROUNDING, _BORDER = 1e-13, 5e-9
_OFF_RANGE = 1e-8
# Cables with limits closer than this have no choice; a limit is broken beyond rounding from this on.
_FIXED, _BROKEN = 1e-9, 1e-12
# A polygon of less area than this, relative to its length squared, is a segment: rounding leaves about 1e-16.
_THIN = 1e-12


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
def _project(W: Array, w_e: Array, k: int, wish: Array, rows: Array, line: Array, owner: Any, c: Array, D: Array,
             gram: Array, lam: Array, tau: Array) -> tuple[int, bool]:
    """Pose k's balanced tensions nearest to ``wish``; cables with owner −2 are held at it, the others have owner −1."""
    free = 0
    for j in range(owner.shape[0]):
        free += 1 if owner[j] == -1 else 0
    rank, reachable = _reduce(W, w_e, k, wish, rows, line, owner)
    free -= rank
    _spread(rows, owner, wish, c, D)
    _nearest(c, D, free, wish, gram, lam)
    for i in range(c.shape[0]):
        tau[i] = c[i]
        for a in range(free):
            tau[i] += D[i, a] * lam[a]
    return free, reachable


@compiled
def closest(W: Array, w_e: Array, low: Array, high: Array, share: float, rounds: int) -> tuple[Array, Any]:
    """The tensions nearest to low + share (high − low) among all that balance the wrench; equal limits hold a cable.

    rounds : how often the cable that leaves its limits by most may be fixed there, and the others solved anew
    W (k, n, m); w_e (k, n); low, high both (k, m) or both (1, m)
    Returns tensions (k, m); FOUND, OUT_OF_RANGE or, where rounds or redundancy ran out, SPENT (k,).
    """
    count, n, m = W.shape
    tensions, found = np.empty((count, m)), np.empty(count, np.int64)
    rows, line, owner, wish = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64), np.empty(m)
    c, D, gram, lam, tau = np.empty(m), np.empty((m, m)), np.empty((m, m)), np.empty(m), np.empty(m)
    held = np.empty(m, np.bool_)
    for k in range(count):
        row = k if low.shape[0] > 1 else 0
        largest = 0.0
        for j in range(m):
            largest = max(largest, high[row, j])
        for j in range(m):
            wish[j] = low[row, j] + share * (high[row, j] - low[row, j])
            held[j] = high[row, j] - low[row, j] <= _FIXED * largest
        left = rounds
        while True:
            for j in range(m):
                owner[j] = -2 if held[j] else -1
            free, reachable = _project(W, w_e, k, wish, rows, line, owner, c, D, gram, lam, tau)
            found[k] = FOUND if reachable else OUT_OF_RANGE if left == rounds else SPENT
            worst, excess = -1, _BROKEN * largest
            for j in range(m):
                over = max(low[row, j] - tau[j], tau[j] - high[row, j])
                if not held[j] and over > excess:
                    worst, excess = j, over
            if worst < 0 or rounds == 0 or found[k] != FOUND:
                break
            if left == 0 or free == 0:
                found[k] = SPENT
                break
            wish[worst] = low[row, worst] if tau[worst] < low[row, worst] else high[row, worst]
            held[worst] = True
            left -= 1
        for j in range(m):
            tensions[k, j] = tau[j]
    return tensions, found


@compiled
def _clip(corners: Array, first: int, count: int, limit: float, sign: float, miss: float) -> int:
    """Cuts a convex polygon where sign · t > limit + miss, t linear over it (Sutherland and Hodgman 1974).

    corners[first:first + count] are (x, y, t); those kept go to the other half of the array; returns how many.
    """
    to = begin = corners.shape[0] // 2 - first
    before = first + count - 1
    over_before = sign * corners[before, 2] - limit
    for now in range(first, first + count):
        over = sign * corners[now, 2] - limit
        if (over > miss) != (over_before > miss):
            share = over_before / (over_before - over)
            for a in range(3):
                corners[to, a] = corners[before, a] + share * (corners[now, a] - corners[before, a])
            to += 1
        if over <= miss:
            for a in range(3):
                corners[to, a] = corners[now, a]
            to += 1
        before = now
        over_before = over
    return to - begin


@compiled
def _polygon(c: Array, D: Array, owner: Any, low: Array, high: Array, row: int, slack: float, miss: float,
             corners: Array) -> tuple[int, int]:
    """Corners, in order, of {λ : low[row] ≤ c + D λ ≤ high[row]}; a segment has 2 or more, a point 1 or more.

    Returns where in ``corners`` they begin, and how many they are.
    """
    first: Any = np.int64(0)   # for bare literals _clip would be compiled a second time
    count: Any = np.int64(1)
    for a in range(2):
        corners[0, a] = corners[1, a] = 0.0
    for j in range(c.shape[0]):
        if owner[j] == -1:   # from a point to a segment, from a segment to a rectangle
            axis = count // 2
            for k in range(count):
                corners[2 * count - 1 - k, 0] = corners[k, 0]
                corners[k, axis] = low[row, j] - slack
                corners[2 * count - 1 - k, axis] = high[row, j] + slack
            count *= 2
    for j in range(c.shape[0]):
        if owner[j] != -1 and count > 0:
            least, most = low[row, j] - slack, high[row, j] + slack
            too_low = too_high = False
            for k in range(first, first + count):
                value = c[j] + D[j, 0] * corners[k, 0] + D[j, 1] * corners[k, 1]
                corners[k, 2] = value
                too_low |= value < least - miss
                too_high |= value > most + miss
            if too_low:
                count = _clip(corners, first, count, -least, -1.0, miss)
                first = corners.shape[0] // 2 - first
            if too_high and count > 0:
                count = _clip(corners, first, count, most, 1.0, miss)
                first = corners.shape[0] // 2 - first
    return first, count


@compiled
def _farthest(corners: Array, first: int, count: int, origin: int) -> int:
    """The corner farthest from one of them."""
    far, extent = origin, 0.0
    for k in range(first, first + count):
        reach = (corners[k, 0] - corners[origin, 0]) ** 2 + (corners[k, 1] - corners[origin, 1]) ** 2
        if reach > extent:
            far, extent = k, reach
    return far


@compiled
def _centroid(corners: Array, first: int, count: int, point: Array) -> None:
    """Area centroid by a fan of triangles; the middle of the longest chord where there is no area to speak of."""
    area, extent, point[0], point[1] = 0.0, 0.0, 0.0, 0.0
    for k in range(first + 1, first + count - 1):
        x, y = corners[k, 0] - corners[first, 0], corners[k, 1] - corners[first, 1]
        next_x, next_y = corners[k + 1, 0] - corners[first, 0], corners[k + 1, 1] - corners[first, 1]
        piece = abs(x * next_y - y * next_x)
        area += piece
        extent += x * x + y * y + next_x * next_x + next_y * next_y
        point[0] += piece * (x + next_x)
        point[1] += piece * (y + next_y)
    if area > _THIN * extent:
        point[0] = corners[first, 0] + point[0] / (3 * area)
        point[1] = corners[first, 1] + point[1] / (3 * area)
    else:
        far = _farthest(corners, first, count, first)
        other = _farthest(corners, first, count, far)
        point[0] = (corners[far, 0] + corners[other, 0]) / 2
        point[1] = (corners[far, 1] + corners[other, 1]) / 2


@compiled
def _corner(D: Array, corners: Array, first: int, count: int, sign: float, close: float, point: Array) -> None:
    """The corner of least sign · Σ τ; among equals the one whose first tensions are least, in any basis the same."""
    best = first
    for k in range(first + 1, first + count):
        x, y, total = corners[k, 0] - corners[best, 0], corners[k, 1] - corners[best, 1], 0.0
        for i in range(D.shape[0]):
            total += sign * (D[i, 0] * x + D[i, 1] * y)
        i = 0
        while abs(total) <= close and i < D.shape[0]:
            total = D[i, 0] * x + D[i, 1] * y
            i += 1
        if total < 0:
            best = k
    point[0], point[1] = corners[best, 0], corners[best, 1]


@compiled
def polygons(W: Array, w_e: Array, low: Array, high: Array, pick: int) -> tuple[Array, Any, Any]:
    """One point of each polygon of feasible tensions: the centroid, or the corner of least or largest sum.

    W (k, n, m); w_e (k, n); low, high both (k, m) or both (1, m); pick CENTROID, LOWEST or HIGHEST
    Returns tensions (k, m), NaN without an answer; FOUND or why not (k,); redundancy r = m − rank (k,).
    """
    count, n, m = W.shape
    tensions, found, spare = np.empty((count, m)), np.empty(count, np.int64), np.empty(count, np.int64)
    rows, line, owner = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64)
    c, D, corners, point = np.empty(m), np.empty((m, max(m, 2))), np.zeros((4 * m + 16, 3)), np.empty(2)
    for k in range(count):
        row = k if low.shape[0] > 1 else 0
        largest = 0.0
        for j in range(m):
            owner[j] = -1
            largest = max(largest, high[row, j])
            D[j, 0] = D[j, 1] = point[0] = point[1] = 0.0
            tensions[k, j] = np.nan
        rank, reachable = _reduce(W, w_e, k, c, rows, line, owner)
        spare[k] = m - rank
        found[k] = OUT_OF_RANGE if not reachable else TOO_REDUNDANT if spare[k] > 2 else EMPTY
        if found[k] != EMPTY:
            continue
        _spread(rows, owner, c, c, D)
        first, sides = _polygon(c, D, owner, low, high, row, 0.0, _ROUNDING * largest, corners)
        if sides == 0:   # one last point on the very border is lost to rounding
            first, sides = _polygon(c, D, owner, low, high, row, _BORDER * largest, 0.0, corners)
        if sides == 0:
            continue
        found[k] = FOUND
        if pick == CENTROID:
            _centroid(corners, first, sides, point)
        else:
            _corner(D, corners, first, sides, 1.0 if pick == LOWEST else -1.0, 1e-9 * largest, point)
        for i in range(m):
            tensions[k, i] = c[i] + D[i, 0] * point[0] + D[i, 1] * point[1]
    return tensions, found, spare
