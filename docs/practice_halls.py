"""Seeded halls to practice in: walls, a shelf to stop at, pallets, somebody walking about."""

from typing import NamedTuple

import numpy as np

from cdprlab.fastkit import Hall, Vehicle, Walker
from cdprlab.fastkit.navigation.hall import walls
from cdprlab.fastkit.plane import rectangle_distance

SIZE = 10.0, 8.0
"""Of the floor [m]."""
GAP = 0.25
"""From the pair at its goal to the shelf [m]."""


class Practice(NamedTuple):
    """A hall, from where to where, and who walks there.

    hall : Hall; start, goal : (3,) [m, m, rad]; walkers : people
    """

    hall: Hall
    start: np.ndarray
    goal: np.ndarray
    walkers: tuple[Walker, ...]


def practice_hall(vehicle: Vehicle, seed: int, pallets: int = 9) -> Practice:
    """A hall with a shelf along its upper wall; the goal is before the shelf.

    pallets : at most so many, 0.5 to 1.2 m long, wherever start and goal stay free
    """
    random = np.random.default_rng(seed)
    length, height = SIZE
    shelf = np.array([random.uniform(0.35, 0.65) * length, height - 0.3, 2.4, 0.6, 0.0])
    goal = np.array([shelf[0], height - 0.6 - GAP - vehicle.width / 2,
                     float(random.choice([0.0, np.pi]))])
    start = random.uniform([2.0, 1.8, -np.pi], [length - 2.0, 2.2, np.pi])
    keep = np.stack([start, goal])
    rows = [*walls([[0, 0], SIZE]), shelf]
    for _ in range(pallets):
        x, y, along, across, heading = random.uniform([0, 0.5, 0.5, 0.4, 0],
                                                      [length, height - 1.0, 1.2, 0.8, np.pi])
        if rectangle_distance(keep, vehicle.size, [x, y, heading], [along, across]).min() > 0.45:
            rows.append(np.array([x, y, along, across, heading]))
    middle = (start[:2] + goal[:2]) / 2
    aside = random.uniform([2.0, -0.5], [3.0, 0.5])
    hall = Hall.of(np.array(rows), [[0, 0], SIZE])
    way = np.clip([middle - aside, middle + aside], 0.4, np.array(SIZE) - 0.4)
    return Practice(hall, start, goal,
                    (Walker(_walkable(hall, way), random.uniform(0.4, 0.8), hall=hall),))


def _walkable(hall: Hall, way: np.ndarray) -> np.ndarray:
    """(2, 2) the longest part of a straight way that leaves a person room [m]."""
    points = way[0] + np.linspace(0, 1, 101)[:, None] * (way[1] - way[0])
    blocked = np.flatnonzero(np.concatenate([[True], hall.distance(points) < 0.3, [True]])) - 1
    first = int(np.argmax(np.diff(blocked)))
    return points[[min(blocked[first] + 1, 100), max(blocked[first + 1] - 1, 0)]]
