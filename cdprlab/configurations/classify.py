"""Which triplets hold a point mass at a position: certainly, perhaps, or certainly not."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import checked
from ..robot import Robot
from .configuration import Configuration, HalfWidth, as_position, counterclockwise, few_cables, triplets
from .region import region
from .sides import side_range

INSIDE, UNCERTAIN, OUTSIDE = "inside", "uncertain", "outside"


@checked
def classify_configurations(robot: Robot, position: ArrayLike,
                            position_uncertainty: Annotated[float, "[m] ≥ 0"] = 0.05,
                            exit_uncertainty: Annotated[float, "[m] ≥ 0"] = 0.02, *,
                            form: str = "corners") -> dict[Configuration, str]:
    """Each triplet of cables → "inside", "uncertain" or "outside" at a position.

    Inside: for every exit point and position within the uncertainties the three sides
    (A_j − A_i) × (M − A_i) seen from above are positive and M is below the plane of the exits.
    Outside: one of these is negative for all of them.

    robot : a point mass (3T) on three cables or more
    position : (3,) M, or a Pose [m]
    position_uncertainty, exit_uncertainty : half widths of the boxes around M and around each
        A_i [m]
    form : how the range of the sides is computed: "corners" (exact), "translated", "natural",
        "contractor"
    Raises InvalidInput for another kind of robot, a bad position, negative uncertainties or an
    unknown form.
    Source: Ramadour and Merlet 2014, sections III and IV.A (δ_a and δ_b as section V has them).

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> classify_configurations(robot, [0.5, 0.1, 1.0])[1, 2, 3]
    'inside'
    """
    M, classes = as_position(position), {}
    for chosen in triplets(robot):
        exits = robot.exit_points[chosen.indices]
        low, high = region(exits, exit_uncertainty, position_uncertainty).ranges(M)
        if form != "corners":
            a = counterclockwise(exits)[:, :2]
            for k in range(3):
                low[k], high[k] = side_range(a[k], a[(k + 1) % 3], M[:2], exit_uncertainty,
                                             position_uncertainty, form)
        classes[chosen] = INSIDE if low.min() > 0 else OUTSIDE if high.min() < 0 else UNCERTAIN
    return classes


@checked
def taut_configurations(robot: Robot, position: ArrayLike, tolerance: HalfWidth = 1e-6) -> tuple[Configuration, ...]:
    """Every set of one, two or three cables that alone holds a weight at a position, nothing uncertain.

    One cable holds what hangs straight below its exit point, two what hangs below the line
    between theirs, three what hangs inside their triangle; a set is listed only if all its
    cables are needed.

    position : (3,) or a Pose [m]
    tolerance : how far off the vertical plane or line still counts as on it [m]
    Raises InvalidInput as `classify_configurations`.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> all(len(chosen) <= 3 for chosen in taut_configurations(robot, [0.5, 0.1, 1.0]))
    True
    """
    M, upward = as_position(position), np.eye(3)[2]

    def holds(chosen: Configuration) -> bool:
        """Whether these cables all pull and balance a weight at M."""
        up = robot.exit_points[chosen.indices] - M
        # Tensions over lengths: a combination of the cable vectors that is one unit of height.
        shares = np.linalg.lstsq(up.T, upward)[0]
        rise = up[:, 2].max()
        off = np.abs(shares @ up - upward).max() * abs(rise)
        # A share of the height: below tolerance/span the cable would be slack but for the
        # tolerance.
        needed = tolerance / max(np.ptp(up[:, :2], axis=0).max(), rise, tolerance)
        return bool(rise > 0 and off <= tolerance and (shares * rise > needed).all())

    return tuple(filter(holds, few_cables(robot)))
