"""Localization on a known map: a Kalman filter whose measurement is how far scanned points are off the map's edges."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ...arrays import Array, checked
from ..plane import Motion, Place, Points, Scan, carried, cross, difference, moved, off_segments, turn
from .hall import Hall

_BEAM = 0.1          # m: of one point; ten times the scanner's noise, since neighboring beams err together
_DOUBTFUL = 0.05     # m: points farther off count less and less
_ROUNDS = 12         # of Gauss and Newton, at most
_NEAR, _FAR = 0.1, 0.5   # m: a point farther off than this, by how sure the pose is, says nothing about it
UNEXPECTED = 0.2
"""A point farther than this from all edges is something that is not on the map [m]."""


@checked
@dataclass(frozen=True)
class Odometry:
    """What wheels say of a short motion, and how wrong they are.

    scale : standard deviation of the error over the way driven, 1 for 100 %
    per_turn : of the heading's error over the angle turned; per_meter : over the way [rad/m]
    """

    scale: Annotated[float, "≥ 0"] = 0.03
    per_turn: Annotated[float, "≥ 0"] = 0.03
    per_meter: Annotated[float, "[rad/m] ≥ 0"] = 0.01

    def covariance(self, step: Motion) -> Array:
        """(3, 3) of a step (dx, dy, dθ) in the vehicle's frame."""
        dx, dy, spin = np.abs(step)
        way = np.hypot(dx, dy)
        across, about = self.scale * way + 1e-5, self.per_turn * spin + self.per_meter * way + 1e-5
        return np.diag([across, across, about]) ** 2

    def measured(self, step: Motion, random: np.random.Generator) -> Array:
        """(3,) what the wheels say of a true step."""
        return random.normal(np.asarray(step), np.sqrt(np.diag(self.covariance(step))))


@checked
class Localization:
    """Where the vehicle believes to be.

    hall : the map
    pose : (3,) x, y, heading, at first as told [m, m, rad]
    uncertainty : (3,) standard deviations of that [m, m, rad]
    odometry : how far the wheels are to be trusted
    eyes : (k, 2) where the scanners are, in the vehicle's frame [m]

    >>> wall = Hall.of([[2, 0, 0.2, 4, 0], [0, 2, 4, 0.2, 0]], [[-3, -3], [3, 3]])
    >>> seen = np.array([[1.8, -0.5], [1.8, 0.5], [0.0, 1.8], [1.0, 1.8]])   # from (0.1, 0.1)
    >>> Localization(wall, [0, 0, 0]).look(seen).round(1).tolist()
    [0.1, 0.1, 0.0]
    """

    def __init__(self, hall: Hall, pose: Place, uncertainty: Place = (0.1, 0.1, 0.05),
                 odometry: Odometry | None = None, eyes: Points = ((0.0, 0.0),)) -> None:
        self.segments, self.eyes, self.pose = hall.segments, eyes, np.asarray(pose)
        self.covariance = np.diag(np.square(uncertainty))
        self.odometry = odometry or Odometry()

    @property
    def deviation(self) -> Array:
        """(3,) standard deviations the filter believes in [m, m, rad]."""
        return np.sqrt(np.diag(self.covariance))

    def drive(self, step: Motion) -> Array:
        """Prediction: the wheels say (dx, dy, dθ) in the vehicle's frame; returns the pose."""
        before, self.pose = self.pose, moved(self.pose, step)
        x, y, _ = self.pose - before
        F, G = np.eye(3), np.eye(3)
        F[:2, 2] = [-y, x]
        G[:2, :2] = turn(before[2] + np.asarray(step)[2] / 2)
        self.covariance = F @ self.covariance @ F.T + G @ self.odometry.covariance(step) @ G.T
        return self.pose

    def look(self, points: Scan) -> Array:
        """Correction: scanned points (h, 2) in the vehicle's frame belong on the map's edges; returns the pose.

        min over q of ‖q − q_predicted‖² / P + Σ d(q p_i)² / σ², points far off every edge left
        out.
        """
        if not len(points) or not len(self.segments):
            return self.pose
        predicted, prior, segments = self.pose, np.linalg.inv(self.covariance), self._facing()
        gate = np.clip(_NEAR + 3 * self.deviation[:2].max(), _NEAR, _FAR)
        for _ in range(_ROUNDS):
            off, arms = self._offsets(points, segments)
            e = np.linalg.norm(off, axis=1)
            weight = (e < gate) / np.maximum(1.0, e / _DOUBTFUL) / _BEAM**2
            # ∂e/∂q
            slope = np.column_stack([off, cross(arms, off)]) / np.maximum(e, 1e-9)[:, None]
            weighted = (slope * weight[:, None]).T
            H = prior + weighted @ slope
            g = weighted @ e + prior @ difference(self.pose, predicted)
            step = np.linalg.solve(H, -g)
            self.pose = self.pose + step
            if np.abs(step).max() < 2e-4:
                break
        self.covariance = np.linalg.inv(H)
        return self.pose

    def unexpected(self, points: Scan) -> Array:
        """(u, 2) those scanned points, in the vehicle's frame, that are nowhere near the map's edges."""
        if not len(self.segments):
            return points
        return points[np.linalg.norm(self._offsets(points, self.segments)[0], axis=1) > UNEXPECTED]

    def _facing(self) -> Array:
        """(s, 2, 2) edges that some scanner sees from outside: the far side of a wall is nearly as near as its face."""
        segments = self.segments
        off = carried(self.pose, self.eyes)[:, None] - segments[:, 0]
        before = (cross(off, segments[:, 1] - segments[:, 0]) > 0).any(axis=0)
        return segments[before] if before.any() else segments

    def _offsets(self, points: Array, segments: Array) -> tuple[Array, Array]:
        """(h, 2) from the nearest edge to each point, and from the vehicle's middle to it, in the world [m]."""
        p = carried(self.pose, points)
        off = off_segments(p[:, None], segments)
        nearest = np.argmin((off * off).sum(axis=-1), axis=1)
        return off[np.arange(len(p)), nearest], p - self.pose[:2]
