"""Ropes that can only pull, one step of an engine: a linear complementarity problem, set up and solved."""

import numpy as np

from ..arrays import Array
from .control import mass_and_bias
from .jit import compiled, compiled_for
from .linear_algebra import factor, solve

# Of A's trace: keeps the tensions of redundant ropes unique and smooth; at 1e-9 they ripple,
# see the tests.
YIELD = 1e-6


@compiled
def complementary(A: Array, b: Array, last: Array) -> Array:
    """T ≥ 0 (m,) with A T − b ≥ 0 and Tᵀ (A T − b) = 0, for a positive definite A.

    Mostly the ropes that were taut with the ``last`` tensions are taut still; from there
    Murty's least-index pivoting comes to the answer, of which there is one, whatever was tried
    first.
    """
    m = b.size
    T, taut, small = np.zeros(m), last > 0.0, 1e-13 * np.abs(b).max()
    for _ in range(1000):
        pulling = np.flatnonzero(taut)
        part, pulls = A[pulling][:, pulling], b[pulling]
        factor(part)
        solve(part, pulls)
        T[:] = 0.0
        for k, pull in zip(pulling, pulls):
            T[k] = pull
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

    mass, inertia, center, gravity, R, t : as `mass_and_bias` takes them; push : (n,) at P; W :
        whole, (n, m), n = 3 planar or 6 spatial
    stiffness : EA [N], 0 of ropes that do not stretch; damping : each rope's own, fraction of
        critical
    last : (m,) tensions of the step before
    """
    n, m = W.shape
    M, h = mass_and_bias(mass, inertia, center, gravity, R, t)
    # M⁻¹ [W, push − h], a row each
    light = np.concatenate((W.T, (push - h).reshape(1, n)))
    factor(M)
    for i in range(m + 1):
        solve(M, light[i])
    A, b, trace = np.zeros((m, m)), np.empty(m), 0.0
    for i in range(m):
        for j in range(m):
            for k in range(n):
                A[i, j] += W[k, i] * light[j, k]
        trace += A[i, i]
    for i in range(m):
        # J v and J v̇ without ropes, with J = −Wᵀ
        rate = gain = 0.0
        for k in range(n):
            rate -= W[k, i] * t[k]
            gain -= W[k, i] * light[m, k]
        if stiffness > 0.0:
            # T = k (L − ρ) + d (J v − ρ̇) + (k dt / 4 + d / 2) J (v' − v): Newmark's average
            # acceleration, which damps nothing by itself, as v is half a step behind L. What
            # rings too fast to be followed, ω dt > 2, is damped, T = k (L' − ρ') + d (L̇' − ρ̇).
            k_i, a_i = stiffness / now[i], max(A[i, i], 1e-12)
            d_i = 2 * damping * np.sqrt(k_i / a_i)
            unseen = min(1.0, (k_i * a_i * dt * dt / 4)**2)
            stiff = dt * (k_i * dt * (1 + 3 * unseen) / 4 + d_i * (1 + unseen) / 2)
            off, off_rate = lengths[i] - now[i], rate - (wound[i] - now[i]) / dt
            b[i] = (k_i * (off + unseen * dt * off_rate) + d_i * off_rate) / stiff + gain
            A[i, i] += 1 / stiff
        else:   # L + dt J v' ≤ ρ'
            b[i] = (lengths[i] + dt * (rate + dt * gain) - wound[i]) / (dt * dt)
            A[i, i] += YIELD * trace
    return complementary(A, b, last)
