"""Pure Gauss–Newton from lengths to a planar pose, every step kept; and a robot of three to six cables to try it on."""

import pathlib
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...arrays import Array, checked
from ...errors import InvalidInput, quoted
from ...mechanics.cables import cable_lengths
from ...mechanics.kinematics import jacobian
from ...robot import Robot
from ...robot.pose import Pose
from ...world import load_world

_ROBOT = load_world(pathlib.Path(__file__).with_name("six_cables.yaml")).robot

_STEPS = 60
"""Where the residuals do not vanish the steps shrink only by a factor each; this many reach 1e-9 m."""

_DONE, _LOST = 1e-10, 20.0
"""A step this small ends the iteration; a position this far out is lost [m]."""


class Path(NamedTuple):
    """What Gauss–Newton did.

    poses : guess first
    residuals : (m,) measured − fitted length at the last pose [m]
    converged : whether the last step was small
    """

    poses: list[Pose]
    residuals: Array
    converged: bool


@checked
def six_cables(count: int = 6) -> Robot:
    """A planar platform of 0.8 m × 0.5 m in a frame of 4 m × 3 m, held by the first ``count`` of six cables.

    count : 3 (as many as unknowns) to 6
    Raises InvalidInput for another number.

    >>> six_cables(4)
    Robot(1R2T, 4 cables, 10 kg)
    """
    if count not in (3, 4, 5, 6):
        raise InvalidInput(f"this robot has 3, 4, 5 or 6 cables, got {quoted(count)}")
    return replace(_ROBOT, cables=_ROBOT.cables[:count])


def gauss_newton_path(robot: Robot, lengths: Array, guess: Pose) -> Path:
    """Pure Gauss–Newton, x ← x + J⁺ (l − l(x)), with nothing that keeps it from running away.

    robot : planar, pattern 1R2T
    lengths : (m,) measured [m]
    guess : where to start

    >>> robot = six_cables()
    >>> path = gauss_newton_path(robot, cable_lengths(robot, Pose([0.4, 1.3], angle=0.2)), Pose([0, 1.5], angle=0))
    >>> path.converged, path.poses[-1]
    (True, Pose([0.4, 1.3], angle=0.2))
    """
    x, poses = np.append(guess.position, guess.angle), [guess]
    residuals = lengths - cable_lengths(robot, guess)
    for _ in range(_STEPS):
        step = np.linalg.pinv(jacobian(robot, poses[-1])) @ residuals
        x = x + step
        poses.append(Pose(x[:2], angle=x[2]))
        residuals = lengths - cable_lengths(robot, poses[-1])
        converged = bool(np.linalg.norm(step) < _DONE)
        if converged or np.abs(x[:2]).max() > _LOST:
            break
    return Path(poses, residuals, converged)
