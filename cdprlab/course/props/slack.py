"""How much slack makes a configuration certain."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import checked
from ...configurations import Configuration, compatible_configurations
from ...configurations.configuration import as_position, triplets
from ...errors import InvalidInput, quoted
from ...robot import Robot


@checked
def slack_length(robot: Robot, position: ArrayLike, configuration: Sequence[int],
                 length_error: float = 0.01) -> float:
    """The smallest length, added to every other cable, that leaves only one configuration compatible [m].

    position : (3,) or a Pose [m]; configuration : three cables, numbered from 1
    length_error : ± of each measured length [m]
    Raises InvalidInput where no such length up to 4 m exists: the position is too near the
    triangle's edge.
    Source: Ramadour and Merlet 2014, section VI, where it is 0.20 m throughout.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> 0.02 < slack_length(robot, [0.5, 0.1, 1.0], (1, 2, 3)) < 0.2
    True
    """
    chosen, M = Configuration(configuration), as_position(position)
    if chosen not in triplets(robot):
        raise InvalidInput(f"configuration must be three of the cables 1 to {robot.n_cables}, "
                           f"got {quoted(tuple(chosen))}")
    rho = np.linalg.norm(robot.exit_points - M, axis=1)
    others = np.ones(robot.n_cables)
    others[chosen.indices] = 0.0

    def certain(slack: float) -> bool:
        return compatible_configurations(robot, rho + slack * others, length_error) == (chosen,)

    growth = 1.1
    slacks = 1e-3 * growth**np.arange(88)       # a millimeter to four meters
    # Certainty may end again at longer slack, where another triplet's cables just meet: the
    # first that is certain.
    high = next((slack for slack in slacks if certain(slack)), None)
    if high is None:
        raise InvalidInput(f"no slack makes {chosen} certain at {M.tolist()} with lengths known to ± {length_error:g} "
                           "m: the position is too near an edge of its triangle")
    low = high / growth
    while high - low > 1e-4:  # a tenth of a millimetre: winches do not know better
        middle = (low + high) / 2
        low, high = (low, middle) if certain(middle) else (middle, high)
    return float(high)
