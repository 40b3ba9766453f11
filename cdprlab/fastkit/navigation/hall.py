"""A hall from above: a floor, and what stands on it as rectangles."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, Flags, checked, frozen, frozen_dataclass
from ...errors import InvalidInput, quoted
from ...world import World
from ..plane import Bounds, Spots, edges, point_distance, rectangle
from .laser import Scanner

_TALLEST = 2.4     # m: of the bases
_HEIGHT = 1.2      # m: of walls and pallets


@frozen_dataclass
class Hall:
    """A known map: k solid rectangles on a floor.

    places : (k, 3) of their centers [m, m, rad]; sizes : (k, 2) along and across [m]
    bounds : (2, 2) lowest and highest corner of the floor that may be driven on [m]
    seen : (k,) whether a scanner's plane cuts it; all keep bases away
    """

    places: Annotated[Array, "(k, 3) [m, m, rad]"]
    sizes: Annotated[Array, "(k, 2) [m]"]
    bounds: Annotated[Array, "(2, 2) [m]"]
    seen: Flags

    @classmethod
    def of(cls, rectangles: Annotated[ArrayLike, "(k, 5) [m, rad]"], bounds: Bounds, seen: ArrayLike = True) -> Hall:
        """A hall of rectangles, by default all as high as the scanners.

        rectangles : (k, 5) center x, y, edges along and across [m], heading [rad]; others as
            above

        >>> Hall.of([[0, 0, 2, 1, 0]], [[-3, -3], [3, 3]]).distance([0, 1.5]).tolist()
        1.0
        """
        rows = np.asarray(rectangles)
        if np.shape(seen) not in ((), (len(rows),)):
            raise InvalidInput(f"seen must be one truth value, or one a rectangle, got {quoted(seen)}")
        return cls(rows[:, [0, 1, 4]], rows[:, 2:4], np.asarray(bounds),
                   np.broadcast_to(seen, len(rows)))

    @classmethod
    def of_world(cls, world: World, bounds: Bounds) -> Hall:
        """The plan of a world's scene: all that stands between the floor and the tops of the bases.

        bounds : (2, 2) [m]
        """
        rows, seen = [], []
        for box in world.scene.boxes:
            middle, half = box.position[2] - world.scene.floor_height, box.size[2] / 2
            if middle + half > 0.01 and middle - half < _TALLEST:
                rows.append([*box.position[:2], *box.size[:2], box.yaw])
                seen.append(abs(Scanner.height - middle) < half)
        return cls.of(np.reshape(rows, (-1, 5)), bounds, np.array(seen, dtype=bool))

    def with_rectangles(self, rectangles: ArrayLike) -> Hall:
        """The hall and more that stands in it; (k, 5) as in `of`."""
        more = Hall.of(rectangles, self.bounds)
        return Hall(np.vstack([self.places, more.places]), np.vstack([self.sizes, more.sizes]),
                    self.bounds, np.append(self.seen, more.seen))

    @cached_property
    def outlines(self) -> Array:
        """(k, 4, 2) corners of each rectangle, counter-clockwise [m]."""
        return frozen(rectangle(self.places, self.sizes))

    @cached_property
    def segments(self) -> Array:
        """(s, 2, 2) edges a scanner can see [m]."""
        return frozen(edges(self.outlines[self.seen]).reshape(-1, 2, 2))

    def distance(self, points: Spots) -> Array:
        """(…) distance of (…, 2) points to the nearest rectangle, 0 inside one [m]; inf in an empty hall."""
        distances = point_distance(np.expand_dims(points, -2), self.places, self.sizes)
        return distances.min(axis=-1, initial=np.inf)


def walls(bounds: Bounds) -> Array:
    """(4, 5) rectangles just outside a floor (2, 2): north, south, west and east of it [m]."""
    thick, half = 0.1, 0.05
    (west, south), (east, north) = np.asarray(bounds, dtype=float)
    x, y = (west + east) / 2, (south + north) / 2
    along, across = east - west, north - south
    return np.array([[x, north + half, along, thick, 0], [x, south - half, along, thick, 0],
                     [west - half, y, thick, across, 0], [east + half, y, thick, across, 0]])


@checked
def in_hall(world: World, bounds: Bounds, pallets: Annotated[ArrayLike, "(k, 5) [m, rad]"] = ()) -> World:
    """A world with walls around the floor and pallets on it.

    bounds : (2, 2) of the floor, the walls just outside [m]
    pallets : (k, 5) center, edges [m], heading [rad]

    >>> import cdprlab as cl
    >>> fastkit = cl.load_world("fastkit_suspended")
    >>> len(in_hall(fastkit, [[-5, -6], [7, 2]], [[3, -3, 0.8, 1.2, 0.3]]).scene.boxes) - len(fastkit.scene.boxes)
    5
    """
    rows = [*walls(bounds), *np.reshape(pallets, (-1, 5))]
    names = ["north wall", "south wall", "west wall", "east wall",
             *(f"pallet {k}" for k in range(1, len(rows) - 3))]
    document = world.to_dict()
    scene = document.setdefault("scene", {})
    scene.setdefault("boxes", []).extend(
        {"name": name, "position": [x, y, _HEIGHT / 2], "size": [along, across, _HEIGHT],
         "yaw": yaw}
        for name, (x, y, along, across, yaw) in zip(names, np.array(rows).tolist()))
    return World.from_dict(document)
