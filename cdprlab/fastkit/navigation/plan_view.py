"""Plan view of a hall: what stands in it, seen from above as rectangles, and poses (x, y, heading) on its floor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array, as_array, frozen
from ...errors import InvalidInput

if TYPE_CHECKING:
    from ...world import World


@dataclass(frozen=True, eq=False)
class Hall:
    """A known map: k solid rectangles on a floor.

    outlines : (k, 4, 2) corners of each, counter-clockwise [m]
    bounds : (2, 2) lowest and highest corner of the floor that may be driven on [m]
    seen : (k,) whether a scanner's plane cuts it; all keep bases away
    """

    outlines: Array
    bounds: Array
    seen: NDArray[np.bool_]

    @classmethod
    def of(cls, rectangles: ArrayLike, bounds: ArrayLike) -> Hall:
        """A hall of rectangles, all as high as the scanners.

        rectangles : (k, 5) center x, y, edges along and across [m], heading [rad]
        bounds : (2, 2) lowest and highest corner [m]

        >>> Hall.of([[0, 0, 2, 1, 0]], [[-3, -3], [3, 3]]).distance([0, 1.5]).tolist()
        1.0
        """
        rows = as_array(rectangles, "rectangles", ("k", 5), "m, rad")
        outlines = np.array([rectangle(*row) for row in rows.tolist()]).reshape(-1, 4, 2)
        return cls(frozen(outlines), as_array(bounds, "bounds", (2, 2), "m"), _flags(np.ones(len(rows), dtype=bool)))

    @classmethod
    def of_world(cls, world: World, bounds: ArrayLike, height: float = 0.2, tallest: float = 2.4) -> Hall:
        """The plan of a world's scene: all that stands between the floor and the tops of the bases.

        bounds : (2, 2) [m]; height : of the scanners' plane [m]; tallest : of the bases [m]
        """
        floor, boxes = world.scene.floor_height, world.scene.boxes
        low = np.array([box.position[2] - box.size[2] / 2 - floor for box in boxes])
        high = np.array([box.position[2] + box.size[2] / 2 - floor for box in boxes])
        inside = (high > 0.01) & (low < tallest)
        rows = [[*box.position[:2], *box.size[:2], box.yaw] for box, keep in zip(boxes, inside) if keep]
        hall = cls.of(np.array(rows).reshape(-1, 5), bounds)
        return cls(hall.outlines, hall.bounds, _flags(((low < height) & (high > height))[inside]))

    def with_rectangles(self, rectangles: ArrayLike) -> Hall:
        """The hall and more that stands in it; (k, 5) as in `of`."""
        more = Hall.of(rectangles, self.bounds)
        return Hall(frozen(np.concatenate([self.outlines, more.outlines])), self.bounds,
                    _flags(np.concatenate([self.seen, more.seen])))

    @property
    def segments(self) -> Array:
        """(s, 2, 2) edges a scanner can see [m]."""
        return edges(self.outlines[self.seen]).reshape(-1, 2, 2)

    def distance(self, points: ArrayLike) -> Array:
        """(…) distance of (…, 2) points to the nearest rectangle, 0 inside one [m]; inf in an empty hall."""
        p = as_array(points, "points", (2,), "m", batch=True)
        if not len(self.outlines):
            return np.full(p.shape[:-1], np.inf)
        sides = edges(self.outlines)                                        # (k, 4, 2, 2)
        along = sides[..., 1, :] - sides[..., 0, :]
        off = p[..., None, None, :] - sides[..., 0, :]                      # (…, k, 4, 2)
        outside = (along[..., 0] * off[..., 1] - along[..., 1] * off[..., 0] < 0).any(axis=-1)
        to_edge = segment_distance(p[..., None, None, :], sides).min(axis=-1)
        return np.where(outside, to_edge, 0.0).min(axis=-1)


def rectangle(x: float, y: float, length: float, width: float, heading: float = 0.0) -> Array:
    """(4, 2) corners, counter-clockwise [m]."""
    local = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) / 2 * [length, width]
    return np.array([x, y]) + local @ turn(heading).T


def _flags(seen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    seen.setflags(write=False)
    return seen


def edges(outlines: Array) -> Array:
    """(…, k, 2, 2) edges of polygons of (…, k, 2) corners."""
    return np.stack([outlines, np.roll(outlines, -1, axis=-2)], axis=-2)


def turn(heading: ArrayLike) -> Array:
    """(…, 2, 2) rotation matrix."""
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)


def carried(poses: ArrayLike, points: ArrayLike) -> Array:
    """(…, k, 2) where points (k, 2) of a moving frame are, with the frame at poses (…, 3)."""
    q = np.asarray(poses, dtype=float)
    return q[..., None, :2] + np.asarray(points) @ np.swapaxes(turn(q[..., 2]), -1, -2)


def wrapped(angle: ArrayLike) -> Array:
    """The same angle in (−π, π].

    >>> float(wrapped(1.5 * np.pi)) + np.pi / 2
    0.0
    """
    a = np.asarray(angle, dtype=float)
    return np.pi - np.mod(np.pi - a, 2 * np.pi)


def segment_distance(points: Array, segments: Array) -> Array:
    """(…) distance of points (…, 2) to segments (…, 2, 2) [m]."""
    start, along = segments[..., 0, :], segments[..., 1, :] - segments[..., 0, :]
    share = ((points - start) * along).sum(axis=-1) / np.maximum((along * along).sum(axis=-1), 1e-18)
    return np.linalg.norm(points - start - np.clip(share, 0, 1)[..., None] * along, axis=-1)


def outline_distance(a: Array, b: Array) -> float:
    """Distance of two convex polygons (k, 2), (l, 2), counter-clockwise; 0 where they touch or overlap [m]."""
    for one, other in ((a, b), (b, a)):
        sides = edges(one)
        along = sides[:, 1] - sides[:, 0]
        normals = np.stack([along[:, 1], -along[:, 0]], axis=-1)
        if ((other[None] - one[:, None]) @ normals[:, :, None]).min(axis=1).max() > 0:
            break                                # an edge of one parts them
    else:
        return 0.0
    return float(min(segment_distance(a[:, None], edges(b)[None]).min(),
                     segment_distance(b[:, None], edges(a)[None]).min()))


def checked_pose(pose: ArrayLike, name: str) -> Array:
    """(3,) x, y [m], heading [rad]; raises InvalidInput for anything else."""
    q = as_array(pose, name, (3,), "m, m, rad")
    if abs(q[2]) > 100:
        raise InvalidInput(f"{name} has a heading of {q[2]:g} rad: headings are in radians")
    return q
