"""Following a plan within the bases' speed limits, and never closer to what is in the way than a safe distance."""

import numpy as np

from ...arrays import Array, checked
from ...errors import InvalidInput
from ..plane import Period, Place, Scan, Way, difference, moved, relative
from .planner import along
from .vehicle import Vehicle

STOP_DISTANCE = 0.3
"""The pair does not come closer than this to anything that is not on its map and may walk [m]."""

_AHEAD = 0.12            # m on the plan, from where the pair is to where it aims
_GAIN = 2.0              # 1/s
_ACCELERATION = 0.2      # m/s² and, over the arm, rad/s²
_HORIZON = (0.5, 1.0, 1.5)  # s that are looked ahead
ARRIVED = np.array([0.005, 0.005, 0.0035])
"""How near to its goal the pair believes to be when it stops [m, m, rad]."""


@checked
class Follower:
    """Drives along a plan: aims a little ahead of where the vehicle is, as fast as limits and neighbors allow.

    vehicle : Vehicle; poses : (n, 3) of a `Plan`

    ``twist`` is the last command; ``blocked`` whether something that is not on the map keeps it
    from driving on.
    """

    def __init__(self, vehicle: Vehicle, poses: Way) -> None:
        if not len(poses):
            raise InvalidInput("poses must be one at least: the plan has no way")
        self.vehicle = vehicle
        self.way = along(poses, 0.01, 0.01)
        self.aim, self.twist, self.blocked = 0, np.zeros(3), False

    def arrived(self, pose: Place) -> bool:
        """Whether the vehicle is at the plan's end, and slow."""
        there = (np.abs(difference(self.way[-1], pose)) <= ARRIVED).all()
        return bool(there and np.abs(self.twist).max() < 0.02)

    def command(self, pose: Place, unexpected: Scan, period: Period) -> Array:
        """(3,) v_x, v_y, ω of the next period, in the vehicle's frame [m/s, rad/s].

        pose : (3,) where the vehicle believes to be
        unexpected : (u, 2) points in its frame that are not on the map
        period : [s]
        """
        vehicle, last = self.vehicle, len(self.way) - 1
        while self.aim < last and vehicle.way(self.way[self.aim], pose) < _AHEAD:
            self.aim += 1
        wish = vehicle.within_limits(_GAIN * relative(self.way[self.aim], pose))
        # Slow enough to stop at the end, v = √(2 a s).
        left = vehicle.way(self.way[-1], pose) + 0.01 * (last - self.aim)
        speed = max(np.linalg.norm(wish[:2]), vehicle.arm * abs(wish[2]), 1e-9)
        wish = wish * min(1.0, np.sqrt(1.6 * _ACCELERATION * left) / speed)
        most = _ACCELERATION * period * np.array([1, 1, 1 / vehicle.arm])
        wish = self.twist + np.clip(wish - self.twist, -most, most)
        here = np.zeros(3)
        least = np.minimum(STOP_DISTANCE, vehicle.distances(here, unexpected) - 1e-4)
        for share in (1.0, 0.5, 0.2, 0.0):
            self.twist = share * wish
            then = vehicle.distances(moved(here, np.outer(_HORIZON, self.twist)), unexpected)
            if (then >= least).all():
                break
        self.blocked = share == 0.0
        return self.twist
