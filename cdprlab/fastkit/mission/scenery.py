"""The hall around a world's shelf: walls and pallets as parts of its scene."""

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import as_array, checked
from ...world import World
from ..navigation.hall import walls

_HEIGHT = 1.2      # m: of walls and pallets


@checked
def in_hall(world: World, bounds: ArrayLike, pallets: Annotated[ArrayLike, "(k, 5) [m, rad]"] = ()) -> World:
    """A world with walls around the floor and pallets on it.

    bounds : (2, 2) of the floor, the walls just outside [m]
    pallets : (k, 5) center, edges [m], heading [rad]

    >>> import cdprlab as cl
    >>> fastkit = cl.load_world("fastkit_suspended")
    >>> len(in_hall(fastkit, [[-5, -6], [7, 2]], [[3, -3, 0.8, 1.2, 0.3]]).scene.boxes) - len(fastkit.scene.boxes)
    5
    """
    rows = [*walls(as_array(bounds, "bounds", (2, 2), "m")), *np.reshape(pallets, (-1, 5))]
    names = ["north wall", "south wall", "west wall", "east wall",
             *(f"pallet {k}" for k in range(1, len(rows) - 3))]
    document = world.to_dict()
    scene = document.setdefault("scene", {})
    scene.setdefault("boxes", []).extend(
        {"name": name, "position": [x, y, _HEIGHT / 2], "size": [along, across, _HEIGHT],
         "yaw": yaw}
        for name, (x, y, along, across, yaw) in zip(names, np.array(rows).tolist()))
    return World.from_dict(document)
