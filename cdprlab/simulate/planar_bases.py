"""Mobile bases that drive in the plane: their poses, and where their exit points are and go."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..robot import Robot, turned_to


class PlanarBases:
    """The bases of a planar robot, driven at given speeds in steps of dt.

    robot : where they start
    dt : time step [s]
    poses, rates : (p, 3) x, y, heading now [m, m, rad] and their rates in world axes [m/s, m/s,
        rad/s]
    exits, exits_ahead : (m, 2) exit points now and after the coming step [m]
    exit_velocities : (m, 2) their mean velocities over that step [m/s]
    reels : (m, 2) where the ropes' straight parts would begin if they had no arc, without pulleys
        the exit points [m]
    reel_velocities : (m, 2) theirs as points of the bases, other ones where a base turns [m/s]
    pulleys : (m or 0, 3) as `Robot.pulleys` has them, now
    frames : none leans
    Arrays that change are written into, but for the poses.
    """

    frames = None

    def __init__(self, robot: Robot, dt: float) -> None:
        self._robot, self._dt = robot, dt
        self.poses = frozen(np.array([base.pose for base in robot.bases]).reshape(-1, 3))
        self.exits, self.pulleys = robot.exit_points.copy(), robot.pulleys.copy()
        self.reels, self.reel_velocities = self.exits, np.zeros_like(self.exits)
        self.drive(np.zeros(self.poses.size))

    def drive(self, speeds: ArrayLike) -> Array:
        """Set (3p,) speeds (θ̇, ρ̇₁, ρ̇₂); returns them clipped to the limits."""
        wanted = as_array(speeds, "base speeds", (self.poses.size,), "rad/s, m/s")
        limits = self._robot.base_speed_max
        driven = np.clip(wanted, -limits, limits)
        self._speeds, self.moving = driven.reshape(-1, 3), bool(driven.any())
        self._aim()
        return driven

    def advance(self) -> None:
        """One step on."""
        self.poses, self.exits[:] = frozen(self.poses + self.rates * self._dt), self.exits_ahead
        if self.pulleys.size and self.rates[:, 2].any():
            names = (base.name for base in self._robot.bases)
            self.pulleys[:] = self._robot.with_bases(dict(zip(names, self.poses))).pulleys
        self._aim()

    def lead(self, reels: Array) -> None:
        """Over pulleys: the ropes come from these (m, 2) points of the bases [m]."""
        spins = np.append(self.rates[:, 2], 0.0)[list(self._robot.base_indices)]
        x, y = (reels - self.exits).T
        self.reels = reels
        self.reel_velocities[:] = self.exit_velocities + np.stack([-spins * y, spins * x], axis=1)

    def _aim(self) -> None:
        """What the present speeds, in the bases' own axes, come to in the world."""
        spin, along, across = self._speeds.T
        c, s = np.cos(self.poses[:, 2]), np.sin(self.poses[:, 2])
        self.rates = np.stack([c * along - s * across, s * along + c * across, spin], axis=1)
        after = self.poses + self.rates * self._dt
        self.exits_ahead = np.array([
            place if k < 0 else after[k, :2] + turned_to(after[k, 2], 2) @ cable.exit_point
            for cable, k, place in zip(self._robot.cables, self._robot.base_indices, self.exits)])
        # What stands still does so exactly, not to rounding.
        self.exit_velocities = self.moving * (self.exits_ahead - self.exits) / self._dt
        self.reel_velocities[:] = self.exit_velocities
        if self.pulleys.size:
            self.lead(self.reels)
