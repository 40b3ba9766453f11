"""What a world file says beside the robot: the scene around it, and tasks."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from ..arrays import Array, checked, frozen_dataclass
from ..errors import InvalidInput, Location, quoted, under
from ..mechanics.trajectory import Trajectory, quintic
from ..robot import Robot
from ..robot.pose import Pose, turned_to

NAME = re.compile(r"[A-Za-z0-9_\-]+")
"""Of a world."""


@frozen_dataclass
class Box:
    """A solid, upright box of the scene: center, edges [m], turn about the vertical [rad], "box" or "obstacle"."""

    position: Annotated[Array, "(d,) [m]"]
    size: Annotated[Array, "(d,) [m] > 0"]
    yaw: float = 0.0
    kind: str = "box"
    name: str = ""

    @property
    def pose(self) -> Pose:
        """Of its center."""
        return Pose.of(self.position, turned_to(self.yaw, self.size.size))


@frozen_dataclass
class Scene:
    """What stands around the robot.

    frame : (2, d) corners of the outline that is drawn, or None [m]
    floor_height : [m]
    boxes : all that is solid, shelves taken apart into their boards
    """

    frame: Annotated[Array, "(2, d) [m]"] | None
    floor_height: float
    boxes: tuple[Box, ...]


def check_pose(pose: Pose, robot: Robot, location: Location) -> None:
    """Raises InvalidInput unless a robot can be there at all."""
    if pose.batch_shape or pose.dimension != robot.dimension:
        raise InvalidInput(f"{location[-1]} must be a single {robot.pattern.engine} pose, got {quoted(pose)}", location)


@frozen_dataclass
class Task:
    """What to do: "quintic" from ``start`` to ``end`` in ``duration`` [s] and ``hold`` [s] there, or "hold"."""

    kind: Literal["quintic", "hold"]
    start: Pose
    end: Pose
    duration: Annotated[float, "[s] > 0"]
    hold: Annotated[float, "[s] ≥ 0"] = 0.0

    def check(self, robot: Robot) -> None:
        """Raises InvalidInput for a robot that cannot do it."""
        check_pose(self.start, robot, ("from",))
        check_pose(self.end, robot, ("to",))

    def trajectory(self) -> Trajectory:
        """The reference motion, without the hold at its end."""
        return quintic(self.start, self.end, self.duration)


Spot = Annotated[Array, "(3,) [m, tilt: rad]"]


@checked
@dataclass(frozen=True, eq=False, kw_only=True)
class PickAndPlace(Task):
    """Take a box from where it stands to its place: a job of many phases, see `picking`.

    box_size, box_mass : [m], [kg]
    box_position, place : (3,) center of the box before and after; its face is flush with the
        edge of its board [m]
    seat : (3,) center of a box that is drawn in, platform frame [m]
    stroke : (3,) from there to the box on its board, world axes, the platform level [m]
    tilt : (3,) roll, pitch, yaw at which the platform hooks and unhooks [rad]
    clearance : to the shelf as the platform moves along it [m]
    coupled : base name → (x, y, heading) of the base that drives away first, empty if none does
        [m, m, rad]
    aside : how far it keeps aside on its way, along its own y axis [m]
    """

    kind: Literal["pick_and_place"]  # type: ignore[assignment]
    duration: Annotated[float, "[s] > 0"] = 1.0
    box_size: Spot
    box_mass: Annotated[float, "[kg] > 0"]
    box_position: Spot
    place: Spot
    seat: Spot
    stroke: Spot
    tilt: Spot
    clearance: float
    coupled: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    aside: float = 0.0

    def __post_init__(self) -> None:
        if not self.stroke.any():
            raise InvalidInput("the stroke must not be zero", ("gripper", "stroke"))

    def check(self, robot: Robot) -> None:
        super().check(robot)
        if robot.dimension == 2 or not robot.bases:
            raise InvalidInput("pick_and_place needs a spatial robot with mobile bases", ("kind",))
        for name in self.coupled:
            with under("coupled", "base"):
                robot.base(name)

    def trajectory(self) -> Trajectory:
        raise InvalidInput("a pick_and_place task is no single motion: use cdprlab.fastkit.pick_and_place(world)")
