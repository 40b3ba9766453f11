"""Where three cables hold a point mass: inside their triangle seen from above, and below its plane.

All four conditions read n · (M − A) > 0, where n is made of exit points: exactly multilinear in
every coordinate, so that the range over boxes is found at their corners.
"""

from __future__ import annotations

from itertools import product
from typing import Annotated

import numpy as np

from ..arrays import Array, checked, frozen_dataclass
from .configuration import HalfWidth, counterclockwise

Triangle = Annotated[Array, "(3, 3) [m]"]
"""Three exit points."""


@frozen_dataclass
class Region:
    """The positions where a triplet holds a load, its exit points and the position known up to ± errors.

    normals : (K, 4, 3), of each condition, the sides' first, at each corner of the exit points' boxes
    offsets : (K, 4), so that the value is ``normals @ M − offsets``
    spreads : (K, 4), what the position's own error adds or takes
    """

    normals: Array
    offsets: Array
    spreads: Array

    def ranges(self, positions: Array) -> tuple[Array, Array]:
        """Lower and upper end of each condition's range at positions (…, 3): the sides', then the plane's (…, 4)."""
        values = np.tensordot(positions, self.normals, (-1, -1)) - self.offsets
        return (values - self.spreads).min(axis=-2), (values + self.spreads).max(axis=-2)

    def certainty(self, positions: Array) -> tuple[Array, Array]:
        """Smallest lower and smallest upper end of the conditions' ranges at positions (…, 3): two arrays (…).

        The first positive: certainly inside. The second negative: certainly outside.
        """
        low, high = self.ranges(positions)
        return low.min(axis=-1), high.min(axis=-1)

    def window(self, start: Array, end: Array, slack: float = 0.0) -> tuple[float, float] | None:
        """The share [λ₀, λ₁] of the way start + λ (end − start), 0 ≤ λ ≤ 1, that is certainly inside; None if none is.

        Each condition at each corner is linear in λ, so the window is one interval and its ends
        are exact.
        slack : added to every condition, so that a way along an edge counts as inside both
            neighbors [m², m³]
        """
        begin = self.normals @ start - self.offsets - self.spreads + slack
        slope = self.normals @ (end - start)
        with np.errstate(divide="ignore", invalid="ignore"):
            zeros = -begin / slope
        if (begin[slope == 0] <= 0).any():
            return None
        first = float(zeros[slope > 0].max(initial=0.0))
        last = float(zeros[slope < 0].min(initial=1.0))
        return (first, last) if first <= last else None

    def polygon(self, triangle: Array, height: float) -> Array:
        """(K, 2) corners, in plan, of what is certainly inside at a height; (0, 2) if nothing is.

        triangle : (3, 2) of the exit points in plan, which holds it [m]
        height : z of the positions [m]
        """
        corners, n = triangle, self.normals[..., :2].reshape(-1, 2)
        c = (self.offsets + self.spreads - self.normals[..., 2] * height).ravel()
        while len(corners) and (short := (corners @ n.T - c).min(axis=0)).min() < -_ON_EDGE:
            corners = _cut(corners, n[short.argmin()], c[short.argmin()])
        return corners


_ON_EDGE = 1e-9
"""[m² and m³] a corner this near a condition's edge fulfills it."""


def _cut(corners: Array, n: Array, c: float) -> Array:
    """What n · x ≥ c leaves of a convex polygon."""
    value = corners @ n - c
    ahead = np.roll(value, -1)
    with np.errstate(divide="ignore", invalid="ignore"):   # of edges that do not cross the line
        crossings = corners + (value / (value - ahead))[:, None] * (np.roll(corners, -1, axis=0) - corners)
    return np.stack([corners, crossings], axis=1)[np.column_stack([value >= 0, value * ahead < 0])]


@checked
def region(exits: Triangle, exit_uncertainty: HalfWidth = 0.0, position_uncertainty: HalfWidth = 0.0) -> Region:
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
    corners = counterclockwise(exits) + exit_uncertainty * _CORNERS
    edges = np.roll(corners, -1, axis=1) - corners
    normals = np.concatenate([np.cross([0, 0, 1], edges), np.cross(edges[:, :1], edges[:, 2:])], axis=1)
    return Region(normals, (normals * corners[:, [0, 1, 2, 0]]).sum(axis=-1),
                  position_uncertainty * np.abs(normals).sum(axis=-1))


_CORNERS = np.array([*product((-1.0, 1.0), repeat=9)]).reshape(-1, 3, 3)
"""Of three exit points' boxes of half width 1."""
