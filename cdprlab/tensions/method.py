"""What a tension distribution method is: built once for its limits, then solved for one W and w_e at a time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from ..arrays import Array

# Equilibrium to 1e-8 of the wrench, limits to 1e-8 of the largest: a thousand times what rounding
# leaves in a well-posed program, a thousandth of what a load cell sees.
RESIDUAL_TOLERANCE = 1e-8
LIMIT_TOLERANCE = 1e-8

Solution = tuple[Array, str]
"""Tensions (m,) and '' or the reason why they are no solution; NaN where the method has no answer at all."""

Solver = Callable[[Array, Array], Solution]
"""``(W, w_e) → tensions, reason`` for one (n, m) wrench matrix and (n,) external wrench."""


class Method(NamedTuple):
    """One family of distributions.

    build : ``(n, tension_min, tension_max, **options) → Solver``; checks its options, allocates once
    complete : whether it finds a distribution whenever one exists
    summary : one line for menus and tables
    """

    build: Callable[..., Solver]
    complete: bool
    summary: str

    def options(self) -> tuple[str, ...]:
        """Names of the options ``build`` takes."""
        import inspect

        parameters: Any = inspect.signature(self.build).parameters.values()
        return tuple(p.name for p in parameters if p.kind is p.KEYWORD_ONLY)


def around_fixed(build: Callable[[Array, Array], Solver], low: Array, high: Array) -> Solver:
    """The solver over the cables that have a choice: bounds that coincide upset active-set programs.

    build : ``(tension_min, tension_max) → Solver`` for any number of cables
    """
    # Limits closer than this are one number: a tenth of what the result's check forgives.
    free = high - low > 1e-9 * high.max()
    if free.all():
        return build(low, high)
    inner = build(low[free], high[free]) if free.any() else None
    held = (low + high) / 2

    def solve(W: Array, w_e: Array) -> Solution:
        tau, reason = held.copy(), ""
        if inner is not None:
            tau[free], reason = inner(W[:, free], w_e + W[:, ~free] @ held[~free])
        return tau, reason

    return solve
