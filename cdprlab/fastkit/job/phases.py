"""The phases of pick and place, from a task: deploy, take the box, carry it, put it down, return, perhaps fold."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array
from ...errors import InvalidInput
from ...mechanics.trajectory import PEAK_SPEED
from ...robot.pose import Pose
from ...world import World
from ...world.model import PickAndPlace
from ..plane import placed, relative
from .machine import Phase, Readings, box_there, settled

BOX = "box"

ACCELERATION = 0.2
"""[m/s² and rad/s²] of bases, as gently as a loaded trolley is pushed."""

_DRAWING = 4.0      # s for the gripper's whole stroke
_LIFT = np.array([0.0, 0.0, 0.003])   # m: a box that is drawn out comes over its board's edge without catching
_OVERLAP = 0.006    # m of the box over its board as it is set down


def job_phases(world: World, task: PickAndPlace, speed: float = 0.5,
               fold: bool = False) -> tuple[Phase, ...]:
    """What happens, in order.

    world : as it is to be once deployed
    speed : the platform's largest, carrying or not [m/s]
    fold : whether the bases come together again in the end
    """
    folding = _folding(world, task) if fold else ()
    return (*_deployment(world, task), *_picking_and_placing(task, speed), *folding)


def _deployment(world: World, task: PickAndPlace) -> Iterator[Phase]:
    if not task.coupled:
        return
    yield Phase("coupled", "both bases stand together, the link closed", 0.5,
                begin=lambda engine: engine.bases.couple())
    yield Phase("uncouple", "the electromagnetic link opens", 0.3,
                begin=lambda engine: engine.bases.uncouple())
    yield from _legs(world, task, {"sidestep": "clear of the shelf",
                                   "deploy": "the active base drives away, the platform stays",
                                   "line up": "the base takes its place"})
    yield Phase("stabilize", "the stabilizers go down, no base can drive", 0.5,
                begin=lambda engine: engine.bases.lower_stabilizers())


def _folding(world: World, task: PickAndPlace) -> Iterator[Phase]:
    """The deployment's way, back."""
    if not task.coupled:
        raise InvalidInput("bases are to fold back, but the task names no `coupled:` base and its pose")
    yield Phase("lift feet", "the stabilizers go up, the bases stand on wheels", 0.5,
                begin=lambda engine: engine.bases.raise_stabilizers())
    yield from _legs(world, task, {"step out": "clear of the shelf again",
                                   "fold": "the active base drives back, the platform stays",
                                   "close up": "beside the other base, as before"}, back=True)
    yield Phase("link", "the electromagnetic link closes", 0.5, drives=dict(task.coupled),
                guard=_arrived, begin=lambda engine: engine.bases.couple())


def _legs(world: World, task: PickAndPlace, words: dict[str, str],
          back: bool = False) -> Iterator[Phase]:
    """Each base's way from its coupled place to its own, a state each: out sideways, along, back in.

    Without ``aside`` it is only along; ``back`` is the same way turned round.
    """
    for name, coupled in task.coupled.items():
        base = world.robot.base(name)
        stops, told = [base.pose, coupled] if back else [coupled, base.pose], list(words.items())
        if task.aside:   # along the base's own y axis
            stops[1:1] = map(tuple, placed(stops, [0.0, task.aside, 0.0]).tolist())
        else:
            told = told[1:2]
        for (state, what), here, there in zip(told, stops, stops[1:]):
            lasting = driving_time(relative(there, here), base.speed_max[[1, 2, 0]], ACCELERATION)
            yield Phase(state, what, lasting.max(), drives={name: there}, guard=_arrived)


def _picking_and_placing(task: PickAndPlace, speed: float) -> Iterator[Phase]:
    before, at, hooking = _stations(task, task.box_position)
    yield _move("approach", "to the box", task.start, before, speed)
    yield Phase("tilt", "the lip goes down, by cable lengths alone", 1.0,
                Pose.of(before.position, hooking.rotation))
    yield Phase("reach", "forward, the lip under the box's edge", 1.5, hooking)
    yield Phase("hook", "level again", 1.0, at, guard=box_there)
    yield Phase("grip", "the gripper closes", 0.3, begin=lambda engine: engine.boxes.grip(BOX))
    yield Phase("draw in", "the box slides from its board into the tray", _DRAWING,
                stroke=(1.0, 0.0))
    yield Phase("back off", "away from the shelf", 1.5, before)
    leaving = before
    before, at, hooking = _stations(task, task.place)
    yield _move("carry", "to the box's place", leaving, Pose(before.position + _LIFT), speed)
    yield Phase("present", "forward, up to the board", 1.5, Pose(at.position + _LIFT))
    # Onto the board before its weight is handed over: a stiff robot would carry on carrying.
    length, depth = _strokes(task)
    over = min(1.0, (max(length - depth, 0.0) + _OVERLAP) / length)
    yield Phase("push", "the box's edge comes over its board", _DRAWING * over,
                stroke=(0.0, over))
    yield Phase("set down", "down onto the board", 0.8, at)
    yield Phase("push out", "the box slides onto its board", _DRAWING, stroke=(over, 1.0))
    yield Phase("release", "the gripper opens", 0.5,
                begin=lambda engine: engine.boxes.release(BOX))
    yield Phase("unhook", "the lip goes down", 1.0, hooking)
    yield Phase("retreat", "away from the shelf", 1.5,
                Pose.of(before.position, hooking.rotation))
    yield Phase("level", "level again", 1.0, before)
    yield _move("return", "back to the start", before, task.start, speed)


def _stations(task: PickAndPlace, box: Array) -> tuple[Pose, Pose, Pose]:
    """Before the shelf, at it, and at it with the lip down, for a box standing there."""
    at = box - task.seat - task.stroke
    inward = task.stroke / np.linalg.norm(task.stroke)
    return Pose(at - task.clearance * inward), Pose(at), Pose(at, rpy=task.tilt)


def _move(name: str, what: str, start: Pose, end: Pose, speed: float) -> Phase:
    way = float(np.linalg.norm(end.position - start.position))
    return Phase(name, what, max(1.0, PEAK_SPEED * way / speed), end)


def _arrived(sensors: Readings) -> str:
    if sensors.base_error > 0.01:
        return f"a base is {sensors.base_error * 1e3:.0f} mm from its place"
    return settled(sensors)


# --- motions along one line ---------------------------------------------------------------------------
def driving_time(way: ArrayLike, limit: ArrayLike, acceleration: float) -> Array:
    """(…) how long rest-to-rest drives over ways (…) take with these limits (…) [s].

    >>> driving_time([1.0, 0.0], 0.2, 0.2).round(6).tolist()
    [6.0, 0.0]
    """
    far = np.abs(way)
    far = np.where(far > 1e-9, far, 0.0)
    top = np.minimum(limit, np.sqrt(far * acceleration))
    if ((top <= 0) & (far > 0)).any():
        raise InvalidInput("a base is to drive in a direction that its speed limits hold")
    return far / np.where(far > 0, top, 1.0) + top / acceleration


def driving_speed(t: float, way: ArrayLike, limit: ArrayLike, acceleration: float) -> Array:
    """(…) the speeds of these drives at time t: up with ``acceleration``, steady, down again [m/s or rad/s].

    >>> float(driving_speed(3.0, -1.0, 0.2, 0.2))
    -0.2
    """
    left = driving_time(way, limit, acceleration) - t
    return np.sign(way) * np.clip(acceleration * np.minimum(t, left), 0.0, limit)


def payload(task: PickAndPlace, stroke: float) -> tuple[float, Array]:
    """What the platform carries of a box between tray and board: mass [kg] and where [m], platform frame.

    The board carries the box until its center is over the edge, and nothing once its far face
    has left it; in between the weight is handed over evenly, all of it at the place where the
    box leaves its board.

    stroke : 0 drawn in, 1 on its board, where its near face is flush with the edge

    >>> from types import SimpleNamespace
    >>> task = SimpleNamespace(stroke=np.array([0, 0.4, 0]), box_size=np.array([0.4, 0.3, 0.15]), box_mass=7.0,
    ...                        seat=np.zeros(3))
    >>> [payload(task, s)[0] for s in (1.0, 0.4375, 0.2, 0.0)]
    [0.0, 3.5, 7.0, 7.0]
    """
    length, depth = _strokes(task)
    inward = task.stroke / length
    off, over, leaves = stroke * length, length - depth / 2, length - depth
    share = float(np.clip((over - off) / (over - leaves), 0.0, 1.0))
    return task.box_mass * share, task.seat + min(off, leaves) * inward


def _strokes(task: PickAndPlace) -> tuple[float, float]:
    """The stroke's length, and the box's along it [m]."""
    length = float(np.linalg.norm(task.stroke))
    return length, float(np.abs(task.box_size @ task.stroke)) / length
