"""Cable configurations: which cables of a point-mass robot are taut."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Indices, as_array, checked
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import cross

HalfWidth = Annotated[float, "[m] ≥ 0"]
"""Of a box around what is uncertain."""


class Configuration(tuple[int, ...]):
    """The taut cables, numbered from 1 as in the literature; equal to the plain tuple of these numbers.

    >>> Configuration((1, 2, 3)), Configuration((1, 2, 3)) == (1, 2, 3)
    (A123, True)
    """

    __slots__ = ()

    @checked
    def __new__(cls, cables: Sequence[int]) -> Configuration:
        return super().__new__(cls, sorted(cables))

    @property
    def indices(self) -> Indices:
        """Positions in the robot's arrays, from 0."""
        return np.array(self, dtype=np.intp) - 1

    def __repr__(self) -> str:
        return "A" + (",".join if max(self, default=0) > 9 else "".join)(map(str, self))


def as_position(position: ArrayLike) -> Array:
    """(3,) from coordinates or a Pose [m]."""
    return as_array(getattr(position, "position", position), "position", (3,), "m")


def triplets(robot: Robot) -> tuple[Configuration, ...]:
    """Every choice of three cables; raises as `few_cables`."""
    return tuple(chosen for chosen in few_cables(robot) if len(chosen) == 3)


def few_cables(robot: Robot) -> tuple[Configuration, ...]:
    """Every choice of one, two or three cables, fewer first.

    Raises InvalidInput unless the robot is a point mass in space (3T) on at least three cables
    that leave their exit points straight.
    """
    if robot.motion_pattern != "3T":
        raise InvalidInput("cable configurations are those of a point mass in space (motion pattern 3T), this robot "
                           f"is {robot.motion_pattern}")
    if robot.pulleys.size:
        raise InvalidInput("cable configurations are told from exit points that stay where they are; this robot's "
                           "cables leave over pulleys, from points that move with the load")
    if robot.n_cables < 3:
        raise InvalidInput(f"a fully constrained point needs three cables, this robot has {robot.n_cables}")
    return tuple(Configuration(chosen) for size in (1, 2, 3)
                 for chosen in combinations(range(1, robot.n_cables + 1), size))


def counterclockwise(exits: Array) -> Array:
    """(3, 3) exit points of a triplet, in counter-clockwise order seen from above."""
    a, b, c = exits[:, :2]
    return exits if cross(b - a, c - a)[0] > 0 else exits[::-1]
