"""Document → `World`: each block becomes the part it describes, and every mistake is named by its place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..arrays import frozen
from ..errors import InvalidInput, Location, WorldError
from ..robot import Base, Cable, Elasticity, Platform, Robot, Winch, inertia_matrix, motion_pattern
from ..robot.pose import Pose
from .mistakes import existing_parts, explanation, key_guesses, kind_of, line_number, place_text, plain
from .model import Box, Document, PickAndPlace, Scene, Task, World
from .writer import styled


def read_world(document: Document, path: str) -> World:
    """The world a document describes; ``path`` is what its messages call it. Raises WorldError."""
    return _Reader(document, path).world()


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

        from .schema import WorldFile

        if not isinstance(self.document, Mapping):
            raise WorldError([f"{self.path}: a world is a mapping of keys (name, platform, cables, …), "
                              f"got {kind_of(self.document)}"])
        try:
            return WorldFile.model_validate(plain(self.document))
        except ValidationError as errors:
            raise WorldError([self._line(location, explanation(error, location))
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
                tasks[name] = (_pick_and_place(block, pose, robot) if block.kind == "pick_and_place"
                               else _task(block, pose, d))
        return World(file.name, file.title, file.source, robot, pose, scene, tasks, self._kept())

    def _kept(self) -> Any:
        """The document for saving: a file's own with its comments, or a copy nobody else can change."""
        return self.document if hasattr(self.document, "lc") else styled(plain(self.document))

    # --- messages ---------------------------------------------------------------------------------
    def _distinct(self, errors: list[Any]) -> list[tuple[Any, Location]]:
        """The schema's errors with their places, unknown keys first, each mistake once."""
        # Pydantic puts the name of a union's member into the path; the document has no such key.
        found = [(error, tuple(existing_parts(self.document, error["loc"]))) for error in errors]
        found.sort(key=lambda pair: pair[0]["type"] != "extra_forbidden")
        misspelt = {(*place[:-1], guess) for error, place in found if error["type"] == "extra_forbidden"
                    for guess in key_guesses(place)}
        kept: dict[Location, Any] = {}
        for error, place in found:
            # A value that fits no member of a union is told at its deepest place only.
            deeper = any(len(other) > len(place) and other[:len(place)] == place for _, other in found)
            if not deeper and not (error["type"] == "missing" and place in misspelt):
                kept.setdefault(place, error)
        return [(error, place) for place, error in kept.items()]

    def _line(self, location: Location, message: str) -> str:
        number = line_number(self.document, location)
        place = f"{self.path}:{number}" if number else self.path
        where = place_text(location)
        return f"{place}: {where}: {message}" if where else f"{place}: {message}"


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
    speed = float("inf") if block.speed is None else block.speed
    return Winch(block.drum_radius, block.gear_ratio, block.efficiency, torque, block.friction.coulomb,
                 block.friction.viscous, block.friction.static, block.inertia, speed)


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


def _pick_and_place(block: Any, pose: Pose, robot: Robot) -> PickAndPlace:
    if robot.dimension == 2 or not robot.bases:
        raise InvalidInput("pick_and_place needs a spatial robot with mobile bases", ("kind",))
    with _under("from"):
        start = pose if block.start is None else _pose(block.start, 3)
    coupled = {}
    if block.coupled is not None:
        with _under("coupled", "base"):
            robot.base(block.coupled.base)
        coupled[block.coupled.base] = (*block.coupled.pose.position, block.coupled.pose.heading)
    box, gripper = block.box, block.gripper
    vectors = (np.array(v) for v in (box.size, box.position, block.place, gripper.seat, gripper.stroke, gripper.tilt))
    size, position, place, seat, stroke, tilt = map(frozen, vectors)
    if not stroke.any():
        raise InvalidInput("the stroke must not be zero", ("gripper", "stroke"))
    return PickAndPlace("pick_and_place", start, start, 1.0, box_size=size, box_mass=box.mass, box_position=position,
                        place=place, seat=seat, stroke=stroke, tilt=tilt, clearance=gripper.clearance, coupled=coupled,
                        aside=block.coupled.aside if block.coupled else 0.0)


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
