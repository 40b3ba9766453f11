"""What can be edited, group by group: rows of fields for keys of the world file, whose schema tells type and unit."""

import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ...errors import InvalidInput, Location, quoted
from ...robot import MOTION_PATTERNS
from ...world import World
from ...world.blocks import keys_at
from .edits import edited, on_base, value_at


class Field(NamedTuple):
    """One thing to type or choose.

    path : where it stands in the world file
    label : short, within its row
    unit : of what is typed
    kind : "number", "text" (numbers, or nothing to leave it out), "points", "choice"
    options : of a choice
    """

    path: Location
    label: str
    unit: str
    kind: str = "number"
    options: tuple[Any, ...] = ()

    @property
    def scale(self) -> float:
        """The file's value of 1 as typed: degrees are typed, radians are kept."""
        return float(np.pi / 180) if self.unit == "deg" else 1.0


class Row(NamedTuple):
    """Fields side by side under one name."""

    label: str
    fields: tuple[Field, ...]


class Place(NamedTuple):
    """Which cable and which base are being edited, from 0."""

    cable: int = 0
    base: int = 0


GROUPS = {
    "cables": ("cables.{cable}.exit_point", "cables.{cable}.anchor_point",
               "cables.{cable}.tension",
               "cables.{cable}.speed", "cables.{cable}.base", "cables.{cable}.pulley"),
    "all cables": ("cable_limits", "cable.axial_stiffness"),
    "platform": ("platform.mass", "platform.inertia", "platform.center_of_mass",
                 "platform.size", "platform.center"),
    "start": ("platform.pose", "motion_pattern", "gravity", "scene.frame"),
    "bases": ("bases.{base}.pose", "bases.{base}.mass", "bases.{base}.center_of_mass",
              "bases.{base}.footprint",
              "bases.{base}.speed"),
    "task": ("tasks.default.to", "tasks.default.duration"),
}
"""Group → the keys it shows; of a block all that a world has."""

LEFT_OUT = {"inertia": "of a uniform box", "speed": "unlimited",
            "axial_stiffness": "does not stretch", "base": "none"}
"""Keys that may be left empty → what that means."""

_KINDS = {"base": "choice", "motion_pattern": "choice", "footprint": "points", "axis": "text", "inertia": "text",
          "speed": "text", "axial_stiffness": "text"}
"""Of fields that are no numbers."""

_LABELS = {"exit_point": "exit point A", "anchor_point": "anchor point B",
           "tension": "tension limits",
           "speed": "speed limit", "base": "on base", "radius": "pulley radius", "axis": "pulley axis",
           "axial_stiffness": "stiffness EA",
           "center": "box center",
           "rpy": "orientation", "lower": "frame, lower", "upper": "frame, upper",
           "rotation": "turn speed",
           "translation": "drive speed", "duration": "lasts"}
_PARTS = {"tension": ("min", "max"), "rpy": ("roll", "pitch", "yaw"),
          "translation": ("ρ₁", "ρ₂")}


def rows(world: World, group: str, place: Place) -> list[Row]:
    """The rows of a group for a world as it is.

    group : of `GROUPS`

    >>> import cdprlab as cl
    >>> [row.label for row in rows(cl.load_world("planar_rigid"), "cables", Place())]
    ['exit point A', 'anchor point B', 'tension limits', 'speed limit']
    """
    index = {"{cable}": place.cable, "{base}": place.base}
    return [row for words in GROUPS[group]
            for row in _rows(world, tuple(index.get(part, part) for part in words.split(".")))]


def shown(field: Field, world: World) -> Any:
    """What stands in a field: a number, a choice, or text.

    >>> import cdprlab as cl
    >>> shown(Field(("platform", "inertia"), "", "kg m²", "text"), cl.load_world("planar_rigid"))
    ''
    """
    value = value_at(world, field.path)
    if field.kind == "choice":
        return value
    if value is None:
        return ""
    return "; ".join(", ".join(f"{x:.10g}" for x in point) for point in np.atleast_2d(value) / field.scale)


def typed(world: World, field: Field, entry: Any, mirrored: str = "") -> World:
    """The world with what was typed into a field; the same world if that is what stood there.

    mirrored : see `edited`
    Raises WorldError naming its place in the world file, InvalidInput for what is no number.
    """
    if entry == shown(field, world):
        return world
    if field.path[-1] == "base":
        return on_base(world, int(field.path[1]), entry)
    value = entry if field.kind == "choice" else _value(field, str(entry))
    if field.kind == "number":
        if value is None:
            raise InvalidInput("nothing stands there; type a number")
        if not isinstance(value, float):
            raise InvalidInput(f"{quoted(entry)} is no number; type one, as 0.5")
        if not np.isfinite(value):
            raise InvalidInput(f"{quoted(entry)} is endless; type an ordinary number")
    if field.path[-1] == "axis" and isinstance(value, list) and np.linalg.norm(value) > 0:   # any length says a way
        value = (np.array(value) / np.linalg.norm(value)).tolist()
    if value is None and field.path == ("cable", "axial_stiffness"):   # what does not stretch does not ring
        world = edited(world, ("cable", "damping"), 0.0)
    return edited(world, field.path, value, mirrored)


def _value(field: Field, text: str) -> Any:
    """What was typed, as the file has it; words stay words, which the file refuses by name."""
    points = [re.sub(r"[,\[\]]", " ", part).replace("−", "-").split()
              for part in text.split(";") if part.strip()]
    try:
        numbers = [[float(word) * field.scale for word in point] for point in points]
    except ValueError:
        return text
    if field.kind == "points" or len(numbers) > 1:
        return numbers
    if not numbers:
        return None
    return numbers[0] if len(numbers[0]) > 1 else numbers[0][0]


def _rows(world: World, path: Location) -> Iterator[Row]:
    """The row of a key, or those of a block; none for what the world does not have."""
    value, key = value_at(world, path), str(path[-1])
    if isinstance(value, dict):
        for inner in value:
            yield from _rows(world, (*path, inner))
        return
    if (value is None and key not in LEFT_OUT) or (key == "base" and not world.robot.bases):
        return
    told = keys_at(path[:-1])[key].get("description", "")
    unit = "".join(re.findall(r"\[(.*?)\]", told)).replace("rad", "deg")
    kind = _KINDS.get(key, "number")
    fields = [Field(path, "", unit, kind, _options(world, key))]
    if kind == "number" and isinstance(value, list):
        fields = [Field((*path, k), name, unit) for k, (name, _) in enumerate(zip(_parts(world, key), value))]
    if fields:
        yield Row(_LABELS.get(key, key.replace("_", " ")), tuple(fields))


def _options(world: World, key: str) -> tuple[Any, ...]:
    if key == "base":
        return None, *(base.name for base in world.robot.bases)
    if key == "motion_pattern":
        return tuple(name for name, pattern in MOTION_PATTERNS.items()
                     if pattern.dimension == world.robot.dimension)
    return ()


def _parts(world: World, key: str) -> tuple[str, ...]:
    """Names of a vector's numbers; where the motion pattern leaves anchor points no choice there is nothing to type."""
    pattern = world.robot.pattern
    if key == "anchor_point" and (not pattern.turns or pattern.name == "2R3T"):
        return ("x",) if pattern.turns else ()
    return _PARTS.get(key, tuple("xyz"))
