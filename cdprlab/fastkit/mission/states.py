"""FASTKIT's mission, one state after the other: drive to the shelf, stand, deploy, pick and place, return, drive home.

    navigation ─ at the shelf ─▶ undeployed ─ stands still ─▶ deployed ─ base in place ─▶ pick and place
    done ◀─ at home ─ home ◀─ coupled again ─ return ◀─ box in place ─────────────────────────────┘

    any of them ─ a guard that stays shut, a fault ─▶ stopped

"stopped" is safe, and says why: bases stand still, cables keep holding the platform, the
gripper stays as it is.
"""

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from ...arrays import Array, checked
from ...errors import InvalidInput, Recording
from ...world import World
from ...world.model import PickAndPlace
from ..events import DONE, STOPPED, Event, as_reason
from ..navigation.driving import Walker
from ..navigation.journey import Journey
from ..plane import Bounds, Place, difference
from .mission_record import Mission
from .trip import COUPLED, Progress, Trip, Work, watch

AT_THE_SHELF = np.array([0.05, 0.05, np.radians(2.0)])
"""As far as the pair may be off its berth, by its own belief and what that is worth [m, m, rad]."""

AT_HOME = np.array([0.1, 0.1, np.radians(5.0)])
"""The same for where the mission began: nothing there has to be met to the centimeter."""

LEANS = np.radians(0.5)
"""A base whose mast is tilted more than this leans [rad]."""


class Stage(NamedTuple):
    """One state of the mission.

    name : of it; what : the same in words
    act : what is done in it
    guard : asked then: '' when the next state may begin, else what is in the way
    begins : where the act of an earlier state did this one too: the job's own state it began
        with
    """

    name: str
    what: str
    act: Callable[[Mission], None]
    guard: Callable[[Mission], str]
    begins: str = ""


@checked
def run_mission(world: World, bounds: Bounds, start: Place, task: str = "pick_and_place",
                *, station: Place = (0.2, -0.4, 0.0), walkers: tuple[Walker, ...] = (),
                seed: int = 0, beams: int = 271, work: Work | None = None,
                progress: Progress | None = None) -> Mission:
    """From somewhere in a hall to the shelf, the task there, and back to where it began.

    world : spatial, a pair of bases, its scene the hall
    task : of kind pick_and_place, with coupled bases
    bounds : (2, 2) of the floor [m]
    start : (3,) pose of the coupled pair, as it is told [m, m, rad]
    station : (3,) from the berth, in its frame, to where the straight drive into it begins
        [m, m, rad]
    walkers : people; seed : of all noise, that of the true start included
    beams : of each scanner
    work : what is done at the shelf, by default `pick_and_place`, bases folded in the end
    progress : called with the state and the simulated time
    Returns Mission; a failure ends it in "stopped" with the reason.
    Raises InvalidInput for a task of another kind, or one that begins deployed. What ends it early
    carries the mission until then, as ``.run``.
    Source: Pedemonte et al. 2020, section 2.3 and Fig. 3; the way home is the way there turned
    round.

    >>> import cdprlab as cl
    >>> run_mission(cl.load_world("fastkit_suspended"), [[-5, -5], [5, 5]], [0, 0, 0], "default")
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: task 'default' is of kind quintic: a mission needs one of kind pick_and_place
    """
    job = world.task(task)
    if not isinstance(job, PickAndPlace):
        raise InvalidInput(f"task {task!r} is of kind {job.kind}: a mission needs one of kind pick_and_place")
    if not job.coupled:
        raise InvalidInput(f"task {task!r} begins deployed: name the `coupled:` base and its pose")
    trip = Trip(world, job, bounds, start, station, walkers, beams, progress)
    mission, began = Mission(world, task, seed), time.perf_counter()
    with Recording(mission.cut):
        # One by one: acts look at the events until then.
        for event in walk_through(mission, mission_states(trip, work)):
            mission.events.append(event)
    mission.real_time_factor = mission.now / (time.perf_counter() - began)
    return mission


@checked
def walk_through(mission: Mission, states: tuple[Stage, ...]) -> Iterator[Event]:
    """The whole machine: enter a state, act, ask its guard, go on or stop."""
    for state in states:
        yield Event(mission.when(state.begins), state.name)
        state.act(mission)
        missing = as_reason(state.guard(mission), mission.now)
        if missing:
            yield Event(mission.now, STOPPED, f"in {state.name}: {missing}")
            return
    yield Event(mission.now, DONE)


@checked
def mission_states(trip: Trip, work: Work | None = None) -> tuple[Stage, ...]:
    """The states of Fig. 3 and what is between them, in order; ``work`` is one act that three of them watch."""
    return (
        Stage("navigation", "coupled, the pair drives to its berth; no cable moves",
              trip.drive_there, at_the_shelf),
        Stage("undeployed", "at the berth, still coupled", watch, stands_still),
        Stage("deployed", "the link opens, the active base drives away",
              partial(trip.work_there, work=work), partial(job_came_to, "approach")),
        Stage("pick and place", "the box from its place to the other",
              watch, partial(job_came_to, "return"), "approach"),
        Stage("return", "the platform goes back, the bases fold, the link closes",
              watch, coupled_again, "return"),
        Stage("home", "coupled, the pair leaves its berth and drives back",
              trip.drive_home, at_home),
    )


# --- guards: '' when the next state may begin, else what is in the way ------------------------------------------------
def at_the_shelf(mission: Mission) -> str:
    """navigation → undeployed: arrived, and sure of it."""
    return _arrived("its berth", mission.journey, AT_THE_SHELF)


def stands_still(mission: Mission) -> str:
    """undeployed → deployed: all wheels carry, no base leans."""
    measured = mission.journey and mission.journey.measured
    if not measured:
        return ""
    if measured["wheels"][-1].min() < 1.0:
        return "a wheel carries nothing"
    return "a base leans" if measured["tilts"][-1] > LEANS else ""


def job_came_to(state: str, mission: Mission) -> str:
    """deployed → pick and place: the job approached the box. → return: the box is in its place, the gripper open."""
    job = mission.job
    if job is None:
        return "there was no job"
    came = any(event.state == state for event in job.events)
    return "" if came else job.reason or f"it ended in {job.state}"


def coupled_again(mission: Mission) -> str:
    """return → home: the job is done, and the bases are where the link takes them."""
    trouble, job = job_came_to(DONE, mission), mission.job
    if trouble or job is None:
        return trouble
    places = job.world.robot.with_bases(job.world.task(mission.task).coupled).bases      # type: ignore[attr-defined]
    apart = job.base_poses[-1, :, :2] - [base.position for base in places]
    off = np.linalg.norm(apart, axis=1).max()
    return "" if off <= COUPLED else f"the bases are not together: one is {off * 1e3:.0f} mm off its coupled place"


def at_home(mission: Mission) -> str:
    """home → done: arrived, and sure of it."""
    return _arrived("where it began", mission.way_home, AT_HOME)


def sure_of_being_at(berth: Array, believed: Array, deviations: Array, allowed: Array,
                     place: str = "its berth") -> str:
    """'' if the pair is where it should be, two standard deviations (3,) counted in, else how far off it may be."""
    off = np.abs(difference(berth, believed)) + 2 * deviations
    return "" if (off <= allowed).all() else (f"the pair may be {np.hypot(*off[:2]) * 1e3:.0f} mm and "
                                              f"{np.degrees(off[2]):.1f}° off {place}")


def _arrived(place: str, way: Journey | None, tolerance: Array) -> str:
    if way is None:
        return "there was no journey"
    return way.reason or sure_of_being_at(way.goal, way.estimates[-1], way.deviations[-1], tolerance, place)
