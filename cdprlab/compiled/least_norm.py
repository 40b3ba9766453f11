"""The compiled least-norm tensions where no limit is active, which is what control loops mostly ask for."""

import numpy as np

from ..arrays import Array
from .jit import compiled_for
from .linear_algebra import factor, solve


@compiled_for(2, 1, 1, 1)
def no_limit_active(W: Array, w_e: Array, low: Array, high: Array) -> tuple[Array, bool]:
    """τ = −Wᵀ (W Wᵀ)⁻¹ w_e (m,) by Cholesky, and whether it can be trusted and keeps the limits.

    W Wᵀ has W's condition squared, of which the factor's diagonal is an estimate: 1e-3 leaves
    residuals of about 1e6 ε = 1e-10.
    """
    n, m = W.shape
    L, y, tau = np.zeros((n, n)), -w_e, np.zeros(m)
    for i in range(n):
        for j in range(i + 1):
            for k in range(m):
                L[i, j] += W[i, k] * W[j, k]
    factor(L)
    solve(L, y)
    least, largest = np.inf, 0.0
    for i in range(n):
        least, largest = min(least, L[i, i]), max(largest, L[i, i])
        for j in range(m):
            tau[j] += W[i, j] * y[i]
    kept = least >= 1e-3 * largest
    for j in range(m):
        kept = kept and low[j] <= tau[j] <= high[j]
    return tau, kept
