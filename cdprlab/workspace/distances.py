"""Distances between straight cables, and between a cable and a box: closed forms over batches."""

import numpy as np

from ..arrays import Array

_FLAT = 1e-14


def segment_distance(p: Array, q: Array, r: Array, s: Array) -> Array:
    """Between the segments pq and rs.

    p, q, r, s : (…, d) ends [m]
    Returns (…) [m].
    The squared distance is a convex quadratic over the unit square: its minimum is where both
    derivatives vanish, or on an edge, and there it is a quadratic in one variable, clipped.

    >>> segment_distance(*(np.array(x, dtype=float) for x in ([-1, 0, 0], [1, 0, 0], [0, 1, 0.5], [0, 2, 0.5])))
    np.float64(1.118033988749895)
    """
    u, v, w = q - p, s - r, p - r
    a, b, c = _dot(u, u), _dot(u, v), _dot(v, v)
    d, e = _dot(u, w), _dot(v, w)
    det = a * c - b * b
    # Where the segments are parallel the interior point is none, and an edge has the minimum as
    # well.
    inner = np.clip(_ratio(b * e - c * d, det, _FLAT * a * c), 0, 1)
    best = np.full(det.shape, np.inf)
    for x in (inner, np.zeros_like(det), np.ones_like(det)):
        y = np.clip(_ratio(b * x + e, c), 0, 1)
        x = np.clip(_ratio(b * y - d, a), 0, 1)   # on the edge y, and no farther inside
        gap = w + x[..., None] * u - y[..., None] * v
        best = np.minimum(best, _dot(gap, gap))
    return np.sqrt(best)[()]


def box_distance(p: Array, q: Array, half: Array) -> Array:
    """Between the segment pq and the solid box |x| ≤ half.

    p, q : (…, d) ends in the box's frame [m]; half : (d,) or (…, d) half edges [m]
    Returns (…) [m], 0 where it passes through.
    The squared distance along the segment is convex, and quadratic between the places where the
    segment crosses the planes of the faces: least at the best of the pieces' own minima.

    >>> box_distance(np.array([-3.0, 2.0]), np.array([3.0, 2.0]), np.array([1.0, 0.5]))
    np.float64(1.5)
    """
    u = q - p
    crossings = np.concatenate([_ratio(side * half - p, u) for side in (-1.0, 1.0)], axis=-1)
    ends = np.broadcast_to([0.0, 1.0], (*u.shape[:-1], 2))
    t = np.sort(np.clip(np.concatenate([crossings, ends], axis=-1), 0, 1), axis=-1)
    p, u, half = p[..., None, :], u[..., None, :], half[..., None, :]
    slopes = _dot(_outside(p + t[..., None] * u, half), u)   # of half the squared distance, linear on each piece
    before, rise = slopes[..., :-1], np.diff(slopes)
    at = t[..., :-1] + np.diff(t) * np.clip(_ratio(-before, rise), 0, 1)
    gap = _outside(p + at[..., None] * u, half)
    return np.sqrt(_dot(gap, gap).min(axis=-1))[()]


def _outside(x: Array, half: Array) -> Array:
    """From the nearest point of the box to x."""
    return np.sign(x) * np.maximum(np.abs(x) - half, 0.0)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=-1))


def _ratio(a: Array, b: Array, least: Array | float = 0.0) -> Array:
    """a / b, and 0 where b is no more than ``least`` in size."""
    usable = np.abs(b) > least
    return np.where(usable, a / np.where(usable, b, 1.0), 0.0)
