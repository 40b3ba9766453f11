"""A design in the making: the last good robot, what it is worth, and the way back."""

from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import CdprError, InvalidInput, Location
from ...robot import Robot
from ...run import Run, run
from ...run.controllers import ComputedTorque
from ...world import World, load_world
from ...world.document import parsed, place_text, plain
from ..brief import Brief
from .assessment import PLANES, Assessment, Window, assess, exit_box
from .edits import contents, edited, opened, with_entry, without_entry
from .fields import Field, Place, typed
from .history import History

_FILE = Path(__file__).with_name("beginnings.yaml")
BEGINNINGS = plain(parsed(_FILE.read_text(encoding="utf-8"), _FILE.name))
"""An empty hall, and bases to be put beside exit points, as world files say them."""


@dataclass
class Kept:
    """What undo brings back.

    place : which cable and base were being edited last
    window : corners of the slice; it grows where exit points leave it, and else stays put [m]
    """

    world: World
    place: Place
    window: Window


class DesignSession:
    """Edits of one world; each is judged, and a bad one raises CdprError and changes nothing.

    world : where to begin
    brief : judged with every design, if there is one
    kept : the world as it was opened or saved last, None for a new one
    mirrored : axes at which edits of a cable are mirrored, as in "xy"

    >>> import cdprlab as cl
    >>> session = DesignSession(cl.load_world("caroca"))
    >>> session.edit(("platform", "mass"), 300.0)
    >>> session.edit(("cables", 2, "tension", 0), 20000.0)
    Traceback (most recent call last):
    ...
    cdprlab.errors.WorldError: cable 3: tension: tension limits are crossed: smallest 20000 N > largest 10000 N
    >>> session.undo()
    >>> session.world.robot.mass
    150.0
    """

    kept: World | None

    def __init__(self, world: World, brief: Brief | None = None) -> None:
        self.history: History[Kept] = History(())
        self.plane, self.mirrored = PLANES[0], ""
        self.brief = brief
        self.flown: Run | None = None
        self._open(opened(world), "")

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
    def edit(self, path: Location, value: Any) -> None:
        """Another value at a place of the world file."""
        self._become(edited(self.world, path, value, self.mirrored), place_text(path))

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
                why = why.removeprefix(f"{place_text(field.path[:depth])}: ")
            raise InvalidInput(f"{name}: {why}", field.path) from error
        self._become(world, name)

    def add(self, kind: str) -> None:
        """One more at the end, which is then edited: a copy of this cable, or a base beside the exit points.

        kind : "cables" or "bases"; cables are given to a base one by one
        """
        entries = contents(self.world)[kind]
        more = entries[self.place.cable] if kind == "cables" else _new_base(self.world.robot)
        self._become(with_entry(self.world, kind, more), f"{kind[:-1]} {len(entries) + 1} added",
                     self.place._replace(**{kind[:-1]: len(entries)}))

    def remove(self, kind: str) -> None:
        """Without the cable or base being edited; those after it move up."""
        at = getattr(self.place, kind[:-1])
        if not contents(self.world)[kind]:
            raise InvalidInput(f"this robot has no {kind} to remove", (kind,))
        self._become(without_entry(self.world, kind, at), f"{kind[:-1]} {at + 1} removed",
                     self.place._replace(**{kind[:-1]: max(at - 1, 0)}))

    def frame_exits(self) -> None:
        """A frame around all exit points, down to the floor."""
        frame = dict(zip(("lower", "upper"), exit_box(self.world)))
        self._become(edited(self.world, ("scene", "frame"), frame), "frame around the exit points")

    def make_motion(self) -> None:
        """A default task that moves: a little way up, which may be changed then."""
        pose = contents(self.world)["platform"]["pose"]
        *level, height = pose["position"]
        task = {"kind": "quintic", "to": pose | {"position": [*level, height + 0.3]},
                "duration": 3.0}
        self._become(edited(self.world, ("tasks", "default"), task), "task")

    def turn_to(self, place: Place) -> None:
        """Edit another cable or base; nothing to undo."""
        self.history.present.place = place

    def look_at(self, plane: str) -> None:
        """Another plane for the slice."""
        self.plane = plane
        self._turn(self.history)

    # --- files ------------------------------------------------------------------------------------------------
    def new(self, name: str = "") -> None:
        """A world of one's own in place of this one: a copy of a shipped one, or an empty hall; it can be undone."""
        document = load_world(name).to_dict() if name else BEGINNINGS["hall"]
        copy = {"name": "my_robot", "title": f"My robot, from {name}" if name else "My robot"}
        self._open(World.from_dict(document | copy), "new robot")
        self.kept = None

    def load(self, name_or_path: str) -> None:
        """A shipped world by name or a world file by path, in place of this one; it can be undone."""
        self._open(opened(load_world(name_or_path)), f"{name_or_path} loaded")

    def read(self, text: str, name: str = "world file") -> None:
        """A world from the text of a world file, in place of this one; mistakes are named by line."""
        self._open(World.from_yaml(text, path=name), f"{name} read")

    def save(self, path: str) -> None:
        """Write the world file."""
        target = Path(path.strip()).expanduser()
        if target.suffix not in (".yaml", ".yml"):
            raise InvalidInput(f"a world file ends in .yaml, got {path.strip() or 'nothing'!r}")
        self.world.save(target)
        self.kept = self.world

    def simulate(self, method: str = "quadratic_program", **gains: float) -> None:
        """The default task in the engine by computed torque; what was flown is ``flown``.

        method : tension distribution
        gains : of `ComputedTorque`
        """
        self.flown = None
        self.flown = run(self.world, method=method, controller=ComputedTorque(**gains))

    # --- the way back -----------------------------------------------------------------------------------------
    def undo(self) -> None:
        """Before the last edit."""
        self._turn(self.history.moved(-1))

    def redo(self) -> None:
        """The edit undone last, again."""
        self._turn(self.history.moved(1))

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
        self.assessment: Assessment = assess(history.present.world, self.plane, history.present.window)
        self.history = history


def _new_base(robot: Robot) -> dict[str, Any]:
    """A base beside the exit points, named after none of the others."""
    names = {base.name for base in robot.bases}
    name = next(name for k in count(1) if (name := f"base_{k}") not in names)
    planar, exits = robot.dimension == 2, robot.exit_points
    beside = np.array([exits[:, 0].max() + 1.0, 0.0 if planar else exits[:, 1].mean()])
    return {"name": name, "pose": {"position": beside.tolist(), "heading": 0.0},
            **BEGINNINGS["base in the plane" if planar else "base"]}
