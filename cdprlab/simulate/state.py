"""What sensors tell at one instant: the state that controllers are written against and engines report."""

from __future__ import annotations

from typing import NamedTuple

from ..arrays import Array
from ..robot import Robot
from ..robot.pose import Pose


class State(NamedTuple):
    """What a controller may know at one instant.

    time : [s]
    robot : the robot, for its masses and points
    position : (d,) of P in the world [m]
    rotation : (d, d)
    twist : (3 planar or 6 spatial,) [v; ω] of P in world axes [m/s, rad/s]
    tensions : (m,) measured over the last step, zero before the first [N]
    """

    time: float
    robot: Robot
    position: Array
    rotation: Array
    twist: Array
    tensions: Array

    @property
    def pose(self) -> Pose:
        """The platform's pose."""
        return Pose.of(self.position, self.rotation)
