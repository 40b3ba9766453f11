"""The one loop: a command makes something of each wish, the engine advances by it, and a row is kept."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ..arrays import Array, Flags, as_answer
from ..errors import Recording
from ..mechanics.cables import cables_at
from ..mechanics.dynamics import inverse_dynamics
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..simulate import Simulator
from .controllers import Controller
from .distributor import Distributor
from .log import Columns, Log

Record = TypeVar("Record")

_UNITS = {"commanded_tensions": "N", "commanded_lengths": "m"}


class Command(ABC):
    """What moves the robot: it makes of each wish what the engine takes, and advances the engine by it.

    asks : what it asks of every cable, as the log has it
    """

    asks: tuple[str, ...]

    def start(self, engine: Simulator, substeps: int) -> Columns:
        """Get ready for an engine that has just been reset, and say what `step` will return.

        substeps : engine steps in a control step
        """
        self.engine, self.substeps = engine, substeps
        return {name: ((engine.world.robot.n_cables,), _UNITS[name]) for name in self.asks}

    @abstractmethod
    def step(self, wish: Any) -> tuple[Array, bool]:
        """Advance the engine by one control step; returns what was asked for in it, and whether it is feasible."""

    def cut(self, cables: list[int]) -> None:  # noqa: B027  (few commands have to know)
        """These cables have just been cut: ask nothing more of them."""


class TensionCommand(Command):
    """Tensions that exert a controller's wrench; a wish is a Reference."""

    asks = ("commanded_tensions",)

    def __init__(self, controller: Controller, distributor: Distributor) -> None:
        self.controller, self.distributor = controller, distributor

    def step(self, wish: Reference) -> tuple[Array, bool]:
        engine = self.engine
        state = engine.state()
        now = state.time
        wanted = as_answer(self.controller(now, state, wish), "the controller's wrench",
                           engine.world.robot.n_dof, "N, N m", now)
        tensions = self.distributor.tensions(engine.wrench_matrix, wanted, now)
        # Judged already, or sent as they are, even where they push: no step() asks again.
        engine.pull(tensions, self.substeps)
        return tensions, self.distributor.found


class LengthCommand(Command):
    """Winches; a wish is the (m,) lengths that the ropes shall have by the end of the control step [m]."""

    asks = ("commanded_lengths",)

    def step(self, wish: Array) -> tuple[Array, bool]:
        return wish, self.engine.bring(wish, self.substeps)


class StretchedLengths(Command):
    """Winches on ropes that stretch: wound shorter by what the tensions that hold the platform stretch them.

    A wish is the Reference of where the platform shall be by the end of the control step, and the
    robot with its bases where they then are, None: where they are.
    """

    asks = ("commanded_tensions", "commanded_lengths")

    def __init__(self, distributor: Distributor) -> None:
        self.distributor = distributor

    def step(self, wish: tuple[Reference, Robot | None]) -> tuple[Array, bool]:
        wound = self.wound(*wish)
        return np.concatenate([self.wanted, wound]), self.engine.bring(wound, self.substeps)

    def wound(self, reference: Reference, robot: Robot | None = None) -> Array:
        """(m,) rope that the winches let out where the ``wanted`` tensions stretch it [m]."""
        robot = robot or self.engine.robot
        assert robot.elasticity is not None
        _, lengths, W = cables_at(robot, reference.pose)
        wrench = inverse_dynamics(robot, reference.pose.rotation, reference.twist, reference.acceleration)
        self.wanted = self.distributor.tensions(W, wrench, self.engine.time)
        return robot.elasticity.unstrained(lengths, self.wanted)


class Flight(NamedTuple):
    """What `fly` kept.

    seen : one row as each control step begins, and one for the end: position, rotation, twist,
        lengths and tensions measured
    asked : what the command asked for in each control step; feasible : (N,) whether it could be had
    elapsed : time the loop took [s]
    cut_short : '' or what ended it early
    """

    seen: Log
    asked: Log
    feasible: Flags
    elapsed: float
    cut_short: str = ""

    @property
    def steps(self) -> int:
        """Control steps flown to their end: one that was not is none, the flight ends where it began."""
        return len(self.seen) - 1


def fly(engine: Simulator, command: Command, wishes: Iterable[Any],
        record: Callable[[Flight], Record], substeps: int = 1) -> Record:
    """Command one wish after the other, as long as there are any; returns the record of the flight.

    Whatever ends it early carries the record of the steps that were flown to their end, see
    `Recording`.

    engine : reset to where it begins; substeps : its steps in a control step
    wishes : what the command takes; an iterator may decide by what the engine has come to, and do
        what else there is as a step begins, such as cuts and pushes
    record : what becomes of the flight
    """
    asked, seen, feasible = Log(command.start(engine, substeps)), Log(engine.columns()), bytearray()
    began = time.perf_counter()

    def flown(cut_short: str = "", _: Any = None) -> Record:
        if len(seen) <= len(asked):   # its end is not kept yet: it was not the record that was disturbed
            seen.append(engine.sample())
        flags = np.array(feasible, dtype=bool)[:len(seen) - 1]
        return record(Flight(seen, asked, flags, time.perf_counter() - began, cut_short))

    with Recording(flown):
        see, sample, keep, step = seen.append, engine.sample, asked.append, command.step
        for k, wish in enumerate(wishes):
            if k == 0:
                see(sample())
            numbers, found = step(wish)
            feasible.append(found)
            keep(numbers)
            see(sample())
        return flown()
