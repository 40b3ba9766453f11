"""Many linear programs over one set of rows at once: max c·q with A q ≤ b, by walking from vertex to vertex.

A support function asks the same polyhedron for its farthest point in many directions. The
revised simplex method in inequality form suits that: a vertex is where k independent rows hold
with equality, and every step is a handful of small matrix products over the whole batch. Each
answer is solved from its own active rows, so rounding never adds up.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Flags, Indices

TOLERANCE = 1e-9
"""How far a row may be overstepped, as a share of the largest limit that is not generous; rounding is about 1e-12."""

_GENEROUS = 100.0
"""Limits larger than all others by more than this are asked only where they are reached."""

SPREAD = 1e4
"""Largest over smallest limit, up to which a tolerance that is a share of the largest harms none."""

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
    Source: Dantzig 1963, Linear Programming and Extensions; degenerate steps by Bland's rule
    (1977).

    >>> box = np.array([[1.0, 0], [0, 1], [-1, 0], [0, -1]])
    >>> maximize(box, np.ones(4), np.array([[1.0, 2.0], [-1.0, 0.0]])).values
    array([3., 1.])
    """
    return Program(A, b).maximize(c)


class Program:
    """A q ≤ b, for a batch of b, asked again and again: where the walks start is found once.

    The largest limit is what rounding is a share of, so that a generous one would be felt at all
    others: an answer that keeps it without being told has nothing to do with it.

    spread : the largest limit over the smallest that is not 0
    """

    def __init__(self, A: Array, b: Array) -> None:
        self._rows, self._limits = A, b
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.abs(b) / np.linalg.norm(A, axis=1)
        reach = np.where(np.isfinite(reach), reach, 0.0).reshape(-1, len(A)).min(axis=0, initial=np.inf)
        sizes = np.sort(reach[reach > 0])
        self.spread = sizes[-1] / sizes[0] if sizes.size else 1.0
        steps = np.flatnonzero(sizes[1:] > _GENEROUS * sizes[:-1])
        self._usual = None
        if self.spread > SPREAD and steps.size:
            self._generous = reach > sizes[steps[-1]]
            self._usual = Program(A[~self._generous], b[..., ~self._generous])

    @cached_property
    def _walks(self) -> _Walks:
        return _Walks(self._rows, self._limits)

    def maximize(self, c: Array) -> Optima:
        """max c·q for each b and each row of c, (…, k)."""
        if self._usual is None:
            return self._walks.maximize(c)
        values, points = self._usual.maximize(c)
        beyond = points @ self._rows[self._generous].T > self._limits[..., self._generous]
        reached = np.isposinf(values) | beyond.any(axis=-1)
        if reached.any():
            found = self._walks.maximize(c)
            values = np.where(reached, found.values, values)
            points = np.where(reached[..., None], found.points, points)
        return Optima(values, points)


class _Walks:
    """The same where all limits are of one size.

    Rows are of size 1, over the directions they say something about (the others are free).
    """

    def __init__(self, A: Array, b: Array) -> None:
        self.batch = b.shape[:-1]
        limits = b.reshape(-1, b.shape[-1])
        sizes = np.linalg.norm(A, axis=1)
        used = np.isfinite(limits).any(axis=0)
        kept = used & (sizes > 1e-13 * sizes.max(initial=0.0))
        rows, scaled = A[kept] / sizes[kept, None], limits[:, kept] / sizes[kept]
        _, s, vt = np.linalg.svd(rows)
        rank = int((s > 1e-11 * s.max(initial=0.0)).sum())
        self._span, self._free = vt[:rank].T, vt[rank:].T
        if rank == A.shape[1]:
            self._span = np.eye(rank)
        scale = np.abs(np.where(np.isfinite(scaled), scaled, 0.0)).max(axis=1, initial=0.0)
        self._scale = np.where(scale > 0, scale, 1.0)
        self._rows, self._limits = rows @ self._span, scaled / self._scale[:, None]
        # 0·q ≤ b is a condition on b alone.
        self._feasible = np.asarray((limits[:, used & ~kept] >= -TOLERANCE * self._scale[:, None]).all(axis=1))
        self._find_starts()

    def maximize(self, c: Array) -> Optima:
        """max c·q for each b and each row of c, (…, k)."""
        batch, k = np.broadcast_shapes(self.batch, c.shape[:-1]), c.shape[-1]
        goals = np.broadcast_to(c, (*batch, k)).reshape(-1, k)
        which = np.broadcast_to(np.arange(len(self._limits)).reshape(self.batch), batch).ravel()
        values, points = np.full(len(goals), -np.inf), np.full((len(goals), k), np.nan)
        some = self._feasible[which]
        which, goals = which[some], goals[some]
        inner, scale = goals @ self._span, self._scale[which]
        size = np.maximum(np.linalg.norm(goals, axis=1), 1e-300)
        rows = np.broadcast_to(self._rows, (len(goals), *self._rows.shape))
        bounded, _, y = _walk(rows, self._limits[which], inner / size[:, None], self._starts[which])
        bounded &= np.abs(goals @ self._free).max(axis=1, initial=0.0) <= 1e-9 * size
        values[some] = np.where(bounded, (inner * y).sum(axis=1) * scale, np.inf)
        points[some] = np.where(bounded[:, None], (y * scale[:, None]) @ self._span.T, np.nan)
        return Optima(values.reshape(batch), points.reshape(*batch, k))

    def _find_starts(self) -> None:
        """(B, k) active rows of one vertex each, and whether there is any point."""
        (r, k), first = self._rows.shape, _independent_rows(self._rows)
        self._starts = np.tile(first, (len(self._limits), 1))
        excess = self._limits[:, first] @ np.linalg.inv(self._rows[first]).T @ self._rows.T - self._limits
        excess[:, first] = 0.0
        out = np.flatnonzero(self._feasible & (excess.max(axis=1, initial=0.0) > _TIE))
        if not out.size:
            return
        # Let the broken rows give way by s, and make s as small as it will be.
        rows = np.zeros((len(out), r + 1, k + 1))
        rows[:, :r, :k] = self._rows
        rows[:, :r, k] = -1.0 * (excess[out] > _TIE)
        rows[:, r, k] = -1.0
        limits, down = np.pad(self._limits[out], ((0, 0), (0, 1))), np.tile(-np.eye(k + 1)[-1], (len(out), 1))
        _, reached, q = _walk(rows, limits, down, np.column_stack([self._starts[out], excess[out].argmax(axis=1)]))
        self._feasible[out] = q[:, k] <= TOLERANCE
        for i, active in zip(out, reached):
            kept = active[active != r]
            if kept.size > k:       # s never left: it is zero up to rounding, any k independent rows will do
                kept = kept[_independent_rows(self._rows[kept])]
            self._starts[i] = kept


def _walk(rows: Array, b: Array, c: Array, active: Indices) -> tuple[Flags, Indices, Array]:
    """Steps along improving edges until none is left: whether bounded, the last active rows, the last vertices."""
    count, r, k = rows.shape
    bounded, points = np.ones(count, dtype=bool), np.zeros((count, k))
    todo = np.arange(count)
    for step in range(200 * (r + k) + 1):
        A, limits, at = rows[todo], b[todo], active[todo]
        inverse = np.linalg.inv(np.take_along_axis(A, at[:, :, None], axis=1))
        q = (inverse @ np.take_along_axis(limits, at, axis=1)[:, :, None])[:, :, 0]
        points[todo] = q
        multipliers = (c[todo, None, :] @ inverse)[:, 0]
        negative = multipliers < -_SLOPE
        each = np.flatnonzero(negative.any(axis=1))
        if not each.size:
            return bounded, active, points
        bland = step > 4 * (r + k)
        leaving = (np.where(negative, at, r) if bland else multipliers).argmin(axis=1)[each]
        edge = inverse[each, :, leaving]
        unit = np.asarray(-edge / np.linalg.norm(edge, axis=1)[:, None])
        entering = _entering(A[each], limits[each], q[each], unit, at[each], bland)
        stopped, todo = entering >= 0, todo[each]
        bounded[todo] = stopped
        todo = todo[stopped]
        active[todo, leaving[stopped]] = entering[stopped]
    raise AssertionError("a linear program did not end: Bland's rule visits no vertex twice")


def _entering(A: Array, b: Array, q: Array, edge: Array, active: Indices, bland: bool) -> Indices:
    """(B,) the row that stops each edge, −1 where none does."""
    slopes = (A @ edge[:, :, None])[:, :, 0]
    np.put_along_axis(slopes, active, 0.0, axis=1)
    slack = np.maximum(b - (A @ q[:, :, None])[:, :, 0], 0.0)
    rising = slopes > _SLOPE * 100
    steps = np.where(rising, slack / np.where(rising, slopes, 1.0), np.inf)
    shortest = steps.min(axis=1)
    tied = rising & (steps <= shortest[:, None] + _TIE)
    # Among rows reached together the steepest gives the best conditioned vertex; Bland's rule
    # takes the first.
    chosen = tied.argmax(axis=1) if bland else np.where(tied, slopes, -1.0).argmax(axis=1)
    return np.where(np.isfinite(shortest), chosen, -1)


def _independent_rows(rows: Array) -> Indices:
    from scipy.linalg import qr

    return np.asarray(qr(rows.T, mode="r", pivoting=True)[1][:rows.shape[1]])
