"""The polygon of feasible tensions of up to two redundant cables: the doors to the compiled loops."""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, plain
from ..compiled import EMPTY, FOUND, OUT_OF_RANGE, SPENT
from .method import INFEASIBLE, UNREACHABLE, Texts, fixed_cables, no_reasons


def polygon_points(W: Array, w_e: Array, low: Array, high: Array, pick: int) -> tuple[Array, Texts, NDArray[np.int64]]:
    """One point of each polygon (segment, point) {τ : W τ + w_e = 0, low ≤ τ ≤ high}.

    W (k, n, m); w_e (k, n); low, high (k or 1, m)
    pick : CENTROID, LOWEST, HIGHEST or NEAREST of `compiled`
    Returns tensions (k, m), NaN where there is no answer; reasons (k,); redundancy r = m − rank
    W (k,). Where r > 2 there is neither an answer nor a reason.
    """
    from ..compiled.polygon import polygons

    tensions, found, spare = polygons(*map(plain, (W, w_e, low, high)), pick)
    return tensions, _texts(found), spare


def unanswered(spare: NDArray[np.int64], reasons: Texts) -> NDArray[np.int64]:
    """Which of a batch have more than a polygon, and so no answer yet."""
    return np.flatnonzero((spare > 2) & (reasons == "")) if (spare > 2).any() else spare[:0]


def closest_tensions(W: Array, w_e: Array, low: Array, high: Array, share: float,
                     rounds: int = 0, *,
                     spent: str = "") -> tuple[Array, Texts]:
    """τ_0 − W⁺ (w_e + W τ_0), τ_0 = τ_min + share (τ_max − τ_min); cables with equal limits stay at them.

    rounds : how often the cable that leaves its limits by most is fixed there and the others
        are solved anew
    spent : the reason where rounds, or the redundancy to do so, run out
    W (k, n, m); w_e (k, n); low, high (k or 1, m)
    Returns tensions (k, m) and reasons (k,); outside the range of W the least-squares answer.
    """
    from ..compiled.closest import closest

    tensions, found = closest(*map(plain, (W, w_e, low, high)), share, rounds)
    off = found == OUT_OF_RANGE
    if off.any():
        wish, fixed = (np.broadcast_to(part, tensions.shape)[off]
                       for part in (low + share * (high - low), fixed_cables(low, high)))
        missed = w_e[off] + (W[off] @ wish[..., None])[..., 0]
        free = np.where(fixed[:, None, :], 0.0, W[off])
        tensions[off] = wish - (np.linalg.pinv(free) @ missed[..., None])[..., 0]
    return tensions, _texts(found, spent)


def _texts(found: NDArray[np.int64], spent: str = "") -> Texts:
    reasons = no_reasons(found.size)
    if (found != FOUND).any():
        for code, text in ((EMPTY, INFEASIBLE), (OUT_OF_RANGE, UNREACHABLE), (SPENT, spent)):
            reasons[found == code] = text
    return reasons
