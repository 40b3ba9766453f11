"""Where a convex set lies and how large it is: the coordinates in which its facets and vertices are listed."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from .subspace import RANK


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


def affine_hull(center: Array, scales: Array, directions: Array) -> Frame:
    """The frame of a set that extends along some directions, and no other.

    center : (n,) inside; scales : (n,); directions : (n, k)
    """
    u, s, _ = np.linalg.svd(directions / scales[:, None])
    u[:, -1] *= np.sign(np.linalg.det(u))   # no mirror: what runs round the one way does so in the frame
    rank = int((s > RANK * s.max(initial=0.0)).sum())
    across = np.linalg.qr(u[:, rank:] / scales[:, None])[0]
    return Frame(center, scales, u[:, :rank], across)
