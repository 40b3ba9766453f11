"""What it means for a pose to belong to a workspace, by one criterion, by two, or over several orientations."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Flags, as_array, frozen, frozen_dataclass, lasting
from ..errors import InvalidInput
from ..mechanics.cables import have_directions
from ..robot import Robot
from ..robot.pose import Pose


@lasting
class Judgement(NamedTuple):
    """One entry a pose: ``inside, margin = …``.

    inside : (N,) whether the pose belongs to the workspace
    margin : (N,) how far it is from the border, in the criterion's unit, negative outside; NaN
        where none is known
    """

    inside: Flags
    margin: Array


@lasting
class Criterion(ABC):
    """Judges poses of a robot; ``a & b`` asks for both."""

    unit: str = ""

    def __post_init__(self) -> None:
        """What is asked for cannot change afterwards: arrays are kept as read-only copies."""
        vars(self).update({name: frozen(value.copy()) for name, value in vars(self).items()
                           if isinstance(value, np.ndarray)})

    @abstractmethod
    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        """Judge a batch (N,) of poses; without ``margin`` only the verdict, which may be much quicker."""

    def __and__(self, other: Criterion) -> Criterion:
        return Both(self, other)


@dataclass(frozen=True)
class Both(Criterion):
    """A pose inside both; the margin is the smaller one if they have the same unit, else NaN."""

    first: Criterion
    second: Criterion

    @property
    def unit(self) -> str:  # type: ignore[override]
        return self.first.unit if self.first.unit == self.second.unit else ""

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        a, b = self.first.judge(robot, poses, margin), self.second.judge(robot, poses, margin)
        if self.first.unit != self.second.unit:
            return unknown(a.inside & b.inside)
        return Judgement(a.inside & b.inside, np.minimum(a.margin, b.margin))


def judge_where_it_can_be(robot: Robot, poses: Pose, criterion: Criterion, margin: bool = True) -> Judgement:
    """A batch (N,) judged by a criterion; a pose where a cable has no direction is outside."""
    try:
        return criterion.judge(robot, poses, margin)
    except InvalidInput:
        sound = have_directions(robot, poses)
        if sound.all():
            raise
    found = unknown(np.zeros(len(poses), dtype=bool))
    if sound.any():
        found.inside[sound], found.margin[sound] = criterion.judge(robot, poses[sound], margin)
    return found


def unknown(inside: Flags) -> Judgement:
    """A verdict without margins."""
    return Judgement(inside, np.full(inside.shape, np.nan))


# --- over several orientations ----------------------------------------------------------------------
@frozen_dataclass
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
