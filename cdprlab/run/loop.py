"""The one loop: a command makes something of each wish, the engine advances by it, and a row is kept."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ..arrays import Array, Progress, as_answer
from ..errors import recording
from ..mechanics.cables import cables_at
from ..mechanics.dynamics import inverse_dynamics
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..simulate import Simulator
from .controllers import Controller
from .distributor import Distributor
from .drive import Drive
from .log import Columns, Log

Record = TypeVar("Record")


class Command(ABC):
    """What moves the robot: it makes of each wish what the engine takes, and advances the engine by it."""

    def start(self, engine: Simulator, substeps: int) -> Columns:
        """Get ready for an engine that has just been reset, and say what `step` will return.

        substeps : engine steps in a control step
        """
        self.engine, self.substeps = engine, substeps
        return self.columns(engine.world.robot)

    @abstractmethod
    def columns(self, robot: Robot) -> Columns:
        """What `step` returns, for the log."""

    @abstractmethod
    def step(self, wish: Any) -> Iterable[float]:
        """Advance the engine by one control step; returns what was asked for in it."""

    def cut(self, cables: list[int]) -> None:  # noqa: B027  (few commands have to know)
        """These cables have just been cut: ask nothing more of them."""


class TensionCommand(Command):
    """Tensions that exert a controller's wrench; a wish is a Reference."""

    def __init__(self, controller: Controller, distributor: Distributor) -> None:
        self.controller, self.distributor = controller, distributor

    def columns(self, robot: Robot) -> Columns:
        return {"commanded_tensions": ((robot.n_cables,), "N"), "feasible": ((), "")}

    def step(self, wish: Reference) -> Iterable[float]:
        engine = self.engine
        state = engine.state()
        now = state.time
        wanted = as_answer(self.controller(now, state, wish), "the controller's wrench",
                           engine.world.robot.n_dof, "N, N m", now)
        tensions = self.distributor.tensions(engine.wrench_matrix, wanted, now)
        # Judged already, or sent as they are, even where they push: no step() asks again.
        engine.pull(tensions, self.substeps)
        return *tensions.tolist(), self.distributor.found

    def cut(self, cables: list[int]) -> None:
        self.distributor.cut(cables)


class LengthCommand(Command):
    """Winches; a wish is the (m,) lengths that the ropes shall have by the end of the control step [m]."""

    def columns(self, robot: Robot) -> Columns:
        return {"commanded_lengths": ((robot.n_cables,), "m"), "feasible": ((), "")}

    def step(self, wish: list[float]) -> Iterable[float]:
        return *wish, self.engine.bring(wish, self.substeps)


class StretchedLengths(Command):
    """Winches on ropes that stretch: wound shorter by what the tensions that hold the platform stretch them.

    A wish is the Reference of where the platform shall be by the end of the control step.

    drive : moves the bases, None: they stay
    """

    def __init__(self, distributor: Distributor, drive: Drive | None) -> None:
        self.distributor, self.drive = distributor, drive

    def columns(self, robot: Robot) -> Columns:
        return {"commanded_tensions": ((robot.n_cables,), "N"), **LengthCommand().columns(robot)}

    def step(self, wish: Reference) -> Iterable[float]:
        wound = self.wound(wish, None if self.drive is None else self.drive.step(self.engine)).tolist()
        return *self.wanted.tolist(), *wound, self.engine.bring(wound, self.substeps)

    def wound(self, wish: Reference, robot: Robot | None = None) -> Array:
        """(m,) rope that the winches let out where the ``wanted`` tensions stretch it [m].

        robot : with its bases where they then are; default: where they are
        """
        robot = robot or self.engine.robot
        assert robot.elasticity is not None
        _, lengths, W = cables_at(robot, wish.pose)
        wrench = inverse_dynamics(robot, wish.pose.rotation, wish.twist, wish.acceleration)
        self.wanted = self.distributor.tensions(W, wrench, self.engine.time)
        return robot.elasticity.unstrained(lengths, self.wanted)

    def cut(self, cables: list[int]) -> None:
        self.distributor.cut(cables)


class Flight(NamedTuple):
    """What `fly` kept.

    log : one row a control step: position, rotation, twist, lengths and tensions measured as it
        begins, and what the command asked for in it; one more row for the end, where nothing is
        asked for
    elapsed : time the loop took [s]
    cut_short : '' or what ended it early
    """

    log: Log
    elapsed: float
    cut_short: str = ""

    @property
    def steps(self) -> int:
        """Control steps flown to their end."""
        return len(self.log) - 1


def fly(engine: Simulator, command: Command, wishes: Iterable[Any],
        record: Callable[[Flight], Record], substeps: int = 1,
        happen: Callable[[int], Any] | None = None) -> Record:
    """Command one wish after the other, as long as there are any; returns the record of the flight.

    Whatever ends it early carries the record of the steps that were flown to their end, see
    `recording`.

    engine : reset to where it begins; substeps : its steps in a control step
    wishes : what the command takes; an iterator may decide by what the engine has come to
    record : what becomes of the flight
    happen : called as each step begins, with its number from 0: what else there is, such as
        cuts and pushes
    """
    log = Log({**engine.columns(), **command.start(engine, substeps)})
    keep, sample, step = log.keep_numbers, engine.sample, command.step
    began = time.perf_counter()
    k = 0
    seen: Sequence[float] | None = None

    def flown(cut_short: str = "", _: Any = None) -> Record:
        if len(log) < k + 2:   # else its end is kept: it is the record that was disturbed
            # A step that was not flown to its end is none: the flight ends where it began.
            end = sample() if seen is None or k < len(log) else seen
            keep((*end, *[np.nan] * (log.width - len(end))))
        return record(Flight(log, time.perf_counter() - began, cut_short))

    with recording(flown):
        for k, wish in enumerate(wishes):
            seen = sample()
            if happen is not None:
                happen(k)
            keep((*seen, *step(wish)))
            seen = None
        return flown()


def counted(wishes: Iterable[Any], steps: int, progress: Progress | None) -> Iterable[Any]:
    """The same wishes; ``progress`` hears of them about a hundred times."""
    if progress is None:
        return wishes

    def tell() -> Iterator[Any]:
        every = max(1, steps // 100)
        for done, wish in enumerate(wishes):
            if done % every == 0:
                progress(done, steps)
            yield wish
        progress(steps, steps)

    return tell()
