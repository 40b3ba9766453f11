"""The same questions as the compiled ones as linear programs, for more than two redundant cables."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..mechanics.optimization import largest_last
from ..robot import Robot


def margin_by_program(W: Array, w_e: Array, low: Array, high: Array, at_high: bool) -> tuple[float, Array]:
    """Largest s with W τ + w_e = 0 and τ_min + s ≤ τ ≤ τ_max − s, and such tensions; −inf where there are none."""
    n, m = W.shape
    identity, ones = np.eye(m), np.ones((m, 1))
    rows = np.block([[-identity, ones], [identity, ones if at_high else 0 * ones]])
    return largest_last(rows, np.concatenate([-low, high]), np.concatenate([W, np.zeros((n, 1))], axis=1), -w_e)


def standing_by_program(W: Array, w_e: Array, A: Array, b: Array, robot: Robot) -> float:
    """Largest s with A τ + s ≤ b among balanced tensions within the limits; −inf where there are none."""
    n, m = W.shape
    identity, none = np.eye(m), np.zeros((m, 1))
    rows = np.block([[-identity, none], [identity, none], [A, np.ones((len(A), 1))]])
    sides = np.concatenate([-robot.tension_min, robot.tension_max, b])
    return largest_last(rows, sides, np.concatenate([W, np.zeros((n, 1))], axis=1), -w_e)[0]


def speed_by_program(rates: Array, B: Array, cables: Array, bases: Array) -> float:
    """Largest s with |J t − B q̇| ≤ l̇_max − s and |q̇| ≤ q̇_max."""
    a, limited = B.shape[1], np.isfinite(cables)
    if not limited.any():
        return np.inf
    B, rates, ones = B[limited], rates[limited], np.ones((int(limited.sum()), 1))
    identity = np.eye(a, a + 1)
    rows = np.block([[-B, ones], [B, ones], [identity], [-identity]])
    sides = np.concatenate([cables[limited] - rates, cables[limited] + rates, bases, bases])
    return largest_last(rows, sides)[0]
