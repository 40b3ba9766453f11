"""One redundant cable: the tensions are one line, and the limits cut an interval out of it."""

import numpy as np

from ..arrays import Array
from ..compiled import CENTROID, HIGHEST, LOWEST
from ..errors import InvalidInput, quoted
from .feasible_polygon import polygon_points
from .method import Answers, vectorized

CHOICES = {"lowest": LOWEST, "middle": CENTROID, "highest": HIGHEST}


def solve(W: Array, w_e: Array, low: Array, high: Array, *, choice: str = "middle") -> Answers:
    """τ = −W⁺ w_e + λ h with h = ker W, Σ h ≥ 0, and λ_lo = max (τ_min − τ_p)/h ≤ λ ≤ λ_hi = min (τ_max − τ_p)/h.

    Where an h_i is negative its two limits change places.
    choice : "lowest" (λ_lo), "middle" or "highest" (λ_hi)
    Source: Okoli 2016, eq. (6.33); (6.34)–(6.35) ignore both limits.
    """
    if not isinstance(choice, str) or choice not in CHOICES:
        raise InvalidInput(f"choice must be one of {', '.join(CHOICES)}, got {quoted(choice)}")
    tensions, reasons, spare = polygon_points(W, w_e, low, high, CHOICES[choice])
    for k in np.flatnonzero(spare != 1):
        tensions[k] = np.nan
        reasons[k] = f"the kernel method needs exactly one redundant cable (r = 1); here r = {spare[k]}"
    return tensions, reasons


METHOD = vectorized(solve, complete=True, summary="one redundant cable (r = 1): lowest, middle or highest admissible λ")
