"""A journey: plan, look, believe, drive, and plan again where something is in the way, until there or stopped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, as_number, frozen
from .driving import Pair, clearance
from .follower import Follower
from .grid import OccupancyGrid
from .localization import Localization, Odometry
from .plan_view import Hall, carried, checked_pose
from .planner import MARGIN, Plan, between, plan_path
from .vehicle import Vehicle, difference

ARRIVED, STOPPED = "arrived", "stopped"
DOCKING_MARGIN = 0.06
"""Kept from the map on the last straight drive to a berth; the localization is that good three times over [m]."""

_WAIT = 2.0           # s blocked, then another way is looked for
_PATIENCE = 30.0      # s blocked without any other way, then the journey ends
_AROUND = 0.2         # m kept occupied about a point that is not on the map
_SURE = np.array([0.15, 0.15, 0.1])   # m, m, rad: less sure of its pose, it must not drive


@dataclass(frozen=True, eq=False)
class Journey:
    """What happened, one row a period.

    state, reason : "arrived", or "stopped" and why
    time : (N,) [s]; poses : (N, 3) true; estimates : (N, 3) believed; deviations : (N, 3) believed uncertainty
    clearance : (N,) exact distance to the nearest thing [m]; waiting : (N,) bool
    people : (N, c, 3) center and radius; plans : (time, Plan) as they were made
    points : (h, 2) of the last scan, vehicle's frame
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
    points: Array = field(repr=False)

    @property
    def errors(self) -> Array:
        """(N, 3) estimate minus truth [m, m, rad]."""
        return difference(self.estimates, self.poses)

    def table(self) -> dict[str, str]:
        """The journey in a few lines."""
        off, end = self.errors, difference(self.goal, self.poses[-1])
        return {
            "state": self.state + (f": {self.reason}" if self.reason else ""),
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


def navigate(pair: Pair, hall: Hall, start: ArrayLike, goal: ArrayLike, *,
             berth: ArrayLike | None = None, uncertainty: ArrayLike = (0.1, 0.1, 0.05), margin: float = MARGIN,
             period: float = 0.1, longest: float = 600.0, truth: bool = False, odometry: Odometry | None = None,
             progress: Callable[[float], Any] | None = None) -> Journey:
    """Drive the pair to a goal on a known map; stop with the reason where that fails.

    pair : what drives; hall : the map it goes by
    start : (3,) where it believes to be at first, give or take ``uncertainty`` (3,); goal : (3,) [m, m, rad]
    berth : (3,) driven to from the goal, straight and in a narrower place than plans allow [m, m, rad]
    margin : kept from all that is on the map [m]; period : between two scans [s]; longest : time allowed [s]
    truth : drive by the true pose instead of the believed one, for comparison
    progress : called with the simulated time
    Returns Journey.
    Source: Pedemonte et al. 2020, section 2.3.
    """
    as_number(period, "period", "s", positive=True)
    doubt = as_array(uncertainty, "uncertainty", (3,), "m, m, rad")
    eyes = [(scanner.x, scanner.y) for scanner in pair.vehicle.scanners]
    where = Localization(hall, checked_pose(start, "start"), doubt, odometry, eyes)
    stops = [checked_pose(goal, "goal")] + ([] if berth is None else [checked_pose(berth, "berth")])
    loop = _Loop(pair, hall, stops, where, margin, period, truth)
    return loop.run(longest, progress)


def docking(hall: Hall, vehicle: Vehicle, plan: Plan, berth: Array, margin: float = DOCKING_MARGIN) -> Plan:
    """The plan and a straight drive from its end to the berth, if that keeps ``margin`` [m] from the map, exactly."""
    nearest = min(clearance(vehicle, pose, hall) for pose in between(plan.poses[-1], berth))
    if nearest < margin:
        return Plan(np.zeros((0, 3)), f"no room to dock: {nearest:.2f} m are left on the way to the berth, "
                                      f"{margin:g} m are wanted")
    return Plan(frozen(np.concatenate([plan.poses, berth[None]])))


class _Loop:
    def __init__(self, pair: Pair, hall: Hall, stops: list[Array], where: Localization, margin: float, period: float,
                 truth: bool) -> None:
        self.pair, self.hall, self.stops, self.where = pair, hall, stops, where
        self.margin, self.period, self.truth = margin, period, truth
        self.grid = OccupancyGrid.of(hall)
        self.plans: list[tuple[float, Plan]] = []
        self.blocked = self.since_plan = 0.0
        self.rows: list[tuple[Any, ...]] = []

    def run(self, longest: float, progress: Callable[[float], Any] | None) -> Journey:
        pair, where, now = self.pair, self.where, 0.0
        points = pair.scan()
        where.look(points)
        first = self._plan(now, where.unexpected(points))[0]
        if not first.found:   # perhaps only somebody who walks on soon
            first = self._plan(now, np.zeros((0, 2)))[0]
        reason, follower = first.reason, Follower(pair.vehicle, first.poses) if first.found else None
        while True:
            self._note(now)
            if follower is None:
                return self._journey(STOPPED, reason, points)
            pose = pair.pose if self.truth else where.pose
            if follower.arrived(pose):
                return self._journey(ARRIVED, "", points)
            reason = self._fault(now, longest)
            if reason:
                return self._journey(STOPPED, reason, points)
            command = follower.command(pose, where.unexpected(points), self.period)
            follower = self._patient(command.blocked, now, points, follower)
            where.drive(pair.drive(command.twist, self.period))
            points = pair.scan()
            where.look(points)
            now += self.period
            if progress is not None:
                progress(now)

    def _fault(self, now: float, longest: float) -> str:
        """'' while the pair may drive on, else why it has to stop."""
        if now > longest:
            return f"not there after {longest:g} s"
        if (self.where.deviation > _SURE).any():
            return "lost: the scanners see too little of the map to know where the pair is"
        if self.blocked > _PATIENCE:
            return "the way is blocked by something that is not on the map, and there is no other way"
        return ""

    def _patient(self, blocked: bool, now: float, points: Array, follower: Follower) -> Follower:
        """Wait a little where something is in the way, then look for a way around it."""
        self.blocked = self.blocked + self.period if blocked else max(0.0, self.blocked - self.period)
        self.since_plan += self.period
        if not blocked or self.blocked < _WAIT or self.since_plan < _WAIT:
            return follower
        plan, around = self._plan(now, self.where.unexpected(points))
        return Follower(self.pair.vehicle, plan.poses, around) if plan.found else follower

    def _plan(self, now: float, unexpected: Array) -> tuple[Plan, Array]:
        """A plan, and the points in the world that it goes around though no map shows them."""
        pose = self.pair.pose if self.truth else self.where.pose
        around, grid = carried(pose, unexpected), self.grid
        if len(unexpected):
            grid = OccupancyGrid.of(self.hall, grid.cell, around, _AROUND)
        plan = plan_path(grid, self.pair.vehicle, pose, self.stops[0], self.margin)
        if plan.found and len(self.stops) > 1:
            plan = docking(self.hall, self.pair.vehicle, plan, self.stops[1])
        self.plans.append((now, plan))
        self.since_plan = 0.0
        return plan, around

    def _note(self, now: float) -> None:
        pair, where = self.pair, self.where
        self.rows.append((now, np.array(pair.pose), np.array(where.pose), where.deviation, pair.clearance(),
                          self.blocked > 0, pair.people))

    def _journey(self, state: str, reason: str, points: Array) -> Journey:
        names = ("time", "poses", "estimates", "deviations", "clearance", "waiting", "people")
        columns: dict[str, Any] = {name: frozen(np.array(column)) for name, column in zip(names, zip(*self.rows))}
        return Journey(self.hall, self.pair.vehicle, self.stops[-1], state, reason, plans=tuple(self.plans),
                       points=points, **columns)
