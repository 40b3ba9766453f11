"""All tensions that hold a platform, and what the limits leave of them: an interval (r = 1) or a polygon (r = 2)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array
from ...sets import Polytope
from ...sets.subspace import null_space
from ...tensions import distribute_tensions

MET = 1e-6
"""A limit counts as met within this share of the largest limit."""


class TensionSet(NamedTuple):
    """The tensions τ = τ_p + N λ that balance a wrench, and those inside the limits, in coordinates one can draw.

    least : (m,) τ_p = −W⁺ w_e, at λ = 0 [N]
    directions : (m, r) N, orthonormal, so that distances between λ are those between tensions;
        along the first Σ τ grows fastest, along the second it does not change
    low, high : (m,) limits [N]
    corners : (v, r) λ of the feasible polygon, counter-clockwise, or of the interval's ends;
        empty if infeasible [N]
    """

    least: Array
    directions: Array
    low: Array
    high: Array
    corners: Array

    @property
    def redundancy(self) -> int:
        """r = m − rank W."""
        return int(self.directions.shape[1])

    def coordinates(self, tensions: ArrayLike) -> Array:
        """(…, r) λ of tensions (…, m) [N]."""
        return (np.asarray(tensions, float) - self.least) @ self.directions

    def tensions(self, coordinates: ArrayLike) -> Array:
        """(…, m) tensions at λ (…, r) [N]."""
        return self.least + np.asarray(coordinates, float) @ self.directions.T

    def walk(self, share: float) -> Array:
        """(r,) λ after a share (0 to 1) of the way around the polygon, or along the interval; NaN if infeasible."""
        if len(self.corners) == 0:
            return np.full(self.redundancy, np.nan)
        way = np.concatenate([self.corners, self.corners[:1]]) if self.redundancy == 2 else self.corners
        lengths = np.insert(np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1)), 0, 0.0)
        return np.array([np.interp(share * lengths[-1], lengths, column) for column in way.T])

    def met_limits(self, tensions: ArrayLike) -> list[str]:
        """The limits that tensions lie on, such as "3 min"."""
        tau, close = np.asarray(tensions, float), MET * self.high.max()
        return [f"{i + 1} {name}" for i in range(tau.size)
                for name, limit in (("min", self.low), ("max", self.high))
                if abs(tau[i] - limit[i]) <= close]


def tension_set(W: ArrayLike, w_e: ArrayLike, tension_min: ArrayLike, tension_max: ArrayLike) -> TensionSet:
    """What can be chosen, and what the limits leave of it.

    W, w_e, tension_min, tension_max : as in `distribute_tensions`, for one pose
    Returns TensionSet; with no corners where r is neither 1 nor 2.

    >>> bead = tension_set([[1.0, -1.0]], [30.0], 10, 100)
    >>> bead.tensions(bead.corners).round(6)
    array([[ 10.,  40.],
           [ 70., 100.]])
    """
    balanced = distribute_tensions(W, w_e, tension_min, tension_max, "pseudo_inverse")
    least = balanced.tensions
    low, high, _ = np.broadcast_arrays(tension_min, tension_max, least)
    N = _directions(null_space(np.asarray(W, float)))
    r = N.shape[1]
    corners = np.zeros((0, r))
    reached = np.abs(balanced.residual).max() <= MET * (1 + np.abs(w_e).max())
    if r in (1, 2) and reached:
        rows, sides = np.concatenate([N, -N]), np.concatenate([high - least, least - low])
        corners = Polytope.from_rows(rows, sides).vertices.reshape(-1, r)
    return TensionSet(least, N, low, high, np.sort(corners, axis=0) if r == 1 else corners)


def _directions(basis: Array) -> Array:
    """The same space with axes that follow the pose smoothly: the way Σ τ grows, and across it."""
    total = basis.sum(axis=0)
    if basis.shape[1] not in (1, 2) or np.linalg.norm(total) < 1e-9:
        return basis
    first = total / np.linalg.norm(total)
    if basis.shape[1] == 1:
        return basis * first
    N = basis @ np.array([[first[0], -first[1]], [first[1], first[0]]])
    # Whichever way across: the one that a fixed, arbitrary set of tensions leans to.
    return N * [1.0, np.copysign(1.0, N[:, 1] @ np.cos(np.arange(len(N))))]


def set_in_words(free: TensionSet) -> str:
    """What the picture shows, in a sentence.

    >>> set_in_words(tension_set([[1.0, -1.0]], [30.0], 10, 20))
    'r = 1: no tensions within the limits.'
    """
    r = free.redundancy
    if r not in (1, 2):
        return f"r = {r}: {'too many dimensions for a picture' if r else 'nothing to choose'}."
    if len(free.corners) == 0:
        return f"r = {r}: no tensions within the limits."
    if r == 1:
        return f"r = 1: an interval of {np.ptp(free.corners):.1f} N."
    return f"r = 2: a polygon of {len(free.corners)} corners."
