"""Loose boxes, and a gripper on the platform that takes hold of them, draws them in and lets go.

The gripper is a constraint between platform and box, whose place on the platform may be moved.
"""

from collections.abc import Iterator

from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput, quoted
from ..robot.pose import Pose
from .bullet import Bullet


class Boxes:
    """The loose boxes of a world in PyBullet, none at first.

    platform : the body that grips them
    """

    def __init__(self, bullet: Bullet, platform: int) -> None:
        self._bullet, self._platform = bullet, platform
        self._boxes: dict[str, tuple[int, Array]] = {}           # body, size
        self._grips: dict[str, tuple[int, Array]] = {}           # constraint, rotation seen from the platform

    def add(self, name: str, position: ArrayLike, size: ArrayLike, mass: float, friction: float = 0.5) -> None:
        """Put a loose box into the world.

        position : (3,) of its center [m]; size : (3,) [m]; mass : [kg]
        friction : the box's factor of the coefficient of friction; boards and floor have 0.5
        """
        if name in self._boxes:
            raise InvalidInput(f"there is a box {quoted(name)} already")
        extent = as_array(size, "size", (3,), "m")
        body = self._bullet.add_box(extent,
                                    as_array(position, "position", (3,), "m"), 0.0, mass)
        self._bullet.changeDynamics(body, -1, lateralFriction=friction)
        self._boxes[name] = body, extent

    def pose(self, name: str) -> Pose:
        """Where a box is."""
        return Pose.of(*self._bullet.placed(self._body(name)))

    def __len__(self) -> int:
        return len(self._boxes)

    def __iter__(self) -> Iterator[tuple[Pose, Array]]:
        """Pose and size of each [m]."""
        return ((self.pose(name), size) for name, (_, size) in self._boxes.items())

    def grip(self, name: str) -> None:
        """Hold a box at the platform, as they are to each other now."""
        if name in self._grips:
            return
        body, platform, bullet = self._body(name), self._platform, self._bullet
        # What is held must not also push: platform and box overlap where the box lies in the
        # tray.
        bullet.setCollisionFilterPair(platform, body, -1, -1, 0)
        seen = bullet.placed(platform)[1].T @ bullet.placed(body)[1]
        self._grips[name] = bullet.fix(platform, -1, body, -1), seen

    def draw(self, name: str, stroke: ArrayLike) -> None:
        """Let the gripper hold a gripped box off the place where it was gripped.

        stroke : (3,) in platform axes, a little more every step or the box is torn away [m]
        """
        if name not in self._grips:
            raise InvalidInput(f"box {quoted(name)} is not gripped; gripped are {', '.join(self._grips) or 'none'}")
        grip, seen = self._grips[name]
        pivot = seen.T @ -as_array(stroke, "stroke", (3,), "m")
        self._bullet.changeConstraint(grip, jointChildPivot=pivot.tolist())

    def is_gripped(self, name: str) -> bool:
        """Whether a box is held at the platform."""
        return name in self._grips

    def release(self, *names: str) -> None:
        """Let these boxes go, or all of them."""
        for name in names or tuple(self._grips):
            if name in self._grips:
                self._bullet.removeConstraint(self._grips.pop(name)[0])

    def _body(self, name: str) -> int:
        if name not in self._boxes:
            raise InvalidInput(f"there is no box {quoted(name)}; there are {', '.join(self._boxes) or 'none'}")
        return self._boxes[name][0]
