"""What a world file becomes: `World` with its robot, pose, scene and tasks."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..arrays import Array
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose

if TYPE_CHECKING:
    from ..mechanics.trajectory import Trajectory

Document = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Box:
    """A solid, upright box of the scene: center, edges [m], turn about the vertical [rad], "box" or "obstacle"."""

    position: Array
    size: Array
    yaw: float
    kind: str
    name: str = ""


@dataclass(frozen=True, eq=False)
class Scene:
    """What stands around the robot.

    frame : (2, d) corners of the outline that is drawn, or None [m]
    floor_height : [m]
    boxes : all that is solid, shelves taken apart into their boards
    """

    frame: Array | None
    floor_height: float
    boxes: tuple[Box, ...]


@dataclass(frozen=True, eq=False)
class Task:
    """What to do: "quintic" from ``start`` to ``end`` in ``duration`` [s] and ``hold`` [s] there, or "hold"."""

    kind: str
    start: Pose
    end: Pose
    duration: float
    hold: float = 0.0

    def trajectory(self) -> Trajectory:
        """The reference motion, without the hold at its end."""
        from ..mechanics.trajectory import quintic

        return quintic(self.start, self.end, self.duration)


@dataclass(frozen=True, eq=False, kw_only=True)
class PickAndPlace(Task):
    """Take a box from where it stands to its place: a job of many phases, see `picking`.

    box_size, box_mass : [m], [kg]
    box_position, place : (3,) center of the box before and after; its face is flush with the edge of its board [m]
    seat : (3,) center of a box that is drawn in, platform frame [m]
    stroke : (3,) from there to the box on its board, world axes, the platform level [m]
    tilt : (3,) roll, pitch, yaw at which the platform hooks and unhooks [rad]
    clearance : to the shelf as the platform moves along it [m]
    coupled : base name → (x, y, heading) of the base that drives away first, empty if none does [m, m, rad]
    aside : how far it keeps aside on its way, along its own y axis [m]
    """

    box_size: Array
    box_mass: float
    box_position: Array
    place: Array
    seat: Array
    stroke: Array
    tilt: Array
    clearance: float
    coupled: Mapping[str, tuple[float, float, float]]
    aside: float = 0.0

    def trajectory(self) -> Trajectory:
        raise InvalidInput("a pick_and_place task is no single motion: use cdprlab.fastkit.pick_and_place(world)")


@dataclass(frozen=True, eq=False)
class World:
    """A robot, where it starts, what is around it and what it shall do.

    >>> import cdprlab as cl
    >>> cl.load_world("caroca")
    World('caroca': Robot(3R3T, 8 cables, 150 kg), tasks default)
    """

    name: str
    title: str
    source: str
    robot: Robot
    pose: Pose
    scene: Scene
    tasks: dict[str, Task]
    document: Any = field(repr=False)

    @classmethod
    def from_dict(cls, document: Document, *, path: str = "world") -> World:
        """A world from the mapping a world file holds (see docs/world_file.md).

        Raises WorldError naming ``path``, line (where known), key and cable of every mistake.
        """
        from .reader import read_world

        return read_world(document, path)

    @classmethod
    def from_yaml(cls, text: str, *, path: str = "world") -> World:
        """A world from the text of a world file.

        Raises WorldError as `from_dict`, and for text that is no YAML.

        >>> import cdprlab as cl
        >>> World.from_yaml(cl.load_world("caroca").to_yaml()).robot.n_cables
        8
        """
        from .files import parsed
        from .reader import read_world

        return read_world(parsed(text, path), path)

    @property
    def engine(self) -> str:
        """"planar" (pymunk) or "spatial" (PyBullet)."""
        return "planar" if self.robot.dimension == 2 else "spatial"

    def task(self, name: str = "default") -> Task:
        """The task of that name; raises InvalidInput naming those there are."""
        if name not in self.tasks:
            raise InvalidInput(f"world {self.name!r} has no task {name!r}; there are {', '.join(self.tasks)}")
        return self.tasks[name]

    def save(self, path: str | Path) -> Path:
        """Write the world file as the world is now: a changed robot or pose too, comments of its file kept.

        Scene and tasks stay as they were read; a task that names no start begins at the saved pose.

        path : where to; raises InvalidInput if its folder does not exist
        """
        target = Path(path)
        if not target.parent.is_dir():
            raise InvalidInput(f"cannot save {target}: there is no folder {target.parent}")
        target.write_text(self.to_yaml(), encoding="utf-8")
        return target

    def to_yaml(self) -> str:
        """The text that `save` writes."""
        from .files import yaml_format
        from .writer import updated_document

        buffer = io.StringIO()
        yaml_format().dump(updated_document(self, World.from_dict), buffer)
        return buffer.getvalue()

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts and lists; ``World.from_dict(world.to_dict())`` is the same world."""
        from .mistakes import plain
        from .writer import updated_document

        return plain(updated_document(self, World.from_dict))

    def __repr__(self) -> str:
        return f"World({self.name!r}: {self.robot!r}, tasks {', '.join(self.tasks)})"
