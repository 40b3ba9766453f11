"""A point load in a vertical plane: the forces that balance it, and where two cable lengths put it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, Flags, as_array, checked
from ...errors import InvalidInput, quoted
from ...mechanics.optimization import largest_last
from ...mechanics.statics import gravity_wrench, wrench_matrix
from ...robot import MOTION_PATTERNS, Cable, Platform, Robot
from ...robot.pose import Pose
from ...tensions import distribute_tensions
from ..text_table import fixed

_ABOVE = (-2.0, 3.0), (2.0, 3.0)
EXIT_POINTS = {2: _ABOVE, 3: (*_ABOVE, (0.0, 0.0)), 4: (*_ABOVE, (2.0, 0.0), (-2.0, 0.0))}
"""Number of cables → exit points of the vertical plane's robots [m]."""

MASS = 10.0
"""Of the point load [kg]."""

_CLOSED = 1e-6
"""Forces that add up to less than this share of the load are called balanced: rounding is far below."""


class Equilibrium(NamedTuple):
    """A point load's balance of forces, cables taken as rods that may push.

    W : (2, m); w_e : (2,) weight and push [N]
    tensions : (m,) negative where a cable would have to push [N]
    null_vector : (m,) h with W h = 0, its largest entry 1 in size; zeros where there is none
    """

    W: Array
    w_e: Array
    tensions: Array
    null_vector: Array

    @property
    def residual(self) -> Array:
        """(2,) W τ + w_e, what the cables leave unbalanced [N]."""
        return self.W @ self.tensions + self.w_e

    @property
    def closed(self) -> bool:
        """Whether the forces add up to zero."""
        return bool(np.linalg.norm(self.residual) <= _CLOSED * (1 + np.linalg.norm(self.w_e)))

    @property
    def slack(self) -> Flags:
        """(m,) True where a cable would have to push; rounding aside."""
        return self.tensions < -_CLOSED * (1 + np.abs(self.tensions).max())

    @property
    def left_over(self) -> Array:
        """(2,) W max(τ, 0) + w_e, the force that real cables leave, which only pull [N]."""
        return self.W @ np.where(self.slack, 0.0, self.tensions) + self.w_e

    def held(self, tensions: ArrayLike) -> Equilibrium:
        """The same load with somebody's own (m,) tensions [N]."""
        return self._replace(tensions=as_array(tensions, "tensions", (self.tensions.size,), "N"))

    def words(self) -> str:
        """The numbers as text."""
        said = "The polygon is closed and every cable pulls."
        if not self.closed:
            said = (f"The forces do not balance: {np.linalg.norm(self.residual):.1f} N are left over, "
                    "the polygon stays open.")
        elif self.slack.any():
            pushes = " and ".join(f"cable {i + 1} would have to push {-self.tensions[i]:.1f} N"
                                  for i in np.flatnonzero(self.slack))
            said = f"The polygon closes on paper only: {pushes}, and cables only pull (slack!)."
        return f"τ = ({', '.join(map(decimal, self.tensions))}) N. {said}"


@checked
def point_load(n_cables: int) -> Robot:
    """A 10 kg load in a vertical plane, hung on two, three or four cables.

    n_cables : 2 (both from above), 3 (one from below) or 4 (a rectangle of exit points)
    Raises InvalidInput for another number.

    >>> point_load(3)
    Robot(2T, 3 cables, 10 kg)
    """
    if n_cables not in EXIT_POINTS:
        raise InvalidInput(f"the point load hangs on 2, 3 or 4 cables, got {quoted(n_cables)}")
    here = np.zeros(2)
    cables = tuple(Cable(np.array(exit_point), here, 0.0, 1e4) for exit_point in EXIT_POINTS[n_cables])
    load = Platform(MASS, np.array(0.1), here, np.array([0.2, 0.2]), here)
    return Robot(MOTION_PATTERNS["2T"], load, cables)


def equilibrium(robot: Robot, position: ArrayLike, push: ArrayLike = (0.0, 0.0), internal: float = 0.0) -> Equilibrium:
    """τ = −W⁺ w_e + λ h: the least tensions, and an internal tension that no one sees from outside.

    robot : of pattern 2T
    position : (2,) of the load [m]
    push : (2,) external force beside the weight [N]
    internal : λ, the internal tension of the most stretched cable [N]
    Raises InvalidInput where a cable has no length.

    >>> equilibrium(point_load(2), [0, 1]).tensions.round(2)
    array([69.37, 69.37])
    """
    pose = Pose(as_array(position, "position", (2,), "m"))
    W = wrench_matrix(robot, pose)
    w_e = gravity_wrench(robot, pose) + as_array(push, "push", (2,), "N")
    least = distribute_tensions(W, w_e, robot.tension_min, robot.tension_max, "pseudo_inverse").tensions
    h = null_vector(W)
    return Equilibrium(W, w_e, least + internal * h, h)


def circle_crossings(centers: ArrayLike, lengths: ArrayLike) -> Array:
    """Where a point on two cables may be: A_1 + s e ± h e_⊥, s = (l_1² − l_2² + d²) / 2d and h² = l_1² − s².

    centers : (2, 2) one row an exit point, not both at one place [m]
    lengths : (…, 2) of the cables [m]
    Returns (…, 2, 2) both places, the lower one first [m]; nan where the circles miss each
    other.

    >>> circle_crossings([[0, 3], [5, 3]], [3, 4])
    array([[1.8, 0.6],
           [1.8, 5.4]])
    """
    first, second = as_array(centers, "centers", (2, 2), "m")
    l1, l2 = np.moveaxis(as_array(lengths, "lengths", (2,), "m", batch=True), -1, 0)
    d = np.linalg.norm(second - first)
    if d == 0:
        raise InvalidInput(f"circles around one place cross everywhere or nowhere: both exit points are at {first}")
    along = (second - first) / d
    s = (l1**2 - l2**2 + d**2) / (2 * d)
    square = l1**2 - s**2
    h = np.sqrt(np.where(square < 0, np.nan, square))
    downwards = np.array([along[1], -along[0]]) * np.copysign(1.0, along[0])
    middle, aside = first + s[..., None] * along, h[..., None] * downwards
    return np.stack([middle + aside, middle - aside], axis=-2)


def lower_crossing(first: Array, second: Array, l1: float, l2: float) -> Array:
    """Where a load hangs on two cables; raises ValueError where no point has these lengths.

    >>> lower_crossing([0, 3], [5, 3], 3, 4)
    array([1.8, 0.6])
    """
    lower: Array = circle_crossings([first, second], [l1, l2])[0]
    if np.isnan(lower).any():
        raise ValueError("no point has these lengths")
    return lower


def null_vector(W: Array) -> Array:
    """h with W h = 0 whose smallest entry is as large as can be, max |h_i| = 1; zeros where W has no null space.

    W : (n, m)
    Returns (m,); all entries positive exactly where a positive null vector exists.

    >>> null_vector(np.array([[1.0, -2.0]]))
    array([1. , 0.5])
    """
    from scipy.linalg import null_space

    kernel = null_space(W)
    m, r = kernel.shape
    if r == 0:
        return np.zeros(m)
    # h = N z with t ≤ h_i ≤ 1, t as large as possible, and so never below zero.
    rows = np.block([[-kernel, np.ones((m, 1))], [kernel, np.zeros((m, 1))]])
    h = kernel @ largest_last(rows, np.repeat([0.0, 1.0], m))[1]
    if np.abs(h).max() < 1e-9:  # no h ≥ 0 but zero: any direction will do
        h = kernel[:, 0] * np.copysign(1.0, kernel[:, 0].sum())
    return h / np.abs(h).max()


def decimal(value: float) -> str:
    """One decimal, with a true minus and no negative zero.

    >>> decimal(-0.01), decimal(-12.34)
    ('0.0', '−12.3')
    """
    return fixed(value, 1).replace("-", "−")
