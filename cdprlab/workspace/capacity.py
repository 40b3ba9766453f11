"""How much room wrenches leave: to the tension limits, to the facets of the available wrench set, to tipping."""

from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Flags, as_array, plain
from ..compiled import CENTROID, FOUND, NOTHING, TOO_REDUNDANT
from ..errors import InvalidInput
from ..mechanics.optimization import largest_last
from ..robot import Robot
from ..sets import Polytope
from ..tensions import distribute_tensions
from ..tensions.law import forgiven
from .margins import balances, margin_by_program, tension_margins

NEAR = 1e-6
"""Of 1 + |w|∞ and the largest τ_min: margins this close to 0 leave the verdict to the law of tension distributions."""


def balanced(margins: Array, W: Array, w_e: Array, loads: Array, low: Array, high: Array) -> Flags:
    """(N,) whether the least margin over all loads is not negative, or the law forgives it: no upper limit counts.

    W : (N, n, m); w_e : (N, n); loads : (k, N or 1, n) [N, N m]; low, high : (m,) [N]
    """
    inside = np.asarray(margins >= 0)
    size = 1 + np.abs(w_e).max(axis=-1) + np.abs(loads).max(axis=(0, -1)) + low.max()
    near = np.abs(margins) <= NEAR * size
    if near.any():
        inside[near] = distribute_tensions(W[near], (w_e + loads)[:, near], low, high).feasible.all(axis=0)
    return inside


def best_tensions(W: Array, w_e: Array, low: Array, high: Array, *, at_high: bool = True) -> tuple[Array, Array]:
    """`tension_margins` and tensions (N, m) that have them, NaN where nothing balances w_e."""
    from ..compiled.polygon import polygons

    s = tension_margins(W, w_e, low, high, at_high=at_high)
    kept = s[:, None]
    tau, found, _ = polygons(*map(plain, (W, w_e, low + kept, high - at_high * kept)), CENTROID)
    for k in np.flatnonzero(found == TOO_REDUNDANT):
        tau[k] = margin_by_program(W[k], w_e[k], low, high, at_high)[1]
    return s, tau


def feasible(W: Array, w_e: Array, low: Array, high: Array) -> Flags:
    """Whether tensions within the limits balance each wrench: the sign of `tension_margins`, quicker with numba."""
    from ..compiled.jit import COMPILES
    from ..compiled.polygon import polygons

    found = np.full(len(W), TOO_REDUNDANT)
    if COMPILES:
        found = polygons(*map(plain, (W, w_e, low[None], high[None])), NOTHING)[1]
    inside, many = np.asarray(found == FOUND), found == TOO_REDUNDANT
    if many.any():
        s = tension_margins(W[many], w_e[many], low, high)
        inside[many] = balanced(s, W[many], w_e[many], np.zeros((1, 1, w_e.shape[1])), low, high)
    return inside


def standing_margin(robot: Robot, W: Array, w_e: Array, A: Array, b: Array) -> float:
    """Largest s with A τ + s ≤ b among tensions within the limits that balance w_e; −inf where there are none.

    W : (n, m); w_e : (n,); A : (f, m) and b : (f,) of `tipping_rows` [m, N m]
    """
    slack = forgiven(w_e, robot.tension_min)
    limits = zip(robot.tension_min - slack, robot.tension_max + slack)
    return largest_last(np.column_stack([A, np.ones(len(A))]), b,
                        np.column_stack([W, np.zeros(len(W))]), -w_e, [*limits, (None, None)])[0]


def capacity_margins(W: Array, w_e: Array, loads: Array, half: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Distance of all wrenches −(w_e + load ± half) from the border of {W τ : τ_min ≤ τ ≤ τ_max}, negative outside.

    The nearest facet decides. Where the rows are forces and moments it is in N, a moment of 1 N
    m counting as 1 N. With one facet's normal n orthogonal to n − 1 columns of W (hyperplane
    shifting), y = Wᵀ n is zero on these columns and orthogonal to the null space of W: the facets
    are those of `tension_margins`.

    W : (N, n, m); w_e : (N, n) [N, N m]; loads : (v, n); half : (n,) [N, N m]; low, high : (m,)
        [N]
    Returns (N,); (N, n) outward unit normal of the facet that decides. Where W loses rank the
    set is flat, and nothing is inside by more than 0.
    Source: Bouchard et al. 2010; Gouttefarde and Krut 2010; Guay et al. 2014 (capacity margin).

    >>> W = np.array([[[1.0, 0.0], [0.0, 1.0]]])
    >>> load, half = np.array([[-2.0, -3.0]]), np.array([0.5, 0.0])
    >>> capacity_margins(W, np.zeros((1, 2)), load, half, np.zeros(2), 4 * np.ones(2))[0]
    array([1.])
    """
    s, normals = np.full(len(W), np.nan), np.empty(w_e.shape)
    for balance in balances(W, w_e):
        nearest, outward = np.full(len(balance.at), np.inf), np.empty(balance.inverse[:, 0].shape)
        for chosen, y in balance.facets():
            normal = sum(balance.inverse[:, i] * share for i, share in zip(chosen, y))
            pull, least, most = np.maximum(y, 0.0), low[chosen], high[chosen]
            exerted, width = (y * balance.c[chosen]).sum(axis=0) - loads @ normal, half @ np.abs(normal)
            above = most @ pull + least @ (y - pull) - exerted.max(axis=0) - width
            below = exerted.min(axis=0) - width - least @ pull - most @ (y - pull)
            with np.errstate(divide="ignore", invalid="ignore"):   # y that is zero is no facet
                size = np.sqrt((normal * normal).sum(axis=0))
                left = np.minimum(above, below) / size
            nearer = left < nearest
            nearest[nearer] = left[nearer]
            outward[:, nearer] = np.where(above <= below, normal, -normal)[:, nearer] / size[nearer]
        s[balance.at], normals[balance.at] = nearest, outward.T
    for k in np.flatnonzero(np.isnan(s)):
        available = Polytope.from_box(W[k], low, high)
        left = (available.offsets - (available.normals @ -(w_e[k] + loads).T).max(axis=1)
                - np.abs(available.normals) @ half)
        worst = left.argmin()
        s[k], normals[k] = left[worst], available.normals[worst]
    return s, normals


def one_or_several(rows: ArrayLike | None, name: str, n: int, unit: str) -> Array:
    """(k, n); 0 from None."""
    return as_array(np.zeros(n) if rows is None else rows, name, (n,), unit, batch=True).reshape(-1, n)


def box_half_widths(value: ArrayLike | None, n: int, unit: str) -> Array:
    """(n,), not negative; 0 from None."""
    half = as_array(np.zeros(n) if value is None else value, "half_widths", (n,), unit)
    if (half < 0).any():
        raise InvalidInput(f"half_widths must not be negative, got {half.tolist()}")
    return half


def box_loads(loads: Array, half: Array) -> Array:
    """(k 2ʰ, n) corners of a box around each load; directions without width make none."""
    signs = np.array(list(product(*[(1.0, -1.0) if h else (0.0,) for h in half])))
    return np.asarray((loads[:, None] + signs * half).reshape(-1, half.size))
