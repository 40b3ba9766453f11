"""The coupled pair of bases as one vehicle that drives in every direction."""

from __future__ import annotations

import numpy as np

from ...arrays import Array, frozen, frozen_dataclass
from ...errors import InvalidInput
from ...robot import Robot
from ..plane import Motion, Place, Places, Scan, difference, placed, point_distance, rectangle
from .laser import Scanner

ACTIVE = "active"
"""Name of the base that drives the pair."""

_LONGEST = 100.0     # m: no link is longer


@frozen_dataclass
class Vehicle:
    """Two coupled bases; its frame is half way between them, x from the active base to the passive one.

    length, width : of the rectangle around both footprints [m]
    arm : from the middle to either base's center [m]
    speed_max : (3,) of a base: rotation, along, across [rad/s, m/s]
    scanners : one a base, in the vehicle's frame
    discs : (k, 2) centers that, with ``radius``, cover the rectangle's rim [m]
    """

    length: float
    width: float
    arm: float
    speed_max: Array
    scanners: tuple[Scanner, ...]
    discs: Array
    radius: float

    @classmethod
    def of(cls, robot: Robot, spacing: float = 2.0, beams: int = 271) -> Vehicle:
        """The pair of a robot with two bases of one footprint.

        spacing : between the bases' centers when coupled [m]; beams : of each scanner

        >>> import cdprlab as cl
        >>> pair = Vehicle.of(cl.load_world("fastkit_suspended").robot)
        >>> round(pair.length, 3), pair.width
        (2.9, 1.0)
        """
        if len(robot.bases) != 2:
            raise InvalidInput(f"the link couples two bases, this robot has {len(robot.bases)}")
        if robot.dimension == 2:
            raise InvalidInput("a planar world is seen from the side: its bases have no way around anything")
        base = robot.base(ACTIVE)
        if not (base.speed_max > 0).all():
            raise InvalidInput(f"base {ACTIVE!r} is to drive the pair, but a zero speed limit holds it")
        half, across = np.abs(np.concatenate([b.footprint for b in robot.bases])).max(axis=0).tolist()
        if not 2 * half <= spacing <= _LONGEST:
            raise InvalidInput(f"coupled bases are {2 * half:g} to {_LONGEST:g} m apart, got {spacing:g} m")
        length, width = spacing + 2 * half, 2 * across
        # On opposite corners two scanners of 270 degrees look all around, and see nothing of
        # the bases.
        scanners = (Scanner(-length / 2, width / 2, 0.75 * np.pi, beams=beams),
                    Scanner(length / 2, -width / 2, -0.25 * np.pi, beams=beams))
        discs, radius = _covering(length, width)
        return cls(length, width, spacing / 2, base.speed_max, scanners, frozen(discs), radius)

    @property
    def size(self) -> Array:
        """(2,) length and width [m]."""
        return np.array([self.length, self.width])

    @property
    def eyes(self) -> Array:
        """(k, 2) where the scanners are, in the vehicle's frame [m]."""
        return np.array([[scanner.x, scanner.y] for scanner in self.scanners])

    def outline(self, pose: Places) -> Array:
        """(…, 4, 2) corners at pose (…, 3) [m]."""
        return rectangle(pose, self.size)

    def distances(self, pose: Places, points: Scan) -> Array:
        """(…, u) of points (u, 2) from the rectangle at pose (…, 3), both in one frame; 0 inside [m]."""
        return point_distance(points, np.expand_dims(pose, -2), self.size)

    # --- the bases --------------------------------------------------------------------------------
    def bases(self, pose: Places) -> Array:
        """(…, 2, 3) poses of the active and the passive base, the pair at pose (…, 3)."""
        return placed(np.expand_dims(pose, -2), [[-self.arm, 0, 0], [self.arm, 0, 0]])

    def base_outlines(self, pose: Places) -> Array:
        """(…, 2, 4, 2) corners of their rectangles [m]."""
        return rectangle(self.bases(pose), [self.length - 2 * self.arm, self.width])

    def pose_of(self, active: Places) -> Array:
        """(…, 3) pose of the pair whose active base is at (…, 3)."""
        return placed(active, [self.arm, 0, 0])

    def base_speeds(self, twist: Motion) -> Array:
        """(3,) speeds of the active base, rotation, along, across, for the pair's (v_x, v_y, ω) in its own frame."""
        vx, vy, spin = np.asarray(twist)
        return np.array([spin, vx, vy - self.arm * spin])

    # --- ways -------------------------------------------------------------------------------------
    def way(self, a: Place, b: Place) -> float:
        """From one pose to another, of the base that has farther to go, about [m]."""
        x, y, spin = np.abs(difference(a, b))
        return float(np.hypot(x, y) + self.arm * spin)

    def quickest(self, step: Places) -> Array:
        """(…) how long a step (…, 3) (dx, dy, dθ) in its own frame takes at the bases' speed limits [s]."""
        x, y, spin = np.moveaxis(np.abs(step), -1, 0)
        return (np.stack([spin, x, y + self.arm * spin], axis=-1) / self.speed_max).max(axis=-1)

    def within_limits(self, twist: Motion) -> Array:
        """(3,) a motion (v_x, v_y, ω), slowed down until both bases can drive it.

        >>> import cdprlab as cl
        >>> Vehicle.of(cl.load_world("fastkit_suspended").robot).within_limits([0.4, 0, 0]).tolist()
        [0.2, 0.0, 0.0]
        """
        return np.divide(twist, np.maximum(1.0, self.quickest(twist)))


def _covering(length: float, width: float) -> tuple[Array, float]:
    """Centers and radius of discs over the rim of a rectangle: three rows, those inside left out."""
    size, counts = np.array([length, width]), np.array([int(np.ceil(3 * length / width)), 3])
    rim = np.ones(counts, dtype=bool)
    rim[1:-1, 1] = False
    centers = ((np.argwhere(rim) + 0.5) / counts - 0.5) * size
    return centers, float(np.hypot(*(size / counts)) / 2)
