"""The feasible tensions of r ≤ 2 by brute force, independent of the library: SVD basis, all pairs of limits."""

import itertools

import numpy as np


class Candidates:
    """Every point where up to r limits are met exactly, of a batch of wrenches.

    W (k, n, m) of full rank; w_e (k, n); low, high (m,). ``points`` (k, c, m) hold the least-norm point for each set
    of met limits, ``inside`` (k, c) whether all limits are kept, ``corners`` (c,) which of them meet r.
    """

    def __init__(self, W, w_e, low, high):
        n, m = W.shape[1:]
        u, s, vt = np.linalg.svd(W)
        self.null = np.swapaxes(vt[:, n:], 1, 2)
        self.least_norm = -(vt[:, :n].swapaxes(1, 2) @ ((u.swapaxes(1, 2) @ w_e[..., None]) / s[..., None]))[..., 0]
        rows = np.concatenate([self.null, self.null], axis=1)
        values = np.concatenate([low - self.least_norm, high - self.least_norm], axis=1)
        r, parts, counts = m - n, [], []
        for size in range(r + 1):
            chosen = list(itertools.combinations(range(2 * m), size))
            sets = np.array(chosen, dtype=int).reshape(len(chosen), size)
            parts.append(_least(rows[:, sets], values[:, sets]))
            counts += [size] * len(sets)
        coordinates = np.concatenate(parts, axis=1)
        self.corners = np.array(counts) == r
        self.points = self.least_norm[:, None] + coordinates @ self.null.swapaxes(1, 2)
        close = 1e-9 * high.max()
        self.inside = ((self.points >= low - close) & (self.points <= high + close)).all(axis=-1)

    @property
    def feasible(self):
        """(k,) whether some corner keeps all limits."""
        return (self.inside & self.corners).any(axis=1)

    def best(self, cost):
        """(k,) smallest cost (k, c) of a point that keeps all limits."""
        return np.where(self.inside, cost, np.inf).min(axis=1)


def _least(rows, values):
    """(k, c, r) least-norm λ with rows λ = values, NaN where the rows depend on each other; rows (k, c, size, r)."""
    size = rows.shape[2]
    gram = rows @ rows.swapaxes(-1, -2)
    with np.errstate(divide="ignore", invalid="ignore"):
        if size == 0:
            return np.zeros((*rows.shape[:2], rows.shape[3]))
        if size == 1:
            weights = values / gram[..., 0]
        else:
            a, b, d = gram[..., 0, 0], gram[..., 0, 1], gram[..., 1, 1]
            det = a * d - b * b
            det = np.where(det < 1e-12 * a * d, np.nan, det)
            weights = np.stack([d * values[..., 0] - b * values[..., 1], a * values[..., 1] - b * values[..., 0]],
                               axis=-1) / det[..., None]
    return (weights[..., None, :] @ rows)[..., 0, :]
