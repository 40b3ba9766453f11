"""Facets of a zonotope, the image of a box, by hyperplane shifting."""

from functools import lru_cache
from itertools import combinations
from math import comb

import numpy as np

from ..arrays import Array, Indices
from ..errors import NotListable

PARALLEL = 1e-9
"""Unit normals this close together are one; generators shorter than this share of the longest are none."""

MOST_COMBINATIONS = 100_000
"""Of generators, before a listing is called too long."""


def hyperplane_shifting(center: Array, generators: Array) -> tuple[Array, Array]:
    """Rows (N, d) with {center + G z : |z| ≤ 1} = {x : N x ≤ d}, one row a facet; G must have full row rank.

    Every facet is parallel to n − 1 independent generators; its plane is shifted outwards along
    its normal n by Σ |n·g_i|.

    center : (n,); generators : G, (n, k)
    Raises NotListable where the choices of n − 1 generators are more than
    ``MOST_COMBINATIONS``.
    Source: Gouttefarde and Krut 2010; Bouchard et al. 2010.

    >>> normals, offsets = hyperplane_shifting(np.zeros(2), np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]))
    >>> len(normals), float(offsets.max().round(6))
    (6, 2.0)
    """
    n, k = generators.shape
    count = comb(k, n - 1)
    if count > MOST_COMBINATIONS:
        raise NotListable(f"{k} cables in {n} dimensions make {count} candidate planes, more than "
                          f"{MOST_COMBINATIONS}; ask contains and support instead, of a workspace by='tensions'")
    normals = np.ones((1, 1)) if n == 1 else _shifting_normals(generators)
    reach = np.abs(normals @ generators).sum(axis=1)
    middle = normals @ center
    return np.concatenate([normals, -normals]), np.concatenate([reach + middle, reach - middle])


def _shifting_normals(generators: Array) -> Array:
    """(f, n) one unit normal a pair of opposite facets: orthogonal to n − 1 independent columns of G."""
    n, k = generators.shape
    lengths = np.linalg.norm(generators, axis=0)
    unit = (generators / np.where(lengths > PARALLEL * lengths.max(), lengths, np.inf)).T
    # One normal a choice of n − 1 generators: R of the transposed choice is triangular, its
    # last row's null vector follows from cofactors; QR by columns is what LAPACK batches best.
    chosen = unit[choices(k, n - 1)]
    q, r = np.linalg.qr(np.swapaxes(chosen, -1, -2), mode="complete")
    pivots = np.abs(np.diagonal(r, axis1=-2, axis2=-1))
    normals = q[pivots.min(axis=-1) > PARALLEL, :, -1]
    # Each line once, its first entry that is not small positive.
    normals = normals * np.sign(np.take_along_axis(normals, (np.abs(normals) > 1e-7).argmax(axis=1)[:, None], axis=1))
    return normals[first_of_each(normals)]


def zonotope_volume(generators: Array) -> float:
    """2ⁿ Σ |det of n generators| over all choices.

    generators : (n, k)
    Source: McMullen 1984, Volumes of projections of unit cubes.

    >>> zonotope_volume(np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]))
    12.0
    """
    n, k = generators.shape
    chosen = generators.T[choices(k, n)]
    return float(2.0 ** n * np.abs(np.linalg.det(chosen)).sum())


@lru_cache(maxsize=16)
def choices(k: int, size: int) -> Indices:
    """(…, size) every choice among 0 to k − 1."""
    return np.array(list(combinations(range(k), size)), dtype=np.intp).reshape(-1, size)


def first_of_each(rows: Array, tolerance: float = 1e-8) -> Indices:
    """Indices of rows that equal no earlier one up to ``tolerance``.

    >>> first_of_each(np.array([[0.0, 1.0], [1.0, 0.0], [0.0, 1.0 + 1e-12]]))
    array([0, 1])
    """
    # Along a fixed slanted line equal rows land on equal numbers; only neighbors there need to
    # be compared.
    slant = rows @ np.sqrt(np.arange(2, 2 + rows.shape[1]))
    order = np.argsort(slant, kind="stable")
    reach = tolerance * np.sqrt(rows.shape[1] * (2 + rows.shape[1]))
    kept = np.ones(len(rows), dtype=bool)
    for gap in range(1, len(rows)):
        near = slant[order[gap:]] - slant[order[:-gap]] <= reach
        if not near.any():
            break
        first, later = order[:-gap][near], order[gap:][near]
        same = (np.abs(rows[first] - rows[later]) <= tolerance).all(axis=1)
        kept[np.maximum(first[same], later[same])] = False
    return np.flatnonzero(kept)
