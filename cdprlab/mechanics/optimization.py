"""One linear program, one quadratic program and one least squares: whoever has rows, limits and a wish asks here."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import Array


def largest_last(A: Any, b: Array, A_eq: Any = None, b_eq: Array | None = None,
                 bounds: Any = (None, None)) -> tuple[float, Array]:
    """max s with A [x; s] ≤ b, A_eq [x; s] = b_eq and bounds on each or on all of them: one linear program.

    A, A_eq : (k, v + 1), (e, v + 1), plain or sparse
    bounds : (least, most) for all, or one pair a variable; None where there is none
    Returns s, −inf where nothing keeps the rows, inf where they do not limit it, NaN where the
    solver gives up; and x (v,), NaN without an answer.
    Source: Huangfu and Hall 2018 (HiGHS).

    >>> largest_last(np.array([[1.0, 1.0], [-1.0, 1.0]]), np.array([3.0, 1.0]))
    (2.0, array([1.]))
    """
    from scipy.optimize import linprog

    cost = np.zeros(A.shape[1])
    cost[-1] = -1.0
    found = linprog(cost, A, b, A_eq, b_eq, bounds, method="highs")
    if found.status == 0:
        return float(found.x[-1]), np.asarray(found.x[:-1])
    return {2: -np.inf, 3: np.inf}.get(found.status, np.nan), np.full(cost.size - 1, np.nan)


def least_quadratic(H: Array, a: Array, C: Array, b: Array, equal: int = 0, factored: bool = False) -> Array | None:
    """min ½ xᵀ H x − aᵀ x with Cᵀ x ≥ b, the first ``equal`` rows as equalities; None where nothing keeps them.

    H : (v, v) positive definite, or factored: R⁻¹ of its Cholesky factor Rᵀ R; a : (v,); C :
        (v, k); b : (k,)
    Source: Goldfarb and Idnani 1983 (quadprog's dual active-set method).

    >>> least_quadratic(np.eye(2), np.zeros(2), np.ones((2, 1)), np.array([3.0]))
    array([1.5, 1.5])
    """
    import quadprog

    if not np.isfinite(b).all():   # quadprog answers NaN with numbers
        return None
    try:
        found: Array = quadprog.solve_qp(H, a, C, b, equal, factored)[0]
    except ValueError:
        return None
    return found


def least_squares(residuals: Callable[[Array], Array], start: Array, slopes: Any = "2-point",
                  method: str = "trf") -> Array:
    """The x near a start with the least ‖residuals(x)‖², as far as rounding lets it be found.

    slopes : ∂residuals/∂x as a function of x, or "2-point"
    method : as scipy has it: "trf", or "lm" for at least as many residuals as unknowns

    >>> least_squares(lambda x: x**2 - 2, np.ones(1)).round(12)
    array([1.41421356])
    """
    from scipy.optimize import least_squares

    tight = 4 * np.finfo(float).eps   # the least that scipy takes
    found: Array = least_squares(residuals, start, slopes, method=method, xtol=tight, ftol=tight, gtol=tight).x
    return found
