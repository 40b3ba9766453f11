"""The compiled least-norm tensions, for up to two redundant cables: the point nearest to 0 of the feasible polygon."""

from typing import Any

import numpy as np

from ..arrays import Array
from . import EMPTY, FOUND
from .jit import compiled, compiled_for, compiled_for_batches
from .linear_algebra import FREE, balance, nearest, wrench_size
from .polygon import polygon


@compiled_for(2, 1, 1, 1)
def no_limit_active(W: Array, w_e: Array, low: Array, high: Array) -> tuple[Array, bool]:
    """τ = −Wᵀ (W Wᵀ)⁻¹ w_e (m,) by Cholesky, and whether it can be trusted and keeps the limits.

    W Wᵀ has W's condition squared, of which the factor's diagonal is an estimate: 1e-3 leaves
    residuals of about 1e6 ε = 1e-10.
    """
    n, m = W.shape
    L, y, tau = np.empty((n, n)), -w_e, np.zeros(m)
    least, largest = np.inf, 0.0
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(m):
                total += W[i, k] * W[j, k]
            for k in range(j):
                total -= L[i, k] * L[j, k]
            L[i, j] = np.sqrt(total) if i == j else total / L[j, j]
        for k in range(i):
            y[i] -= L[i, k] * y[k]
        y[i] /= L[i, i]
        least, largest = min(least, L[i, i]), max(largest, L[i, i])
    kept = least >= 1e-3 * largest
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            y[i] -= L[k, i] * y[k]
        y[i] /= L[i, i]
        for j in range(m):
            tau[j] += W[i, j] * y[i]
    for j in range(m):
        kept = kept and low[j] <= tau[j] <= high[j]
    return tau, kept


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
def least_norms(W: Array, w_e: Array, low: Array, high: Array) -> tuple[Array, Any, Any]:
    """min ‖τ‖² with W τ + w_e = 0 and the limits: exact, as the program's only active sets are none, an edge, a corner.

    W (k, n, m); w_e (k, n); low, high both (k, m) or both (1, m)
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
        for j in range(m):
            owner[j] = FREE
        found[k], spare[k] = balance(W, w_e, k, c, rows, line, owner, c, D)
        point[0] = point[1] = 0.0 if found[k] == FOUND else np.nan
        if found[k] == FOUND:
            nearest(c, D, spare[k], zero, gram, point)
            if not inside(c, D, point, low, high, row):
                first, sides = polygon(c, D, owner, low, high, row, wrench_size(w_e, k), corners)
                if sides == 0:
                    found[k] = EMPTY
                    point[0] = np.nan
                else:
                    border_point(c, D, corners, first, sides, point)
        for i in range(m):
            tensions[k, i] = c[i] + D[i, 0] * point[0] + D[i, 1] * point[1]
    return tensions, found, spare
