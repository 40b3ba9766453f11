"""The result that checks itself: every method's tensions are judged by equilibrium and limits, whatever it says."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import isnan, nan
from operator import sub
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, frozen
from ..errors import InfeasibleTensions
from .method import LIMIT_TOLERANCE, OUT_OF_RANGE, RESIDUAL_TOLERANCE, Texts, broken_limit


class Problem(NamedTuple):
    """What was asked: W (…, n, m), w_e (…, n), limits (…, m), their batch axes as given."""

    W: Array
    w_e: Array
    low: Array
    high: Array


@dataclass(frozen=True, eq=False)
class TensionDistribution:
    """Tensions and what they are worth: ``feasible`` alone says whether they may be used.

    tensions : (…, m) clipped to the limits when feasible, else the method's own last answer [N]
    feasible : (…) equilibrium holds and every limit is kept
    residual : (…, n) W τ + w_e [N, N m]
    margin : (…) distance to the nearest limit, negative outside [N]
    method : its name
    complete : whether the method finds a distribution whenever one exists
    reason : '' when feasible, else why not; an array in a batch; put into words when first asked for
    """

    tensions: Array
    feasible: Any
    residual: Array
    margin: Any
    method: str
    complete: bool
    _problem: Problem | None = field(repr=False)
    _said: Any = field(repr=False)

    @cached_property
    def reason(self) -> Any:
        """'' when feasible, else why not; an array in a batch. An incomplete method adds what the LP says."""
        texts = np.full(np.shape(self.feasible), "", dtype=object)
        bad = ~np.asarray(self.feasible)
        if self._problem is not None:
            said = np.broadcast_to(np.array(self._said, dtype=object), bad.shape)[bad]
            texts[bad] = _reasons(self._problem, self.tensions[bad], self.residual[bad], said,
                                  ask_program=not self.complete)
        return texts if texts.ndim else texts[()]

    def require(self) -> TensionDistribution:
        """Itself if all is feasible; raises InfeasibleTensions, carrying it, if not."""
        if np.all(self.feasible):
            return self
        bad = np.argwhere(~np.atleast_1d(self.feasible))
        reason = np.atleast_1d(self.reason)[tuple(bad[0])]
        share = f"{len(bad)} of {np.size(self.feasible)} wrenches: " if np.ndim(self.feasible) else ""
        raise InfeasibleTensions(f"{share}{reason}; method 'relaxed' gives the least wrench error inside the limits",
                                 self)


def checked_distribution(W: Array, w_e: Array, low: Array, high: Array, tensions: Array, reasons: Any,
                         method: str, complete: bool = False) -> TensionDistribution:
    """Judges tensions by the law, whatever their method says: equilibrium residual and limits.

    Arrays as in `distribute_tensions`; tensions (…, m) with the whole batch shape; reasons : str or (…) of str
    """
    if tensions.ndim == 1:
        return _judge_one(Problem(W, w_e, low, high), tensions, reasons, method, complete)
    margin = 0.0 - _largest(np.maximum(low - tensions, tensions - high))
    inside = margin >= -LIMIT_TOLERANCE * high.max(axis=-1)
    near = inside & (margin < 0)
    if near.any():   # first clipped, then weighed: what is returned is what was judged
        tensions = np.where(near[..., None], np.minimum(np.maximum(tensions, low), high), tensions)
        margin[near] = 0.0
    residual = np.einsum("...ij,...j->...i", W, tensions)
    residual += w_e
    error, feasible = _largest(np.abs(residual)), inside
    if not (error <= RESIDUAL_TOLERANCE).all():   # else no wrench is so small that this would be too much
        feasible = inside & (error <= RESIDUAL_TOLERANCE * (1 + _largest(np.abs(w_e))))
    problem = None if feasible.all() else _selected(Problem(W, w_e, low, high), ~feasible)
    return TensionDistribution(frozen(tensions), feasible, frozen(residual), margin, method, complete, problem, reasons)


def _selected(problem: Problem, bad: Any) -> Problem:
    """The wrenches without tensions, copied: (k, n, m), (k, n), (k, m), (k, m)."""
    W, w_e, low, high = problem
    return Problem(*(np.broadcast_to(part, (*np.shape(bad), *part.shape[part.ndim - own:]))[bad]
                     for part, own in ((W, 2), (w_e, 1), (low, 1), (high, 1))))


def _largest(values: Array) -> Array:
    """max over the last axis, which is short: numpy is several times faster along a long one."""
    return np.ascontiguousarray(np.moveaxis(values, -1, 0)).max(axis=0)


def _judge_one(problem: Problem, tensions: Array, reason: str, method: str, complete: bool) -> TensionDistribution:
    """The same for one wrench, on plain numbers: numpy's fixed cost per call would be most of it."""
    W, w_e, low, high = problem
    lows, taus, highs = low.tolist(), tensions.tolist(), high.tolist()
    margin, slack = min(min(map(sub, taus, lows)), min(map(sub, highs, taus))), LIMIT_TOLERANCE * max(highs)
    if -slack <= margin < 0:
        tensions, margin = np.minimum(np.maximum(tensions, low), high), 0.0
    residual = W.dot(tensions) + w_e
    error, wrench = max(map(abs, residual.tolist())), max(map(abs, w_e.tolist()))
    feasible = margin >= 0 and error <= RESIDUAL_TOLERANCE * (1 + wrench)
    if isnan(sum(taus)):   # NaN hides from min and max
        feasible, margin = False, nan
    kept = None if feasible else Problem(*(part[None].copy() for part in problem))
    return TensionDistribution(frozen(tensions), feasible, frozen(residual), margin, method, complete, kept, reason)


def _reasons(problem: Problem, tensions: Array, residual: Array, said: Texts, *, ask_program: bool) -> Texts:
    texts = said.copy()
    for k in np.flatnonzero(said == ""):
        missed = f"the wrench is missed by {np.abs(residual[k]).max():.3g} N or N m"
        texts[k] = broken_limit(tensions[k], problem.low[k], problem.high[k]) or missed
    if ask_program:
        from . import linear_program

        asked = np.flatnonzero(texts != OUT_OF_RANGE)
        program = linear_program.batch()(*(part[asked] for part in problem))[1]
        texts[asked] += np.where(program == "", "; the LP says a distribution exists", "; the LP says none exists")
    return texts
