"""The guards of a mission: '' when the next state may begin, else what is in the way."""

import numpy as np

from ...arrays import Array
from ..events import DONE
from ..navigation.journey import ARRIVED, Journey
from ..plane import difference
from .mission_record import Mission

AT_THE_SHELF = np.array([0.05, 0.05, np.radians(2.0)])
"""As far as the pair may be off its berth, by its own belief and what that is worth [m, m, rad]."""

AT_HOME = np.array([0.1, 0.1, np.radians(5.0)])
"""The same for where the mission began: nothing there has to be met to the centimeter."""

COUPLED = 0.01
"""As far as the bases may be off their places to each other as the link closes: its magnets pull no farther [m]."""

LEANS = np.radians(0.5)
"""A base whose mast is tilted more than this leans [rad]."""


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


def base_in_place(mission: Mission) -> str:
    """deployed → pick and place: the job got as far as approaching the box."""
    return _job_came_to("approach", mission)


def box_in_place(mission: Mission) -> str:
    """pick and place → return: the gripper has let the box go where it belongs."""
    return _job_came_to("return", mission)


def coupled_again(mission: Mission) -> str:
    """return → home: the job is done, and the bases are where the link takes them."""
    trouble, job = _job_came_to(DONE, mission), mission.job
    if trouble or job is None:
        return trouble
    places = job.world.robot.with_bases(job.world.task(mission.task).coupled).bases      # type: ignore[attr-defined]
    apart = job.base_poses[-1, :, :2] - [base.position for base in places]
    off = float(np.linalg.norm(apart, axis=1).max())
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
    if way is None or way.state != ARRIVED:
        return "there was no journey" if way is None else way.reason
    return sure_of_being_at(way.goal, way.estimates[-1], way.deviations[-1], tolerance, place)


def _job_came_to(state: str, mission: Mission) -> str:
    job = mission.job
    if job is None:
        return "there was no job"
    came = any(event.state == state for event in job.events)
    return "" if came else job.reason or f"it ended in {job.state}"
