"""Robots whose cables are not quite the ones they came with."""

from dataclasses import replace
from typing import Any

from ...arrays import as_count, checked
from ...robot import Robot


def every_cable(robot: Robot, **changes: Any) -> Robot:
    """The same robot, all cables changed alike.

    changes : fields of Cable, such as tension_max=500.0

    >>> import cdprlab as cl
    >>> every_cable(cl.load_world("planar_rigid").robot, tension_max=60.0).tension_max
    array([60., 60., 60., 60.])
    """
    return replace(robot, cables=tuple(replace(cable, **changes) for cable in robot.cables))


@checked
def without_cable(robot: Robot, index: int) -> Robot:
    """The same robot with one cable less.

    index : from 0

    >>> import cdprlab as cl
    >>> without_cable(cl.load_world("planar_rigid").robot, 0).n_cables
    3
    """
    as_count(index, "index", 0, robot.n_cables - 1)
    return replace(robot, cables=robot.cables[:index] + robot.cables[index + 1:])
