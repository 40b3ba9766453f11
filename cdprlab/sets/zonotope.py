"""Facets of a zonotope, the image of a box, by hyperplane shifting."""

from functools import lru_cache
from itertools import combinations
from math import comb

import numpy as np

from ..arrays import Array, Flags, Indices
from ..errors import NotListable

PARALLEL = 1e-9
"""Unit normals this close together are one."""

ALONG = 1e-13
"""Cosines below this between a plane's normal and a generator are rounding: the plane is parallel to it."""

MOST_COMBINATIONS = 100_000
"""Of generators, before a listing is called too long."""


def hyperplane_shifting(generators: Array, least: float = -1.0) -> tuple[Array, Array]:
    """Rows (N, d) with {G z : least ≤ z ≤ 1} = {x : N x ≤ d}, one row a facet; G must have full row rank.

    Every facet is parallel to n − 1 independent generators; its plane is shifted outwards along
    its normal n by Σ max(n·g_i, least n·g_i), which is Σ |n·g_i| where |z| ≤ 1. Generators count
    by their directions, however long or short they are.

    generators : G, (n, k); least : of every z, −1 or 0
    Raises NotListable where the choices of n − 1 generators are more than
    ``MOST_COMBINATIONS``.
    Source: Gouttefarde and Krut 2010; Bouchard et al. 2010.

    >>> normals, offsets = hyperplane_shifting(np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]))
    >>> len(normals), float(offsets.max().round(6))
    (6, 2.0)
    """
    n, k = generators.shape
    count = comb(k, n - 1)
    if count > MOST_COMBINATIONS:
        raise NotListable(f"{k} cables in {n} dimensions make {count} candidate planes, more than "
                          f"{MOST_COMBINATIONS}; ask contains and support instead, of a workspace by='tensions'")
    lengths = np.linalg.norm(generators, axis=0)
    unit = (generators / np.where(lengths > 0, lengths, 1.0)).T
    # QR by columns is what LAPACK batches best.
    normals, independent = across(np.swapaxes(unit[choices(k, n - 1)], -1, -2))
    normals = normals[independent]
    # Each line once, its first entry that is not small positive; then its opposite.
    first = (np.abs(normals) > 1e-7).argmax(axis=1)[:, None]
    normals *= np.sign(np.take_along_axis(normals, first, axis=1))
    normals = normals[first_of_each(normals)]
    along = products(normals, generators)
    along = np.concatenate([along, -along])
    return np.concatenate([normals, -normals]), np.maximum(along, least * along).sum(axis=1)


def across(columns: Array) -> tuple[Array, Flags]:
    """(…, n) a unit vector across n − 1 columns each, (…, n, n − 1), and whether these are independent."""
    q, r = np.linalg.qr(columns, mode="complete")
    pivots = np.abs(np.diagonal(r, axis1=-2, axis2=-1))
    return q[..., -1], pivots.min(axis=-1, initial=np.inf) > PARALLEL


def products(directions: Array, generators: Array) -> Array:
    """(…, k) d·g, nought where it is rounding: a generator of any length says nothing across itself."""
    found = directions @ generators
    sizes = np.linalg.norm(directions, axis=-1)[..., None] * np.linalg.norm(generators, axis=0)
    return np.where(np.abs(found) > ALONG * sizes, found, 0.0)


@lru_cache(maxsize=16)
def choices(k: int, size: int) -> Indices:
    """(…, size) every choice among 0 to k − 1."""
    return np.array(list(combinations(range(k), size)), dtype=np.intp).reshape(comb(k, size), size)


def first_of_each(rows: Array, tolerance: float = 1e-8) -> Indices:
    """Indices of rows that equal no earlier one up to ``tolerance``.

    >>> first_of_each(np.array([[0.0, 1.0], [1.0, 0.0], [0.0, 1.0 + 1e-12]]))
    array([0, 1])
    """
    # Along a fixed slanted line equal rows land on equal numbers; only neighbors there need to
    # be compared. (A tree's list of pairs takes gigabytes where 20,000 rows are equal.)
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
