"""Hang a robot on ropes of given lengths: where is it at rest, and which ropes are slack?"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import NoConvergence
from ...mechanics.cables import cable_lengths
from ...mechanics.rest import equilibrium
from ...robot import Robot
from ...robot.pose import Pose

_LOOSE = 1e-5
"""A rope with more than this to spare is slack [m]."""


class Settled(NamedTuple):
    """A robot at rest on its ropes.

    pose : of the platform
    spare : (m,) rope let out beyond the distance it spans [m]
    """

    pose: Pose
    spare: Array

    @property
    def slack(self) -> Array:
        """(m,) True where a rope hangs through."""
        return np.asarray(self.spare > _LOOSE)


def hang(robot: Robot, lengths: Array, start: Pose) -> Settled | None:
    """The lowest place near ``start`` that the ropes allow, l_i(x) ≤ l_i, by `equilibrium`; None where there is none.

    >>> from cdprlab.course.props.point_load import point_load
    >>> settled = hang(point_load(2), np.array([2.5, 2.5]), Pose([0, 2], angle=0))
    >>> settled.pose.position.round(6) + 0.0
    array([0. , 1.5])
    """
    try:
        pose = equilibrium(robot, lengths, start).pose
    except NoConvergence:
        return None
    return Settled(pose, lengths - cable_lengths(robot, pose))
