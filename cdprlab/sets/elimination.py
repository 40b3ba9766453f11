"""Rows of an image from rows of what it is the image of: the coordinates that M forgets are eliminated."""

import numpy as np

from ..arrays import Array
from .simplex import TOLERANCE
from .subspace import null_space
from .zonotope import PARALLEL, across, choices


def eliminate(M: Array, A: Array, b: Array) -> tuple[Array, Array]:
    """Rows (N, d) with {M q : A q ≤ b} = {x : N x ≤ d}, some of them superfluous.

    x = M q leaves q = M⁺ x + K y open, K spanning the null space of M. By Farkas some y will do
    unless a combination λ ≥ 0 of rows with λᵀ A K = 0 forbids it, and combinations of at most r
    + 1 rows are enough for r columns. Where M has no full row rank, pairs of opposite rows hold
    x in its span.

    M : (n, k); A : (r, k); b : (r,)
    Source: Schrijver 1986, Theory of Linear and Integer Programming, sec. 7.1 and 12.2.

    >>> triangle = np.array([[1.0, 1.0], [0.0, -1.0], [-1.0, 0.0]])
    >>> N, d = eliminate(np.array([[1.0, 0.0]]), triangle, np.array([2.0, 0.0, 0.0]))
    >>> sorted(zip(N[:, 0].round(6).tolist(), d.round(6).tolist()))
    [(-1.0, 0.0), (-1.0, 0.0), (1.0, 2.0)]
    """
    K, back = null_space(M), np.linalg.pinv(M)
    used = np.isfinite(b)
    rows, limits = A[used], b[used]
    multipliers = _conformal(rows @ K)
    normals, offsets = multipliers @ (rows @ back), multipliers @ limits
    sizes = np.linalg.norm(normals, axis=1)
    says = sizes > PARALLEL * sizes.max(initial=0.0)
    flat = null_space(M.T).T
    return (np.concatenate([normals[says] / sizes[says, None], flat, -flat]),
            np.concatenate([offsets[says] / sizes[says], np.zeros(2 * len(flat))]))


def _conformal(rows: Array) -> Array:
    """(f, r) all λ ≥ 0 with λᵀ rows = 0 on at most k + 1 rows, largest entry 1."""
    r, k = rows.shape
    sizes = np.linalg.norm(rows, axis=1)
    unit = rows / np.where(sizes > PARALLEL * sizes.max(initial=0.0), sizes, 1.0)[:, None]
    chosen = choices(r, k + 1)
    weights, independent = across(unit[chosen])
    weights *= np.sign(weights.sum(axis=1, keepdims=True))
    good = independent & (weights >= -TOLERANCE).all(axis=1)
    weights = np.maximum(weights[good], 0.0) / np.where(sizes > 0, sizes, 1.0)[chosen[good]]
    found = np.zeros((len(weights), r))
    np.put_along_axis(found, chosen[good],
                      weights / weights.max(axis=1, initial=1e-300)[:, None], axis=1)
    return found
