"""Edits of a world as changes of what its file says, which is then read again. Comments stay."""

from collections.abc import Mapping
from functools import lru_cache, reduce
from itertools import product
from operator import getitem
from typing import Any

import numpy as np

from ...errors import InvalidInput, Location
from ...world import World
from ...world.blocks import LimitsBlock, WorldFile
from ...world.document import copied, overlay, own, plain
from ...world.writer import updated_document
from ..text_table import cable_names

CHANGED = " (changed)"
"""At the end of a title that may no longer be true."""

SHARED = "cable_limits"
"""The block whose limits, once edited, hold for every cable."""


def opened(world: World) -> World:
    """The same world with a file that says all of it, also what was changed since it was read."""
    return World.from_dict(updated_document(world), path=world.name)


@lru_cache(maxsize=2)
def contents(world: World) -> dict[str, Any]:
    """Everything a world file can say of a robot, its frame and its tasks, spelled out; None for what is left out.

    Under ``cable_limits`` are the first cable's, which an edit there gives to all. Not to be
    changed.
    """
    document: Any = world.document
    known = WorldFile.of(world)
    if "inertia" not in document["platform"]:
        known["platform"]["inertia"] = None
    # A world without a default task holds its pose for a while.
    tasks: dict[str, Any] = {"default": {"kind": "hold",
                                         "duration": world.tasks["default"].duration}}
    tasks |= plain(document.get("tasks", {}))
    turn = {"angle": 0.0} if world.robot.dimension == 2 else {"rpy": [0.0, 0.0, 0.0]}
    for task in tasks.values():
        if "to" in task:
            task["to"] = turn | task["to"]
    shared = LimitsBlock.of(world.robot.cables[0])
    return known | {SHARED: shared, "scene": plain(document.get("scene", {})), "tasks": tasks}


def value_at(world: World, path: Location) -> Any:
    """What a world has at some place of its file, left out there or not; None where it has nothing.

    >>> import cdprlab as cl
    >>> value_at(cl.load_world("caroca"), ("cables", 0, "tension", 1))
    10000.0
    """
    known: Any = contents(world)
    try:
        return reduce(getitem, path, known)
    except (KeyError, IndexError, TypeError):
        return None


def edited(world: World, path: Location, value: Any, mirrored: str = "") -> World:
    """The world with another value at one place of its file; None leaves it out.

    mirrored : axes as in "xy"; what is changed at a cable is changed at its mirror images, too

    world : of `opened`, or edited before
    Raises WorldError naming the place if that is no world; ``world`` itself is never changed.

    >>> import cdprlab as cl
    >>> heavier = edited(cl.load_world("caroca"), ("platform", "mass"), 200.0)
    >>> heavier.robot.mass, heavier.to_dict()["platform"]["mass"]
    (200.0, 200.0)
    """
    before, after = contents(world), copied(contents(world))
    for place, its_value in {**_images(world, path, value, mirrored), path: value}.items():
        node: Any = after
        for part in place[:-1]:
            if isinstance(part, str) and node.get(part) is None:
                node[part] = {}
            node = node[part]
        node[place[-1]] = plain(its_value)
    if path[0] == SHARED:
        # Written whatever stood there: what is shown are the first cable's.
        key = path[1]
        before = before | {SHARED: {key: object()}}
        after[SHARED] = {key: after[SHARED][key]}
        for cable in after["cables"]:
            cable[key] = None
    return _rewritten(world, before, after)


def _images(world: World, path: Location, value: Any, axes: str) -> dict[Location, Any]:
    """Where a cable's mirror images have what stands at ``path``, and what it becomes there.

    Exit points are mirrored at the middle of them all, anchor points at the platform's axes; cables
    that share the point go along.
    """
    robot = world.robot
    if path[0] != "cables" or not axes or robot.bases:
        return {}
    _, cable, key, *component = path
    middle, points = np.zeros(robot.dimension), robot.anchor_points
    if key != "anchor_point":
        middle = (robot.exit_points.min(axis=0) + robot.exit_points.max(axis=0)) / 2
        points = robot.exit_points - middle
    found: dict[Location, Any] = {}
    for signs in product(*((1.0, -1.0) if axis in axes else (1.0,) for axis in "xyz"[:robot.dimension])):
        image = value
        if component and key in ("exit_point", "anchor_point"):
            axis = int(component[0])
            image = float(middle[axis] + signs[axis] * (value - middle[axis]))
        same = np.isclose(points, signs * points[int(cable)], atol=1e-6).all(axis=1)
        for other in np.flatnonzero(same).tolist():
            found.setdefault(("cables", other, key, *component), image)
    return found


def with_entry(world: World, key: str, block: Mapping[str, Any]) -> World:
    """The world with one more cable or base at the end.

    key : "cables" or "bases"
    """
    entries = contents(world)[key]
    return _rewritten(world, {key: entries}, {key: [*entries, block]})


def without_entry(world: World, key: str, index: int) -> World:
    """The world without one cable or base.

    Raises WorldError where that leaves no world, InvalidInput for a base that still carries
    cables.
    """
    if key == "bases":
        name = world.robot.bases[index].name
        carried = [cable.base == name for cable in world.robot.cables]
        if any(carried):
            raise InvalidInput(f"base {name!r} still carries {cable_names(carried)}: give them another base, or none, "
                               "first", ("bases", index))
    document = copied(world.document)
    del own(document, key)[index]
    return World.from_dict(document, path="")


def on_base(world: World, cable: int, name: str | None) -> World:
    """The world with a cable's exit point on another base, or none; it stays where it is in the world frame.

    cable : from 0
    """
    point = world.robot.exit_points[cable]
    if name is not None:
        base = world.robot.base(name)
        point = (point - base.origin) @ base.rotation
    after = copied(contents(world))
    after["cables"][cable] |= {"base": name, "exit_point": plain(point)}
    return _rewritten(world, contents(world), after)


def _rewritten(world: World, before: dict[str, Any], after: dict[str, Any]) -> World:
    """The world whose file differs as the two contents do; its mistakes name no line, for the lines have moved."""
    document = copied(world.document)
    overlay(document, before, after)
    title = document.get("title") or ""
    if title and not title.endswith(CHANGED) and document != world.document:
        document["title"] = title + CHANGED
    return World.from_dict(document, path="")
