"""FASTKIT's mission, one state after the other: drive to the shelf, stand, deploy, pick and place, return, drive home.

    navigation ─ at the shelf ─▶ undeployed ─ stands still ─▶ deployed ─ base in place ─▶ pick and place
                                                                                             │ box in place
    stopped ◀─ any guard that stays shut, any fault          done ◀─ at home ─ home ◀─ coupled again ─ return

"stopped" is safe, and says why: bases stand still, cables keep holding the platform, the gripper stays as it is.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

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

AT_HOME = np.array([0.1, 0.1, np.radians(5.0)])
"""The same for where the mission began: nothing there has to be met to the centimeter."""

COUPLED = 0.01
"""As far as the bases may be off their places to each other as the link closes: its magnets pull no farther [m]."""

LEANS = np.radians(0.5)
"""A base whose mast is tilted more than this leans [rad]."""

Work = Callable[[World, str], Job]
"""What is done once the pair stands at the shelf: deploys, picks, places, returns, folds."""

Progress = Callable[[str, float], Any]
"""Called with the mission's state and the simulated time [s]."""


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
    way_home, drive_home : the way back, and what the engine measured on it
    real_time_factor : simulated over elapsed time
    """

    world: World
    task: str
    seed: int
    events: list[Event] = field(default_factory=list)
    journey: Journey | None = None
    drive: Drive | None = None
    job: Job | None = None
    way_home: Journey | None = None
    drive_home: Drive | None = None
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
    def parts(self) -> dict[str, Journey | Job]:
        """What there is of the way there, the work and the way home, in this order."""
        parts = {"way there": self.journey, "work": self.job, "way home": self.way_home}
        return {name: part for name, part in parts.items() if part is not None}

    @property
    def now(self) -> float:
        """Simulated time so far [s]."""
        return sum(float(part.time[-1]) for part in self.parts.values())

    def when(self, begins: str) -> float:
        """When the job first was in that state of its own; now, if it never was, or there is no job [s]."""
        if self.job is None or self.journey is None:
            return self.now
        times = [event.time for event in self.job.events if event.state == begins]
        return float(self.journey.time[-1]) + times[0] if times else self.now

    def table(self) -> dict[str, str]:
        """The mission in a few lines."""
        rows = {f"{number}. {event.state}": f"{event.time:.1f} s" + (f", {event.why}" if event.why else "")
                for number, event in enumerate(self.events, 1)}
        for name, part in self.parts.items():
            rows.update({f"{name}: {quantity}": value for quantity, value in part.table().items()
                         if quantity not in ("state", "real-time factor")})
        return {**rows, "mission time": f"{self.now:.1f} s", "real-time factor": f"{self.real_time_factor:.1f}"}


class State(NamedTuple):
    """One state of the mission.

    name : of it; what : the same in words
    act : what is done in it; guard : asked then: '' when the next state may begin, else what is in the way
    begins : where the act of an earlier state did this one too: the job's own state it began with
    """

    name: str
    what: str
    act: Callable[[Mission], None]
    guard: Callable[[Mission], str]
    begins: str = ""


def run_mission(world: World, bounds: ArrayLike, start: ArrayLike, task: str = "pick_and_place", *,
                station: ArrayLike = (0.2, -0.4, 0.0), walkers: tuple[Walker, ...] = (), seed: int = 0,
                beams: int = 271, work: Work | None = None, states: tuple[State, ...] | None = None,
                progress: Progress | None = None) -> Mission:
    """From somewhere in a hall to the shelf, the task there, and back to where it began.

    world : spatial, a pair of bases, its scene the hall; task : of kind pick_and_place, with coupled bases
    bounds : (2, 2) of the floor [m]; start : (3,) pose of the coupled pair, as it is told [m, m, rad]
    station : (3,) from the berth, in its frame, to where the straight drive into it begins [m, m, rad]
    walkers : people; seed : of all noise, that of the true start included; beams : of each scanner
    work : what is done at the shelf, by default `pick_and_place`, bases folded in the end
    states : other than `mission_states`; progress : called with the state and the simulated time
    Returns Mission; a failure ends it in "stopped" with the reason.
    Raises InvalidInput for a task of another kind, or one that begins deployed.
    Source: Pedemonte et al. 2020, section 2.3 and Fig. 3; the way home is the way there turned round.

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
                as_array(station, "station", (3,), "m, m, rad"), walkers, beams, progress)
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


def mission_states(trip: Trip, work: Work | None = None) -> tuple[State, ...]:
    """The states of Fig. 3 and what is between them, in order; ``work`` is one act that three of them watch."""
    return (
        State("navigation", "coupled, the pair drives to its berth; no cable moves", trip.drive_there, at_the_shelf),
        State("undeployed", "at the berth, still coupled", stand, stands_still),
        State("deployed", "the link opens, the active base drives away", work_there(work, trip), base_in_place),
        State("pick and place", "the box from its place to the other", go_on, box_in_place, "approach"),
        State("return", "the platform goes back, the bases fold, the link closes", go_on, coupled_again, "return"),
        State("home", "coupled, the pair leaves its berth and drives back", trip.drive_home, at_home),
    )


# --- guards -------------------------------------------------------------------------------------------
def at_the_shelf(mission: Mission) -> str:
    """navigation → undeployed: arrived, and sure of it."""
    return _sure_of_being_at("its berth", mission.journey, AT_THE_SHELF)


def stands_still(mission: Mission) -> str:
    """undeployed → deployed: all wheels carry, no base leans."""
    drive = mission.drive
    if drive is None or not len(drive.wheels):
        return ""
    if drive.wheels[-1].min() < 1.0:
        return "a wheel carries nothing"
    return "a base leans" if drive.tilts[-1] > LEANS else ""


def base_in_place(mission: Mission) -> str:
    """deployed → pick and place: the job got as far as approaching the box."""
    return "" if "approach" in _job_states(mission) else _job_reason(mission)


def box_in_place(mission: Mission) -> str:
    """pick and place → return: the gripper has let the box go where it belongs."""
    return "" if "return" in _job_states(mission) else _job_reason(mission)


def coupled_again(mission: Mission) -> str:
    """return → home: the job is done, and the bases are where the link takes them."""
    job = mission.job
    if job is None or job.state != DONE:
        return _job_reason(mission)
    places = job.world.robot.with_bases(job.world.task(mission.task).coupled).bases      # type: ignore[attr-defined]
    off = max(float(np.linalg.norm(stands[:2] - base.position)) for stands, base in zip(job.base_poses[-1], places))
    return "" if off <= COUPLED else f"the bases are not together: one is {off * 1e3:.0f} mm off its coupled place"


def at_home(mission: Mission) -> str:
    """home → done: arrived, and sure of it."""
    return _sure_of_being_at("where it began", mission.way_home, AT_HOME)


def _sure_of_being_at(place: str, way: Journey | None, tolerance: Array) -> str:
    if way is None or way.state != ARRIVED:
        return "there was no journey" if way is None else way.reason
    off = np.abs(difference(way.goal, way.estimates[-1])) + 2 * way.deviations[-1]
    return "" if (off <= tolerance).all() else (f"the pair may be {np.hypot(*off[:2]) * 1e3:.0f} mm and "
                                                f"{np.degrees(off[2]):.1f}° off {place}")


def _job_states(mission: Mission) -> list[str]:
    return [] if mission.job is None else [event.state for event in mission.job.events]


def _job_reason(mission: Mission) -> str:
    return "there was no job" if mission.job is None else mission.job.reason or f"it ended in {mission.job.state}"


# --- acts ---------------------------------------------------------------------------------------------
def stand(_: Mission) -> None:
    """Nothing is done: the pair stands, and its guard looks at how."""


def go_on(_: Mission) -> None:
    """The job that an earlier state began goes on by itself; the guard looks at what it wrote down."""


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
    progress: Progress | None = None

    @property
    def coupled(self) -> World:
        """The world with the pair at its berth."""
        return replace(self.world, robot=self.world.robot.with_bases(self.task.coupled), pose=self.task.start, tasks={})

    @property
    def berth(self) -> Array:
        """(3,) pose of the pair at its berth [m, m, rad]."""
        return pair_pose(self.coupled)[0]

    @property
    def gate(self) -> Array:
        """(3,) where the straight way into the berth, and out of it, begins [m, m, rad]."""
        return np.array([*carried(self.berth, [self.station[:2]])[0], self.berth[2] + self.station[2]])

    def drive_there(self, mission: Mission) -> None:
        """Navigate to the berth in the engine, the true start a little off the one told."""
        truly = self.start + np.random.default_rng(mission.seed).uniform(-1, 1, 3) * [0.08, 0.08, 0.04]
        mission.journey, mission.drive = self._navigate(mission, truly, self.start, self.gate, berth=self.berth,
                                                        seed=mission.seed)

    def drive_home(self, mission: Mission) -> None:
        """Navigate back from where the bases have come together; what the pair believed there, it believes still."""
        assert mission.journey is not None and mission.job is not None
        truly = self._pair.pose_of(mission.job.base_poses[-1, 0])
        doubt = mission.journey.deviations[-1] + [COUPLED, COUPLED, COUPLED]
        mission.way_home, mission.drive_home = self._navigate(mission, truly, mission.journey.estimates[-1],
                                                              self.start, leaving=self.gate, uncertainty=doubt,
                                                              seed=mission.seed + 1)

    def _navigate(self, mission: Mission, truly: Array, believed: Array, goal: Array, *, seed: int,
                  **how: ArrayLike) -> tuple[Journey, Drive]:
        hall, pair = Hall.of_world(self.world, self.bounds), self._pair
        walkers = tuple(replace(walker, hall=hall) for walker in self.walkers)
        with EnginePair(self.coupled, pair, hall, truly, walkers, seed=seed) as bases:
            way = navigate(bases, hall, believed, goal, progress=self.told(mission), **how)     # type: ignore[arg-type]
            return way, bases.measured()

    @property
    def _pair(self) -> Vehicle:
        return Vehicle.of(self.world.robot, pair_pose(self.coupled)[1], beams=self.beams)

    def told(self, mission: Mission) -> Callable[[float], Any] | None:
        """What tells the time of a part to whom it concerns, as the mission's."""
        tell, before = self.progress, mission.now
        return None if tell is None else lambda part: tell(mission.state, before + part)

    def arrived(self, mission: Mission) -> World:
        """The world with its bases as the pair truly stands, and deploys from there straight on.

        That is what calibrating the exit points on the spot would give; the shelf stays where it is.
        """
        assert mission.journey is not None
        berth, stands = self.berth, mission.journey.poses[-1]
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


def work_there(work: Work | None, trip: Trip) -> Callable[[Mission], None]:
    """The act that does the work where the pair stands; None: `pick_and_place`, and fold."""
    def act(mission: Mission) -> None:
        there, tell = trip.arrived(mission), trip.told(mission)
        if work is not None:
            mission.job = work(there, mission.task)
            return
        ticks = None if tell is None else lambda done, _: tell(1e-3 * done)
        mission.job = pick_and_place(there, mission.task, fold=True, progress=ticks)

    return act
