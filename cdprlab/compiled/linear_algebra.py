"""All tensions τ = c + D λ that balance a wrench, by Gauss–Jordan elimination, and the nearest of them to a wish.

Elimination makes D the identity in the free cables, so that λ are these cables' own tensions.
Nothing chosen from them in this room (the nearest tensions, the centroid, a vertex) depends on
which basis of W's null space that is.
"""

from typing import Any

import numpy as np

from ..arrays import Array
from . import FOUND, OUT_OF_RANGE, TOLERANCE, TOO_REDUNDANT
from .jit import compiled

FREE, HELD = -1, -2
"""Before elimination: a column that may solve a row, and one held at a value."""

# A row this much smaller than it was depends on those before it: elimination leaves about 1e-15
# of it.
DEPENDENT = 1e-12
NOUGHT = 1e-15


@compiled
def wrench_size(w_e: Array) -> float:
    """1 + |w_e|∞: what tolerances are shares of."""
    size = 1.0
    for force in w_e:
        size = max(size, 1.0 + abs(force))
    return size


@compiled
def balance(W: Array, w_e: Array, held_at: Array, rows: Array, line: Array, owner: Any, c: Array,
            D: Array) -> tuple[int, int]:
    """c (m,) and D (m, m or 2) of one pose, by Gauss–Jordan on [W | −w_e − W_held τ_held]; a λ not there moves nothing.

    W (n, m); w_e (n,); rows (n, m + 1) and line (m + 1,) to work in; ``owner[j]``, FREE or HELD,
    becomes the row of W that column j solves
    Returns OUT_OF_RANGE where rows that depend on others do not agree with them, else
    TOO_REDUNDANT or FOUND; how many λ there are, one per free cable.
    """
    n, m = W.shape
    for i in range(n):
        rows[i, m] = -w_e[i]
        for j in range(m):
            rows[i, j] = W[i, j]
            if owner[j] == HELD:
                rows[i, m] -= W[i, j] * held_at[j]
                rows[i, j] = 0.0
    agree = True
    for i in range(n):
        pivot, largest, before = -1, 0.0, 0.0
        for j in range(m):
            before = max(before, abs(W[i, j]))
            if owner[j] == FREE and abs(rows[i, j]) > largest:
                pivot, largest = j, abs(rows[i, j])
        if largest <= DEPENDENT * before:
            agree = agree and abs(rows[i, m]) <= TOLERANCE * wrench_size(w_e)
            continue
        owner[pivot] = i
        scale = 1.0 / rows[i, pivot]
        for j in range(m + 1):   # in an array of its own the loop below runs on vectors
            line[j] = rows[i, j] * scale
        for q in range(n):
            factor = rows[q, pivot]
            for j in range(m + 1):
                rows[q, j] -= factor * line[j]
        for j in range(m + 1):
            rows[i, j] = line[j]
    free = 0
    for j in range(m):
        D[j, 0] = D[j, 1] = c[j] = 0.0
    for j in range(m):
        if owner[j] == HELD:
            c[j] = held_at[j]
        elif owner[j] >= 0:
            c[j] = rows[owner[j], m]
        else:
            for i in range(m):
                D[i, free] = 0.0
                # Less than nought would, of a wish at 1e12 N, make something.
                if owner[i] >= 0 and abs(rows[owner[i], j]) >= NOUGHT:
                    D[i, free] = -rows[owner[i], j]
            D[j, free] = 1.0
            free += 1
    known = TOO_REDUNDANT if free > 2 else FOUND
    return known if agree else OUT_OF_RANGE, free


@compiled
def factor(A: Array) -> None:
    """The lower half of A, positive definite, becomes L with L Lᵀ = A."""
    for i in range(len(A)):
        for j in range(i + 1):
            for k in range(j):
                A[i, j] -= A[i, k] * A[j, k]
            A[i, j] = np.sqrt(A[i, i]) if i == j else A[i, j] / A[j, j]


@compiled
def solve(L: Array, b: Array) -> None:
    """The first n numbers of b become (L Lᵀ)⁻¹ b, with L (n, n)."""
    n = len(L)
    for i in range(n):
        for k in range(i):
            b[i] -= L[i, k] * b[k]
        b[i] /= L[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            b[i] -= L[k, i] * b[k]
        b[i] /= L[i, i]


@compiled
def nearest(c: Array, D: Array, free: int, wish: Array) -> Array:
    """λ (m or 2,) of min ‖c + D λ − wish‖², where Dᵀ D is at least the identity."""
    lam, gram = np.zeros(D.shape[1]), np.zeros((free, free))
    for a in range(free):
        for i in range(len(c)):
            lam[a] += D[i, a] * (wish[i] - c[i])
            for b in range(a + 1):
                gram[a, b] += D[i, a] * D[i, b]
    factor(gram)
    solve(gram, lam)
    return lam


@compiled
def cross(a: Any, b: Any) -> Any:
    """The three entries of a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
