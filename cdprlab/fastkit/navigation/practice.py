"""Seeded halls to practice in: walls, a shelf to stop at, pallets, somebody walking about."""

from typing import NamedTuple

import numpy as np

from ...arrays import Array, as_seed, checked
from ..plane import rectangle_distance
from .driving import Walker
from .hall import Hall, walls
from .vehicle import Vehicle


class Practice(NamedTuple):
    """A hall, from where to where, and who walks there.

    hall : Hall; start, goal : (3,) [m, m, rad]; walkers : people
    """

    hall: Hall
    start: Array
    goal: Array
    walkers: tuple[Walker, ...]


@checked
def practice_hall(vehicle: Vehicle, seed: int, size: tuple[float, float] = (10.0, 8.0),
                  pallets: int = 9, gap: float = 0.25) -> Practice:
    """A hall with a shelf along its upper wall; the goal is before the shelf, ``gap`` [m] from it.

    size : of the hall [m]
    pallets : at most so many, 0.5 to 1.2 m long, wherever start and goal stay free

    >>> import cdprlab as cl
    >>> pair = Vehicle.of(cl.load_world("fastkit_suspended").robot)
    >>> practice_hall(pair, 3).goal.round(3).tolist() == practice_hall(pair, 3).goal.round(3).tolist()
    True
    """
    random = np.random.default_rng(as_seed(seed))
    length, height = size
    shelf = np.array([random.uniform(0.35, 0.65) * length, height - 0.3, 2.4, 0.6, 0.0])
    goal = np.array([shelf[0], height - 0.6 - gap - vehicle.width / 2,
                     float(random.choice([0.0, np.pi]))])
    start = random.uniform([2.0, 1.8, -np.pi], [length - 2.0, 2.2, np.pi])
    keep = np.stack([start, goal])
    rows = [*walls([[0, 0], size]), shelf]
    for _ in range(pallets):
        x, y, along, across, heading = random.uniform([0, 0.5, 0.5, 0.4, 0],
                                                      [length, height - 1.0, 1.2, 0.8, np.pi])
        if rectangle_distance(keep, vehicle.size, [x, y, heading], [along, across]).min() > 0.45:
            rows.append(np.array([x, y, along, across, heading]))
    middle = (start[:2] + goal[:2]) / 2
    aside = random.uniform([2.0, -0.5], [3.0, 0.5])
    hall = Hall.of(np.array(rows), [[0, 0], size])
    way = np.clip([middle - aside, middle + aside], 0.4, np.array(size) - 0.4)
    return Practice(hall, start, goal,
                    (Walker(_walkable(hall, way), random.uniform(0.4, 0.8), hall=hall),))


def _walkable(hall: Hall, way: Array) -> Array:
    """(2, 2) the longest part of a straight way that leaves a person room [m]."""
    points = way[0] + np.linspace(0, 1, 101)[:, None] * (way[1] - way[0])
    blocked = np.flatnonzero(np.concatenate([[True], hall.distance(points) < 0.3, [True]])) - 1
    first = int(np.argmax(np.diff(blocked)))
    return points[[min(blocked[first] + 1, 100), max(blocked[first + 1] - 1, 0)]]
