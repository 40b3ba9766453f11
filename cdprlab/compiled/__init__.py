"""What numba compiles: the loops that plain numpy is too slow for, each beside its equation. Importing this loads none.

The words that these loops and who calls them share are here.
"""

CENTROID, LOWEST, HIGHEST, NOTHING = 0, 1, 2, 3
"""What to pick of a polygon: the area's centroid, the corner of least or largest sum, or no point at all."""

FOUND, EMPTY, OUT_OF_RANGE, TOO_REDUNDANT, SPENT = 0, 1, 2, 3, 4
"""Or why there is no answer: nothing inside the limits, nothing at any tension, more than a polygon (r > 2), no cable
left to fix."""
