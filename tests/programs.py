"""What a polytope should answer, by linear programs that HiGHS solves."""

import numpy as np
import scipy.sparse
from scipy.optimize import linprog


def lp_support(polytope, directions):
    """max d·M q with A q ≤ b, some directions at a time as one sparse program."""
    return np.concatenate([_stacked(polytope, part) for part in np.array_split(directions, -(-len(directions) // 40))])


def _stacked(polytope, directions):
    finite = np.isfinite(polytope.limits)
    goals = directions @ polytope.map
    rows = scipy.sparse.block_diag([scipy.sparse.coo_array(polytope.rows[finite])] * len(goals), format="csr")
    found = linprog(-goals.ravel(), A_ub=rows, b_ub=np.tile(polytope.limits[finite], len(goals)), bounds=(None, None),
                    method="highs")
    assert found.status == 0
    return (goals * found.x.reshape(goals.shape)).sum(axis=1) + directions @ polytope.shift


def lp_contains(polytope, x):
    """Whether HiGHS finds a q with M q = x and A q ≤ b."""
    return linprog(np.zeros(polytope.map.shape[1]), A_ub=polytope.rows, b_ub=polytope.limits, A_eq=polytope.map,
                   b_eq=x - polytope.shift, bounds=(None, None), method="highs").status == 0
