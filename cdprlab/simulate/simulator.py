"""The interface every engine keeps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose
from ..world import World
from .state import State


class Simulator(ABC):
    """One robot in one engine; several may live in one process. Use it in a ``with`` block, or close it.

    world, robot, dt : what it was made for; dt is the engine's time step [s]
    position, rotation, twist, tensions : the present state, as in `State`
    wrench_matrix, lengths : (n, m) and (m,) [m] of the present pose
    """

    world: World
    robot: Robot
    dt: float
    position: Array
    rotation: Array
    twist: Array
    tensions: Array
    wrench_matrix: Array
    lengths: Array

    @abstractmethod
    def reset(self, pose: Pose | None = None) -> State:
        """Put the robot at rest at a pose (default the world's), all cables whole; time starts at 0."""

    @abstractmethod
    def step(self, tensions: Array, substeps: int = 1) -> None:
        """Advance by ``substeps`` × dt with these (m,) cable tensions held [N]."""

    def wind(self, lengths: ArrayLike, substeps: int = 1) -> bool:
        """Advance while winches bring the ropes to these (m,) lengths; False where a speed limit kept one from it."""
        raise InvalidInput(f"{type(self).__name__} has no winches")

    def drive(self, speeds: ArrayLike) -> Array:
        """Let the mobile bases drive on at these (3p,) speeds; returns them as their limits allow [rad/s, m/s]."""
        raise InvalidInput(f"{type(self).__name__} has no bases that drive: planar worlds have")

    def sample(self) -> Iterable[float]:
        """Position, rotation (row by row), twist, lengths and tensions as one row of a log."""
        return np.concatenate([self.position, self.rotation.ravel(), self.twist, self.lengths, self.tensions]).tolist()

    @abstractmethod
    def state(self) -> State:
        """The present state."""

    @abstractmethod
    def cut(self, cables: ArrayLike | None = None) -> None:
        """Cut cables by index from 0 (default all): they carry nothing until the next reset."""

    @abstractmethod
    def push(self, wrench: ArrayLike) -> None:
        """Apply an external (n,) wrench at P during every further step [N, N m]; zero to stop."""

    @abstractmethod
    def contact_force(self) -> float:
        """Sum of the normal contact forces on the platform during the last step [N]."""

    @abstractmethod
    def render(self, width: int = 640, height: int = 480) -> Any:
        """(height, width, 3) uint8 picture of the present state, cables colored by tension."""

    @abstractmethod
    def close(self) -> None:
        """Release the engine; safe to call twice."""

    def __enter__(self) -> Simulator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
