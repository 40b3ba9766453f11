"""What a tension distribution method is: built once for its limits, then solved for one W and w_e at a time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from ..arrays import Array

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
