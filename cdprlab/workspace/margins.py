"""How far inside their limits cables can balance wrenches: the least of the bounds that the facets make."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Indices
from ..mechanics.optimization import largest_last

NOUGHT = 1e-10      # of all that is summed up: less is zero
PARALLEL = 1e-9     # cofactors below this share of the products they are made of are zero
DEPENDENT = 1e-11   # a row of W of which this share is left beside the others depends on them
TOGETHER = 1024     # poses; their rows of numbers stay in the processor's cache


class Balance(NamedTuple):
    """All tensions c + D λ that balance the wrenches of some poses, cable by cable, with all these poses in a row.

    at : (k,) which poses
    c : (m, k); D : (r, m, k); inverse : W⁺ transposed, (n, m, k)
    """

    at: Indices
    c: Array
    D: Array
    inverse: Array

    def facets(self) -> Iterator[tuple[list[int], Array]]:
        """Each y with Σ y_i D_i = 0 of least many cables: which ones, and (r + 1, k) y."""
        for cables in combinations(range(len(self.c)), len(self.D) + 1):
            yield list(cables), cofactors(self.D[:, cables])


def balances(W: Array, w_e: Array) -> Iterator[Balance]:
    """Some poses after the other, without those where W has no full row rank, or more than two cables are redundant.

    W : (N, n, m); w_e : (N, n) [N, N m]
    """
    n, m = W.shape[1:]
    for first in range(0, len(W) if 0 <= m - n <= 2 else 0, TOGETHER):
        q, r = np.linalg.qr(np.swapaxes(W[first:first + TOGETHER], 1, 2), mode="complete")
        pivots = np.abs(np.diagonal(r, axis1=1, axis2=2))
        regular = np.flatnonzero(pivots.min(axis=1) > DEPENDENT * pivots.max(axis=1))
        inverse = np.linalg.solve(r[regular, :n], np.swapaxes(q[regular, :, :n], 1, 2))
        c = -np.einsum("kim,ki->mk", inverse, w_e[first + regular])
        yield Balance(first + regular, c, np.ascontiguousarray(q[regular, :, n:].T),
                      np.ascontiguousarray(np.moveaxis(inverse, 0, -1)))


def tension_margins(W: Array, w_e: Array, low: Array, high: Array, *, at_high: bool = True) -> Array:
    """Largest s with W τ + w_e = 0 and τ_min + s ≤ τ ≤ τ_max − s, for each pose; −inf where nothing balances w_e.

    All balanced tensions are c + D λ. Each y with Σ y_i D_i = 0 of least many cables bounds s
    from above, by duality, and the least of these bounds is s itself.

    W : (N, n, m); w_e : (N, n) [N, N m]; low, high : (m,) [N]
    at_high : whether s is kept from the upper limits too
    Returns (N,) [N], negative where the limits must be broken by −s.

    >>> W = np.array([[[1.0, -1.0]]])
    >>> tension_margins(W, np.zeros((1, 1)), np.array([1.0, 1.0]), np.array([5.0, 9.0]))
    array([2.])
    """
    own = (high - low).min()   # what each cable's own limits leave
    s = np.full(len(W), np.nan)
    for balance in balances(W, w_e):
        least = np.full(len(balance.at), own / 2 if at_high else own)
        for chosen, y in balance.facets():
            c, size = balance.c[chosen], np.abs(y).sum(axis=0)
            over, under = high[chosen, None] - c, c - low[chosen, None]
            missed = -NOUGHT * (size + np.abs(y * c).sum(axis=0) + low[chosen] @ np.abs(y))
            for way in (y, -y):   # s rate ≤ left; where s has no part in it, it is kept, to rounding, or not
                pull, ease = np.maximum(way, 0.0), np.maximum(-way, 0.0)
                left = (pull * over + ease * under).sum(axis=0)
                rate = size if at_high else ease.sum(axis=0)
                with np.errstate(divide="ignore", invalid="ignore"):
                    most = np.where(rate > NOUGHT * size, left / rate, np.where(left < missed, -np.inf, np.inf))
                least = np.minimum(least, most)
        s[balance.at] = least
    for k in np.flatnonzero(np.isnan(s)):
        s[k] = margin_by_program(W[k], w_e[k], low, high, at_high)[0]
    return s


def cofactors(D: Array) -> Array:
    """y (r + 1, k) with Σ y_i D_i = 0 for r + 1 rows of the null space, D (r, r + 1, k); 0 where that is rounding."""
    if len(D) == 0:
        return np.ones((1, D.shape[-1]))
    if len(D) == 1:
        y = np.stack([D[0, 1], -D[0, 0]])
        size = np.ones(D.shape[-1])
    else:
        a, b = D
        ahead, behind = a[[1, 2, 0]] * b[[2, 0, 1]], a[[2, 0, 1]] * b[[1, 2, 0]]
        y = ahead - behind
        size = np.maximum(np.abs(ahead), np.abs(behind)).max(axis=0)
    return np.where(np.abs(y) > PARALLEL * size, y, 0.0)   # one by one: a generous limit would make much of rounding


def margin_by_program(W: Array, w_e: Array, low: Array, high: Array, at_high: bool) -> tuple[float, Array]:
    """The margin of one pose by a linear program, and tensions (m,) that have it."""
    m = low.size
    rows = np.block([[-np.eye(m), np.ones((m, 1))],
                     [np.eye(m), np.full((m, 1), float(at_high))]])
    return largest_last(rows, np.append(-low, high),
                        np.column_stack([W, np.zeros(len(W))]), -w_e)
