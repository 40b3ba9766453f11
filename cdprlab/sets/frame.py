"""Where a `Polytope` lies and how large it is: the coordinates in which its facets and vertices are listed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array, frozen
from ..errors import NotListable

if TYPE_CHECKING:
    from .polytope import Polytope

_FLAT = 1e-9
"""A set is flat across a direction in which it is narrower than this share of its size."""

_SOLID = 1e-3
"""Points spread in all directions by more than this leave no doubt that the set is not flat."""


class Frame(NamedTuple):
    """Where a set lies: center + scales·(U z) with z in ``dimension`` coordinates, all of size 1.

    center : (n,) inside; scales : (n,) half the range of each component; basis : U, (n, dimension) orthonormal
    missing : (n, n − dimension) orthonormal directions, of x, across which the set is flat
    """

    center: Array
    scales: Array
    basis: Array
    missing: Array

    @property
    def dimension(self) -> int:
        """Of the set; −1 when it is empty."""
        return -1 if np.isnan(self.center).any() else self.basis.shape[1]

    @property
    def span(self) -> Array:
        """(n, dimension) orthonormal directions of x in which the set extends."""
        if self.dimension < 1:
            return np.zeros((len(self.center), 0))
        return np.asarray(np.linalg.qr(self.scales[:, None] * self.basis)[0])

    def outside(self, z: Array) -> Array:
        """(…, n) points of the set from their coordinates in the frame."""
        return self.center + self.scales * (z @ self.basis.T)

    def rows(self, normals: Array, offsets: Array) -> tuple[Array, Array]:
        """Unit rows over x from rows over z."""
        n = normals @ self.basis.T / self.scales
        d = offsets + n @ self.center
        size = np.linalg.norm(n, axis=1)
        return n / size[:, None], d / size


def frame(polytope: Polytope) -> Frame:
    """The affine hull of the set, found by asking how wide it is: n directions, each extends it or is missing.

    Raises NotListable where the set is unbounded.
    """
    if (known := _symmetric(polytope)) is not None:
        return known
    n, eye = polytope.n, np.eye(polytope.n)
    ends = polytope.support_point(np.concatenate([-eye, eye])).reshape(2, n, n)
    reach = polytope.component_range() if np.isnan(ends).any() else np.diagonal(ends, axis1=1, axis2=2).T
    if np.isinf(reach).any():
        raise NotListable("the set is unbounded (a cable without a speed limit, or too few cables), so it has no list "
                          "of vertices and facets; contains, support and the ranges still answer")
    if np.isnan(reach).any():
        return Frame(np.full(n, np.nan), np.ones(n), np.zeros((n, 0)), np.eye(n))
    half = (reach[:, 1] - reach[:, 0]) / 2
    scales = np.where(half > _FLAT * np.abs(reach).max(axis=1), half, 1.0)
    points = ends.reshape(-1, n)
    if np.linalg.svd((points - points.mean(axis=0)) / scales, compute_uv=False)[-1] > _SOLID:
        return Frame(frozen(points.mean(axis=0)), frozen(scales), frozen(eye), frozen(np.zeros((n, 0))))
    return _probed(polytope, scales, float(np.abs(reach / scales[:, None]).max()))


def _symmetric(polytope: Polytope) -> Frame | None:
    """Without a program: rows N x ≤ d and −N x ≤ d with d > 0 and N of full rank enclose a solid around the origin."""
    if polytope._outer_rows is None:
        return None
    normals, offsets = polytope._outer_rows
    normals, offsets = normals[np.isfinite(offsets)], offsets[np.isfinite(offsets)]
    half, n = len(offsets) // 2, polytope.n
    if not half or (offsets <= 0).any() or not (np.array_equal(normals[:half], -normals[half:])
                                                and np.array_equal(offsets[:half], offsets[half:])):
        return None
    near = np.abs(normals[:half] / offsets[:half, None]).max(axis=0)    # 1 / distance to the border along each axis
    spread = np.linalg.svd(normals[:half] / offsets[:half, None] / np.where(near > 0, near, 1.0), compute_uv=False)
    if len(spread) < n or spread[-1] < _SOLID:
        return None
    return Frame(frozen(np.zeros(n)), frozen(1 / near), frozen(np.eye(n)), frozen(np.zeros((n, 0))))


def _probed(polytope: Polytope, scales: Array, size: float) -> Frame:
    """Direction by direction: across each the set extends, or it is flat."""
    n = polytope.n
    basis, missing, seen = np.zeros((n, 0)), np.zeros((n, 0)), []
    for _ in range(n):
        way = _unused(np.concatenate([basis, missing], axis=1))
        ends = polytope.support_point(np.stack([way, -way]) / scales) / scales
        step = (ends[0] - ends[1]) - basis @ (basis.T @ (ends[0] - ends[1]))
        seen.append(ends * scales)
        if abs(way @ (ends[0] - ends[1])) > _FLAT * max(1.0, size):
            basis = np.concatenate([basis, (step / np.linalg.norm(step))[:, None]], axis=1)
        else:
            missing = np.concatenate([missing, way[:, None]], axis=1)
    across = np.linalg.qr(missing / scales[:, None])[0] if missing.shape[1] else missing
    return Frame(frozen(np.concatenate(seen).mean(axis=0)), frozen(scales), frozen(basis), frozen(across))


def _unused(directions: Array) -> Array:
    """A unit vector orthogonal to all columns, as close to an axis as there is."""
    left = np.eye(len(directions)) - directions @ directions.T
    way = left[np.linalg.norm(left, axis=1).argmax()]
    return np.asarray(way / np.linalg.norm(way))
