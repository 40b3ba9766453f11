"""The interface every engine keeps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..control import State
from ..errors import InvalidInput
from ..pose import Pose
from ..robot import Robot
from ..world import World

CABLE_MODELS = {
    "tension": "point-to-point constraint cables under torque: the tension is commanded and measured",
    "force": "ideal massless cables as external forces: the baseline",
}
"""What ``cables=`` may be, and what it means."""


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


def open_simulator(world: World, cables: str = "tension", dt: float = 1e-3, **options: Any) -> Simulator:
    """The simulator a world's engine asks for, reset to the world's pose.

    world : World
    cables : one of ``CABLE_MODELS``
    dt : engine time step [s]
    options : the engine's own (PyBullet: ``tip_mass`` [kg], ``solver_iterations``)
    Raises InvalidInput for an unknown cable model, MissingDependency where the engine is not installed.
    """
    if cables not in CABLE_MODELS:
        raise InvalidInput(f"cable model {cables!r} is not available in the {world.engine} engine; "
                           f"there are {', '.join(CABLE_MODELS)}")
    if not (np.isfinite(dt) and dt > 0):
        raise InvalidInput(f"dt must be a positive time step [s], got {dt!r}")
    if world.engine == "planar":
        raise InvalidInput(f"world {world.name!r} is planar; this version simulates spatial worlds only "
                           "(kinematics, statics and tensions work for both)")
    from .spatial import SpatialSimulator

    return SpatialSimulator(world, cables, dt, **options)
