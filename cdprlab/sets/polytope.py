"""`Polytope`: the image {shift + M q : A q ≤ b} of what limits allow, asked by linear programs, listed on demand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, as_array, frozen
from ..errors import InvalidInput
from .elimination import can_eliminate, eliminate
from .frame import Frame, frame
from .line import line_ends
from .listing import Planes, corners, facets, planes, volume
from .simplex import TOLERANCE, Program, maximize
from .subspace import null_space, solve


@dataclass(frozen=True, eq=False, repr=False)
class Polytope:
    """The convex set {shift + M q : A q ≤ b}; make one by `from_image`, `from_rows` or `from_box`.

    map : M, (n, k); rows : A, (r, k); limits : b, (r,), inf where a row is no limit; shift : (n,)
    box : (lower, upper) of q where the rows are just that, which makes the set a zonotope
    outer : makes rows (N, d) with the set = {x : N x ≤ d}, superfluous ones allowed, where they are known

    >>> square = Polytope.from_rows([[1, 0], [0, 1], [-1, 0], [0, -1]], [1, 1, 1, 1])
    >>> square.contains([[0.5, 1.0], [0.5, 1.1]]), square.volume
    (array([ True, False]), 4.0)
    """

    map: Array
    rows: Array
    limits: Array
    shift: Array
    box: tuple[Array, Array] | None = None
    outer: Callable[[], tuple[Array, Array]] | None = None

    @classmethod
    def from_image(cls, M: ArrayLike, A: ArrayLike, b: ArrayLike) -> Polytope:
        """{M q : A q ≤ b}: what a machine can do whose actuators q, shared or not, obey A q ≤ b.

        M : (n, k); A : (r, k); b : (r,), inf where a row is no limit
        """
        m = as_array(M, "M", ("n", "k"))
        a = as_array(A, "A", ("r", m.shape[1]))
        limits = _limits(b, "b", a.shape[0])
        known = m.shape[0] > 3 and can_eliminate(m, a)      # up to 3-D support points are quicker
        return cls(m, a, limits, frozen(np.zeros(m.shape[0])),
                   outer=(lambda: eliminate(m, a, limits)) if known else None)

    @classmethod
    def from_rows(cls, normals: ArrayLike, offsets: ArrayLike) -> Polytope:
        """{x : N x ≤ d}; superfluous rows are allowed.

        normals : N, (r, n); offsets : d, (r,), inf where a row is no limit
        """
        rows = as_array(normals, "normals", ("r", "n"))
        limits = _limits(offsets, "offsets", rows.shape[0])
        n = rows.shape[1]
        return cls(frozen(np.eye(n)), rows, limits, frozen(np.zeros(n)), outer=lambda: (rows, limits))

    @classmethod
    def from_box(cls, M: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> Polytope:
        """The zonotope {M q : lower ≤ q ≤ upper}.

        M : (n, k); lower, upper : (k,), finite
        """
        m = as_array(M, "M", ("n", "k"))
        low, high = (as_array(v, name, (m.shape[1],)) for v, name in ((lower, "lower"), (upper, "upper")))
        if (low > high).any():
            raise InvalidInput(f"lower must not exceed upper, got {low.tolist()} and {high.tolist()}")
        eye = np.eye(m.shape[1])
        return cls(m, frozen(np.concatenate([eye, -eye])), frozen(np.concatenate([high, -low])),
                   frozen(np.zeros(m.shape[0])), box=(low, high))

    # --- questions that always have an answer -----------------------------------------------------
    @property
    def n(self) -> int:
        """Components of a point."""
        return self.map.shape[0]

    @property
    def is_empty(self) -> bool:
        """Whether nothing satisfies the limits."""
        return not self._program.is_feasible

    def support(self, direction: ArrayLike) -> Array:
        """h(d) = max d·x over the set; −inf when it is empty, inf where it is unbounded.

        direction : (…, n)
        Returns (…).
        """
        d = self._points(direction, "direction")
        if self.box is not None:
            center, half = self.center_and_generators
            return np.asarray(d @ center + np.abs(d @ half).sum(axis=-1))
        return np.asarray(self._program.maximize(d @ self.map).values + d @ self.shift)

    def support_point(self, direction: ArrayLike) -> Array:
        """(…, n) a point of the set where d·x is largest; nan where there is none."""
        d = self._points(direction, "direction")
        if self.box is not None:
            center, half = self.center_and_generators
            return np.asarray(center + np.where(d @ half < 0, -1.0, 1.0) @ half.T)
        return np.asarray(self._program.maximize(d @ self.map).points @ self.map.T + self.shift)

    def contains(self, x: ArrayLike) -> NDArray[np.bool_]:
        """Whether some q gives x, to 1e-9 of the largest limit.

        x : (…, n)
        Returns (…) of bool.
        """
        q, reached = solve(self.map, self._points(x, "x") - self.shift)
        left = self.limits - q @ self.rows.T
        if self._null.shape[1]:
            values = maximize(self.rows @ self._null, left, np.zeros(self._null.shape[1])).values
            inside = np.asarray(values > -np.inf)
        else:
            inside = np.asarray((left >= -TOLERANCE * self._row_scale).all(axis=-1))
        return np.asarray(inside & reached)[()]

    def component_range(self) -> Array:
        """(n, 2) smallest and largest x_i over the set, whatever the other components are; nan when it is empty."""
        eye = np.eye(self.n)
        reach = self.support(np.concatenate([eye, -eye]))
        if np.isneginf(reach).any():
            return np.full((self.n, 2), np.nan)
        return np.stack([-reach[self.n:], reach[:self.n]], axis=1)

    def axis_section(self, origin: ArrayLike = 0.0) -> Array:
        """(n, 2) how far one can go along −e_i and +e_i alone from an origin inside; nan where it is outside.

        origin : (n,), or 0
        """
        start = self._origin(origin)
        if not self.contains(start):
            return np.full((self.n, 2), np.nan)
        ends = np.array([line_ends(self, start, axis) for axis in np.eye(self.n)])
        ends = np.where(np.isnan(ends), 0.0, ends)     # inside by less than rounding
        return np.stack([np.minimum(ends[:, 0], 0.0), np.maximum(ends[:, 1], 0.0)], axis=1)

    def scale(self, x: ArrayLike, origin: ArrayLike = 0.0) -> Array:
        """The largest s with origin + s (x − origin) inside; nan where that line misses the set.

        x : (…, n); origin : (n,), or 0
        Returns (…); inf where the set has no end that way, or x is the origin and inside.
        """
        points, start = self._points(x, "x"), self._origin(origin)
        flat = (points - start).reshape(-1, self.n)
        return np.array([line_ends(self, start, way)[1] for way in flat]).reshape(points.shape[:-1])[()]

    # --- parts of it ------------------------------------------------------------------------------
    def project(self, components: Sequence[int]) -> Polytope:
        """The shadow: the chosen components of every point."""
        chosen = self._chosen(components)
        return Polytope(frozen(self.map[chosen]), self.rows, self.limits, frozen(self.shift[chosen]), box=self.box)

    def slice(self, components: Sequence[int], origin: ArrayLike = 0.0) -> Polytope:
        """The cut: the chosen components of the points whose others are those of ``origin``.

        origin : (n,), or 0
        """
        chosen = self._chosen(components)
        others = np.setdiff1d(np.arange(self.n), chosen)
        fixed = self.map[others]
        q, reached = solve(fixed, (self._origin(origin) - self.shift)[others])
        null = null_space(fixed)
        limits = self.limits - self.rows @ q if reached else np.full(self.limits.shape, -1.0)
        rows = self.rows @ null if reached else np.zeros((len(limits), null.shape[1]))
        return Polytope(frozen(self.map[chosen] @ null), frozen(rows), frozen(limits),
                        frozen(self.shift[chosen] + self.map[chosen] @ q))

    # --- lists, made when first asked for ---------------------------------------------------------
    @property
    def dimension(self) -> int:
        """Of the set itself: below n where it is flat, −1 when it is empty."""
        return self._frame.dimension

    @property
    def span(self) -> Array:
        """(n, dimension) orthonormal directions in which the set extends."""
        return self._frame.span

    @cached_property
    def vertices(self) -> Array:
        """(v, n) corners; in the plane counter-clockwise. Raises NotListable where there are too many."""
        at = self._frame
        return frozen(at.outside(self._corners) if at.dimension >= 0 else np.zeros((0, self.n)))

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
        return volume(self)

    def __repr__(self) -> str:
        kind = "zonotope" if self.box is not None else "polytope"
        if self.is_empty:
            return f"Polytope(empty, {self.n}-D)"
        flat = f", flat: dimension {self.dimension}" if self.dimension < self.n else ""
        return f"Polytope({self.n}-D {kind}{flat})"

    # --- inside -----------------------------------------------------------------------------------
    @cached_property
    def _outer_rows(self) -> tuple[Array, Array] | None:
        return None if self.outer is None else self.outer()

    @cached_property
    def _frame(self) -> Frame:
        return frame(self)

    @cached_property
    def _planes(self) -> Planes:
        return planes(self)

    @cached_property
    def _corners(self) -> Array:
        return corners(self)

    @cached_property
    def _facets(self) -> tuple[Array, Array]:
        normals, offsets = facets(self)
        return frozen(normals), frozen(offsets)

    @cached_property
    def center_and_generators(self) -> tuple[Array, Array]:
        """(n,) and (n, k) of a zonotope {center + G z : |z| ≤ 1}; raises InvalidInput for other sets."""
        if self.box is None:
            raise InvalidInput("only the image of a box has generators; this set has other limits too")
        low, high = self.box
        return frozen(self.shift + self.map @ ((high + low) / 2)), frozen(self.map * ((high - low) / 2))

    @cached_property
    def _program(self) -> Program:
        return Program(self.rows, self.limits)

    @cached_property
    def _null(self) -> Array:
        return frozen(null_space(self.map))

    @cached_property
    def _row_scale(self) -> Array:
        """(r,) what 1e-9 is a share of: the largest limit, in each row's own size."""
        sizes = np.linalg.norm(self.rows, axis=1)
        finite = np.isfinite(self.limits) & (sizes > 0)
        largest = np.abs(self.limits[finite] / sizes[finite]).max(initial=0.0)
        return frozen(np.where(sizes > 0, sizes, 1.0) * (largest or 1.0))

    def _points(self, x: ArrayLike, name: str) -> Array:
        return as_array(x, name, (self.n,), batch=True)

    def _origin(self, origin: ArrayLike) -> Array:
        if np.ndim(origin) == 0 and origin == 0:
            return np.zeros(self.n)
        return as_array(origin, "origin", (self.n,))

    def _chosen(self, components: Sequence[int]) -> Array:
        chosen = np.asarray(components)
        if chosen.ndim != 1 or not chosen.size or len(set(chosen.tolist())) != chosen.size \
                or chosen.dtype.kind not in "iu" or chosen.min() < 0 or chosen.max() >= self.n:
            raise InvalidInput(f"components must be different numbers from 0 to {self.n - 1}, got {components!r}")
        return chosen


def _limits(value: ArrayLike, name: str, count: int) -> Array:
    given = np.asarray(value, dtype=float)
    as_array(np.where(np.isposinf(given), 0.0, given), name, (count,))
    return frozen(given.copy())
