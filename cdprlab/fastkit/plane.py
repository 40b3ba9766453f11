"""Geometry on the floor: poses (x, y, heading) that carry points and poses, segments, solid rectangles."""

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..errors import InvalidInput
from ..robot.pose import rotation_from_vector
from ..workspace.distances import box_distance

Place = Annotated[ArrayLike, "(3,) [m, m, rad]"]
Places = Annotated[ArrayLike, "(…, 3) [m, m, rad]"]
Bounds = Annotated[ArrayLike, "(2, 2) [m]"]
Motion = Annotated[ArrayLike, "(3,) [m, m, rad; or a second]"]
Points = Annotated[ArrayLike, "(…, k, 2) [m]"]
Scan = Annotated[Array, "(h, 2) [m]"]
Way = Annotated[Array, "(n, 3) [m, m, rad]"]
Spots = Annotated[ArrayLike, "(…, 2) [m]"]
Period = Annotated[float, "[s] > 0"]
"""What public functions take: poses, a floor's corners, motions (v or d of x, y, θ), points in a list, scanned, along
a way, anywhere; how long."""

NO_POINTS = frozen(np.zeros((0, 2)))
_CORNERS = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) / 2


def checked_pose(pose: ArrayLike, name: str) -> Array:
    """(3,) x, y [m], heading [rad]; raises InvalidInput for anything else."""
    q = as_array(pose, name, (3,), "m, m, rad")
    if abs(q[2]) > 100:
        raise InvalidInput(f"{name} has a heading of {q[2]:g} rad: headings are in radians")
    return q


# --- poses ------------------------------------------------------------------------------------------------
def turn(heading: ArrayLike) -> Array:
    """(…, 2, 2) rotation matrix."""
    return rotation_from_vector(np.asarray(heading, dtype=float)[..., None])


def carried(poses: Places, points: Points) -> Array:
    """(…, k, 2) where points (k, 2) of a moving frame are, with the frame at poses (…, 3)."""
    q = np.asarray(poses, dtype=float)
    return q[..., None, :2] + np.matmul(points, turn(-q[..., 2]))


def placed(frames: ArrayLike, poses: ArrayLike, turned: float = 0.0) -> Array:
    """(…, 3) where poses (…, 3) in a moving frame are, with the frame at (…, 3).

    turned : share of each pose's own angle by which the frame has turned as its place counts

    >>> placed([1, 2, np.pi / 2], [0.5, 0, 0.1]).round(2).tolist()
    [1.0, 2.5, 1.67]
    """
    q, p = np.broadcast_arrays(frames, poses)
    way = turn(q[..., 2] + turned * p[..., 2]) @ p[..., :2, None]
    return q + np.concatenate([way[..., 0], p[..., 2:]], axis=-1)


def relative(poses: ArrayLike, frames: ArrayLike, turned: float = 0.0) -> Array:
    """(…, 3) poses as their frames, other poses, see them: what `placed` puts back."""
    d = difference(poses, frames)
    way = d[..., None, :2] @ turn(np.asarray(frames)[..., 2] + turned * d[..., 2])
    return np.concatenate([way[..., 0, :], d[..., 2:]], axis=-1)


def difference(target: Places, pose: Places) -> Array:
    """(…, 3) target minus pose, the angle the short way round, in (−π, π] [m, m, rad]."""
    d = np.subtract(target, pose)
    return np.concatenate([d[..., :2], np.pi - np.mod(np.pi - d[..., 2:], 2 * np.pi)], axis=-1)


def moved(pose: ArrayLike, twist: ArrayLike, period: float = 1.0) -> Array:
    """(…, 3) pose after driving on at (v_x, v_y, ω), in the vehicle's frame, for a short while [s]."""
    return placed(pose, np.multiply(twist, period), 0.5)


def step_between(before: ArrayLike, after: ArrayLike) -> Array:
    """(…, 3) (dx, dy, dθ) in the vehicle's frame, as `moved` takes it."""
    return relative(after, before, 0.5)


def cross(a: Array, b: Array) -> Array:
    """(…) a_x b_y − a_y b_x of (…, 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


# --- segments and rectangles --------------------------------------------------------------------------------
def rectangle(pose: ArrayLike, size: ArrayLike) -> Array:
    """(…, 4, 2) corners, counter-clockwise, of rectangles at poses (…, 3), (…, 2) along and across them [m]."""
    return carried(pose, _CORNERS * np.asarray(size)[..., None, :])


def edges(outlines: Array) -> Array:
    """(…, k, 2, 2) edges of polygons of (…, k, 2) corners."""
    return np.stack([outlines, np.roll(outlines, -1, axis=-2)], axis=-2)


def off_segments(points: Array, segments: Array) -> Array:
    """(…, 2) from the nearest point of a segment (…, 2, 2) to a point (…, 2) [m]."""
    start, along = segments[..., 0, :], segments[..., 1, :] - segments[..., 0, :]
    off = points - start
    share = (off * along).sum(axis=-1) / np.maximum((along * along).sum(axis=-1), 1e-18)
    return off - np.clip(share, 0, 1)[..., None] * along


def off_rectangles(points: ArrayLike, poses: ArrayLike, sizes: ArrayLike) -> Array:
    """(…, 2) from the nearest point of a solid rectangle at a pose (…, 3), (…, 2) along and across, to a point (…, 2).

    >>> off_rectangles([0, 2], [0, 0, np.pi / 2], [3, 1]).round(2).tolist()
    [0.0, 0.5]
    """
    q, half = np.asarray(poses, dtype=float), np.divide(sizes, 2)
    R = turn(q[..., 2])
    local = ((points - q[..., :2])[..., None, :] @ R)[..., 0, :]
    return (R @ (local - np.clip(local, -half, half))[..., None])[..., 0]


def point_distance(points: ArrayLike, poses: ArrayLike, sizes: ArrayLike) -> Array:
    """(…) of that point from that rectangle; 0 inside [m]."""
    return np.linalg.norm(off_rectangles(points, poses, sizes), axis=-1)


def rectangle_distance(pose: ArrayLike, size: ArrayLike, poses: ArrayLike,
                       sizes: ArrayLike) -> Array:
    """(…) of a rectangle at a pose (…, 3), (2,) along and across, to another; 0 where they touch or overlap [m]."""
    others = relative(poses, pose)   # as the first one sees them
    ends = edges(rectangle(others, sizes))
    to_edges = box_distance(ends[..., 0, :], ends[..., 1, :], np.divide(size, 2)).min(axis=-1)
    # The other may have all of the first inside, far from its own edges.
    return np.minimum(to_edges, point_distance(np.zeros(2), others, sizes))
