"""The compiled wrench matrix, the same as in `statics`."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .polygon import compiled


@compiled
def columns(exits: Array, anchors: Array, position: Array, rotation: Array, n: int) -> tuple[Array, bool]:
    """(k, n, m) of [u; r × u] as far as there are rows, and whether every cable has a length."""
    count, d = position.shape
    m = exits.shape[0]
    W, r, u, whole = np.empty((count, n, m)), np.zeros(3), np.zeros(3), True
    for k in range(count):
        for i in range(m):
            square = 0.0
            for a in range(d):
                r[a] = 0.0
                for b in range(d):
                    r[a] += rotation[k, a, b] * anchors[i, b]
                u[a] = exits[i, a] - position[k, a] - r[a]
                square += u[a] * u[a]
            whole &= square > 0.0
            inverse = 1.0 / np.sqrt(square)
            for a in range(d):
                u[a] *= inverse
            for a in range(min(d, n)):
                W[k, a, i] = u[a]
            if n == 6:
                W[k, 3, i] = r[1] * u[2] - r[2] * u[1]
                W[k, 4, i] = r[2] * u[0] - r[0] * u[2]
            if n == 6 or (n == 3 and d == 2):
                W[k, n - 1, i] = r[0] * u[1] - r[1] * u[0]
    return W, whole
