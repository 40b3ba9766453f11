"""A planar robot alone: no frame, no box, and no floor within reach."""

from ...errors import InvalidInput, quoted
from ...robot import Robot
from ...robot.pose import Pose
from ...world import World
from ...world.model import Scene

_DEEP = -1e3
"""Of the floor, which no experiment of seconds reaches [m]."""


def bare_world(robot: Robot, pose: Pose) -> World:
    """A world that holds this planar robot at this pose and nothing else.

    Raises InvalidInput for a spatial robot.

    >>> from cdprlab.course.props.point_load import point_load
    >>> bare_world(point_load(2), Pose([0, 1], angle=0)).scene.boxes
    ()
    """
    if robot.dimension != 2:
        raise InvalidInput(f"this experiment is for planar robots, got {quoted(robot)}")
    return World("bare", "", "", robot, pose,
                 Scene(frame=None, floor_height=_DEEP, boxes=()), {}, None)
