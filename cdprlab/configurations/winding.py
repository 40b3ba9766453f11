"""A sequence of configurations as rope lengths over time: the chosen cables taut, the others let out by some slack."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Flags, as_number
from ..errors import InvalidInput
from ..mechanics.cables import cable_lengths
from ..mechanics.trajectory import PEAK_SPEED, quintic, rest_to_rest
from ..robot import Robot
from ..robot.pose import Pose
from .configuration import Configuration
from .sequence import ConfigurationSequence


@dataclass(frozen=True, eq=False)
class Winding:
    """What the winches do, one row a time step.

    time : (N,) [s]; positions : (N, 3) where the load shall be [m]
    lengths : (N, m) of rope let out [m]
    taut : (N, m) whether the plan lets the cable be taut; while it changes, both the old and the new ones, and all
        of them until the first slack is out
    """

    time: Array
    positions: Array
    lengths: Array
    taut: Flags


def winding_plan(robot: Robot, sequence: ConfigurationSequence, slack: float = 0.2, speed: float = 0.2,
                 reeling: float = 0.05, dt: float = 1e-3) -> Winding:
    """Rope lengths that lead a point mass along a sequence.

    The cables that shall not carry are first let out by ``slack``; then the load moves from step to step. All is done
    rest to rest. At a change the cable that comes in is taken up **before** the one that goes is paid out: done at
    once, two taut cables would be left for a moment, and the load would swing.

    robot : as the sequence was planned for; slack : 0 winds every rope by inverse kinematics alone [m]
    speed : the load's largest [m/s]
    reeling : of slack taken up and let out, slow enough for the load to follow without swinging [m/s]
    dt : [s]
    Raises InvalidInput for numbers that are not positive (slack: negative), or speeds above a winch's limit.
    Source: Ramadour and Merlet 2014, sections II and VI (slack of 0.20 m); the order of the change is our own.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("marionet").robot
    >>> best = cl.plan_configurations(robot, [0.6, 0.8, 0.8], [1.9, 1.1, 0.5])[0]
    >>> winding_plan(robot, best).lengths.shape[1]
    4
    """
    pace, step = as_number(speed, "speed", "m/s", positive=True), as_number(dt, "dt", "s", positive=True)
    reel = as_number(reeling, "reeling", "m/s", positive=True)
    if not 0 <= slack < np.inf:
        raise InvalidInput(f"slack must be zero or more [m], got {slack}")
    if max(pace, reel) > robot.speed_max.min():
        raise InvalidInput(f"speed and reeling must not exceed the winches' {robot.speed_max.min():g} m/s, "
                           f"got {pace:g} and {reel:g} m/s")
    pieces = list(_pieces(robot.n_cables, sequence, float(slack), pace, reel, step))
    positions, loose = np.concatenate([piece[0] for piece in pieces]), np.concatenate([piece[1] for piece in pieces])
    lengths = cable_lengths(robot, Pose(positions)) + loose
    return Winding(np.arange(1.0, len(positions) + 1) * step, positions, lengths,
                   np.concatenate([piece[2] for piece in pieces]))


_Piece = tuple[Array, Array, Flags]
"""Positions (k, 3), slack (k, m), whether taut (k, m)."""


def _pieces(m: int, sequence: ConfigurationSequence, slack: float, speed: float, reeling: float,
            dt: float) -> Iterator[_Piece]:
    place, chosen = sequence.steps[0]
    # Until the slack is out, chance decides which cables carry.
    yield _reeled(place, np.zeros(m), slack * _loose(m, chosen), np.ones(m, dtype=bool), reeling, dt)
    for here, now in sequence.steps[1:]:
        if now == chosen:
            yield _moved(place, here, slack * _loose(m, now), _held(m, now), speed, dt)
        else:
            both = _held(m, chosen) | _held(m, now)
            before, after = slack * _loose(m, chosen), slack * _loose(m, now)
            between = np.minimum(before, after)
            yield _reeled(place, before, between, both, reeling, dt)
            yield _reeled(place, between, after, both, reeling, dt)
        place, chosen = here, now


def _held(m: int, chosen: Configuration) -> Flags:
    held = np.zeros(m, dtype=bool)
    held[chosen.indices] = True
    return held


def _loose(m: int, chosen: Configuration) -> Array:
    return np.where(_held(m, chosen), 0.0, 1.0)


def _reeled(place: Array, before: Array, after: Array, taut: Flags, reeling: float, dt: float) -> _Piece:
    steps = int(np.ceil(PEAK_SPEED * np.abs(after - before).max() / reeling / dt))
    # Rest to rest: a rope that is a little off becomes taut, or slack, while the winch is slow, and jerks nothing.
    shares = rest_to_rest(np.arange(1, steps + 1)[:, None] / max(steps, 1))
    return np.tile(place, (steps, 1)), before + shares * (after - before), np.tile(taut, (steps, 1))


def _moved(start: Array, end: Array, loose: Array, taut: Flags, speed: float, dt: float) -> _Piece:
    duration = PEAK_SPEED * float(np.linalg.norm(end - start)) / speed
    steps = max(1, int(np.ceil(duration / dt)))
    path = quintic(Pose(start), Pose(end), steps * dt)(np.arange(1, steps + 1) * dt)
    return path.pose.position, np.tile(loose, (steps, 1)), np.tile(taut, (steps, 1))
