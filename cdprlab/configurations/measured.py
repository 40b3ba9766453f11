"""What measurements say about the configuration: lengths with errors, and marks on the cables."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Indices, as_array, as_number
from ..errors import InvalidInput
from ..robot import Robot
from .accuracy import position_sensitivity
from .classify import certainty
from .configuration import Configuration, as_position, few_cables, triplets

_GROWTH = 1.1
_SLACKS = tuple(1e-3 * _GROWTH**k for k in range(88))
"""Tried in turn, a millimeter to four meters [m]."""


def compatible_configurations(robot: Robot, lengths: ArrayLike, length_error: float = 0.01, *,
                              exit_uncertainty: float = 0.0) -> tuple[Configuration, ...]:
    """Every configuration of one, two or three taut cables that measured lengths ± error do not exclude.

    Taut cables give the position: ‖M − A_i‖ = ρ_i; the others must reach it, ρ_l ≥ ‖M − A_l‖, and the taut ones must
    hold the load. A configuration is dropped only if no lengths within the error allow it.

    lengths : (m,) measured, slack included [m]
    length_error : ± of each [m]; exit_uncertainty : half width of the box around each A_i [m]
    Raises InvalidInput for another kind of robot or wrong numbers.
    Source: Ramadour and Merlet 2014, eq. (1)–(3) and the end of section II.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> lengths = cl.cable_lengths(robot, cl.Pose([0.5, 0.1, 1.0])) + [0, 0, 0, 0.2]
    >>> compatible_configurations(robot, lengths)
    (A123,)
    """
    candidates = few_cables(robot)
    rho = as_array(lengths, "lengths", (robot.n_cables,), "m")
    # A displaced exit point shows as a length error of at most the diagonal of its box.
    error = as_number(length_error, "length_error", "m") + np.sqrt(3) * as_number(exit_uncertainty,
                                                                                  "exit_uncertainty", "m")
    return tuple(chosen for chosen in candidates
                 if _possible(robot.exit_points, rho, chosen.indices, error, exit_uncertainty))


def slack_length(robot: Robot, position: ArrayLike, configuration: Iterable[int], length_error: float = 0.01, *,
                 exit_uncertainty: float = 0.0) -> float:
    """The smallest length, added to every other cable, that leaves only one configuration compatible [m].

    position : (3,) or a Pose [m]; configuration : three cables, numbered from 1
    length_error : ± of each measured length [m]; exit_uncertainty : half width of the box around each A_i [m]
    Raises InvalidInput where no such length up to 4 m exists: the position is too near the triangle's edge.
    Source: Ramadour and Merlet 2014, section VI, where it is 0.20 m throughout.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> 0.02 < slack_length(robot, [0.5, 0.1, 1.0], (1, 2, 3)) < 0.2
    True
    """
    chosen, M = Configuration(configuration), as_position(position)
    if chosen not in triplets(robot):
        raise InvalidInput(f"configuration must be three of the cables 1 to {robot.n_cables}, got {tuple(chosen)}")
    rho = np.linalg.norm(robot.exit_points - M, axis=1)
    others = np.ones(robot.n_cables)
    others[chosen.indices] = 0.0

    def certain(slack: float) -> bool:
        found = compatible_configurations(robot, rho + slack * others, length_error, exit_uncertainty=exit_uncertainty)
        return found == (chosen,)

    # Certainty may end again at longer slack, where another triplet's cables just meet: the first that is certain.
    high = next((slack for slack in _SLACKS if certain(slack)), None)
    if high is None:
        raise InvalidInput(f"no slack makes {chosen} certain at {M.tolist()} with lengths known to ± {length_error:g} "
                           "m: the position is too near an edge of its triangle")
    low = high / _GROWTH
    while high - low > 1e-4:  # a tenth of a millimetre: winches do not know better
        middle = (low + high) / 2
        low, high = (low, middle) if certain(middle) else (middle, high)
    return high


def reset_by_marks(readings: ArrayLike, marks: Iterable[tuple[int, float]]) -> Array:
    """Cable length from a drum that drifts, put right by each mark that passes the exit point.

    readings : (N,) length as the drum's turns give it [m]
    marks : (sample, true length [m]) of each mark seen, in order of time
    Returns (N,): the reading plus the last mark's correction; before the first mark the reading itself.
    Source: Ramadour and Merlet 2014, section II (foils glued to the cable at known lengths).

    >>> reset_by_marks([2.00, 2.11, 2.22, 2.33], [(1, 2.10)]).round(2)
    array([2.  , 2.1 , 2.21, 2.32])
    """
    raw = as_array(readings, "readings", (), "m", batch=True)
    length = raw.copy()
    for sample, true in marks:
        if not 0 <= sample < raw.shape[0]:
            raise InvalidInput(f"a mark's sample must be 0 to {raw.shape[0] - 1}, got {sample}")
        length[sample:] = raw[sample:] + (true - raw[sample])
    return length


def hanging_position(robot: Robot, lengths: ArrayLike) -> tuple[Array, Configuration]:
    """Where a weight comes to rest on ropes of given lengths, and which of them are then taut.

    The lowest point that every rope reaches: min z subject to ‖M − A_i‖ ≤ ρ_i, which is convex and so has one answer,
    on one, two or three taut ropes.

    lengths : (m,) of rope let out [m]
    Returns (3,) M [m] and the taut Configuration.
    Raises InvalidInput for another kind of robot, or ropes so short that no point is within reach of all.
    Source: the point-mass case of Carricato and Merlet 2011 (direct geometrico-static problem).

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> M, taut = hanging_position(robot, cl.cable_lengths(robot, cl.Pose([0.5, 0.1, 1.0])) + [0, 0, 0, 0.2])
    >>> M.round(6), taut
    (array([0.5, 0.1, 1. ]), A123)
    """
    candidates, exits = few_cables(robot), robot.exit_points
    rho = as_array(lengths, "lengths", (robot.n_cables,), "m")
    found = []
    for chosen in candidates:
        place = _below(exits[chosen.indices], rho[chosen.indices], 0.0)
        # 1e-9 m: a rope that is taut as well is not too short.
        if place is not None and (np.linalg.norm(exits - place[0], axis=1) <= rho + 1e-9).all():
            found.append((place[0], chosen))
    if not found:
        raise InvalidInput(f"no point is within reach of all ropes of lengths {rho.tolist()} m")
    # The first, of fewest ropes, where several hold the same point: the others are just not slack.
    return min(found, key=lambda candidate: round(float(candidate[0][2]), 9))


# --- positions from lengths, with their error ---------------------------------------------------------------
def _possible(exits: Array, rho: Array, chosen: Indices, error: float, exit_uncertainty: float) -> bool:
    """Whether taut cables ``chosen`` can carry the load alone, given all lengths ± error."""
    place = _below(exits[chosen], rho[chosen], error)
    if place is None:
        return False
    M, radius = place
    reach = rho + error - np.linalg.norm(exits - M, axis=1) + np.sqrt(3) * radius
    if (np.delete(reach, chosen) < 0).any():
        return False
    return len(chosen) < 3 or certainty(exits[chosen], M, radius, exit_uncertainty, "corners")[1] >= 0


def _below(exits: Array, rho: Array, error: float) -> tuple[Array, float] | None:
    """Where one, two or three taut cables hold a load, and how far off that may be; None where they cannot."""
    if len(rho) == 1:
        return exits[0] - [0, 0, rho[0]], error
    return _below_two(exits, rho, error) if len(rho) == 2 else _below_three(exits, rho, error)


def _below_two(exits: Array, rho: Array, error: float) -> tuple[Array, float] | None:
    """In the vertical plane of both exits, the lower of the two meeting points."""
    a, edge = exits[0], exits[1] - exits[0]
    across = np.linalg.norm(edge[:2])
    if across == 0:
        return None
    plane = np.array([edge[:2] @ edge[:2] / across, edge[2]])
    corners = [_lower_meeting(plane, rho + error * np.array(signs)) for signs in
               ((0, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))]
    points = np.array([point for point in corners if point is not None])
    # Between the exits, or as good as: a cable beyond would have to push.
    inside = [0 <= share <= across for share in points[:, 0]] if len(points) else []
    if not any(inside):
        return None
    middle = points.mean(axis=0)
    flat = np.append(edge[:2] / across * middle[0], middle[1])
    return a + flat, float(np.abs(points - middle).max())


def _lower_meeting(b: Array, rho: Array) -> Array | None:
    """Lower intersection of circles about 0 and b in a vertical plane."""
    d = float(np.hypot(*b))
    along = (d**2 + rho[0]**2 - rho[1]**2) / (2 * d)
    height = rho[0]**2 - along**2
    if height < 0:
        return None
    unit, normal = b / d, np.array([b[1], -b[0]]) / d
    return unit * along + normal * np.sqrt(height)


def _below_three(exits: Array, rho: Array, error: float) -> tuple[Array, float] | None:
    """The lower point at these lengths, and a bound for its error (a fixed point of sensitivity times length error)."""
    M = _trilaterate(exits, rho)
    if M is None:
        return None
    radius = 0.0
    for _ in range(50):
        grown = float(position_sensitivity(exits, M, radius)) * error
        if not grown < 1.0:
            return M, 1.0  # nearly singular: a metre's uncertainty excludes nothing
        if grown <= radius * (1 + 1e-6):
            break
        radius = grown * 1.01
    return M, radius


def _trilaterate(exits: Array, rho: Array) -> Array | None:
    a, b, c = exits
    x = (b - a) / np.linalg.norm(b - a)
    y = (c - a) - x * (x @ (c - a))
    if not y.any():
        return None
    y = y / np.linalg.norm(y)
    u = (rho[0]**2 - rho[1]**2 + (b - a) @ (b - a)) / (2 * np.linalg.norm(b - a))
    v = (rho[0]**2 - rho[2]**2 + (c - a) @ (c - a) - 2 * u * (x @ (c - a))) / (2 * (y @ (c - a)))
    # Lengths that just do not meet are off by their error: the nearest point in the plane stands for them.
    depth = np.sqrt(max(0.0, rho[0]**2 - u**2 - v**2))
    down = np.cross(x, y)
    down = -down if down[2] > 0 else down
    point: Array = a + u * x + v * y + depth * down
    return point
