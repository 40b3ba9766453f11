"""What makes tensions an answer, whoever gave them: they balance the wrench, and each cable keeps its own limits."""

from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import TOLERANCE

NOT_FINITE = "the wrench is not finite"


class Weighed(NamedTuple):
    """Tensions and what the law says of them.

    tensions : (…, m) clipped to limits that are missed by rounding only [N]
    residual : (…, n) W τ + w_e [N, N m]
    margin : (…) distance to the nearest limit, negative outside; NaN tensions have none [N]
    feasible : (…)
    """

    tensions: Array
    residual: Array
    margin: Any
    feasible: Any


def weigh(W: Array, w_e: Array, low: Array, high: Array, tensions: Array) -> Weighed:
    """The law of every tension distribution: results and control loops ask it here.

    |W τ + w_e|∞ ≤ 1e-8 (1 + |w_e|∞), and each limit is kept to 1e-8 (1 + |w_e|∞ + τ_min): a cable's generous τ_max
    changes nothing for the others.

    W : (…, n, m); w_e : (…, n); low, high : (…, m); tensions : (…, m) with the whole batch shape

    >>> found = weigh(np.array([[1.0, -1.0]]), np.zeros(1), np.ones(2), np.full(2, 9.0), np.array([3.0, 3.0]))
    >>> bool(found.feasible), float(found.margin)
    (True, 2.0)
    """
    from ..compiled.weighing import weigh

    batch = tensions.shape[:-1]
    if not batch:
        return Weighed(*(part[0] for part in weigh(W[None], w_e[None], low[None], high[None], tensions[None])))
    found = weigh(flat(batch, W, 2), *(flat(batch, part) for part in (w_e, low, high, tensions)))
    return Weighed(*(part.reshape(batch + part.shape[1:]) for part in found))


def flat(batch: tuple[int, ...], part: Array, own: int = 1) -> Array:
    """(k, …) of a whole batch, one after the other, from (…, own axes) that broadcast to it.

    >>> flat((2, 2), np.zeros(3)).shape
    (4, 3)
    """
    shape = part.shape[part.ndim - own:]
    return np.broadcast_to(part, (*batch, *shape)).reshape(-1, *shape)


def tension_scale(w_e: Array, low: Array) -> Array:
    """(…, m) 1 + |w_e|∞ + τ_min: what tolerances of tensions are shares of [N].

    w_e : (…, n); low : (m,)
    """
    return np.asarray(1 + np.abs(w_e).max(axis=-1, keepdims=True) + low)


def forgiven(w_e: Array, low: Array) -> Array:
    """(…, m) by how much solvers may widen limits, for a last tension on the very border: half of what the law allows.

    w_e : (…, n); low : (m,)
    """
    return TOLERANCE / 2 * tension_scale(w_e, low)


def shortfall(tensions: Array, residual: Array, margin: float, low: Array, high: Array) -> str:
    """Why one wrench's tensions are no answer: the cable that leaves its limits by most, or what is missed."""
    if not np.isfinite(tensions).all():
        return NOT_FINITE
    if margin < 0:
        worst = np.minimum(tensions - low, high - tensions).argmin()
        return (f"cable {worst + 1} would need {tensions[worst]:.4g} N, allowed {low[worst]:g} to "
                f"{high[worst]:g} N")
    return f"the wrench is missed by {np.abs(residual).max():.3g} N or N m"
