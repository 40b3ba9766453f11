"""Where a convex set lies and how large it is: the coordinates in which its facets and vertices are listed."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..arrays import Array, frozen

_FLAT = 1e-9
"""A set is flat across a direction in which it is narrower than this share of its size."""

_SOLID = 1e-3
"""Points spread in all directions by more than this leave no doubt that the set is not flat."""


class Frame(NamedTuple):
    """Where a set lies: center + scales·(U z) with z in ``dimension`` coordinates, all of size 1.

    center : (n,) inside; scales : (n,) half the range of each component; basis : U,
        (n, dimension) orthonormal
    missing : (n, n − dimension) orthonormal directions, of x, across which the set is flat
    """

    center: Array
    scales: Array
    basis: Array
    missing: Array

    @property
    def dimension(self) -> int:
        """Of the set."""
        return self.basis.shape[1]

    @property
    def back(self) -> Array:
        """(dimension, n): z = back (x − center), and the support in direction d of z is that in direction d·back."""
        return self.basis.T / self.scales

    def outside(self, z: Array) -> Array:
        """(…, n) points of the set from their coordinates in the frame."""
        return self.center + self.scales * (z @ self.basis.T)

    def inside(self, x: Array) -> Array:
        """(…, dimension) coordinates in the frame of points of the set."""
        return (x - self.center) @ self.back.T

    def rows(self, normals: Array, offsets: Array) -> tuple[Array, Array]:
        """Unit rows over x from rows over z, two opposite ones added for each missing direction."""
        n = normals @ self.back
        size = np.linalg.norm(n, axis=1)
        n, level = n / size[:, None], self.center @ self.missing
        return (np.concatenate([n, self.missing.T, -self.missing.T]),
                np.concatenate([offsets / size + n @ self.center, level, -level]))


def affine_hull(ends: Array, support_point: Callable[[Array], Array]) -> Frame:
    """The affine hull of a bounded set, found by asking how wide it is: n directions, each extends it or is missing.

    ends : (2, n, n) its points farthest along −e_i and e_i; support_point : d → its point
        farthest along d
    """
    n = ends.shape[-1]
    reach = np.diagonal(ends, axis1=1, axis2=2).T
    half = (reach[:, 1] - reach[:, 0]) / 2
    scales = np.where(half > _FLAT * np.abs(reach).max(axis=1), half, 1.0)
    points = ends.reshape(-1, n)
    basis, missing, seen = np.zeros((n, 0)), np.zeros((n, 0)), [points]
    if np.linalg.svd((points - points.mean(axis=0)) / scales, compute_uv=False)[-1] > _SOLID:
        basis = np.eye(n)
    else:
        size = max(1.0, float(np.abs(reach / scales[:, None]).max()))
        seen = []
        while basis.shape[1] + missing.shape[1] < n:
            way = _unused(np.concatenate([basis, missing], axis=1))
            seen.append(support_point(np.stack([way, -way]) / scales))
            step = (seen[-1][0] - seen[-1][1]) / scales
            if abs(way @ step) > _FLAT * size:
                step = step - basis @ (basis.T @ step)
                basis = np.concatenate([basis, (step / np.linalg.norm(step))[:, None]], axis=1)
            else:
                missing = np.concatenate([missing, way[:, None]], axis=1)
    across = np.linalg.qr(missing / scales[:, None])[0]
    return Frame(frozen(np.concatenate(seen).mean(axis=0)), frozen(scales), frozen(basis),
                 frozen(across))


def _unused(directions: Array) -> Array:
    """A unit vector orthogonal to all columns, as close to an axis as there is."""
    left = np.eye(len(directions)) - directions @ directions.T
    way = left[np.linalg.norm(left, axis=1).argmax()]
    return np.asarray(way / np.linalg.norm(way))
