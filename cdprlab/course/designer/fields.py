"""What can be edited, group by group: every field knows its place in the world file, its unit and how it is typed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ...errors import InvalidInput
from ...robot import MOTION_PATTERNS
from ...world import World
from ...world.document import plain
from .edits import Path, edited, field_name, on_base, value_at

DEGREE = float(np.pi / 180)


class Field(NamedTuple):
    """One thing to type or choose.

    path : where it stands in the world file
    label : short, within its row
    unit : of what is typed
    kind : "number", "maybe" (a number, or nothing to leave it out), "numbers" (several, or nothing), "points", "choice"
    step : of an arrow key
    scale : file value of 1 as typed: degrees are typed, radians are kept
    options : of a choice
    removes : what is left out with it; default itself
    """

    path: Path
    label: str
    unit: str = ""
    kind: str = "number"
    step: float = 0.05
    scale: float = 1.0
    options: tuple[Any, ...] = ()
    removes: Path = ()


class Row(NamedTuple):
    """Fields side by side under one name."""

    label: str
    fields: tuple[Field, ...]


class Place(NamedTuple):
    """Which cable and which base are being edited, from 0."""

    cable: int = 0
    base: int = 0


FIRST = Place()

GROUPS = ("cables", "all cables", "platform", "start", "bases", "task")


def rows(world: World, group: str, place: Place = FIRST) -> list[Row]:
    """The rows of a group for a world as it is.

    Raises InvalidInput for an unknown group.

    >>> import cdprlab as cl
    >>> [row.label for row in rows(cl.load_world("planar_rigid"), "cables")]
    ['exit point A', 'anchor point B', 'tension limits', 'speed limit']
    """
    makers = {"cables": _cable, "all cables": _all_cables, "platform": _platform, "start": _start, "bases": _base,
              "task": _task}
    if group not in makers:
        raise InvalidInput(f"there is no group {group!r}; there are {', '.join(makers)}")
    return list(makers[group](world, place))


def shown(field: Field, world: World) -> Any:
    """What stands in a field: a number, a choice, or text.

    >>> import cdprlab as cl
    >>> shown(Field(("platform", "inertia"), "", kind="numbers"), cl.load_world("planar_rigid"))
    ''
    """
    if field.kind in ("numbers", "maybe") and _left_out(field.path, world):
        return ""
    value = value_at(world, field.path)
    if field.kind == "choice":
        return value
    if field.kind == "number":
        return float(f"{float(value) / field.scale:.10g}")
    if value is None:
        return ""
    if field.kind == "points":
        return "; ".join(", ".join(f"{x:.10g}" for x in point) for point in value)
    return ", ".join(f"{x:.10g}" for x in np.ravel(value))


def typed(world: World, field: Field, entry: Any) -> World:
    """The world with what was typed into a field; the same world if that is what stood there.

    Raises InvalidInput naming the field, WorldError naming its place in the world file.
    """
    if entry == shown(field, world):
        return world
    if field.path[-1] == "base":
        return on_base(world, int(field.path[1]), entry)
    value = _value(field, entry)
    if value is None and field.removes:
        return edited(world, field.removes, None)
    return edited(world, field.path, value)


def _value(field: Field, entry: Any) -> Any:
    if field.kind == "choice":
        return entry
    if field.kind == "points":
        return [_numbers(field, part) for part in str(entry).split(";") if part.strip()]
    found = _numbers(field, str(entry))
    if not found and field.kind in ("maybe", "numbers"):
        return None
    if len(found) == 1 and (field.kind != "numbers" or field.path[-1] == "inertia"):
        return found[0] * field.scale
    if field.kind == "numbers" and found:
        return found
    raise InvalidInput(f"{field_name(field.path)}: must be one number, got {str(entry)!r}", field.path)


def _numbers(field: Field, text: str) -> list[float]:
    words = text.replace(",", " ").replace("[", " ").replace("]", " ").replace("−", "-").split()
    try:
        return [float(word) for word in words]
    except ValueError:
        wanted = "numbers, separated by commas" if field.kind in ("numbers", "points") else "a number"
        raise InvalidInput(f"{field_name(field.path)}: must be {wanted}, got {text!r}", field.path) from None


def _left_out(path: Path, world: World) -> bool:
    """Whether the world's own file does not mention it."""
    node = plain(world.document)
    for part in path:
        if part == "cable_limits" or (isinstance(part, int) and part >= len(node)):
            return value_at(world, path) is None
        node = node[part] if isinstance(part, int) else node.get(part)
        if node is None:
            # A cable's speed may come from cable_limits.
            return path[0] != "cables" or value_at(world, path) is None
    return False


# --- groups ---------------------------------------------------------------------------------------------------
def _axes(world: World) -> str:
    return "xyz"[:world.robot.dimension]


def _vector(path: Path, axes: str, unit: str = "m", step: float = 0.05) -> tuple[Field, ...]:
    return tuple(Field((*path, k), axis, unit, step=step) for k, axis in enumerate(axes))


def _cable(world: World, place: Place) -> Iterator[Row]:
    at: Path = ("cables", place.cable)
    yield Row("exit point A", _vector((*at, "exit_point"), _axes(world)))
    # Where the motion pattern leaves anchor points no choice there is nothing to type.
    pattern = world.robot.pattern
    free = "" if not pattern.turns else "x" if pattern.name == "2R3T" else _axes(world)
    if free:
        yield Row("anchor point B", _vector((*at, "anchor_point"), free))
    yield Row("tension limits", _limits((*at, "tension")))
    yield Row("speed limit", (Field((*at, "speed"), "", "m/s", "maybe"),))
    if world.robot.bases:
        names = (None, *(base.name for base in world.robot.bases))
        yield Row("on base", (Field((*at, "base"), "", kind="choice", options=names),))


def _limits(path: Path) -> tuple[Field, ...]:
    return Field((*path, 0), "min", "N", step=1.0), Field((*path, 1), "max", "N", step=10.0)


def _all_cables(world: World, _: Place) -> Iterator[Row]:
    yield Row("tension limits", _limits(("cable_limits", "tension")))
    yield Row("speed limit", (Field(("cable_limits", "speed"), "", "m/s", "maybe"),))
    yield Row("stiffness EA", (Field(("cable", "axial_stiffness"), "", "N", "maybe", removes=("cable",)),))


def _platform(world: World, _: Place) -> Iterator[Row]:
    at, axes = ("platform",), _axes(world)
    yield Row("mass", (Field((*at, "mass"), "", "kg", step=1.0),))
    yield Row("inertia", (Field((*at, "inertia"), "", "kg m²", "numbers"),))
    yield Row("center of mass", _vector((*at, "center_of_mass"), axes, step=0.01))
    yield Row("size", _vector((*at, "size"), axes))
    yield Row("box center", _vector((*at, "center"), axes))


def _start(world: World, _: Place) -> Iterator[Row]:
    yield from _pose(("platform", "pose"), world)
    patterns = tuple(name for name, pattern in MOTION_PATTERNS.items() if pattern.dimension == world.robot.dimension)
    yield Row("motion pattern", (Field(("motion_pattern",), "", kind="choice", options=patterns),))
    yield Row("gravity", (Field(("gravity",), "", "m/s²", step=0.01),))
    if world.scene.frame is not None:
        yield Row("frame, lower", _vector(("scene", "frame", "lower"), _axes(world)))
        yield Row("frame, upper", _vector(("scene", "frame", "upper"), _axes(world)))


def _pose(path: Path, world: World) -> Iterator[Row]:
    yield Row("position of P", _vector((*path, "position"), _axes(world)))
    if world.robot.dimension == 2:
        yield Row("angle", (Field((*path, "angle"), "", "deg", step=1.0, scale=DEGREE),))
    else:
        yield Row("orientation", tuple(Field((*path, "rpy", k), name, "deg", step=1.0, scale=DEGREE)
                                       for k, name in enumerate(("roll", "pitch", "yaw"))))


def _base(world: World, place: Place) -> Iterator[Row]:
    if not world.robot.bases:
        return
    at: Path = ("bases", place.base)
    yield Row("position", _vector((*at, "pose", "position"), "xy"))
    yield Row("heading", (Field((*at, "pose", "heading"), "", "deg", step=1.0, scale=DEGREE),))
    yield Row("mass", (Field((*at, "mass"), "", "kg", step=1.0),))
    yield Row("center of mass", _vector((*at, "center_of_mass"), _axes(world)))
    yield Row("footprint", (Field((*at, "footprint"), "", "m", "points"),))
    yield Row("turn speed", (Field((*at, "speed", "rotation"), "", "rad/s"),))
    yield Row("drive speed", tuple(Field((*at, "speed", "translation", k), name, "m/s")
                                      for k, name in enumerate(("ρ₁", "ρ₂"))))


def _task(world: World, _: Place) -> Iterator[Row]:
    at: Path = ("tasks", "default")
    kind = value_at(world, (*at, "kind"))
    if kind == "quintic":
        yield from _pose((*at, "to"), world)
        yield Row("lasts", (Field((*at, "duration"), "", "s", step=0.5),))
    elif kind == "hold":
        yield Row("lasts", (Field((*at, "duration"), "", "s", step=0.5),))
