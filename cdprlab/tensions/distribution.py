"""The one door to all methods, and the result that checks itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..errors import InfeasibleTensions, InvalidInput
from . import pseudo_inverse, quadratic_program, relaxed
from .method import LIMIT_TOLERANCE, RESIDUAL_TOLERANCE, Method, Solver

METHODS: dict[str, Method] = {
    "quadratic_program": quadratic_program.METHOD,
    "pseudo_inverse": pseudo_inverse.METHOD,
    "relaxed": relaxed.METHOD,
}


@dataclass(frozen=True, eq=False)
class TensionDistribution:
    """Tensions and what they are worth: ``feasible`` alone says whether they may be used.

    tensions : (…, m) clipped to the limits when feasible, else the method's own last answer [N]
    feasible : (…) equilibrium holds and every limit is kept
    residual : (…, n) W τ + w_e [N, N m]
    margin : (…) distance to the nearest limit, negative outside [N]
    method : its name
    complete : whether the method finds a distribution whenever one exists
    reason : '' when feasible, else why not; an array in a batch
    """

    tensions: Array
    feasible: Any
    residual: Array
    margin: Any
    method: str
    complete: bool
    reason: Any

    def require(self) -> TensionDistribution:
        """Itself if all is feasible; raises InfeasibleTensions, carrying it, if not."""
        if np.all(self.feasible):
            return self
        bad = np.argwhere(~np.atleast_1d(self.feasible))
        reason = np.atleast_1d(self.reason)[tuple(bad[0])]
        share = f"{len(bad)} of {np.size(self.feasible)} wrenches: " if np.ndim(self.feasible) else ""
        raise InfeasibleTensions(f"{share}{reason}; method 'relaxed' gives the least wrench error inside the limits",
                                 self)


def distribute_tensions(W: ArrayLike, w_e: ArrayLike, tension_min: ArrayLike, tension_max: ArrayLike,
                        method: str = "quadratic_program", **options: Any) -> TensionDistribution:
    """Cable tensions with W τ + w_e = 0 and τ_min ≤ τ ≤ τ_max, one of infinitely many by the method's choice.

    W : (…, n, m) wrench matrix
    w_e : (…, n) external wrench, gravity included [N, N m]
    tension_min, tension_max : numbers, (m,) or (…, m) limits [N]
    method : see ``tension_methods()``; options are the method's own
    Returns TensionDistribution.
    Raises InvalidInput for wrong shapes, NaN, crossed or negative limits, an unknown method or option.
    Source: Okoli 2016, ch. 6; Pott 2018, ch. 3.

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0, 0, 1])
    >>> found = distribute_tensions(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), 50, 10000)
    >>> bool(found.feasible), float(found.tensions.min().round(1))
    (True, 317.6)
    """
    W, w_e, low, high = _checked(W, w_e, tension_min, tension_max)
    batch = W.shape[:-2]
    tensions = np.empty((*batch, W.shape[-1]))
    reasons = np.empty(batch, dtype=object)
    shared = _shared_limits(low, high)
    solve = solver_for(method, W.shape[-2], *shared, **options) if shared else None
    for index in np.ndindex(batch):
        one = solve or solver_for(method, W.shape[-2], low[index], high[index], **options)
        tensions[index], reasons[index] = one(W[index], w_e[index])
    return checked_distribution(W, w_e, low, high, tensions, reasons, method)


def tension_methods() -> dict[str, str]:
    """Name → one line about each method.

    >>> list(tension_methods())[0]
    'quadratic_program'
    """
    return {name: method.summary for name, method in METHODS.items()}


def solver_for(method: str, n: int, tension_min: Array, tension_max: Array, **options: Any) -> Solver:
    """The method built for n rows and these limits, ``(W, w_e) → tensions, reason``: what control loops call.

    Its answers are unchecked; ``checked_distribution`` judges them, one or a whole run at a time.
    Raises InvalidInput for an unknown method or option.
    """
    if method not in METHODS:
        raise InvalidInput(f"unknown tension method {method!r}; there are {', '.join(METHODS)}")
    known = METHODS[method].options()
    unknown = [name for name in options if name not in known]
    if unknown:
        raise InvalidInput(f"method {method!r} takes no option {unknown[0]!r}; "
                           f"it takes {', '.join(known) if known else 'none'}")
    return METHODS[method].build(n, tension_min, tension_max, **options)


def checked_distribution(W: Array, w_e: Array, low: Array, high: Array, tensions: Array, reasons: Any,
                         method: str) -> TensionDistribution:
    """Judges tensions by the law, whatever their method says: equilibrium residual and limits.

    Arrays as in `distribute_tensions`, one batch shape; reasons : (…) of str.
    """
    residual = (W @ tensions[..., None])[..., 0] + w_e
    margin = np.minimum(tensions - low, high - tensions).min(axis=-1)
    slack = LIMIT_TOLERANCE * high.max(axis=-1)
    balanced = np.abs(residual).max(axis=-1) <= RESIDUAL_TOLERANCE * (1 + np.abs(w_e).max(axis=-1))
    inside = margin >= -slack
    feasible = np.asarray(balanced & inside)
    tensions = np.where(feasible[..., None], np.clip(tensions, low, high), tensions)
    margin = np.where(feasible, np.maximum(margin, 0.0), margin)
    texts = np.empty(feasible.shape, dtype=object)
    for index in np.ndindex(feasible.shape):
        texts[index] = "" if feasible[index] else _reason(str(reasons[index]), tensions[index], low[index],
                                                          high[index], residual[index], bool(inside[index]))
    complete = METHODS[method].complete if method in METHODS else False
    single = feasible.ndim == 0
    return TensionDistribution(frozen(tensions), bool(feasible) if single else feasible, frozen(residual),
                               float(margin) if single else margin, method, complete,
                               texts[()] if single else texts)


def _reason(given: str, tau: Array, low: Array, high: Array, residual: Array, inside: bool) -> str:
    if given:
        return given
    if not inside:
        excess = np.maximum(low - tau, tau - high)
        worst = int(np.nanargmax(excess))
        return f"cable {worst + 1} would need {tau[worst]:.4g} N, allowed {low[worst]:g} to {high[worst]:g} N"
    return f"the wrench is missed by {np.abs(residual).max():.3g} N or N m"


def _checked(W: ArrayLike, w_e: ArrayLike, low: ArrayLike, high: ArrayLike) -> tuple[Array, Array, Array, Array]:
    W = as_array(W, "wrench matrix W", ("n", "m"), batch=True)
    n, m = W.shape[-2:]
    if not n or not m:
        raise InvalidInput(f"wrench matrix W needs at least one row and one cable, got shape {W.shape}")
    w_e = as_array(w_e, "external wrench w_e", (n,), "N, N m", batch=True)
    limits = []
    for value, name in ((low, "tension_min"), (high, "tension_max")):
        given = as_array(value, name, (), "N", batch=True)
        if given.ndim and given.shape[-1] not in (1, m):
            raise InvalidInput(f"{name} must be a number or {m} numbers [N], got shape {given.shape}")
        limits.append(given)
    try:
        batch = np.broadcast_shapes(W.shape[:-2], w_e.shape[:-1], *(limit.shape[:-1] for limit in limits))
    except ValueError:
        raise InvalidInput(f"batch shapes do not fit together: W {W.shape}, w_e {w_e.shape}, "
                           f"limits {limits[0].shape}, {limits[1].shape}") from None
    low, high = (np.broadcast_to(limit, (*batch, m)) for limit in limits)
    if (low < 0).any():
        raise InvalidInput(f"tension_min must not be negative [N] (cables only pull), got {float(low.min()):g}")
    if (low > high).any():
        at = tuple(np.argwhere(low > high)[0])
        raise InvalidInput(f"tension limits are crossed at cable {at[-1] + 1}: "
                           f"{float(low[at]):g} N > {float(high[at]):g} N")
    return np.broadcast_to(W, (*batch, n, m)), np.broadcast_to(w_e, (*batch, n)), low, high


def _shared_limits(low: Array, high: Array) -> tuple[Array, Array] | None:
    """The (m,) limits if the whole batch has the same, so that one solver serves it."""
    if low.ndim == 1:
        return low, high
    flat_low, flat_high = low.reshape(-1, low.shape[-1]), high.reshape(-1, high.shape[-1])
    if flat_low.shape[0] and (flat_low == flat_low[0]).all() and (flat_high == flat_high[0]).all():
        return flat_low[0], flat_high[0]
    return None
