"""Workspaces over several orientations: total orientation asks for all of them, reachable for any."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose
from .criterion import Criterion, Judgement


@dataclass(frozen=True, eq=False)
class AllOrientations(Criterion):
    """Total orientation: the criterion holds at every given orientation, poses giving the position alone.

    criterion : asked at each of them
    orientations : (k, 3) rpy, or (k,) angles in the plane [rad]
    margin : the smallest
    Source: Merlet 2006, Parallel Robots, sec. 7 (total orientation workspace).

    >>> import cdprlab as cl
    >>> tilts = [[a, 0, 0] for a in (-0.2, 0.0, 0.2)]
    >>> robot, criterion = cl.load_world("caroca").robot, AllOrientations(cl.WrenchFeasible(), tilts)
    >>> criterion.judge(robot, cl.Pose([[0, 0, 1]])).inside
    array([ True])
    """

    criterion: Criterion
    orientations: ArrayLike

    @property
    def unit(self) -> str:  # type: ignore[override]
        return self.criterion.unit

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        return _over(self.criterion, robot, poses, self.orientations, margin, all_of_them=True)


@dataclass(frozen=True, eq=False)
class AnyOrientation(Criterion):
    """Reachable: the criterion holds at one of the given orientations at least; arguments as `AllOrientations`.

    margin : the largest
    """

    criterion: Criterion
    orientations: ArrayLike

    @property
    def unit(self) -> str:  # type: ignore[override]
        return self.criterion.unit

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        return _over(self.criterion, robot, poses, self.orientations, margin, all_of_them=False)


def _over(criterion: Criterion, robot: Robot, poses: Pose, orientations: ArrayLike, margin: bool,
          all_of_them: bool) -> Judgement:
    inside = np.full(poses.batch_shape, all_of_them)
    margins = np.full(poses.batch_shape, np.inf if all_of_them else -np.inf)
    join, pick = (np.logical_and, np.minimum) if all_of_them else (np.logical_or, np.maximum)
    for turned in _turned(robot, poses, orientations):
        found = criterion.judge(robot, turned, margin)
        inside, margins = join(inside, found.inside), pick(margins, found.margin)
    return Judgement(inside, margins)


def _turned(robot: Robot, poses: Pose, orientations: ArrayLike) -> list[Pose]:
    planar = robot.dimension == 2
    given: Array = as_array(orientations, "orientations", ("k",) if planar else ("k", 3), "rad")
    if not len(given):
        raise InvalidInput("orientations must hold at least one")
    return [Pose(poses.position, angle=turn) if planar else Pose(poses.position, rpy=turn) for turn in given]
