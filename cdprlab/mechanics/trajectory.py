"""References over time: quintic motions between poses, and poses held."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen_dataclass, lasting
from ..errors import InvalidInput
from ..robot.pose import (
    Pose,
    rotation_vector,
    rotation_vector_jacobian,
    rotation_vector_jacobian_rate,
)

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

    def rows(self, index: Any) -> Reference:
        """Some of a batch."""
        return Reference(self.pose[index], self.twist[index], self.acceleration[index])


@frozen_dataclass
class Trajectory:
    """A motion ``(t) → Reference`` that takes single times or arrays; before 0 and after ``duration`` it rests.

    start, end : Pose
    duration : [s]
    coefficients : (6, n) c_k of [p − p₀; r] = Σ c_k t^k, the rotation exp([r]×) R₀
    """

    start: Pose
    end: Pose
    duration: float
    coefficients: Annotated[Array, "(6, n)"]

    def __call__(self, t: ArrayLike) -> Reference:
        times = as_array(t, "t", (), "s", batch=True)
        within = np.clip(times, 0.0, self.duration)
        motion = _derivatives(self.coefficients, within)
        motion[1:, within != times] = 0.0
        x, rate, bend = motion
        d = self.start.dimension
        J, J_rate = rotation_vector_jacobian(x[..., d:]), rotation_vector_jacobian_rate(x[..., d:], rate[..., d:])
        spin = J @ rate[..., d:, None]
        spin_rate = J @ bend[..., d:, None] + J_rate @ rate[..., d:, None]
        return Reference(self.start.displaced(x), np.concatenate([rate[..., :d], spin[..., 0]], axis=-1),
                         np.concatenate([bend[..., :d], spin_rate[..., 0]], axis=-1))


@checked
def quintic(start: Pose, end: Pose, duration: Annotated[float, "[s] > 0"], *, start_twist: ArrayLike | None = None,
            end_twist: ArrayLike | None = None, start_acceleration: ArrayLike | None = None,
            end_acceleration: ArrayLike | None = None) -> Trajectory:
    """Fifth-degree polynomial between two poses; rest to rest x = x₀ + (x₁ − x₀)(10 s³ − 15 s⁴ + 6 s⁵), s = t/T.

    Position is interpolated in world axes; orientation as exp([r(t)]×) R₀, r quintic, which
    rest to rest turns about one fixed axis.

    start, end : single poses
    duration : T [s]
    start_twist, end_twist : (3 or 6,) [v; ω] in world axes, default rest [m/s, rad/s]
    start_acceleration, end_acceleration : their time derivatives, default zero [m/s², rad/s²]
    Returns Trajectory: ``(t) → pose, twist, acceleration``.
    Raises InvalidInput for poses of different dimension or a duration that is not positive.
    Source: Okoli 2016, eq. (6.6)–(6.14), solved anew: the printed coefficients (6.19)–(6.21)
    are wrong.

    >>> path = quintic(Pose([0, 0, 1]), Pose([1, 0, 1]), 2.0)
    >>> path(1.0).pose.position
    array([0.5, 0. , 1. ])
    """
    if start.batch_shape or end.batch_shape:
        raise InvalidInput("a trajectory runs between two single poses, not batches")
    if start.dimension != end.dimension:
        raise InvalidInput(f"start has {start.dimension} dimensions, end has {end.dimension}")
    size = 3 * (start.dimension - 1)
    given = {"start_twist": start_twist, "end_twist": end_twist,
             "start_acceleration": start_acceleration, "end_acceleration": end_acceleration}
    twist0, twist1, acceleration0, acceleration1 = (
        np.zeros(size) if value is None else as_array(value, name, (size,))
        for name, value in given.items())
    turn = rotation_vector(end.rotation @ start.rotation.T)
    rate0, bend0 = _vector_rates(0 * turn, twist0, acceleration0)
    rate1, bend1 = _vector_rates(turn, twist1, acceleration1)
    # Three powers are known from the start, three follow from the end: what each power of one
    # comes to there, and its rate and second derivative.
    known = np.stack([0 * rate0, rate0, bend0 / 2])
    wanted = np.stack([np.concatenate([end.position - start.position, turn]), rate1, bend1])
    powers = _derivatives(np.eye(6), duration)
    return Trajectory(start, end, duration, np.concatenate(
        [known, np.linalg.solve(powers[:, 3:], wanted - powers[:, :3] @ known)]))


def rest_to_rest(share: ArrayLike) -> Array:
    """s³ (10 − 15 s + 6 s²): how much of a way is done after a share s of its time, from rest to rest.

    share : (…) of the time; before 0 and after 1 it rests

    >>> rest_to_rest([0.0, 0.5, 2.0]).tolist()
    [0.0, 0.5, 1.0]
    """
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(s**3 * (10 - 15 * s + 6 * s**2))


@checked
def hold(pose: Pose, duration: Annotated[float, "[s] > 0"]) -> Trajectory:
    """Rest at one pose.

    pose : single
    duration : [s]

    >>> hold(Pose([0, 0, 1]), 2.0)(0.5).twist
    array([0., 0., 0., 0., 0., 0.])
    """
    return quintic(pose, pose, duration)


def _derivatives(coefficients: Array, t: Any) -> Array:
    """Σ c_k t^k of (6, n) coefficients at times (…), and its first two derivatives: (3, …, n)."""
    from numpy.polynomial.polynomial import polyder, polyval

    return np.stack([np.moveaxis(polyval(t, polyder(coefficients, order)), 0, -1) for order in range(3)])


def _vector_rates(vector: Array, twist: Array, acceleration: Array) -> tuple[Array, Array]:
    """Rates of [p; r] where r is ``vector``, from ω = J ṙ and ω̇ = J r̈ + J̇ ṙ."""
    (v, spin), (a, spin_rate) = (np.split(part, [-vector.size]) for part in (twist, acceleration))
    inverse = np.linalg.inv(rotation_vector_jacobian(vector))
    rate = inverse @ spin
    bend = inverse @ (spin_rate - rotation_vector_jacobian_rate(vector, rate) @ rate)
    return np.concatenate([v, rate]), np.concatenate([a, bend])
