"""Sequences of cable configurations along a straight way: where to change, how good each is, which is safest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush
from itertools import groupby, pairwise, permutations
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, checked, frozen, lasting
from ..errors import InvalidInput
from ..robot import Robot
from .accuracy import position_sensitivity
from .configuration import Configuration, as_position, triplets
from .region import region

UNSAFE_CHANGE = 4
"""Score of a change that passes an under-constrained configuration."""

_EDGE = 1e-9  # m² and m³: a way along an edge is in both triangles
_GRID, _ZOOMS = 101, 4
_MOST = 200
"""Sequences that are ranked; more take more than a second."""

Step = tuple[Array, Configuration]

_Chain = tuple[Configuration, ...]
_Windows = dict[Configuration, tuple[float, float]]
"""Configuration → first and last share of the way where it holds."""
_Changes = dict[Configuration, dict[Configuration, tuple[float, float, bool]]]
_Latest = dict[Configuration, float]
"""Configuration → the share of the way up to which it still leads to G."""


@lasting
@dataclass(frozen=True, eq=False)
class ConfigurationSequence:
    """One way to go: positions and the configuration each is reached in, with scores; lower is better.

    steps : (position (3,) [m], Configuration) of S, of each change twice (old and new), and of
        G
    location_scores : one a step: 0 (amid its triangle) to 4, or with method "accuracy" [m/m]
    transition_scores : one a change: 0 safe, 4 where a cable may be missing
    score : their sum; with "accuracy" the largest location score
    safe : every position certainly inside its triangle, every change where both configurations
        certainly hold
    """

    steps: tuple[Step, ...]
    location_scores: tuple[float, ...]
    transition_scores: tuple[float, ...]
    safe: bool
    method: str = "stability"

    @property
    def score(self) -> float:
        """Of the whole sequence."""
        if self.method == "accuracy":
            return max(self.location_scores)
        return sum(self.location_scores) + sum(self.transition_scores)

    @property
    def configurations(self) -> tuple[Configuration, ...]:
        """In order, each once."""
        return tuple(chosen for chosen, _ in groupby(chosen for _, chosen in self.steps))

    def __str__(self) -> str:
        way = " → ".join(map(str, self.configurations))
        return f"{way}: score {self.score:.3g}, {'safe' if self.safe else 'not safe'}"


@dataclass(frozen=True, eq=False)
class _Way:
    """The straight way from S to G, and where on it each triplet holds."""

    robot: Robot
    start: Array
    end: Array
    position_uncertainty: float
    exit_uncertainty: float
    method: str

    @cached_property
    def nominal(self) -> _Windows:
        """Where each configuration holds, if nothing is uncertain."""
        return self._windows(0.0, 0.0, _EDGE)

    @cached_property
    def certain(self) -> _Windows:
        """Where each configuration certainly holds."""
        return self._windows(self.exit_uncertainty, self.position_uncertainty, 0.0)

    def _windows(self, exits: float, position: float, slack: float) -> _Windows:
        windows = {chosen: region(self.robot.exit_points[chosen.indices], exits, position)
                   .window(self.start, self.end, slack) for chosen in triplets(self.robot)}
        return {chosen: window for chosen, window in windows.items() if window is not None}

    def at(self, share: float | Array) -> Array:
        return frozen(self.start + np.multiply.outer(share, self.end - self.start))

    def grade(self, chosen: Configuration, places: Array) -> Array:
        """Of a configuration at places (…, 3), larger is better: min d / max d, or minus its sensitivity."""
        exits = self.robot.exit_points[chosen.indices]
        if self.method == "accuracy":
            return -position_sensitivity(exits, places, self.position_uncertainty, self.exit_uncertainty)
        return _plan_ratio(exits, places)

    def ends(self, windows: _Windows, end: int) -> set[Configuration]:
        """Configurations whose window holds S (0) or G (1)."""
        return {chosen for chosen, window in windows.items() if window[end] == end}

    @cached_property
    def changes(self) -> _Changes:
        """Configuration → those it may become, and where: in the certain window if there is one, which is safe, else in
        the nominal overlap."""
        found: _Changes = {old: {} for old in self.nominal}
        # A certain window is more than a point: on a shared edge, known exactly, only two
        # cables hold.
        for windows, least in ((self.nominal, -_EDGE), (self.certain, _EDGE)):
            for old, new in permutations(windows, 2):
                first, last = max(windows[old][0], windows[new][0]), min(windows[old][1], windows[new][1])
                if last - first >= least:
                    found[old][new] = min(first, last), last, windows is self.certain
        return found

    def onward(self, old: Configuration, share: float, latest: _Latest
               ) -> Iterator[tuple[Configuration, float, float, bool]]:
        """From a share of the way on what a configuration may become that must be left by its latest: which, between
        which shares, and whether safely."""
        for new, (first, last, safe) in self.changes[old].items():
            first, last = max(share, first), min(last, latest.get(new, -1.0))
            if first <= last + _EDGE:
                yield new, first, last, safe

    def shared_edge(self, old: Configuration, new: Configuration) -> float:
        """Where the way crosses, in plan, the edge between the exits of the two cables both have; NaN where not."""
        common = np.intersect1d(old, new) - 1
        if len(common) == 2:
            a, b = self.robot.exit_points[common, :2]
            ways = np.column_stack([(self.end - self.start)[:2], a - b])
            if abs(np.linalg.det(ways)) >= _EDGE:
                share, along = np.linalg.solve(ways, a - self.start[:2])
                if 0 <= along <= 1:
                    return share
        return np.nan


@checked
def plan_configurations(robot: Robot, start: ArrayLike, goal: ArrayLike,
                        method: Literal["stability", "accuracy"] = "stability", *,
                        position_uncertainty: Annotated[float, "[m] ≥ 0"] = 0.05,
                        exit_uncertainty: Annotated[float, "[m] ≥ 0"] = 0.02
                        ) -> list[ConfigurationSequence]:
    """Ranked sequences of configurations from S straight to G with the fewest changes; best first.

    A change is safe where the old and the new configuration are both certainly inside; there,
    "stability" takes the point where the smaller of their min d / max d (plan distances to the
    three exits) is largest, "accuracy" where the larger of their position sensitivities is
    smallest. Without such a point it lies at the edge both share, or amid the nominal overlap
    where that is not crossed, and scores 4; "accuracy" does not take it at all.

    robot : a point mass (3T) on three cables or more
    start, goal : (3,) S and G, or Pose [m]
    method : "stability" or "accuracy"
    position_uncertainty, exit_uncertainty : half widths of the boxes around M and each A_i [m]
    Returns list of ConfigurationSequence; empty, the reason logged, where the method allows
    none.
    Raises InvalidInput for an unknown method, or a start or goal that no three cables hold.
    Source: Ramadour and Merlet 2014, section IV, scores as in section V.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("point_mass").robot
    >>> print(plan_configurations(robot, [-1, 0.3, 1], [1, 0.3, 1])[0])
    A134 → A234: score 4, safe
    """
    way = _Way(robot, as_position(start), as_position(goal), position_uncertainty, exit_uncertainty,
               method)
    for name, place, end in (("start", way.start, 0), ("goal", way.end, 1)):
        if not way.ends(way.nominal, end):
            raise InvalidInput(f"no three cables hold a load at the {name} {place.tolist()}: it must lie below the "
                               "exit points and, seen from above, between them")
    chains = _fewest_changes(way)
    found = [_sequence(way, chain) for chain in chains]
    if method == "accuracy":
        found = [sequence for sequence in found if not any(sequence.transition_scores)]
    if not found:
        _log(
            "no sequence: %s has no change where both configurations are certainly inside, which method 'accuracy' "
            "asks for", ", ".join("→".join(map(str, chain)) for chain in chains))
    return sorted(found, key=lambda sequence: (method == "accuracy" and not sequence.safe, sequence.score))


def _log(message: str, *values: Any) -> None:
    import logging

    logging.getLogger(__name__).warning(message, *values)


def _fewest_changes(way: _Way) -> list[_Chain]:
    """Chains of configurations from S to G of the smallest length; certain ends first, else nominal ones.

    All of them, or the `_MOST` with the fewest unsafe changes, and the log says so.
    """
    for windows in (way.certain, way.nominal):
        layers = _latest(way, way.ends(windows, 0), way.ends(windows, 1))
        if layers[0]:
            break
    found: list[_Chain] = []
    # Fewest unsafe changes first, and of these the longest: nothing is begun that need not be.
    waiting: list[tuple[int, int, _Chain, float]] = [(0, 0, (first,), 0.0) for first in sorted(layers[0])]
    while waiting and len(found) <= _MOST:
        unsafe, _, chain, share = heappop(waiting)
        if len(chain) == len(layers):
            found.append(chain)
            continue
        for new, first, _, safe in way.onward(chain[-1], share, layers[len(chain)]):
            heappush(waiting, (unsafe + (not safe), -len(chain), (*chain, new), first))
    if len(found) > _MOST:
        _log(
            "more than %d sequences have %d changes: ranked are that many, those with the fewest unsafe changes",
            _MOST, len(layers) - 1)
    return sorted(found[:_MOST])


def _latest(way: _Way, starts: set[Configuration], goals: set[Configuration]) -> list[_Latest]:
    """For each step of the shortest chains: configuration → the share of the way up to which it still leads to G.

    Backwards from G, a change more at a time, until one of the starts is reached; the first is
    empty if none ever is.
    """
    layers, best = [dict.fromkeys(goals, 1.0)], dict.fromkeys(goals, 1.0)
    while layers[0] and not starts & layers[0].keys():
        before = {old: max((last for _, _, last, _ in way.onward(old, 0.0, layers[0])), default=-1.0)
                  for old in way.nominal}
        # Sooner in the way and with more changes is of no use.
        layers.insert(0, {old: share for old, share in before.items() if share > best.get(old, -1.0)})
        best |= layers[0]
    layers[0] = {chosen: share for chosen, share in layers[0].items() if chosen in starts}
    return layers


def _sequence(way: _Way, chain: _Chain) -> ConfigurationSequence:
    """The sequence of a chain: each change where it is best, early enough for those after it."""
    overlaps = np.array([way.changes[old][new] for old, new in pairwise(chain)]).reshape(-1, 3)
    latest = np.minimum.accumulate(overlaps[::-1, 1])[::-1]
    share, steps = 0.0, [(way.start, chain[0])]
    for (old, new), (first, _, safe), last in zip(pairwise(chain), overlaps, latest):
        share = _switch(way, old, new, min(max(first, share), last), last, safe)
        steps += [(way.at(share), old), (way.at(share), new)]
    steps.append((way.end, chain[-1]))
    scores = tuple(float(-way.grade(chosen, place)) if way.method == "accuracy" else
                   location_score(way.robot.exit_points[chosen.indices], place) for place, chosen in steps)
    changes = tuple(0 if safe else UNSAFE_CHANGE for safe in overlaps[:, 2])
    certain = chain[0] in way.ends(way.certain, 0) and chain[-1] in way.ends(way.certain, 1)
    return ConfigurationSequence(tuple(steps), scores, changes, certain and not any(changes), way.method)


def location_score(exits: Array, position: Array) -> int:
    """⌊5 (1 − min d / max d)⌋ of the plan distances to a configuration's exits: 0 amid them, 4 below one of them.

    exits : (3, 3) [m]; position : (3,) [m]

    >>> location_score(np.array([[0, 0, 3], [4, 0, 3], [0, 4, 3.0]]), np.array([1, 1, 0.0]))
    2
    """
    # A ratio that is a fifth but for rounding is a fifth; below an exit point the score is 5 by
    # the formula, 4 by the range the paper gives.
    return min(4, int(5 * (1 - _plan_ratio(exits, position)) + 1e-9))


def _switch(way: _Way, old: Configuration, new: Configuration, first: float, last: float, safe: bool) -> float:
    """Where on the way to change, as a share of it."""
    if not safe:
        edge = way.shared_edge(old, new)
        return edge if first - _EDGE <= edge <= last + _EDGE else (first + last) / 2
    low, high = first, last
    for _ in range(_ZOOMS):  # both grades are smooth: a grid, then finer ones around its best point
        shares = np.linspace(low, high, _GRID)
        grades = [way.grade(chosen, way.at(shares)) for chosen in (old, new)]
        best = shares[np.minimum(*grades).argmax()]
        width = (high - low) / (_GRID - 1)
        low, high = max(first, best - width), min(last, best + width)
    return best


def _plan_ratio(exits: Array, positions: Array) -> Array:
    """(…) min d / max d over the plan distances from positions (…, 3) to a configuration's exits."""
    d = np.linalg.norm(positions[..., None, :2] - exits[:, :2], axis=-1)
    return d.min(axis=-1) / d.max(axis=-1)
