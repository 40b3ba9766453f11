"""Null spaces and smallest solutions: the linear algebra under the sets."""

import numpy as np

from ..arrays import Array, Flags

RANK = 1e-10
"""Singular values below this share of the largest are zero."""


def null_space(matrix: Array) -> Array:
    """(k, r) orthonormal columns N with matrix N = 0.

    >>> null_space(np.array([[1.0, 0.0]])).T.round(6) + 0.0
    array([[0., 1.]])
    """
    _, s, vt = np.linalg.svd(matrix)
    return vt[int((s > RANK * s.max(initial=0.0)).sum()):].T


def solve(matrix: Array, x: Array) -> tuple[Array, Flags]:
    """The smallest q with matrix q = x for each row of x, and whether there is one."""
    u, s, vt = np.linalg.svd(matrix, full_matrices=False)
    rank = int((s > RANK * s.max(initial=0.0)).sum())
    along = x @ u[:, :rank]
    off = np.abs(x - along @ u[:, :rank].T).max(axis=-1, initial=0.0)
    size = np.maximum(np.abs(x).max(axis=-1, initial=0.0), s.max(initial=0.0) * 1e-3)
    return (along / s[:rank]) @ vt[:rank], np.asarray(off <= 1e-9 * size)
