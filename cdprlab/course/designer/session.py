"""A design in the making: the last good robot, what it is worth, what went wrong, and the way back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from pathlib import Path as FilePath
from typing import Any, NamedTuple

import numpy as np

from ...errors import CdprError, InvalidInput
from ...run import Run, run
from ...run.controllers import ComputedTorque
from ...world import World, load_world
from ...world.document import place_text
from ..brief import Brief, Verdict
from .assessment import PLANES, Assessment, Window, assess, exit_box
from .edits import Path, contents, edited, opened, with_entry, without_entry
from .fields import Field, Place, typed
from .history import History


def verb(work: Callable[..., None]) -> Callable[..., bool]:
    """What the session does, so that it says whether it worked.

    What cdprlab refuses on purpose becomes the session's ``mistake``, and nothing is changed.
    """
    @wraps(work)
    def told(session: DesignSession, *entries: Any, **named: Any) -> bool:
        try:
            work(session, *entries, **named)
        except CdprError as error:
            session.mistake = str(error)
            return False
        session.mistake = ""
        return True

    return told


class Kept(NamedTuple):
    """What undo brings back.

    place : which cable and base were being edited
    window : corners of the slice; it grows where exit points leave it, and else stays put [m]
    """

    world: World
    place: Place
    window: Window


class DesignSession:
    """Edits of one world; each is judged, and a bad one changes nothing but ``mistake``.

    world : where to begin
    brief : judged with every design, if there is one
    kept : the world as it was opened or saved last, None for a new one
    mirrored : axes at which edits of a cable are mirrored, as in "xy"

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
        begun = opened(world)
        self.history: History[Kept] = History(Kept(begun, Place(), exit_box(begun)))
        self.kept: World | None = self.world
        self.mirrored = ""
        self.mistake = ""
        self.brief = brief
        self.flown: Run | None = None
        self.look_at(PLANES[0])

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

    @property
    def unsaved(self) -> bool:
        """Whether no file has the world as it is now."""
        return self.world is not self.kept

    # --- edits ------------------------------------------------------------------------------------------------
    @verb
    def edit(self, path: Path, value: Any) -> None:
        """Another value at a place of the world file."""
        self._become(edited(self.world, path, value, self.mirrored), place_text(path))

    @verb
    def type(self, field: Field, entry: Any, name: str = "") -> None:
        """What was typed into a field.

        name : of the field on the screen, for messages
        """
        name = name or place_text(field.path)
        try:
            world = typed(self.world, field, entry, self.mirrored)
        except CdprError as error:
            why = str(error)
            for depth in range(len(field.path), 0, -1):
                why = why.removeprefix(place_text(field.path[:depth]) + ": ")
            raise InvalidInput(f"{name}: {why}", field.path) from error
        self._become(world, name)

    @verb
    def add_cable(self) -> None:
        """A copy of the cable being edited, at the end; it is then edited."""
        world = with_entry(self.world, "cables",
                           contents(self.world)["cables"][self.place.cable])
        m = world.robot.n_cables
        self._become(world, f"cable {m} added", self.place._replace(cable=m - 1))

    @verb
    def remove_cable(self) -> None:
        """Without the cable being edited; those after it move up."""
        at = self.place.cable
        self._become(without_entry(self.world, "cables", at), f"cable {at + 1} removed",
                     self.place._replace(cable=max(at - 1, 0)))

    @verb
    def add_base(self) -> None:
        """One more mobile base beside the frame; cables are given to it one by one."""
        self._become(with_entry(self.world, "bases", _new_base(self.world)), "base added",
                     self.place._replace(base=len(self.world.robot.bases)))

    @verb
    def remove_base(self) -> None:
        """Without the base being edited."""
        at = self.place.base
        if not self.world.robot.bases:
            raise InvalidInput("this robot has no bases to remove", ("bases",))
        self._become(without_entry(self.world, "bases", at), f"base {at + 1} removed",
                     self.place._replace(base=max(at - 1, 0)))

    @verb
    def frame_exits(self) -> None:
        """A frame around all exit points, down to the floor."""
        low, high = exit_box(self.world)
        self._become(edited(self.world, ("scene", "frame"), {"lower": low, "upper": high}),
                     "frame around the exit points")

    @verb
    def make_motion(self) -> None:
        """A default task that moves: a little way up, which may be changed then."""
        pose = contents(self.world)["platform"]["pose"]
        *level, height = pose["position"]
        task = {"kind": "quintic", "to": pose | {"position": [*level, height + 0.3]},
                "duration": 3.0}
        self._become(edited(self.world, ("tasks", "default"), task), "task")

    def turn_to(self, place: Place) -> None:
        """Edit another cable or base; nothing to undo."""
        self.history = replace(self.history, present=self.history.present._replace(place=place))

    def look_at(self, plane: str) -> None:
        """Another plane for the slice."""
        self.plane = plane
        self.assessment: Assessment = assess(self.world, plane, self.history.present.window)

    # --- files ------------------------------------------------------------------------------------------------
    @verb
    def new(self, name: str = "") -> None:
        """A world of one's own in place of this one: a copy of a shipped one, or an empty hall; it can be undone."""
        document = load_world(name).to_dict() if name else _HALL
        copy = {"name": "my_robot", "title": f"My robot, from {name}" if name else "My robot"}
        self._open(World.from_dict(document | copy), "new robot")
        self.kept = None

    @verb
    def load(self, name_or_path: str) -> None:
        """A shipped world by name or a world file by path, in place of this one; it can be undone."""
        self._open(opened(load_world(name_or_path)), f"{name_or_path} loaded")

    @verb
    def read(self, text: str, name: str = "world file") -> None:
        """A world from the text of a world file, in place of this one; mistakes are named by line."""
        self._open(World.from_yaml(text, path=name), f"{name} read")

    @verb
    def save(self, path: str) -> None:
        """Write the world file."""
        target = FilePath(path.strip()).expanduser()
        if target.suffix not in (".yaml", ".yml"):
            raise InvalidInput(f"a world file ends in .yaml, got {path.strip() or 'nothing'!r}")
        self.world.save(target)
        self.kept = self.world

    @verb
    def simulate(self, method: str = "quadratic_program", kp: float = 100.0, kd: float = 100.0,
                 ki: float = 0.0) -> None:
        """The default task in the engine by computed torque; what was flown is ``flown``.

        method : tension distribution
        kp, kd, ki : gains [1/s²], [1/s], [1/s³]
        """
        self.flown = None
        self.flown = run(self.world, method=method, controller=ComputedTorque(kp, kd, ki))

    # --- the way back -----------------------------------------------------------------------------------------
    @verb
    def undo(self) -> None:
        """Before the last edit."""
        self._turn(self.history.undone())

    @verb
    def redo(self) -> None:
        """The edit undone last, again."""
        self._turn(self.history.redone())

    # --- inside -----------------------------------------------------------------------------------------------
    def _open(self, world: World, label: str) -> None:
        self._turn(self.history.done(label, Kept(world, Place(), exit_box(world))))
        self.kept = self.world

    def _become(self, world: World, label: str, place: Place | None = None) -> None:
        if world is not self.world:
            (low, high), (least, most) = self.history.present.window, exit_box(world)
            window = np.minimum(low, least), np.maximum(high, most)
            self._turn(self.history.done(label, Kept(world, place or self.place, window)))

    def _turn(self, history: History[Kept]) -> None:
        # Judged first: what cannot be judged is not kept.
        self.assessment = assess(history.present.world, self.plane, history.present.window)
        self.history = history


_HALL = {
    "name": "my_robot", "engine": "spatial", "motion_pattern": "3R3T",
    "platform": {"mass": 20.0, "size": [0.6, 0.4, 0.3], "pose": {"position": [0.0, 0.0, 1.0]}},
    "cable_limits": {"tension": [5.0, 500.0]},
    "cables": [{"exit_point": [0.0, 0.0, 3.0], "anchor_point": [0.0, 0.0, 0.15]}],
    "scene": {"frame": {"lower": [-3.0, -2.0, 0.0], "upper": [3.0, 2.0, 3.0]}},
}
"""An empty hall: a frame, a load, and one cable to copy."""


def _new_base(world: World) -> dict[str, Any]:
    """A base beside the exit points, named after none of the others."""
    names = {base.name for base in world.robot.bases}
    name = next(f"base_{k}" for k in range(1, len(names) + 2) if f"base_{k}" not in names)
    x = float(world.robot.exit_points[:, 0].max()) + 1.0
    planar = world.robot.dimension == 2
    y = 0.0 if planar else float(np.mean(world.robot.exit_points[:, 1]))
    contacts = [[0.4, 0.0], [-0.4, 0.0]] if planar else [[0.4, 0.4], [-0.4, 0.4], [-0.4, -0.4],
                                                         [0.4, -0.4]]
    return {"name": name, "pose": {"position": [x, y], "heading": 0.0}, "mass": 50.0,
            "center_of_mass": [0.0, 0.5] if planar else [0.0, 0.0, 0.5], "footprint": contacts,
            "speed": {"rotation": 0.0, "translation": [0.2, 0.0]}}
