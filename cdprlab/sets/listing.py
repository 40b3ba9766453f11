"""Vertices, facets and volume of a `Polytope`, listed where that is sensible."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array, frozen
from ..errors import NotListable
from .zonotope import MOST_COMBINATIONS, PARALLEL, first_of_each, n_choices, shifting_normals

if TYPE_CHECKING:
    from .polytope import Polytope

_FLAT = 1e-9
"""A set is flat across a direction in which it is narrower than this share of its size."""

_SOLID = 1e-3
"""Points spread in all directions by more than this leave no doubt that the set is not flat."""

_SAME = 1e-8
"""Corners of a set of size 1 this close together are one: Qhull merges within about 1e-12 of its own accord."""

_MOST_CANDIDATES = 20_000
"""Rows to be sorted into facets and others, before a listing is called too long."""


class Frame(NamedTuple):
    """Where a set lies: center + scales·(U z) with z in ``dimension`` coordinates, all of size 1.

    center : (n,) inside; scales : (n,) half the range of each component; basis : U, (n, dimension) orthonormal
    missing : (n, n − dimension) orthonormal directions, of x, across which the set is flat
    """

    center: Array
    scales: Array
    basis: Array
    missing: Array

    @property
    def dimension(self) -> int:
        """Of the set; −1 when it is empty."""
        return -1 if np.isnan(self.center).any() else self.basis.shape[1]

    @property
    def span(self) -> Array:
        """(n, dimension) orthonormal directions of x in which the set extends."""
        if self.dimension < 1:
            return np.zeros((len(self.center), 0))
        return np.asarray(np.linalg.qr(self.scales[:, None] * self.basis)[0])

    def outside(self, z: Array) -> Array:
        """(…, n) points of the set from their coordinates in the frame."""
        return self.center + self.scales * (z @ self.basis.T)

    def rows(self, normals: Array, offsets: Array) -> tuple[Array, Array]:
        """Unit rows over x from rows over z."""
        n = normals @ self.basis.T / self.scales
        d = offsets + n @ self.center
        size = np.linalg.norm(n, axis=1)
        return n / size[:, None], d / size


class Planes(NamedTuple):
    """Facets in the frame's coordinates, and the corners and volume where they came along.

    normals : (f, k) unit; offsets : (f,); corners : (v, k) or None
    """

    normals: Array
    offsets: Array
    corners: Array | None = None


def frame(polytope: Polytope) -> Frame:
    """The affine hull of the set, found by asking how wide it is: n directions, each extends it or is missing.

    Raises NotListable where the set is unbounded.
    """
    if (known := _symmetric(polytope)) is not None:
        return known
    n, eye = polytope.n, np.eye(polytope.n)
    ends = polytope.support_point(np.concatenate([-eye, eye])).reshape(2, n, n)
    reach = polytope.component_range() if np.isnan(ends).any() else np.diagonal(ends, axis1=1, axis2=2).T
    if np.isinf(reach).any():
        raise NotListable("the set is unbounded (a cable without a speed limit, or too few cables), so it has no list "
                          "of vertices and facets; contains, support and the ranges still answer")
    if np.isnan(reach).any():
        return Frame(np.full(n, np.nan), np.ones(n), np.zeros((n, 0)), np.eye(n))
    half = (reach[:, 1] - reach[:, 0]) / 2
    scales = np.where(half > _FLAT * np.abs(reach).max(axis=1), half, 1.0)
    points = ends.reshape(-1, n)
    if np.linalg.svd((points - points.mean(axis=0)) / scales, compute_uv=False)[-1] > _SOLID:
        return Frame(frozen(points.mean(axis=0)), frozen(scales), frozen(eye), frozen(np.zeros((n, 0))))
    return _probed(polytope, scales, float(np.abs(reach / scales[:, None]).max()))


def _symmetric(polytope: Polytope) -> Frame | None:
    """Without a program: rows N x ≤ d and −N x ≤ d with d > 0 and N of full rank enclose a solid around the origin."""
    if polytope.outer is None:
        return None
    normals, offsets = polytope.outer()
    normals, offsets = normals[np.isfinite(offsets)], offsets[np.isfinite(offsets)]
    half, n = len(offsets) // 2, polytope.n
    if not half or (offsets <= 0).any() or not (np.array_equal(normals[:half], -normals[half:])
                                                and np.array_equal(offsets[:half], offsets[half:])):
        return None
    near = np.abs(normals[:half] / offsets[:half, None]).max(axis=0)    # 1 / distance to the border along each axis
    spread = np.linalg.svd(normals[:half] / offsets[:half, None] / np.where(near > 0, near, 1.0), compute_uv=False)
    if len(spread) < n or spread[-1] < _SOLID:
        return None
    return Frame(frozen(np.zeros(n)), frozen(1 / near), frozen(np.eye(n)), frozen(np.zeros((n, 0))))


def _probed(polytope: Polytope, scales: Array, size: float) -> Frame:
    """Direction by direction: across each the set extends, or it is flat."""
    n = polytope.n
    basis, missing, seen = np.zeros((n, 0)), np.zeros((n, 0)), []
    for _ in range(n):
        way = _unused(np.concatenate([basis, missing], axis=1))
        ends = polytope.support_point(np.stack([way, -way]) / scales) / scales
        step = (ends[0] - ends[1]) - basis @ (basis.T @ (ends[0] - ends[1]))
        seen.append(ends * scales)
        if abs(way @ (ends[0] - ends[1])) > _FLAT * max(1.0, size):
            basis = np.concatenate([basis, (step / np.linalg.norm(step))[:, None]], axis=1)
        else:
            missing = np.concatenate([missing, way[:, None]], axis=1)
    across = np.linalg.qr(missing / scales[:, None])[0] if missing.shape[1] else missing
    return Frame(frozen(np.concatenate(seen).mean(axis=0)), frozen(scales), frozen(basis), frozen(across))


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
    if polytope.outer is not None and k == polytope.n:
        return _without_superfluous(*_in_frame(polytope, at, *polytope.outer()))
    if k <= 3:
        return _asked_hull(polytope, at)
    raise NotListable(f"the facets of this {k}-dimensional image cannot be listed at sensible cost; ask contains, "
                      "support or axis_section, or list a part of it: project([0, 1, 2]) or slice([0, 1, 2])")


def corners(polytope: Polytope) -> Array:
    """(v, k) vertices in the frame's coordinates; in the plane counter-clockwise."""
    found = polytope._planes
    points = found.corners if found.corners is not None else _meetings(*found[:2])
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
    from scipy.spatial import ConvexHull

    at = polytope._frame
    if at.dimension < polytope.n:
        return 0.0
    inside = np.ptp(polytope._corners) if polytope.n == 1 else ConvexHull(polytope._corners).volume
    return float(inside * at.scales.prod())


def _unused(directions: Array) -> Array:
    """A unit vector orthogonal to all columns, as close to an axis as there is."""
    left = np.eye(len(directions)) - directions @ directions.T
    way = left[np.linalg.norm(left, axis=1).argmax()]
    return np.asarray(way / np.linalg.norm(way))


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
    normals = shifting_normals(inside)
    reach = np.abs(normals @ inside).sum(axis=1)
    middle = normals @ (at.basis.T @ ((center - at.center) / at.scales))
    return Planes(np.concatenate([normals, -normals]), np.concatenate([reach + middle, reach - middle]))


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
    from scipy.spatial import ConvexHull

    hull = ConvexHull(normals / offsets[:, None])
    kept = np.sort(hull.vertices)
    return Planes(normals[kept], offsets[kept], _from_dual(hull.equations))


def _meetings(normals: Array, offsets: Array) -> Array:
    from scipy.spatial import ConvexHull

    return _from_dual(ConvexHull(normals / offsets[:, None]).equations)


def _from_dual(equations: Array) -> Array:
    points = -equations[:, :-1] / equations[:, -1:]
    return points[first_of_each(points, _SAME)]


def _asked_hull(polytope: Polytope, at: Frame) -> Planes:
    """Hull of support points, new ones asked for beyond every facet until there are none."""
    from scipy.spatial import ConvexHull

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
        hull = ConvexHull(points)
        flat = hull.equations[first_of_each(hull.equations, _SAME)]
        new = first_of_each(np.concatenate([asked, flat[:, :-1]]), _SAME)
        directions = flat[new[new >= len(asked)] - len(asked), :-1]
        if not len(directions) or len(points) == before:
            return Planes(flat[:, :-1], -flat[:, -1], points[np.sort(hull.vertices)])
