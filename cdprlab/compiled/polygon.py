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
            if abs(over) < abs(over_before):   # from an end that is far, say at 1e12 N, rounding would be felt
                near, far, share = now, before, over / (over - over_before)
            else:
                near, far, share = before, now, over_before / (over_before - over)
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
def polygon(c: Array, D: Array, owner: Any, low: Array, high: Array, size: float, slack: float,
            corners: Array) -> Array:
    """(k, 3) corners λ, in order, of {λ : low ≤ c + D λ ≤ high}; those of a segment or a point coincide.

    size : `wrench_size`; slack : 0, which becomes BORDER where nothing is found, or BORDER;
    corners : (4 m + 16, 3) to work in
    """
    while True:
        first: Any = np.int64(0)   # for bare literals `clip` would be compiled a second time
        count: Any = np.int64(4)
        corners[:4] = 0.0
        axis = 0
        for j in range(len(c)):
            if owner[j] == FREE:
                scale = slack * (size + abs(low[j]))
                corners[:4, axis] = low[j] - scale
                for k in (2, 3 - 2 * axis):   # the second λ is high at the second and third corner
                    corners[k, axis] = high[j] + scale
                axis += 1
        for j in range(len(c)):
            if owner[j] == FREE:
                continue
            least, most = np.inf, -np.inf
            for k in range(first, first + count):
                t = c[j] + D[j, 0] * corners[k, 0] + D[j, 1] * corners[k, 1]
                least, most = min(least, t), max(most, t)
                corners[k, 2] = t
            scale = size + abs(low[j])
            for sign, worst, end in ((-1.0, -least, -low[j]), (1.0, most, high[j])):
                limit = end + slack * scale
                if worst > limit + ROUNDING * scale:
                    count = clip(corners, first, count, limit, sign, ROUNDING * scale)
                    first = len(corners) // 2 - first
        if count or slack > 0.0:
            return corners[first:first + count]
        slack = BORDER   # one last point on the very border is lost to rounding


@compiled
def centroid(corners: Array, point: Array) -> None:
    """Area centroid by a fan of triangles; the middle of the box around it where there is no area to speak of."""
    area, extent, point[0], point[1] = 0.0, 0.0, 0.0, 0.0
    for k in range(1, len(corners) - 1):
        x, y = corners[k, 0] - corners[0, 0], corners[k, 1] - corners[0, 1]
        next_x, next_y = corners[k + 1, 0] - corners[0, 0], corners[k + 1, 1] - corners[0, 1]
        piece = abs(x * next_y - y * next_x)
        area += piece
        extent += x * x + y * y + next_x * next_x + next_y * next_y
        point[0] += piece * (x + next_x)
        point[1] += piece * (y + next_y)
    for a in range(2):
        if area > THIN * extent:
            point[a] = corners[0, a] + point[a] / (3 * area)
        else:
            least = most = corners[0, a]
            for k in range(1, len(corners)):
                least, most = min(least, corners[k, a]), max(most, corners[k, a])
            point[a] = (least + most) / 2


@compiled
def corner(D: Array, corners: Array, sign: float, close: float, point: Array) -> None:
    """The corner of least sign · Σ τ; among equals the one whose first tensions are least, in any basis the same."""
    best = 0
    for k in range(1, len(corners)):
        x, y, total = corners[k, 0] - corners[best, 0], corners[k, 1] - corners[best, 1], 0.0
        for i in range(len(D)):
            total += sign * (D[i, 0] * x + D[i, 1] * y)
        i = 0
        while abs(total) <= close and i < len(D):
            total = D[i, 0] * x + D[i, 1] * y
            i += 1
        if total < 0:
            best = k
    point[0], point[1] = corners[best, 0], corners[best, 1]


@compiled
def border_point(c: Array, D: Array, corners: Array, point: Array) -> None:
    """The point of least ‖c + D λ‖ on the border: on each edge p + s (q − p) the best s, kept from 0 to 1."""
    for k in range(len(corners)):
        corners[k, 2] = 0.0
        for i in range(len(c)):
            tau = c[i] + D[i, 0] * corners[k, 0] + D[i, 1] * corners[k, 1]
            corners[k, 2] += tau * tau
    least = np.inf
    before = len(corners) - 1
    for k in range(len(corners)):
        near, far = before, k   # from a far end rounding would be felt
        if corners[k, 2] < corners[before, 2]:
            near, far = k, before
        x, y = corners[far, 0] - corners[near, 0], corners[far, 1] - corners[near, 1]
        along, steepness = 0.0, 0.0
        for i in range(len(c)):
            start = c[i] + D[i, 0] * corners[near, 0] + D[i, 1] * corners[near, 1]
            step = D[i, 0] * x + D[i, 1] * y
            along -= start * step
            steepness += step * step
        s = min(along / steepness, 1.0) if along > 0.0 else 0.0
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
    owner, zero, point = np.empty(m, np.int64), np.zeros(m), np.empty(2)
    rows, line, c = np.empty((n, m + 1)), np.empty(m + 1), np.empty(m)
    D, room = np.empty((m, max(m, 2))), np.empty((4 * m + 16, 3))
    for k in range(count):
        row = k if len(low) > 1 else 0
        low_k, high_k, size, least = low[row], high[row], wrench_size(w_e[k]), 0.0
        for j in range(m):
            owner[j] = FREE
            least = max(least, low_k[j])
        found[k], spare[k] = balance(W[k], w_e[k], zero, rows, line, owner, c, D)
        point[0] = point[1] = np.nan
        near = found[k] == FOUND and pick == NEAREST
        if near:
            lam = nearest(c, D, spare[k], zero)
            point[0], point[1] = lam[0], lam[1]
            for i in range(m):
                near = near and low_k[i] <= c[i] + D[i, 0] * point[0] + D[i, 1] * point[1] <= high_k[i]
        if found[k] == FOUND and not near:
            # No point to be true to the limits, no first look without slack.
            slack = BORDER if pick == NOTHING else 0.0
            corners = polygon(c, D, owner, low_k, high_k, size, slack, room)
            if len(corners) == 0:
                found[k] = EMPTY
                point[0] = np.nan
            elif pick == NEAREST:
                border_point(c, D, corners, point)
            elif pick == CENTROID:
                centroid(corners, point)
            elif pick != NOTHING:
                corner(D, corners, 1.0 if pick == LOWEST else -1.0, 1e-9 * (size + least), point)
        for i in range(m):
            tensions[k, i] = c[i] + D[i, 0] * point[0] + D[i, 1] * point[1]
    return tensions, found, spare
