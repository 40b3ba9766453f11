"""Many linear programs over one set of rows at once: max c·q with A q ≤ b, by walking from vertex to vertex.

A support function asks the same polyhedron for its farthest point in many directions. The revised simplex method in
inequality form suits that: a vertex is where k independent rows hold with equality, and every step is a handful of
small matrix products over the whole batch. Each answer is solved from its own active rows, so rounding never adds up.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Flags, Indices

TOLERANCE = 1e-9
"""How far a row may be overstepped, as a share of the largest limit; rounding is about 1e-12 of it."""

_SLOPE = 1e-11
"""Multipliers and edge slopes below this are zero; rows, limits and objectives have size 1 by then."""

_TIE = 1e-12
"""Rows reached within this step length are reached together."""


class Optima(NamedTuple):
    """One entry an objective.

    values : (…) max c·q; −inf where nothing satisfies the rows, inf where nothing bounds it
    points : (…, k) where it is reached, nan where it is not
    """

    values: Array
    points: Array


def maximize(A: Array, b: Array, c: Array) -> Optima:
    """max c·q subject to A q ≤ b, for a batch of b and c.

    A : (r, k); b : (…, r), inf leaves a row out; c : (…, k)
    Source: Dantzig 1963, Linear Programming and Extensions; degenerate steps by Bland's rule (1977).

    >>> box = np.array([[1.0, 0], [0, 1], [-1, 0], [0, -1]])
    >>> maximize(box, np.ones(4), np.array([[1.0, 2.0], [-1.0, 0.0]])).values
    array([3., 1.])
    """
    return Program(A, b).maximize(c)


class Program:
    """A q ≤ b, for a batch of b, asked again and again: where the walks start is found once.

    Rows are of size 1, over the directions they say something about (the others are free).
    """

    def __init__(self, A: Array, b: Array) -> None:
        self.batch = b.shape[:-1]
        limits = b.reshape(-1, b.shape[-1])
        sizes = np.linalg.norm(A, axis=1)
        used = np.isfinite(limits).any(axis=0)
        self._kept = used & (sizes > 1e-13 * max(sizes.max(initial=0.0), 1e-300))
        self._empty = used & ~self._kept        # 0·q ≤ b: a condition on b alone
        self._sizes = sizes[self._kept]
        rows = A[self._kept] / self._sizes[:, None]
        _, s, vt = np.linalg.svd(rows, full_matrices=True)
        rank = int((s > 1e-11 * s.max(initial=0.0)).sum())
        self._span, self._free = vt[:rank].T, vt[rank:].T
        if rank == A.shape[1]:
            self._span = np.eye(rank)
        self._rows = rows @ self._span
        self._limits, self._scale = self._scaled(limits)
        self.is_feasible, self._starts = self._vertices(limits)

    def maximize(self, c: Array) -> Optima:
        """max c·q for each b and each row of c, (…, k)."""
        batch, k = np.broadcast_shapes(self.batch, c.shape[:-1]), c.shape[-1]
        goals = np.broadcast_to(c, (*batch, k)).reshape(-1, k)
        which = np.broadcast_to(np.arange(len(self._limits)).reshape(self.batch), batch).ravel()
        values, points = np.full(len(goals), -np.inf), np.full((len(goals), k), np.nan)
        some = np.flatnonzero(self.is_feasible[which])
        if some.size:
            values[some], points[some] = self._walked(which[some], goals[some])
        return Optima(values.reshape(batch), points.reshape(*batch, k))

    def _walked(self, which: Indices, goals: Array) -> tuple[Array, Array]:
        """(B,) optimal values and (B, k) points of feasible programs."""
        scale = self._scale[which]
        inner = goals @ self._span
        size = np.maximum(np.linalg.norm(goals, axis=1), 1e-300)
        bounded, y = np.ones(len(goals), dtype=bool), np.zeros((len(goals), 0))
        if self._rows.shape[1]:
            rows = np.broadcast_to(self._rows, (len(goals), *self._rows.shape))
            bounded, _, y = _walk(rows, self._limits[which], inner / size[:, None], self._starts[which])
        if self._free.size:
            bounded &= np.abs(goals @ self._free).max(axis=1) <= 1e-9 * size
        points = (y * scale[:, None]) @ self._span.T
        values = np.where(bounded, (inner * y).sum(axis=1) * scale, np.inf)
        return values, np.where(bounded[:, None], points, np.nan)

    def _vertices(self, limits: Array) -> tuple[Flags, Indices]:
        """(B,) whether there is any point, and (B, k) active rows of one vertex each."""
        b, k = self._limits, self._rows.shape[1]
        feasible = np.asarray((limits[:, self._empty] >= -TOLERANCE * self._scale[:, None]).all(axis=1))
        first = _independent_rows(self._rows) if k else np.zeros(0, dtype=int)
        active = np.tile(first, (len(b), 1))
        if k:
            excess = b[:, first] @ np.linalg.inv(self._rows[first]).T @ self._rows.T - b
            excess[:, first] = 0.0
            out = np.flatnonzero(feasible & (excess.max(axis=1) > _TIE))
            if out.size:
                feasible[out], active[out] = self._first_vertices(b[out], active[out], excess[out])
        return feasible, active

    def _scaled(self, limits: Array) -> tuple[Array, Array]:
        b = limits[:, self._kept] / self._sizes
        scale = np.abs(np.where(np.isfinite(b), b, 0.0)).max(axis=1, initial=0.0)
        scale = np.where(scale > 0, scale, 1.0)
        return b / scale[:, None], scale

    def _first_vertices(self, b: Array, active: Indices, excess: Array) -> tuple[Flags, Indices]:
        """Let the broken rows give way by s, and make s as small as it will be."""
        count, (r, k) = len(b), self._rows.shape
        broken = excess > _TIE
        rows = np.zeros((count, r + 1, k + 1))
        rows[:, :r, :k] = self._rows
        rows[:, :r, k] = np.where(broken, -1.0, 0.0)
        rows[:, r, k] = -1.0
        down = np.zeros((count, k + 1))
        down[:, k] = -1.0
        worst = np.where(broken, excess, -np.inf).argmax(axis=1)
        _, reached, q = _walk(rows, np.concatenate([b, np.zeros((count, 1))], axis=1), down,
                              np.concatenate([active, worst[:, None]], axis=1), prefer=r)
        feasible = q[:, k] <= TOLERANCE
        for i in np.flatnonzero(feasible):
            kept = reached[i][reached[i] != r]
            if kept.size > k:       # s never left: it is zero up to rounding, any k independent rows will do
                kept = kept[_independent_rows(self._rows[kept])]
            active[i] = kept
        return feasible, active


def _walk(rows: Array, b: Array, c: Array, active: Indices, prefer: int = -1) -> tuple[Flags, Indices, Array]:
    """Steps along improving edges until none is left: whether bounded, the last active rows, the last vertices."""
    count, r, k = rows.shape
    bounded, active, points = np.ones(count, dtype=bool), active.copy(), np.zeros((count, k))
    todo = np.arange(count)
    for step in range(200 * (r + k)):
        A, limits, at = rows[todo], b[todo], active[todo]
        inverse = np.linalg.inv(np.take_along_axis(A, at[:, :, None], axis=1))
        q = (inverse @ np.take_along_axis(limits, at, axis=1)[:, :, None])[:, :, 0]
        points[todo] = q
        multipliers = (c[todo, None, :] @ inverse)[:, 0]
        bland = step > 4 * (r + k)
        leaving, improving = _leaving(multipliers, at, bland)
        if not improving.any():
            return bounded, active, points
        each = np.flatnonzero(improving)
        edge = -inverse[each, :, leaving[each]]
        entering = _entering(A[each], limits[each], q[each], _unit(edge), at[each], bland, prefer)
        todo, slots = todo[each], leaving[each]
        bounded[todo] = entering >= 0
        blocked = entering >= 0
        active[todo[blocked], slots[blocked]] = entering[blocked]
        todo = todo[blocked]
        if not todo.size:
            return bounded, active, points
    raise AssertionError("a linear program did not end: Bland's rule visits no vertex twice")


def _leaving(multipliers: Array, active: Indices, bland: bool) -> tuple[Indices, Flags]:
    """Slot of the row to leave, and whether leaving one improves."""
    negative = multipliers < -_SLOPE
    improving = np.asarray(negative.any(axis=1))
    if bland:
        return np.where(negative, active, np.iinfo(np.int64).max).argmin(axis=1), improving
    return multipliers.argmin(axis=1), improving


def _entering(A: Array, b: Array, q: Array, edge: Array, active: Indices, bland: bool, prefer: int) -> Indices:
    """(B,) the row that stops each edge, −1 where none does."""
    slopes = (A @ edge[:, :, None])[:, :, 0]
    np.put_along_axis(slopes, active, 0.0, axis=1)
    slack = np.maximum(b - (A @ q[:, :, None])[:, :, 0], 0.0)
    rising = slopes > _SLOPE * 100
    steps = np.where(rising, slack / np.where(rising, slopes, 1.0), np.inf)
    shortest = steps.min(axis=1)
    tied = rising & (steps <= shortest[:, None] + _TIE)
    # Among rows reached together the steepest gives the best conditioned vertex; Bland's rule takes the first.
    chosen = tied.argmax(axis=1) if bland else np.where(tied, slopes, -1.0).argmax(axis=1)
    if prefer >= 0:
        chosen = np.where(tied[:, prefer], prefer, chosen)
    return np.where(np.isfinite(shortest), chosen, -1)


def _unit(vectors: NDArray[Any]) -> Array:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1)[:, None])


def _independent_rows(rows: Array) -> Indices:
    from scipy.linalg import qr

    return np.asarray(qr(rows.T, mode="r", pivoting=True)[1][:rows.shape[1]])
