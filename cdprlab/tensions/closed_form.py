"""The balanced tensions nearest to the middle of the limits, in one formula."""

from ..arrays import Array
from .feasible_polygon import closest_tensions
from .method import Answers, vectorized


def solve(W: Array, w_e: Array, low: Array, high: Array) -> Answers:
    """τ = τ_m − W⁺ (w_e + W τ_m), τ_m = (τ_min + τ_max)/2; cables with equal limits stay at them.

    A limit of as much as you like moves that middle, and so the answer: it is what is aimed at.
    Found whenever ‖τ − τ_m‖₂ ≤ min (τ_max − τ_min)/2, never when it exceeds ‖τ_max − τ_min‖₂/2.
    Source: Pott, Bruckmann and Mikelsons 2009; Okoli 2016, eq. (6.27)–(6.29), whose bounds are
    misprinted.
    """
    return closest_tensions(W, w_e, low, high, 0.5)


METHOD = vectorized(solve, complete=False,
                    summary="nearest to the middle of the limits, one formula; may leave the limits")
