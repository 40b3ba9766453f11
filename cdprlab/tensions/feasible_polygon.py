"""The polygon of feasible tensions of up to two redundant cables: the doors to the compiled loops."""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, plain
from ..compiled import OUT_OF_RANGE
from .method import INFEASIBLE, UNREACHABLE, Answers, Texts, fixed_cables


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


def closest_tensions(W: Array, w_e: Array, low: Array, high: Array, share: float, rounds: int = 0, *,
                     spent: str = "") -> Answers:
    """τ_0 − W⁺ (w_e + W τ_0), τ_0 = τ_min + share (τ_max − τ_min); cables with equal limits stay at them.

    rounds : how often the cable that leaves its limits by most is fixed there and the others
        are solved anew
    spent : the reason where rounds, or the redundancy to do so, run out
    W (k, n, m); w_e (k, n); low, high (k or 1, m)
    Returns tensions (k, m) and reasons (k,); outside the range of W the least-squares answer.
    """
    from ..compiled.closest import closest

    tensions, found = closest(*map(plain, (W, w_e, low, high)), share, rounds)
    for k in np.flatnonzero(found == OUT_OF_RANGE):
        least, most = low[k % len(low)], high[k % len(high)]
        wish = least + share * (most - least)
        free = np.where(fixed_cables(least, most), 0.0, W[k])
        tensions[k] = wish - np.linalg.pinv(free) @ (w_e[k] + W[k] @ wish)
    return tensions, _texts(found, spent)


def _texts(found: NDArray[np.int64], spent: str = "") -> Texts:
    """(k,) what `FOUND` and the codes after it say, r > 2 nothing."""
    return np.array(["", INFEASIBLE, UNREACHABLE, "", spent], dtype=object)[found]
