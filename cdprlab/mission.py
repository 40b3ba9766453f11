"""FASTKIT's mission, one state after the other: drive to the shelf, stand, deploy, pick and place, return.

    navigation ─ at the shelf ─▶ undeployed ─ stands still ─▶ deployed ─ base in place ─▶ pick and place
                                                                                             │ box in place
    stopped ◀─ any guard that stays shut, any fault, with its reason               done ◀─ return

"stopped" is safe: bases stand still, cables keep holding the platform, the gripper stays as it is.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, as_array
from .errors import InvalidInput
from .mission_drive import Drive, EnginePair, pair_pose
from .navigation import ARRIVED, Hall, Journey, Vehicle, Walker, navigate
from .navigation.plan_view import carried
from .navigation.vehicle import difference
from .picking import Job, pick_and_place
from .world import World
from .world.model import PickAndPlace

DONE, STOPPED = "done", "stopped"

AT_THE_SHELF = np.array([0.05, 0.05, np.radians(2.0)])
"""As far as the pair may be off its berth, by its own belief and what that is worth [m, m, rad]."""

Work = Callable[[World, str], Job]
"""What is done once the pair stands at the shelf: deploys, picks, places, returns."""


class Event(NamedTuple):
    """A state was entered: when [s], which, and why (where it is not as planned)."""

    time: float
    state: str
    why: str = ""


@dataclass
class Mission:
    """What happened, state by state.

    world, task : what was to be done; seed : of all noise
    state, reason : "done", or "stopped" and why
    events : states in order
    journey, drive : the way to the shelf, and what the engine measured on it
    job : what happened there
    real_time_factor : simulated over elapsed time
    """

    world: World
    task: str
    seed: int
    events: list[Event] = field(default_factory=list)
    journey: Journey | None = None
    drive: Drive | None = None
    job: Job | None = None
    real_time_factor: float = np.nan

    @property
    def state(self) -> str:
        """Name of the last state."""
        return self.events[-1].state if self.events else ""

    @property
    def reason(self) -> str:
        """'' or why it stopped."""
        return self.events[-1].why if self.events else ""

    @property
    def now(self) -> float:
        """Simulated time so far [s]."""
        return sum(float(part.time[-1]) for part in (self.journey, self.job) if part is not None)

    def when(self, begins: str) -> float:
        """When the job first was in that state; now, if it never was [s]."""
        if self.job is None or self.journey is None:
            return self.now
        times = [event.time for event in self.job.events if event.state == begins]
        return float(self.journey.time[-1]) + times[0] if times else self.now

    def table(self) -> dict[str, str]:
        """The mission in a few lines."""
        rows = {f"{number}. {event.state}": f"{event.time:.1f} s" + (f", {event.why}" if event.why else "")
                for number, event in enumerate(self.events, 1)}
        for part in (self.journey, self.job):
            if part is not None:
                rows.update({name: value for name, value in part.table().items() if name != "state"})
        return {**rows, "mission time": f"{self.now:.1f} s", "real-time factor": f"{self.real_time_factor:.1f}"}


class State(NamedTuple):
    """One state of the mission.

    name : of it; what : the same in words
    act : what is done in it; guard : '' when the next state may begin, else what is in the way
    begins : the job's own state it begins with, where an earlier act has done it already
    """

    name: str
    what: str
    act: Callable[[Mission], None]
    guard: Callable[[Mission], str]
    begins: str = ""


def run_mission(world: World, bounds: ArrayLike, start: ArrayLike, task: str = "pick_and_place", *,
                station: ArrayLike = (0.2, -0.4, 0.0), walkers: tuple[Walker, ...] = (), seed: int = 0,
                beams: int = 271, work: Work = pick_and_place, states: tuple[State, ...] | None = None) -> Mission:
    """From somewhere in a hall to the shelf, the task there, and back to the start pose of the platform.

    world : spatial, a pair of bases, its scene the hall; task : of kind pick_and_place, with coupled bases
    bounds : (2, 2) of the floor [m]; start : (3,) pose of the coupled pair, as it is told [m, m, rad]
    station : (3,) from the berth, in its frame, to where the last straight drive begins [m, m, rad]
    walkers : people; seed : of all noise, that of the true start included; beams : of each scanner
    work : what is done at the shelf; states : other than `mission_states`
    Returns Mission; a failure ends it in "stopped" with the reason.
    Raises InvalidInput for a task of another kind, or one that begins deployed.
    Source: Pedemonte et al. 2020, section 2.3 and Fig. 3.

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
    trip = Trip(world, job, as_array(bounds, "bounds", (2, 2), "m"), as_array(start, "start", (3,), "m, m, rad"),
                as_array(station, "station", (3,), "m, m, rad"), walkers, beams)
    mission, began = Mission(world, task, seed), time.perf_counter()
    for event in walk_through(mission, mission_states(trip, work) if states is None else states):
        mission.events.append(event)
    mission.real_time_factor = mission.now / (time.perf_counter() - began)
    return mission


def walk_through(mission: Mission, states: tuple[State, ...]) -> Iterator[Event]:
    """The whole machine: enter a state, act, ask its guard, go on or stop."""
    for state in states:
        yield Event(mission.when(state.begins), state.name)
        state.act(mission)
        missing = state.guard(mission)
        if missing:
            yield Event(mission.now, STOPPED, f"in {state.name}: {missing}")
            return
    yield Event(mission.now, DONE)


def mission_states(trip: Trip, work: Work = pick_and_place) -> tuple[State, ...]:
    """The states of Fig. 3 and what is between them, in order."""
    return (
        State("navigation", "coupled, the pair drives to its berth; no cable moves", trip.drive_there, at_the_shelf),
        State("undeployed", "at the berth, still coupled", _nothing, stands_still),
        State("deployed", "the link opens, the active base drives away; then the box", work_there(work, trip),
              base_in_place),
        State("pick and place", "the box from its place to the other", _nothing, box_in_place, "approach"),
        State("return", "the platform goes back to its start", _nothing, back_again, "return"),
    )


# --- guards -------------------------------------------------------------------------------------------
def at_the_shelf(mission: Mission) -> str:
    """navigation → undeployed: arrived, and sure of it."""
    way = mission.journey
    if way is None or way.state != ARRIVED:
        return "there was no journey" if way is None else way.reason
    off = np.abs(difference(way.goal, way.estimates[-1])) + 2 * way.deviations[-1]
    return "" if (off <= AT_THE_SHELF).all() else (f"the pair may be {np.hypot(*off[:2]) * 1e3:.0f} mm and "
                                                   f"{np.degrees(off[2]):.1f}° off its berth")


def stands_still(mission: Mission) -> str:
    """undeployed → deployed: all wheels carry, no base leans."""
    drive = mission.drive
    if drive is None or not len(drive.wheels):
        return ""
    if drive.wheels[-1].min() < 1.0:
        return "a wheel carries nothing"
    return "a base leans" if drive.tilts[-1] > np.radians(0.5) else ""


def base_in_place(mission: Mission) -> str:
    """deployed → pick and place: the job got as far as approaching the box."""
    return "" if "approach" in _job_states(mission) else _job_reason(mission)


def box_in_place(mission: Mission) -> str:
    """pick and place → return: the gripper has let the box go where it belongs."""
    return "" if "return" in _job_states(mission) else _job_reason(mission)


def back_again(mission: Mission) -> str:
    """return → done: the job is done."""
    return "" if mission.job is not None and mission.job.state == DONE else _job_reason(mission)


def _job_states(mission: Mission) -> list[str]:
    return [] if mission.job is None else [event.state for event in mission.job.events]


def _job_reason(mission: Mission) -> str:
    return "there was no job" if mission.job is None else mission.job.reason or f"it ended in {mission.job.state}"


# --- acts ---------------------------------------------------------------------------------------------
def _nothing(_: Mission) -> None:
    """What happens in this state, an earlier act has done: its guard looks at the record."""


@dataclass(frozen=True, eq=False)
class Trip:
    """Where from, where to, and who is on the way; see `run_mission`."""

    world: World
    task: PickAndPlace
    bounds: Array
    start: Array
    station: Array
    walkers: tuple[Walker, ...]
    beams: int

    @property
    def coupled(self) -> World:
        """The world with the pair at its berth."""
        return replace(self.world, robot=self.world.robot.with_bases(self.task.coupled), pose=self.task.start, tasks={})

    def drive_there(self, mission: Mission) -> None:
        """Navigate to the berth in the engine."""
        berth, spacing = pair_pose(self.coupled)
        pair = Vehicle.of(self.world.robot, spacing, beams=self.beams)
        hall = Hall.of_world(self.world, self.bounds)
        c, s = np.cos(berth[2]), np.sin(berth[2])
        station = berth + [*(np.array([[c, -s], [s, c]]) @ self.station[:2]), self.station[2]]
        random = np.random.default_rng(mission.seed)
        truly = self.start + random.uniform(-1, 1, 3) * [0.08, 0.08, 0.04]
        walkers = tuple(replace(walker) for walker in self.walkers)
        with EnginePair(self.coupled, pair, hall, truly, walkers, seed=mission.seed) as bases:
            mission.journey = navigate(bases, hall, self.start, station, berth=berth)
            mission.drive = bases.measured()

    def arrived(self, mission: Mission) -> World:
        """The world with its bases as the pair truly stands, and deploys from there straight on.

        That is what calibrating the exit points on the spot would give; the shelf stays where it is.
        """
        assert mission.journey is not None
        berth, stands = pair_pose(self.coupled)[0], mission.journey.poses[-1]
        coupled = {name: _shifted(place, berth, stands) for name, place in self.task.coupled.items()}
        deployed = {base.name: _shifted((*base.position.tolist(), base.heading), berth, stands)
                    for base in self.world.robot.bases}
        return replace(self.world, robot=self.world.robot.with_bases(deployed),
                       tasks={mission.task: replace(self.task, coupled=coupled)})


def _shifted(place: tuple[float, ...], berth: Array, stands: Array) -> tuple[float, float, float]:
    """A place on the floor as it is when all that belongs to the berth is where the pair stands."""
    spin = float(difference(stands, berth)[2])
    x, y = carried([*stands[:2], spin], [np.array(place[:2]) - berth[:2]])[0].tolist()
    return x, y, place[2] + spin


def work_there(work: Work, trip: Trip) -> Callable[[Mission], None]:
    """The act that does the work where the pair stands."""
    def act(mission: Mission) -> None:
        mission.job = work(trip.arrived(mission), mission.task)

    return act
