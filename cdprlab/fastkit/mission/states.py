"""FASTKIT's mission, one state after the other: drive to the shelf, stand, deploy, pick and place, return, drive home.

    navigation ─ at the shelf ─▶ undeployed ─ stands still ─▶ deployed ─ base in place ─▶ pick
    and place │ box in place stopped ◀─ any guard that stays shut, any fault          done ◀─ at
    home ─ home ◀─ coupled again ─ return

"stopped" is safe, and says why: bases stand still, cables keep holding the platform, the
gripper stays as it is.
"""

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

from numpy.typing import ArrayLike

from ...arrays import as_array, checked
from ...errors import InvalidInput
from ...world import World
from ...world.model import PickAndPlace
from ..events import DONE, STOPPED, Event, as_reason
from ..navigation.driving import Walker
from .guards import at_home, at_the_shelf, base_in_place, box_in_place, coupled_again, stands_still
from .mission_record import Mission
from .trip import Progress, Trip, Work, watch


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
def run_mission(world: World, bounds: ArrayLike, start: ArrayLike, task: str = "pick_and_place",
                *, station: ArrayLike = (0.2, -0.4, 0.0), walkers: tuple[Walker, ...] = (),
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
    Raises InvalidInput for a task of another kind, or one that begins deployed.
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
    trip = Trip(world, job, as_array(bounds, "bounds", (2, 2), "m"),
                as_array(start, "start", (3,), "m, m, rad"),
                as_array(station, "station", (3,), "m, m, rad"), walkers, beams, progress)
    mission, began = Mission(world, task, seed), time.perf_counter()
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
              partial(trip.work_there, work=work), base_in_place),
        Stage("pick and place", "the box from its place to the other",
              watch, box_in_place, "approach"),
        Stage("return", "the platform goes back, the bases fold, the link closes",
              watch, coupled_again, "return"),
        Stage("home", "coupled, the pair leaves its berth and drives back",
              trip.drive_home, at_home),
    )
