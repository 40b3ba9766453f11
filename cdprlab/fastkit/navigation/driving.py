"""What drives: a pair of bases among people, as its kinematics say."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_seed, checked
from ...run.log import Log
from ..plane import (
    Motion,
    Period,
    Place,
    Spots,
    checked_pose,
    moved,
    off_rectangles,
    point_distance,
    rectangle_distance,
    step_between,
    turn,
)
from .hall import Hall
from .laser import Scanner, cast
from .localization import Odometry
from .vehicle import Vehicle


@checked
@dataclass(eq=False)
class Walker:
    """A person who walks to and fro, and stops before walking into a machine.

    way : (2, 2) from where to where [m]; speed : [m/s]; radius : [m]
    care : stops this near to the machine [m]
    patience : then turns round after [s], and, cornered, steps back
    hall : what they cannot step back through; None: nothing is in the way
    """

    way: Annotated[Array, "(2, 2) [m]"]
    speed: Annotated[float, "[m/s] ≥ 0"] = 0.6
    radius: Annotated[float, "[m] > 0"] = 0.25
    care: Annotated[float, "[m] ≥ 0"] = 0.4
    patience: Annotated[float, "[s] ≥ 0 or inf"] = 4.0
    hall: Hall | None = None

    def __post_init__(self) -> None:
        self.place, self.onward = np.array(self.way[0]), 1
        self.waited, self.turned = 0.0, 0

    def walk(self, period: Period, pose: Place, size: Spots) -> None:
        """Walk on for a period [s], minding a machine at pose (3,), (2,) along and across [m]."""
        left, reach = self.way[self.onward] - self.place, self.speed * period
        far = np.linalg.norm(left)
        if far < 1e-9:
            self.onward = 1 - self.onward
            return
        then = self.place + left * min(1.0, reach / far)
        near, now = point_distance([then, self.place], pose, size) - self.radius
        # Along a machine one walks on, but not ever closer.
        along = 0.2 * np.linalg.norm(then - self.place) if near > self.care / 2 else 0.0
        if near < self.care and near < now - along:
            self._wait(period, pose, size)
            return
        self.place, self.waited, self.turned = then, 0.0, 0
        if far <= reach:
            self.onward = 1 - self.onward

    def _wait(self, period: float, pose: ArrayLike, size: ArrayLike) -> None:
        self.waited += period
        if self.waited > self.patience:
            self.onward, self.waited, self.turned = 1 - self.onward, 0.0, self.turned + 1
        off = off_rectangles(self.place, pose, size)
        far = float(np.linalg.norm(off))
        if self.turned > 1 and far - self.radius < self.care:    # turned round and could not walk that way either
            away = off / max(far, 1e-9) * self.speed * period
            backs = self.place + turn([0.0, 0.8, -0.8, 1.5, -1.5]) @ away    # straight back, or past what stands there
            free = point_distance(backs, pose, size) >= far
            if self.hall is not None:
                free &= self.hall.distance(backs) >= self.radius
            if free.any():
                self.place = backs[free.argmax()]


@checked
class KinematicPair:
    """A coupled pair among people that drives exactly as told, and whose beams end where geometry says.

    vehicle : Vehicle; hall : what truly stands there, on the map or not
    pose : (3,) where it truly is: for records and options, not for navigation [m, m, rad]
    walkers : people; odometry : how wrong the wheels are; seed : of all noise
    log : what an engine measured, a row a period
    """

    log: Log | None = None

    def __init__(self, vehicle: Vehicle, hall: Hall, pose: ArrayLike,
                 walkers: tuple[Walker, ...] = (), odometry: Odometry | None = None,
                 seed: int = 0) -> None:
        self.vehicle, self.hall, self.walkers = vehicle, hall, walkers
        self.pose = checked_pose(pose, "pose")
        self.odometry = odometry or Odometry()
        self._random = np.random.default_rng(as_seed(seed))

    def move(self, twist: Motion, period: Period) -> None:
        """Drive on at (v_x, v_y, ω) for a while; ``pose`` is then another."""
        self.pose = moved(self.pose, self.vehicle.within_limits(twist), period)

    def rays(self, scanner: Scanner) -> Array:
        """(beams,) how far the scanner's beams truly go, inf beyond its range [m]."""
        return cast(*scanner.beams_from(self.pose), self.hall.segments, self.people)

    def drive(self, twist: Motion, period: Period) -> Array:
        """Drive on for a while, people walking; returns the step (dx, dy, dθ) the wheels say it was."""
        before = self.pose
        self.move(twist, period)
        for walker in self.walkers:
            walker.walk(period, self.pose, self.vehicle.size)
        return self.odometry.measured(step_between(before, self.pose), self._random)

    def scan(self) -> Array:
        """(h, 2) points of all scanners in the vehicle's frame [m]."""
        return np.concatenate([scanner.points(scanner.measured(self.rays(scanner),
                                                               self._random))
                               for scanner in self.vehicle.scanners])

    @property
    def people(self) -> Array:
        """(c, 3) center and radius of who walks about [m]."""
        return np.array([[*walker.place, walker.radius] for walker in self.walkers]).reshape(-1, 3)


def clearance(vehicle: Vehicle, poses: ArrayLike, hall: Hall, people: ArrayLike = ()) -> Array:
    """(…) exact distance of the pair's rectangle at (…, 3) to what stands and walks there; 0 is contact [m]."""
    q, walking = np.asarray(poses, dtype=float), np.reshape(people, (-1, 3))
    outline, (low, high) = vehicle.outline(q), hall.bounds
    to_edge = np.minimum(outline - low, high - outline).min(axis=-1)
    to_things = rectangle_distance(q[..., None, :], vehicle.size, hall.places, hall.sizes)
    to_people = vehicle.distances(q, walking[:, :2]) - walking[:, 2]
    return np.maximum(np.concatenate([to_edge, to_things, to_people], axis=-1).min(axis=-1), 0.0)
