"""What measurements say about the configuration: lengths with errors, and marks on the cables."""

from collections.abc import Iterable
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked
from ..errors import InvalidInput, quoted
from ..robot import Robot
from .accuracy import position_sensitivity
from .configuration import Configuration, HalfWidth, few_cables
from .region import region


@checked
def compatible_configurations(robot: Robot, lengths: ArrayLike, length_error: HalfWidth = 0.01, *,
                              exit_uncertainty: HalfWidth = 0.0) -> tuple[Configuration, ...]:
    """Every configuration of one, two or three taut cables that measured lengths ± error do not exclude.

    Taut cables give the position: ‖M − A_i‖ = ρ_i; the others must reach it, ρ_l ≥ ‖M − A_l‖,
    and the taut ones must hold the load. A configuration is dropped only if no lengths within
    the error allow it.

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
    candidates, exits = few_cables(robot), robot.exit_points
    rho = as_array(lengths, "lengths", (robot.n_cables,), "m")
    # A displaced exit point shows as a length error of at most the diagonal of its box.
    error = length_error + np.sqrt(3) * exit_uncertainty

    def possible(taut: Configuration) -> bool:
        """Whether these cables can carry the load, given all lengths ± error."""
        chosen, below = taut.indices, _below_three if len(taut) == 3 else _below
        place = below(exits[chosen], rho[chosen], error)
        if place is None:
            return False
        M, radius = place
        reach = rho + error - np.linalg.norm(exits - M, axis=1) + np.sqrt(3) * radius
        if (np.delete(reach, chosen) < 0).any():
            return False
        return len(taut) < 3 or bool(region(exits[chosen], exit_uncertainty, radius).certainty(M)[1] >= 0)

    return tuple(filter(possible, candidates))


def reset_by_marks(readings: ArrayLike, marks: Iterable[tuple[int, float]]) -> Array:
    """Cable length from a drum that drifts, put right by each mark that passes the exit point.

    readings : (N,) length as the drum's turns give it [m]
    marks : (sample, true length [m]) of each mark seen, in order of time
    Returns (N,): the reading plus the last mark's correction; before the first mark the reading
    itself.
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


@checked
def hanging_position(robot: Robot, lengths: ArrayLike) -> tuple[Array, Configuration]:
    """Where a weight comes to rest on ropes of given lengths, and which of them are then taut.

    The lowest point that every rope reaches: min z subject to ‖M − A_i‖ ≤ ρ_i, which is convex
    and so has one answer, on one, two or three taut ropes.

    lengths : (m,) of rope let out [m]
    Returns (3,) M [m] and the taut Configuration.
    Raises InvalidInput for another kind of robot, or ropes so short that no point is within
    reach of all.
    Source: the point-mass case of Carricato and Merlet 2011 (direct geometrico-static problem).

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> M, taut = hanging_position(robot, cl.cable_lengths(robot, cl.Pose([0.5, 0.1, 1.0])) + [0, 0, 0, 0.2])
    >>> M.round(6), taut
    (array([0.5, 0.1, 1. ]), A123)
    """
    candidates, exits = few_cables(robot), robot.exit_points
    rho = as_array(lengths, "lengths", (robot.n_cables,), "m")
    # 1e-9 m: a rope that is taut as well is not too short.
    found = [(M, chosen) for chosen in candidates
             if (M := _lowest(exits[chosen.indices], rho[chosen.indices])) is not None
             and (np.linalg.norm(exits - M, axis=1) <= rho + 1e-9).all()]
    if not found:
        raise InvalidInput(f"no point is within reach of all ropes of lengths {quoted(rho.tolist())} m")
    # The first, of fewest ropes, where several hold the same point: the others are just not
    # slack.
    return min(found, key=lambda candidate: round(candidate[0][2], 9))


# --- positions from lengths, with their error ---------------------------------------------------------------
def _below(exits: Array, rho: Array, error: float) -> tuple[Array, float] | None:
    """Where one or two taut cables hold a load, and how far off that may be; None where they cannot."""
    shifts = [(0.0,) * len(rho), *product((error, -error), repeat=len(rho))]
    points = np.array([M for shift in shifts if (M := _lowest(exits, rho + shift)) is not None]).reshape(-1, 3)
    # Between the exits, or as good as: a cable beyond would have to push.
    across = (exits[-1] - exits[0])[:2]
    along = (points - exits[0])[:, :2] @ across
    if not ((along >= 0) & (along <= across @ across)).any():
        return None
    middle = points.mean(axis=0)
    off = points - middle
    return middle, np.maximum(np.linalg.norm(off[:, :2], axis=1), np.abs(off[:, 2])).max()


def _below_three(exits: Array, rho: Array, error: float) -> tuple[Array, float] | None:
    """The lower point at these lengths, and a bound for its error (a fixed point of sensitivity times length error)."""
    M, radius = _lowest(exits, rho, nearest=True), 0.0
    if M is None:
        return None
    for _ in range(50):
        grown = float(position_sensitivity(exits, M, radius)) * error
        if not grown < 1.0:
            return M, 1.0  # nearly singular: a metre's uncertainty excludes nothing
        if grown <= radius * (1 + 1e-6):
            break
        radius = grown * 1.01
    return M, radius


def _lowest(exits: Array, rho: Array, nearest: bool = False) -> Array | None:
    """The lowest point at these distances from one, two or three exits; None where there is none.

    nearest : lengths that just do not meet are off by their error, the nearest point between
        the exits stands for them
    """
    edges = exits[1:] - exits[0]
    levels = (rho[0]**2 - rho[1:]**2 + (edges**2).sum(axis=1)) / 2
    solved, _, rank, _ = np.linalg.lstsq(edges, np.column_stack([levels, edges[:, 2]]))
    foot, upward = solved.T
    down = upward - [0.0, 0.0, 1.0]      # what the exits' line or plane leaves of the way down
    size, square = np.linalg.norm(down), rho[0]**2 - foot @ foot
    if rank < len(edges) or size < 1e-9 or (square < 0 and not nearest):
        return None
    return np.asarray(exits[0] + foot + np.sqrt(max(square, 0.0)) / size * down)
