"""What a tension distribution method is: solved for a batch at once, or built for its limits and solved one by one."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Flags
from ..compiled import FIXED
from .law import shortfall, tension_scale, weigh

INFEASIBLE = "no tensions within the limits balance the wrench"
UNREACHABLE = "the cables cannot exert this wrench at any tension: it lies outside the range of W"
PROOFS = (INFEASIBLE, UNREACHABLE.split(":")[0])
"""How the reasons begin that say more than that a method found nothing."""

Texts = NDArray[np.object_]

Solution = tuple[Array, str]
"""Tensions (m,) and '' or the reason why they are no solution; NaN where the method has no answer at all."""

Solver = Callable[[Array, Array], Solution]
"""``(W, w_e) → tensions, reason`` for one (n, m) wrench matrix and (n,) external wrench."""

Answers = tuple[Array, Texts]
"""Tensions (k, m) and reasons (k,) of a batch."""

BatchSolver = Callable[..., Answers]
"""``(W, w_e, tension_min, tension_max, **options) → Answers``: (k, n, m), (k, n), limits (k, m) or (1, m) for all."""


class Method(NamedTuple):
    """One family of distributions.

    solve : a BatchSolver; its keyword-only arguments are the method's options
    build : ``(n, tension_min, tension_max, **options) → Solver``; checks its options, allocates
        once
    complete : whether it finds a distribution whenever one exists
    summary : one line for menus and tables
    """

    solve: BatchSolver
    build: Callable[..., Solver]
    complete: bool
    summary: str


def vectorized(solve: BatchSolver, *, complete: bool, summary: str) -> Method:
    """The method of a batch solver; one wrench is then a batch of one, and weighed: a control loop asks nobody else."""

    def build(n: int, tension_min: Array, tension_max: Array, **options: Any) -> Solver:
        low, high = tension_min[None], tension_max[None]

        def solve_one(W: Array, w_e: Array) -> Solution:
            tensions, reasons = solve(W[None], w_e[None], low, high, **options)
            if reasons[0]:
                return tensions[0], reasons[0]
            found = weigh(W, w_e, tension_min, tension_max, tensions[0])
            return found.tensions, "" if found.feasible else shortfall(*found[:3], tension_min, tension_max)

        return solve_one

    return Method(solve, build, complete, summary)


def one_by_one(left: Flags, build: Callable[[Array, Array], Solver], W: Array, w_e: Array, low: Array, high: Array,
               tensions: Array, reasons: Texts) -> None:
    """Answers what is left of a batch, wrench by wrench, by ``(tension_min, tension_max) → Solver``."""
    solver = cache(lambda row: build(low[row], high[row]))
    for k in np.flatnonzero(left):
        tensions[k], reasons[k] = solver(k % len(low))(W[k], w_e[k])   # limits of its own, or those of all


def sharpened(W: Array, w_e: Array, low: Array, high: Array, tau: Array) -> Array:
    """A solver's corner or border point to rounding: cables at a limit are put on it, the others balance the wrench."""
    close = 1e-6 * tension_scale(w_e, low).max()
    at_low, at_high = tau - low < close, high - tau < close
    held = at_low | at_high
    sharp = np.where(at_low, low, np.where(at_high, high, tau))
    sharp[~held] = np.linalg.lstsq(W[:, ~held], -w_e - W[:, held] @ sharp[held])[0]
    return sharp if weigh(W, w_e, low, high, sharp).feasible else tau


def fixed_cables(low: Array, high: Array) -> Flags:
    """Which cables have no choice."""
    return high - low <= FIXED * (1 + low)


def around_fixed(build: Callable[[Array, Array], Solver], low: Array, high: Array) -> Solver:
    """The solver over the cables that have a choice: bounds that coincide upset active-set programs.

    build : ``(tension_min, tension_max) → Solver`` for any number of cables
    """
    fixed = fixed_cables(low, high)
    if not fixed.any():
        return build(low, high)
    free, held = ~fixed, (low + high) / 2
    inner = build(low[free], high[free])

    def solve(W: Array, w_e: Array) -> Solution:
        tau, reason = held.copy(), ""
        if free.any():
            tau[free], reason = inner(W[:, free], w_e + W[:, fixed] @ held[fixed])
        return tau, reason

    return solve
