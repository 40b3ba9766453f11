"""What laser scanners see in the engine: beams are ray tests against everything solid, people included."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .spatial import SpatialSimulator

_TALL = 1.75     # m: a person


def ray_distances(simulator: SpatialSimulator, origin: Array, directions: Array, reach: float) -> Array:
    """(b,) distance along each beam to what it meets first, inf where it meets nothing within reach [m].

    origin : (3,) of the scanner [m]; directions : (b, 3) unit vectors; reach : [m]
    """
    ends = origin + reach * directions
    hits = simulator.bullet.rayTestBatch(np.broadcast_to(origin, ends.shape).tolist(), ends.tolist())
    share = np.array([hit[2] for hit in hits])
    return np.where([hit[0] >= 0 for hit in hits], reach * share, np.inf)


class Bystander:
    """A person in the engine: an upright cylinder that is where it is put.

    simulator : SpatialSimulator; place : (2,) [m]; radius : [m]
    """

    def __init__(self, simulator: SpatialSimulator, place: Array, radius: float) -> None:
        b = self._bullet = simulator.bullet
        shape = b.createCollisionShape(b.GEOM_CYLINDER, radius=radius, height=_TALL)
        self._body = b.createMultiBody(0, shape, basePosition=[*place, _TALL / 2])

    def put(self, place: Array) -> None:
        """Stand there."""
        self._bullet.resetBasePositionAndOrientation(self._body, [*place, _TALL / 2], [0, 0, 0, 1])
