"""What drives: the interface of a pair of bases, real or simulated, and a purely kinematic one with people about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_array
from .laser import cast
from .localization import Odometry
from .plan_view import Hall, checked_pose, edges, outline_distance, segment_distance, turn
from .vehicle import Vehicle, difference, moved


class Pair(Protocol):
    """A coupled pair that can be told to drive, and tells what it notices."""

    vehicle: Vehicle

    @property
    def pose(self) -> Array:
        """(3,) where it truly is: for records and options, not for navigation."""

    def drive(self, twist: Array, period: float) -> Array:
        """Drive on for a while; returns the step (dx, dy, dθ) the wheels say it was."""

    def scan(self) -> Array:
        """(h, 2) points of all scanners in the vehicle's frame [m]."""

    def clearance(self) -> float:
        """Distance to the nearest thing, by exact geometry; 0 is contact [m]."""

    @property
    def people(self) -> Array:
        """(c, 3) center and radius of who walks about [m]."""


@dataclass
class Walker:
    """A person who walks to and fro, and stops before walking into a machine.

    way : (2, 2) from where to where [m]; speed : [m/s]; radius : [m]
    care : stops this near to the machine [m]; patience : then turns round after [s], and, cornered, steps back
    hall : what they cannot step back through; None: nothing is in the way
    """

    way: Array
    speed: float = 0.6
    radius: float = 0.25
    care: float = 0.4
    patience: float = 4.0
    hall: Hall | None = None

    def __post_init__(self) -> None:
        self.way = as_array(self.way, "way", (2, 2), "m")
        self.place, self.onward = np.array(self.way[0]), 1
        self.waited, self.turned = 0.0, 0

    def walk(self, period: float, machine: Array) -> None:
        """Walk on, the machine's outline (4, 2) in mind."""
        left = self.way[self.onward] - self.place
        far = float(np.linalg.norm(left))
        if far < 1e-9:
            self.onward = 1 - self.onward
            return
        then = self.place + left * min(1.0, self.speed * period / far)
        near, now = (_disc_distance(machine, place, self.radius) for place in (then, self.place))
        # Along a machine one walks on, but not ever closer.
        along = 0.2 * float(np.linalg.norm(then - self.place)) if near > self.care / 2 else 0.0
        if near < self.care and near < now - along:
            self._wait(period, machine, now)
            return
        self.place, self.waited, self.turned = then, 0.0, 0
        if far <= self.speed * period:
            self.onward = 1 - self.onward

    def _wait(self, period: float, machine: Array, now: float) -> None:
        self.waited += period
        if self.waited > self.patience:
            self.onward, self.waited, self.turned = 1 - self.onward, 0.0, self.turned + 1
        if self.turned > 1 and now < self.care:      # turned round and could not walk that way either
            away = _away(machine, self.place) * self.speed * period
            for angle in (0.0, 0.8, -0.8, 1.5, -1.5):            # straight back, or past what stands there
                back = self.place + turn(angle) @ away
                roomy = self._room(back) >= min(self._room(self.place), 0.2)
                if roomy and _disc_distance(machine, back, self.radius) >= now:
                    self.place = back
                    return

    def _room(self, place: Array) -> float:
        """Between the person and what stands in the hall [m]."""
        return np.inf if self.hall is None else float(self.hall.distance(place)) - self.radius


class KinematicPair:
    """A pair that drives exactly as told, in a hall where people may walk and things stand that no map shows.

    vehicle : Vehicle; hall : what truly stands there; pose : (3,) at first [m, m, rad]
    walkers : people; odometry : how wrong the wheels are; seed : of all noise
    """

    def __init__(self, vehicle: Vehicle, hall: Hall, pose: ArrayLike, walkers: tuple[Walker, ...] = (),
                 odometry: Odometry | None = None, seed: int = 0) -> None:
        self.vehicle, self.hall, self.walkers = vehicle, hall, walkers
        self.odometry = Odometry() if odometry is None else odometry
        self._pose = np.array(checked_pose(pose, "pose"))
        self._segments = hall.segments
        self._random = np.random.default_rng(seed)

    @property
    def pose(self) -> Array:
        return self._pose

    @property
    def people(self) -> Array:
        return np.array([[*walker.place, walker.radius] for walker in self.walkers]).reshape(-1, 3)

    def drive(self, twist: Array, period: float) -> Array:
        before = self._pose
        self._pose = moved(before, self.vehicle.within_limits(twist), period)
        for walker in self.walkers:
            walker.walk(period, self.vehicle.outline(self._pose))
        return self.odometry.measured(step_between(before, self._pose), self._random)

    def scan(self) -> Array:
        points, people = [], self.people
        for scanner in self.vehicle.scanners:
            origin, directions = scanner.beams_from(self._pose)
            near = self._segments[segment_distance(origin, self._segments) < scanner.range]
            points.append(scanner.points(scanner.measured(cast(origin, directions, near, people), self._random)))
        return np.concatenate(points)

    def clearance(self) -> float:
        return clearance(self.vehicle, self._pose, self.hall, self.people)


def step_between(before: ArrayLike, after: ArrayLike) -> Array:
    """(3,) (dx, dy, dθ) in the vehicle's frame, as `Localization.drive` takes it."""
    d = difference(after, before)
    return np.array([*(turn(np.asarray(before)[2] + d[2] / 2).T @ d[:2]), d[2]])


def clearance(vehicle: Vehicle, pose: ArrayLike, hall: Hall, people: ArrayLike = ()) -> float:
    """Exact distance of the pair's rectangle to what stands and walks there; 0 is contact [m]."""
    outline = vehicle.outline(pose)
    low, high = hall.bounds
    to_edge = float(min((outline - low).min(), (high - outline).min()))
    reach = float(np.hypot(vehicle.length, vehicle.width)) / 2
    middle, near = np.asarray(pose, dtype=float)[:2], max(to_edge, 0.0)
    for other in hall.outlines:
        # Whoever is farther than the nearest so far need not be looked at exactly.
        if segment_distance(middle, edges(other)).min() - reach < near:
            near = min(near, outline_distance(outline, other))
    discs = [_disc_distance(outline, np.array([x, y]), r) for x, y, r in np.reshape(people, (-1, 3)).tolist()]
    return max(0.0, min([near, *discs]))


def _disc_distance(outline: Array, center: Array, radius: float) -> float:
    sides = edges(outline)
    along, off = sides[:, 1] - sides[:, 0], center - sides[:, 0]
    inside = (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0] >= 0).all()
    return 0.0 if inside else float(segment_distance(center, sides).min()) - radius


def _away(outline: Array, place: Array) -> Array:
    """(2,) unit vector from an outline's nearest point to a place outside it."""
    start, end = np.moveaxis(edges(outline), 1, 0)
    along = end - start
    share = np.clip(((place - start) * along).sum(axis=1) / (along * along).sum(axis=1), 0, 1)
    off = place - start - share[:, None] * along
    distances = np.linalg.norm(off, axis=1)
    return np.asarray(off[distances.argmin()] / max(distances.min(), 1e-9))
