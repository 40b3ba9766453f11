"""Mobile bases that drive in the plane: their poses, and where their exit points are and go."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..robot import Robot

Point = tuple[float, float]


class PlanarBases:
    """The bases of a planar robot, driven at given speeds in steps of dt.

    robot : where they start
    dt : time step [s]
    """

    def __init__(self, robot: Robot, dt: float) -> None:
        self._start, self._dt = robot, dt
        self._present: Robot | None = robot
        self._poses = [list(base.pose) for base in robot.bases]
        self._speeds = [[0.0, 0.0, 0.0] for _ in robot.bases]
        self.moving = False
        self.exits: list[list[float]] = robot.exit_points.tolist()

    def drive(self, speeds: ArrayLike) -> Array:
        """Set (3p,) speeds (θ̇, ρ̇₁, ρ̇₂); returns them clipped to the limits."""
        bases = self._start.bases
        wanted = as_array(speeds, "base speeds", (3 * len(bases),), "rad/s, m/s")
        limits = np.concatenate([base.speed_max for base in bases]) if bases else wanted
        driven = np.clip(wanted, -limits, limits)
        self._speeds = driven.reshape(-1, 3).tolist()
        self.moving = bool(driven.any())
        return driven

    @property
    def robot(self) -> Robot:
        """The robot with its bases where they are now."""
        if self._present is None:
            self._present = self._start.with_bases({base.name: pose for base, pose in
                                                    zip(self._start.bases, self._poses)})
        return self._present

    def motions(self) -> list[tuple[Point, float, Point, float]]:
        """Of each base: position [m], heading [rad], velocity in world axes [m/s], turning speed [rad/s]."""
        return [((x, y), heading, _turned(heading, along, across), spin)
                for (x, y, heading), (spin, along, across) in zip(self._poses, self._speeds)]

    def exit_velocities(self) -> list[Point]:
        """Mean velocity of each exit point over the coming step [m/s]."""
        after = self._exits_after()
        return [((bx - ax) / self._dt, (by - ay) / self._dt) for (ax, ay), (bx, by) in zip(self.exits, after)]

    def advance(self) -> None:
        """One step on."""
        after = self._exits_after()
        for pose, (_, _, (vx, vy), spin) in zip(self._poses, self.motions()):
            pose[0] += vx * self._dt
            pose[1] += vy * self._dt
            pose[2] += spin * self._dt
        self.exits = [list(point) for point in after]
        self._present = None

    def _exits_after(self) -> list[Point]:
        ahead, points = self.motions(), []
        for cable, k, present in zip(self._start.cables, self._start.base_indices, self.exits):
            if k < 0:
                points.append((present[0], present[1]))
                continue
            (x, y), heading, (vx, vy), spin = ahead[k]
            px, py = _turned(heading + spin * self._dt, *cable.exit_point.tolist())
            points.append((x + vx * self._dt + px, y + vy * self._dt + py))
        return points


def _turned(angle: float, x: float, y: float) -> Point:
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y
