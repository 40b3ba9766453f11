"""Occupancy grid of a hall and its distance transform: how far every place is from all that stands there."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated

import numpy as np
from scipy.ndimage import distance_transform_edt
from scipy.spatial import KDTree

from ...arrays import Array, Flags, frozen, frozen_dataclass
from ..plane import NO_POINTS, Places, Scan, Spots, carried, turn
from .hall import Hall
from .vehicle import Vehicle

Line = Annotated[Array, "(k,) [m]"]


@frozen_dataclass
class OccupancyGrid:
    """Cells over a hall's floor; a cell counts as occupied if anything may stand in it.

    cell : edge of a cell [m]
    corner : (2,) lowest corner [m]
    occupied : (nx, ny) bool
    clearance : (nx, ny) lower bound of the distance from anywhere in the cell to what stands
        there or to the floor's edge; it is at most ``2 √2 cell`` below the true one [m]
    """

    cell: float
    corner: Array
    occupied: Flags
    clearance: Array

    @classmethod
    def of(cls, hall: Hall, cell: Annotated[float, "[m] > 0"] = 0.03, points: Scan = NO_POINTS,
           reach: Annotated[float, "[m] ≥ 0"] = 0.0) -> OccupancyGrid:
        """The grid of a hall.

        points : (p, 2) seen there that are not on the map [m]
        reach : radius kept occupied about each of them [m]

        >>> grid = OccupancyGrid.of(Hall.of([[2, 0, 1, 1, 0]], [[-1, -2], [5, 2]]))
        >>> round(float(grid.clearance_at([0.5, 0.0])), 1)    # 1 m, less what a cell hides
        0.9
        """
        low, high = hall.bounds
        shape = np.maximum(np.ceil((high - low) / cell - 1e-9).astype(int), 1)
        centers = low + (np.moveaxis(np.indices(shape), 0, -1) + 0.5) * cell
        hidden = cell / np.sqrt(2)                      # from a cell's center to its corner
        occupied = np.zeros(shape, bool)
        if len(points):
            occupied = KDTree(points).query(centers)[0] <= reach + hidden
        for place, size in zip(hall.places, hall.sizes):
            off = (centers - place[:2]) @ turn(place[2])
            occupied |= (np.abs(off) <= size / 2 + hidden).all(axis=-1)
        occupied.setflags(write=False)
        # One ring of occupied cells outside: the floor's edge is a wall.
        walled = np.pad(occupied, 1, constant_values=True)
        between_centers = distance_transform_edt(~walled, sampling=cell)[1:-1, 1:-1]
        return cls(cell, low, occupied,
                   frozen(np.maximum(between_centers - np.sqrt(2) * cell, 0.0)))

    @property
    def slack(self) -> float:
        """The most by which ``clearance`` is too careful [m]."""
        return 2 * np.sqrt(2) * self.cell

    def clearance_at(self, points: Spots) -> Array:
        """(…) clearance at points (…, 2); 0 off the floor [m]."""
        return self._walled[self._cells(*np.moveaxis(np.asarray(points), -1, 0))]

    def room(self, vehicle: Vehicle, poses: Places) -> Array:
        """(…) what is surely left between a vehicle at poses (…, 3) and all that stands there [m]."""
        return self.clearance_at(carried(poses, vehicle.discs)).min(axis=-1) - vehicle.radius

    def room_on(self, vehicle: Vehicle, xs: Line, ys: Line, headings: Line) -> Array:
        """(k, nx, ny) the same at k headings and all places (x, y): cells are looked up row by column."""
        turned = carried(np.pad(headings[:, None], ((0, 0), (2, 0))), vehicle.discs)
        rows, columns = self._cells(xs + turned[..., :1], ys + turned[..., 1:])
        return np.array([self._walled[i[:, :, None], j[:, None]].min(axis=0)
                         for i, j in zip(rows, columns)]) - vehicle.radius

    @cached_property
    def _walled(self) -> Array:
        """The clearance in a ring of zeros: there it is off the floor."""
        return np.pad(self.clearance, 1)

    def _cells(self, *points: Array) -> tuple[Array, ...]:
        """Where x and y are in ``_walled``."""
        return tuple(np.clip(np.floor((along - low) / self.cell).astype(int) + 1, 0, count - 1)
                     for along, low, count in zip(points, self.corner, self._walled.shape))
