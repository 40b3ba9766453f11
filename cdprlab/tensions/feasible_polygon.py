"""The polygon of feasible tensions of up to two redundant cables: the doors to the compiled kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, plain
from .method import INFEASIBLE, OUT_OF_RANGE, Texts, fixed_cables, no_reasons

CENTROID, LOWEST, HIGHEST = 0, 1, 2
"""What `polygon_points` picks: the area's centroid, or the corner of least or largest sum of tensions."""


def polygon_points(W: Array, w_e: Array, low: Array, high: Array, pick: int) -> tuple[Array, Texts, NDArray[np.int64]]:
    """One point of each polygon (segment, point) {τ : W τ + w_e = 0, low ≤ τ ≤ high}.

    W (k, n, m); w_e (k, n); low, high (k or 1, m)
    Returns tensions (k, m), NaN where there is no answer; reasons (k,); redundancy r = m − rank W (k,).
    Where r > 2 there is neither an answer nor a reason.
    """
    from ..compiled import polygon as kernels

    tensions, found, spare = kernels.polygons(plain(W), plain(w_e), plain(low), plain(high), pick)
    reasons = no_reasons(tensions.shape[0])
    if found.any():
        reasons[found == kernels.EMPTY] = INFEASIBLE
        reasons[found == kernels.OUT_OF_RANGE] = OUT_OF_RANGE
    return tensions, reasons, spare


def too_redundant(spare: NDArray[np.int64], reasons: Texts) -> NDArray[np.bool_]:
    """Which of a batch have more than a polygon, and so no answer yet."""
    most = spare > 2
    return most & (reasons == "") if most.any() else most


def closest_tensions(W: Array, w_e: Array, low: Array, high: Array, share: float, rounds: int = 0, *,
                     spent: str = "") -> tuple[Array, Texts]:
    """τ_0 − W⁺ (w_e + W τ_0), τ_0 = τ_min + share (τ_max − τ_min); cables with equal limits stay at them.

    rounds : how often the cable that leaves its limits by most is fixed there and the others are solved anew
    spent : the reason where rounds, or the redundancy to do so, run out
    W (k, n, m); w_e (k, n); low, high (k or 1, m)
    Returns tensions (k, m) and reasons (k,); outside the range of W the least-squares answer.
    """
    from ..compiled import polygon as kernels

    tensions, found = kernels.closest(plain(W), plain(w_e), plain(low), plain(high), share, rounds)
    reasons = no_reasons(tensions.shape[0])
    if found.any():
        reasons[found == kernels.SPENT] = spent
        off = found == kernels.OUT_OF_RANGE
        reasons[off] = OUT_OF_RANGE
        wish, fixed = (np.broadcast_to(part, tensions.shape)[off]
                       for part in (low + share * (high - low), fixed_cables(low, high)))
        missed = w_e[off] + (W[off] @ wish[..., None])[..., 0]
        free = np.where(fixed[:, None, :], 0.0, W[off])
        tensions[off] = wish - (np.linalg.pinv(free) @ missed[..., None])[..., 0]
    return tensions, reasons
