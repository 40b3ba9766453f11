"""Ropes that can only pull, one step of an engine: a linear complementarity problem, set up and solved."""

import numpy as np

from ..arrays import Array
from .control import mass_and_bias
from .jit import compiled, compiled_for

# Of A's trace: keeps the tensions of redundant ropes unique and smooth; at 1e-9 they ripple,
# see the tests.
YIELD = 1e-6


@compiled
def solve(A: Array, B: Array) -> None:
    """B becomes A⁻¹ B by elimination; A (n, n), positive definite, is overwritten."""
    n, k = B.shape
    for p in range(n):
        for row in range(p + 1, n):
            factor = A[row, p] / A[p, p]
            for j in range(p, n):
                A[row, j] -= factor * A[p, j]
            for j in range(k):
                B[row, j] -= factor * B[p, j]
    for p in range(n - 1, -1, -1):
        for j in range(k):
            for q in range(p + 1, n):
                B[p, j] -= A[p, q] * B[q, j]
            B[p, j] /= A[p, p]


@compiled
def complementary(A: Array, b: Array, last: Array) -> Array:
    """T ≥ 0 (m,) with A T − b ≥ 0 and Tᵀ (A T − b) = 0, for a positive definite A.

    Mostly the ropes that were taut with the ``last`` tensions are taut still; from there
    Murty's least-index pivoting comes to the answer, of which there is one, whatever was tried
    first.
    """
    m = b.size
    T, taut, order, small = np.zeros(m), last > 0.0, np.zeros(m, np.int64), 1e-13 * np.abs(b).max()
    for _ in range(1000):
        k = 0
        for i in range(m):
            if taut[i]:
                order[k] = i
                k += 1
        part, pulls = np.empty((k, k)), np.empty((k, 1))
        for i in range(k):
            pulls[i, 0] = b[order[i]]
            for j in range(k):
                part[i, j] = A[order[i], order[j]]
        solve(part, pulls)
        T[:] = 0.0
        for i in range(k):
            T[order[i]] = pulls[i, 0]
        wrong = -1
        for i in range(m - 1, -1, -1):
            gap = -b[i]
            for j in range(m):
                gap += A[i, j] * T[j]
            if (taut[i] and T[i] * A[i, i] < -small) or (not taut[i] and gap < -small):
                wrong = i
        if wrong < 0:
            break
        taut[wrong] = not taut[wrong]
    return np.maximum(T, 0.0)


@compiled_for(0, 2, 1, 0, 2, 1, 1, 2, 1, 1, 1, 0, 0, 0, 1)
def rope_tensions(mass: float, inertia: Array, center: Array, gravity: float, R: Array,
                  t: Array, push: Array,
                  W: Array, lengths: Array, now: Array, wound: Array, dt: float,
                  stiffness: float, damping: float,
                  last: Array) -> Array:
    """T (m,) of ropes that are wound from ``now`` to ``wound`` by the end of the step.

    mass, inertia, center, gravity, R, t : as `mass_and_bias` takes them; push : (6,) at P; W :
        whole, (6, m)
    stiffness : EA [N], 0 of ropes that do not stretch; damping : fraction of critical
    last : (m,) tensions of the step before
    """
    m = W.shape[1]
    M, h = mass_and_bias(mass, inertia, center, gravity, R, t)
    # [M⁻¹ W, M⁻¹ (push − h)]
    light = np.empty((6, m + 1))
    light[:, :m] = W
    light[:, m] = push - h
    solve(M, light)
    A, b, trace = np.zeros((m, m)), np.empty(m), 0.0
    for i in range(m):
        for j in range(m):
            for k in range(6):
                A[i, j] += W[k, i] * light[k, j]
        trace += A[i, i]
    for i in range(m):
        # L + dt J v_free − ρ', with J = −Wᵀ
        over = lengths[i] - wound[i]
        for k in range(6):
            over -= dt * W[k, i] * (t[k] + dt * light[k, m])
        if stiffness > 0.0:   # T = k (L' − ρ') + d (L̇' − ρ̇) at the step's end
            k_i = stiffness / wound[i]
            d_i = 2 * damping * np.sqrt(k_i / max(A[i, i], 1e-12))
            stiff = dt * (k_i * dt + d_i)
            b[i] = (k_i * over + d_i * (over - (lengths[i] - now[i])) / dt) / stiff
            A[i, i] += 1 / stiff
        else:
            b[i] = over / (dt * dt)
            A[i, i] += YIELD * trace
    return complementary(A, b, last)
