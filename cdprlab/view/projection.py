"""From space to the plane of a picture: a mild perspective that turns about the vertical, in plain numpy."""

import numpy as np

from ..arrays import Array
from ..robot.pose import rotation_from_vector, turned_to

_DISTANCE = 3.5
"""Of the eye, in radii of what is seen: near enough for depth, far enough for parallel edges to look it."""

_RAISED = rotation_from_vector(np.array([np.pi / 2 - np.deg2rad(22.0), 0.0, 0.0]))
"""Columns to the right, up, and towards an eye 22° above the horizon."""


class Projection:
    """A camera that looks at the middle of some points.

    points : (k, d) everything that shall be seen [m]; planar points stay as they are
    azimuth : where the eye stands, 0 on the −y side, counter-clockwise from above [deg]

    >>> view = Projection(np.array([[0.0, 0.0, 0.0], [2.0, 2.0, 2.0]]))
    >>> view.flat(np.array([1.0, 1.0, 1.0]))
    array([0., 0.])
    """

    def __init__(self, points: Array, azimuth: float = 25.0) -> None:
        self.center = (points.min(axis=0) + points.max(axis=0)) / 2
        self.radius = max(np.linalg.norm(points - self.center, axis=1).max(), 1e-3)
        self.turn(azimuth)

    def turn(self, azimuth: float) -> None:
        """Walk around: ``azimuth`` [deg]."""
        self.axes = (turned_to(np.deg2rad(azimuth), 3) @ _RAISED).T

    @property
    def eye(self) -> Array:
        """(3,) where the camera stands [m]."""
        return self.center + _DISTANCE * self.radius * self.axes[2]

    def flat(self, points: Array) -> Array:
        """Where points appear.

        points : (…, d) [m]
        Returns (…, 2), to the right and up, in meters at the distance of the middle.
        """
        if points.shape[-1] == 2:
            return points
        local = (points - self.center) @ self.axes.T
        # What comes nearer than a third of the distance stays there: nothing may pass behind
        # the eye.
        depth = np.minimum(local[..., 2:] / (_DISTANCE * self.radius), 2 / 3)
        return local[..., :2] / (1 - depth)
