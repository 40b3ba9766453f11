"""Planning: the shortest way of the pair among what stands in a hall, by Dijkstra's method on a lattice of poses."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ...arrays import Array, Indices, checked, frozen_dataclass
from ..plane import Way, checked_pose, difference
from .occupancy import OccupancyGrid
from .vehicle import Vehicle

Margin = Annotated[float, "[m] ≥ 0"]
MARGIN = 0.1
"""Kept between the pair and all that stands in the hall [m]."""

_STEP = 0.1          # m between neighbors of the lattice
_HEADINGS = 16       # of the lattice
_BETWEEN = 4         # headings looked at from one of them to the next
_WIDE = 0.4          # m of room beyond which a place costs nothing extra
_JOIN = 0.45         # m around start and goal where the lattice is joined
_JOINED = 40         # nodes at most


@frozen_dataclass
class Plan:
    """A way, or why there is none.

    poses : (n, 3) from start to goal, straight in between; empty without a way [m, m, rad]
    reason : '' or what is in the way
    """

    poses: Way
    reason: str = ""

    @classmethod
    def none(cls, reason: str) -> Plan:
        """No way, and why."""
        return cls(np.zeros((0, 3)), reason)

    @property
    def found(self) -> bool:
        """Whether there is a way."""
        return not self.reason

    @property
    def length(self) -> float:
        """Of the middle's way [m]."""
        return float(np.linalg.norm(np.diff(self.poses[:, :2], axis=0), axis=1).sum())


@checked
def inflated_width(grid: OccupancyGrid, vehicle: Vehicle, margin: Margin = MARGIN) -> float:
    """A straight gap this wide is certainly found: the discs, the margin, and what cells hide [m]."""
    return 2 * (float(vehicle.discs[:, 1].max()) + vehicle.radius + margin + grid.slack)


@checked
def plan_path(grid: OccupancyGrid, vehicle: Vehicle, start: ArrayLike, goal: ArrayLike,
              margin: Margin = MARGIN) -> Plan:
    """The quickest way from start to goal: min Σ time × (2 − room left, up to where room is plenty).

    grid : of the hall; start, goal : (3,) poses of the vehicle [m, m, rad]
    margin : kept from all that stands there; from where the pair stands already, as much as
        there is [m]
    Returns Plan; without a way its ``reason`` says why.
    Source: E. W. Dijkstra, Numerische Mathematik 1, 1959, on the costmap of Pedemonte et al.
    2020, section 2.3.

    >>> import cdprlab as cl
    >>> from cdprlab.fastkit import Hall
    >>> hall = Hall.of([[0, 0, 0.2, 4, 0]], [[-5, -3], [5, 3]])
    >>> pair = Vehicle.of(cl.load_world("fastkit_suspended").robot)
    >>> plan_path(OccupancyGrid.of(hall), pair, [-2.5, 0, 0], [2.5, 0, 0]).reason
    'there is no way of 1.50 m width from the start to the goal'
    """
    a, b = checked_pose(start, "start"), checked_pose(goal, "goal")
    here, there = grid.room(vehicle, np.stack([a, b])).tolist()
    if there < margin:
        left = "0" if there < 0 else f"{there:.2f}"
        return Plan.none(f"the goal is not free: {left} m are left around the pair, {margin:g} m are wanted")
    if here < -grid.slack - vehicle.radius / 2:
        return Plan.none("the pair stands against something: there is no room to drive away")
    least = min(margin, here)
    nodes = _Lattice(grid, vehicle, margin).way(a, b, least)
    if not len(nodes):
        wide = inflated_width(grid, vehicle, margin)
        return Plan.none(f"there is no way of {wide:.2f} m width from the start to the goal")
    poses = np.vstack([a, nodes, b])
    # Out of a tight place as the lattice goes: a straight drive could stay as tight for long.
    tight = int(here < margin)
    return Plan(np.vstack([poses[:tight], _shortened(grid, vehicle, poses[tight:], margin)]))


def between(a: ArrayLike, b: ArrayLike, step: float = 0.04, turn_step: float = 0.03) -> Array:
    """(…, k, 3) poses from a to b (…, 3), both included, close enough together to be looked at one by one."""
    d = difference(b, a)
    far = np.maximum(np.linalg.norm(d[..., :2], axis=-1) / step, np.abs(d[..., 2]) / turn_step)
    count = int(np.ceil(far.max(initial=1.0)))
    return np.asarray(a) + np.arange(count + 1)[:, None] / count * d[..., None, :]


def along(poses: Array, *steps: float) -> Array:
    """(k, 3) poses on a way (n, 3), corners among them, close enough together: see `between`."""
    return np.concatenate([poses[:1], *(between(a, b, *steps)[1:] for a, b in zip(poses, poses[1:]))])


@lru_cache(1)   # somewhere else to go, in the same hall, does not need another
class _Lattice:
    """Poses on a grid of places and headings, those free joined to their free neighbors."""

    def __init__(self, grid: OccupancyGrid, vehicle: Vehicle, margin: float) -> None:
        self.grid, self.vehicle, self.margin = grid, vehicle, margin
        self.xs, self.ys = (low + np.arange(_STEP / 2, count * grid.cell, _STEP)
                            for low, count in zip(grid.corner, grid.occupied.shape))
        self.headings = np.arange(_HEADINGS * _BETWEEN) * 2 * np.pi / (_HEADINGS * _BETWEEN)
        # A rectangle that is turned round is the same rectangle: half the headings are enough.
        half = grid.room_on(vehicle, self.xs, self.ys, self.headings[:len(self.headings) // 2])
        self.room = np.tile(half, (2, 1, 1)).reshape(_HEADINGS, _BETWEEN, *half.shape[1:])
        self.free = self.room[:, 0] >= margin                                        # (headings, nx, ny)
        self.nodes = np.flatnonzero(self.free)
        self.poses = self._poses(self.nodes)

    def way(self, start: Array, goal: Array, least: float) -> Array:
        """(n, 3) poses of the best way between the nodes that start and goal join; (0, 3) if there is none."""
        (ends, _), (begins, joining) = self._joined(goal, self.margin), self._joined(start, least)
        if not (len(ends) and len(begins)):
            return np.zeros((0, 3))
        times, previous = dijkstra(self._graph, directed=False, indices=ends[0],
                                   return_predecessors=True)
        best = int(begins[np.argmin(times[begins] + joining)])
        nodes = []
        while best >= 0 and np.isfinite(times[best]):
            nodes.append(best)
            best = int(previous[best])
        return self._poses(np.array(nodes, dtype=int))

    def _poses(self, nodes: Indices) -> Array:
        h, x, y = np.unravel_index(nodes, self.free.shape)
        return np.stack([self.xs[x], self.ys[y], self.headings[_BETWEEN * h]], axis=-1)

    def _joined(self, pose: Array, least: float) -> tuple[Indices, Array]:
        """Free nodes near a pose that a straight free drive reaches, nearest first, and in what time [s]."""
        d = np.abs(difference(self.poses, pose))
        near = (d <= [_JOIN, _JOIN, 2.2 * np.pi / _HEADINGS]).all(axis=1)
        nodes, times = self.nodes[near], (d[near] / self.vehicle.speed_max[[1, 2, 0]]).sum(axis=-1)
        room = self.grid.room(self.vehicle, between(pose, self.poses[near])).min(axis=-1)
        best = np.argsort(times, kind="stable")
        best = best[room[best] >= least - 1e-9][:_JOINED]
        return nodes[best], times[best]

    @cached_property
    def _graph(self) -> csr_array:
        """Seconds between neighbors, (nodes, nodes)."""
        index = np.arange(self.free.size).reshape(self.free.shape)
        wide = 1 + np.clip(1 - (self.room[:, 0] - self.margin) / _WIDE, 0, 1)
        spin, forward, across = self.vehicle.speed_max
        along = _STEP / min(forward, across)
        about = 2 * np.pi / _HEADINGS / min(spin, across / self.vehicle.arm)
        turns = (self.room >= self.margin).all(axis=1)
        edges = []
        for step in ((0, 1, 0), (0, 0, 1), (0, 1, 1), (0, 1, -1), (1, 0, 0)):
            # Headings go round; places do not, but at the floor's edge, where rolling would
            # join them, none is free.
            there = np.roll(index, np.negative(step), axis=(0, 1, 2))
            both = (turns if step[0] else self.free) & self.free.ravel()[there]
            # A turn counts where it begins, a way at both its ends.
            time = about * wide if step[0] else np.hypot(*step[1:]) * along * (wide + wide.ravel()[there]) / 2
            edges.append((index[both], there[both], time[both]))
        i, j, t = map(np.concatenate, zip(*edges))
        return csr_array((t, (i, j)), shape=(index.size, index.size))


def _shortened(grid: OccupancyGrid, vehicle: Vehicle, poses: Array, margin: float) -> Array:
    """The way with corners left out, wherever the straight drive is as free as the way around has to be."""
    room, kept = grid.room(vehicle, poses), [0]
    while (k := kept[-1]) < len(poses) - 1:
        for ahead in range(min(len(poses) - 1, k + 30), k, -1):
            # Not through a narrower place than the lattice chose.
            least = np.clip(room[k:ahead + 1].min(), margin, margin + 0.15)
            way = between(poses[k], poses[ahead])
            if ahead == k + 1 or (grid.room(vehicle, way) >= least - 1e-9).all():
                break
        kept.append(ahead)
    return poses[kept]
