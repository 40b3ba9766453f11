"""The coupled pair of bases as one vehicle that drives in every direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, frozen
from ...errors import InvalidInput
from ...robot import Robot
from .laser import Scanner
from .plan_view import carried, rectangle, wrapped


@dataclass(frozen=True, eq=False)
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
    def of(cls, robot: Robot, spacing: float = 2.0, active: str = "active", beams: int = 271) -> Vehicle:
        """The pair of a robot with two bases of one footprint.

        spacing : between the bases' centers when coupled [m]; active : the base that drives
        beams : of each scanner

        >>> import cdprlab as cl
        >>> pair = Vehicle.of(cl.load_world("fastkit_suspended").robot)
        >>> round(pair.length, 3), pair.width
        (2.9, 1.0)
        """
        if len(robot.bases) != 2:
            raise InvalidInput(f"the link couples two bases, this robot has {len(robot.bases)}")
        if robot.dimension == 2:
            raise InvalidInput("a planar world is seen from the side: its bases have no way around anything")
        base = robot.base(active)
        if not (base.speed_max > 0).all():
            raise InvalidInput(f"base {active!r} is to drive the pair, but a zero speed limit holds it")
        half = np.abs(np.concatenate([b.footprint for b in robot.bases])).max(axis=0)
        if spacing < 2 * half[0]:
            raise InvalidInput(f"coupled bases are at least {2 * half[0]:g} m apart, got {spacing:g} m")
        length, width = spacing + 2 * float(half[0]), 2 * float(half[1])
        # On opposite corners two scanners of 270 degrees look all around, and see nothing of the bases.
        corner = np.array([length, width]) / 2
        scanners = (Scanner(-corner[0], corner[1], 0.75 * np.pi, beams=beams),
                    Scanner(corner[0], -corner[1], -0.25 * np.pi, beams=beams))
        discs, radius = _covering(length, width)
        return cls(length, width, spacing / 2, base.speed_max, scanners, frozen(discs), radius)

    def outline(self, pose: ArrayLike) -> Array:
        """(4, 2) corners at pose (3,) [m]."""
        return carried(pose, rectangle(0, 0, self.length, self.width))

    def bases(self, pose: ArrayLike) -> Array:
        """(…, 2, 3) poses of the active and the passive base, the pair at pose (…, 3)."""
        q = np.asarray(pose, dtype=float)
        centers = carried(q, [[-self.arm, 0.0], [self.arm, 0.0]])
        return np.concatenate([centers, np.broadcast_to(q[..., None, 2:], (*centers.shape[:-1], 1))], axis=-1)

    def pose_of(self, active: ArrayLike) -> Array:
        """(…, 3) pose of the pair whose active base is at (…, 3)."""
        q = np.asarray(active, dtype=float)
        return np.concatenate([carried(q, [[self.arm, 0.0]])[..., 0, :], q[..., 2:]], axis=-1)

    def base_speeds(self, twist: ArrayLike) -> Array:
        """(3,) speeds of the active base, rotation, along, across, for the pair's (v_x, v_y, ω) in its own frame."""
        vx, vy, spin = np.asarray(twist, dtype=float).tolist()
        return np.array([spin, vx, vy - self.arm * spin])

    def twist_of(self, base_speeds: ArrayLike) -> Array:
        """(3,) the pair's (v_x, v_y, ω) in its own frame when the active base drives so."""
        spin, vx, vy = np.asarray(base_speeds, dtype=float).tolist()
        return np.array([vx, vy + self.arm * spin, spin])

    def within_limits(self, twist: ArrayLike) -> Array:
        """(3,) the same motion, slowed down until both bases can drive it.

        >>> import cdprlab as cl
        >>> Vehicle.of(cl.load_world("fastkit_suspended").robot).within_limits([0.4, 0, 0]).tolist()
        [0.2, 0.0, 0.0]
        """
        t = np.asarray(twist, dtype=float)
        ends = np.array([[t[2], t[0], t[1] - self.arm * t[2]], [t[2], t[0], t[1] + self.arm * t[2]]])
        return np.asarray(t / max(1.0, float((np.abs(ends) / self.speed_max).max())))


def moved(pose: ArrayLike, twist: ArrayLike, period: float) -> Array:
    """(…, 3) pose after driving on at (v_x, v_y, ω), in the vehicle's frame, for a short while [s]."""
    q, t = np.asarray(pose, dtype=float), np.asarray(twist, dtype=float)
    heading = q[..., 2] + t[..., 2] * period / 2
    c, s = np.cos(heading), np.sin(heading)
    step = np.stack([c * t[..., 0] - s * t[..., 1], s * t[..., 0] + c * t[..., 1], t[..., 2]], axis=-1) * period
    return q + step


def difference(target: ArrayLike, pose: ArrayLike) -> Array:
    """(…, 3) target minus pose, the angle the short way round [m, m, rad]."""
    d = np.asarray(target, dtype=float) - np.asarray(pose, dtype=float)
    return np.concatenate([d[..., :2], wrapped(d[..., 2:])], axis=-1)


def _covering(length: float, width: float) -> tuple[Array, float]:
    """Centers and radius of discs over the rim of a rectangle: three rows, those inside left out."""
    rows, columns = 3, int(np.ceil(3 * length / width))
    x, y = (((np.arange(count) + 0.5) / count - 0.5) * size for count, size in ((columns, length), (rows, width)))
    centers = np.stack(np.meshgrid(x, y), axis=-1)
    rim = np.ones((rows, columns), dtype=bool)
    rim[1, 1:-1] = False
    return centers[rim], float(np.hypot(length / columns, width / rows) / 2)
