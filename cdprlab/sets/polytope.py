"""`Polytope`: the image {shift + M q : A q ≤ b} of what limits allow, asked by linear programs, listed on demand.

A set given by its own rows is the image under M = 1. A zonotope, the image of a box, finds its
facets by hyperplane shifting and answers its support by a formula.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import product
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Flags, as_array, frozen, frozen_dataclass
from ..errors import InvalidInput, NotListable, quoted
from .elimination import eliminate
from .frame import Frame, affine_hull
from .listing import SAME, Planes, asked_hull, candidates, hull, meet, meetings, without_superfluous
from .simplex import SPREAD, TOLERANCE, Optima, Program, maximize
from .subspace import RANK, null_space, solve
from .zonotope import ALONG, MOST_COMBINATIONS, hyperplane_shifting, products

_FLAT = 1e-9
"""A set is flat across a direction in which it is narrower than this share of its size."""

_MOST_SIGNS = 12
"""Generators up to which a zonotope's corners are sought among all 2ᵏ sign combinations."""


@frozen_dataclass
class Polytope:
    """The convex set {shift + M q : A q ≤ b}; make one by `from_image`, `from_rows` or `from_box`.

    map : M, (n, k); rows : A, (r, k); limits : b, (r,), inf where a row is no limit; shift :
        (n,)
    outer : makes rows (N, d) with the set = {x : N x ≤ d}, some superfluous, where it knows
        better than `eliminate`

    >>> square = Polytope.from_rows([[1, 0], [0, 1], [-1, 0], [0, -1]], [1, 1, 1, 1])
    >>> square.contains([[0.5, 1.0], [0.5, 1.1]]), square.volume
    (array([ True, False]), 4.0)
    """

    map: Array
    rows: Array
    limits: Array
    shift: Array
    outer: Callable[[], tuple[Array, Array]] | None = None

    def __post_init__(self) -> None:
        for array in (self.map, self.rows, self.limits, self.shift):
            frozen(array)

    @staticmethod
    def from_image(M: ArrayLike, A: ArrayLike, b: ArrayLike) -> Polytope:
        """{M q : A q ≤ b}: what a machine can do whose actuators q, shared or not, obey A q ≤ b.

        M : (n, k); A : (r, k); b : (r,), inf where a row is no limit
        """
        m = as_array(M, "M", ("n", "k"))
        a = as_array(A, "A", ("r", m.shape[1]))
        return Polytope(m, a, as_array(b, "b", a.shape[:1], limit=np.inf), np.zeros(m.shape[0]))

    @staticmethod
    def from_rows(normals: ArrayLike, offsets: ArrayLike) -> Polytope:
        """{x : N x ≤ d}; superfluous rows are allowed.

        normals : N, (r, n); offsets : d, (r,), inf where a row is no limit
        """
        rows = as_array(normals, "normals", ("r", "n"))
        n = rows.shape[1]
        return Polytope(np.eye(n), rows, as_array(offsets, "offsets", rows.shape[:1], limit=np.inf),
                        np.zeros(n))

    @staticmethod
    def from_box(M: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> Zonotope:
        """The zonotope {M q : lower ≤ q ≤ upper}.

        M : (n, k); lower, upper : (k,), finite
        """
        m = as_array(M, "M", ("n", "k"))
        low = as_array(lower, "lower", m.shape[1:])
        high = as_array(upper, "upper", low.shape)
        if (low > high).any():
            raise InvalidInput(f"lower must not exceed upper, got {quoted(low)} and {quoted(high)}")
        eye = np.eye(m.shape[1])
        return Zonotope(m, np.concatenate([eye, -eye]), np.concatenate([high, -low]),
                        np.zeros(m.shape[0]))

    # --- questions that always have an answer -----------------------------------------------------
    @property
    def n(self) -> int:
        """Components of a point."""
        return self.map.shape[0]

    @property
    def is_empty(self) -> bool:
        """Whether nothing satisfies the limits."""
        return bool(np.isneginf(self.support(np.zeros(self.n))))

    def support(self, direction: ArrayLike) -> Array:
        """h(d) = max d·x over the set; −inf when it is empty, inf where it is unbounded.

        direction : (…, n)
        Returns (…).
        """
        d = self._points(direction, "direction")
        return np.asarray(self._farthest(d).values + d @ self.shift)

    def support_point(self, direction: ArrayLike) -> Array:
        """(…, n) a point of the set where d·x is largest; nan where there is none."""
        d = self._points(direction, "direction")
        return np.asarray(self._farthest(d).points @ self.map.T + self.shift)

    def contains(self, x: ArrayLike) -> Flags:
        """Whether some q gives x, to 1e-9 of the point and of the limits, generous ones left aside.

        x : (…, n)
        Returns (…) of bool.
        """
        q, reached = solve(self.map, self._points(x, "x") - self.shift)
        left = self.limits - q @ self.rows.T
        if self._null.shape[1]:
            inside = maximize(self.rows @ self._null, left, np.zeros(self._null.shape[1])).values > -np.inf
        else:
            size = np.abs(q).max(axis=-1, initial=0.0)[..., None] * np.linalg.norm(self.rows, axis=1)
            inside = (left >= -TOLERANCE * (np.abs(self.limits) + size)).all(axis=-1)
        return np.asarray(inside & reached)[()]

    def component_range(self) -> Array:
        """(n, 2) smallest and largest x_i over the set, whatever the other components are; nan when it is empty."""
        eye = np.eye(self.n)
        reach = self.support(np.stack([-eye, eye], axis=1))
        return np.where(np.isneginf(reach), np.nan, reach) * [-1, 1]

    def axis_section(self, origin: ArrayLike = 0.0) -> Array:
        """(n, 2) how far one can go along −e_i and +e_i alone from an origin inside; nan where it is outside.

        origin : (n,), or 0
        """
        start = self._origin(origin)
        if not self.contains(start):
            return np.full((self.n, 2), np.nan)
        ends = np.array([self._line_ends(start, axis) for axis in np.eye(self.n)])
        ends = np.where(np.isnan(ends), 0.0, ends)     # inside by less than rounding
        return np.clip(ends, [-np.inf, 0.0], [0.0, np.inf])

    def scale(self, x: ArrayLike, origin: ArrayLike = 0.0) -> Array:
        """The largest s with origin + s (x − origin) inside; nan where that line misses the set.

        x : (…, n); origin : (n,), or 0
        Returns (…); inf where the set has no end that way, or x is the origin and inside.
        """
        points, start = self._points(x, "x"), self._origin(origin)
        flat = (points - start).reshape(-1, self.n)
        return np.array([self._line_ends(start, way)[1] for way in flat]).reshape(points.shape[:-1])[()]

    def _line_ends(self, start: Array, way: Array) -> tuple[float, float]:
        """Smallest and largest s with start + s way inside, nan where no s is.

        A program over s and what the map forgets: M q = start + s way is solved by q = q₀ + s
        q₁ + K y.
        """
        q, reached = solve(self.map, np.stack([start - self.shift, way]))
        if not reached[1]:      # the set does not extend that way at all
            return (0.0, 0.0) if self.contains(start) else (np.nan, np.nan)
        rows = self.rows @ np.concatenate([self._null, q[1][:, None]], axis=1)
        ahead = np.eye(rows.shape[1])[-1]
        low, high = maximize(rows, self.limits - self.rows @ q[0], np.stack([-ahead, ahead])).values
        if not reached[0] or np.isneginf(low):
            return np.nan, np.nan
        return -float(low), float(high)

    # --- parts of it ------------------------------------------------------------------------------
    def project(self, components: Sequence[int]) -> Polytope:
        """The shadow: the chosen components of every point."""
        chosen = self._chosen(components)
        return type(self)(self.map[chosen], self.rows, self.limits, self.shift[chosen])

    def slice(self, components: Sequence[int], origin: ArrayLike = 0.0) -> Polytope:
        """The cut: the chosen components of the points whose others are those of ``origin``.

        origin : (n,), or 0
        """
        chosen = self._chosen(components)
        others = np.setdiff1d(np.arange(self.n), chosen)
        q, reached = solve(self.map[others], (self._origin(origin) - self.shift)[others])
        null = null_space(self.map[others])
        limits = np.where(reached, self.limits - self.rows @ q, -1.0)   # nothing keeps 0 ≤ −1
        return Polytope(self.map[chosen] @ null, reached * self.rows @ null, limits,
                        self.shift[chosen] + self.map[chosen] @ q)

    # --- lists, made when first asked for ---------------------------------------------------------
    @property
    def dimension(self) -> int:
        """Of the set itself: below n where it is flat, −1 when it is empty."""
        return -1 if self.is_empty else self._frame.dimension

    @cached_property
    def vertices(self) -> Array:
        """(v, n) corners; in the plane counter-clockwise. Raises NotListable where there are too many."""
        at, found = self._frame, self._planes
        points = self._meetings(found) if found.corners is None else found.corners
        if at.dimension == 2:
            x, y = (points - points.mean(axis=0)).T
            points = points[np.argsort(np.arctan2(y, x))]
        return frozen(at.outside(points))

    @property
    def normals(self) -> Array:
        """(f, n) unit outward normals, one row a facet; a flat set adds two opposite rows a missing direction."""
        return self._facets[0]

    @property
    def offsets(self) -> Array:
        """(f,) with normals @ x ≤ offsets exactly where x is in the set."""
        return self._facets[1]

    @property
    def volume(self) -> float:
        """n-dimensional volume (area in the plane), in the product of the components' units; 0 when flat or empty."""
        if self.dimension < self.n:
            return 0.0
        at = self._frame
        corners = at.inside(self.vertices)      # of size 1, which suits Qhull
        size = np.ptp(corners) if self.n == 1 else hull(corners).volume
        return float(size * at.scales.prod())

    def __repr__(self) -> str:
        if self.is_empty:
            return f"Polytope(empty, {self.n}-D)"
        try:
            more = f", flat: dimension {self.dimension}" if self.dimension < self.n else ""
        except NotListable:
            more = ", unbounded or nearly so"
        return f"Polytope({self.n}-D {type(self).__name__.lower()}{more})"

    # --- inside -----------------------------------------------------------------------------------
    def _farthest(self, d: Array) -> Optima:
        """max d·M q over the limits, and the q that have it."""
        return self._program.maximize(d @ self.map)

    @cached_property
    def _frame(self) -> Frame:
        """Around the middle of the points that are farthest along rows and axes and against them."""
        ways = np.concatenate([self.rows, -self.rows, self.map, -self.map])
        values, points = self._program.maximize(ways)
        if np.isneginf(values).any():
            return affine_hull(np.zeros(self.n), np.ones(self.n), np.zeros((self.n, 0)))
        along, reach = (part.reshape(2, -1) for part in np.split(values, [2 * len(self.rows)]))
        lengths = np.linalg.norm(self.rows, axis=1)
        widths = along.sum(axis=0) / np.where(lengths > 0, lengths, 1.0)
        chosen = widths[widths > TOLERANCE * np.abs(self.limits)]   # without those that have no choice
        if self._program.spread > SPREAD and np.isfinite(chosen).all() and \
                chosen.max(initial=0.0) > 1e-2 / SAME * chosen.min(initial=np.inf):   # of what listing forgives
            raise NotListable("some limits are so much larger than others that facets cannot be told apart; ask "
                              "contains, support or axis_section, or give limits that a machine has")
        if np.isinf(reach).any():
            raise NotListable("the set is unbounded (a cable without a speed limit, or too few cables), so it has no "
                              "list of vertices and facets; contains, support and the ranges still answer")
        half = reach.sum(axis=0) / 2
        sizes = np.abs(reach).max(axis=0) + np.abs(self.shift)
        scales = np.where(half > _FLAT * sizes, half, 1.0)
        widest = widths.max(where=np.isfinite(widths), initial=0.0)
        free = null_space(self.rows[widths <= _FLAT * widest])
        return affine_hull(self.shift + self.map @ np.nanmean(points, axis=0), scales, self.map @ free)

    @cached_property
    def _planes(self) -> Planes:
        at = self._frame
        if at.dimension > 1:
            return self._list(at)
        if at.dimension == 1:
            first, last = at.inside(self.support_point(np.concatenate([at.back, -at.back])))[:, 0]
            return Planes(np.array([[1.0], [-1.0]]), np.array([first, -last]),
                          np.array([[last], [first]]))
        return Planes(np.zeros((0, 0)), np.zeros(0), np.zeros((0 if self.is_empty else 1, 0)))

    def _list(self, at: Frame) -> Planes:
        """Facets in coordinates of the frame, which are two at least."""
        forgotten = self._null.shape[1]
        if self.outer is not None:
            normals, offsets = self.outer()
        # Up to 3-D support points are quicker than eliminating what the map forgets.
        elif (self.n > 3 or not forgotten) and comb(len(self.rows), forgotten + 1) <= MOST_COMBINATIONS:
            normals, offsets = eliminate(self.map, self.rows, self.limits)
            offsets = offsets + normals @ self.shift
        elif at.dimension > 3:
            raise NotListable(f"the facets of this {at.dimension}-dimensional image cannot be listed at sensible cost; "
                              "ask contains, support or axis_section, or list a part of it: project([0, 1, 2]) or "
                              "slice([0, 1, 2])")
        else:
            return asked_hull(lambda d: at.inside(self.support_point(d @ at.back)),
                              at.dimension)
        return without_superfluous(*candidates(at, normals, offsets, self.support))

    def _meetings(self, found: Planes) -> Array:
        """(v, k) where the facets meet."""
        return meetings(found.normals, found.offsets)

    @cached_property
    def _facets(self) -> tuple[Array, Array]:
        if self.is_empty:
            return np.zeros((1, self.n)), -np.ones(1)
        normals, offsets = self._frame.rows(*self._planes[:2])
        return frozen(normals), frozen(offsets)

    @cached_property
    def _program(self) -> Program:
        return Program(self.rows, self.limits)

    @cached_property
    def _null(self) -> Array:
        return null_space(self.map)

    def _points(self, x: ArrayLike, name: str) -> Array:
        return as_array(x, name, (self.n,), batch=True)

    def _origin(self, origin: ArrayLike) -> Array:
        given = as_array(origin, "origin", (), batch=True)
        return np.zeros(self.n) if given.ndim == given.any() == 0 else as_array(given, "origin", (self.n,))

    def _chosen(self, components: Sequence[int]) -> Array:
        chosen = np.asarray(components)
        if not chosen.size or np.intersect1d(chosen, range(self.n)).size < chosen.size:
            raise InvalidInput(f"components must be different numbers from 0 to {self.n - 1}, got {quoted(components)}")
        return chosen


class Zonotope(Polytope):
    """{center + G z : |z| ≤ 1}, the image of a box: facets by hyperplane shifting, the support by a formula."""

    @property
    def _box(self) -> tuple[Array, Array]:
        """Lower and upper limits (k,)."""
        high, low = self.limits.reshape(2, -1)
        return -low, high

    def _farthest(self, d: Array) -> Optima:
        along, (low, high) = products(d, self.map), self._box
        return Optima(np.maximum(along * low, along * high).sum(axis=-1), np.where(along > 0, high, low))

    @cached_property
    def _edges(self) -> Array:
        """(n, k) how far each q moves the point, those that do."""
        low, high = self._box
        sizes = np.linalg.norm(self.map, axis=0)
        return (self.map * (high - low))[:, (sizes > ALONG * sizes.max(initial=0.0)) & (high > low)]

    @cached_property
    def _frame(self) -> Frame:
        """From the corner of all lower limits: generators count by their directions alone."""
        unit = self._edges / np.linalg.norm(self._edges, axis=0)
        sizes = np.linalg.norm(unit, axis=1)
        scales = np.where(sizes > RANK * sizes.max(initial=0.0), sizes, 1.0)
        return affine_hull(self.shift + self.map @ self._box[0], scales, unit)

    def _list(self, at: Frame) -> Planes:
        return Planes(*hyperplane_shifting(at.back @ self._edges, least=0.0))

    def _meetings(self, found: Planes) -> Array:
        edges = self._frame.back @ self._edges
        if edges.shape[1] > _MOST_SIGNS:
            inner = edges.sum(axis=1) / 2
            return meetings(found.normals, found.offsets - found.normals @ inner) + inner
        way = found.normals @ (edges / np.linalg.norm(edges, axis=0))
        ends = np.array(list(product((0.0, 1.0), repeat=edges.shape[1])))
        on = ends @ (way < -SAME).T + (1 - ends) @ (way > SAME).T == 0   # farthest of all that way
        return np.asarray(ends[meet(on, found.normals)] @ edges.T)
