"""Hang a planar robot on ropes of given lengths and wait: where does it come to rest, and which ropes are taut?"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_array
from ...robot import Robot
from ...robot.pose import Pose
from ...simulate import Simulator, open_simulator
from .bare_world import bare_world
from .changed_cables import every_cable

_STEP, _WINDING, _LONGEST = 8e-3, 0.4, 15.0
"""Time step, time in which the winches bring the ropes to length, and the end of all patience [s]."""

_ITERATIONS = 300
"""Of the solver: whichever ropes go slack, the few that stay taut may pull almost against each other and need many."""

_LULLS, _TUGS = 10, 50
"""Steps in a row after which a standstill is rest and no turning point of a swing, and after which ropes that are too
short may end their tug-of-war, which never rests."""

_RESTS = 1e-6
"""Slower is called rest [m/s, rad/s]; what is still to go is then a few micrometers."""

_LOOSE = 1e-5
"""A rope with more than this to spare is slack, and one longer than told by more than this has been torn [m]."""


class Settled(NamedTuple):
    """A robot at rest on its ropes.

    pose : of the platform
    tensions : (m,) [N]
    spare : (m,) rope let out beyond the distance it spans [m]; negative where the engine could
        not keep to the length
    """

    pose: Pose
    tensions: Array
    spare: Array

    @property
    def fits(self) -> bool:
        """Whether some pose is within reach of all ropes; where none is, something would tear."""
        return bool(self.spare.min() >= -_LOOSE)

    @property
    def slack(self) -> Array:
        """(m,) True where a rope hangs through."""
        return np.asarray(self.spare > _LOOSE)


def hang(robot: Robot, lengths: ArrayLike, start: Pose) -> Settled:
    """Where a planar robot comes to rest: the lowest place with every distance ‖a_i − p − R b_i‖ ≤ l_i.

    robot : planar; its winches are taken as fast as needed
    lengths : (m,) of the ropes [m]
    start : where the platform is before the winches bring the ropes to these lengths
    Raises InvalidInput for lengths of another shape or not positive.

    >>> from cdprlab.course.props.point_load import point_load
    >>> settled = hang(point_load(2), [2.5, 2.5], Pose([0, 2], angle=0))
    >>> settled.pose.position.round(6) + 0.0, settled.tensions.round(2)
    (array([0. , 1.5]), array([81.75, 81.75]))
    """
    wanted = as_array(lengths, "lengths", (robot.n_cables,), "m")
    with open_simulator(bare_world(every_cable(robot, speed_max=np.inf), start),
                        cables="length", dt=_STEP,
                        solver_iterations=_ITERATIONS) as engine:
        drag = _critical_drag(robot, wanted)
        given, winding, lulls, tugs = engine.lengths, round(_WINDING / _STEP), 0, 0
        for k in range(1, round(_LONGEST / _STEP)):
            twist = engine.twist[:robot.n_dof]
            lulls = lulls + 1 if k > winding and np.abs(twist).max() < _RESTS else 0
            tugs = tugs + 1 if k > winding and _torn(engine, wanted) else 0
            if lulls > _LULLS or tugs > _TUGS:
                break
            engine.push(-drag * twist)
            engine.wind(given + min(k / winding, 1.0) * (wanted - given))
        return Settled(Pose.of(engine.position, engine.rotation), engine.tensions,
                       wanted - engine.lengths)


def _torn(engine: Simulator, lengths: Array) -> bool:
    """Ropes on a swing are some micrometers off, the engine turns them once a step; more than 1 mm is no swing."""
    return bool((engine.lengths - lengths).max() > 1e-3)


def _critical_drag(robot: Robot, lengths: Array) -> Array:
    """(n,) of air as thick as oil, in which a pendulum on the shortest rope comes to rest soonest [N s/m, N m s]."""
    inertia = np.array([robot.mass, robot.mass, float(robot.platform.inertia)])[:robot.n_dof]
    return np.asarray(2 * np.sqrt(max(robot.gravity, 1.0) / lengths.min()) * inertia)
