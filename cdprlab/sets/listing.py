"""Vertices, facets and volume of a `Polytope`, listed where that is sensible."""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import NotListable
from .frame import Frame
from .simplex import Indices, maximize
from .zonotope import (
    MOST_COMBINATIONS,
    PARALLEL,
    box_corners,
    first_of_each,
    hyperplane_shifting,
    n_choices,
    zonotope_volume,
)

if TYPE_CHECKING:
    from .polytope import Polytope

_SAME = 1e-8
"""Corners of a set of size 1 this close together are one: Qhull merges within about 1e-12 of its own accord."""

_FULL_RANK = 1e-12
"""Smallest eigenvalue of Σ n nᵀ over unit normals that meet in a corner; rounding is 1e-15."""

_MOST_SIGNS = 12
"""Generators up to which a zonotope's corners are sought among all 2ᵏ sign combinations."""

_MOST_CANDIDATES = 20_000
"""Rows to be sorted into facets and others, before a listing is called too long."""


class Planes(NamedTuple):
    """Facets in the frame's coordinates, and the corners and volume where they came along.

    normals : (f, k) unit; offsets : (f,); corners : (v, k) or None
    """

    normals: Array
    offsets: Array
    corners: Array | None = None


def planes(polytope: Polytope) -> Planes:
    """The facets by the cheapest exact way there is.

    Zonotopes: hyperplane shifting. Sets whose rows are known: rows without the superfluous ones. Others, up to 3-D:
    hull of support points, asked for until every facet is a support plane.
    Raises NotListable when none of them is sensible.
    """
    at = polytope._frame
    k = at.dimension
    if k <= 1:
        return _short(polytope, at)
    if polytope.box is not None:
        return _zonotope_planes(polytope, at)
    if polytope._outer_rows is not None:
        return _without_superfluous(*_in_frame(polytope, at, *polytope._outer_rows))
    if k <= 3:
        return _asked_hull(polytope, at)
    raise NotListable(f"the facets of this {k}-dimensional image cannot be listed at sensible cost; ask contains, "
                      "support or axis_section, or list a part of it: project([0, 1, 2]) or slice([0, 1, 2])")


def corners(polytope: Polytope) -> Array:
    """(v, k) vertices in the frame's coordinates; in the plane counter-clockwise."""
    found = polytope._planes
    if found.corners is not None:
        points = found.corners
    elif polytope.box is not None and polytope.map.shape[1] <= _MOST_SIGNS:
        at, every = polytope._frame, polytope.map @ box_corners(*polytope.box).T + polytope.shift[:, None]
        points = _tips(at.basis.T @ ((every.T - at.center) / at.scales).T, *found[:2])
    else:
        points = _meetings(*found[:2])
    if points.shape[1] != 2:
        return points
    middle = points.mean(axis=0)
    return points[np.argsort(np.arctan2(*(points - middle).T[::-1]))]


def facets(polytope: Polytope) -> tuple[Array, Array]:
    """Rows over x: (f, n) and (f,), with two opposite ones a missing direction."""
    at, found = polytope._frame, polytope._planes
    if at.dimension < 0:
        return np.zeros((1, polytope.n)), -np.ones(1)
    n, d = at.rows(found.normals, found.offsets)
    level = at.center @ at.missing
    return np.concatenate([n, at.missing.T, -at.missing.T]), np.concatenate([d, level, -level])


def volume(polytope: Polytope) -> float:
    """Volume of the set, 0 where it is flat."""
    at = polytope._frame
    if at.dimension < polytope.n:
        return 0.0
    if polytope.box is not None and comb(polytope.map.shape[1], polytope.n) <= MOST_COMBINATIONS:
        return zonotope_volume(polytope.center_and_generators[1])
    inside = np.ptp(polytope._corners) if polytope.n == 1 else _hull(polytope._corners).volume
    return float(inside * at.scales.prod())


def _short(polytope: Polytope, at: Frame) -> Planes:
    """Nothing, a point or a segment."""
    k = max(at.dimension, 0)
    if k == 0:
        return Planes(np.zeros((0, 0)), np.zeros(0), np.zeros((at.dimension + 1, 0)))
    way = at.basis.T / at.scales
    ends = ((polytope.support_point(np.concatenate([way, -way])) - at.center) @ way.T)[:, 0]
    return Planes(np.array([[1.0], [-1.0]]), np.array([ends[0], -ends[1]]), ends[::-1, None])


def _zonotope_planes(polytope: Polytope, at: Frame) -> Planes:
    center, generators = polytope.center_and_generators
    inside = at.basis.T @ (generators / at.scales[:, None])
    if n_choices(*inside.shape) > MOST_COMBINATIONS:
        raise NotListable(f"{inside.shape[1]} cables in {inside.shape[0]} dimensions make {n_choices(*inside.shape)} "
                          f"candidate planes, more than {MOST_COMBINATIONS}; ask contains and support instead")
    middle = at.basis.T @ ((center - at.center) / at.scales)
    return Planes(*hyperplane_shifting(middle, inside))


def _in_frame(polytope: Polytope, at: Frame, normals: Array, offsets: Array) -> tuple[Array, Array]:
    """Distinct unit rows over z, those that touch the set."""
    n = normals * at.scales @ at.basis
    d = offsets - normals @ at.center
    size = np.linalg.norm(n, axis=1)
    kept = np.isfinite(d) & (size > PARALLEL * size.max())
    n, d = n[kept] / size[kept, None], d[kept] / size[kept]
    order = np.argsort(d, kind="stable")    # of equal normals the nearest plane comes first, and stays
    n, d = n[order], d[order]
    unique = first_of_each(n)
    n, d = n[unique], d[unique]
    if len(n) > 40 * at.dimension:          # asking is cheaper than Qhull once there are many
        out, level = at.rows(n, np.zeros(len(n)))
        size = np.linalg.norm(n @ at.basis.T / at.scales, axis=1)
        touching = (polytope.support(out) - level) * size >= d - _SAME
        n, d = n[touching], d[touching]
    if len(n) > _MOST_CANDIDATES:
        raise NotListable(f"{len(n)} candidate planes, more than {_MOST_CANDIDATES}; ask contains and support instead")
    return n, d


def _without_superfluous(normals: Array, offsets: Array) -> Planes:
    """Planes n·z ≤ d around an inner point and points n/d are dual: a facet is a corner of the points' hull."""
    try:
        hull = _hull(normals / offsets[:, None])
    except NotListable:                     # corners where many planes meet: each plane is then asked for itself
        kept = _needed(normals, offsets)
        return Planes(normals[kept], offsets[kept])
    kept = np.sort(hull.vertices)
    return Planes(normals[kept], offsets[kept], _from_dual(hull.equations))


def _needed(normals: Array, offsets: Array) -> Indices:
    """Planes beyond which the set reaches as soon as they give way: max nᵢ·z > dᵢ with dᵢ + 1 for dᵢ in row i."""
    reached = maximize(normals, offsets + np.eye(len(offsets)), normals).values
    return np.flatnonzero(reached > offsets + _SAME)


def _meetings(normals: Array, offsets: Array) -> Array:
    return _from_dual(_hull(normals / offsets[:, None]).equations)


def _tips(points: Array, normals: Array, offsets: Array) -> Array:
    """(v, k) those of the columns at which planes of full rank meet."""
    on = (normals @ points >= offsets[:, None] - _SAME).astype(float)
    spread = np.einsum("fp,fi,fj->pij", on, normals, normals)
    tips = points.T[np.linalg.eigvalsh(spread)[:, 0] > _FULL_RANK]
    return tips[first_of_each(tips, _SAME)]


def _hull(points: Array) -> Any:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return ConvexHull(points)
    except QhullError as error:
        raise NotListable("Qhull cannot tell the facets of this set apart (too many meet in one corner); ask contains, "
                          "support or axis_section, or list a part of it by project or slice") from error


def _from_dual(equations: Array) -> Array:
    points = -equations[:, :-1] / equations[:, -1:]
    return points[first_of_each(points, _SAME)]


def _asked_hull(polytope: Polytope, at: Frame) -> Planes:
    """Hull of support points, new ones asked for beyond every facet until there are none."""
    k = at.dimension
    back = at.basis.T / at.scales
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * k)).reshape(k, -1).T
    directions = np.concatenate([np.eye(k), -np.eye(k), signs])
    points = asked = np.zeros((0, k))
    while True:
        found = (polytope.support_point(directions @ back) - at.center) @ back.T
        asked, before = np.concatenate([asked, directions]), len(points)
        points = np.concatenate([points, found])
        points = points[first_of_each(points, _SAME)]
        hull = _hull(points)
        flat = hull.equations[first_of_each(hull.equations, _SAME)]
        new = first_of_each(np.concatenate([asked, flat[:, :-1]]), _SAME)
        directions = flat[new[new >= len(asked)] - len(asked), :-1]
        if not len(directions) or len(points) == before:
            return Planes(flat[:, :-1], -flat[:, -1], points[np.sort(hull.vertices)])
