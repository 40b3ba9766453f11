"""Workspaces over several orientations: total orientation asks for all of them, inclusive orientation for any."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose
from .criterion import Criterion, Judgement, judge_where_it_can_be


@checked
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
    join: ClassVar[tuple[np.ufunc, np.ufunc]] = (np.logical_and, np.minimum)

    @property
    def unit(self) -> str:  # type: ignore[override]
        return self.criterion.unit

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        planar = robot.dimension == 2
        given: Array = as_array(self.orientations, "orientations",
                                ("k",) if planar else ("k", 3), "rad")
        if not len(given):
            raise InvalidInput("orientations must hold at least one")
        turned = [Pose(poses.position, angle=turn) if planar else Pose(poses.position, rpy=turn)
                  for turn in given]
        found = zip(*(judge_where_it_can_be(robot, at, self.criterion, margin) for at in turned))
        return Judgement(*(join.reduce(parts) for join, parts in zip(self.join, found)))


class AnyOrientation(AllOrientations):
    """Inclusive orientation: the criterion holds at one of the given orientations at least; arguments as before.

    As `AllOrientations`, which asks for all of them.

    margin : the largest
    Source: Merlet 2006, Parallel Robots, sec. 7 (inclusive orientation workspace).
    """

    join = (np.logical_or, np.maximum)
