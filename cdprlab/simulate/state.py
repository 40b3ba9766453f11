"""What an engine tells at one instant: controllers are written against it, pictures are drawn from it."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array, frozen, lasting
from ..robot import Robot
from ..robot.pose import Pose
from ..world import Scene


@lasting
class State(NamedTuple):
    """What a controller may know at one instant, and what else a picture shows.

    time : [s]
    robot : the robot, for its masses and points; its bases where they are now
    position : (d,) of P in the world [m]
    rotation : (d, d)
    twist : (3 planar or 6 spatial,) [v; ω] of P in world axes [m/s, rad/s]
    tensions : (m,) measured over the last step, zero before the first [N]
    scene : what stands around the robot
    rope_lengths : (m,) let out by winches, None where tensions are commanded [m]
    boxes : pose and (3,) size [m] of each loose box
    lengths : (m,) of the cables [m]
    base_frames : (p, 3, 4) rotation and center of mass of each base that may lean, None where none can

    To a controller position, rotation, tensions and lengths are what its sensors measured, the
    twist is what an observer makes of that, and the robot is the one it believes in.
    """

    time: float
    robot: Robot
    position: Array
    rotation: Array
    twist: Array
    tensions: Array
    scene: Scene | None = None
    rope_lengths: Array | None = None
    boxes: tuple[tuple[Pose, Array], ...] = ()
    lengths: Array = frozen(np.zeros(0))
    base_frames: Array | None = None

    @property
    def pose(self) -> Pose:
        """The platform's pose."""
        return Pose.of(self.position, self.rotation)
