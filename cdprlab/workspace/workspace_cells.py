"""A workspace as cells: boxes inside, outside or between the two, and what they measure together."""

import numpy as np

from ..arrays import Array, Indices, frozen_dataclass


@frozen_dataclass
class WorkspaceCells:
    """Cells that fill what was asked for.

    lower, upper : (N, k) corners [m], of an angle [rad]; equal along an axis that is held
    verdict : (N,) 1 inside, −1 outside, 0 undecided or on the border
    """

    lower: Array
    upper: Array
    verdict: Array

    @property
    def inside(self) -> Array:
        """(n, 2, k) cells inside."""
        return self._cells(1)

    @property
    def outside(self) -> Array:
        """(n, 2, k) cells outside."""
        return self._cells(-1)

    @property
    def undecided(self) -> Array:
        """(n, 2, k) cells that are neither at the resolution asked for."""
        return self._cells(0)

    @property
    def bounds(self) -> tuple[float, float]:
        """The true length, area or volume lies between these [m, m², m³, times rad with an angle].

        Those of `refine` hold for a workspace without details smaller than the first grid's cells.
        """
        edges = self.upper - self.lower
        size = np.prod(edges, axis=1, where=edges > 0)   # over the axes that are not held
        inside, between = (float(size[self.verdict == verdict].sum()) for verdict in (1, 0))
        return inside, inside + between

    @property
    def measure(self) -> float:
        """Middle of the bounds [m, m², m³]."""
        return sum(self.bounds) / 2

    @property
    def error(self) -> float:
        """Half of what lies between the bounds."""
        return (self.bounds[1] - self.bounds[0]) / 2

    def _cells(self, verdict: int) -> Array:
        chosen = self.verdict == verdict
        return np.stack([self.lower[chosen], self.upper[chosen]], axis=1)


def halved(lower: Array, upper: Array, axis: int | Indices) -> tuple[Array, Array]:
    """Both halves of each cell, cut across an axis: the same of all, or (N,) one each."""
    rows = np.arange(len(lower))
    middle = (lower[rows, axis] + upper[rows, axis]) / 2
    end, start = upper.copy(), lower.copy()
    end[rows, axis] = start[rows, axis] = middle
    return np.concatenate([lower, start]), np.concatenate([end, upper])
