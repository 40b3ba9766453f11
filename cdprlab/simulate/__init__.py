"""Engines behind one interface: `open_simulator` gives the one a world asks for."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import InvalidInput
from ..world import World
from .simulator import Simulator

__all__ = ["CABLE_MODELS", "Simulator", "open_simulator"]

CABLE_MODELS = {
    "tension": "point-to-point constraint cables under torque: the tension is commanded and measured",
    "force": "ideal massless cables as external forces: the baseline",
}
"""What ``cables=`` may be, and what it means."""


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
