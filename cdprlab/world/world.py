"""`World`, and where it comes from: the worlds that come with cdprlab, files, texts and mappings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import checked, frozen_dataclass
from ..errors import InvalidInput, WorldError, quoted, shortened, under
from ..robot import Robot
from ..robot.pose import Pose
from .files import checked_path, write_text
from .model import NAME, Scene, Task, check_pose

# Blocks and documents (pydantic, ruamel) are imported when needed: they would double the time
# of `import cdprlab`.


@frozen_dataclass
class World:
    """A robot, where it starts, what is around it and what it shall do.

    errors : by how much it is off the world it was drawn from, as `perturbed` says; not saved

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
    tasks: Mapping[str, Task]
    document: Mapping[str, Any] | None = None
    errors: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not NAME.fullmatch(self.name):
            raise InvalidInput(f"a world's name must be one word of letters, digits, _ and -, got {quoted(self.name)}",
                               ("name",))
        check_pose(self.pose, self.robot, ("platform", "pose"))
        for name, task in self.tasks.items():
            with under("tasks", name):
                task.check(self.robot)

    @classmethod
    def from_dict(cls, document: Mapping[str, Any], *, path: str = "world") -> World:
        """A world from the mapping a world file holds (see docs/world_file.md).

        Raises WorldError naming ``path``, line (where known), key and cable of every mistake.
        """
        from .reader import read

        return cls(**read(document, path))

    @classmethod
    def from_yaml(cls, text: str, *, path: str = "world") -> World:
        """A world from the text of a world file.

        Raises WorldError as `from_dict`, and for text that is no YAML.

        >>> import cdprlab as cl
        >>> World.from_yaml(cl.load_world("caroca").to_yaml()).robot.n_cables
        8
        """
        from .document import parsed
        from .reader import read

        return cls(**read(parsed(text, path), path))

    @property
    def engine(self) -> str:
        """"planar" (pymunk) or "spatial" (PyBullet)."""
        return self.robot.pattern.engine

    def idle_keys(self, cables: str = "tension", *, driven: bool = False, bodies: bool = False,
                  sensed: bool = False) -> tuple[str, ...]:
        """Keys of its file that a run with these cables takes no notice of; methods, sets and jobs may.

        cables, bodies : as `run` takes them
        driven, sensed : whether it is given base_speeds, and a real world or sensors

        >>> load_world("fastkit_suspended").idle_keys("elastic", bodies=True)
        ('bases.speed',)
        """
        robot, wound = self.robot, cables in ("length", "elastic")
        drawn_only = ("bases.mass", "bases.center_of_mass", "bases.footprint")
        idle = {"cable": robot.elasticity is not None and cables != "elastic",
                "linear_density": robot.linear_density > 0,
                "length_offset": robot.length_offsets.any() and not sensed,
                "tension": cables == "length",
                "speed": not wound and any(np.isfinite(cable.speed_max) for cable in robot.cables),
                "bases.speed": robot.bases and not driven,
                **dict.fromkeys(drawn_only, robot.bases and not bodies)}
        return tuple(key for key, unheard in idle.items() if unheard)

    def task(self, name: str = "default") -> Task:
        """The task of that name; raises InvalidInput naming those there are."""
        if name not in self.tasks:
            raise InvalidInput(f"world {self.name!r} has no task {quoted(name)}; there are "
                               f"{shortened(', '.join(self.tasks))}")
        return self.tasks[name]

    def save(self, path: str | Path) -> Path:
        """Write the world file as the world is now: a changed robot or pose too, comments of its file kept.

        A changed scene is written with its shelves taken apart; a task that names no start begins
        at the saved pose.

        path : where to
        Raises InvalidInput if its folder does not exist, CannotWrite where the file cannot be
        written.
        """
        return write_text(checked_path(path), self.to_yaml())

    def to_yaml(self) -> str:
        """The text that `save` writes."""
        from .document import dumped
        from .writer import updated_document

        return dumped(updated_document(self))

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts and lists; ``World.from_dict(world.to_dict())`` is the same world."""
        from .document import plain
        from .writer import updated_document

        return plain(updated_document(self))

    def __repr__(self) -> str:
        return f"World({self.name!r}: {self.robot!r}, tasks {', '.join(self.tasks)})"


def world_names() -> list[str]:
    """Names of the worlds that come with cdprlab.

    >>> "caroca" in world_names()
    True
    """
    return sorted(path.stem for path in shipped("worlds").glob("*.yaml"))


@checked
def load_world(name_or_path: str | Path) -> World:
    """A shipped world by name, or any world file by path (ending in .yaml or .yml).

    Raises WorldError for an unknown name or a file with mistakes in it.

    >>> load_world("caroca").robot.n_cables
    8
    """
    from .document import LONGEST

    told = shortened(str(name_or_path))
    try:
        path = _world_path(name_or_path)
        told = shortened(str(path))
        with path.open(encoding="utf-8") as file:
            text = file.read(LONGEST + 1)   # what is longer is refused
    except OSError as error:
        raise WorldError([f"cannot read {told}: {error.strerror}"]) from None
    except UnicodeDecodeError:
        raise WorldError([f"{told}: not a text file in UTF-8"]) from None
    return World.from_yaml(text, path=told)


def world_schema() -> dict[str, Any]:
    """JSON Schema of the world file.

    >>> world_schema()["title"]
    'WorldFile'
    """
    from .blocks import WorldFile

    return WorldFile.model_json_schema()


def shipped(folder: str) -> Path:
    """A folder that comes along: beside the code in an installed wheel, beside the package in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / folder
    return inside if inside.is_dir() else package.parent / folder


def _world_path(name_or_path: str | Path) -> Path:
    given = Path(name_or_path)
    if "://" in str(name_or_path):
        raise WorldError([f"world files are not read from addresses: save {shortened(str(name_or_path))} "
                          "and give the file's path"])
    if given.suffix.lower() in (".yaml", ".yml"):
        if not given.is_file():
            raise WorldError([f"there is no world file {shortened(str(given))}"])
        return given
    path = shipped("worlds") / f"{name_or_path}.yaml"
    if len(given.parts) != 1 or not path.is_file():
        from difflib import get_close_matches

        close = get_close_matches(str(name_or_path), world_names(), n=1)
        hint = f"did you mean {close[0]!r}? " if close else ""
        raise WorldError([f"unknown world {quoted(str(name_or_path))}; {hint}there are {', '.join(world_names())}; "
                          "or give the path of a .yaml file"])
    return path
