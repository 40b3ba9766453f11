"""Occupancy grid of a hall and its distance transform: how far every place is from all that stands there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array, as_number, frozen
from .plan_view import Hall, carried
from .vehicle import Vehicle

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class OccupancyGrid:
    """Cells over a hall's floor; a cell counts as occupied if anything may stand in it.

    cell : edge of a cell [m]
    corner : (2,) lowest corner [m]
    occupied : (nx, ny) bool
    clearance : (nx, ny) lower bound of the distance from anywhere in the cell to what stands there or to the floor's
        edge; it is at most ``2 √2 cell`` below the true one [m]
    """

    cell: float
    corner: Array
    occupied: Flags
    clearance: Array

    @classmethod
    def of(cls, hall: Hall, cell: float = 0.03, points: ArrayLike = (), reach: float = 0.0) -> OccupancyGrid:
        """The grid of a hall.

        points : (p, 2) seen there that are not on the map [m]; reach : radius kept occupied about each of them [m]

        >>> grid = OccupancyGrid.of(Hall.of([[2, 0, 1, 1, 0]], [[-1, -2], [5, 2]]))
        >>> round(float(grid.clearance_at([0.5, 0.0])), 1)    # 1 m, less what a cell hides
        0.9
        """
        as_number(cell, "cell", "m", positive=True)
        low, high = hall.bounds
        shape = np.maximum(np.ceil((high - low) / cell - 1e-9).astype(int), 1)
        occupied = np.zeros(shape, dtype=bool)
        hidden = cell / np.sqrt(2)                      # from a cell's center to its corner
        for outline in hall.outlines:
            middle, along = outline.mean(axis=0), outline[0] - outline[1]
            length, width = np.linalg.norm(along), np.linalg.norm(outline[1] - outline[2])
            axes = np.stack([along / length, np.array([-along[1], along[0]]) / length])
            half = np.array([length, width]) / 2
            where, off = _near(occupied, low, cell, middle, float(np.hypot(*half)) + hidden)
            occupied[where] |= (np.abs(off @ axes.T) <= half + hidden).all(axis=-1)
        for point in np.asarray(points, dtype=float).reshape(-1, 2):
            where, off = _near(occupied, low, cell, point, reach + hidden)
            occupied[where] |= np.linalg.norm(off, axis=-1) <= reach + hidden
        return cls(cell, low, _kept(occupied), frozen(_clearance(occupied, cell)))

    @property
    def slack(self) -> float:
        """The most by which ``clearance`` is too careful [m]."""
        return 2 * np.sqrt(2) * self.cell

    def clearance_at(self, points: ArrayLike) -> Array:
        """(…) clearance at points (…, 2); 0 off the floor [m]."""
        k = np.floor((np.asarray(points, dtype=float) - self.corner) / self.cell).astype(int)
        nx, ny = self.occupied.shape
        on = (k >= 0).all(axis=-1) & (k[..., 0] < nx) & (k[..., 1] < ny)
        k = np.clip(k, 0, [nx - 1, ny - 1])
        return np.where(on, self.clearance[k[..., 0], k[..., 1]], 0.0)

    def room(self, vehicle: Vehicle, poses: ArrayLike) -> Array:
        """(…) what is surely left between a vehicle at poses (…, 3) and all that stands there [m]."""
        return self.clearance_at(carried(poses, vehicle.discs)).min(axis=-1) - vehicle.radius

    def room_on(self, vehicle: Vehicle, xs: Array, ys: Array, heading: float) -> Array:
        """(nx, ny) the same for one heading at all places (x, y): cells are looked up row by column."""
        walled = np.pad(self.clearance, 1)          # the ring around it is off the floor
        least = np.full((len(xs), len(ys)), np.inf)
        for dx, dy in carried([0, 0, heading], vehicle.discs).tolist():
            i, j = (np.clip(np.floor((line - low) / self.cell).astype(int) + 1, 0, count - 1)
                    for line, low, count in zip((xs + dx, ys + dy), self.corner, walled.shape))
            np.minimum(least, walled[i[:, None], j], out=least)
        return least - vehicle.radius


def _near(occupied: Flags, low: Array, cell: float, middle: Array, radius: float) -> tuple[tuple[slice, slice], Array]:
    """The cells around a place, and (…, 2) how far their centers are off it."""
    first = np.clip(np.floor((middle - radius - low) / cell).astype(int), 0, occupied.shape)
    last = np.clip(np.ceil((middle + radius - low) / cell).astype(int) + 1, first, occupied.shape)
    x, y = (low[i] + (np.arange(first[i], last[i]) + 0.5) * cell - middle[i] for i in (0, 1))
    return (slice(first[0], last[0]), slice(first[1], last[1])), np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)


def _kept(occupied: Flags) -> Flags:
    occupied.setflags(write=False)
    return occupied


def _clearance(occupied: Flags, cell: float) -> Array:
    from scipy.ndimage import distance_transform_edt

    # One ring of occupied cells outside: the floor's edge is a wall.
    walled = np.pad(occupied, 1, constant_values=True)
    between_centers = distance_transform_edt(~walled, sampling=cell)[1:-1, 1:-1]
    return np.maximum(between_centers - np.sqrt(2) * cell, 0.0)
