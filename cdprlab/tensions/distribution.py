"""The one door to all methods."""

from __future__ import annotations

from math import isfinite
from operator import sub
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput
from . import (
    barycenter,
    closed_form,
    improved_closed_form,
    judgement,
    kernel,
    linear_program,
    pseudo_inverse,
    puncture,
    quadratic_program,
    relaxed,
)
from .judgement import TensionDistribution as TensionDistribution
from .method import Method, Solver, no_reasons

METHODS: dict[str, Method] = {
    "linear_program": linear_program.METHOD,
    "quadratic_program": quadratic_program.METHOD,
    "pseudo_inverse": pseudo_inverse.METHOD,
    "closed_form": closed_form.METHOD,
    "improved_closed_form": improved_closed_form.METHOD,
    "kernel": kernel.METHOD,
    "puncture": puncture.METHOD,
    "barycenter": barycenter.METHOD,
    "relaxed": relaxed.METHOD,
}


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
    batch = () if W.ndim == 2 and w_e.ndim == low.ndim == high.ndim == 1 else _batch_shape(W, w_e, low, high)
    if not batch:
        tensions, reasons = solver_for(method, W.shape[-2], low, high, **options)(W, w_e)
    else:
        tensions, reasons = _solve_batch(batch, W, w_e, low, high, method, options)
    return checked_distribution(W, w_e, low, high, tensions, reasons, method)


def _solve_batch(batch: tuple[int, ...], W: Array, w_e: Array, low: Array, high: Array, method: str,
                 options: dict[str, Any]) -> tuple[Array, Any]:
    n, m = W.shape[-2:]
    every_W, every_w = np.broadcast_to(W, (*batch, n, m)), np.broadcast_to(w_e, (*batch, n))
    shared = low.ndim == high.ndim == 1
    lows, highs = ((limit[None] if shared else np.broadcast_to(limit, (*batch, m)).reshape(-1, m))
                   for limit in (low, high))
    flat_W, flat_w = every_W.reshape(-1, n, m), every_w.reshape(-1, n)
    chosen = _method(method, options)
    if chosen.batch is not None:
        tensions, reasons = chosen.batch(**options)(flat_W, flat_w, lows, highs)
        return tensions.reshape(*batch, m), reasons.reshape(batch)
    tensions, reasons = np.empty((flat_W.shape[0], m)), no_reasons(flat_W.shape[0])
    solve = chosen.build(n, low, high, **options) if shared else None
    for k in range(flat_W.shape[0]):
        one = solve or chosen.build(n, lows[k], highs[k], **options)
        tensions[k], reasons[k] = one(flat_W[k], flat_w[k])
    return tensions.reshape(*batch, m), reasons.reshape(batch)


def tension_methods() -> dict[str, str]:
    """Name → one line about each method.

    >>> list(tension_methods())[0]
    'linear_program'
    """
    return {name: method.summary for name, method in METHODS.items()}


def solver_for(method: str, n: int, tension_min: Array, tension_max: Array, **options: Any) -> Solver:
    """The method built for n rows and these limits, ``(W, w_e) → tensions, reason``: what control loops call.

    Its answers are unchecked; ``checked_distribution`` judges them, one or a whole run at a time.
    Raises InvalidInput for an unknown method or option.
    """
    return _method(method, options).build(n, tension_min, tension_max, **options)


def _method(name: str, options: dict[str, Any]) -> Method:
    if name not in METHODS:
        raise InvalidInput(f"unknown tension method {name!r}; there are {', '.join(METHODS)}")
    if options:
        known = METHODS[name].options()
        unknown = [option for option in options if option not in known]
        if unknown:
            raise InvalidInput(f"method {name!r} takes no option {unknown[0]!r}; "
                               f"it takes {', '.join(known) if known else 'none'}")
    return METHODS[name]


def checked_distribution(W: Array, w_e: Array, low: Array, high: Array, tensions: Array, reasons: Any,
                         method: str) -> TensionDistribution:
    """Judges tensions by the law, whatever their method says: equilibrium residual and limits.

    Arrays as in `distribute_tensions`, tensions of the whole batch; reasons : str or (…) of str
    """
    complete = method in METHODS and METHODS[method].complete
    return judgement.checked_distribution(W, w_e, low, high, tensions, reasons, method, complete)


def _checked(W: ArrayLike, w_e: ArrayLike, low: ArrayLike, high: ArrayLike) -> tuple[Array, Array, Array, Array]:
    W = _gate(W, "wrench matrix W", ("n", "m"))
    n, m = W.shape[-2:]
    if not n or not m:
        raise InvalidInput(f"wrench matrix W needs at least one row and one cable, got shape {W.shape}")
    w_e = _gate(w_e, "external wrench w_e", (n,), "N, N m")
    low, high = _limits(low, "tension_min", m), _limits(high, "tension_max", m)
    if low.ndim == high.ndim == 1:
        lows, highs = low.tolist(), high.tolist()
        if min(lows) >= 0 and min(map(sub, highs, lows)) >= 0:
            return W, w_e, low, high
    _batch_shape(W, w_e, low, high)
    if (low < 0).any():
        raise InvalidInput(f"tension_min must not be negative [N] (cables only pull), got {float(low.min()):g}")
    if (low > high).any():
        at = tuple(np.argwhere(low > high)[0])
        low, high = np.broadcast_arrays(low, high)
        raise InvalidInput(f"tension limits are crossed at cable {at[-1] + 1}: "
                           f"{float(low[at]):g} N > {float(high[at]):g} N")
    return W, w_e, low, high


def _gate(value: ArrayLike, name: str, shape: tuple[int | str, ...], unit: str = "") -> Array:
    """`as_array`, without its copy where there is nothing to change: a batch of W is most of what is moved."""
    if type(value) is np.ndarray and value.dtype == np.float64 and value.ndim >= max(1, len(shape)):
        fits = not shape or isinstance(shape[-1], str) or value.shape[-1] == shape[-1]
        flat = value.ravel()
        if fits and isfinite(flat.dot(flat)):   # else something is not finite, or enormous: looked at closely
            return value
    return as_array(value, name, shape, unit, batch=True)


def _limits(value: ArrayLike, name: str, m: int) -> Array:
    """(m,) or (…, m) from a number or an array."""
    given = _gate(value, name, (), "N")
    if given.ndim and given.shape[-1] == m:
        return given
    if given.ndim and given.shape[-1] != 1:
        raise InvalidInput(f"{name} must be a number or {m} numbers [N], got shape {given.shape}")
    return np.broadcast_to(given, (*given.shape[:-1], m))


def _batch_shape(W: Array, w_e: Array, low: Array, high: Array) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(W.shape[:-2], w_e.shape[:-1], low.shape[:-1], high.shape[:-1])
    except ValueError:
        raise InvalidInput(f"batch shapes do not fit together: W {W.shape}, w_e {w_e.shape}, "
                           f"limits {low.shape}, {high.shape}") from None
