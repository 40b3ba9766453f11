"""Edits of a world as changes of its file: a path, a value, and the whole file is read again. Comments stay."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import InvalidInput, WorldError
from ...world import World
from ...world.blocks import WorldFile
from ...world.document import place_text, plain, styled
from ...world.writer import updated_document

Path = tuple[str | int, ...]
"""Where in a world file a value stands: ``("cables", 2, "exit_point", 0)``."""

SHARED = "cable_limits"
"""The block whose limits, once edited, hold for every cable."""


def opened(world: World) -> World:
    """The same world with a file that says all of it, also what was changed since it was read."""
    return World.from_dict(updated_document(world), path=world.name)


def contents(world: World) -> dict[str, Any]:
    """Everything a world file can say of a robot, its frame and its tasks, spelled out; None for what is left out.

    Under ``cable_limits`` are the first cable's, which an edit there gives to all.
    """
    frame, document = world.scene.frame, world.document
    scene = {**plain(document.get("scene") or {}), "floor": {"height": world.scene.floor_height},
             "frame": None if frame is None else {"lower": frame[0].tolist(), "upper": frame[1].tolist()}}
    known = WorldFile.of(world)
    shared = {key: known["cables"][0][key] for key in ("tension", "speed")}
    return {**known, SHARED: shared, "scene": scene, "tasks": _tasks(world)}


def value_at(world: World, path: Path) -> Any:
    """What a world has at some place of its file, left out there or not; None where it has nothing.

    >>> import cdprlab as cl
    >>> value_at(cl.load_world("caroca"), ("cables", 0, "tension", 1))
    10000.0
    """
    found: Any = contents(world)
    for part in path:
        if isinstance(found, Mapping):
            found = found.get(part)
        elif isinstance(found, list) and isinstance(part, int) and part < len(found):
            found = found[part]
        else:
            return None
    return found


def edited(world: World, path: Path, value: Any) -> World:
    """The world with another value at one place of its file; None leaves it out.

    world : of `opened`, or edited before
    Raises WorldError naming the place if that is no world; ``world`` itself is never changed.

    >>> import cdprlab as cl
    >>> heavier = edited(cl.load_world("caroca"), ("platform", "mass"), 200.0)
    >>> heavier.robot.mass, heavier.to_dict()["platform"]["mass"]
    (200.0, 200.0)
    """
    document = copy.deepcopy(world.document)
    node: Any = document
    for depth, part in enumerate(path[:-1], 1):
        node = _own(node, part, value_at(world, path[:depth]))
    _put(node, path[-1], value)
    if path[0] == SHARED:
        for cable in document["cables"]:
            cable.pop(path[1], None)
    return read(document)


def with_entry(world: World, key: str, block: Mapping[str, Any]) -> World:
    """The world with one more cable or base at the end.

    key : "cables" or "bases"
    """
    document = copy.deepcopy(world.document)
    _own(document, key, []).append(styled(plain(block), root=False))
    return read(document)


def without_entry(world: World, key: str, index: int) -> World:
    """The world without one cable or base.

    Raises WorldError where that leaves no world, InvalidInput for a base that still carries cables.
    """
    if key == "bases":
        name = world.robot.bases[index].name
        carried = [str(i + 1) for i, cable in enumerate(world.robot.cables) if cable.base == name]
        if carried:
            raise InvalidInput(f"base {name!r} still carries cable{'s' * (len(carried) > 1)} {', '.join(carried)}: "
                               "give them another base, or none, first", ("bases", index))
    document = copy.deepcopy(world.document)
    del _own(document, key, [])[index]
    if not document[key] and key == "bases":
        del document[key]
    return read(document)


def on_base(world: World, cable: int, name: str | None) -> World:
    """The world with a cable's exit point on another base, or none; it stays where it is in the world frame.

    cable : from 0
    """
    point, robot = world.robot.exit_points[cable], world.robot
    if name is not None:
        base = robot.base(name)
        point = (point - base.origin) @ base.rotation
    document = copy.deepcopy(world.document)
    block = _own(_own(document, "cables", None), cable, None)
    _put(block, "base", name)
    _put(block, "exit_point", point)
    return read(document)


def read(document: Any) -> World:
    """The world of a document; its mistakes name cable and key, but no line, for the file's lines have moved.

    Raises WorldError.
    """
    try:
        return World.from_dict(document, path="")
    except WorldError as error:
        raise WorldError([_without_line(problem) for problem in error.problems]) from None


def field_name(path: Path) -> str:
    """A place in words.

    >>> field_name(("cables", 2, "exit_point", 0))
    'cable 3: exit_point[1]'
    """
    return place_text(path)


def _tasks(world: World) -> dict[str, Any]:
    """The file's tasks, angles spelled out; a world without a default task holds its pose for a while."""
    tasks = plain(world.document.get("tasks") or {})
    tasks.setdefault("default", {"kind": "hold", "duration": world.tasks["default"].duration})
    turn = {"angle": 0.0} if world.robot.dimension == 2 else {"rpy": [0.0, 0.0, 0.0]}
    for task in tasks.values():
        for end in ("from", "to", "at"):
            if end in task:
                task[end] = {**turn, **task[end]}
    return tasks


def _without_line(problem: str) -> str:
    """":12: cable 3: tension: …" without its first part."""
    place, _, rest = problem.partition(": ")
    return rest if place.strip(":").isdigit() or not place else problem


def _own(node: Any, key: str | int, known: Any) -> Any:
    """The block at ``key``, to be changed: spelled out if the file leaves it out, a copy if others refer to it."""
    missing = isinstance(key, str) and node.get(key) is None
    if missing:
        node[key] = styled(plain(known) if known is not None else {}, root=False)
    elif node[key].yaml_anchor() is not None:
        node[key] = copy.deepcopy(node[key])
        node[key].yaml_set_anchor(None)
    return node[key]


def _put(node: Any, key: str | int, value: Any) -> None:
    if value is None and isinstance(key, str):
        node.pop(key, None)
    else:
        clean = plain(value.tolist() if isinstance(value, np.ndarray) else value)
        node[key] = styled(clean, root=False)
