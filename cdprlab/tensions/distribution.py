"""The one door to all methods."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_batch, common_batch
from ..errors import InvalidInput
from .judgement import TensionDistribution, checked_distribution
from .law import flat
from .methods import method_named, solver_for


def distribute_tensions(W: ArrayLike, w_e: ArrayLike, tension_min: ArrayLike, tension_max: ArrayLike,
                        method: str = "quadratic_program", **options: Any) -> TensionDistribution:
    """Cable tensions with W τ + w_e = 0 and τ_min ≤ τ ≤ τ_max, one of infinitely many by the method's choice.

    W : (…, n, m) wrench matrix
    w_e : (…, n) external wrench, gravity included [N, N m]
    tension_min, tension_max : numbers, (m,) or (…, m) limits [N]
    method : see ``tension_methods()``; options are the method's own
    Returns TensionDistribution.
    Raises InvalidInput for wrong shapes, NaN, crossed or negative limits, an unknown method or
    option.
    Source: Okoli 2016, ch. 6; Pott 2018, ch. 3.

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0, 0, 1])
    >>> found = distribute_tensions(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), 50, 10000)
    >>> bool(found.feasible), float(found.tensions.min().round(1))
    (True, 317.6)
    """
    W = as_batch(W, "wrench matrix W", ("n", "m"))
    n, m = W.shape[-2:]
    if not n or not m:
        raise InvalidInput(f"wrench matrix W needs at least one row and one cable, got shape {W.shape}")
    w_e = as_batch(w_e, "external wrench w_e", (n,), "N, N m")
    low, high = _limits(tension_min, "tension_min", m), _limits(tension_max, "tension_max", m)
    if low.min() < 0:
        raise InvalidInput(f"tension_min must not be negative [N] (cables only pull), got {float(low.min()):g}")
    batch = common_batch(W=W.shape[:-2], w_e=w_e.shape[:-1], tension_min=low.shape[:-1],
                         tension_max=high.shape[:-1])
    crossed = low > high
    if crossed.any():
        at = tuple(np.argwhere(crossed)[0])
        least, most = (np.broadcast_to(limit, crossed.shape)[at] for limit in (low, high))
        raise InvalidInput(f"tension limits are crossed at cable {at[-1] + 1}: {least:g} N > {most:g} N")
    if not batch:
        return checked_distribution(W, w_e, low, high, *solver_for(method, n, low, high, **options)(W, w_e), method)
    limits = (flat(() if low.ndim == high.ndim == 1 else batch, limit) for limit in (low, high))
    tensions, reasons = method_named(method, options).solve(flat(batch, W, 2), flat(batch, w_e), *limits, **options)
    return checked_distribution(W, w_e, low, high, tensions.reshape(*batch, m), reasons.reshape(batch), method)


def _limits(value: ArrayLike, name: str, m: int) -> Array:
    """(m,) or (…, m) from a number or an array."""
    given = as_batch(value, name, (), "N")
    if given.shape[-1:] == (m,):
        return given
    if given.shape[-1:] not in ((), (1,)):
        raise InvalidInput(f"{name} must be a number or {m} numbers [N], got shape {given.shape}")
    return np.broadcast_to(given, (*given.shape[:-1], m))
