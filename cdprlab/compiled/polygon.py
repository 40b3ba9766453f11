"""The compiled polygon of feasible tensions, for up to two redundant cables, and the points one may want of it.

With τ = c + D λ, D the identity in the free cables, the polygon of feasible λ starts as the
rectangle of these cables' limits, and is cut by those of the others.
"""

from typing import Any

import numpy as np

from ..arrays import Array
from . import CENTROID, EMPTY, FOUND, LOWEST, NEAREST, NOTHING, TOLERANCE
from .jit import compiled, compiled_for_batches
from .linear_algebra import FREE, balance, nearest, wrench_size

# Limits are met when missed by rounding only; and if nothing meets them, by half of what the
# result's check forgives.
ROUNDING, BORDER = 1e-13, TOLERANCE / 2
# A polygon of less area than this, relative to its length squared, is a segment: rounding
# leaves about 1e-16.
THIN = 1e-12


@compiled
def clip(corners: Array, first: int, count: int, limit: float, sign: float, miss: float) -> int:
    """Cuts a convex polygon where sign · t > limit + miss, t linear over it (Sutherland and Hodgman 1974).

    corners[first:first + count] are (x, y, t); those kept go to the other half of the array;
    returns how many.
    """
    to = begin = corners.shape[0] // 2 - first
    before = first + count - 1
    over_before = sign * corners[before, 2] - limit
    for now in range(first, first + count):
        over = sign * corners[now, 2] - limit
        if (over > miss) != (over_before > miss):
            near, far, share = before, now, over_before / (over_before - over)
            if share > 0.5:   # from the end that is far, say at 1e12 N, rounding would be felt
                near, far, share = now, before, over / (over - over_before)
            for a in range(3):
                corners[to, a] = corners[near, a] + share * (corners[far, a] - corners[near, a])
            to += 1
        if over <= miss:
            for a in range(3):
                corners[to, a] = corners[now, a]
            to += 1
        before = now
        over_before = over
    return to - begin


@compiled
def polygon(c: Array, D: Array, owner: Any, low: Array, high: Array, row: int, size: float,
            corners: Array) -> tuple[int, int]:
    """Corners, in order, of {λ : low[row] ≤ c + D λ ≤ high[row]}; those of a segment or a point coincide.

    size : `wrench_size`
    Returns where in ``corners`` they begin, and how many they are.
    """
    slack, miss = 0.0, ROUNDING
    for _ in range(2):
        first: Any = np.int64(0)   # for bare literals `clip` would be compiled a second time
        count: Any = np.int64(4)
        corners[:4] = 0.0
        axis = 0
        for j in range(c.shape[0]):
            if owner[j] == FREE:
                for k in range(4):   # low, low, high, high of one λ, and low, high, high, low of the other
                    end = low[row, j] - slack * (size + abs(low[row, j]))
                    if (k + axis) % 4 > 1:
                        end = high[row, j] + slack * (size + abs(low[row, j]))
                    corners[k, axis] = end
                axis += 1
        for j in range(c.shape[0]):
            for sign in (-1.0, 1.0):
                if owner[j] == FREE or count == 0:
                    continue
                scale = size + abs(low[row, j])
                limit = slack * scale + (high[row, j] if sign > 0.0 else -low[row, j])
                broken = False
                for k in range(first, first + count):
                    corners[k, 2] = c[j] + D[j, 0] * corners[k, 0] + D[j, 1] * corners[k, 1]
                    broken |= sign * corners[k, 2] > limit + miss * scale
                if broken:
                    count = clip(corners, first, count, limit, sign, miss * scale)
                    first = corners.shape[0] // 2 - first
        if count > 0:
            break
        slack, miss = BORDER, 0.0   # one last point on the very border is lost to rounding
    return first, count


@compiled
def centroid(corners: Array, first: int, count: int, point: Array) -> None:
    """Area centroid by a fan of triangles; the middle of the box around it where there is no area to speak of."""
    area, extent, point[0], point[1] = 0.0, 0.0, 0.0, 0.0
    for k in range(first + 1, first + count - 1):
        x, y = corners[k, 0] - corners[first, 0], corners[k, 1] - corners[first, 1]
        next_x, next_y = corners[k + 1, 0] - corners[first, 0], corners[k + 1, 1] - corners[first, 1]
        piece = abs(x * next_y - y * next_x)
        area += piece
        extent += x * x + y * y + next_x * next_x + next_y * next_y
        point[0] += piece * (x + next_x)
        point[1] += piece * (y + next_y)
    for a in range(2):
        if area > THIN * extent:
            point[a] = corners[first, a] + point[a] / (3 * area)
        else:
            least = most = corners[first, a]
            for k in range(first + 1, first + count):
                least, most = min(least, corners[k, a]), max(most, corners[k, a])
            point[a] = (least + most) / 2


@compiled
def corner(D: Array, corners: Array, first: int, count: int, sign: float, close: float, point: Array) -> None:
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
def inside(c: Array, D: Array, point: Array, low: Array, high: Array, row: int) -> bool:
    """Whether c + D λ keeps the limits."""
    for i in range(c.shape[0]):
        tau = c[i] + D[i, 0] * point[0] + D[i, 1] * point[1]
        if tau < low[row, i] or tau > high[row, i]:
            return False
    return True


@compiled
def border_point(c: Array, D: Array, corners: Array, first: int, count: int, point: Array) -> None:
    """The point of least ‖c + D λ‖ on the border: on each edge p + s (q − p) the best s, kept from 0 to 1."""
    for k in range(first, first + count):
        corners[k, 2] = 0.0
        for i in range(c.shape[0]):
            tau = c[i] + D[i, 0] * corners[k, 0] + D[i, 1] * corners[k, 1]
            corners[k, 2] += tau * tau
    least = np.inf
    before = first + count - 1
    for k in range(first, first + count):
        near, far = before, k   # from a far end rounding would be felt
        if corners[k, 2] < corners[before, 2]:
            near, far = k, before
        x, y = corners[far, 0] - corners[near, 0], corners[far, 1] - corners[near, 1]
        along, steepness = 0.0, 0.0
        for i in range(c.shape[0]):
            start = c[i] + D[i, 0] * corners[near, 0] + D[i, 1] * corners[near, 1]
            step = D[i, 0] * x + D[i, 1] * y
            along -= start * step
            steepness += step * step
        s = 0.0
        if along > 0.0:
            s = min(along / steepness, 1.0)
        square = corners[near, 2] + s * (s * steepness - 2.0 * along)
        if square < least:
            least = square
            point[0], point[1] = corners[near, 0] + s * x, corners[near, 1] + s * y
        before = k


@compiled_for_batches
def polygons(W: Array, w_e: Array, low: Array, high: Array, pick: int) -> tuple[Array, Any, Any]:
    """One point of each polygon of feasible tensions; with NOTHING only whether there is one.

    NEAREST is exact: the only active sets of its program are none, an edge and a corner.

    W (k, n, m); w_e (k, n); low, high both (k, m) or both (1, m); pick NOTHING or one of the
    others
    Returns tensions (k, m), NaN without an answer; FOUND or why not (k,); redundancy r = m −
    rank (k,).
    """
    count, n, m = W.shape
    tensions, found, spare = np.empty((count, m)), np.empty(count, np.int64), np.empty(count, np.int64)
    rows, line, owner = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m, np.int64)
    c, D = np.empty(m), np.empty((m, max(m, 2)))
    corners, point, zero, gram = np.empty((4 * m + 16, 3)), np.empty(2), np.zeros(m), np.empty((2, 2))
    for k in range(count):
        row = k if low.shape[0] > 1 else 0
        size, least = wrench_size(w_e, k), 0.0
        for j in range(m):
            owner[j] = FREE
            least = max(least, low[row, j])
        found[k], spare[k] = balance(W, w_e, k, c, rows, line, owner, c, D)
        point[0] = point[1] = np.nan
        near = found[k] == FOUND and pick == NEAREST
        if near:
            point[0] = point[1] = 0.0
            nearest(c, D, spare[k], zero, gram, point)
            near = inside(c, D, point, low, high, row)
        if found[k] == FOUND and not near:
            first, sides = polygon(c, D, owner, low, high, row, size, corners)
            if sides == 0:
                found[k] = EMPTY
                point[0] = np.nan
            elif pick == NEAREST:
                border_point(c, D, corners, first, sides, point)
            elif pick == CENTROID:
                centroid(corners, first, sides, point)
            elif pick != NOTHING:
                corner(D, corners, first, sides, 1.0 if pick == LOWEST else -1.0,
                       1e-9 * (size + least), point)
        for i in range(m):
            tensions[k, i] = c[i] + D[i, 0] * point[0] + D[i, 1] * point[1]
    return tensions, found, spare
