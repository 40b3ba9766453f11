"""A sequence of configurations as rope lengths over time: the chosen cables taut, the others let out by some slack."""

from collections.abc import Iterator
from typing import Annotated

import numpy as np

from ..arrays import Array, Flags, checked, frozen_dataclass
from ..errors import InvalidInput
from ..mechanics.cables import cable_lengths
from ..mechanics.trajectory import PEAK_SPEED, rest_to_rest
from ..robot import Robot
from ..robot.pose import Pose
from .sequence import ConfigurationSequence


@frozen_dataclass
class Winding:
    """What the winches do, one row a time step.

    time : (N,) [s]; positions : (N, 3) where the load shall be [m]
    lengths : (N, m) of rope let out [m]
    taut : (N, m) whether the plan lets the cable be taut; while it changes, both the old and
        the new ones, and all of them until the first slack is out
    """

    time: Array
    positions: Array
    lengths: Array
    taut: Flags


STEP = 1e-3
"""[s] between two rows of a plan."""

_MOST_STEPS = 1_000_000

Speed = Annotated[float, "[m/s] > 0"]


@checked
def winding_plan(robot: Robot, sequence: ConfigurationSequence,
                 slack: Annotated[float, "[m] ≥ 0"] = 0.2, speed: Speed = 0.2,
                 reeling: Speed = 0.05) -> Winding:
    """Rope lengths that lead a point mass along a sequence.

    The cables that shall not carry are first let out by ``slack``; then the load moves from
    step to step. All is done rest to rest. At a change the cable that comes in is taken up
    **before** the one that goes is paid out: done at once, two taut cables would be left for a
    moment, and the load would swing.

    robot : as the sequence was planned for; slack : 0 winds every rope by inverse kinematics
        alone [m]
    speed : the load's largest [m/s]
    reeling : of slack taken up and let out, slow enough for the load to follow without swinging
        [m/s]
    Raises InvalidInput for numbers that are not positive (slack: negative), or speeds above a
    winch's limit.
    Source: Ramadour and Merlet 2014, sections II and VI (slack of 0.20 m); the order of the
    change is our own.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("marionet").robot
    >>> best = cl.plan_configurations(robot, [0.6, 0.8, 0.8], [1.9, 1.1, 0.5])[0]
    >>> winding_plan(robot, best).lengths.shape[1]
    4
    """
    if max(speed, reeling) > robot.speed_max.min():
        raise InvalidInput(f"speed and reeling must not exceed the winches' {robot.speed_max.min():g} m/s, "
                           f"got {speed:g} and {reeling:g} m/s")
    rows, flags = [], []
    at = np.append(sequence.steps[0][0], np.zeros(robot.n_cables))
    for end, taut in _legs(robot.n_cables, sequence, slack):
        way = end - at
        duration = PEAK_SPEED * max(np.linalg.norm(way[:3]) / speed,
                                    np.abs(way[3:]).max() / reeling)
        if duration / STEP > _MOST_STEPS:
            raise InvalidInput(f"a leg takes {duration:.3g} s, more than {_MOST_STEPS} steps of {STEP:g} s: "
                               "give less slack or more speed")
        count = int(np.ceil(duration / STEP))
        # Rest to rest: a rope that is a little off becomes taut, or slack, while the winch is
        # slow, and jerks nothing.
        rows.append(at + rest_to_rest(np.arange(1, count + 1)[:, None] / count) * way)
        flags.append(np.tile(taut, (count, 1)))
        at = end
    positions, loose = np.split(np.concatenate(rows), [3], axis=1)
    lengths = cable_lengths(robot, Pose(positions)) + loose
    return Winding(np.arange(1.0, len(positions) + 1) * STEP, positions, lengths,
                   np.concatenate(flags))


def _legs(m: int, sequence: ConfigurationSequence, slack: float) -> Iterator[tuple[Array, Flags]]:
    """Where each leg ends, position and slack of each cable in a row, and which cables the plan lets be taut on it."""
    held = np.ones(m, dtype=bool)   # until the slack is out, chance decides which cables carry
    for place, chosen in sequence.steps:
        new = np.isin(np.arange(m), chosen.indices)
        both = held | new
        for taut in (both, new):
            yield np.append(place, np.where(taut, 0.0, slack)), both
        held = new
