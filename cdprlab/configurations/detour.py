"""Ways around what a straight way cannot pass safely: the crossing of the diagonals, and ends amid an edge."""

from collections.abc import Callable
from functools import partial
from itertools import product, starmap

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..robot import Robot, turned_to
from .configuration import as_position, triplets
from .region import Region, region
from .sequence import UNSAFE_CHANGE, ConfigurationSequence, location_score, plan_configurations

_SHARES = np.linspace(0.05, 0.95, 19)
_OFFSETS = np.outer(np.arange(1, 41) * 0.05, [1, -1]).ravel()  # m, to either side
_AROUND = np.arange(0, 1.0, 0.02)  # m


def plan_detour(robot: Robot, start: ArrayLike, goal: ArrayLike, *,
                position_uncertainty: float = 0.05,
                exit_uncertainty: float = 0.02) -> ConfigurationSequence | None:
    """The shortest way over one waypoint whose every change is safe; the straight way if that is safe already.

    Near the crossing of two diagonals no triplet is certain, so a straight way across it has no
    safe sequence; the waypoint leads past it, at the height of the way. A start or goal that is
    not certainly inside any triplet is left for, or reached from, the nearest point at its
    height that is (the literature's M₀); such a sequence is not `safe`.

    robot, start, goal, position_uncertainty, exit_uncertainty : as for `plan_configurations`
    Returns a ConfigurationSequence whose steps include the waypoint, or None where no waypoint
    helps.
    Raises InvalidInput as `plan_configurations`.
    Source: Ramadour and Merlet 2014, sections IV.A (step 1) and VII, which leaves the crossing
    open.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> straight = plan_configurations(robot, [-1, 0, 1], [1, 0, 1])[0]
    >>> around = plan_detour(robot, [-1, 0, 1], [1, 0, 1])
    >>> straight.safe, around.safe
    (False, True)
    """
    plan = partial(plan_configurations, robot, position_uncertainty=position_uncertainty,
                   exit_uncertainty=exit_uncertainty)
    S, G = as_position(start), as_position(goal)
    plan(S, G)  # says what is wrong with the ends, if anything
    regions = [region(robot.exit_points[c.indices], exit_uncertainty, position_uncertainty)
               for c in triplets(robot)]
    first, last = _safe_start(regions, S), _safe_start(regions, G)
    if first is None or last is None:
        return None
    core = _between(lambda a, b: [sequence for sequence in plan(a, b) if sequence.safe], first, last, regions)
    return core and _with_ends(core, S, G, robot)


def _safe_start(regions: list[Region], position: Array) -> Array | None:
    """The nearest position at the same height that is certainly inside a triplet."""
    turns = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    circle = turned_to(turns, 3)[..., 0]
    near = (position + radius * way for radius in _AROUND for way in circle)
    return next((place for place in near if _certain(regions, place)), None)


def _certain(regions: list[Region], position: Array) -> bool:
    return any(known.certainty(position)[0] > 0 for known in regions)


def _between(safe: Callable[[Array, Array], list[ConfigurationSequence]], S: Array, G: Array,
             regions: list[Region]) -> ConfigurationSequence | None:
    if direct := safe(S, G):
        return direct[0]
    way = G - S
    side = np.cross([0, 0, 1], way) if way[:2].any() else np.array([1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    points = [S + share * way + offset * side for share, offset in product(_SHARES, _OFFSETS)]
    points = [V for V in points if _certain(regions, V)]
    for V in sorted(points, key=lambda V: np.linalg.norm(V - S) + np.linalg.norm(G - V)):
        if legs := list(product(safe(S, V), safe(V, G))):
            return min(starmap(_joined, legs), key=lambda sequence: sequence.score)
    return None


def _joined(a: ConfigurationSequence, b: ConfigurationSequence) -> ConfigurationSequence:
    """One sequence of two legs; where both are in the same configuration, the waypoint is one step."""
    same = a.steps[-1][1] == b.steps[0][1]
    return ConfigurationSequence(a.steps + b.steps[same:], a.location_scores + b.location_scores[same:],
                                 a.transition_scores + (0,) * (not same) + b.transition_scores, a.safe and b.safe)


def _with_ends(core: ConfigurationSequence, S: Array, G: Array, robot: Robot) -> ConfigurationSequence:
    """The nominal S and G added where the core starts or ends beside them: the load hangs there on two cables."""
    (first, old), (last, new) = core.steps[0], core.steps[-1]
    before = () if np.array_equal(S, first) else ((S, old),)
    after = () if np.array_equal(G, last) else ((G, new),)
    steps, loose = before + core.steps + after, len(before + after)
    scores = tuple(location_score(robot.exit_points[chosen.indices], place) for place, chosen in steps)
    return ConfigurationSequence(steps, scores,
                                 core.transition_scores + (UNSAFE_CHANGE,) * loose, core.safe and not loose)
