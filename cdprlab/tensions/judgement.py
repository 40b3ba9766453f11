"""The result that checks itself: every method's tensions are judged by equilibrium and limits, whatever it says."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array, data_frame, frozen, lasting
from ..errors import InfeasibleTensions
from .law import flat, shortfall, weigh
from .method import PROOFS, UNREACHABLE, Texts
from .methods import METHODS


@lasting
@dataclass(frozen=True, eq=False)
class TensionDistribution:
    """Tensions and what they are worth: ``feasible`` alone says whether they may be used.

    tensions : (…, m) clipped to the limits when feasible, else the method's own last answer [N]
    feasible : (…) equilibrium holds and every limit is kept
    residual : (…, n) W τ + w_e [N, N m]
    margin : (…) distance to the nearest limit, negative outside [N]
    method : its name
    reason : '' when feasible, else why not; an array in a batch; put into words when first
        asked for
    """

    tensions: Array
    feasible: Any
    residual: Array
    margin: Any
    method: str
    _problem: tuple[Array, ...] = field(repr=False)
    _said: Texts = field(repr=False)

    @cached_property
    def complete(self) -> Any:
        """Whether "infeasible" means that no distribution exists, for such a method finds one whenever there is one.

        False where the method does not apply or gave up; an array where that differs within a batch.
        """
        if self.method not in METHODS or not METHODS[self.method].complete:
            return False
        silent = np.array(~np.asarray(self.feasible))
        silent[silent] = [not text.startswith(PROOFS) for text in self._said]
        return ~silent if silent.ndim and silent.any() else not silent.any()

    @cached_property
    def reason(self) -> Any:
        """'' when feasible, else why not; an array in a batch. An incomplete method adds what the LP says."""
        texts = np.full(np.shape(self.feasible), "", dtype=object)
        bad = ~np.asarray(self.feasible)
        said = self._said.copy()
        answers = [*zip(self.tensions[bad], self.residual[bad], np.asarray(self.margin)[bad], *self._problem[2:])]
        for k in np.flatnonzero(said == ""):
            said[k] = shortfall(*answers[k])
        asked = np.flatnonzero((said != UNREACHABLE) & ~np.broadcast_to(self.complete, bad.shape)[bad])
        if asked.size:
            program = METHODS["linear_program"].solve(*(part[asked] for part in self._problem))[1]
            said[asked] += np.where(program == "", "; the LP says a distribution exists", "; the LP says none exists")
        texts[bad] = said
        return texts[()]

    def __repr__(self) -> str:
        said = "feasible" if np.all(self.feasible) else "not feasible"
        if np.ndim(self.feasible):
            said = f"{np.count_nonzero(self.feasible)} of {np.size(self.feasible)} feasible"
        with np.printoptions(precision=4, threshold=24, suppress=True):
            return (f"TensionDistribution({self.method}, {said}, margin {np.min(self.margin, initial=np.inf):.4g} N,\n"
                    f"tensions {self.tensions})")

    def to_frame(self) -> Any:
        """A row a wrench, as a pandas DataFrame: each cable's tension, the margin, and whether it is feasible."""
        rows = self.tensions.reshape(-1, self.tensions.shape[-1])
        return data_frame({f"cable {i + 1} [N]": tensions for i, tensions in enumerate(rows.T)}
                          | {"margin [N]": np.ravel(self.margin), "feasible": np.ravel(self.feasible)})

    def require(self) -> TensionDistribution:
        """Itself if all is feasible; raises InfeasibleTensions, carrying it, if not."""
        if np.all(self.feasible):
            return self
        bad = ~np.asarray(self.feasible)
        reason = np.asarray(self.reason)[bad][0]
        share = f"{bad.sum()} of {bad.size} wrenches: " if bad.ndim else ""
        raise InfeasibleTensions(f"{share}{reason}; method 'relaxed' gives the least wrench error inside the limits",
                                 self)


def checked_distribution(W: Array, w_e: Array, low: Array, high: Array, tensions: Array, reasons: Any,
                         method: str) -> TensionDistribution:
    """Judges tensions by the law, whatever their method says: equilibrium residual and limits.

    Arrays as in `distribute_tensions`; tensions (…, m) with the whole batch shape; reasons :
    str or (…) of str
    """
    tensions, residual, margin, feasible = weigh(W, w_e, low, high, tensions)
    batch, said = feasible.shape, np.array([], dtype=object)
    problem: tuple[Array, ...] = ()
    if not feasible.all():   # those without tensions, copied: (k, n, m), (k, n), (k, m), (k, m)
        bad = ~feasible.ravel()
        problem = (flat(batch, W, 2)[bad], *(flat(batch, part)[bad] for part in (w_e, low, high)))
        said = np.broadcast_to(np.array(reasons, dtype=object), batch)[~feasible]
    if not batch:
        feasible, margin = bool(feasible), float(margin)
    return TensionDistribution(frozen(tensions), feasible, frozen(residual), margin, method, problem, said)
