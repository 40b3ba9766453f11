"""Facets and corners of a polytope in its frame's coordinates: of size 1, and the origin inside."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, Flags, Indices
from ..errors import NotListable
from .frame import Frame
from .simplex import maximize
from .zonotope import PARALLEL, first_of_each

SAME = 1e-8
"""Corners of a set of size 1 this close together are one: Qhull merges within about 1e-12 of its own accord."""

_FULL_RANK = 1e-12
"""Smallest eigenvalue of Σ n nᵀ over unit normals that meet in a corner; rounding is 1e-15."""

_ROUNDING = 1e-15
"""Share of a coordinate by which another machine may round it otherwise."""

_ATTEMPTS = 4
"""Where many facets meet, Qhull gives up on one rounding of the points in thirty, and not on the next."""

_MOST_CANDIDATES = 20_000
"""Rows to be sorted into facets and others, before a listing is called too long."""


class Planes(NamedTuple):
    """Facets, and the corners where they came along.

    normals : (f, k) unit; offsets : (f,); corners : (v, k) or None
    """

    normals: Array
    offsets: Array
    corners: Array | None = None


def candidates(at: Frame, normals: Array, offsets: Array, support: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Rows over x as distinct unit rows over z, those that touch the set.

    support : d → the set's own
    """
    n = normals * at.scales @ at.basis
    d = offsets - normals @ at.center
    size = np.linalg.norm(n, axis=1)
    kept = np.isfinite(d) & (size > PARALLEL * size.max())
    n, d = n[kept] / size[kept, None], d[kept] / size[kept]
    order = np.argsort(d, kind="stable")    # of equal normals the nearest plane comes first, and stays
    unique = order[first_of_each(n[order])]
    n, d = n[unique], d[unique]
    if len(n) > 40 * at.dimension:          # asking is cheaper than Qhull once there are many
        out = n @ at.back
        touching = support(out) - out @ at.center >= d - SAME
        n, d = n[touching], d[touching]
    if len(n) > _MOST_CANDIDATES:
        raise NotListable(f"{len(n)} candidate planes, more than {_MOST_CANDIDATES}; ask contains and support instead")
    return n, d


def without_superfluous(normals: Array, offsets: Array) -> Planes:
    """Planes n·z ≤ d around an inner point and points n/d are dual: a facet is a corner of the points' hull."""
    try:
        dual = hull(normals / offsets[:, None])
    except NotListable:                     # corners where many planes meet: each plane is then asked for itself
        kept = needed(normals, offsets)
        return Planes(normals[kept], offsets[kept])
    kept = np.sort(dual.vertices)
    return Planes(normals[kept], offsets[kept], _from_dual(dual.equations))


def needed(normals: Array, offsets: Array) -> Indices:
    """Planes beyond which the set reaches as soon as they give way: max nᵢ·z > dᵢ with dᵢ + 1 for dᵢ in row i."""
    reached = maximize(normals, offsets + np.eye(len(offsets)), normals).values
    return np.flatnonzero(reached > offsets + SAME)


def meetings(normals: Array, offsets: Array) -> Array:
    """(v, k) corners of {z : n·z ≤ d}."""
    return _from_dual(hull(normals / offsets[:, None]).equations)


def meet(on: Array, normals: Array) -> Flags:
    """(p,) whether the planes on which a point lies, ``on`` (p, f), have it in common with no other point."""
    spread = np.einsum("pf,fi,fj->pij", on.astype(float), normals, normals)
    return np.asarray(np.linalg.eigvalsh(spread)[:, 0] > _FULL_RANK)


def asked_hull(support_point: Callable[[Array], Array], k: int) -> Planes:
    """Hull of support points, new ones asked for along every facet until none lies beyond."""
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * k)).reshape(k, -1).T
    points = support_point(np.concatenate([np.eye(k), -np.eye(k), signs]))
    while True:
        points = points[first_of_each(points, SAME)]
        around = hull(points)
        planes = around.equations[first_of_each(around.equations, SAME)]
        normals, offsets = planes[:, :-1], -planes[:, -1]
        found = support_point(normals)
        beyond = (found * normals).sum(axis=1) > SAME + offsets
        if not beyond.any():
            return Planes(normals, offsets, points[np.sort(around.vertices)])
        points = np.concatenate([points, found[beyond]])


def hull(points: Array) -> Any:
    """Qhull's; raises NotListable where it gives up."""
    from scipy.spatial import ConvexHull, QhullError

    for attempt in range(_ATTEMPTS):
        luck = np.random.default_rng(attempt).uniform(-1.0, 1.0, points.shape) if attempt else 0.0
        try:
            return ConvexHull(points * (1 + _ROUNDING * luck))
        except QhullError as error:
            refused = error
    raise NotListable("Qhull cannot tell the facets of this set apart (too many meet in one corner); ask contains, "
                      "support or axis_section, or list a part of it by project or slice") from refused


def _from_dual(equations: Array) -> Array:
    points = -equations[:, :-1] / equations[:, -1:]
    return points[first_of_each(points, SAME)]
