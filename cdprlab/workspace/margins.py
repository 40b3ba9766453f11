"""How far inside their limits cables can balance wrenches: the least of the bounds that the facets make."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..arrays import Array
from ..mechanics.optimization import largest_last

NOUGHT = 1e-10      # of all that is summed up: less is zero
PARALLEL = 1e-9     # cofactors below this share of the products they are made of are zero
DEPENDENT = 1e-11   # singular values below this share of the largest are zero
OFF_RANGE = 1e-8    # of the wrench: what no tensions balance
TOGETHER = 1024     # poses; their rows of numbers stay in the processor's cache


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
    s = np.full(len(W), np.nan)
    sound = np.flatnonzero(np.isfinite(W).all(axis=(1, 2)) & np.isfinite(w_e).all(axis=1))
    for first in range(0, len(sound), TOGETHER):
        at = sound[first:first + TOGETHER]
        u, sizes, vt = np.linalg.svd(W[at])
        ranks = (sizes > DEPENDENT * sizes[:, :1]).sum(axis=1)
        for rank in np.unique(ranks):
            here = ranks == rank
            s[at[here]] = _of_one_rank(rank, u[here], sizes[here], vt[here], w_e[at[here]], low, high, at_high)
    for k in sound[np.isnan(s[sound])]:   # too redundant
        s[k] = margin_by_program(W[k], w_e[k], low, high, at_high)[0]
    return s


def _of_one_rank(rank: int, u: Array, sizes: Array, vt: Array, w_e: Array, low: Array, high: Array,
                 at_high: bool) -> Array:
    """Margins of poses of one rank; NaN where more than two cables are redundant."""
    m = vt.shape[1]
    along = np.einsum("kij,ki->kj", u, -w_e)
    off = np.abs(along[:, rank:]).max(axis=1, initial=0) > OFF_RANGE * (1 + np.abs(w_e).max(axis=1))
    if m - rank > 2:
        return np.where(off, -np.inf, np.nan)
    # Cable by cable, with all poses in a row.
    c = np.einsum("kr,krm->mk", along[:, :rank] / sizes[:, :rank], vt[:, :rank])
    D = np.moveaxis(vt[:, rank:], 0, -1)
    half = (high - low) / 2
    s = np.full(len(u), half.min() if at_high else 2 * half.min())   # what each cable's own limits leave
    for cables in combinations(range(m), m - rank + 1):
        y = cofactors(D[:, cables])
        size = np.abs(y).sum(axis=0)
        chosen = list(cables)
        over, under = high[chosen, None] - c[chosen], c[chosen] - low[chosen, None]
        pull, ease = np.maximum(y, 0.0), np.maximum(-y, 0.0)
        above, below = (pull * over + ease * under).sum(axis=0), (pull * under + ease * over).sum(axis=0)
        missed = -NOUGHT * (size + np.abs(y * c[chosen]).sum(axis=0) + low[chosen] @ np.abs(y))
        up = size if at_high else (size - y.sum(axis=0)) / 2
        down = size if at_high else size - up
        s = np.minimum(s, bound(above, below, up, down, missed))
    return np.where(off, -np.inf, s)


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


def bound(above: Array, below: Array, up: Array, down: Array, missed: Array) -> Array:
    """The largest s with s up ≤ above and s down ≤ below; a sum without s is kept, to rounding, or not."""
    nought = NOUGHT * (up + down)
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.minimum(np.where(up > nought, above / up, np.inf),
                          np.where(down > nought, below / down, np.inf))
    broken = (up <= nought) & (above < missed) | (down <= nought) & (below < missed)
    return np.where(broken, -np.inf, most)


def margin_by_program(W: Array, w_e: Array, low: Array, high: Array, at_high: bool) -> tuple[float, Array]:
    """The margin of one pose by a linear program, and tensions (m,) that have it."""
    m = low.size
    rows = np.block([[-np.eye(m), np.ones((m, 1))],
                     [np.eye(m), np.full((m, 1), float(at_high))]])
    return largest_last(rows, np.append(-low, high),
                        np.column_stack([W, np.zeros(len(W))]), -w_e)
