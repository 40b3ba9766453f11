"""References over time: quintic motions between poses, and poses held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, as_number, checked, frozen, lasting
from ..errors import InvalidInput
from ..robot.pose import Pose, rotation_from_vector, rotation_vector

PEAK_SPEED = 15 / 8
"""Largest over mean speed of a quintic from rest to rest."""


@lasting
class Reference(NamedTuple):
    """Where the platform should be: ``pose, twist, acceleration = trajectory(t)``.

    pose : Pose
    twist : (…, 3 planar or 6 spatial) [v; ω] of P in world axes [m/s, rad/s]
    acceleration : its time derivative [m/s², rad/s²]
    """

    pose: Pose
    twist: Array
    acceleration: Array


@lasting
@checked
@dataclass(frozen=True, eq=False)
class Trajectory:
    """A motion ``(t) → Reference`` that takes single times or arrays; before 0 and after ``duration`` it rests.

    start, end : Pose
    duration : [s]
    way : (3 planar or 6 spatial,) [p₁ − p₀; log(R₁ R₀ᵀ)] in world axes [m, rad]
    """

    start: Pose
    end: Pose
    duration: float
    way: Array

    def __call__(self, t: ArrayLike) -> Reference:
        s = np.clip(as_array(t, "t", (), "s", batch=True) / self.duration, 0.0, 1.0)[..., None]
        rate = 30 * (s * (1 - s))**2 / self.duration
        bend = 60 * s * (1 - s) * (1 - 2 * s) / self.duration**2
        gone, d = rest_to_rest(s) * self.way, self.start.dimension
        pose = Pose.of(self.start.position + gone[..., :d],
                       rotation_from_vector(gone[..., d:]) @ self.start.rotation)
        return Reference(pose, rate * self.way, bend * self.way)


@checked
def quintic(start: Pose, end: Pose, duration: float) -> Trajectory:
    """Fifth-degree polynomial from rest to rest, x = x₀ + (x₁ − x₀)(10 s³ − 15 s⁴ + 6 s⁵), s = t/T.

    Position is interpolated in world axes; the platform turns about one fixed axis.

    start, end : single poses
    duration : T [s]
    Returns Trajectory: ``(t) → pose, twist, acceleration``.
    Raises InvalidInput for poses of different dimension or a duration that is not positive.
    Source: Okoli 2016, eq. (6.6)–(6.14), solved anew: the printed coefficients (6.19)–(6.21)
    are wrong.

    >>> path = quintic(Pose([0, 0, 1]), Pose([1, 0, 1]), 2.0)
    >>> path(1.0).pose.position
    array([0.5, 0. , 1. ])
    """
    period = as_number(duration, "duration", "s", positive=True)
    if start.batch_shape or end.batch_shape:
        raise InvalidInput("a trajectory runs between two single poses, not batches")
    if start.dimension != end.dimension:
        raise InvalidInput(f"start has {start.dimension} dimensions, end has {end.dimension}")
    turn = rotation_vector(end.rotation @ start.rotation.T)
    way = np.concatenate([end.position - start.position, turn])
    return Trajectory(start, end, period, frozen(way))


def rest_to_rest(share: ArrayLike) -> Array:
    """s³ (10 − 15 s + 6 s²): how much of a way is done after a share s of its time, from rest to rest.

    share : (…) of the time; before 0 and after 1 it rests

    >>> rest_to_rest([0.0, 0.5, 2.0]).tolist()
    [0.0, 0.5, 1.0]
    """
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s**3 * (10 - 15 * s + 6 * s**2))


@checked
def hold(pose: Pose, duration: float) -> Trajectory:
    """Rest at one pose.

    pose : single
    duration : [s]

    >>> hold(Pose([0, 0, 1]), 2.0)(0.5).twist
    array([0., 0., 0., 0., 0., 0.])
    """
    return quintic(pose, pose, duration)
