"""Engines behind one interface: `open_simulator` gives the one a world asks for."""

from __future__ import annotations

from inspect import signature
from typing import Annotated, Any

from ..arrays import checked
from ..errors import InvalidInput, quoted
from ..world import World
from .planar import PlanarSimulator
from .simulator import WOUND, Simulator
from .spatial import SpatialSimulator

__all__ = ["CABLE_MODELS", "WOUND", "Simulator", "open_simulator"]

CABLE_MODELS = {
    "tension": "the tension is commanded; spatial: point-to-point constraint cables under torque, and measured",
    "force": "ideal massless cables as external forces: the baseline",
    "length": "winches pay ropes in and out, and ropes go slack by themselves: the length is commanded",
    "elastic": "the same with ropes that stretch as the world's `cable:` block says",
}
"""What ``cables=`` may be, and what it means."""


@checked
def open_simulator(world: World, cables: str = "tension", dt: Annotated[float, "[s] > 0"] = 1e-3,
                   **options: Any) -> Simulator:
    """The simulator a world's engine asks for, reset to the world's pose.

    world : World
    cables : one of ``CABLE_MODELS``
    dt : engine time step [s]
    options : the engine's own (PyBullet: ``tip_mass`` [kg], ``solver_iterations``,
        ``bodies=True`` for mobile bases that stand on wheels, drive and tip; pymunk:
        ``solver_iterations``)
    Raises InvalidInput for an unknown cable model, MissingDependency where the engine is not
    installed.
    """
    if cables not in CABLE_MODELS:
        raise InvalidInput(f"cable model {quoted(cables)} is not available; there are {', '.join(CABLE_MODELS)}")
    engine: Any = PlanarSimulator if world.engine == "planar" else SpatialSimulator
    known = [*signature(engine).parameters][3:]   # after world, cables and dt
    for option in options:
        if option not in known:
            raise InvalidInput(f"the {world.engine} engine takes no option {quoted(option)}; "
                               f"it takes {', '.join(known)}")
    return engine(world, cables, dt, **options)
