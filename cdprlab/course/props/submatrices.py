"""The papers' available twist set of bases that move: what all square sub-matrices of J allow together."""

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse.csgraph import connected_components

from ...arrays import Array
from ...errors import InvalidInput
from ...sets import Polytope, hyperplane_shifting
from ...sets.subspace import null_space
from ...sets.twist import checked_speeds


class SubmatrixTwistSet(NamedTuple):
    """The papers' construction.

    set : Polytope
    exact : whether it is certain to equal `twist_set`
    """

    set: Polytope
    exact: bool


def submatrix_twist_set(J: ArrayLike, B: ArrayLike, speed_max: ArrayLike,
                        base_speed_max: ArrayLike) -> SubmatrixTwistSet:
    """What all square sub-matrices of J allow together: ∩ₖ {Jₖ⁻¹ (l̇ₖ + Bₖ q̇)}, singular ones left out.

    Always contains the available twist set, and equals it when every base moves by itself (its
    block of B is its cables' rows of J times the base's own Jacobian) and J has full column
    rank.

    J : (m, n); B : (m, a); speed_max : (m,); base_speed_max : (a,)
    Raises InvalidInput where no sub-matrix is regular.
    Source: Rasheed et al. 2018, eq. (16)–(17).

    >>> found = submatrix_twist_set([[1], [1]], [[1], [-1]], [2, 2], [0.8])
    >>> found.exact, float(found.set.support([1.0]))
    (False, 2.8)
    """
    j, b, cable, base = checked_speeds(J, B, speed_max, base_speed_max)
    m, n = j.shape
    found = []
    for k in map(list, combinations(range(m), n)):
        if np.isfinite(cable[k]).all() and np.linalg.cond(j[k]) <= 1e10:
            speeds = np.concatenate([np.diag(cable[k]), b[k] * base], axis=1)
            found.append(hyperplane_shifting(np.linalg.solve(j[k], speeds)))
    if not found:
        raise InvalidInput(f"no {n} of the {m} cables determine the twist: J has no regular sub-matrix here, so the "
                           "construction says nothing; use available_twist_set")
    return SubmatrixTwistSet(Polytope.from_rows(*map(np.concatenate, zip(*found))),
                             not null_space(j).shape[1] and _bases_move_by_themselves(j, b * base))


def _bases_move_by_themselves(J: Array, B: Array) -> bool:
    """Whether actuators that share cables move those cables' exits like one base does."""
    m, a = B.shape
    shared = np.zeros((m + a, m + a))
    shared[:m, m:] = B != 0
    count, part = connected_components(shared, directed=False)   # cables and actuators that have to do with each other
    for k in range(count):
        rows, columns = part[:m] == k, part[m:] == k
        moves = B[rows][:, columns]
        left = moves - J[rows] @ np.linalg.lstsq(J[rows], moves, rcond=None)[0]
        if np.abs(left).max(initial=0.0) > 1e-9 * np.abs(moves).max(initial=0.0):
            return False
    return True
