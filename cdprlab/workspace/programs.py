"""The same questions as the compiled ones as linear programs, for more than two redundant cables."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..robot import Robot


def margin_by_program(W: Array, w_e: Array, low: Array, high: Array, at_high: bool) -> tuple[float, Array]:
    """Largest s with W τ + w_e = 0 and τ_min + s ≤ τ ≤ τ_max − s, and such tensions; −inf where there are none."""
    n, m = W.shape
    identity, ones = np.eye(m), np.ones((m, 1))
    rows = np.block([[-identity, ones], [identity, ones if at_high else 0 * ones]])
    answer = _largest_last(rows, np.concatenate([-low, high]), np.concatenate([W, np.zeros((n, 1))], axis=1), -w_e)
    return (-np.inf, np.full(m, np.nan)) if answer is None else (float(answer[-1]), answer[:-1])


def standing_by_program(W: Array, w_e: Array, A: Array, b: Array, robot: Robot) -> float:
    """Largest s with A τ + s ≤ b among balanced tensions within the limits; −inf where there are none."""
    n, m = W.shape
    identity, none = np.eye(m), np.zeros((m, 1))
    rows = np.block([[-identity, none], [identity, none], [A, np.ones((len(A), 1))]])
    answer = _largest_last(rows, np.concatenate([-robot.tension_min, robot.tension_max, b]),
                           np.concatenate([W, np.zeros((n, 1))], axis=1), -w_e)
    return -np.inf if answer is None else float(answer[-1])


def speed_by_program(rates: Array, B: Array, cables: Array, bases: Array) -> float:
    """Largest s with |J t − B q̇| ≤ l̇_max − s and |q̇| ≤ q̇_max."""
    a, limited = B.shape[1], np.isfinite(cables)
    if not limited.any():
        return np.inf
    B, rates, ones = B[limited], rates[limited], np.ones((int(limited.sum()), 1))
    identity = np.eye(a, a + 1)
    rows = np.block([[-B, ones], [B, ones], [identity], [-identity]])
    sides = np.concatenate([cables[limited] - rates, cables[limited] + rates, bases, bases])
    answer = _largest_last(rows, sides, np.zeros((0, a + 1)), np.zeros(0))
    return -np.inf if answer is None else float(answer[-1])


def _largest_last(A: Array, b: Array, A_eq: Array, b_eq: Array) -> Array | None:
    """The x with the largest last entry; None where nothing satisfies the rows."""
    from scipy.optimize import linprog

    done: Any = linprog(-np.eye(A.shape[1])[-1], A_ub=A, b_ub=b, A_eq=A_eq if len(A_eq) else None,
                        b_eq=b_eq if len(A_eq) else None, bounds=(None, None), method="highs")
    return np.asarray(done.x) if done.status == 0 else None
