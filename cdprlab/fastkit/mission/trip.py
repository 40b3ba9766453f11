"""The acts of a mission: the drive to the shelf, the work there and the drive home, for one hall."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_seed, frozen_dataclass
from ...errors import InvalidInput, quoted
from ...world import World
from ...world.model import PickAndPlace
from ..job.job import pick_and_place
from ..job.job_record import Job
from ..navigation.driving import Walker
from ..navigation.hall import Hall
from ..navigation.journey import Journey, navigate
from ..navigation.vehicle import Vehicle
from ..plane import Bounds, Place, placed
from .engine_pair import EnginePair, pair_pose, shifted, shifted_bases
from .mission_record import Mission

COUPLED = 0.01
"""As far as the bases may be off their places to each other as the link closes: its magnets pull no farther [m]."""

Work = Callable[[World, str], Job]
"""What is done once the pair stands at the shelf: deploys, picks, places, returns, folds."""

Progress = Callable[[str, float], Any]
"""Called with the mission's state and the simulated time [s]."""


def watch(_: Mission) -> None:
    """Nothing is done: the pair stands, or the job that an earlier state began goes on by itself."""


@frozen_dataclass
class Trip:
    """Where from, where to, and who is on the way; see `run_mission`."""

    world: World
    task: PickAndPlace
    bounds: Bounds
    start: Place
    station: Place
    walkers: tuple[Walker, ...]
    beams: int
    progress: Progress | None = None

    @property
    def coupled(self) -> World:
        """The world with the pair at its berth."""
        return replace(self.world, robot=self.world.robot.with_bases(self.task.coupled),
                       pose=self.task.start)

    @property
    def berth(self) -> Array:
        """(3,) pose of the pair at its berth [m, m, rad]."""
        return pair_pose(self.coupled)[0]

    @property
    def gate(self) -> Array:
        """(3,) where the straight way into the berth, and out of it, begins [m, m, rad]."""
        return placed(self.berth, self.station)

    def drive_there(self, mission: Mission) -> None:
        """Navigate to the berth in the engine, the true start a little off the one told."""
        off = np.random.default_rng(as_seed(mission.seed)).uniform(-1, 1, 3) * [0.08, 0.08, 0.04]
        mission.journey = self._navigate(mission, np.add(self.start, off), self.start, self.gate, berth=self.berth,
                                         seed=mission.seed)

    def drive_home(self, mission: Mission) -> None:
        """Navigate back from where the bases have come together; what the pair believed there, it believes still."""
        if mission.journey is None or mission.job is None:
            raise InvalidInput("a mission drives home after its journey and its job, which this one has not made")
        truly = self._pair.pose_of(mission.job.base_poses[-1, 0])
        doubt = mission.journey.deviations[-1] + COUPLED
        mission.way_home = self._navigate(mission, truly, mission.journey.estimates[-1], self.start,
                                          leaving=self.gate, uncertainty=doubt,
                                          seed=mission.seed + 1)

    def _navigate(self, mission: Mission, truly: Array, believed: ArrayLike, goal: ArrayLike, *,
                  seed: int, **how: ArrayLike) -> Journey:
        hall, pair = Hall.of_world(self.world, self.bounds), self._pair
        walkers = tuple(replace(walker, hall=hall) for walker in self.walkers)
        with EnginePair(self.coupled, pair, hall, truly, walkers, seed=seed) as bases:
            return navigate(bases, hall, believed, goal, progress=self.told(mission),
                            **how)     # type: ignore[arg-type]

    @property
    def _pair(self) -> Vehicle:
        return Vehicle.of(self.world.robot, pair_pose(self.coupled)[1], beams=self.beams)

    def told(self, mission: Mission) -> Callable[[float], Any] | None:
        """What tells the time of a part to whom it concerns, as the mission's."""
        tell, before = self.progress, mission.now
        return None if tell is None else lambda part: tell(mission.state, before + part)

    def arrived(self, mission: Mission) -> World:
        """The world with its bases as the pair truly stands, and deploys from there straight on.

        That is what calibrating the exit points on the spot would give; the shelf stays where
        it is.
        """
        if mission.journey is None:
            raise InvalidInput("a mission arrives after its journey, which this one has not made")
        berth, stands = self.berth, mission.journey.poses[-1]
        coupled = {name: shifted(place, berth, stands) for name, place in self.task.coupled.items()}
        return replace(self.world, robot=shifted_bases(self.world.robot, berth, stands),
                       tasks={mission.task: replace(self.task, coupled=coupled)})

    def work_there(self, mission: Mission, work: Work | None = None) -> None:
        """Do the work where the pair stands; None: `pick_and_place`, and fold."""
        tell = self.told(mission)
        ticks = None if tell is None else lambda done, _: tell(1e-3 * done)
        work = work or partial(pick_and_place, fold=True, progress=ticks)
        job = work(self.arrived(mission), mission.task)
        if not all(hasattr(job, name) for name in ("state", "reason", "events", "base_poses", "world")):
            raise InvalidInput(f"work at t = {mission.now:.4g} s must give a Job, got {quoted(job)}")
        mission.job = job
