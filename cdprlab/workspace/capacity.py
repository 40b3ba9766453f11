"""Wrench feasibility by the facets of the available wrench set: a whole box of wrenches at the price of one."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, plain
from ..sets.zonotope import hyperplane_shifting


def capacity_margins(W: Array, w_e: Array, loads: Array, half: Array, low: Array, high: Array, *,
                     exact: bool = True) -> tuple[Array, Array]:
    """Distance of all wrenches −(w_e + load ± half) from the border of {W τ : τ_min ≤ τ ≤ τ_max}, negative outside.

    The nearest facet decides. Where the rows are forces and moments it is in N, a moment of 1 N m counting as 1 N.

    W : (N, n, m); w_e : (N, n) [N, N m]; loads : (v, n); half : (n,) [N, N m]; low, high : (m,) [N]
    exact : without it a negative answer only means outside
    Returns (N,); (N, n) outward unit normal of the facet that decides. Where W loses rank the set is flat: −inf for a
    box that is not, else 0 or what a corner lacks by `tension_margins`.
    Source: Bouchard et al. 2010; Gouttefarde and Krut 2010; Guay et al. 2014 (capacity margin).

    >>> W = np.array([[[1.0, 0.0], [0.0, 1.0]]])
    >>> load, half = np.array([[-2.0, -3.0]]), np.array([0.5, 0.0])
    >>> capacity_margins(W, np.zeros((1, 2)), load, half, np.zeros(2), 4 * np.ones(2))[0]
    array([1.])
    """
    from ..compiled import facets as kernel

    n = W.shape[1]
    carried = np.concatenate([W, np.broadcast_to(np.eye(n), (len(W), n, n))], axis=2)
    s, normals, found = kernel.capacity(plain(carried), plain(w_e), plain(loads), plain(half), plain(low), plain(high),
                                        exact)
    s[found == kernel.UNREACHABLE] = -np.inf
    for k in np.flatnonzero(found == kernel.TOO_REDUNDANT):
        s[k], normals[k] = _one_by_one(W[k], w_e[k], loads, half, low, high)
    normals[found == kernel.UNREACHABLE] = np.nan
    return s, normals


def _one_by_one(W: Array, w_e: Array, loads: Array, half: Array, low: Array, high: Array) -> tuple[float, Array]:
    """By the planes of one pose; where W loses rank, by the corners."""
    n = W.shape[0]
    if np.linalg.matrix_rank(W) < n:
        return _flat(W, w_e, loads, half, low, high), np.full(n, np.nan)
    normals, offsets = hyperplane_shifting(W @ (high + low) / 2, W * (high - low) / 2)
    left = (offsets - (normals @ -(w_e + loads).T).max(axis=1)) - np.abs(normals) @ half
    worst = int(np.argmin(left))
    return float(left[worst]), normals[worst]


def _flat(W: Array, w_e: Array, loads: Array, half: Array, low: Array, high: Array) -> float:
    from .tensions import box_loads, tension_margins

    corners = box_loads(loads, half)
    repeated = np.broadcast_to(W, (len(corners), *W.shape))
    return float(min(0.0, tension_margins(repeated, w_e + corners, low, high).min()))
