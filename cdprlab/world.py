"""World files: YAML ↔ `World`. Every mistake is named by file, line, key and cable."""

from __future__ import annotations

import difflib
import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import Array, frozen
from .errors import InvalidInput, Location, WorldError
from .pose import Pose
from .robot import (
    Base,
    Cable,
    Elasticity,
    Platform,
    Robot,
    Winch,
    inertia_matrix,
    motion_pattern,
)
from .world_writer import styled, updated_document

if TYPE_CHECKING:
    from .trajectory import Trajectory

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
        from .trajectory import quintic

        return quintic(self.start, self.end, self.duration)


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
        return _Reader(document, path).world()

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
        buffer = io.StringIO()
        _yaml().dump(updated_document(self, World.from_dict), buffer)
        target.write_text(buffer.getvalue(), encoding="utf-8")
        return target

    def to_dict(self) -> dict[str, Any]:
        """Plain dicts and lists; ``World.from_dict(world.to_dict())`` is the same world."""
        return _plain(updated_document(self, World.from_dict))

    def __repr__(self) -> str:
        return f"World({self.name!r}: {self.robot!r}, tasks {', '.join(self.tasks)})"


def world_names() -> list[str]:
    """Names of the worlds that come with cdprlab.

    >>> "caroca" in world_names()
    True
    """
    return sorted(path.stem for path in _worlds_folder().glob("*.yaml"))


def load_world(name_or_path: str | Path) -> World:
    """A shipped world by name, or any world file by path (ending in .yaml or .yml).

    Raises WorldError for an unknown name or a file with mistakes in it.

    >>> load_world("caroca").robot.n_cables
    8
    """
    path = _world_path(name_or_path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise WorldError([f"cannot read {path}: {error.strerror}"]) from None
    except UnicodeDecodeError:
        raise WorldError([f"{path}: not a text file in UTF-8"]) from None
    return World.from_dict(_parse(text, str(path)), path=str(path))


def world_schema() -> dict[str, Any]:
    """JSON Schema of the world file.

    >>> world_schema()["title"]
    'WorldFile'
    """
    from .world_schema import WorldFile

    return WorldFile.model_json_schema()


class _Reader:
    """Turns one document into a World; remembers where it came from for its messages."""

    def __init__(self, document: Document, path: str) -> None:
        self.document = document
        self.path = path

    def world(self) -> World:
        parsed = self._parsed()
        try:
            return self._build(parsed)
        except InvalidInput as error:
            raise WorldError([self._line(error.location, error.message)]) from None

    def _parsed(self) -> Any:
        from pydantic import ValidationError

        from .world_schema import WorldFile

        if not isinstance(self.document, Mapping):
            raise WorldError([f"{self.path}: a world is a mapping of keys (name, platform, cables, …), "
                              f"got {_kind_of(self.document)}"])
        try:
            return WorldFile.model_validate(_plain(self.document))
        except ValidationError as errors:
            raise WorldError([self._line(location, _explain(error, location))
                              for error, location in self._distinct(errors.errors())]) from None

    def _build(self, file: Any) -> World:
        pattern = motion_pattern(file.motion_pattern)
        d = pattern.dimension
        engine = "planar" if d == 2 else "spatial"
        if file.engine not in (None, engine):
            raise InvalidInput(f"motion pattern {pattern.name} runs in the {engine} engine, not {file.engine!r}",
                               ("engine",))
        with _under("platform"):
            platform = _platform(file.platform, d)
        bases = tuple(_each("bases", file.bases, lambda block: _base(block, d)))
        _check_limits(file.cable_limits)
        cables = tuple(_each("cables", file.cables, lambda block: _cable(block, file.cable_limits, d)))
        robot = Robot(pattern, platform, cables, bases, file.gravity, _winch(file.winch), _elasticity(file.cable))
        with _under("platform", "pose"):
            pose = _pose(file.platform.pose, d)
        with _under("scene"):
            scene = _scene(file.scene, d)
        tasks = {"default": Task("hold", pose, pose, 2.0)}
        for name, block in file.tasks.items():
            with _under("tasks", name):
                tasks[name] = _task(block, pose, d)
        return World(file.name, file.title, file.source, robot, pose, scene, tasks, self._kept())

    def _kept(self) -> Any:
        """The document for saving: a file's own with its comments, or a copy nobody else can change."""
        return self.document if hasattr(self.document, "lc") else styled(_plain(self.document))

    # --- messages ---------------------------------------------------------------------------------
    def _distinct(self, errors: list[Any]) -> list[tuple[Any, Location]]:
        """The schema's errors with their places, unknown keys first, each mistake once."""
        # Pydantic puts the name of a union's member into the path; the document has no such key.
        found = [(error, tuple(_existing(self.document, error["loc"]))) for error in errors]
        found.sort(key=lambda pair: pair[0]["type"] != "extra_forbidden")
        misspelt = {(*place[:-1], guess) for error, place in found if error["type"] == "extra_forbidden"
                    for guess in _guesses(place)}
        kept: dict[Location, Any] = {}
        for error, place in found:
            # A value that fits no member of a union is told at its deepest place only.
            deeper = any(len(other) > len(place) and other[:len(place)] == place for _, other in found)
            if not deeper and not (error["type"] == "missing" and place in misspelt):
                kept.setdefault(place, error)
        return [(error, place) for place, error in kept.items()]

    def _line(self, location: Location, message: str) -> str:
        number = _line_number(self.document, location)
        place = f"{self.path}:{number}" if number else self.path
        where = _where(location)
        return f"{place}: {where}: {message}" if where else f"{place}: {message}"


# --- document → parts ---------------------------------------------------------------------------------
def _platform(block: Any, d: int) -> Platform:
    size = _sized(block.size, d, "size")
    zero = [0.0] * d
    center_of_mass, center = (np.array(_sized(getattr(block, key) or zero, d, key))
                              for key in ("center_of_mass", "center"))
    return Platform(block.mass, _inertia(block, size, d), center_of_mass, np.array(size), center)


def _inertia(block: Any, size: list[float], d: int) -> Any:
    if block.inertia is None:
        squares = np.square(size)
        inertia = block.mass / 12 * (squares.sum() - (squares if d == 3 else 0))
        return np.diag(inertia) if d == 3 else inertia
    if d == 2:
        if isinstance(block.inertia, list):
            raise InvalidInput("in the plane inertia is one number [kg m²], "
                               f"got {len(block.inertia)} numbers", ("inertia",))
        return block.inertia
    if not isinstance(block.inertia, list):
        raise InvalidInput("in space inertia is 3 numbers (principal) or 6 (xx yy zz xy xz yz) [kg m²], "
                           f"got the single number {block.inertia:g}", ("inertia",))
    return inertia_matrix(block.inertia, ("inertia",))


def _check_limits(defaults: Any) -> None:
    """Crossed limits are cable_limits' mistake, not the first cable's."""
    if defaults.tension and defaults.tension[0] > defaults.tension[1]:
        low, high = defaults.tension
        raise InvalidInput(f"tension limits are crossed: smallest {low:g} N > largest {high:g} N",
                           ("cable_limits", "tension"))


def _cable(block: Any, defaults: Any, d: int) -> Cable:
    tension = block.tension or defaults.tension
    if tension is None:
        raise InvalidInput("no tension limits: give the cable its own `tension: [min, max]` or all of them "
                           "`cable_limits: {tension: [min, max]}` [N]", ("tension",))
    speed = block.speed or defaults.speed or float("inf")
    exit_point, anchor_point = (_sized(getattr(block, key), d, key) for key in ("exit_point", "anchor_point"))
    return Cable(np.array(exit_point), np.array(anchor_point), tension[0], tension[1], speed, block.base)


def _base(block: Any, d: int) -> Base:
    center = _sized(block.center_of_mass or [0.0] * d, d, "center_of_mass")
    return Base(block.name, np.array(block.pose.position), block.pose.heading, block.mass, np.array(center),
                np.array(block.footprint), np.array([block.speed.rotation, *block.speed.translation]))


def _pose(block: Any, d: int) -> Pose:
    position = _sized(block.position, d, "position")
    if d == 2:
        if block.rpy is not None:
            raise InvalidInput("a planar pose takes angle, not rpy", ("rpy",))
        return Pose(position, angle=block.angle or 0.0)
    if block.angle is not None:
        raise InvalidInput("a spatial pose takes rpy, not angle", ("angle",))
    return Pose(position, rpy=block.rpy or [0.0, 0.0, 0.0])


def _winch(block: Any) -> Winch | None:
    if block is None:
        return None
    torque = float("inf") if block.torque is None else block.torque
    return Winch(block.drum_radius, block.gear_ratio, block.efficiency, torque,
                 block.friction.coulomb, block.friction.viscous)


def _elasticity(block: Any) -> Elasticity | None:
    return None if block is None else Elasticity(block.axial_stiffness, block.damping)


def _task(block: Any, pose: Pose, d: int) -> Task:
    if block.kind == "hold":
        with _under("at"):
            at = pose if block.at is None else _pose(block.at, d)
        return Task("hold", at, at, block.duration)
    with _under("from"):
        start = pose if block.start is None else _pose(block.start, d)
    with _under("to"):
        end = _pose(block.to, d)
    return Task("quintic", start, end, block.duration, block.hold)


def _scene(block: Any, d: int) -> Scene:
    frame = None
    if block.frame is not None:
        with _under("frame"):
            frame = frozen(np.array([_sized(getattr(block.frame, corner), d, corner) for corner in ("lower", "upper")]))
    boxes = [box for kind, key in (("box", "boxes"), ("obstacle", "obstacles"))
             for box in _each(key, getattr(block, key), lambda entry, kind=kind: _box(entry, kind, d))]
    if d == 2 and block.shelves:
        raise InvalidInput("a planar scene has no shelves; use boxes", ("shelves",))
    boxes += [board for shelf in block.shelves for board in _boards(shelf)]
    return Scene(frame, block.floor.height if block.floor else 0.0, tuple(boxes))


def _box(block: Any, kind: str, d: int) -> Box:
    return Box(np.array(_sized(block.position, d, "position")), np.array(_sized(block.size, d, "size")),
               block.yaw, kind, block.name)


def _boards(shelf: Any) -> Iterator[Box]:
    """A shelf's boards and its two side walls, 2 cm thick."""
    thickness = 0.02
    depth, width, height = shelf.size
    c, s = np.cos(shelf.yaw), np.sin(shelf.yaw)
    parts = [((0.0, side * (width - thickness) / 2, height / 2), (depth, thickness, height)) for side in (-1, 1)]
    parts += [((0.0, 0.0, level - thickness / 2), (depth, width, thickness)) for level in shelf.levels]
    for (x, y, z), size in parts:
        place = np.array([shelf.position[0] + c * x - s * y, shelf.position[1] + s * x + c * y, z])
        yield Box(place, np.array(size), shelf.yaw, "box", shelf.name)


def _sized(values: list[float], d: int, key: str) -> list[float]:
    if len(values) != d:
        raise InvalidInput(f"must be {d} numbers in {'the plane' if d == 2 else 'space'}, got {len(values)}", (key,))
    return values


def _each(key: str, blocks: list[Any], build: Any) -> Iterator[Any]:
    for i, block in enumerate(blocks):
        with _under(key, i):
            yield build(block)


@contextmanager
def _under(*prefix: str | int) -> Iterator[None]:
    try:
        yield
    except InvalidInput as error:
        raise error.below(*prefix) from None


# --- reading and locating -----------------------------------------------------------------------------
def _yaml() -> Any:
    from ruamel.yaml import YAML

    yaml = YAML(typ="rt")
    yaml.width = 120
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml


def _parse(text: str, path: str) -> Any:
    from ruamel.yaml.constructor import DuplicateKeyError
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        return _yaml().load(text)
    except DuplicateKeyError as error:
        key = str(error.problem).split('"')[1]
        where = _where((*_cable_at(text, error.problem_mark.index), key))
        raise WorldError([f"{path}:{error.problem_mark.line + 1}: {where}: this key stands here twice; "
                          "keep one"]) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f":{mark.line + 1}" if mark else ""
        raise WorldError([f"{path}{line}: not valid YAML: {error.problem or error.context}"]) from None
    except YAMLError as error:
        raise WorldError([f"{path}: not valid YAML: {str(error).splitlines()[0]}"]) from None


def _cable_at(text: str, index: int) -> Location:
    """("cables", i) of the cable in whose block a character stands; () outside of them."""
    for key, value in _yaml().compose(text).value:
        if key.value == "cables" and isinstance(value.value, list):
            for i, block in enumerate(value.value):
                if block.start_mark.index <= index < block.end_mark.index:
                    return ("cables", i)
    return ()


def _worlds_folder() -> Path:
    """Beside the code in an installed wheel, beside the package in a checkout."""
    inside = Path(__file__).parent / "worlds"
    return inside if inside.is_dir() else Path(__file__).parent.parent / "worlds"


def _world_path(name_or_path: str | Path) -> Path:
    given = Path(name_or_path)
    if given.suffix in (".yaml", ".yml"):
        if not given.is_file():
            raise WorldError([f"there is no world file {given}"])
        return given
    path = _worlds_folder() / f"{name_or_path}.yaml"
    if len(given.parts) != 1 or not path.is_file():
        close = difflib.get_close_matches(str(name_or_path), world_names(), n=1)
        hint = f"did you mean {close[0]!r}? " if close else ""
        raise WorldError([f"unknown world {str(name_or_path)!r}; {hint}there are {', '.join(world_names())}; "
                          "or give the path of a .yaml file"])
    return path


def _plain(value: Any) -> Any:
    """ruamel's commented containers and numbers as plain Python."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return kind(value)
    return value.item() if isinstance(value, np.generic) else value


def _existing(document: Any, location: Location) -> Iterator[str | int]:
    """The parts of a pydantic location that are keys or indices of the document, and a missing last key."""
    node = document
    for place, part in enumerate(location):
        is_index = isinstance(node, list | tuple) and isinstance(part, int) and part < len(node)
        if is_index or (isinstance(node, Mapping) and part in node):
            node = node[part]
            yield part
        elif place == len(location) - 1 and isinstance(node, Mapping) and isinstance(part, str):
            yield part


def _line_number(document: Any, location: Location) -> int | None:
    """Line (from 1) of the deepest part of ``location`` the document has; None where it has no lines."""
    node, line = document, None
    if hasattr(document, "lc"):
        line = document.lc.line + 1
    for part in location:
        if not hasattr(node, "lc") or node.lc.data is None or part not in node.lc.data:
            break
        line = node.lc.data[part][0] + 1
        node = node[part]
    return line


def _where(location: Location) -> str:
    """("cables", 2, "tension") as "cable 3: tension"."""
    if location[:1] == ("cables",) and len(location) > 1 and isinstance(location[1], int):
        rest = _where(location[2:])
        return f"cable {location[1] + 1}" + (f": {rest}" if rest else "")
    text = ""
    for part in location:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _explain(error: Any, location: Location) -> str:
    kind, given, context = error["type"], error.get("input"), error.get("ctx", {})
    if kind == "extra_forbidden":
        return _unknown_key(location)
    if kind == "missing":
        return "missing; a world needs it"
    if kind == "finite_number":
        return f"must be a finite number, got {given}"
    if kind in _WANTED:
        return f"must be {_WANTED[kind]}, got {'nothing' if given is None else repr(given)}"
    if kind in ("too_short", "too_long"):
        count = context.get("min_length", context.get("max_length"))
        bound = "at least" if kind == "too_short" else "at most"
        return f"must have {bound} {count} {'entry' if count == 1 else 'entries'}, got {context['actual_length']}"
    if kind.startswith("union_tag"):
        return f"kind must be quintic or hold, got {context.get('tag', 'none')}"
    message = error["msg"].replace("Input should be", "must be").replace("greater than or equal to", "at least")
    return f"{message}, got {given!r}" if isinstance(given, int | float | str) else message


_WANTED = {"float_type": "a number", "list_type": "a list", "string_type": "text", "dict_type": "a block of keys",
           "model_type": "a block of keys", "model_attributes_type": "a block of keys",
           "string_pattern_mismatch": "one word of letters, digits, _ and -"}


def _unknown_key(location: Location) -> str:
    hint = "".join(f"did you mean {guess!r}? " for guess in _guesses(location))
    return f"unknown key; {hint}allowed here: {', '.join(_allowed_keys(location[:-1]))}"


def _guesses(location: Location) -> list[str]:
    """The allowed key that looks most like the unknown one at ``location``, if any does."""
    return difflib.get_close_matches(str(location[-1]), _allowed_keys(location[:-1]), n=1)


def _kind_of(document: Any) -> str:
    if document is None:
        return "an empty file"
    return "a list" if isinstance(document, list | tuple) else repr(document)


def _allowed_keys(location: Location) -> list[str]:
    """Keys of the schema block at ``location``."""
    from typing import get_args

    from pydantic import BaseModel

    from .world_schema import WorldFile

    def models(annotation: Any) -> Iterator[Any]:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            yield annotation
        for argument in get_args(annotation):
            yield from models(argument)

    blocks: list[Any] = [WorldFile]
    for part in location:
        if isinstance(part, int):
            continue
        fields = [f for block in blocks for key, f in block.model_fields.items() if part in (key, f.alias)]
        if fields:
            blocks = [found for f in fields for found in models(f.annotation)]
    return sorted({f.alias or key for block in blocks for key, f in block.model_fields.items()})
