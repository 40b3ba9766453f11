"""What hides what: boxes seen from an eye, in the order in which they are painted, and points behind them."""

import numpy as np

from ..arrays import Array, Flags
from .outlines import box_faces

_TOUCHING = 1e-6
"""[m] Boxes that meet in a face are apart."""

_NEARLY = 1e-3
"""Of the distance to the eye: a point so little behind a face is on it."""

_SUN = np.array([0.45, -0.65, 1.0])


class Blocks:
    """Boxes in space that do not run through each other, seen from an eye.

    corners : (n, 8, 3) of each box, in the order of `box_edges` [m]
    eye : (3,) [m]
    ``seen`` (n, 6) says which faces look towards the eye, ``lightness`` (n, 6) how bright they are: the more they look
    to the sun the brighter.

    >>> from cdprlab import Pose
    >>> from cdprlab.view.outlines import box_corners
    >>> cubes = [box_corners(np.ones(3), Pose([0, y, 0])) for y in (0, 2)]
    >>> blocks = Blocks(np.stack(cubes), np.array([0.0, -9.0, 0.0]))
    >>> blocks.order(), blocks.hides(np.array([[0.0, 1.0, 0.0], [5.0, 9.0, 0.0]])).tolist()
    ([1, 0], [[True, False], [False, False]])
    """

    def __init__(self, corners: Array, eye: Array) -> None:
        self.corners = corners
        centers, middles = corners.mean(axis=1), corners[:, box_faces(3)].mean(axis=2)
        outwards = middles - centers[:, None]
        self.normals = outwards / np.linalg.norm(outwards, axis=-1, keepdims=True)
        self.offsets = (self.normals * middles).sum(axis=-1)
        self.eye_heights = self.normals @ eye - self.offsets
        self.seen = self.eye_heights > 0
        self.lightness = 0.78 + 0.25 * self.normals @ (_SUN / np.linalg.norm(_SUN))
        self.distances = np.linalg.norm(centers - eye, axis=-1)

    def order(self) -> list[int]:
        """Which box is painted after which: the farthest first, but none before one that it may hide."""
        heights = np.einsum("ifx,jcx->ifjc", self.normals, self.corners)
        heights -= self.offsets[:, :, None, None]
        beyond = (heights > -_TOUCHING).all(axis=-1)
        # A face's plane that parts two boxes says which is on the eye's side: that one the
        # other cannot hide.
        before = (beyond & self.seen[..., None]).any(axis=1)
        behind = (beyond & ~self.seen[..., None]).any(axis=1)
        may_hide = ~(before | behind.T)
        after = may_hide & ~may_hide.T
        left, order = np.argsort(-self.distances).tolist(), []
        while left:
            free = (box for box in left if not after[box, left].any())
            order.append(next(free, left[0]))
            left.remove(order[-1])
        return order

    def hides(self, points: Array) -> Flags:
        """(n, k) whether each box stands between the eye and each of (k, 3) points."""
        start = self.eye_heights[..., None]
        end = self.normals @ points.T - self.offsets[..., None]
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = start / (start - end)                   # of a face's plane, from 0 at the eye to 1 at the point
        outside = np.where(end < start, crossing, np.inf)
        enters = np.where(start > 0, outside, 0.0).max(axis=1)
        leaves = np.where((start <= 0) & (end > 0), crossing, 1.0).min(axis=1)
        return enters < leaves - _NEARLY
