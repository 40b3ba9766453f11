"""A journey: plan, look, believe, drive, and plan again where something is in the way, until there or stopped."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_number, checked, frozen_dataclass
from ...errors import Recording
from ...run.log import Columns, Log
from ..events import STOPPED
from ..plane import NO_POINTS, Place, carried, checked_pose, difference
from .driving import KinematicPair, clearance
from .follower import Follower
from .hall import Hall
from .localization import Localization
from .occupancy import OccupancyGrid
from .planner import Plan, between, plan_path
from .vehicle import Vehicle

ARRIVED = "arrived"
DOCKING_MARGIN = 0.06
"""Kept from the map on the last straight drive to a berth; the localization is that good three times over [m]."""

_WAIT = 2.0           # s blocked, then another way is looked for
_LONGEST = 600.0      # s a journey may take
_PATIENCE = 30.0      # s blocked without any other way, then the journey ends
_AROUND = 0.2         # m kept occupied about a point that is not on the map
_OUT = np.array([0.1, 0.1, 0.1])      # m, m, rad: this near to where it was to leave to, it is out of the berth
_COLUMNS: Columns = {"time": ((), "s"), "poses": ((3,), "m, m, rad"), "estimates": ((3,), "m, m, rad"),
                     "deviations": ((3,), "m, m, rad"), "clearance": ((), "m"), "waiting": ((), "")}
_SURE = np.array([0.15, 0.15, 0.1])   # m, m, rad: less sure of its pose, it must not drive


@frozen_dataclass
class Journey:
    """What happened, one row a period.

    state, reason : "arrived", or "stopped" and why
    time : (N,) [s]; poses : (N, 3) true; estimates : (N, 3) believed
    deviations : (N, 3) believed uncertainty
    clearance : (N,) exact distance to the nearest thing [m]
    waiting : (N,) bool, for somebody to walk on
    people : (N, c, 3) center and radius; plans : (time, Plan) as they were made
    scans : N of (h, 2) points, vehicle's frame
    measured : what an engine measured, a row a period; None by kinematics alone
    cut_short : '' or what ended it early, Ctrl-C for one
    """

    hall: Hall
    vehicle: Vehicle
    goal: Array
    state: str
    reason: str
    time: Array
    poses: Array
    estimates: Array
    deviations: Array
    clearance: Array
    waiting: Array
    people: Array
    plans: tuple[tuple[float, Plan], ...]
    scans: tuple[Array, ...] = field(repr=False)
    measured: Log | None = None
    cut_short: str = ""

    @property
    def errors(self) -> Array:
        """(N, 3) estimate minus truth [m, m, rad]."""
        return difference(self.estimates, self.poses)

    def columns(self) -> dict[str, tuple[Array, str]]:
        """Name → what there is of it a row, and its unit."""
        return {name.removesuffix("s"): (getattr(self, name), unit) for name, (_, unit) in _COLUMNS.items()}

    def table(self) -> dict[str, str]:
        """The journey in a few lines."""
        off, end = self.errors, difference(self.goal, self.poses[-1])
        return {
            "state": f"{self.state}: {self.reason}".removesuffix(": "),
            "time": f"{self.time[-1]:.1f} s",
            "way": f"{np.linalg.norm(np.diff(self.poses[:, :2], axis=0), axis=1).sum():.2f} m",
            "plans made": f"{len(self.plans)}",
            "smallest clearance": f"{self.clearance.min():.2f} m",
            "localization error, largest": f"{np.linalg.norm(off[:, :2], axis=1).max() * 1e3:.0f} mm, "
                                           f"{np.degrees(np.abs(off[:, 2]).max()):.2f}°",
            "localization error, at the end": f"{np.linalg.norm(off[-1, :2]) * 1e3:.0f} mm, "
                                              f"{np.degrees(abs(off[-1, 2])):.2f}°",
            "off the goal": f"{np.linalg.norm(end[:2]) * 1e3:.0f} mm, {np.degrees(abs(end[2])):.2f}°",
        }


@checked
def navigate(pair: KinematicPair, hall: Hall, start: ArrayLike, goal: ArrayLike, *,
             berth: ArrayLike | None = None, leaving: ArrayLike | None = None,
             uncertainty: Place = (0.1, 0.1, 0.05), period: float = 0.1,
             progress: Callable[[float], Any] | None = None) -> Journey:
    """Drive the pair to a goal on a known map; stop with the reason where that fails.

    pair : what drives; hall : the map it goes by
    start : (3,) where it believes to be at first, give or take ``uncertainty`` (3,)
    goal : (3,) [m, m, rad]
    berth : (3,) driven to from the goal, straight and in a narrower place than plans allow
        [m, m, rad]
    leaving : (3,) driven to first, as straight and as narrow: the way out of a berth
        [m, m, rad]
    period : between two scans [s]
    progress : called with the simulated time
    Returns Journey; what ends it early carries what was driven, as ``.run``.
    Source: Pedemonte et al. 2020, section 2.3.
    """
    as_number(period, "period", "s", minimum=1e-3)
    where = Localization(hall, checked_pose(start, "start"), uncertainty, pair.odometry, pair.vehicle.eyes)
    stops = [checked_pose(goal, "goal")] + ([] if berth is None else [checked_pose(berth, "berth")])
    out = None if leaving is None else checked_pose(leaving, "leaving")
    driver = _Driver(pair, hall, stops, out, where, period)
    with Recording(driver.cut):
        return driver.drive(progress)


def with_berth(hall: Hall, vehicle: Vehicle, plan: Plan, berth: Array,
               leaving: bool = False) -> Plan:
    """The plan and a straight drive from its end to the berth, or, leaving it, from the berth to its begin.

    The straight drive keeps ``DOCKING_MARGIN`` from the map, exactly, or there is no such plan.
    """
    nearest = clearance(vehicle, between(berth, plan.poses[0 if leaving else -1]), hall).min()
    if nearest < DOCKING_MARGIN:
        return Plan.none(f"no room to {'leave' if leaving else 'dock'}: {nearest:.2f} m are left between berth and "
                         f"map on the straight way, {DOCKING_MARGIN:g} m are wanted")
    return Plan(np.vstack([berth, plan.poses] if leaving else [plan.poses, berth]))


@dataclass(eq=False)
class _Driver:
    """A journey under way: what it is told, and what changes from period to period."""

    pair: KinematicPair
    hall: Hall
    stops: list[Array]
    leaving: Array | None
    where: Localization
    period: float
    plans: list[tuple[float, Plan]] = field(default_factory=list)
    scans: list[Array] = field(default_factory=list)
    now: float = 0.0
    blocked: float = 0.0
    since_plan: float = 0.0

    def __post_init__(self) -> None:
        self.grid = OccupancyGrid.of(self.hall)
        self.log = Log({**_COLUMNS, "people": (self.pair.people.shape, "m")})

    def drive(self, progress: Callable[[float], Any] | None) -> Journey:
        """Period after period, until there or stopped."""
        self._look()
        # Around all that is in sight; if there is no way, perhaps it is only somebody who walks on soon.
        follower = self._plan(self.unexpected) or self._plan(NO_POINTS)
        while follower and not follower.arrived(self.where.pose):
            reason = self._fault()
            if reason:
                return self._journey(STOPPED, reason)
            twist = follower.command(self.where.pose, self.unexpected, self.period)
            follower = self._patient(follower)
            self.where.drive(self.pair.drive(twist, self.period))
            self.now += self.period
            if progress is not None:
                progress(self.now)
            self._look()
        return self._journey(ARRIVED) if follower else self._journey(STOPPED, self.plans[-1][1].reason)

    def cut(self, reason: str, _: Any) -> Journey | None:
        """What was driven until it was cut short, if anything."""
        return replace(self._journey(STOPPED, reason), cut_short=reason) if len(self.log) else None

    def _look(self) -> None:
        """Correct the belief by a scan, and write down how all is."""
        pair, where = self.pair, self.where
        points = pair.scan()
        where.look(points)
        self.unexpected = where.unexpected(points)
        # Once out of the berth, plans begin where the pair is.
        if self.leaving is not None and (np.abs(difference(self.leaving, where.pose)) < _OUT).all():
            self.leaving = None
        room = clearance(pair.vehicle, pair.pose, pair.hall, pair.people)
        self.log.keep(self.now, pair.pose, where.pose, where.deviation, room,
                      self.blocked > 0, pair.people)
        self.scans.append(points)

    def _fault(self) -> str:
        """'' while the pair may drive on, else why it has to stop."""
        if self.now > _LONGEST:
            return f"not there after {_LONGEST:g} s"
        if (self.where.deviation > _SURE).any():
            return "lost: the scanners see too little of the map to know where the pair is"
        if self.blocked > _PATIENCE:
            return "the way is blocked by something that is not on the map, and there is no other way"
        return ""

    def _patient(self, follower: Follower) -> Follower:
        """Where something is in the way: wait a little, then look for a way around it."""
        self.blocked = max(0.0, self.blocked + self.period * (1 if follower.blocked else -1))
        self.since_plan += self.period
        if not follower.blocked or min(self.blocked, self.since_plan) < _WAIT:
            return follower
        return self._plan(self.unexpected) or follower

    def _plan(self, unexpected: Array) -> Follower | None:
        """What follows a way around points that no map shows; None: there is none, the last plan says why."""
        pose, vehicle, grid = self.where.pose, self.pair.vehicle, self.grid
        if len(unexpected):
            grid = OccupancyGrid.of(self.hall, points=carried(pose, unexpected), reach=_AROUND)
        plan = plan_path(grid, vehicle, pose if self.leaving is None else self.leaving,
                         self.stops[0])
        if plan.found and self.leaving is not None:
            plan = with_berth(self.hall, vehicle, plan, pose, leaving=True)
        if plan.found and len(self.stops) > 1:
            plan = with_berth(self.hall, vehicle, plan, self.stops[1])
        self.plans.append((self.now, plan))
        self.since_plan = 0.0
        return Follower(vehicle, plan.poses) if plan.found else None

    def _journey(self, state: str, reason: str = "") -> Journey:
        columns: dict[str, Any] = {name: self.log[name] for name in self.log.units}
        columns["waiting"] = columns["waiting"] > 0
        return Journey(self.hall, self.pair.vehicle, self.stops[-1], state, reason,
                       plans=tuple(self.plans), scans=tuple(self.scans), measured=self.pair.log,
                       **columns)
