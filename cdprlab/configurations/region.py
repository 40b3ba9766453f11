"""Where three cables hold a point mass: inside their triangle seen from above, and below its plane.

All four conditions read n · (M − A) > 0, where n is made of exit points: exactly multilinear in
every coordinate, so that the range over boxes is found at their corners.
"""

from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Annotated

import numpy as np

from ..arrays import Array, checked
from .configuration import counterclockwise

Triangle = Annotated[Array, "(3, 3) [m]"]
"""Three exit points."""


@dataclass(frozen=True, eq=False)
class Region:
    """The positions where a triplet holds a load, its exit points and the position known up to ± errors.

    normals : for each condition (K, 3), one row for each corner of the exit points' boxes
    offsets : for each condition (K,), so that the value is ``normals @ M − offsets``
    spreads : for each condition (K,), what the position's own error adds or takes
    """

    normals: tuple[Array, ...]
    offsets: tuple[Array, ...]
    spreads: tuple[Array, ...]

    def certainty(self, positions: Array) -> tuple[Array, Array]:
        """Smallest lower and smallest upper end of the conditions' ranges at positions (…, 3): two arrays (…).

        The first positive: certainly inside. The second negative: certainly outside.
        """
        low, high = [], []
        for n, c, r in zip(self.normals, self.offsets, self.spreads):
            values = positions @ n.T - c
            low.append((values - r).min(axis=-1))
            high.append((values + r).max(axis=-1))
        return np.min(low, axis=0), np.min(high, axis=0)

    def window(self, start: Array, end: Array, slack: float = 0.0) -> tuple[float, float] | None:
        """The share [λ₀, λ₁] of the way start + λ (end − start), 0 ≤ λ ≤ 1, that is certainly inside; None if none is.

        Each condition at each corner is linear in λ, so the window is one interval and its ends
        are exact.
        slack : added to every condition, so that a way along an edge counts as inside both
            neighbors [m², m³]
        """
        n, c, r = map(np.concatenate, (self.normals, self.offsets, self.spreads))
        begin, slope = n @ start - c - r + slack, n @ (end - start)
        with np.errstate(divide="ignore", invalid="ignore"):
            zeros = -begin / slope
        if (begin[slope == 0] <= 0).any():
            return None
        first = float(max(0.0, zeros[slope > 0].max(initial=0.0)))
        last = float(min(1.0, zeros[slope < 0].min(initial=1.0)))
        return (first, last) if first <= last else None

    def polygon(self, triangle: Array, height: float) -> Array:
        """(K, 2) corners, in plan, of what is certainly inside at a height; (0, 2) if nothing is.

        triangle : (3, 2) of the exit points in plan, which holds it [m]
        height : z of the positions [m]
        """
        n, c, r = map(np.concatenate, (self.normals, self.offsets, self.spreads))
        corners, n, c = triangle, n[:, :2], c + r - n[:, 2] * height
        while len(corners) and (short := (corners @ n.T - c).min(axis=0)).min() < -_ON_EDGE:
            corners = _cut(corners, n[short.argmin()], c[short.argmin()])
        return corners


_ON_EDGE = 1e-9
"""[m² and m³] a corner this near a condition's edge fulfills it."""


def _cut(corners: Array, n: Array, c: float) -> Array:
    """What n · x ≥ c leaves of a convex polygon."""
    value = corners @ n - c
    after, value_after = np.roll(corners, -1, axis=0), np.roll(value, -1)
    kept: list[Array] = []
    for a, b, f, g in zip(corners, after, value, value_after):
        if f >= 0:
            kept.append(a)
        if f * g < 0:
            kept.append(a + f / (f - g) * (b - a))
    return np.array(kept).reshape(-1, 2)


@checked
def region(exits: Triangle, exit_uncertainty: float = 0.0, position_uncertainty: float = 0.0) -> Region:
    """The region of one triplet.

    exits : (3, 3) exit points [m]
    exit_uncertainty, position_uncertainty : half widths of the boxes around them and around the
        position [m]
    Source: Ramadour and Merlet 2014, section IV.A; the range of each side is exact over the
    boxes' corners.

    >>> corners = np.array([[0, 0, 3], [4, 0, 3], [0, 3, 3.0]])
    >>> region(corners).window(np.array([1, 1, 0.0]), np.array([1, 3, 0.0]))
    (0.0, 0.625)
    """
    a = counterclockwise(exits)
    normals, offsets = [], []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        # Only the plan view of two exit points enters a side.
        shift = _corners(4).reshape(-1, 2, 2) * exit_uncertainty
        start, edge = a[i, :2] + shift[:, 0], a[j, :2] + shift[:, 1] - a[i, :2] - shift[:, 0]
        normals.append(np.stack([-edge[:, 1], edge[:, 0], np.zeros(len(edge))], axis=1))
        offsets.append(np.einsum("ki,ki->k", normals[-1][:, :2], start))
    corners = a + _corners(9).reshape(-1, 3, 3) * exit_uncertainty
    down = -np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals.append(down)
    offsets.append(np.einsum("ki,ki->k", down, corners[:, 0]))
    spreads = tuple(position_uncertainty * np.abs(n).sum(axis=1) for n in normals)
    return Region(tuple(normals), tuple(offsets), spreads)


@cache
def _corners(n: int) -> Array:
    """(2ⁿ, n) of ±1."""
    return np.array(list(product((-1.0, 1.0), repeat=n)))
