"""What numba compiles: the loops that plain numpy is too slow for, each beside its equation. Importing this loads none.

The words that these loops and who calls them share are here.
"""

TOLERANCE = 1e-8
"""Of 1 + |w_e|∞ the residual that a distribution may leave, of 1 + |w_e|∞ + τ_min what a tension may lack.

A thousand times what rounding leaves, a thousandth of what a load cell sees. No upper limit
counts: a generous one must not change another cable's answer.
"""

FIXED = TOLERANCE / 10
"""Of 1 + τ_min: limits closer than this are one number."""

CENTROID, LOWEST, HIGHEST, NEAREST, NOTHING = 0, 1, 2, 3, 4
"""What to pick of a polygon: the centroid, the corner of least or largest sum, what is nearest to 0, or no point."""

FOUND, EMPTY, OUT_OF_RANGE, TOO_REDUNDANT, SPENT = 0, 1, 2, 3, 4
"""Or why there is no answer: nothing inside the limits, nothing at any tension, more than a polygon (r > 2), no cable
left to fix."""
