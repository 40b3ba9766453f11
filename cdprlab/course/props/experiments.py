"""Statics put to the test: hold tensions on a planar robot and let it go, or hang one on ropes of given lengths."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, Flags, as_array
from ...errors import InvalidInput, NoConvergence, quoted
from ...mechanics.cables import cable_lengths
from ...mechanics.rest import equilibrium
from ...robot import Robot
from ...robot.pose import Pose
from ...simulate import open_simulator
from ...world import World
from ...world.model import Scene

_DEEP = -1e3
"""Of the floor, which no experiment of seconds reaches [m]."""

_LOOSE = 1e-5
"""A rope with more than this to spare is slack [m]."""


class Motion(NamedTuple):
    """What the engine saw.

    time : (k,) since it was let go, 0 first [s]
    positions : (k, 2) of P [m]
    acceleration : (n,) over the first step [m/s², rad/s²]
    """

    time: Array
    positions: Array
    acceleration: Array

    @property
    def way(self) -> float:
        """From where it was let go [m]."""
        return float(np.linalg.norm(self.positions[-1] - self.positions[0]))


def let_go(robot: Robot, pose: Pose, tensions: ArrayLike, push: ArrayLike | None = None,
           duration: float = 0.5) -> Motion:
    """The first moments of a planar robot whose winches hold these tensions: M a = W max(τ, 0) + w_e.

    robot : planar
    pose : where it is at rest
    tensions : (m,) held [N]; where one is negative the rope hangs slack and carries nothing
    push : (n,) external wrench beside the weight [N, N m]
    duration : at least one step of 1 ms [s]
    Raises InvalidInput for numbers of another shape, or a robot in space.

    >>> from cdprlab.course.props.point_load import point_load
    >>> let_go(point_load(2), Pose([0, 1], angle=0), [-50, 0]).acceleration
    array([ 0.  , -9.81])
    """
    if robot.dimension != 2:
        raise InvalidInput(f"this experiment is for planar robots, got {quoted(robot)}")
    pulls = np.maximum(as_array(tensions, "tensions", (robot.n_cables,), "N"), 0.0)
    alone = World("alone", "", "", robot, pose, Scene(None, _DEEP, ()), {}, None)
    with open_simulator(alone) as engine:
        if push is not None:
            engine.push(push)
        places, twists = [engine.position], []
        for _ in range(round(duration / engine.dt)):
            engine.step(pulls)
            places.append(engine.position)
            twists.append(engine.twist)
    return Motion(np.arange(0.0, len(places)) * engine.dt, np.array(places),
                  twists[0][:robot.n_dof] / engine.dt)


class Settled(NamedTuple):
    """A robot at rest on its ropes.

    pose : of the platform
    spare : (m,) rope let out beyond the distance it spans [m]
    """

    pose: Pose
    spare: Array

    @property
    def slack(self) -> Flags:
        """(m,) True where a rope hangs through."""
        return self.spare > _LOOSE


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
