"""A design in the making: the last good robot, what it is worth, what went wrong, and the way back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path as FilePath
from typing import Any, NamedTuple

import numpy as np

from ...errors import CdprError, InvalidInput
from ...run import Run, run
from ...run.controllers import ComputedTorque
from ...world import World, load_world
from ..brief import Brief, Verdict
from .assessment import PLANES, Assessment, assess
from .edits import contents, edited, field_name, opened, with_entry, without_entry
from .fields import Field, Place, typed
from .history import History


class Kept(NamedTuple):
    """What undo brings back: the world, and which cable and base were being edited."""

    world: World
    place: Place


@dataclass(frozen=True)
class Flight:
    """How a design is simulated.

    method : tension distribution
    kp, kd : gains of computed torque [1/s²], [1/s]
    """

    method: str = "quadratic_program"
    kp: float = 100.0
    kd: float = 100.0


class DesignSession:
    """Edits of one world; each is judged, and a bad one changes nothing but ``mistake``.

    world : where to begin
    brief : judged with every design, if there is one

    >>> import cdprlab as cl
    >>> session = DesignSession(cl.load_world("caroca"))
    >>> session.edit(("platform", "mass"), 300.0)
    True
    >>> session.edit(("cables", 2, "tension", 0), 20000.0), session.mistake
    (False, 'cable 3: tension: tension limits are crossed: smallest 20000 N > largest 10000 N')
    >>> session.undo(), session.world.robot.mass
    (True, 150.0)
    """

    def __init__(self, world: World, brief: Brief | None = None) -> None:
        if not isinstance(world, World):
            raise InvalidInput(f"a designer takes a World, got {type(world).__name__}")
        self.history: History[Kept] = History(Kept(opened(world), Place()))
        self.plane = PLANES[0]
        self.mistake = ""
        self.brief = brief
        self.assessment: Assessment = assess(self.world, self.plane)

    @property
    def verdict(self) -> Verdict | None:
        """What the brief says of the present world, None without a brief."""
        return None if self.brief is None else self.brief.judge(self.world)

    @property
    def world(self) -> World:
        """The last good world."""
        return self.history.present.world

    @property
    def place(self) -> Place:
        """Which cable and which base are being edited, from 0."""
        return self.history.present.place

    # --- edits ------------------------------------------------------------------------------------------------
    def edit(self, path: tuple[str | int, ...], value: Any) -> bool:
        """Another value at a place of the world file; says whether that is a robot. Also sets `mistake`."""
        return self._do(field_name(path), lambda: (edited(self.world, path, value), self.place))

    def type(self, field: Field, entry: Any) -> bool:
        """What was typed into a field."""
        return self._do(field_name(field.path), lambda: (typed(self.world, field, entry), self.place))

    def add_cable(self) -> bool:
        """A copy of the cable being edited, at the end; it is then edited."""
        def work() -> tuple[World, Place]:
            block = contents(self.world)["cables"][self.place.cable]
            return with_entry(self.world, "cables", block), self.place._replace(cable=self.world.robot.n_cables)

        return self._do(f"cable {self.world.robot.n_cables + 1} added", work)

    def remove_cable(self) -> bool:
        """Without the cable being edited; those after it move up."""
        at = self.place.cable
        return self._do(f"cable {at + 1} removed", lambda: (
            without_entry(self.world, "cables", at), self.place._replace(cable=max(at - 1, 0))))

    def add_base(self) -> bool:
        """One more mobile base beside the frame; cables are given to it one by one."""
        def work() -> tuple[World, Place]:
            return with_entry(self.world, "bases", _new_base(self.world)), self.place._replace(
                base=len(self.world.robot.bases))

        return self._do("base added", work)

    def remove_base(self) -> bool:
        """Without the base being edited."""
        at = self.place.base

        def work() -> tuple[World, Place]:
            if not self.world.robot.bases:
                raise InvalidInput("this robot has no bases to remove", ("bases",))
            return without_entry(self.world, "bases", at), self.place._replace(base=max(at - 1, 0))

        return self._do(f"base {at + 1} removed", work)

    def frame_exits(self) -> bool:
        """A frame around all exit points, down to the floor."""
        points = self.world.robot.exit_points
        low, high = points.min(axis=0), points.max(axis=0)
        low[-1] = min(low[-1], self.world.scene.floor_height)
        return self._do("frame around the exit points", lambda: (
            edited(self.world, ("scene", "frame"), {"lower": low.tolist(), "upper": high.tolist()}), self.place))

    def make_motion(self) -> bool:
        """A default task that moves: a little way up, which may be changed then."""
        pose = contents(self.world)["platform"]["pose"]
        up = [*pose["position"][:-1], pose["position"][-1] + 0.3]
        task = {"kind": "quintic", "to": {**{key: turn for key, turn in pose.items() if turn is not None},
                                          "position": up}, "duration": 3.0}
        return self._do("task", lambda: (edited(self.world, ("tasks", "default"), task), self.place))

    def turn_to(self, place: Place) -> None:
        """Edit another cable or base; nothing to undo."""
        self._keep(self.history.present._replace(place=place))

    def look_at(self, plane: str) -> None:
        """Another plane for the slice."""
        self.plane = plane
        self.assessment = assess(self.world, plane)

    # --- files ------------------------------------------------------------------------------------------------
    def load(self, name_or_path: str) -> bool:
        """A shipped world by name or a world file by path, in place of this one; it can be undone."""
        return self._do(f"{name_or_path} loaded", lambda: (opened(load_world(name_or_path)), Place()))

    def read(self, text: str, name: str = "world file") -> bool:
        """A world from the text of a world file, in place of this one; mistakes are named by line."""
        return self._do(f"{name} read", lambda: (World.from_yaml(text, path=name), Place()))

    def save(self, path: str) -> bool:
        """Write the world file; says whether it worked."""
        def work() -> None:
            if not path.strip().endswith((".yaml", ".yml")):
                raise InvalidInput(f"a world file ends in .yaml, got {path.strip() or 'nothing'!r}")
            try:
                self.world.save(FilePath(path.strip()).expanduser())
            except OSError as error:
                raise InvalidInput(f"cannot write {path}: {error.strerror}") from None

        return self._try(work)

    def simulate(self, flight: Flight) -> Run | None:
        """The default task in the engine; None if that is impossible, and `mistake` says why."""
        flown: list[Run] = []

        def work() -> None:
            flown.append(run(self.world, method=flight.method, controller=ComputedTorque(flight.kp, flight.kd)))

        self._try(work)
        return flown[0] if flown else None

    # --- the way back -----------------------------------------------------------------------------------------
    def undo(self) -> bool:
        """Before the last edit."""
        return self._travel(lambda: self.history.undone())

    def redo(self) -> bool:
        """The edit undone last, again."""
        return self._travel(lambda: self.history.redone())

    # --- inside -----------------------------------------------------------------------------------------------
    def _do(self, label: str, work: Callable[[], tuple[World, Place]]) -> bool:
        def whole() -> None:
            world, place = work()
            if world is not self.world:
                judged = assess(world, self.plane)
                self.history, self.assessment = self.history.done(label, Kept(world, place)), judged

        return self._try(whole)

    def _travel(self, way: Callable[[], History[Kept]]) -> bool:
        def whole() -> None:
            history = way()
            self.assessment = assess(history.present.world, self.plane)
            self.history = history

        return self._try(whole)

    def _try(self, work: Callable[[], None]) -> bool:
        """Whether it worked; what cdprlab refuses on purpose becomes ``mistake``, and nothing is changed."""
        try:
            work()
        except CdprError as error:
            self.mistake = str(error)
            return False
        self.mistake = ""
        return True

    def _keep(self, kept: Kept) -> None:
        self.history = replace(self.history, present=kept)


def _new_base(world: World) -> dict[str, Any]:
    """A base beside the exit points, named after none of the others."""
    names = {base.name for base in world.robot.bases}
    name = next(f"base_{k}" for k in range(1, len(names) + 2) if f"base_{k}" not in names)
    x = float(world.robot.exit_points[:, 0].max()) + 1.0
    planar = world.robot.dimension == 2
    y = 0.0 if planar else float(np.mean(world.robot.exit_points[:, 1]))
    contacts = [[0.4, 0.0], [-0.4, 0.0]] if planar else [[0.4, 0.4], [-0.4, 0.4], [-0.4, -0.4], [0.4, -0.4]]
    return {"name": name, "pose": {"position": [x, y], "heading": 0.0}, "mass": 50.0,
            "center_of_mass": [0.0, 0.5] if planar else [0.0, 0.0, 0.5], "footprint": contacts,
            "speed": {"rotation": 0.0, "translation": [0.2, 0.0]}}
